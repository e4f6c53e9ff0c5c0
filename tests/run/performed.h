// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "tests/run/program.h"

namespace imomushi {

/// Starts the program in the background and does `meanwhile` once it listens; $osc and $vmc are its ports.
inline Run performed(const std::string& arguments, const std::string& meanwhile) {
    const std::string senders = IMOMUSHI_SOURCE_DIR "/assets/live";
    writeFile("perform.sh", "cd '" + folder().string() + "'\nrm -f heard\nexport PYTHONDONTWRITEBYTECODE=1\nenv -u DISPLAY -u WAYLAND_DISPLAY '" IMOMUSHI_PROGRAM "' " + arguments +
                                " >answers 2>heard &\nprogram=$!\nport() { sed -n \"s/^Listening to $1 on 127.0.0.1:\\([0-9]*\\)$/\\1/p\" heard; }\n"
                                "for i in $(seq 600); do [ \"$(grep -c Listening heard 2>/dev/null)\" = 2 ] && break; sleep 0.1; done\n"
                                "osc=$(port osc); vmc=$(port vmc); senders='" + senders + "'\n" + meanwhile + "\nwait $program\n");
    const int status = std::system(("bash '" + (folder() / "perform.sh").string() + "'").c_str());
    Run run;
    run.status = WIFEXITED(status) ? WEXITSTATUS(status) : -2;
    run.out = readFile(folder() / "answers");
    run.err = readFile(folder() / "heard");
    std::istringstream text(run.out);
    for (std::string line; std::getline(text, line);) run.answers.push_back(Json::parse(line));
    return run;
}

}  // namespace imomushi
