// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "core/touch/flesh_contact.h"
#include "tests/support/allocations.h"
#include "tests/touch/bodies.h"

using namespace imomushi;
using namespace imomushi::touching;

namespace {

/// Bodies that stand where they are put.
class Stands : public FleshContact::Posed {
public:
    struct Place {
        const Touched* body;
        Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
        Vec3 shift = Vec3::Zero();
    };
    explicit Stands(std::vector<Place> given) : places(std::move(given)) {}
    [[nodiscard]] Vec3 at(std::size_t body, std::int32_t vertex) const override {
        const auto& p = places[body];
        return p.axes * p.body->mesh.vertices.row(vertex).transpose() + p.shift;
    }
    [[nodiscard]] const Eigen::Matrix3d& axes(std::size_t body) const override { return places[body].axes; }

    [[nodiscard]] FleshContact contact(const std::vector<double>& shear = {}) const {
        std::vector<FleshContact::Body> bodies;
        for (std::size_t i = 0; i < places.size(); ++i) {
            const Touched& body = *places[i].body;
            const ElementMesh mesh{body.mesh, {}};
            bodies.push_back({std::make_shared<const ContactSurface>(mesh, TouchSurface::build(mesh, body.faces, body.response).value()), shear.empty() ? 1.0 : shear[i]});
        }
        return FleshContact(std::move(bodies));
    }
    /// World, with dents.
    [[nodiscard]] Points dented(const FleshContact& contact, std::size_t body) const {
        const auto& p = places[body];
        const Eigen::VectorXd u = p.body->response->touch.displacement.cast<double>() * contact.patchForces(body);
        Points out = p.body->mesh.vertices;
        for (std::size_t i = 0; i < p.body->response->freeVertices.size(); ++i)
            out.row(p.body->response->freeVertices[i]) += u.segment<3>(3 * static_cast<Eigen::Index>(i)).transpose();
        return (out * p.axes.transpose()).rowwise() + p.shift.transpose();
    }
    std::vector<Place> places;
};

const Eigen::Matrix3d kUpsideDown = Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitX()).toRotationMatrix();
const FleshContact::Near kBoth{{{0, 1}}, {}};
const Plane kFloor = Plane::through(Vec3::Zero(), Vec3::UnitZ()).value();  // the bodies here stand along z

/// The upper half of a sphere of radius 1, held below: it does not sway.
const Touched& dome() {
    static const Touched out = [] {
        auto body = shapes::sphere(1.0, 3);
        body.ends.push_back(shapes::patchWhere(body.mesh, [](const Vec3& p) { return p.z() < 0.05; }));
        return precompute(inputOf(body.mesh, body.ends, 48));
    }();
    return out;
}

/// Two spheres of radius 1, pole to pole, `depth` into each other.
Stands poles(double depth) { return Stands({{&ball()}, {&ball(), kUpsideDown, Vec3(0, 0, 2.0 - depth)}}); }

}  // namespace

TEST_CASE("flesh contact: what presses is pressed as much, along the axis, the more the deeper, and not at all when apart") {
    Stands stands = poles(0.0);
    FleshContact contact = stands.contact();
    double before = 0.0;
    for (const double depth : {0.01, 0.02, 0.05, 0.1, 0.2, 0.3}) {
        CAPTURE(depth);
        stands.places[1].shift.z() = 2.0 - depth;
        for (int i = 0; i < 5; ++i) contact.step(stands, kBoth, {}, true);
        CHECK(contact.converged());
        const Vec3 force = contact.force(1);
        CHECK((force + contact.force(0)).norm() <= 1e-9 * force.norm());
        CHECK(force.head<2>().norm() <= 0.06 * force.z());  // its patches are no rings
        CHECK(force.z() > 1.05 * before);
        before = force.z();
    }
    stands.places[1].shift.z() = 2.5;
    contact.step(stands, kBoth, {}, false);
    CHECK(contact.idle());
    CHECK(contact.patchForces(0).isZero(0.0));
}

TEST_CASE("flesh contact: equal spheres meet in the plane between them") {
    for (const double depth : {0.05, 0.1, 0.2}) {
        CAPTURE(depth);
        const Stands stands = poles(depth);
        FleshContact contact = stands.contact();
        contact.step(stands, kBoth, {}, true);
        const double plane = 1.0 - 0.5 * depth;
        CHECK(stands.dented(contact, 0).col(2).maxCoeff() <= plane + 0.1 * depth);
        CHECK(stands.dented(contact, 1).col(2).minCoeff() >= plane - 0.1 * depth);
        CHECK(stands.dented(contact, 0).col(2).maxCoeff() >= plane - 0.1 * depth);
    }
}

