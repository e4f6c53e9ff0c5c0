// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/elasticity/boundary_problem.h"
#include "core/joints/joint_face.h"
#include "core/mesh/mesh.h"
#include "core/meshing/solved_body.h"
#include "core/reduction/touch_patches.h"

namespace imomushi {

/// Response of an element to contact forces on its touch patches, with all joint faces at rest, for shear modulus 1. Column 3 p + axis: a force along that
/// axis of the element rest axes, distributed over patch p like its weights; displacement per force over the shear modulus, m / m^2. Empty where it was
/// not asked for.
struct TouchResponse {
    TouchPatches patches;
    Eigen::MatrixXf displacement;  ///< 3 * #free x 3 P, rows as those of ElementResponse::response
    Eigen::MatrixXd forces;        ///< g x 3 P: with patch forces f and joint parameters v the faces are held by K v + forces f
    /// 3 P x 3 P: weighted mean displacement of patch p by a force on patch q. Symmetric, positive semidefinite.
    Eigen::MatrixXd compliance;
    /// Vertices where the displacement gradient is largest: for every patch by a force on that patch, and by one on any other. While the largest singular
    /// value of all gradients is below 1, the deformation is injective there.
    std::vector<std::int32_t> probes;
    Eigen::MatrixXf gradients;    ///< 9 #probes x 3 P: 3 i + j of each is d u_i / d x_j per force over the shear modulus, 1/m^2
    double asymmetry = 0.0;       ///< |C - C^T| / |C + C^T| (Frobenius) of the raw compliance C: error of reciprocity
    double negativeEnergy = 0.0;  ///< most negative eigenvalue of C over the largest, before it was set to zero

    [[nodiscard]] int columns() const { return static_cast<int>(displacement.cols()); }
    [[nodiscard]] std::size_t bytes() const;
};

/// The tractions of the patches on the solver mesh, each of total force 1: #V x P. `body`: that of the patches and of `solved`.
Eigen::MatrixXd patchTractions(const TouchPatches& patches, const TriangleMesh& body, std::span<const JointFace> faces, const SolvedBody& solved);

/// Resultants of the tractions: 6 x 3 P, the force (m^2), and its moment about `middle` over `size`.
Eigen::MatrixXd patchResultants(const SolverMesh& mesh, const Eigen::MatrixXd& tractions, const Vec3& middle, double size);

/// The raw compliance, 3 P x 3 P; `solution`: its last columns are those of the tractions.
Eigen::MatrixXd patchCompliance(const SolverMesh& mesh, const Eigen::MatrixXd& tractions, const std::vector<std::int32_t>& freeVertices,
                                const BoundaryProblem::Solution& solution);

/// Projects the compliance to a symmetric positive semidefinite one and finds probes and gradients; `response` has patches, displacement, forces and the raw
/// compliance. `free`: rows of displacement. Errors: "cancelled"; "singular" (not finite).
Result<void> finishTouch(const TriangleMesh& body, std::span<const JointFace> faces, const std::vector<std::int32_t>& free, double nu, int threads,
                         TouchResponse& response, const Progress& progress);

}  // namespace imomushi
