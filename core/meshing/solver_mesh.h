// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/joints/joint_face.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// The mesh that is solved on: the same polyhedron as the body, with more vertices. Responses are kept at the body's vertices only, so
/// that refining costs no frame time.
struct SolverMesh {
    TriangleMesh mesh;  ///< its first vertices are the body's, in their order
    struct Patch {
        std::vector<std::int32_t> vertices;   ///< ascending, the rim included
        std::vector<std::int32_t> triangles;  ///< ascending
    };
    std::vector<Patch> faces;  ///< one per joint face
    /// Where a vertex lies: between vertices before it, with these shares (they add up to 1; a share of 0 fills an entry that is not needed).
    struct Origin {
        std::array<std::int32_t, 3> of;
        std::array<double, 3> share;
    };
    std::vector<Origin> origin;  ///< of each vertex after the body's
    std::vector<std::array<std::int32_t, 2>> bubbles;  ///< edges along which the displacement is quadratic, ascending; see BoundaryEquation
};

/// The body itself, with linear displacement.
SolverMesh plainSolverMesh(const TriangleMesh& body, std::span<const JointFace> faces);

/// Vertices and triangles of each of `count` faces; `face`: that of each triangle, -1: none.
std::vector<SolverMesh::Patch> patchesOf(const Triangles& triangles, std::span<const std::int32_t> face, std::size_t count);

/// The same surface with a vertex in the middle of every edge that has a bubble, in their order after the others; without bubbles itself.
SolverMesh halvedAtBubbles(const SolverMesh& mesh);

/// Bisects the body, always where edges are longest relative to the wanted size, until it has exactly `vertices` vertices. The wanted size
/// is the same everywhere but near rims of faces and near re-entrant edges, where the solution is singular: there it shrinks with the distance,
/// to kFinestRefined of the size elsewhere. Convex edges need no more than their surroundings. Deterministic, no vertex is moved.
/// Errors: "too-few-vertices" (fewer than the body has), "bad-value" (more than SolverMeshSetting::kMax, or no area to bisect).
Result<SolverMesh> refinedSolverMesh(const TriangleMesh& body, std::span<const JointFace> faces, int vertices);
inline constexpr double kFinestRefined = 0.25;

/// An edge at which the solution is singular.
struct SingularEdge {
    std::int32_t low = 0, high = 0;
    std::int32_t face = -1;  ///< whose rim it is; -1: a free edge, sharp and re-entrant
};
/// Ascending by their vertices.
std::vector<SingularEdge> singularEdges(const SolverMesh& mesh);

/// Bisects the body until no edge of a triangle is longer than the least of `longest` (m, per body vertex) at its corners. That of a new vertex is the mean of those that it lies between, or
/// what `between` says of its place, where that is longer. `face`: that of each triangle, -1: none; of `count`. Deterministic, no vertex is moved.
SolverMesh bisectedTo(const TriangleMesh& body, std::vector<std::int32_t> face, std::size_t count, std::vector<double> longest, const std::function<double(const Vec3&)>& between = {});

}  // namespace imomushi