TEST_CASE("flesh contact: of a soft and a stiff body the soft one gives way") {
    const double depth = 0.1;
    const Stands stands = poles(depth);
    FleshContact contact = stands.contact({1.0, 20.0});
    contact.step(stands, kBoth, {}, true);
    const double soft = 1.0 - stands.dented(contact, 0).col(2).maxCoeff(), stiff = stands.dented(contact, 1).col(2).minCoeff() - (1.0 - depth);
    CHECK(soft == doctest::Approx(depth).epsilon(0.15));
    CHECK(stiff / soft == doctest::Approx(1.0 / 20.0).epsilon(0.3));
}

TEST_CASE("flesh contact: friction holds up to its cone and is the same at any rate of frames") {
    const auto slid = [&](double friction, double way, int steps) {
        Stands stands({{&dome()}, {&dome(), kUpsideDown, Vec3(0, 0, 1.9)}});
        FleshContact contact = stands.contact();
        contact.step(stands, kBoth, {.friction = friction}, true);
        for (int i = 1; i <= steps; ++i) {
            stands.places[1].shift.x() = way * i / steps;
            contact.step(stands, kBoth, {.friction = friction}, false);
        }
        return contact.force(1);
    };
    // What friction does: without it, the slope of the other surface pushes.
    const auto held = [&](double friction, double way, int steps) -> double { return slid(0.0, way, steps).x() - slid(friction, way, steps).x(); };
    const double stuck = held(1.0, 0.005, 30), farther = held(1.0, 0.01, 30), slips = held(0.2, 0.15, 60), normal = slid(0.2, 0.15, 60).z();
    CHECK(stuck > 0.0);
    CHECK(farther / stuck == doctest::Approx(2.0).epsilon(0.1));
    CHECK(slips / normal == doctest::Approx(0.2).epsilon(0.2));
    for (const int steps : {30, 144}) {
        CHECK(held(1.0, 0.01, steps) == doctest::Approx(farther).epsilon(0.02));
        CHECK(held(0.2, 0.15, steps) == doctest::Approx(slips).epsilon(0.02));
    }
}

TEST_CASE("flesh contact: what touches at rest does not press") {
    const Touched& low = segment();
    Touched high = low;
    high.mesh.vertices.col(0).array() += 1.0;  // side by side, in one line of points
    Stands stands({{&low}, {&high}});
    FleshContact contact = stands.contact();
    contact.step(stands, kBoth, {}, true);
    CHECK(contact.idle());
    CHECK(contact.restClearance(0, 1) <= 1.0);
}

TEST_CASE("flesh contact: a step does not allocate, and the same steps give the same bytes") {
    Stands stands = poles(0.0);
    FleshContact one = stands.contact(), other = stands.contact();
    for (int i = 0; i < 40; ++i) {
        stands.places[1].shift = Vec3(0.002 * i, 0.001 * i, 2.02 - 0.006 * i);
        const std::size_t before = allocations();
        one.step(stands, kBoth, {}, i == 20);
        REQUIRE(allocations() == before);
        other.step(stands, kBoth, {}, i == 20);
        REQUIRE(one.patchForces(0) == other.patchForces(0));
        REQUIRE(one.patchForces(1) == other.patchForces(1));
        REQUIRE(one.patchForces(0).allFinite());
    }
    CHECK_FALSE(one.idle());
}

TEST_CASE("flesh contact: stays finite and bounded in any place") {
    Stands stands = poles(0.0);
    FleshContact contact = stands.contact();
    std::mt19937 random(7);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    for (int i = 0; i < 300; ++i) {
        stands.places[1].shift = Vec3(number(random), number(random), 1.5 + number(random));
        stands.places[1].axes = Eigen::Quaterniond(number(random), number(random), number(random), number(random)).normalized().toRotationMatrix();
        contact.step(stands, kBoth, {.friction = i % 3 * 0.5}, i % 10 == 0);
        for (const std::size_t body : {0, 1}) {
            REQUIRE(contact.patchForces(body).allFinite());
            const Eigen::VectorXd gradients = ball().response->touch.gradients.cast<double>() * contact.patchForces(body);
            double most = 0.0;
            for (Eigen::Index k = 0; k < gradients.size(); k += 9) most = std::max(most, gradients.segment<9>(k).norm());
            REQUIRE(most <= FleshContact::Settings().mostStrain * (1.0 + 1e-6));
        }
    }
}

