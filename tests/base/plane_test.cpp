// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/base/plane.h"

#include <doctest/doctest.h>

#include <limits>

using namespace imomushi;

TEST_CASE("plane: heights count from its origin along its normal, whatever the length of what it was made of") {
    for (const double length : {1e-300, 1.0, 1e300}) {
        const Plane plane = Plane::through(Vec3(1, 2, 3), length * Vec3(0.0, 0.6, 0.8)).value();
        CHECK(plane.normal().norm() == doctest::Approx(1.0));
        CHECK(plane.height(Vec3(-7, 2.6, 3.8)) == doctest::Approx(1.0));
        CHECK(plane.height(Vec3(1, 2, 3)) == 0.0);
        CHECK(std::abs(plane.along(Vec3(1, 2, 3)).dot(plane.normal())) <= 1e-15);
    }
    CHECK(Plane::level(-2.0).height(Vec3(5, 1, 5)) == 3.0);
}

TEST_CASE("plane: without a place or a direction there is none") {
    const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
    for (const double bad : {inf, -inf, nan}) {
        CHECK(Plane::through(Vec3(0, bad, 0), Vec3::UnitY()).error().code == "bad-value");
        CHECK(Plane::through(Vec3::Zero(), Vec3(0, bad, 1)).error().code == "bad-value");
    }
    CHECK(Plane::through(Vec3::Zero(), Vec3::Zero()).error().code == "bad-value");
    CHECK(Plane::through(Vec3(2.0 * Plane::kFarthest, 0, 0), Vec3::UnitY()).error().code == "bad-value");
}
