// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <numeric>
#include <random>

#include "core/proposal/choose_planes.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

/// A bar of 1 x 1 x 12 along z, from whose low end limbs are counted.
struct Bar {
    TriangleMesh mesh = shapes::box({-0.5, -0.5, 0.0}, {0.5, 0.5, 12.0}, 4, 4, 48).mesh;
    CutSurface surface{mesh};
    std::vector<double> volume = std::vector<double>(static_cast<std::size_t>(mesh.vertices.rows()), 1.0 / static_cast<double>(mesh.vertices.rows()));

    /// What lies between two heights belongs beyond the cut.
    [[nodiscard]] PlaneWish wish(double low, double high, int parent = -1) const {
        PlaneWish wish;
        for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) wish.own.push_back(mesh.vertices(v, 2) > low && mesh.vertices(v, 2) < high ? 1.0 : 0.0);
        wish.parent = parent;
        return wish;
    }

    [[nodiscard]] std::vector<std::optional<CutPlane>> choose(const std::vector<PlaneWish>& wishes, const std::optional<CutPlane>& mirror = {}) const {
        return choosePlanes(surface, volume, wishes, mirror, 0.01, {});
    }
};

constexpr double kAll = 13.0;
CutPlane across(double z) { return {Vec3(0.0, 0.0, z), Vec3::UnitZ()}; }
/// Meets heights from z - 1.5 to z + 1.5.
CutPlane slanting(double z) { return {Vec3(0.0, 0.0, z), Vec3(0.0, -3.0, 1.0).normalized()}; }

}  // namespace

TEST_CASE("choosing planes: an earlier cut chooses again where its plane is in the way of a later one") {
    const Bar bar;
    PlaneWish arm = bar.wish(4.1, kAll), hand = bar.wish(5.1, kAll, 0);
    arm.planes = {slanting(4.1)};
    arm.more = {across(4.1)};
    hand.planes = {across(5.1)};
    const auto alone = bar.choose({arm});
    REQUIRE(alone[0]);
    CHECK(alone[0]->normal == slanting(4.1).normal);  // alone it is content with its first plane
    const auto both = bar.choose({arm, hand});
    REQUIRE(both[0]);
    REQUIRE(both[1]);
    CHECK(both[0]->normal == Vec3::UnitZ());
    CHECK(both[1]->origin.z() == 5.1);
    CHECK(cutBody(bar.mesh, std::vector<CutPlane>{*both[0], *both[1]}).has_value());
}

TEST_CASE("choosing planes: of cuts that never go together the fewest are given up") {
    // The first one is in the way of all others and has no other plane.
    const Bar bar;
    std::vector<PlaneWish> wishes{bar.wish(6.1, kAll), bar.wish(5.1, kAll), bar.wish(6.6, kAll), bar.wish(7.1, kAll)};
    wishes[0].planes = {slanting(6.1)};
    wishes[1].planes = {across(5.1)};
    wishes[2].planes = {across(6.6)};
    wishes[3].planes = {across(7.1)};
    const auto planes = bar.choose(wishes);
    CHECK(!planes[0]);
    for (std::size_t c = 1; c < 4; ++c) CHECK(planes[c]);
}

TEST_CASE("choosing planes: twins get mirrored planes that do not meet") {
    const Bar bar;
    const CutPlane mirror{Vec3(0, 0, 6), Vec3::UnitZ()};
    PlaneWish up = bar.wish(7.1, kAll), down = bar.wish(-1.0, 4.9);
    up.twin = 1;
    down.twin = 0;
    up.planes = {slanting(7.1), across(6.0), across(7.6)};  // the first two would meet their images
    const auto planes = bar.choose({up, down}, mirror);
    REQUIRE(planes[0]);
    REQUIRE(planes[1]);
    CHECK(planes[0]->origin.z() == 7.6);
    CHECK(std::abs(planes[1]->origin.z() - 4.4) < 1e-12);
    CHECK((planes[1]->normal + Vec3::UnitZ()).norm() < 1e-12);
}

TEST_CASE("choosing planes: a plane that cuts off something else than the limb does not count, a hat that belongs to the root does not hinder") {
    const Bar bar;
    PlaneWish head = bar.wish(10.1, 11.1), leg = bar.wish(8.1, 8.6), backward = bar.wish(8.1, kAll), shallow = bar.wish(11.9, kAll);
    head.planes = {across(10.1)};
    leg.planes = {across(8.1)};  // with it goes seven times as much
    backward.planes = {{Vec3(0, 0, 8.1), -Vec3::UnitZ()}};
    shallow.planes = {across(11.95)};  // less than the least piece, though all vertices of the end lie there
    CHECK(bar.choose({head})[0]);
    CHECK(!bar.choose({leg})[0]);
    CHECK(!bar.choose({backward})[0]);
    CHECK(!bar.choose({shallow})[0]);
}

TEST_CASE("choosing planes: where all cuts can have a plane, all get one, in whatever order they come") {
    // Nine cuts along the bar, each with one plane that goes with those of all others and several slanting ones, listed first, that go with few.
    const Bar bar;
    int missing = 0;
    for (unsigned seed = 0; seed < 12; ++seed) {
        std::minstd_rand random(seed + 1);
        const auto between = [&](double low, double high) { return low + (high - low) * static_cast<double>(random() % 1000) / 1000.0; };
        std::vector<std::size_t> order(9);
        std::iota(order.begin(), order.end(), std::size_t{0});
        for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
        std::vector<PlaneWish> wishes;
        for (const std::size_t i : order) {
            const double z = 1.6 + static_cast<double>(i);
            PlaneWish wish = bar.wish(z, kAll);
            for (int decoy = 0; decoy < 4; ++decoy)
                wish.planes.push_back({Vec3(0, 0, z + between(-0.3, 0.3)), Vec3(between(-2.0, 2.0), between(-3.0, 3.0), 1.0).normalized()});
            wish.more = {across(z)};
            wishes.push_back(std::move(wish));
        }
        for (const auto& plane : bar.choose(wishes)) missing += !plane;
    }
    CHECK(missing == 0);
}
