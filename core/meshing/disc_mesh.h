// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/joints/joint_face.h"
#include "core/meshing/solver_mesh.h"

namespace imomushi {

/// The body with the outlines of its handles' discs (JointFace::disc) as edges: what is held, and so the answer, then does not depend on how the surface is
/// divided into triangles.
struct DiscMesh {
    SolverMesh mesh;                 ///< the same polyhedron, finer near discs
    std::vector<char> exact;         ///< per face, 1: its disc is held; 0: its triangles are held
    /// In which disc body vertices lie that are in no face: they move as it does.
    struct Inside {
        std::int32_t vertex = 0, face = 0;
    };
    std::vector<Inside> inside;      ///< by vertex, ascending

    [[nodiscard]] bool any() const { return std::any_of(exact.begin(), exact.end(), [](char e) { return e != 0; }); }
    /// The faces with vertices and triangles of `mesh`.
    [[nodiscard]] std::vector<JointFace> faces(std::span<const JointFace> ofBody) const;
};

/// Edges across an outline are about this part of the radius, or shorter.
inline constexpr double kDiscEdge = 0.2;

/// A disc that cannot be met so is held by its triangles: where the body is too coarse for it, where it would come near another face or close around a limb. Where
/// that holds for all, or there is none, `mesh` is empty.
DiscMesh discMesh(const TriangleMesh& body, std::span<const JointFace> faces);

}  // namespace imomushi
