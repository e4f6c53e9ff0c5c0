// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/meshing/solver_mesh.h"

namespace imomushi {

/// Measures that differ by less than about this share are equal: those of equal parts of a body, wherever it lies and however it is
/// turned or scaled. Rounding, also that of coordinates a million sizes from the origin, then does not decide how a body is cut.
inline constexpr double kTie = 1e-6;

/// A positive number by its order of magnitude, in steps of kTie: numbers compare as their grades do, and equal ones have the same but for the
/// rare one that lies just between two steps.
inline std::int64_t grade(double x) { return std::llround(std::log(std::max(x, 1e-300)) / kTie); }

/// A solver mesh as it is cut: triangles with their faces.
struct MeshPieces {
    std::vector<Vec3> points;
    std::vector<SolverMesh::Origin> origin;
    std::vector<std::array<std::int32_t, 3>> corners;
    std::vector<std::int32_t> face;  ///< -1: free

    explicit MeshPieces(const SolverMesh& mesh) : origin(mesh.origin), face(static_cast<std::size_t>(mesh.mesh.triangles.rows()), -1) {
        for (Eigen::Index v = 0; v < mesh.mesh.vertices.rows(); ++v) points.push_back(mesh.mesh.vertices.row(v).transpose());
        for (Eigen::Index t = 0; t < mesh.mesh.triangles.rows(); ++t)
            corners.push_back({mesh.mesh.triangles(t, 0), mesh.mesh.triangles(t, 1), mesh.mesh.triangles(t, 2)});
        for (std::size_t f = 0; f < mesh.faces.size(); ++f)
            for (const std::int32_t t : mesh.faces[f].triangles) face[static_cast<std::size_t>(t)] = static_cast<std::int32_t>(f);
    }

    /// A vertex between others.
    std::int32_t add(const std::array<std::int32_t, 3>& of, const std::array<double, 3>& share) {
        Vec3 p = Vec3::Zero();
        for (std::size_t k = 0; k < 3; ++k) p += share[k] * at(of[k]);
        points.push_back(p);
        origin.push_back({of, share});
        return static_cast<std::int32_t>(points.size()) - 1;
    }
    void triangle(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t label) {
        corners.push_back({a, b, c});
        face.push_back(label);
    }
    /// By the shorter diagonal, of equal ones the first.
    void quad(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d, std::int32_t label) {
        if ((at(a) - at(c)).squaredNorm() <= (1.0 + kTie) * (at(b) - at(d)).squaredNorm()) {
            triangle(a, b, c, label);
            triangle(a, c, d, label);
        } else {
            triangle(a, b, d, label);
            triangle(b, c, d, label);
        }
    }
    /// The parts of triangle k whose side c is halved by vertex m[c], -1: whole.
    void halved(const std::array<std::int32_t, 3>& k, const std::array<std::int32_t, 3>& m, std::int32_t label) {
        const int count = (m[0] >= 0) + (m[1] >= 0) + (m[2] >= 0);
        if (count == 0) return triangle(k[0], k[1], k[2], label);
        if (count == 3) {
            triangle(m[0], m[1], m[2], label);
            for (std::size_t c = 0; c < 3; ++c) triangle(k[c], m[c], m[(c + 2) % 3], label);
            return;
        }
        std::size_t c = 0;  // the only halved side, or the only whole one
        while ((m[c] >= 0) != (count == 1)) ++c;
        const std::int32_t a = k[c], b = k[(c + 1) % 3], apex = k[(c + 2) % 3];
        if (count == 1) {
            triangle(a, m[c], apex, label);
            triangle(m[c], b, apex, label);
        } else {
            triangle(apex, m[(c + 2) % 3], m[(c + 1) % 3], label);
            quad(a, b, m[(c + 1) % 3], m[(c + 2) % 3], label);
        }
    }
    [[nodiscard]] const Vec3& at(std::int32_t v) const { return points[static_cast<std::size_t>(v)]; }
    [[nodiscard]] Triangles table() const {
        Triangles out(static_cast<Eigen::Index>(corners.size()), 3);
        for (std::size_t t = 0; t < corners.size(); ++t)
            for (std::size_t c = 0; c < 3; ++c) out(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(c)) = corners[t][c];
        return out;
    }
    [[nodiscard]] SolverMesh joined(std::size_t faces) const {
        SolverMesh out;
        out.origin = origin;
        out.mesh.vertices.resize(static_cast<Eigen::Index>(points.size()), 3);
        for (std::size_t v = 0; v < points.size(); ++v) out.mesh.vertices.row(static_cast<Eigen::Index>(v)) = points[v].transpose();
        out.mesh.triangles = table();
        out.faces = patchesOf(out.mesh.triangles, face, faces);
        return out;
    }
};

}  // namespace imomushi
