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
    auto p = contact.surface().nearest(place);
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
            contact.converge();
            CHECK(contact.state(0) == TouchContact::State::Sticks);
            CHECK_FALSE(contact.clamped(0));
            const Vec3 target =
                body->at(p, body->mesh.vertices) - depth * body->size() * normalAt(*body, p) + 0.3 * depth * body->size() * Vec3(0.1, 0.0, 0.2);
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

TEST_CASE("touch: the frame adds the displacement to all vertices, and nothing where nobody touches") {
    const Touched& body = segment();
    std::vector<std::int32_t> first;
    for (std::int32_t v = 0; v < body.mesh.vertices.rows(); v += TouchBlocks::kBlock) first.push_back(v);
    first.push_back(5);  // blocks may overlap
    TouchBlocks blocks(*body.response, first);
    REQUIRE(blocks.count() == first.size());
    std::vector<float, Eigen::aligned_allocator<float>> local(first.size() * 3 * TouchBlocks::kBlock, 0.25f);
    TouchContact contact = body.contact();
    blocks.weigh(contact.patchForces());
    CHECK(blocks.idle());
    blocks.add(0, blocks.count(), local.data());
    CHECK(std::all_of(local.begin(), local.end(), [](float x) { return x == 0.25f; }));
    put(contact, 3, Vec3(0, 0.5, 0.4));
    push(body, contact, 3, 0.1);
    contact.converge();
    blocks.weigh(contact.patchForces());
    CHECK(blocks.activeColumns() <= 3 * 10);
    blocks.add(0, 7, local.data());
    blocks.add(7, blocks.count(), local.data());
    const Points u = body.displacement(contact);
    for (std::size_t b = 0; b < first.size(); ++b)
        for (int lane = 0; lane < TouchBlocks::kBlock; ++lane)
            for (int axis = 0; axis < 3; ++axis) {
                const std::int32_t v = first[b] + lane;
                const double expected = 0.25 + (v < u.rows() ? u(v, axis) : 0.0);
                CHECK(std::abs(static_cast<double>(
                                   local[(b * 3 + static_cast<std::size_t>(axis)) * TouchBlocks::kBlock + static_cast<std::size_t>(lane)]) -
                               expected) <= 1e-6);
            }
}

TEST_CASE("touch: the joints feel a finger") {
    const Touched& body = segment();
    TouchContact contact = body.contact();
    Eigen::VectorXd forces = Eigen::VectorXd::Zero(body.response->columns());
    contact.addJointForces(2.0, forces);
    CHECK(forces.isZero(0.0));
    put(contact, 0, Vec3(0.5, 0, 0.5));
    push(body, contact, 0, 0.05);
    contact.converge();
    contact.addJointForces(2.0, forces);
    CHECK((forces + 2.0 * body.response->touch.forces * contact.patchForces()).norm() <= 1e-15);
    CHECK(forces.norm() > 0.0);
}

TEST_CASE("touch: two fingers pinch from both sides, and many fingers all meet their targets") {
    const Touched& body = segment();
    TouchContact contact = body.contact();
    const auto a = put(contact, 0, Vec3(0.5, 0, 0.5)), b = put(contact, 1, Vec3(-0.5, 0, 0.5));
    for (const int i : {0, 1}) push(body, contact, i, 0.08);
    contact.converge();
    const Points moved = body.mesh.vertices + body.displacement(contact);
    const double before = (body.at(a, body.mesh.vertices) - body.at(b, body.mesh.vertices)).norm(),
                 after = (body.at(a, moved) - body.at(b, moved)).norm();
    CHECK(after == doctest::Approx(before - 0.16).epsilon(1e-3));
    CHECK(contact.force(0).x() < 0.0);
    CHECK(contact.force(1).x() > 0.0);
    CHECK(contact.force(0).norm() == doctest::Approx(contact.force(1).norm()).epsilon(0.1));
    // It gets wider across, as flesh that is pinched does.
    const auto side = contact.surface().nearest(Vec3(0, 0.5, 0.5));
    CHECK(body.at(side, moved).y() > body.at(side, body.mesh.vertices).y() + 0.005);

    TouchContact many = body.contact();
    std::vector<TouchContact::Point> points;
    for (int i = 0; i < 6; ++i) {
        points.push_back(put(many, i, Vec3(0.5 * std::cos(1.0472 * i), 0.5 * std::sin(1.0472 * i), i % 2 ? 0.3 : 0.7)));
        push(body, many, i, 0.02 + 0.003 * i);
    }
    many.converge();
    const Points all = body.mesh.vertices + body.displacement(many);
    for (int i = 0; i < 6; ++i) {
        CAPTURE(i);
        CHECK(many.state(i) == TouchContact::State::Sticks);
        const auto& p = points[static_cast<std::size_t>(i)];
        const Vec3 target = body.at(p, body.mesh.vertices) - (0.02 + 0.003 * i) * normalAt(body, p);
        CHECK((body.at(p, all) - target).norm() <= 1e-6 * body.size());
    }
}

