// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reduction/joint_stiffness.h"

#include <cblas.h>
#include <lapacke.h>

#include <Eigen/Geometry>
#include <Eigen/SparseCore>
#include <algorithm>

#include "core/base/finite.h"
#include "core/elasticity/dense_lu.h"
#include "core/mesh/topology.h"
#include "core/reduction/semidefinite_projection.h"

namespace imomushi {

namespace {

/// Relative ridge on the Gram matrix of the joint modes: modes that a small patch cannot tell apart (three vertices, twelve modes) share the load instead
/// of dividing by zero; regular ones change by rounding.
constexpr double kGramRidge = 1e-13;

/// Of the largest stiffness among joint parameters that displace their faces equally: below it is rounding.
constexpr double kNoStiffness = 1e-13;

/// A rigid motion is in the span of the joint modes when they miss it by no more than a flat face may be out of its plane.
constexpr double kRigidMiss = 2.0 * JointFace::kFlatTolerance;

/// Z <- L Z L^T, or L^-1 Z L^-T, of symmetric Z, with the lower triangle of `L`, some columns at a time. False: cancelled.
bool congruent(const Eigen::MatrixXd& L, bool inverse, Eigen::MatrixXd& Z, const Progress& progress) {
    const auto n = static_cast<int>(Z.rows());
    constexpr int kBatch = 256;
    for (int side = 0; side < 2; ++side) {
        for (int first = 0; first < n; first += kBatch) {
            if (progress.cancelled()) return false;
            const int count = std::min(kBatch, n - first);
            if (inverse)
                cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, n, count, 1.0, L.data(), n, &Z(0, first), n);
            else
                cblas_dtrmm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, n, count, 1.0, L.data(), n, &Z(0, first), n);
        }
        Z.transposeInPlace();
    }
    Z = (0.5 * (Z + Z.transpose())).eval();
    return true;
}

}  // namespace

