// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <map>

#include "core/mesh/health.h"
#include "core/meshing/solver_mesh.h"
#include "tests/reduction/faces.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

/// A box 1 x 1 x 2 of n cells per unit length; shared vertices, outward.
TriangleMesh box(int n) {
    std::map<std::tuple<int, int, int>, int> index;
    TriangleMesh mesh;
    std::vector<Vec3> points;
    std::vector<std::array<int, 3>> triangles;
    const auto vertex = [&](int x, int y, int z) {
        const auto [it, fresh] = index.try_emplace({x, y, z}, static_cast<int>(points.size()));
        if (fresh) points.emplace_back(double(x) / n, double(y) / n, double(z) / n);
        return it->second;
    };
    const int size[3] = {n, n, 2 * n};
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            for (int i = 0; i < size[u]; ++i)
                for (int j = 0; j < size[v]; ++j) {
                    const auto at = [&](int a, int b) {
                        int p[3];
                        p[axis] = side * size[axis], p[u] = i + a, p[v] = j + b;
                        return vertex(p[0], p[1], p[2]);
                    };
                    const int q[4] = {at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
                    if (side) triangles.push_back({q[0], q[1], q[2]}), triangles.push_back({q[0], q[2], q[3]});
                    else triangles.push_back({q[0], q[2], q[1]}), triangles.push_back({q[0], q[3], q[2]});
                }
        }
    mesh.vertices.resize(static_cast<int>(points.size()), 3);
    for (int i = 0; i < mesh.vertices.rows(); ++i) mesh.vertices.row(i) = points[i].transpose();
    mesh.triangles.resize(static_cast<int>(triangles.size()), 3);
    for (int i = 0; i < mesh.triangles.rows(); ++i)
        for (int c = 0; c < 3; ++c) mesh.triangles(i, c) = triangles[i][c];
    return mesh;
}

struct Facts {
    bool closed = true;
    double volume = 0, area = 0, worstQuality = 1;
};

Facts facts(const TriangleMesh& mesh) {
    Facts f;
    std::map<std::pair<int, int>, int> directed;
    for (int t = 0; t < mesh.triangles.rows(); ++t) {
        Vec3 p[3];
        double squares = 0;
        for (int c = 0; c < 3; ++c) p[c] = mesh.vertices.row(mesh.triangles(t, c));
        for (int c = 0; c < 3; ++c) ++directed[{mesh.triangles(t, c), mesh.triangles(t, (c + 1) % 3)}], squares += (p[c] - p[(c + 1) % 3]).squaredNorm();
        f.volume += p[0].dot(p[1].cross(p[2])) / 6;
        const double area = 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).norm();
        f.area += area;
        f.worstQuality = std::min(f.worstQuality, 4 * std::sqrt(3.0) * area / squares);
    }
    for (const auto& [e, n] : directed) f.closed = f.closed && n == 1 && directed.contains({e.second, e.first});
    return f;
}

}  // namespace

namespace {

/// Every vertex after the first `own` lies where it says.
void checkOrigins(const SolverMesh& mesh, int own) {
    REQUIRE(static_cast<int>(mesh.origin.size()) == mesh.mesh.vertices.rows() - own);
    for (int v = own; v < mesh.mesh.vertices.rows(); ++v) {
        const auto& [of, share] = mesh.origin[static_cast<std::size_t>(v - own)];
        Vec3 p = Vec3::Zero();
        for (std::size_t k = 0; k < 3; ++k) {
            CHECK(of[k] < v);
            p += share[k] * Vec3(mesh.mesh.vertices.row(of[k]).transpose());
        }
        CHECK((Vec3(mesh.mesh.vertices.row(v).transpose()) - p).norm() <= 1e-14);
    }
}

/// An L: a bar bent by 90 degrees, of unit cells. Its only re-entrant edge is x = 1, z = 1.
TriangleMesh elbow() {
    TriangleMesh mesh;
    mesh.vertices.resize(12, 3);
    mesh.vertices << 0, 0, 0, 3, 0, 0, 3, 0, 1, 1, 0, 1, 1, 0, 3, 0, 0, 3,  //
        0, 1, 0, 3, 1, 0, 3, 1, 1, 1, 1, 1, 1, 1, 3, 0, 1, 3;
    mesh.triangles.resize(20, 3);
    mesh.triangles << 0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 6, 8, 7, 6, 9, 8, 6, 10, 9, 6, 11, 10,  //
        0, 7, 1, 0, 6, 7, 1, 8, 2, 1, 7, 8, 2, 9, 3, 2, 8, 9, 3, 10, 4, 3, 9, 10, 4, 11, 5, 4, 10, 11, 5, 6, 0, 5, 11, 6;
    return mesh;
}

double shortestEdge(const TriangleMesh& mesh, const std::function<bool(const Vec3&)>& where) {
    double shortest = 1e300;
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
        for (int c = 0; c < 3; ++c) {
            const Vec3 a = mesh.vertices.row(mesh.triangles(t, c)), b = mesh.vertices.row(mesh.triangles(t, (c + 1) % 3));
            if (where(0.5 * (a + b))) shortest = std::min(shortest, (a - b).norm());
        }
    return shortest;
}

}  // namespace

