// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/joints/joint_face.h"
#include "core/mesh/mesh.h"
#include "core/reduction/held_modes.h"

namespace imomushi {

/// What projectStiffness() found; see ResponseQuality.
struct StiffnessQuality {
    double asymmetry = 0.0, negativeEnergy = 0.0;
};

/// Projects the raw joint stiffness K = C^T M T (g x g, T the tractions) onto stiffnesses: symmetric, zero on rigid motions, positive semidefinite. The
/// metric is W = C^T M C, which measures joint parameters by the displacement that they make, so that metres and radians need no weights of their own.
/// `loadForces` (g x k) are changed by the least that balances the resultants `loads` (6 x k) on rigid motions.
/// Errors: "singular": W is not positive definite, or K not finite (a face without area); "cancelled".
Result<StiffnessQuality> projectStiffness(const HeldModes& modes, const SolverMesh& mesh, const Eigen::MatrixXd& loads, Eigen::MatrixXd& K,
                                          Eigen::MatrixXd& loadForces, const Progress& progress);

/// The tractions, linear on the triangles of the faces, whose nodal forces are `forces` (3 m x g, in the axes of each face, row 3 i + axis of vertex i):
/// 3 m x g in element axes. Minus the linear field that balances them in force and moment, as collocation balances only up to its discretisation error.
/// Empty: a face without area.
Eigen::MatrixXd nodalTractions(const TriangleMesh& body, std::span<const JointFace> faces, const HeldModes& modes, const std::vector<int>& firstColumn,
                               const Eigen::MatrixXd& forces);

}  // namespace imomushi
