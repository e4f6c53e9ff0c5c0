// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

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
};

/// Bisects triangles near the rims of the faces (longest edge first, so angles stay bounded away from zero) until their edges fit the
/// wanted size. Deterministic. No vertex is moved; body and faces keep their shape exactly.
SolverMesh solverMesh(const TriangleMesh& body, std::span<const JointFace> faces, const RimRefinement& refinement);

}  // namespace imomushi