TEST_CASE("touch: of two fingers at one place the deeper one pushes") {
    const Touched& body = ball();
    TouchContact one = body.contact(), two = body.contact();
    put(one, 0, Vec3(0, 0, 1));
    push(body, one, 0, 0.1);
    one.converge();
    for (const int i : {4, 9}) put(two, i, Vec3(0, 0, 1));
    push(body, two, 4, 0.05);
    push(body, two, 9, 0.1);
    two.converge();
    CHECK((two.patchForces() - one.patchForces()).norm() <= 1e-6 * one.patchForces().norm());
    // The same place and depth: they share the force.
    push(body, two, 4, 0.1);
    two.converge();
    CHECK((two.patchForces() - one.patchForces()).norm() <= 1e-6 * one.patchForces().norm());
}

TEST_CASE("touch: friction holds a finger within its cone, and without friction the force is straight in") {
    const Touched& body = ball();
    for (const double friction : {0.0, 0.3, 1.0, 10.0}) {
        CAPTURE(friction);
        TouchSettings settings;
        settings.friction = friction;
        TouchContact contact = body.contact(settings);
        const auto p = put(contact, 0, Vec3(0.2, 0.3, 1));
        const Vec3 n = normalAt(body, p);
        for (const double along : {0.0, 0.02, 0.3}) {
            push(body, contact, 0, 0.05, along * n.cross(Vec3::UnitX()).normalized());
            REQUIRE(contact.aim(0, -0.05 * n + along * n.cross(Vec3::UnitX()).normalized(), n));
            contact.converge();
            const double into = -contact.force(0).dot(n);
            CHECK(into > 0.0);
            CHECK((contact.force(0) + into * n).norm() <= (1.0 + 1e-9) * friction * into + 1e-15);
            // Slipping or not, it is as deep as asked for, unless the flesh gave way no further.
            if (!contact.clamped(0)) CHECK(-contact.displacement(0).dot(n) == doctest::Approx(0.05).epsilon(1e-5));
        }
    }
}

TEST_CASE("touch: a dent is smooth: deepest at the finger, and fading with the distance") {
    for (const Touched* body : {&ball(), &segment()}) {
        TouchContact contact = body->contact();
        const auto p = put(contact, 0, body == &ball() ? Vec3(0.1, 0.1, 1) : Vec3(0.5, 0, 0.5));
        push(*body, contact, 0, 0.1);
        contact.converge();
        const Vec3 at = body->at(p, body->mesh.vertices), n = normalAt(*body, p);
        const Points u = body->displacement(contact);
        const double reach = body->response->touch.patches.reach;
        std::array<double, 5> deepest{};  // by distance
        for (Eigen::Index v = 0; v < u.rows(); ++v) {
            const double distance = (Vec3(body->mesh.vertices.row(v).transpose()) - at).norm();
            double& depth = deepest[std::min<std::size_t>(4, static_cast<std::size_t>(distance / (0.4 * reach)))];
            depth = std::max(depth, -u.row(v).dot(n));
        }
        CHECK(u.rowwise().norm().maxCoeff() <= 0.11);
        CHECK(deepest[0] >= 0.1 - 1e-6);
        for (std::size_t i = 1; i < deepest.size(); ++i) CHECK(deepest[i] < deepest[i - 1]);
        CHECK(deepest[4] <= 0.7 * deepest[0]);  // the body as a whole gives way too
        // No edge is bent more sharply than the dent is deep over the width of a bump.
        const EdgeTable edges(body->mesh.triangles);
        double sharpest = 0.0;
        for (int e = 0; e < edges.size(); ++e) {
            const auto low = edges.uses(e)[0].low, high = edges.uses(e)[0].high;
            sharpest = std::max(sharpest, (u.row(low) - u.row(high)).norm() / (body->mesh.vertices.row(low) - body->mesh.vertices.row(high)).norm());
        }
        CHECK(sharpest <= 4.0 * 0.1 / reach);
    }
}

