// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/triangle_clusters.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <random>

#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

/// Whether a ray meets a triangle, two-sided (Moeller and Trumbore).
bool crosses(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a, p = direction.cross(ac), s = origin - a, q = s.cross(ab);
    const double determinant = ab.dot(p);
    if (determinant == 0.0) return false;
    const double u = s.dot(p) / determinant, v = direction.dot(q) / determinant;
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && ac.dot(q) / determinant > 0.0;
}

}  // namespace

TEST_CASE("triangle clusters: a ray finds every triangle that it meets, in any pose, through vertices and along edges too, and few others") {
    std::mt19937 random(3);
    const auto number = [&] { return 2.0 * static_cast<double>(random()) / 4294967295.0 - 1.0; };
    const auto vector = [&] {
        const double x = number(), y = number(), z = number();
        return Vec3(x, y, z);
    };
    std::size_t candidates = 0, met = 0, rays = 0, all = 0;
    for (const auto& body : {shapes::sphere(1.0, 4), shapes::bar(6), shapes::torus(1.0, 0.3, 40, 20), shapes::cylinder(0.5, 3.0, 30, 60)}) {
        const TriangleMesh& mesh = body.mesh;
        const TriangleClusters clusters(mesh);
        for (int pose = 0; pose < 3; ++pose) {
            Points now = mesh.vertices;
            for (Eigen::Index v = 0; pose > 0 && v < now.rows(); ++v) {
                now.row(v) += 0.3 * pose * Vec3(std::sin(2.0 * now(v, 2)), std::cos(now(v, 0)), 0.0).transpose();
                if (pose == 2) now.row(v) *= 1e3;
            }
            const auto at = [&](std::int32_t v) -> Vec3 { return now.row(v).transpose(); };
            const double size = now.cwiseAbs().maxCoeff();
            for (int ray = 0; ray < 75; ++ray) {
                const Vec3 origin = ray % 3 == 0 ? Vec3(0.3 * size * vector()) : Vec3(5.0 * size * vector());
                // At a vertex, at the middle of an edge, along an axis, or anywhere.
                const auto t = static_cast<Eigen::Index>(random() % static_cast<std::size_t>(mesh.triangles.rows()));
                const Vec3 corner = at(mesh.triangles(t, 0)), middle = 0.5 * (corner + at(mesh.triangles(t, 1)));
                Vec3 direction = ray % 5 == 0 ? Vec3(corner - origin) : ray % 5 == 1 ? Vec3(middle - origin) : ray % 5 == 2 ? Vec3(Vec3::Unit(ray % 3)) : vector();
                if (direction.norm() == 0.0) continue;
                direction.normalize();
                std::vector<std::int32_t> found;
                clusters.along(origin, direction, at, found);
                CHECK(std::is_sorted(found.begin(), found.end()));
                CHECK(std::adjacent_find(found.begin(), found.end()) == found.end());
                for (std::int32_t i = 0; i < mesh.triangles.rows(); ++i) {
                    if (!crosses(origin, direction, at(mesh.triangles(i, 0)), at(mesh.triangles(i, 1)), at(mesh.triangles(i, 2)))) continue;
                    ++met;
                    CHECK(std::binary_search(found.begin(), found.end(), i));
                }
                candidates += found.size();
                all += static_cast<std::size_t>(mesh.triangles.rows());
                ++rays;
            }
        }
    }
    CHECK(met > rays);
    CHECK(candidates < all / 8);
}

TEST_CASE("triangle clusters: of no triangles there are none, and a flat mesh has them all") {
    std::vector<std::int32_t> found;
    const auto nowhere = [](std::int32_t) { return Vec3(Vec3::Zero()); };
    TriangleClusters(TriangleMesh{}).along(Vec3::Zero(), Vec3::UnitX(), nowhere, found);
    CHECK(found.empty());
    TriangleMesh point;
    point.vertices = Points::Zero(3, 3);
    point.triangles = (Triangles(1, 3) << 0, 1, 2).finished();
    TriangleClusters(point).along(Vec3(-1, 0, 0), Vec3::UnitX(), nowhere, found);
    CHECK(found == std::vector<std::int32_t>{0});
}
