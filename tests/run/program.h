// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/folder.h"

/// The program as a black box: scripts in, JSON lines and exit status out.
namespace imomushi {

using Json = nlohmann::ordered_json;

inline const std::filesystem::path& folder() {
    static const TestFolder folder;
    return folder.path();
}

inline std::filesystem::path writeFile(const std::string& name, const std::string& bytes) {
    const auto path = folder() / name;
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
}

struct Run {
    int status = -1;
    std::string out, err;
    std::vector<Json> answers;
};

/// Runs the program in a folder of its own, without display. `arguments` for the shell, which does `before` first.
inline Run program(const std::string& arguments, const std::string& before = "true") {
    const auto out = folder() / "stdout", err = folder() / "stderr";
    const std::string command = "cd '" + folder().string() + "' && " + before + " && env -u DISPLAY -u WAYLAND_DISPLAY '" IMOMUSHI_PROGRAM "' " + arguments + " >'" + out.string() +
                                "' 2>'" + err.string() + "'";
    const int status = std::system(command.c_str());
    Run run;
    run.status = WIFEXITED(status) ? WEXITSTATUS(status) : -2;
    run.out = readFile(out);
    run.err = readFile(err);
    return run;
}

inline Run script(const std::string& lines, const std::string& options = "", const std::string& before = "true") {
    const auto path = writeFile("script.jsonl", lines);
    Run run = program("run " + options + " '" + path.string() + "'", before);
    std::istringstream text(run.out);
    for (std::string line; std::getline(text, line);) run.answers.push_back(Json::parse(line));
    return run;
}

inline std::string codeOf(const Json& answer) { return answer["ok"].get<bool>() ? "ok" : answer["error"]["code"].get<std::string>(); }

}  // namespace imomushi
