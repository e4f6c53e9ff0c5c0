// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <random>
#include <vector>

#include "core/mesh/mesh.h"

/// What goes wrong with meshes on their way.
namespace imomushi::messes {

inline TriangleMesh both(const TriangleMesh& a, const TriangleMesh& b) {
    TriangleMesh m;
    m.vertices.resize(a.vertices.rows() + b.vertices.rows(), 3);
    m.vertices << a.vertices, b.vertices;
    m.triangles.resize(a.triangles.rows() + b.triangles.rows(), 3);
    m.triangles << a.triangles, (b.triangles.array() + static_cast<std::int32_t>(a.vertices.rows())).matrix();
    return m;
}

inline TriangleMesh inverted(TriangleMesh m) {
    m.triangles.col(1).swap(m.triangles.col(2));
    return m;
}

inline TriangleMesh moved(TriangleMesh m, double scale, const Vec3& shift) {
    m.vertices = ((m.vertices * scale).rowwise() + shift.transpose()).eval();
    return m;
}

/// Every triangle with vertices of its own, as STL has it, drawn towards its middle: 1 leaves it, 0.9 opens a slit around it.
inline TriangleMesh exploded(const TriangleMesh& m, double size) {
    TriangleMesh e;
    e.vertices.resize(m.triangles.rows() * 3, 3);
    e.triangles.resize(m.triangles.rows(), 3);
    for (Eigen::Index f = 0; f < m.triangles.rows(); ++f) {
        const Eigen::RowVector3d middle = (m.vertices.row(m.triangles(f, 0)) + m.vertices.row(m.triangles(f, 1)) + m.vertices.row(m.triangles(f, 2))) / 3;
        for (int k = 0; k < 3; ++k) {
            const Eigen::RowVector3d p = m.vertices.row(m.triangles(f, k));
            e.vertices.row(3 * f + k) = size == 1.0 ? p : Eigen::RowVector3d(middle + size * (p - middle));
            e.triangles(f, k) = static_cast<std::int32_t>(3 * f + k);
        }
    }
    return e;
}

inline TriangleMesh without(const TriangleMesh& m, const std::vector<std::int32_t>& triangles) {
    TriangleMesh r;
    r.vertices = m.vertices;
    r.triangles.resize(m.triangles.rows(), 3);
    Eigen::Index n = 0;
    for (std::int32_t f = 0; f < m.triangles.rows(); ++f)
        if (std::find(triangles.begin(), triangles.end(), f) == triangles.end()) r.triangles.row(n++) = m.triangles.row(f);
    r.triangles.conservativeResize(n, 3);
    return r;
}

/// One triangle more, over these vertices.
inline TriangleMesh withTriangle(TriangleMesh m, int a, int b, int c) {
    m.triangles.conservativeResize(m.triangles.rows() + 1, 3);
    m.triangles.bottomRows(1) << a, b, c;
    return m;
}

/// Triangles removed, turned and repeated, vertices shifted, by chance.
inline TriangleMesh broken(const TriangleMesh& m, unsigned seed, double removed, double turned, double repeated, double shift) {
    std::mt19937 random(seed);
    const auto chance = [&](double p) { return static_cast<double>(random()) < p * 4294967296.0; };
    TriangleMesh out = m;
    for (Eigen::Index i = 0; i < out.vertices.size(); ++i) out.vertices.data()[i] += shift * (static_cast<double>(random()) / 2147483648.0 - 1.0);
    std::vector<Eigen::Matrix<std::int32_t, 1, 3>> triangles;
    for (Eigen::Index f = 0; f < m.triangles.rows(); ++f) {
        if (chance(removed)) continue;
        Eigen::Matrix<std::int32_t, 1, 3> t = m.triangles.row(f);
        if (chance(turned)) std::swap(t[1], t[2]);
        triangles.push_back(t);
        if (chance(repeated)) triangles.push_back(t);
    }
    out.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
    for (std::size_t f = 0; f < triangles.size(); ++f) out.triangles.row(static_cast<Eigen::Index>(f)) = triangles[f];
    return out;
}

}  // namespace imomushi::messes
