// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "core/mesh/topology.h"
#include "core/touch/touch_blocks.h"
#include "tests/support/allocations.h"
#include "tests/touch/bodies.h"

using namespace imomushi;
using namespace imomushi::touching;

namespace {

constexpr double kFrame = 1.0 / 60.0;

Vec3 normalAt(const Touched& body, const TouchContact::Point& p) { return areaVector(body.mesh, p.triangle).normalized(); }

/// Pushes finger i, down at `p`, `depth` straight in and `along` besides, the element at rest.
void push(const Touched& body, TouchContact& contact, int i, double depth, const Vec3& along = Vec3::Zero()) {
    TouchContact::Point p;
    p.triangle = contact.triangle(i);
    p.barycentric = Vec3::Constant(1.0 / 3.0);
    const Vec3 target = body.at(p, body.mesh.vertices) - depth * normalAt(body, p) + along;
    REQUIRE(contact.aim(i, body.corners(p.triangle), target));
}

/// A finger in the middle of the triangle nearest to a place.
TouchContact::Point put(TouchContact& contact, int i, const Vec3& place, double radius = 0.0) {
    auto p = contact.nearest(place);
    p.barycentric = Vec3::Constant(1.0 / 3.0);
    REQUIRE(contact.place(i, p, radius));
    return p;
}

}  // namespace

TEST_CASE("touch: the pressed point meets its target") {
    for (const auto& [name, body] : all()) {
        CAPTURE(name);
        TouchContact contact = body->contact();
        const Vec3 place = name == "segment" ? Vec3(0.5, 0.0, 0.5) : name == "fin" ? Vec3(0.1, 0.04, 0.9) : Vec3(0.3, 0.4, 0.86);
        const auto p = put(contact, 0, place);
        for (const double depth : {0.01, 0.02, 0.03}) {
            push(*body, contact, 0, depth * body->size(), 0.3 * depth * body->size() * Vec3(0.1, 0.0, 0.2));
            contact.settle();
            CHECK(contact.state(0) == TouchContact::State::Sticks);
            CHECK_FALSE(contact.clamped(0));
            const Vec3 target = body->at(p, body->mesh.vertices) - depth * body->size() * normalAt(*body, p) + 0.3 * depth * body->size() * Vec3(0.1, 0.0, 0.2);
            const Points moved = body->mesh.vertices + body->displacement(contact);
            CHECK((body->at(p, moved) - target).norm() <= 1e-6 * body->size());
        }
    }
}

TEST_CASE("touch: a finger that pulls does nothing at all") {
    for (const auto& [name, body] : all()) {
        CAPTURE(name);
        TouchContact contact = body->contact();
        put(contact, 0, Vec3(0.2, 0.5, 0.6));
        for (const double depth : {0.0, -0.01, -0.3}) {
            push(*body, contact, 0, depth * body->size(), depth < 0.0 ? Vec3(0.001, 0.002, 0.0) : Vec3::Zero());
            contact.step(kFrame);
            CHECK(contact.idle());
            CHECK(contact.patchForces().isZero(0.0));
            CHECK(contact.state(0) == TouchContact::State::Outside);
        }
        CHECK(contact.revision() == 0);
    }
}
