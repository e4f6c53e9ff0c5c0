// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/worker/worker.h"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <thread>

#include "tests/worker/operations.h"

using namespace imomushi;

namespace {

/// Operations are done by workers while this lives.
struct WithWorkers {
    WithWorkers() { setWorkerProgram(IMOMUSHI_TEST_WORKER); }
    ~WithWorkers() { setWorkerProgram({}); }
};

int openDescriptors() {
    int n = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) n += !entry.path().empty();
    return n;
}

bool anyChild() {
    siginfo_t child{};
    return ::waitid(P_ALL, 0, &child, WEXITED | WNOHANG | WNOWAIT) == 0;
}

pid_t workerPid() { return static_cast<pid_t>(std::stol(breaking("pid").value_or("-1"))); }

}  // namespace

TEST_CASE("worker: an operation answers the same with and without a worker") {
    setWorkerProgram({});
    const auto here = repeated("imomushi", 1000);
    REQUIRE(here);
    const WithWorkers on;
    CHECK(repeated("imomushi", 1000).value_or("") == *here);
    const auto steps = stepped(10, {}, "");
    REQUIRE(steps);
    CHECK(steps->sum == 55);
    CHECK(steps->leftOut.empty());
}

TEST_CASE("worker: one is kept from operation to operation, and none is left when nobody wants any") {
    setWorkerProgram({});
    const int before = openDescriptors();
    {
        const WithWorkers on;
        const pid_t first = workerPid();
        CHECK(first > 0);
        CHECK(first != ::getpid());
        CHECK(workerPid() == first);
        CHECK(anyChild());
    }
    CHECK_FALSE(anyChild());
    CHECK(openDescriptors() == before);
}

TEST_CASE("worker: requests and answers of any size come over, and large ones that it keeps are not mixed up") {
    const WithWorkers on;
    // More than a socket takes at once, in both directions, and more of them than a worker keeps.
    std::vector<std::string> texts;
    for (int i = 0; i < 24; ++i) texts.emplace_back(std::size_t{1} << (14 + i % 9), static_cast<char>('a' + i));
    for (int round = 0; round < 2; ++round)
        for (const std::string& text : texts) CHECK(repeated(text, 2).value_or("") == text + text);
    const std::string large(std::size_t{96} << 20, 'x');
    const auto answer = repeated(large, 1);
    REQUIRE(answer);
    CHECK(*answer == large);
}

TEST_CASE("worker: what breaks down in a step is done again without that step, and the answer says so") {
    const WithWorkers on;
    WorkLimits limits;
    limits.memoryBytes = std::size_t{512} << 20;
    for (const std::string how : {"crash", "abort", "exit", "memory", "burn"}) {
        CAPTURE(how);
        limits.cpuSeconds = how == "burn" ? 1 : 60;  // taking memory takes time, too
        const auto answer = stepped(10, how == "burn" ? std::vector{3} : std::vector{3, 7}, how, {}, limits);
        REQUIRE(answer);
        CHECK(answer->sum == (how == "burn" ? 52 : 45));
        CHECK(answer->leftOut ==
              (how == "burn" ? std::vector<std::string>{"a step (3)"} : std::vector<std::string>{"a step (3)", "a step (7)"}));
    }
    // Where an answer would depend on the machine, a limit is a failure; a crash is not.
    limits.leaveOut = false;
    for (const std::string how : {"memory", "burn", "crash"}) {
        CAPTURE(how);
        limits.cpuSeconds = how == "burn" ? 1 : 60;  // taking memory takes time, too
        const auto answer = stepped(10, {3}, how, {}, limits);
        CHECK((answer ? std::string("left out") : answer.error().code) == (how == "memory" ? "too-large" : how == "burn" ? "timeout" : "left out"));
    }
    // At most eight times.
    const auto eight = stepped(10, {1, 2, 3, 4, 5, 6, 7, 8}, "crash");
    REQUIRE(eight);
    CHECK(eight->sum == 19);
    const auto nine = stepped(10, {1, 2, 3, 4, 5, 6, 7, 8, 9}, "crash");
    REQUIRE(!nine);
    CHECK(nine.error().code == "worker-failed");
}

TEST_CASE("worker: what breaks down outside of any step is a failure that is said") {
    const WithWorkers on;
    const auto code = [](const std::string& how, const WorkLimits& limits = {}) {
        const auto answer = breaking(how, {}, limits);
        return answer ? *answer : answer.error().code;
    };
    for (const char* how : {"crash", "abort", "exit", "garbage"}) CHECK_MESSAGE(code(how) == "worker-failed", how);
    CHECK(code("kill") == "worker-killed");
    WorkLimits limits;
    limits.cpuSeconds = 1;
    CHECK(code("burn", limits) == "timeout");
    limits = {};
    limits.wallSeconds = 0.3;
    CHECK(code("sleep", limits) == "timeout");
    limits = {};
    limits.memoryBytes = std::size_t{512} << 20;
    CHECK(code("memory", limits) == "too-large");
    CHECK(code("none") == "nothing broke");
    setWorkerProgram("/nonexistent/worker");
    CHECK(code("none") == "worker-failed");
}

TEST_CASE("worker: processor time is that of one operation, however long the worker is kept") {
    const WithWorkers on;
    WorkLimits limits;
    limits.cpuSeconds = 1;
    const pid_t first = workerPid();
    const std::string text(std::size_t{4} << 20, 'x');
    for (int i = 0; i < 12; ++i) REQUIRE(repeated(text, 8, {}, limits));  // some seconds in all
    CHECK(workerPid() == first);
}

TEST_CASE("worker: it inherits no open files") {
    const WithWorkers on;
    const std::ofstream open(std::filesystem::temp_directory_path() / ("imomushi-open-" + std::to_string(::getpid())));
    const auto answer = breaking("descriptors");
    REQUIRE(answer);
    // Its connection and where libraries print to.
    CHECK(std::count(answer->begin(), answer->end(), ' ') == 2);
    std::filesystem::remove(std::filesystem::temp_directory_path() / ("imomushi-open-" + std::to_string(::getpid())));
}

TEST_CASE("worker: cancelling answers at once and ends it") {
    const WithWorkers on;
    std::stop_source stop;
    std::jthread later([&] {
        while (!anyChild()) std::this_thread::yield();
        stop.request_stop();
    });
    const auto answer = breaking("sleep", Progress({}, stop.get_token()));  // would take 1000 s
    REQUIRE(!answer);
    CHECK(answer.error().code == kCancelled);
    CHECK_FALSE(anyChild());
}

TEST_CASE("worker: its progress is told, from 0 to 1 and never backwards") {
    const WithWorkers on;
    double last = 0.0;
    REQUIRE(repeated("x", 100,
                     Progress(
                         [&](std::string_view stage, double fraction) {
                             CHECK(stage == "repeat");
                             CHECK(fraction >= last);
                             last = fraction;
                         },
                         {})));
    CHECK(last == 1.0);
}
