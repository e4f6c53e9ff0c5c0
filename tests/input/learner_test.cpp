// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <cmath>

#include "core/input/control_learner.h"
#include "tests/support/input_values.h"

using namespace imomushi;

namespace {

constexpr std::int64_t kMs = 1'000'000;

InputValue at(std::int64_t milliseconds, const std::string& channel, std::initializer_list<double> numbers, const std::string& source = "osc") {
    InputValue value = valueOf(source, channel, numbers);
    value.nanoseconds = milliseconds * kMs;
    return value;
}

}  // namespace

TEST_CASE("learner: among a thousand numbers that tremble the one that is moved is found, with the range that it usually has") {
    ControlLearner learner;
    for (int t = 0; t < 2000; t += 16)
        for (int i = 0; i < 100; ++i) {
            const double tremble = 0.004 * std::sin(0.1 * t + i);
            learner.hear(at(t, "/noise/" + std::to_string(i), {0.3 + tremble, tremble, -5.0 + tremble}));
            if (i == 7) learner.hear(at(t, "/fader", {tremble, t < 1000 ? 0.1 : 0.1 + 0.8 * std::min(1.0, (t - 1000) / 500.0)}));
        }
    const auto found = learner.found(2000 * kMs);
    REQUIRE(found);
    CHECK(found->source == "osc");
    CHECK(found->channel == "/fader");
    CHECK(found->component == 1);
    CHECK(found->low == 0.0);
    CHECK(found->high == 1.0);
    CHECK(found->now == doctest::Approx(0.9));
    CHECK(!found->settled);
    // When its range has not grown for a while, it is meant.
    CHECK(learner.found(2600 * kMs)->settled);
}

TEST_CASE("learner: nothing that stands still is found; a small motion is no meant one") {
    ControlLearner learner;
    CHECK(!learner.found(0));
    for (int t = 0; t < 1000; t += 16) learner.hear(at(t, "/still", {0.5, 12.0, -3.0}));
    CHECK(!learner.found(5000 * kMs));
    learner.hear(at(1000, "/still", {0.58, 12.0, -3.0}));
    const auto found = learner.found(5000 * kMs);
    REQUIRE(found);
    CHECK(!found->settled);
    CHECK(found->low == doctest::Approx(0.5));
    CHECK(found->high == doctest::Approx(0.58));
}

TEST_CASE("learner: a button that only says that it is pressed goes from 0 to that; what is sent all the time is no button") {
    ControlLearner learner;
    learner.hear(at(0, "/always", {1.0}));
    learner.hear(at(300, "/too", {1.0}));
    CHECK(!learner.found(1000 * kMs));
    learner.hear(at(900, "/press", {127.0}));
    const auto found = learner.found(2000 * kMs);
    REQUIRE(found);
    CHECK(found->channel == "/press");
    CHECK(found->low == 0.0);
    CHECK(found->high == 127.0);
    CHECK(found->settled);
}

TEST_CASE("learner: of a rotation that is told twice, the rotation vector is found; what is not finite is nothing") {
    ControlLearner learner;
    for (int t = 0; t < 1000; t += 16) {
        const double turn = 0.0012 * t;
        learner.hear(at(t, "bone/LeftUpperArm", {0, 0, 0, std::sin(turn / 2), 0, 0, std::cos(turn / 2), turn, 0, 0}, "vmc"));
        learner.hear(at(t, "/broken", {t % 32 == 0 ? std::nan("") : 1e300}));
    }
    const auto found = learner.found(3000 * kMs);
    REQUIRE(found);
    CHECK(found->source == "vmc");
    CHECK(found->component == 7);
    CHECK(found->high == doctest::Approx(0.0012 * 992));
}

TEST_CASE("learner: of a key and the stick that it is part of the key is meant, both keys of a direction are the stick") {
    const auto press = [](ControlLearner& learner, std::int64_t ms, double up, double down) {
        learner.hear(at(ms, "up", {up}, "keys"));
        learner.hear(at(ms, "arrows", {0.0, up - down}, "keys"));
    };
    ControlLearner one;
    press(one, 0, 1.0, 0.0);
    press(one, 300, 0.0, 0.0);
    REQUIRE(one.found(300 * kMs));
    CHECK(one.found(300 * kMs)->channel == "up");
    ControlLearner both;
    press(both, 0, 1.0, 0.0);
    press(both, 200, 0.0, 0.0);
    press(both, 400, 0.0, 1.0);
    const auto found = both.found(400 * kMs);
    REQUIRE(found);
    CHECK(found->channel == "arrows");
    CHECK(found->component == 1);
    CHECK(found->low == -1.0);
    CHECK(found->high == 1.0);
}