Result<StiffnessQuality> projectStiffness(const HeldModes& modes, const SolverMesh& mesh, const Eigen::MatrixXd& loads, Eigen::MatrixXd& K,
                                          Eigen::MatrixXd& loadForces, const Progress& progress) {
    StiffnessQuality quality;
    useSingleThreadedBlas();
    const auto singular = [] { return fail("singular", "The joint modes of a face cannot be told apart; choose larger joint faces."); };
    const auto cancelled = [] { return fail(kCancelled, "The precompute was cancelled."); };
    const auto g = static_cast<int>(K.rows());
    const double symmetricNorm = (K + K.transpose()).norm();
    quality.asymmetry = symmetricNorm > 0.0 ? (K - K.transpose()).norm() / symmetricNorm : 0.0;

    // In parameters scaled to unit diagonal of W.
    const Eigen::SparseMatrix<double> C = modes.C.sparseView();
    const Eigen::MatrixXd massC = faceMass(mesh, modes.C);
    Eigen::MatrixXd W = C.transpose() * massC;
    const Eigen::VectorXd unit = W.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    W = (unit.asDiagonal() * (0.5 * (W + W.transpose())) * unit.asDiagonal()).eval();
    W.diagonal().array() += kGramRidge;
    Eigen::MatrixXd scaled = unit.asDiagonal() * (0.5 * (K + K.transpose())) * unit.asDiagonal();
    if (progress.cancelled()) return cancelled();

    // Rigid motions within the span of the modes: least squares in the mass norm, then the combinations whose residual is small.
    Eigen::MatrixXd factor = W;
    if (LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', g, factor.data(), g) != 0) return singular();
    if (progress.cancelled()) return cancelled();
    Eigen::MatrixXd rigid = unit.asDiagonal() * (massC.transpose() * modes.R);
    LAPACKE_dpotrs(LAPACK_COL_MAJOR, 'L', g, 6, factor.data(), g, rigid.data(), g);
    const Eigen::MatrixXd miss = modes.R - C * (unit.asDiagonal() * rigid);
    Eigen::MatrixXd missed = miss.transpose() * faceMass(mesh, miss), size = modes.R.transpose() * faceMass(mesh, modes.R);
    size.diagonal().array() += 1e-9 * size.trace();  // rotations that a single straight row of vertices cannot show
    Eigen::VectorXd ratio(6);
    if (LAPACKE_dsygv(LAPACK_COL_MAJOR, 1, 'V', 'L', 6, missed.data(), 6, size.data(), 6, ratio.data()) != 0) return singular();
    int found = 0;
    while (found < 6 && ratio[found] <= kRigidMiss * kRigidMiss) ++found;
    if (found > 0) {
        const Eigen::MatrixXd V = rigid * missed.leftCols(found);
        const Eigen::MatrixXd WV = W * V;
        Eigen::MatrixXd gram = V.transpose() * WV, along = WV.transpose();
        if (LAPACKE_dposv(LAPACK_COL_MAJOR, 'L', found, g, gram.data(), found, along.data(), found) != 0) return singular();
        if (loadForces.size() > 0) {
            const Eigen::MatrixXd forces = unit.asDiagonal() * loadForces;
            // `along` is gram^-1 (W V)^T, so that V^T along^T = I.
            const Eigen::MatrixXd missing = -missed.leftCols(found).transpose() * loads - V.transpose() * forces;
            loadForces = unit.cwiseInverse().asDiagonal() * (forces + along.transpose() * missing);
        }
        // The projector I - V along, on both sides.
        const Eigen::MatrixXd SV = scaled * V, VSV = V.transpose() * SV;
        scaled -= SV * along;
        scaled -= along.transpose() * SV.transpose() - along.transpose() * VSV.transpose() * along;
    }

    // K = L S L^T with W = L L^T: S has the eigenvalues of K relative to W. Negative ones come of rounding or of a coarse mesh and are set to zero.
    if (!congruent(factor, true, scaled, progress)) return cancelled();
    const auto spectrum = projectToSemidefinite(scaled, progress);
    if (!spectrum) return tl::make_unexpected(spectrum.error());
    quality.negativeEnergy = spectrum->highest > 0.0 ? std::min(spectrum->lowest, 0.0) / spectrum->highest : 0.0;
    if (!congruent(factor, false, scaled, progress)) return cancelled();
    const Eigen::VectorXd back = unit.cwiseInverse();
    K = back.asDiagonal() * scaled * back.asDiagonal();
    K = (0.5 * (K + K.transpose())).eval();  // to the last bit
    // Parameters that move a body of one face rigidly have a stiffness of rounding errors, which may be negative.
    for (int i = 0; i < g; ++i)
        if (scaled(i, i) <= kNoStiffness * scaled.diagonal().maxCoeff()) {
            K.row(i).setZero();
            K.col(i).setZero();
        }
    if (!allFinite(K)) return singular();
    return quality;
}

Eigen::MatrixXd nodalTractions(const TriangleMesh& body, std::span<const JointFace> faces, const HeldModes& modes, const std::vector<int>& firstColumn,
                               const Eigen::MatrixXd& forces) {
    useSingleThreadedBlas();
    const Eigen::Index g = forces.cols();
    Eigen::MatrixXd tractions(forces.rows(), g), R(forces.rows(), 6), massR(forces.rows(), 6), total = Eigen::MatrixXd::Zero(6, g);
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const JointFace& face = faces[f];
        const auto m = static_cast<Eigen::Index>(face.vertices.size());
        const auto at = [&](std::int32_t triangle, int corner) {
            return std::lower_bound(face.vertices.begin(), face.vertices.end(), body.triangles(triangle, corner)) - face.vertices.begin();
        };
        Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(m, m), x(m, 3 * g);
        for (const std::int32_t t : face.triangles)
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < 3; ++b) mass(at(t, a), at(t, b)) += (a == b ? 2.0 : 1.0) / 24.0 * areaVector(body, t).norm();
        for (Eigen::Index i = 0; i < m; ++i) {
            const Eigen::Index row = firstColumn[f] + 3 * i;
            const Eigen::MatrixXd force = face.frame.axes * forces.middleRows(row, 3);
            const Vec3 arm = (Vec3(body.vertices.row(face.vertices[static_cast<std::size_t>(i)]).transpose()) - modes.middle) / modes.size;
            for (int axis = 0; axis < 3; ++axis) {
                x.row(i).segment(axis * g, g) = force.row(axis);
                R.block<3, 1>(row, axis) = Vec3::Unit(axis);
                R.block<3, 1>(row, 3 + axis) = Vec3::Unit(axis).cross(arm);
            }
            total += R.middleRows(row, 3).transpose() * force;
        }
        for (Eigen::Index i = 0; i < m; ++i) {
            massR.middleRows(firstColumn[f] + 3 * i, 3).setZero();
            for (Eigen::Index k = 0; k < m; ++k) massR.middleRows(firstColumn[f] + 3 * i, 3) += mass(i, k) * R.middleRows(firstColumn[f] + 3 * k, 3);
        }
        const auto size = static_cast<lapack_int>(m);
        if (LAPACKE_dposv(LAPACK_COL_MAJOR, 'L', size, static_cast<lapack_int>(3 * g), mass.data(), size, x.data(), size) != 0) return {};
        for (Eigen::Index i = 0; i < m; ++i)
            for (int axis = 0; axis < 3; ++axis) tractions.row(firstColumn[f] + 3 * i + axis) = x.row(i).segment(axis * g, g);
    }
    Eigen::MatrixXd gram = R.transpose() * massR;
    if (LAPACKE_dposv(LAPACK_COL_MAJOR, 'L', 6, static_cast<lapack_int>(g), gram.data(), 6, total.data(), 6) != 0) return {};
    tractions -= R * total;
    return tractions;
}

}  // namespace imomushi
