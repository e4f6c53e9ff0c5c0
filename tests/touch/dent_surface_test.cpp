// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/touch/dent_surface.h"
#include "core/touch/touch_blocks.h"
#include "tests/support/allocations.h"
#include "tests/touch/bodies.h"

using namespace imomushi;
using namespace imomushi::touching;

namespace {

constexpr double kNu = 0.45;

/// A block of ten radii of a finger of 1, held below, whose vertices crowd in the middle of its top.
TriangleMesh block(int cells, double power, std::vector<shapes::Patch>& held) {
    auto body = shapes::box(Vec3(-5, -5, 0), Vec3(5, 5, 10), cells, cells, 8);
    for (Eigen::Index v = 0; v < body.mesh.vertices.rows(); ++v)
        for (int axis = 0; axis < 2; ++axis) {
            double& x = body.mesh.vertices(v, axis);
            x = std::copysign(5.0 * std::pow(std::abs(x) / 5.0, power), x);
        }
    held.assign(1, body.ends[0]);
    return body.mesh;
}

struct Pressed {
    Touched body;
    std::shared_ptr<const TouchSurface> surface;
    std::shared_ptr<const DentSurface> dents;
    std::vector<std::int32_t> first;

    Pressed(const TriangleMesh& mesh, const std::vector<shapes::Patch>& held, int patches)
        : body(precompute(inputOf(mesh, held, patches, kNu, {SolverMeshSetting::Kind::Draft, 0}))),
          surface(TouchSurface::build({mesh, {}}, body.faces, body.response).value()) {
        for (std::int32_t v = 0; v < mesh.vertices.rows(); v += TouchBlocks::kBlock) first.push_back(v);
        dents = std::make_shared<const DentSurface>(ElementMesh{mesh, {}}, body.faces, surface, kNu, first);
    }
    [[nodiscard]] TouchContact contact(double tip) const {
        TouchSettings settings;
        settings.tip = tip;
        return TouchContact::build(surface, settings, tip > 0.0 ? dents : nullptr).value();
    }
    [[nodiscard]] Points displacement(const TouchContact& contact) const {
        Points out = body.displacement(contact);
        for (const Dent& dent : contact.dents())
            for (std::int32_t v = 0; v < out.rows() && dent.active(); ++v)
                out.row(v) += (dents->compliance(dent, v) * dent.force).transpose();
        return out;
    }
};

/// Of a smooth sphere on a half-space, over its depth, at a distance from its middle over the radius of the contact (Johnson, section 3.6).
double hertz(double t) {
    return t < 1.0 ? 1.0 - 0.5 * t * t : ((2.0 - t * t) * std::asin(1.0 / t) + std::sqrt(t * t - 1.0)) / std::numbers::pi;
}

/// The displacements down of the vertices on the positive x axis of the top, by their places.
std::vector<std::pair<double, double>> profileOf(const TriangleMesh& mesh, const Points& moved) {
    std::vector<std::pair<double, double>> out;
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v)
        if (mesh.vertices(v, 2) > 9.99 && std::abs(mesh.vertices(v, 1)) < 1e-9 && mesh.vertices(v, 0) > -1e-9)
            out.emplace_back(mesh.vertices(v, 0), -moved(v, 2));
    std::sort(out.begin(), out.end());
    return out;
}

/// Twice the place where a profile has fallen to half of its beginning, between its points as a dent falls there (with hertz() of the contact).
double widthOf(const std::vector<std::pair<double, double>>& profile, double contact) {
    const double half = 0.5 * profile.front().second;
    for (std::size_t i = 1; i < profile.size(); ++i) {
        if (profile[i].second > half) continue;
        // The difference from the half-space is smooth: it is what is interpolated.
        const auto [x0, u0] = profile[i - 1];
        const auto [x1, u1] = profile[i];
        const double e0 = u0 - 2.0 * half * hertz(x0 / contact), e1 = u1 - 2.0 * half * hertz(x1 / contact);
        double low = x0, high = x1;
        for (int k = 0; k < 60; ++k) {
            const double x = 0.5 * (low + high), u = 2.0 * half * hertz(x / contact) + e0 + (e1 - e0) * (x - x0) / (x1 - x0);
            (u > half ? low : high) = x;
        }
        return 2.0 * low;
    }
    return 10.0;
}

const Pressed& coarse() {
    static const Pressed out = [] {
        std::vector<shapes::Patch> held;
        const TriangleMesh mesh = block(24, 1.6, held);
        return Pressed(mesh, held, 48);
    }();
    return out;
}

/// 24 fingers on the top and a side.
void fingers(TouchContact& contact) {
    for (int i = 0; i < TouchContact::kFingers; ++i) {
        const double x = -3.5 + 1.4 * (i % 6), y = -2.7 + 1.8 * (i / 6);
        REQUIRE(contact.place(i, contact.surface().nearest(i % 5 == 4 ? Vec3(x, 5, 5 + y) : Vec3(x, y, 10)), 0.0));
        REQUIRE(contact.aim(i, (0.1 + 0.005 * i) * (i % 5 == 4 ? Vec3(0, -1, 0) : Vec3(0.1, 0, -1)),
                            i % 5 == 4 ? Vec3(Vec3::UnitY()) : Vec3(Vec3::UnitZ())));
    }
}

}  // namespace

