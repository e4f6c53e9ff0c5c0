// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/solid_angle.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/mesh/winding_number.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

/// The winding number at vertex v; its own triangles, seen edge-on, add nothing.
double windingAt(const TriangleMesh& mesh, std::int32_t v) {
    std::vector<std::int32_t> others;
    for (std::int32_t f = 0; f < mesh.triangles.rows(); ++f)
        if ((mesh.triangles.row(f).array() != v).all()) others.push_back(f);
    return windingNumber(mesh, others, mesh.vertices.row(v).transpose());
}

}  // namespace

TEST_CASE("solid angle: an eighth at the corners of a cube, a quarter at its edges, half on its sides, and the rest of it in a hole") {
    for (const bool hole : {false, true}) {
        const auto body = shapes::box(Vec3(0, 0, 0), Vec3(1, 1, 1), 2, 2, 2);
        const TriangleMesh mesh = hole ? shapes::inverted(body).mesh : body.mesh;
        const auto angles = vertexSolidAngles(mesh);
        for (std::int32_t v = 0; v < mesh.vertices.rows(); ++v) {
            const Vec3 p = mesh.vertices.row(v).transpose();
            const int sides = static_cast<int>((p.array() == 0.0).count() + (p.array() == 1.0).count());
            const double inside = std::pow(0.5, sides);
            CHECK(angles[static_cast<std::size_t>(v)] == doctest::Approx(hole ? 1.0 - inside : inside).epsilon(1e-14));
        }
    }
}

TEST_CASE("solid angle: the same as the winding number of the whole surface, wherever it does not touch itself") {
    CHECK(rc::check("any body, bent and flattened", [] {
        const int which = *rc::gen::inRange(0, 4);
        shapes::Body body = which == 0   ? shapes::sphere(1.0, 1)
                            : which == 1 ? shapes::torus(1.0, 0.3, 9, 5)
                            : which == 2 ? shapes::cylinder(0.5, 2.0, 9, 3)
                                         : shapes::box(Vec3(-1, -1, -1), Vec3(1, 1, 1), 2, 3, 2);
        const double thin = std::pow(10.0, -*rc::gen::inRange(0, 4));
        const double size = std::pow(10.0, *rc::gen::inRange(-6, 7));
        // A smooth bend that maps no two places onto one.
        for (Eigen::Index v = 0; v < body.mesh.vertices.rows(); ++v) {
            const Vec3 p = body.mesh.vertices.row(v).transpose();
            body.mesh.vertices.row(v) = size * Eigen::RowVector3d(p.x() + 0.4 * std::sin(p.z()), p.y(), thin * (p.z() + 0.3 * p.y() * p.y()));
        }
        const auto angles = vertexSolidAngles(body.mesh);
        for (std::int32_t v = 0; v < body.mesh.vertices.rows(); ++v) {
            RC_ASSERT(angles[static_cast<std::size_t>(v)] > 0.0);
            RC_ASSERT(angles[static_cast<std::size_t>(v)] < 1.0);
            RC_ASSERT(std::abs(angles[static_cast<std::size_t>(v)] - windingAt(body.mesh, v)) < 1e-11);
        }
    }));
}

TEST_CASE("solid angle: a vertex that touches another part of the surface is told by the winding number, which is larger") {
    // A pyramid's tip on the side of a box, both in one mesh.
    const auto box = shapes::box(Vec3(-1, -1, 0), Vec3(1, 1, 1), 1, 1, 1);
    TriangleMesh mesh = box.mesh;
    const Eigen::Index first = mesh.vertices.rows(), triangles = mesh.triangles.rows();
    mesh.vertices.conservativeResize(first + 4, 3);
    mesh.vertices.bottomRows(4) << 0.2, 0.1, 1, 1, 0, 2, -0.5, 0.8, 2, -0.5, -0.8, 2;
    mesh.triangles.conservativeResize(triangles + 4, 3);
    mesh.triangles.bottomRows(4) << 0, 2, 1, 0, 3, 2, 0, 1, 3, 1, 2, 3;
    mesh.triangles.bottomRows(4).array() += static_cast<std::int32_t>(first);
    const auto angles = vertexSolidAngles(mesh);
    for (std::int32_t v = 0; v < mesh.vertices.rows(); ++v) {
        const double miss = windingAt(mesh, v) - angles[static_cast<std::size_t>(v)];
        if (v == first)
            CHECK(std::abs(miss) > 0.4);  // half a sphere more or, as rounding has it, the whole one or nothing less its own part
        else
            CHECK(std::abs(miss) < 1e-12);
    }
}
