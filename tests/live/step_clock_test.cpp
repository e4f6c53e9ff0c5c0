// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include "core/live/step_clock.h"

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

TEST_CASE("step clock: after a rest it begins anew") {
    Clock c;
    CHECK(c.at(0ms) == 1);
    c.start += 1h;
    c.clock.begin(c.start);
    CHECK(c.at(0ms) == 1);
    CHECK(c.at(5ms) == 0);
    CHECK(c.clock.leftOut() == 0.0);
}