TEST_CASE("dents: a finger of radius 1 on a block of 10 makes the dent of a half-space, 48 patches under it or 200") {
    std::vector<shapes::Patch> held;
    const TriangleMesh mesh = block(24, 1.6, held);
    const Pressed fine(mesh, held, 200);
    for (const Pressed* pressed : {&coarse(), &fine})
        for (const double depth : {0.1, 0.3, 0.45}) {
            CAPTURE(depth);
            const double contact = std::sqrt(depth);  // radius^2 = depth
            std::vector<std::pair<double, double>> profile;
            for (const double tip : {0.0, 1.0}) {
                TouchContact finger = pressed->contact(tip);
                REQUIRE(finger.place(0, finger.surface().nearest(Vec3(0, 0, 10)), 1.0));
                REQUIRE(finger.aim(0, Vec3(0, 0, -depth), Vec3::UnitZ()));
                finger.converge();
                profile = profileOf(mesh, pressed->displacement(finger));
                MESSAGE(pressed->surface->touch().patches.count()
                        << " patches, " << std::string(tip > 0.0 ? "with" : "without") << " a tip, " << depth << " deep: width "
                        << widthOf(profile, contact) << ", half-space " << 2.0 * contact << ", force " << -finger.force(0).z()
                        << ", half-space " << depth * contact / (3.0 / 8.0 * (1.0 - kNu)));
                // Patches alone are several times as wide.
                if (!(tip > 0.0)) CHECK(widthOf(profile, contact) > 1.5 * 2.0 * contact);
            }
            CHECK(profile.front().second == doctest::Approx(depth).epsilon(1e-6));
            CHECK(widthOf(profile, contact) == doctest::Approx(2.0 * contact).epsilon(0.05));
            // All of it, but for what the block gives way as a whole.
            for (const auto& [x, u] : profile) CHECK(std::abs(u - depth * hertz(x / contact)) <= 0.05 * depth);
        }
}

TEST_CASE("dents: 24 fingers at once all meet their targets, and frames add what contacts know") {
    const Pressed& on = coarse();
    TouchContact contact = on.contact(0.5);
    fingers(contact);
    contact.converge();
    const Points moved = on.displacement(contact);
    int sticking = 0;
    for (int i = 0; i < TouchContact::kFingers; ++i) {
        const bool side = i % 5 == 4;
        const Vec3 wanted = (0.1 + 0.005 * i) * (side ? Vec3(0, -1, 0) : Vec3(0.1, 0, -1)),
                   normal = side ? Vec3(Vec3::UnitY()) : Vec3(Vec3::UnitZ());
        CHECK(contact.displacement(i).dot(normal) == doctest::Approx(wanted.dot(normal)).epsilon(1e-6));
        if (contact.state(i) != TouchContact::State::Sticks) continue;
        ++sticking;
        CHECK((contact.displacement(i) - wanted).norm() <= 1e-6);
    }
    CHECK(sticking > 12);
    TouchBlocks blocks(*on.body.response, on.first);
    blocks.weigh(contact.patchForces());
    std::vector<float, Eigen::aligned_allocator<float>> local(on.first.size() * 3 * TouchBlocks::kBlock, 0.0f), pieces = local;
    blocks.add(0, on.first.size(), local.data());
    on.dents->add(contact.dents(), 0, on.first.size(), local.data());
    double most = 0.0;
    for (Eigen::Index v = 0; v < moved.rows(); ++v)
        for (int axis = 0; axis < 3; ++axis)
            most = std::max(most, std::abs(static_cast<double>(local[static_cast<std::size_t>(
                                               (v / TouchBlocks::kBlock * 3 + axis) * TouchBlocks::kBlock + v % TouchBlocks::kBlock)]) -
                                           moved(v, axis)));
    CHECK(most <= 3e-5 * 0.2);  // single precision, of dents as deep as 0.2
    // In whatever pieces.
    for (std::size_t b = 0; b < on.first.size(); b += 7) {
        blocks.add(b, std::min(b + 7, on.first.size()), pieces.data());
        on.dents->add(contact.dents(), b, std::min(b + 7, on.first.size()), pieces.data());
    }
    CHECK(local == pieces);
    // Joint faces stay.
    for (const std::int32_t v : on.body.faces[0].vertices) CHECK(moved.row(v).isZero(0.0));
}

