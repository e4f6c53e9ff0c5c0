// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/body_geometry.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "tests/render/test_bodies.h"

using namespace imomushi;
using namespace imomushi::render;

namespace {

/// A tube along x from x0 to x1 with both caps, its look as in a file without one.
TestBody tube(double x0, double x1, int rings = 6, int sides = 24) {
    TestBody body;
    const int vertices = (rings + 1) * sides + 2;
    body.mesh->body.vertices.resize(vertices, 3);
    for (int r = 0; r <= rings; ++r)
        for (int s = 0; s < sides; ++s) {
            const double angle = 2.0 * std::numbers::pi * s / sides;
            body.mesh->body.vertices.row(r * sides + s) << x0 + (x1 - x0) * r / rings, std::cos(angle), std::sin(angle);
        }
    body.mesh->body.vertices.row(vertices - 2) << x0, 0, 0;
    body.mesh->body.vertices.row(vertices - 1) << x1, 0, 0;
    body.mesh->body.triangles.resize(2 * sides * rings + 2 * sides, 3);
    int f = 0;
    // Caps first: triangles 0 ... sides - 1 at x0, sides ... 2 sides - 1 at x1.
    for (int s = 0; s < sides; ++s) body.mesh->body.triangles.row(f++) << vertices - 2, (s + 1) % sides, s;
    for (int s = 0; s < sides; ++s) body.mesh->body.triangles.row(f++) << vertices - 1, rings * sides + s, rings * sides + (s + 1) % sides;
    for (int r = 0; r < rings; ++r)
        for (int s = 0; s < sides; ++s) {
            const int a = r * sides + s, b = r * sides + (s + 1) % sides;
            body.mesh->body.triangles.row(f++) << a, b, a + sides;
            body.mesh->body.triangles.row(f++) << b, b + sides, a + sides;
        }
    body.settle();
    return body;
}

/// Display normals by look at the drawn corners: calls check(body triangle, corner, normal).
template <class Check>
void eachCorner(const TestBody& body, BodyGeometry& geometry, Check check) {
    std::vector<float> out(std::size_t(geometry.vertexCount()) * BodyGeometry::kFloats);
    geometry.sumNormals(body.positions.data());
    geometry.fill(body.positions.data(), body.normals.data(), out.data());
    for (std::size_t i = 0; i < geometry.indices().size(); ++i) {
        const float* v = &out[geometry.indices()[i] * BodyGeometry::kFloats];
        check(geometry.bodyTriangle(static_cast<int>(i / 3)), static_cast<int>(i % 3), Vec3(v[3], v[4], v[5]));
    }
}

Vec3 facet(const TestBody& body, int f) {
    const auto p = [&](int c) { return Eigen::Map<const Eigen::Vector3f>(&body.positions[3 * body.mesh->body.triangles(f, c)]).cast<double>().eval(); };
    return (p(1) - p(0)).cross(p(2) - p(0)).normalized();
}

}  // namespace

TEST_CASE("display normals: a smooth body takes the normals of its body vertices as they are") {
    const TestBody body = blob(Vec3::Zero(), Vec3(1, 0.6, 0.8));
    BodyGeometry geometry(*body.mesh, nullptr);
    CHECK(geometry.vertexCount() == body.mesh->body.vertices.rows());
    eachCorner(body, geometry, [&](int f, int c, const Vec3& n) {
        const int v = body.mesh->body.triangles(f, c);
        CHECK((n - Eigen::Map<const Eigen::Vector3f>(&body.normals[3 * v]).cast<double>()).norm() == 0.0);
    });
}

TEST_CASE("display normals: the edge of a cap stays hard and the side round, in any pose") {
    TestBody body = tube(0, 3);
    BodyGeometry geometry(*body.mesh, nullptr);
    // A bend: what was straight is an arc now.
    for (auto v : body.mesh->body.vertices.rowwise()) {
        const double angle = 0.4 * v.x(), radius = 4.0 + v.y();
        v.x() = radius * std::sin(angle);
        v.y() = radius * std::cos(angle);
    }
    body.settle();
    eachCorner(body, geometry, [&](int f, int, const Vec3& n) {
        CHECK(n.norm() == doctest::Approx(1.0).epsilon(1e-5));
        if (f < 48) CHECK(n.dot(facet(body, f)) > 0.9999);
        // Half the angle between neighbouring sides and a little for the bend.
        else CHECK(n.dot(facet(body, f)) > std::cos(0.3));
    });
}

