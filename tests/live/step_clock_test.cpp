// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <atomic>
#include <thread>
#include <utility>

#include "core/live/step_clock.h"
#include "core/live/step_thread.h"

using namespace imomushi;
using namespace std::chrono_literals;

namespace {

/// Steps of 10 ms; times count from the first.
struct Clock {
    StepClock clock{100.0};
    StepClock::Time start{1h};
    Clock() { clock.begin(start); }
    int at(StepClock::Duration since) { return clock.due(start + since); }
};

}  // namespace

TEST_CASE("step clock: the first step is due at once, and the next ones a step's length apart, however unevenly it is asked") {
    Clock c;
    CHECK(c.at(0ms) == 1);
    CHECK(c.at(1ms) == 0);
    CHECK(c.at(9999us) == 0);
    CHECK(c.at(10ms) == 1);
    CHECK(c.at(27ms) == 1);
    CHECK(c.at(30ms) == 1);
    CHECK(c.clock.next() == c.start + 40ms);
    CHECK(c.clock.leftOut() == 0.0);
}

TEST_CASE("step clock: up to four steps that are late are made up for") {
    Clock c;
    CHECK(c.at(0ms) == 1);
    CHECK(c.at(40ms) == 4);
    CHECK(c.at(49ms) == 0);
    CHECK(c.at(50ms) == 1);
    CHECK(c.clock.leftOut() == 0.0);
}

TEST_CASE("step clock: what is later still is left out, and said; steps stay on their grid") {
    Clock c;
    CHECK(c.at(0ms) == 1);
    CHECK(c.at(1005ms) == StepClock::kMostAtOnce);  // 100 were due
    CHECK(c.clock.leftOut() == doctest::Approx(0.96));
    CHECK(c.at(1009ms) == 0);
    CHECK(c.at(1010ms) == 1);
}

TEST_CASE("step clock: steps that were not made after all are due again") {
    Clock c;
    CHECK(c.at(0ms) == 1);
    CHECK(c.at(45ms) == 4);
    c.clock.putBack(3);
    CHECK(c.clock.next() == c.start + 20ms);
    CHECK(c.at(49ms) == 3);
    c.clock.putBack(2);
    CHECK(c.at(1005ms) == StepClock::kMostAtOnce);
    CHECK(c.clock.leftOut() == doctest::Approx(0.94));
}

TEST_CASE("step thread: steps that take longer than their time are said to be left out, also where somebody parks it after each") {
    std::atomic<int> steps{0};
    StepThread thread([&](double, double) {
        std::this_thread::sleep_for(30ms);
        ++steps;
        return 0.0;
    });
    const auto start = std::chrono::steady_clock::now();
    const auto passed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
    double before = 0.0;  // the last step, whose time is not over
    for (int i = 0; i < 30; ++i) {
        before = passed();
        const int made = steps;
        thread.run(100.0);
        while (steps == made) std::this_thread::sleep_for(1ms);
        thread.park();
    }
    MESSAGE(steps.load() << " steps of 10 ms in " << before << " to " << passed() << " s, " << thread.leftOut() << " s left out");
    // All that passed was stepped or left out, but for the few that are still due.
    const double known = 0.01 * steps + thread.leftOut();
    CHECK(known >= before - 0.01 * StepClock::kMostAtOnce);
    CHECK(known <= passed() + 0.01 * StepClock::kMostAtOnce);
}

TEST_CASE("step clock: after a rest it begins anew") {
    Clock c;
    CHECK(c.at(0ms) == 1);
    c.start += 1h;
    c.clock.begin(c.start);
    CHECK(c.at(0ms) == 1);
    CHECK(c.at(5ms) == 0);
    CHECK(c.clock.leftOut() == 0.0);
}

TEST_CASE("step thread: it sleeps for as long as a step says, counts that, is woken by anybody, and is not woken while it is parked") {
    std::atomic<int> steps{0};
    std::atomic<double> sleep{0.0}, slept{-1.0};
    StepThread thread([&](double, double before) {
        ++steps;
        slept = before;
        return sleep.load();
    });
    const auto until = [](auto done) {
        for (const auto start = std::chrono::steady_clock::now(); std::chrono::steady_clock::now() - start < 60s; std::this_thread::sleep_for(1ms))
            if (done()) return true;
        return false;
    };
    thread.run(100.0);
    CHECK(until([&] { return steps > 5; }));
    CHECK(slept == 0.0);
    sleep = 0.5;
    int made = steps;
    CHECK(until([&] { return steps > made && slept > 0.4; }));  // by itself
    CHECK(slept >= 0.49 - 1e-6);                                // less the step that is made
    sleep = StepThread::kUntilWoken;
    thread.wake();
    made = -1;
    CHECK(until([&] { return made == std::exchange(made, steps.load()) && steps > 8; }));
    std::this_thread::sleep_for(300ms);
    made = steps;
    std::this_thread::sleep_for(300ms);
    CHECK(steps == made);
    thread.wake();
    CHECK(until([&] { return steps == made + 1; }));
    CHECK(slept >= 0.28);
    thread.park();
    thread.wake();
    std::this_thread::sleep_for(100ms);
    CHECK(steps == made + 1);
    // Woken while it was parked: it does not go to sleep again over it.
    thread.run(100.0, StepThread::kUntilWoken);
    CHECK(until([&] { return steps == made + 2; }));
    thread.park();
    // Whoever is put to sleep goes on sleeping, and its time counts from its last step on.
    thread.run(100.0, 0.4);
    CHECK(until([&] { return steps == made + 3; }));
    CHECK(slept >= 0.38);
}
