// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/joints/joint_face.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// How much finer than the body its solver mesh is. The solution is singular at the rims of joint faces, and that is where a coarse mesh loses
/// its accuracy: refining there costs few vertices and no frame time, since responses are kept at the body's vertices only.
struct RimRefinement {
    int levels = 0;         ///< edges at a rim are 2^-levels of the rim's own edges, 0...8; 0: the body as it is
    double grading = 0.6;   ///< away from a rim an edge may be as long as this times its distance from it, > 0
};

/// The mesh that is solved on: the same polyhedron as the body, with more vertices.
struct SolverMesh {
    TriangleMesh mesh;  ///< its first vertices are the body's, in their order
    struct Patch {
        std::vector<std::int32_t> vertices;   ///< ascending, the rim included
        std::vector<std::int32_t> triangles;  ///< ascending
    };
    std::vector<Patch> faces;  ///< one per joint face
    std::vector<std::array<std::int32_t, 2>> midpointOf;  ///< of each vertex after the body's: the two vertices, both before it, that it is midway between
};

/// Bisects triangles near the rims of the faces (longest edge first, so angles stay bounded away from zero) until their edges fit the
/// wanted size. Deterministic. No vertex is moved; body and faces keep their shape exactly.
SolverMesh solverMesh(const TriangleMesh& body, std::span<const JointFace> faces, const RimRefinement& refinement);

/// Bisects the body, always where edges are longest relative to the wanted size, until it has exactly `vertices` vertices. The wanted size
/// is the same everywhere but near rims of faces and near re-entrant edges, where the solution is singular: there it shrinks with the distance,
/// to kFinestRefined of the size elsewhere. Convex edges need no more than their surroundings. Deterministic, no vertex is moved.
/// Errors: "too-few-vertices" (fewer than the body has), "bad-value" (more than SolverMeshSetting::kMost, or no area to bisect).
Result<SolverMesh> refinedSolverMesh(const TriangleMesh& body, std::span<const JointFace> faces, int vertices);
inline constexpr double kFinestRefined = 0.25;

}  // namespace imomushi
