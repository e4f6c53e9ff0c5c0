// SPDX-License-Identifier: GPL-3.0-or-later
// Workers and the programs that ask them, killed at any moment.
#include <doctest/doctest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <thread>

#include "tests/support/thorough.h"
#include "tests/support/victim.h"
#include "tests/worker/operations.h"

using namespace imomushi;

namespace {

std::ptrdiff_t descriptorCount() {
    const std::filesystem::directory_iterator all("/proc/self/fd");
    return std::distance(begin(all), end(all));
}

/// Memory shared with workers.
int sharedMemories() {
    std::ifstream maps("/proc/self/maps");
    int count = 0;
    for (std::string line; std::getline(maps, line);) count += line.find("memfd:worker") != std::string::npos;
    return count;
}

/// One of several operations, which send little, much, what is kept, and what breaks down by itself.
std::string ask(int which) {
    const auto said = [](const Result<std::string>& answer) { return answer ? *answer : answer.error().code; };
    if (which % 4 == 3) {
        const auto steps = stepped(10, {3}, "crash");
        return steps ? std::to_string(steps->sum) : steps.error().code;
    }
    static const std::string large(std::size_t{1} << 20, 'x');
    return said(repeated(which % 4 == 2 ? large : which % 4 == 1 ? large.substr(0, 40000) : "small", which % 4 + 1));
}

}  // namespace

TEST_CASE("killed: workers, at any moment; each answer has the same bytes or says that one was killed, and nothing is left") {
    setWorkerProgram({});
    const auto before = descriptorCount();
    setWorkerProgram(IMOMUSHI_TEST_WORKER);
    std::string right[4];
    for (int which = 0; which < 4; ++which) right[which] = ask(which);
    CHECK(right[3] == "52");
    std::atomic<bool> done = false;
    std::atomic<int> kills = 0;
    std::jthread killer([&] {
        std::mt19937 random(5);
        while (!done) {
            ::usleep(static_cast<useconds_t>(random() % 8000));
            for (const pid_t child : childProcesses()) kills += ::kill(child, SIGKILL) == 0;
        }
    });
    const int wanted = repeats(100, 2000);
    int answered = 0, killed = 0;
    for (int n = 0; kills < wanted; ++n) {
        const std::string answer = ask(n);
        const bool same = answer == right[n % 4];
        answered += same;
        killed += answer == "worker-killed";
        REQUIRE_MESSAGE((same || answer == "worker-killed"), answer.substr(0, 100));
    }
    done = true;
    killer.join();
    MESSAGE(kills.load() << " kills: " << answered << " answers, " << killed << " said that it was killed");
    CHECK(answered > 0);
    for (int which = 0; which < 4; ++which) CHECK(ask(which) == right[which]);
    setWorkerProgram({});
    CHECK(childProcesses().empty());
    CHECK(descriptorCount() == before);
    CHECK(sharedMemories() == 0);
}

TEST_CASE("killed: programs that ask workers, at any moment; no worker lives on") {
    std::mt19937 random(6);
    for (int kill = 0; kill < repeats(100, 2000); ++kill) {
        const Killed killed = killAfter({IMOMUSHI_TEST_WORKER, "work"}, std::chrono::microseconds(random() % 30'000));
        REQUIRE_FALSE(killed.ended);
        REQUIRE(killed.left == 0);
    }
}
