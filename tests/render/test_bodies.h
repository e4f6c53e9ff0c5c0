// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "ui/render/scene.h"

namespace imomushi {

/// A body with the positions and normals that a scene points to.
struct TestBody {
    std::shared_ptr<ElementMesh> mesh = std::make_shared<ElementMesh>();
    std::vector<float> positions, normals;

    /// Takes the rest positions of the mesh; normals are area-weighted.
    void settle() {
        const Points& v = mesh->body.vertices;
        const Triangles& t = mesh->body.triangles;
        positions.resize(3 * v.rows());
        for (Eigen::Index i = 0; i < v.rows(); ++i)
            for (int c = 0; c < 3; ++c) positions[3 * i + c] = static_cast<float>(v(i, c));
        Points n = Points::Zero(v.rows(), 3);
        for (Eigen::Index f = 0; f < t.rows(); ++f) {
            const Vec3 a = v.row(t(f, 0)), b = v.row(t(f, 1)), c = v.row(t(f, 2));
            const Vec3 area = (b - a).cross(c - a);
            for (int k = 0; k < 3; ++k) n.row(t(f, k)) += area.transpose();
        }
        n.rowwise().normalize();
        normals.resize(3 * v.rows());
        for (Eigen::Index i = 0; i < v.rows(); ++i)
            for (int c = 0; c < 3; ++c) normals[3 * i + c] = static_cast<float>(n(i, c));
    }

    [[nodiscard]] render::Body body(std::uint64_t id, const Eigen::Vector3f& color) const {
        render::Body b;
        b.id = id;
        b.mesh = mesh;
        b.positions = positions.data();
        b.normals = normals.data();
        b.revision = 1;
        b.color = color;
        return b;
    }
};

/// A superellipsoid: |x/a|^p + |y/b|^p + |z/c|^p = 1, p = 2/e (e = 1: an ellipsoid), closed, outward.
inline TestBody blob(const Vec3& centre, const Vec3& radii, double e = 1.0, int rings = 24, int sides = 36) {
    TestBody body;
    const auto power = [&](double x) { return std::copysign(std::pow(std::abs(x), e), x); };
    const int vertices = 2 + (rings - 1) * sides;
    body.mesh->body.vertices.resize(vertices, 3);
    body.mesh->body.triangles.resize(2 * sides * (rings - 1), 3);
    Points& v = body.mesh->body.vertices;
    v.row(0) = (centre + Vec3(0, radii.y(), 0)).transpose();
    v.row(vertices - 1) = (centre - Vec3(0, radii.y(), 0)).transpose();
    for (int r = 1; r < rings; ++r)
        for (int s = 0; s < sides; ++s) {
            const double theta = std::numbers::pi * r / rings, phi = 2 * std::numbers::pi * s / sides;
            v.row(1 + (r - 1) * sides + s) = (centre + Vec3(radii.x() * power(std::sin(theta)) * power(std::sin(phi)), radii.y() * power(std::cos(theta)),
                                                            radii.z() * power(std::sin(theta)) * power(std::cos(phi))))
                                                 .transpose();
        }
    int f = 0;
    const auto at = [&](int r, int s) { return r == 0 ? 0 : r == rings ? vertices - 1 : 1 + (r - 1) * sides + s % sides; };
    for (int r = 0; r < rings; ++r)
        for (int s = 0; s < sides; ++s) {
            if (r < rings - 1) body.mesh->body.triangles.row(f++) << at(r, s), at(r + 1, s), at(r + 1, s + 1);
            if (r > 0) body.mesh->body.triangles.row(f++) << at(r, s), at(r + 1, s + 1), at(r, s + 1);
        }
    body.settle();
    return body;
}

}  // namespace imomushi
