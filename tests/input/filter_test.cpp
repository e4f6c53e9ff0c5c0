// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/input/one_euro_filter.h"
#include "core/input/response_curve.h"
#include "core/input/spring_filter.h"

using namespace imomushi;

TEST_CASE("response curve: a stick rests in its dead zone, and its ends reach the ends of the target whatever the curve") {
    ResponseCurve c{-1.0, 1.0, -0.2, 0.4, 2.0, 0.1};
    CHECK(c.at(0.0) == doctest::Approx(0.1));
    CHECK(c.at(0.09) == doctest::Approx(0.1));
    CHECK(c.at(1.0) == doctest::Approx(0.4));
    CHECK(c.at(-5.0) == doctest::Approx(-0.2));
    CHECK(c.at(0.55) == doctest::Approx(0.1 + 0.3 * 0.25));
    std::swap(c.outLow, c.outHigh);
    CHECK(c.at(1.0) == doctest::Approx(-0.2));
    const ResponseCurve straight{0.0, 127.0, 0.0, 1.0};
    CHECK(straight.at(63.5) == doctest::Approx(0.5));
}

TEST_CASE("one-euro filter: noise of what stands still becomes small, and what moves fast is followed closer") {
    const OneEuro calm{1.0, 0.0}, quick{1.0, 1.0};
    FilteredNumber still, slow, fast;
    double largest = 0.0;
    for (int i = 0; i < 600; ++i) {
        const double now = still.follow(i % 2 ? 0.01 : -0.01, 1.0 / 60.0, calm);
        if (i > 60) largest = std::max(largest, std::abs(now));
        slow.follow(i / 60.0, 1.0 / 60.0, calm);
        fast.follow(i / 60.0, 1.0 / 60.0, quick);
    }
    CHECK(largest < 0.001);
    // Behind a ramp of 1 per second a low pass is late by its time constant.
    const double late = 599 / 60.0 - slow.follow(599 / 60.0, 1e-9, calm);
    CHECK(late == doctest::Approx(calm.delay()).epsilon(0.01));
    CHECK(599 / 60.0 - fast.follow(599 / 60.0, 1e-9, quick) < 0.6 * late);
    FilteredRotation turn;
    turn.restart(Eigen::Quaterniond::Identity());
    const Eigen::Quaterniond goal(Eigen::AngleAxisd(1.0, Vec3::UnitX()));
    Eigen::Quaterniond at = Eigen::Quaterniond::Identity();
    for (int i = 0; i < 300; ++i) at = turn.follow(Eigen::Quaterniond(-goal.coeffs()), 1.0 / 60.0, calm);  // the same rotation
    CHECK(at.angularDistance(goal) < 1e-6);
}

TEST_CASE("spring: it swings beyond by what its damping lets it, comes to rest exactly, and steps of any length agree") {
    const Spring spring{2.0, 0.4};
    SprungNumber fine, coarse;
    double highest = 0.0, apart = 0.0;
    for (int i = 1; i <= 1200; ++i) {
        const double now = fine.follow(1.0, 1.0 / 240.0, spring);
        highest = std::max(highest, now);
        if (i % 4 == 0) apart = std::max(apart, std::abs(now - coarse.follow(1.0, 1.0 / 60.0, spring)));
    }
    CHECK(highest == doctest::Approx(1.0 + std::exp(-0.4 * std::numbers::pi / std::sqrt(1.0 - 0.16))).epsilon(1e-3));
    CHECK(apart < 1e-6);  // both come to rest within 1e-7
    CHECK(fine.follow(1.0, 1.0 / 240.0, spring) == 1.0);
    SprungNumber calm;
    double before = 0.0;
    for (int i = 0; i < 600; ++i) {
        const double now = calm.follow(1.0, 1.0 / 60.0, {1.0, 1.0});
        CHECK(now >= before);
        CHECK(now <= 1.0);
        before = now;
    }
    CHECK(before == 1.0);
    // A step of a second is as stable as any.
    SprungNumber late;
    for (int i = 0; i < 100; ++i) CHECK(std::abs(late.follow(1.0, 1.0, {20.0, 0.05})) < 2.1);
}