TEST_CASE("touch: however deep fingers go, no triangle turns over and no gradient passes its bound") {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> d(-1.0, 1.0);
    for (const auto& [name, body] : all()) {
        CAPTURE(name);
        TouchContact contact = body->contact();
        int clamped = 0;
        for (int scene = 0; scene < 60; ++scene) {
            contact.reset();
            const int fingers = 1 + scene % 5;
            for (int i = 0; i < fingers; ++i) {
                const auto p = put(contact, i, 2.0 * Vec3(d(random), d(random), d(random)), scene % 2 ? 0.0 : 0.3);
                REQUIRE(
                    contact.aim(i, -(scene % 3 ? 10.0 : 0.3) * normalAt(*body, p) + 0.2 * Vec3(d(random), d(random), d(random)), normalAt(*body, p)));
            }
            contact.converge();
            for (int i = 0; i < fingers; ++i) clamped += contact.clamped(i);
            const Eigen::VectorXd gradients = body->response->touch.gradients.cast<double>() * contact.patchForces();
            for (Eigen::Index i = 0; i < gradients.size(); i += 9) CHECK(gradients.segment<9>(i).norm() <= 0.7 * (1.0 + 1e-6));
            TriangleMesh moved = body->mesh;
            moved.vertices += body->displacement(contact);
            for (std::int32_t f = 0; f < moved.triangles.rows(); ++f) CHECK(areaVector(moved, f).dot(areaVector(body->mesh, f)) > 0.0);
        }
        CHECK(clamped > 20);
    }
}

TEST_CASE("touch: a lifted finger's dent goes back monotonically, at any frame rate alike, and all is at rest again") {
    const Touched& body = segment();
    const auto run = [&](double rate, std::vector<double>& depth) {
        TouchContact contact = body.contact();
        const auto p = put(contact, 0, Vec3(0.5, 0, 0.5));
        const Vec3 n = normalAt(body, p), at = body.at(p, body.mesh.vertices);
        push(body, contact, 0, 0.1);
        for (int i = 0; i < static_cast<int>(rate); ++i) contact.step(1.0 / rate);
        CHECK(-contact.displacement(0).dot(n) == doctest::Approx(0.1).epsilon(1e-6));
        contact.lift(0);
        double last = 0.1;
        for (int i = 1; i <= static_cast<int>(2.0 * rate); ++i) {
            contact.step(1.0 / rate);
            const double now = -(body.at(p, body.mesh.vertices + body.displacement(contact)) - at).dot(n);
            CHECK(now <= last);
            CHECK(now >= -1e-12);
            last = now;
            if (i % static_cast<int>(rate / 6.0) == 0) depth.push_back(now);
        }
        CHECK(contact.idle());
        CHECK(contact.patchForces().isZero(0.0));
        const auto revision = contact.revision();
        contact.step(1.0 / rate);
        CHECK(contact.revision() == revision);
    };
    std::vector<double> at30, at60, at144;
    run(30.0, at30);
    run(60.0, at60);
    run(144.0, at144);
    REQUIRE(at30.size() == at144.size());
    for (std::size_t i = 0; i < at30.size(); ++i) {
        CHECK(std::abs(at30[i] - at144[i]) <= 1e-9);
        CHECK(std::abs(at60[i] - at144[i]) <= 1e-9);
    }
    CHECK(at60[0] == doctest::Approx(0.1 * 0.0709).epsilon(0.01));  // (1 + x) exp(-x) at x = 3.8897 / 0.9: a sixth of a second of 0.15
}

TEST_CASE("touch: a finger that is put down deep comes in smoothly, at any frame rate alike") {
    const Touched& body = segment();
    std::vector<std::vector<double>> depth(3);
    for (std::size_t k = 0; k < 3; ++k) {
        const double rate = k == 0 ? 30.0 : k == 1 ? 60.0 : 150.0;
        TouchContact contact = body.contact();
        const auto p = put(contact, 0, Vec3(0.5, 0, 0.5));
        push(body, contact, 0, 0.1);
        double last = 0.0;
        for (int i = 1; i <= static_cast<int>(rate); ++i) {
            contact.step(1.0 / rate);
            const double now = -contact.displacement(0).dot(normalAt(body, p));
            CHECK(now >= last - 1e-12);
            last = now;
            if (i % static_cast<int>(rate / 30.0) == 0) depth[k].push_back(now);
        }
        CHECK(last == doctest::Approx(0.1).epsilon(1e-6));
    }
    CHECK(depth[0][0] < 0.09);
    CHECK(depth[0][1] > 0.09);
    for (const auto& other : {depth[1], depth[2]})
        for (std::size_t i = 0; i < depth[0].size(); ++i) CHECK(std::abs(other[i] - depth[0][i]) <= 1e-9);
}

