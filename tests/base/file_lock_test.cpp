// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/base/file_lock.h"

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "tests/support/folder.h"

using namespace imomushi;

TEST_CASE("file lock: one holds it, the next takes it when that ends or is killed, and it leaves no file") {
    const TestFolder folder;
    const auto path = folder / "a.lock";
    {
        const auto held = FileLock::take(path);
        REQUIRE(held);
        CHECK_FALSE(FileLock::take(path));
        CHECK(std::filesystem::exists(path));
    }
    CHECK_FALSE(std::filesystem::exists(path));

    const pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        const auto held = FileLock::take(path);
        ::kill(::getpid(), held ? SIGKILL : SIGTERM);
    }
    int status = 0;
    REQUIRE(::waitpid(child, &status, 0) == child);
    REQUIRE(WTERMSIG(status) == SIGKILL);
    CHECK(std::filesystem::exists(path));
    CHECK(FileLock::take(path));

    std::ofstream(path) << "of another program";
    CHECK(FileLock::take(path));
    CHECK_FALSE(std::filesystem::exists(path));
    CHECK_FALSE(FileLock::take(folder.path() / "no such folder" / "a.lock"));
}