TEST_CASE("display normals: a body that is flat-shaded in its file stays flat-shaded when it deforms") {
    TestBody body = blob(Vec3::Zero(), Vec3::Ones(), 1.0, 6, 8);
    RenderMesh& surface = body.mesh->renderMesh;
    const int faces = static_cast<int>(body.mesh->body.triangles.rows());
    surface.triangles.resize(faces, 3);
    surface.normals.resize(3 * faces, 3);
    for (int f = 0; f < faces; ++f)
        for (int c = 0; c < 3; ++c) {
            surface.bodyVertex.push_back(body.mesh->body.triangles(f, c));
            surface.triangles(f, c) = 3 * f + c;
            surface.normals.row(3 * f + c) = facet(body, f).cast<float>().transpose();
        }
    BodyGeometry geometry(*body.mesh, nullptr);
    for (std::size_t v = 0; v < body.positions.size() / 3; ++v) body.positions[3 * v] += 0.7f * body.positions[3 * v + 1];
    eachCorner(body, geometry, [&](int f, int, const Vec3& n) { CHECK(n.dot(facet(body, f)) > 0.99999); });
}

TEST_CASE("display normals: vertices split for texture coordinates alone do not break the shading") {
    TestBody body = blob(Vec3::Zero(), Vec3::Ones());
    RenderMesh& surface = body.mesh->renderMesh;
    const int faces = static_cast<int>(body.mesh->body.triangles.rows());
    surface.triangles.resize(faces, 3);
    surface.normals.resize(3 * faces, 3);
    for (int f = 0; f < faces; ++f)
        for (int c = 0; c < 3; ++c) {
            const int v = body.mesh->body.triangles(f, c);
            surface.bodyVertex.push_back(v);
            surface.triangles(f, c) = 3 * f + c;
            surface.normals.row(3 * f + c) = Eigen::Map<const Eigen::RowVector3f>(&body.normals[3 * v]);
        }
    BodyGeometry geometry(*body.mesh, nullptr);
    CHECK(geometry.vertexCount() == 3 * faces);
    eachCorner(body, geometry, [&](int f, int c, const Vec3& n) {
        CHECK((n - Eigen::Map<const Eigen::Vector3f>(&body.normals[3 * body.mesh->body.triangles(f, c)]).cast<double>()).norm() < 1e-6);
    });
}

TEST_CASE("display normals: two halves of a tube shade like the whole tube where they are joined") {
    const TestBody left = tube(-3, 0), right = tube(0, 3), whole = tube(-3, 3, 12);
    std::vector<std::int32_t> leftCap, rightCap;
    for (int s = 0; s < 24; ++s) {
        leftCap.push_back(24 + s);
        rightCap.push_back(s);
    }
    BodyGeometry a(*left.mesh, &leftCap), b(*right.mesh, &rightCap), w(*whole.mesh, nullptr);
    CHECK(a.indices().size() == 3 * std::size_t(left.mesh->body.triangles.rows() - 24));
    a.sumNormals(left.positions.data());
    b.sumNormals(right.positions.data());
    for (int s = 0; s < 24; ++s) {
        const int ga = a.seamGroup(6 * 24 + s), gb = b.seamGroup(s);
        REQUIRE(ga >= 0);
        REQUIRE(gb >= 0);
        a.addToNormal(ga, b.sum(gb));
    }
    std::vector<float> joined(std::size_t(a.vertexCount()) * BodyGeometry::kFloats), smooth(std::size_t(w.vertexCount()) * BodyGeometry::kFloats);
    a.fill(left.positions.data(), left.normals.data(), joined.data());
    w.sumNormals(whole.positions.data());
    w.fill(whole.positions.data(), whole.normals.data(), smooth.data());
    int compared = 0;
    for (const std::uint32_t i : a.indices())
        for (const std::uint32_t j : w.indices()) {
            if (a.bodyVertex()[i] < 6 * 24 || a.bodyVertex()[i] >= 7 * 24 || a.bodyVertex()[i] != w.bodyVertex()[j]) continue;
            ++compared;
            for (int c = 3; c < 6; ++c) CHECK(joined[6 * i + c] == doctest::Approx(smooth[6 * j + c]).epsilon(1e-5));
        }
    CHECK(compared > 0);
}

TEST_CASE("triangles are drawn by material, and a drawn triangle leads back to its own") {
    TestBody body = blob(Vec3::Zero(), Vec3::Ones(), 1.0, 6, 8);
    RenderMesh& surface = body.mesh->renderMesh;
    surface.triangles = body.mesh->body.triangles;
    for (int v = 0; v < body.mesh->body.vertices.rows(); ++v) surface.bodyVertex.push_back(v);
    surface.materials.resize(2);
    for (int f = 0; f < surface.triangles.rows(); ++f) surface.material.push_back(f % 2);
    BodyGeometry geometry(*body.mesh, nullptr);
    REQUIRE(geometry.ranges().size() == 2);
    for (const auto& range : geometry.ranges())
        for (int i = range.first; i < range.first + range.count; ++i) {
            const int f = geometry.bodyTriangle(i / 3);
            CHECK(f % 2 == range.material);
            CHECK(geometry.bodyVertex()[geometry.indices()[i]] == body.mesh->body.triangles(f, i % 3));
        }
}
