// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/support/folder.h"
#include "tests/support/left_out.h"

namespace {

constexpr int kLeftOut = 77;      // of both scripts
constexpr int kNoProgram = 127;   // of a shell

/// A session from outside, in a folder of its own with a mesh. `more`: arguments of the script after the folder.
void session(const char* script, const char* more) {
    const imomushi::TestFolder folder("imomushi-session");
    std::filesystem::copy_file(IMOMUSHI_CLIENTS "/../data/reference/a_cylinder_coarse.obj", folder / "body.obj");
    const std::string quoted = "'" + folder.path().string() + "'";
    // Debian's python knows the bus; another one that comes first in PATH may not.
    const std::string python = std::filesystem::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3";
    const int code = std::system(("cd " + quoted + " && timeout 400 dbus-run-session -- " + python + " '" IMOMUSHI_CLIENTS "/" + script + "' '" IMOMUSHI_PROGRAM "' " + quoted + " " + more + " >said 2>errors").c_str());
    const int status = WIFEXITED(code) ? WEXITSTATUS(code) : -1;
    const std::string said = imomushi::readFile(folder / "said");
    if (status == kLeftOut || status == kNoProgram) return imomushi::leaveOut(said.empty() ? "dbus-run-session is not installed" : said);
    INFO(said, imomushi::readFile(folder / "errors"));
    CHECK(status == 0);
    CHECK(said.find("project, take and exported file hold what was done") != std::string::npos);
}

}  // namespace

TEST_CASE("by keyboard and screen reader alone: import, cut, faces and bones, each edited, precompute, pose, record, export and save, and the files hold it") { session("by_keyboard.py", ""); }

TEST_CASE("by mouse, in Japanese, light, with letters of 150 % on a screen of 1280 x 720: the same, on the stage, too, and nothing that is needed lies outside") { session("by_mouse.py", "ja light 1.5"); }