TEST_CASE("touch: a finger that comes back into its own dent, or goes out and in, never makes the surface jump") {
    const Touched& body = ball();
    TouchContact contact = body.contact();
    const auto p = put(contact, 0, Vec3(0, 0.2, 1));
    const Vec3 n = normalAt(body, p), at = body.at(p, body.mesh.vertices);
    double last = 0.0;
    constexpr double kSmall = 1.0 / 240.0;
    for (int i = 0; i < 960; ++i) {
        if (i == 250) contact.lift(0);
        if (i == 262) REQUIRE(contact.place(0, p, 0.0));
        if (contact.down(0)) push(body, contact, 0, i > 500 && i < 520 ? -0.2 : 0.1);
        contact.step(kSmall);
        const double now = -(body.at(p, body.mesh.vertices + body.displacement(contact)) - at).dot(n);
        // The fastest it goes: omega / e of the way per second, omega = 3.89 / 0.05 s.
        CHECK(std::abs(now - last) <= 1.05 * 0.1 * 78.0 / 2.718 * kSmall);
        last = now;
    }
    CHECK(last == doctest::Approx(0.1).epsilon(1e-5));
}

TEST_CASE("touch: fingers follow the pose: a moved and turned element is touched as one at rest") {
    const Touched& body = ball();
    const Eigen::Matrix3d R = Eigen::AngleAxisd(0.8, Vec3(1, 1, -0.3).normalized()).toRotationMatrix();
    TouchContact still = body.contact(), turned = body.contact();
    const auto p = put(still, 0, Vec3(0.3, 0.2, 0.9));
    put(turned, 0, Vec3(0.3, 0.2, 0.9));
    auto corners = body.corners(p.triangle);
    const Vec3 target = body.at(p, body.mesh.vertices) + Vec3(0.01, -0.02, -0.1);
    REQUIRE(still.aim(0, corners, target));
    for (Vec3& corner : corners) corner = R * corner + Vec3(1, 2, 3);
    REQUIRE(turned.aim(0, corners, R * target + Vec3(1, 2, 3), R));
    still.converge();
    turned.converge();
    CHECK((still.patchForces() - turned.patchForces()).norm() <= 1e-10 * still.patchForces().norm());
}

TEST_CASE("touch: a wider finger presses more patches, softly wider") {
    const Touched& body = ball();
    TouchContact contact = body.contact();
    double lastSpread = 0.0;
    for (const double radius : {0.1, 0.5, 0.6, 0.9, 1.3}) {
        contact.reset();
        const auto p = put(contact, 0, Vec3(0, 0, 1), radius);
        push(body, contact, 0, 0.05);
        contact.converge();
        CHECK((contact.displacement(0) + 0.05 * normalAt(body, p)).norm() <= 1e-6);
        double spread = 0.0, sum = 0.0;
        for (Eigen::Index k = 0; k < contact.patchForces().size() / 3; ++k) {
            const double force = contact.patchForces().segment<3>(3 * k).norm();
            const Vec3 centre = body.mesh.vertices.row(body.response->touch.patches.centre[static_cast<std::size_t>(k)]).transpose();
            spread += force * (centre - body.at(p, body.mesh.vertices)).squaredNorm();
            sum += force;
        }
        CHECK(spread / sum >= lastSpread - 1e-12);
        lastSpread = spread / sum;
    }
    CHECK(contact.surface().narrowest() == doctest::Approx(0.5 * body.response->touch.patches.reach));
}