TEST_CASE("dents: those of lifted fingers go back smoothly, without memory, and none are left") {
    const Pressed& on = coarse();
    TouchContact contact = on.contact(0.5);
    fingers(contact);
    for (int frame = 0; frame < 60; ++frame) contact.step(1.0 / 60.0);
    double last = on.displacement(contact).norm();
    CHECK(last > 0.5);
    for (int i = 0; i < TouchContact::kFingers; ++i)
        if (i % 4 != 0) contact.lift(i);
    for (int i = 0; i < TouchContact::kFingers; i += 4) contact.lift(i);
    const std::size_t before = allocations();
    for (int frame = 0; frame < 90; ++frame) {
        contact.step(1.0 / 60.0);
        CHECK(contact.patchForces().allFinite());
    }
    CHECK(allocations() == before);
    CHECK(contact.idle());
    CHECK(std::none_of(contact.dents().begin(), contact.dents().end(), [](const Dent& d) { return d.active(); }));
    // One alone: as deep as it was at first, then less and less.
    REQUIRE(contact.place(3, contact.surface().nearest(Vec3(0, 0, 10)), 0.0));
    REQUIRE(contact.aim(3, Vec3(0, 0, -0.2), Vec3::UnitZ()));
    for (int frame = 0; frame < 60; ++frame) contact.step(1.0 / 60.0);
    contact.lift(3);
    last = 0.2 + 1e-6;
    for (int frame = 0; frame < 60; ++frame) {
        contact.step(1.0 / 600.0);
        const double deep = profileOf(on.body.mesh, on.displacement(contact)).front().second;
        CHECK(deep <= last);
        CHECK(deep >= 0.8 * last);
        last = deep;
    }
    CHECK(last < 0.1);
}

TEST_CASE("dents: a deep finger has a wider contact instead of a torn surface, and at last that of its patches") {
    const Pressed& on = coarse();
    TouchContact contact = on.contact(0.3);
    REQUIRE(contact.place(0, contact.surface().nearest(Vec3(0, 0, 10)), 0.0));
    double radius = 0.0;
    for (const double depth : {0.05, 0.2, 0.5, 1.0, 2.0, 3.0}) {
        REQUIRE(contact.aim(0, Vec3(0, 0, -depth), Vec3::UnitZ()));
        contact.converge();
        const auto profile = profileOf(on.body.mesh, on.displacement(contact));
        CHECK_FALSE(contact.clamped(0));
        CHECK(profile.front().second == doctest::Approx(depth).epsilon(1e-6));
        // No slope is steeper than the largest strain, 0.7, but for a percent of what patches add.
        for (std::size_t i = 1; i < profile.size(); ++i)
            CHECK((profile[i - 1].second - profile[i].second) / (profile[i].first - profile[i - 1].first) <= 0.75);
        CHECK(contact.dents()[0].radius > radius);
        radius = contact.dents()[0].radius;
    }
}

TEST_CASE("dents: a finger that wants to go deeper than flesh gives way makes a dent, deeper than patches alone give way, and as deep however far it wants") {
    const Pressed& on = coarse();
    const auto pressed = [&](double tip, double depth) {
        TouchContact contact = on.contact(tip);
        REQUIRE(contact.place(0, contact.surface().nearest(Vec3(0, 0, 10)), 0.0));
        REQUIRE(contact.aim(0, Vec3(0, 0, -depth), Vec3::UnitZ()));
        contact.converge();
        return contact;
    };
    const auto deep = [&](const TouchContact& contact) { return profileOf(on.body.mesh, on.displacement(contact)).front().second; };
    const TouchContact plain = pressed(0.0, 50.0);
    REQUIRE(plain.clamped(0));
    double last = 0.0;
    for (const double depth : {2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 15.0, 50.0, 900.0}) {
        CAPTURE(depth);
        const TouchContact contact = pressed(0.3, depth);
        const double reached = deep(contact);
        CHECK(reached >= last * (1.0 - 1e-3));
        if (contact.clamped(0)) {
            CHECK(reached > deep(plain));
            CHECK(reached < depth);
            CHECK(contact.dents()[0].active());
        } else {
            CHECK(reached == doctest::Approx(depth).epsilon(1e-6));
        }
        last = reached;
    }
    CHECK(last == doctest::Approx(deep(pressed(0.3, 20.0))).epsilon(1e-3));
    CHECK(last < 9.0);
}

TEST_CASE("dents: between two shapes of a take a dent that comes stays in its place") {
    Dent a, b;
    b.force = Vec3(0, 0, -2);
    b.centre = Vec3(1, 2, 3);
    b.normal = Vec3::UnitZ();
    b.radius = 0.5;
    b.patchRadius = 2.0;
    const Dent half = Dent::between(a, b, 0.5), other = Dent::between(b, a, 0.25);
    CHECK(half.centre == b.centre);
    CHECK(half.radius == 0.5);
    CHECK(half.force == Vec3(0, 0, -1));
    CHECK(other.force == Vec3(0, 0, -1.5));
    CHECK(other.centre == b.centre);
    double numbers[Dent::kNumbers];
    b.put(numbers);
    Dent back;
    back.take(numbers);
    CHECK(back == b);
}
