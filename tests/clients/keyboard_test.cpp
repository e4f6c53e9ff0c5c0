// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/support/folder.h"
#include "tests/support/left_out.h"

namespace {

constexpr int kLeftOut = 77;      // of by_keyboard.py
constexpr int kNoProgram = 127;   // of a shell

}  // namespace

TEST_CASE("by keyboard and screen reader alone: import, cut, faces and bones, each edited, precompute, pose, record, export and save, and the files hold it") {
    const imomushi::TestFolder folder("imomushi-keyboard");
    std::filesystem::copy_file(IMOMUSHI_CLIENTS "/../data/reference/a_cylinder_coarse.obj", folder / "body.obj");
    const std::string quoted = "'" + folder.path().string() + "'";
    // Debian's python knows the bus; another one that comes first in PATH may not.
    const std::string python = std::filesystem::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3";
    const int code = std::system(("cd " + quoted + " && timeout 280 dbus-run-session -- " + python + " '" IMOMUSHI_CLIENTS "/by_keyboard.py' '" IMOMUSHI_PROGRAM "' " + quoted + " >said 2>errors").c_str());
    const int status = WIFEXITED(code) ? WEXITSTATUS(code) : -1;
    const std::string said = imomushi::readFile(folder / "said");
    if (status == kLeftOut || status == kNoProgram) return imomushi::leaveOut(said.empty() ? "dbus-run-session is not installed" : said);
    INFO(said, imomushi::readFile(folder / "errors"));
    CHECK(status == 0);
    CHECK(said.find("project, take and exported file hold what was done") != std::string::npos);
}