TEST_CASE("refined solver mesh: has the wanted number of vertices, on the same closed surface, and says where each new one lies") {
    const shapes::Body bodies[] = {shapes::bar(3), shapes::cylinder(0.5, 2.0, 9, 5), shapes::torus(1.0, 0.4, 12, 8), shapes::sphere(1.0, 1)};
    for (const auto& body : bodies) {
        const auto faces = facesOf(body);
        const MeshFacts before = meshFacts(body.mesh);
        const auto own = static_cast<int>(body.mesh.vertices.rows());
        for (const int wanted : {own, own + 1, 2 * own, 5 * own}) {
            const SolverMesh fine = refinedSolverMesh(body.mesh, faces, wanted).value();
            CHECK(fine.mesh.vertices.rows() == wanted);
            CHECK(fine.mesh.vertices.topRows(own) == body.mesh.vertices);
            const MeshFacts after = meshFacts(fine.mesh);
            CHECK(after.closed);
            CHECK(after.outward);
            CHECK(after.volume == doctest::Approx(before.volume).epsilon(1e-12));
            CHECK(after.area == doctest::Approx(before.area).epsilon(1e-12));
            // Longest-edge bisection never makes an angle smaller than half of the smallest there was (Rosenberg and Stenger 1975).
            CHECK(facts(fine.mesh).worstQuality >= 0.25 * facts(body.mesh).worstQuality);
            checkOrigins(fine, own);
            for (std::size_t f = 0; f < faces.size(); ++f) {
                double area = 0.0;
                for (const auto t : fine.faces[f].triangles) {
                    const auto row = [&](int c) -> Vec3 { return fine.mesh.vertices.row(fine.mesh.triangles(t, c)); };
                    area += 0.5 * (row(1) - row(0)).cross(row(2) - row(0)).norm();
                }
                CHECK(area == doctest::Approx(faces[f].area).epsilon(1e-12));
            }
        }
        CHECK(refinedSolverMesh(body.mesh, faces, 3 * own).value().mesh.triangles == refinedSolverMesh(body.mesh, faces, 3 * own).value().mesh.triangles);
    }
}

TEST_CASE("refined solver mesh: finer at rims and at re-entrant edges than elsewhere, but not at convex edges") {
    const TriangleMesh body = elbow();
    REQUIRE(meshFacts(body).outward);
    const std::vector<JointFace> faces{jointFaceByPlane(body, Vec3(3, 0, 0), Vec3(1, 0, 0), 1e-9).value()};
    const SolverMesh fine = refinedSolverMesh(body, faces, 3000).value();
    const double inner = shortestEdge(fine.mesh, [](const Vec3& p) { return std::hypot(p.x() - 1, p.z() - 1) < 0.05; });
    const double rim = shortestEdge(fine.mesh, [](const Vec3& p) { return std::abs(p.x() - 3) < 0.05; });
    const double convex = shortestEdge(fine.mesh, [](const Vec3& p) { return p.z() > 2.95 && p.x() < 0.05; });
    // A quarter is asked for; bisection meets a wanted size up to a factor of two.
    CHECK(inner <= 0.5 * convex);
    CHECK(rim <= 0.5 * convex);
}

TEST_CASE("refined solver mesh: fewer vertices than the body has, or too many, are refused with a reason") {
    const shapes::Body body = shapes::bar(3);
    const auto less = refinedSolverMesh(body.mesh, facesOf(body), 10);
    REQUIRE(!less);
    CHECK(less.error().code == "too-few-vertices");
    CHECK(less.error().message.find("decimated:10") != std::string::npos);
    CHECK(refinedSolverMesh(body.mesh, facesOf(body), 2'000'000'000).error().code == "bad-value");
    TriangleMesh nothing = body.mesh;
    nothing.vertices.setZero();
    CHECK(refinedSolverMesh(nothing, {}, 1000).error().code == "bad-value");
}
