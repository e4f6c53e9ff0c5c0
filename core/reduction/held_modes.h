// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/joints/face_basis.h"
#include "core/joints/joint_face.h"
#include "core/mesh/mesh.h"
#include "core/meshing/solved_body.h"

namespace imomushi {

/// The displacement of all held vertices of a solver mesh by joint parameters and by rigid motions. Rows: face by face, xyz of each vertex, as
/// BoundaryProblem::solve() takes them.
struct HeldModes {
    Eigen::MatrixXd C;          ///< 3 * #held x g: displacement (m) per unit of a joint parameter, world axes
    Eigen::MatrixXd inside;     ///< 3 * #SolvedBody::inside x g: the same of these body vertices
    Eigen::MatrixXd R;          ///< 3 * #held x 6: translations along the axes, rotations about `middle` per `size`
    Vec3 middle = Vec3::Zero(); ///< of the mesh's bounding box
    double size = 1.0;          ///< m, its diagonal
};
/// `body`, `faces`: which a full basis has its parameters on; `bases`, `firstColumn`: as in ElementResponse.
HeldModes heldModes(const TriangleMesh& body, std::span<const JointFace> faces, const SolvedBody& solved, const std::vector<FaceBasis>& bases, const std::vector<int>& firstColumn);

/// The displacement of the held vertices, 3 * #held x 1, that is linear between the displacements of the body's vertices, #V x 3.
Eigen::MatrixXd heldDisplacement(const SolvedBody& solved, const Points& body);

/// M Z for the mass matrix M of linear functions on the faces, M_ab = int N_a N_b dS (m^2), and Z of 3 * #held x any.
Eigen::MatrixXd faceMass(const SolverMesh& mesh, const Eigen::MatrixXd& Z);

}  // namespace imomushi