TEST_CASE("flesh contact: the ground holds flesh like the plane between two equal bodies, and drags it along its cone") {
    const double depth = 0.1;
    const Stands both = poles(2.0 * depth), alone({{&ball(), kUpsideDown, Vec3(0, 0, 1.0 - depth)}});
    FleshContact pressed = both.contact(), grounded = alone.contact();
    pressed.step(both, kBoth, {}, true);
    grounded.step(alone, {{}, {0}}, {.ground = kFloor}, true);
    CHECK(grounded.force(0).z() == doctest::Approx(pressed.force(1).z()).epsilon(0.05));
    CHECK(alone.dented(grounded, 0).col(2).minCoeff() >= -0.1 * depth);

    Stands moving({{&dome(), kUpsideDown, Vec3(0, 0, 1.0 - depth)}});
    FleshContact dragged = moving.contact();
    const FleshContact::Settings settings{.ground = kFloor, .groundFriction = 0.2};
    dragged.step(moving, {{}, {0}}, settings, true);
    const double before = dragged.force(0).x();
    for (int i = 1; i <= 60; ++i) {
        moving.places[0].shift.x() = 0.2 * i / 60;
        dragged.step(moving, {{}, {0}}, settings, false);
    }
    CHECK(dragged.force(0).x() - before == doctest::Approx(-0.2 * dragged.force(0).z()).epsilon(0.1));
}

TEST_CASE("flesh contact: a turned scene, its ground too, has the turned answer") {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    struct Scene {
        Stands stands{{{&ball(), kUpsideDown, Vec3(0, 0, 0.93)}, {&ball(), Eigen::Matrix3d::Identity(), Vec3(0.05, 0, 2.8)}}};
        FleshContact contact = stands.contact();
        FleshContact::Settings settings{.ground = kFloor};
    } straight;
    const auto press = [](Scene& scene, const Eigen::Matrix3d& turn, const Vec3& shift) {
        for (int i = 0; i < 8; ++i) {
            Stands now = scene.stands;
            for (auto& place : now.places) {
                place.shift = turn * (place.shift + 0.01 * i * Vec3(0.3, 0.1, -1.0)) + shift;
                place.axes = turn * place.axes;
            }
            scene.contact.step(now, {{{0, 1}}, {0}}, scene.settings, i == 0);
        }
    };
    press(straight, Eigen::Matrix3d::Identity(), Vec3::Zero());
    REQUIRE(straight.contact.force(0).z() > 0.0);
    for (int i = 0; i < 6; ++i) {
        const Eigen::Matrix3d turn = Eigen::Quaterniond(number(random), number(random), number(random), number(random)).normalized().toRotationMatrix();
        const Vec3 shift(5.0 * number(random), 5.0 * number(random), 5.0 * number(random));
        Scene turned;
        turned.settings.ground = Plane::through(shift, turn * Vec3::UnitZ()).value();
        press(turned, turn, shift);
        for (const std::size_t body : {0, 1}) {
            // Products are kept in single precision, and the sweeps stop where nothing moves by more than a part of 1e-5.
            const double size = straight.contact.patchForces(body).norm();
            CHECK((turned.contact.patchForces(body) - straight.contact.patchForces(body)).norm() <= 1e-3 * size);
            CHECK((turned.contact.force(body) - turn * straight.contact.force(body)).norm() <= 1e-3 * straight.contact.force(body).norm());
        }
    }
}

