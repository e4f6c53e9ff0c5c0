// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fcntl.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

extern char** environ;

namespace imomushi {

/// What a program wrote to its standard output by the time it was killed (SIGKILL) or had ended. Its errors go where those of the test go.
struct Killed {
    std::string out;
    bool ended = false;  ///< before it could be killed
    int status = -1;     ///< if it ended by itself
    int left = 0;        ///< processes that it had started and that lived on; they are killed
};

/// Processes that the main thread of this one has started, or has for others' that died.
inline std::set<pid_t> childProcesses() {
    std::set<pid_t> all;
    std::ifstream children("/proc/self/task/" + std::to_string(::getpid()) + "/children");
    for (pid_t child = 0; children >> child;) all.insert(child);
    return all;
}

/// Starts a program (its path and arguments) and kills it after a time; mayEnd: unless it ended by itself before. The pipe holds what it says
/// meanwhile: less than 64 KB.
inline Killed killAfter(const std::vector<std::string>& command, std::chrono::microseconds time, bool mayEnd = false) {
    ::prctl(PR_SET_CHILD_SUBREAPER, 1);  // what it has started is this process's once it is dead
    const std::set<pid_t> before = childProcesses();
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    std::vector<char*> words;
    for (const auto& word : command) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    pid_t child = 0;
    const int failed = ::posix_spawn(&child, words[0], &actions, nullptr, words.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    if (failed) throw std::runtime_error("cannot start " + command[0]);
    int status = 0;
    const auto last = std::chrono::steady_clock::now() + time;
    bool gone = false;
    if (!mayEnd) std::this_thread::sleep_for(time);
    while (mayEnd && !(gone = ::waitpid(child, &status, WNOHANG) == child) && std::chrono::steady_clock::now() < last) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (!gone) {
        ::kill(child, SIGKILL);
        ::waitpid(child, &status, 0);
    }
    Killed killed;
    killed.ended = WIFEXITED(status);
    if (killed.ended) killed.status = WEXITSTATUS(status);
    std::array<char, 4096> bytes{};
    for (ssize_t n = 0; (n = ::read(ends[0], bytes.data(), bytes.size())) > 0;) killed.out.append(bytes.data(), static_cast<std::size_t>(n));
    ::close(ends[0]);
    for (const pid_t orphan : childProcesses()) {
        if (before.contains(orphan)) continue;
        pid_t gone = 0;
        for (int wait = 0; gone == 0 && wait < 10'000; ++wait)
            if ((gone = ::waitpid(orphan, nullptr, WNOHANG)) == 0) ::usleep(1000);
        if (gone != 0) continue;
        ++killed.left;
        ::kill(orphan, SIGKILL);
        ::waitpid(orphan, nullptr, 0);
    }
    ::prctl(PR_SET_CHILD_SUBREAPER, 0);
    return killed;
}

}  // namespace imomushi
