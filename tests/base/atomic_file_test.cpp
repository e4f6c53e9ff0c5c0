// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/base/atomic_file.h"

#include "core/base/abandoned_files.h"

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

using namespace imomushi;

namespace {

std::set<std::string> namesIn(const std::filesystem::path& folder) {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) names.insert(entry.path().filename().string());
    return names;
}

/// Another process writes a part of `path` and is killed.
void killWhileWriting(const std::filesystem::path& path) {
    const pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        AtomicFile file(path);
        file.write("half");
        ::kill(::getpid(), SIGKILL);
    }
    int status = 0;
    REQUIRE(::waitpid(child, &status, 0) == child);
    REQUIRE(WIFSIGNALED(status));
}

}  // namespace

TEST_CASE("atomic file: the next writer removes what killed ones left, and nothing else") {
    const auto folder = std::filesystem::temp_directory_path() / ("imomushi_atomic_file_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    const auto path = folder / "a.imomushi";
    REQUIRE(writeFileAtomically(path, "old"));
    const std::set<std::string> others = {"a.imomushi.part", "a.imomushi.notes-1.part", "b.imomushi.1-0.part"};
    for (const auto& name : others) std::ofstream(folder / name) << "of somebody else";

    killWhileWriting(path);
    killWhileWriting(path);  // removes what the first one left
    CHECK(namesIn(folder).size() == 2 + others.size());
    {
        AtomicFile going(path);  // a file that somebody writes now is not abandoned
        going.write("first");
        REQUIRE(writeFileAtomically(path, "second"));
        CHECK(namesIn(folder).size() == 2 + others.size());
        REQUIRE(going.finish());
    }
    std::set<std::string> expected = others;
    expected.insert("a.imomushi");
    CHECK(namesIn(folder) == expected);
    std::string text;
    std::ifstream(path) >> text;
    CHECK(text == "first");

    // Those of one file, before anybody writes it again.
    killWhileWriting(path);
    CHECK(namesIn(folder).size() == 2 + others.size());
    removeAbandonedPartsOf(path);
    CHECK(namesIn(folder) == expected);

    // All of a folder, where no name is written again.
    killWhileWriting(path);
    killWhileWriting(folder / "c.imomushi");
    {
        AtomicFile going(folder / "d.imomushi");
        removeAbandonedFiles(folder);
        REQUIRE(going.finish());
    }
    for (const auto& name : {"a.imomushi.part", "a.imomushi.notes-1.part", "a.imomushi", "d.imomushi"}) CHECK(namesIn(folder).contains(name));
    CHECK(namesIn(folder).size() == 4);
    std::filesystem::remove_all(folder);
}