TEST_CASE("touch: what makes no sense is refused and changes nothing") {
    const Touched& body = shell();
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    TouchContact contact = body.contact();
    const auto p = contact.surface().nearest(Vec3(0, 0, 2));
    CHECK(p.distance == doctest::Approx(1.0).epsilon(0.02));
    CHECK(contact.surface().nearest(Vec3(nan, 0, 0)).triangle == -1);
    // From inside the cavity the outer surface is met, never the cavity's.
    CHECK(contact.surface().nearest(Vec3(0, 0, 0.6)).distance > 0.3);
    CHECK_FALSE(contact.place(-1, p, 0.0));
    CHECK_FALSE(contact.place(TouchContact::kFingers, p, 0.0));
    CHECK_FALSE(contact.place(0, p, -1.0));
    CHECK_FALSE(contact.place(0, p, nan));
    CHECK_FALSE(contact.place(0, {p.triangle, Vec3(nan, 0, 0), 0.0}, 0.0));
    CHECK_FALSE(contact.place(0, {p.triangle, Vec3(2, -1, 0), 0.0}, 0.0));
    CHECK_FALSE(contact.place(0, {-1, Vec3(1, 0, 0), 0.0}, 0.0));
    CHECK_FALSE(contact.place(0, {static_cast<std::int32_t>(body.mesh.triangles.rows()), Vec3(1, 0, 0), 0.0}, 0.0));
    CHECK_FALSE(contact.place(0, {static_cast<std::int32_t>(body.mesh.triangles.rows()) - 1, Vec3(1, 0, 0), 0.0}, 0.0));  // of the cavity
    CHECK_FALSE(contact.place(0, {body.faces[0].triangles[0], Vec3(1, 0, 0), 0.0}, 0.0));
    CHECK_FALSE(contact.aim(0, Vec3::Zero(), Vec3::UnitZ()));
    REQUIRE(contact.place(0, p, 0.0));
    CHECK_FALSE(contact.aim(0, Vec3(inf, 0, 0), Vec3::UnitZ()));
    CHECK_FALSE(contact.aim(0, Vec3(0, 0, -0.1), Vec3::Zero()));
    CHECK_FALSE(contact.aim(0, body.corners(p.triangle), Vec3(nan, 0, 0)));
    contact.step(kFrame);
    CHECK(contact.idle());
    REQUIRE(contact.aim(0, Vec3(0, 0, -1e300), Vec3::UnitZ()));
    contact.step(nan);
    contact.step(-1.0);
    contact.step(1e300);
    CHECK(contact.clamped(0));
    CHECK(contact.patchForces().allFinite());
    contact.reset();
    CHECK(contact.idle());

    TouchSettings bad;
    bad.friction = -0.1;
    CHECK(contact.set(bad).error().code == "bad-value");
    bad = {};
    bad.mostStrain = 1.0;
    CHECK(contact.set(bad).error().code == "bad-value");
    bad = {};
    bad.releaseSeconds = nan;
    CHECK(contact.set(bad).error().code == "bad-value");
    CHECK(TouchSurface::build({ball().mesh, {}}, ball().faces, body.response).error().code == "bad-value");
    CHECK(TouchSurface::build({body.mesh, {}}, body.faces, std::make_shared<const ElementResponse>()).error().code == "bad-value");
}

TEST_CASE("touch: random fingers for many frames stay finite and bounded, do not allocate, and do the same again") {
    for (const auto& [name, body] : all()) {
        CAPTURE(name);
        const auto run = [&](int frames) {
            std::mt19937 random(7);
            std::uniform_real_distribution<double> d(-1.0, 1.0);
            TouchContact contact = body->contact();
            const auto u = [&] { return Vec3(d(random), d(random), d(random)); };
            double most = 0.0, hash = 0.0;
            std::size_t allocated = 0;
            for (int frame = 0; frame < frames; ++frame) {
                const std::size_t before = allocations();
                const int i = static_cast<int>(random() % TouchContact::kFingers);
                const auto what = random() % 12;
                if (what == 0) contact.lift(i);
                if (what == 1) contact.place(i, contact.surface().nearest(2.0 * u()), std::abs(d(random)));
                if (what == 2 && frame % 7 == 0 && contact.down((i + 1) % TouchContact::kFingers)) {  // two at one place
                    TouchContact::Point p;
                    p.triangle = contact.triangle((i + 1) % TouchContact::kFingers);
                    p.barycentric = Vec3(0.2, 0.3, 0.5);
                    contact.place(i, p, 0.0);
                }
                if (frame % 997 == 0) contact.liftAll();
                for (int k = 0; k < TouchContact::kFingers; ++k)
                    if (contact.down(k) && random() % 3 == 0) contact.aim(k, (random() % 50 == 0 ? 1e6 : 0.2) * u(), u());
                contact.step(random() % 100 == 0 ? 1.0 : std::abs(d(random)) / 60.0);
                allocated += allocations() - before;
                most = std::max(most, contact.patchForces().cwiseAbs().maxCoeff());
                hash = 0.9 * hash + contact.patchForces().sum();
                if (frame % 100 == 0) {
                    const Eigen::VectorXd gradients = body->response->touch.gradients.cast<double>() * contact.patchForces();
                    for (Eigen::Index g = 0; g < gradients.size(); g += 9) REQUIRE(gradients.segment<9>(g).norm() <= 0.7 * (1.0 + 1e-6));
                }
            }
            CHECK(allocated == 0);
            CHECK(std::isfinite(most));
            contact.liftAll();
            for (int frame = 0; frame < 300; ++frame) contact.step(kFrame);
            CHECK(contact.idle());
            return hash;
        };
        run(25'000);
        CHECK(run(2000) == run(2000));
    }
}
