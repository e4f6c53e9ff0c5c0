// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "core/base/colour.h"
#include "core/base/finite.h"
#include "core/base/union_find.h"
#include "core/mesh/bounds.h"
#include "core/mesh/closest_point.h"
#include "core/mesh/edge_key.h"
#include "core/mesh/flat_region.h"
#include "core/mesh/triangle_tree.h"
#include "core/mesh/vertex_corners.h"
#include "tests/support/shapes.h"

using namespace imomushi;

TEST_CASE("union-find: the lowest member represents a set, whatever the order of unions") {
    for (const bool backwards : {false, true}) {
        UnionFind sets(10);
        std::vector<std::pair<std::int32_t, std::int32_t>> unions = {{3, 7}, {7, 9}, {1, 2}, {9, 8}, {3, 9}};
        if (backwards) std::reverse(unions.begin(), unions.end());
        for (const auto& [a, b] : unions) sets.unite(b, a);
        const std::vector<std::int32_t> expected = {0, 1, 1, 3, 4, 5, 6, 3, 3, 3};
        for (std::int32_t i = 0; i < 10; ++i) CHECK(sets.find(i) == expected[static_cast<std::size_t>(i)]);
    }
}

TEST_CASE("finite: infinities and NaN are found without a floating-point exception") {
    Points p = Points::Ones(4, 3);
    CHECK(allFinite(p));
    CHECK(allFinite(p.row(2)));
    for (const double bad : {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::signaling_NaN()}) {
        p(2, 1) = bad;
        CHECK_FALSE(allFinite(p));
        CHECK_FALSE(allFinite(p.data(), 12));
        CHECK(allFinite(p.data(), 7));
        CHECK(allFinite(p.row(1)));
    }
}

TEST_CASE("colour: linear light and sRGB are inverses, clamped") {
    for (int i = 0; i <= 255; ++i) CHECK(srgbFromLinear(static_cast<double>(linearFromSrgb(i / 255.0))) == doctest::Approx(i / 255.0).epsilon(1e-6));
    CHECK(linearFromSrgb(-1.0) == 0.0f);
    CHECK(linearFromSrgb(2.0) == 1.0f);
    CHECK(srgbFromLinear(3.0) == 1.0);
}

TEST_CASE("bounds: of no points is the origin, of others their box") {
    CHECK(diagonalOf(Points(0, 3)) == 0.0);
    Points p(3, 3);
    p << 1, 2, 3, -1, 5, 3, 0, 0, 3;
    CHECK(boundsOf(p).low == Vec3(-1, 0, 3));
    CHECK(boundsOf(p).high == Vec3(1, 5, 3));
    CHECK(diagonalOf(p) == doctest::Approx(std::sqrt(29.0)));
}

TEST_CASE("edge keys: an edge has one key, its two sides have two") {
    CHECK(edgeKey(3, 8) == edgeKey(8, 3));
    CHECK(sideKey(3, 8) != sideKey(8, 3));
    CHECK(edgeKey(3, 8) < edgeKey(3, 9));
    CHECK(edgeKey(3, 1000000) < edgeKey(4, 5));
}

TEST_CASE("vertex corners: each corner is listed at its vertex, in ascending order; left-out triangles are not") {
    const TriangleMesh mesh = shapes::sphere(1.0, 2).mesh;
    std::vector<char> which(static_cast<std::size_t>(mesh.triangles.rows()));
    for (std::size_t f = 0; f < which.size(); ++f) which[f] = f % 3 != 0;
    const std::span<const std::int32_t> all(mesh.triangles.data(), static_cast<std::size_t>(mesh.triangles.size()));
    for (const bool some : {false, true}) {
        const VertexCorners corners = some ? VertexCorners(all, static_cast<std::size_t>(mesh.vertices.rows()), which) : VertexCorners(mesh);
        std::size_t count = 0, expected = 0;
        for (std::int32_t v = 0; v < mesh.vertices.rows(); ++v) {
            const auto at = corners.at(v);
            CHECK(std::is_sorted(at.begin(), at.end()));
            for (const std::int32_t c : at) {
                CHECK(all[static_cast<std::size_t>(c)] == v);
                CHECK((!some || which[static_cast<std::size_t>(c / 3)]));
            }
            count += at.size();
        }
        for (const char w : which) expected += some ? 3 * static_cast<std::size_t>(w) : 3;
        CHECK(count == expected);
    }
}

TEST_CASE("closest point on a triangle: no sample of the triangle is nearer, also on triangles that are segments") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> at(-1.0, 1.0);
    const auto point = [&] { return Vec3(at(random), at(random), at(random)); };
    for (int k = 0; k < 400; ++k) {
        const Vec3 a = point(), b = point(), c = k % 5 == 4 ? b : point(), p = 2.0 * point();
        const ClosestOnTriangle closest = closestOnTriangle(b - a, c - a, p - a, p - b, p - c);
        const Vec3 w = closest.weights / closest.weights.sum();
        CHECK(w.minCoeff() >= 0.0);
        const double distance = (w[0] * a + w[1] * b + w[2] * c - p).norm();
        for (int i = 0; i <= 20; ++i)
            for (int j = 0; j <= 20 - i; ++j) {
                const double s = i / 20.0, t = j / 20.0;
                CHECK(((1.0 - s - t) * a + s * b + t * c - p).norm() >= distance - 1e-12);
            }
    }
}

TEST_CASE("triangle tree: finds all triangles within a distance, in ascending order") {
    const TriangleMesh mesh = shapes::sphere(1.0, 2).mesh;
    const TriangleTree tree(mesh);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> at(-1.5, 1.5);
    for (int k = 0; k < 50; ++k) {
        const Vec3 p(at(random), at(random), at(random));
        const double nearest = std::sqrt(tree.nearest(p).squaredDistance);
        const auto found = tree.within(p, nearest + 0.1);
        CHECK(std::is_sorted(found.begin(), found.end()));
        for (std::int32_t t = 0; t < mesh.triangles.rows(); ++t)
            if (std::sqrt(TriangleTree(mesh, {t}).nearest(p).squaredDistance) <= nearest + 0.1) CHECK(std::binary_search(found.begin(), found.end(), t));
        CHECK(found.size() < static_cast<std::size_t>(mesh.triangles.rows()));
    }
}

TEST_CASE("flat region: bodies with flat ends have one, at any size and place, and round ones have none") {
    for (const double scale : {1e-3, 1.0, 1e3}) {
        CAPTURE(scale);
        const auto placed = [&](TriangleMesh mesh) {
            mesh.vertices *= scale;
            mesh.vertices.rowwise() += scale * Eigen::RowVector3d(5.0, -7.0, 3.0);
            return mesh;
        };
        // The ends of a long thin cylinder are 2 % of its surface each, in 24 triangles and more that count together.
        CHECK(hasFlatRegion(placed(shapes::cylinder(0.1, 4.6, 24, 24).mesh)));
        CHECK(hasFlatRegion(placed(shapes::box({0, 0, 0}, {1, 1, 1}, 3, 3, 3).mesh)));
        CHECK_FALSE(hasFlatRegion(placed(shapes::sphere(1.0, 4).mesh)));
    }
    CHECK_FALSE(hasFlatRegion({}));
    TriangleMesh point;
    point.vertices = Points::Zero(3, 3);
    point.triangles = Triangles(1, 3);
    point.triangles << 0, 1, 2;
    CHECK_FALSE(hasFlatRegion(point));
}