TEST_CASE("flesh contact: what has settled sleeps, byte for byte, until one that it hangs together with moves or goes") {
    // Two pairs of balls, far from each other, and one that lies on the ground.
    Stands stands({{&ball()}, {&ball(), kUpsideDown, Vec3(0, 0, 1.9)}, {&ball(), Eigen::Matrix3d::Identity(), Vec3(9, 0, 0)}, {&ball(), kUpsideDown, Vec3(9, 0, 1.9)}, {&ball(), kUpsideDown, Vec3(20, 0, 0.9)}});
    FleshContact contact = stands.contact();
    const FleshContact::Settings settings{.ground = kFloor};
    const FleshContact::Near near{{{0, 1}, {2, 3}}, {4}};
    std::vector<char> moved(5, 0);
    const auto asleep = [&] {
        std::vector<bool> out;
        for (std::size_t b = 0; b < 5; ++b) out.push_back(contact.asleep(b));
        return out;
    };
    contact.step(stands, near, settings, true);
    for (int i = 0; i < 20 && asleep() != std::vector<bool>(5, true); ++i) {
        contact.begin(near, settings, moved);
        contact.finish(stands, false);
    }
    REQUIRE(asleep() == std::vector<bool>(5, true));
    std::vector<Eigen::VectorXd> before;
    for (std::size_t b = 0; b < 5; ++b) before.push_back(contact.patchForces(b));
    const auto same = [&](std::size_t b) { return contact.patchForces(b) == before[b]; };
    for (int i = 0; i < 3; ++i) {
        contact.begin(near, settings, moved);
        contact.finish(stands, i == 1);
        for (std::size_t b = 0; b < 5; ++b) CHECK(same(b));
    }

    stands.places[1].shift.z() -= 0.02;
    moved[1] = 1;
    contact.begin(near, settings, moved);
    CHECK(asleep() == std::vector<bool>{false, false, true, true, true});
    contact.finish(stands, false);
    CHECK_FALSE(same(0));
    CHECK_FALSE(same(1));
    for (const std::size_t b : {2, 3, 4}) CHECK(same(b));

    // The other pair parts: who stays behind is no longer pressed.
    stands.places[3].shift.z() += 5.0;
    moved = {0, 0, 0, 1, 0};
    contact.begin({{{0, 1}}, {4}}, settings, moved);
    contact.finish(stands, false);
    CHECK(contact.patchForces(2).isZero(0.0));
    CHECK(contact.patchForces(3).isZero(0.0));
    CHECK(same(4));

    // Other numbers wake everybody.
    moved.assign(5, 0);
    contact.begin({{{0, 1}}, {4}}, {.friction = 0.1, .ground = kFloor}, moved);
    CHECK(asleep() == std::vector<bool>(5, false));
}

TEST_CASE("flesh contact: more contacts than are solved are said, and each body keeps its deepest ones") {
    // Both are in the ground as a whole, and meet each other a little.
    Stands stands({{&ball(), kUpsideDown, Vec3(-0.99, 0, -1.2)}, {&ball(), kUpsideDown, Vec3(0.99, 0, -1.2)}});
    FleshContact contact = stands.contact();
    const FleshContact::Near near{{{0, 1}}, {0, 1}};
    contact.step(stands, near, {.ground = kFloor}, true);
    CHECK(contact.bounded());
    CHECK(contact.force(0).z() > 0.0);
    // The two are mirror images but for their patches: none is held less for having been looked at later.
    CHECK(contact.force(1).z() == doctest::Approx(contact.force(0).z()).epsilon(0.1));
    for (auto& place : stands.places) place.shift.z() = 0.95;
    contact.step(stands, near, {.ground = kFloor}, true);
    CHECK_FALSE(contact.bounded());
}

TEST_CASE("flesh contact: clearances at rest are those of all samples, or less where surfaces are far apart") {
    const Touched& low = segment();
    for (const double apart : {0.0, 0.3, 0.9, 6.0}) {
        CAPTURE(apart);
        Touched high = low;
        high.mesh.vertices.col(2).array() += 1.0 + apart;
        const Stands stands({{&low}, {&high}});
        const FleshContact contact = stands.contact();
        const auto surface = [](const Touched& of) {
            const ElementMesh mesh{of.mesh, {}};
            return ContactSurface(mesh, TouchSurface::build(mesh, of.faces, of.response).value());
        };
        const ContactSurface a = surface(low), b = surface(high);
        // Opposed after a turn of .5 and as much strain.
        const double turned = std::cos(std::acos(-0.1) - 1.0);
        double least = 1e9;
        for (std::size_t i = 0; i < a.samples(); ++i)
            for (std::size_t k = 0; k < b.samples(); ++k)
                if (a.surface().normal(a.vertex(i)).dot(b.surface().normal(b.vertex(k))) < turned) least = std::min(least, (a.surface().vertex(a.vertex(i)) - b.surface().vertex(b.vertex(k))).norm());
        CHECK(contact.restClearance(0, 1) <= least);
        if (apart < 0.5) CHECK(contact.restClearance(0, 1) == least);
        if (apart > 5.0) CHECK(contact.restClearance(0, 1) >= apart);
    }
}
