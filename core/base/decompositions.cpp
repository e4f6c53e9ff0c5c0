// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/base/decompositions.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <numbers>

namespace imomushi {

namespace {

/// 1 + cosine below which two directions are opposite: nearer, their cross product has no digits left.
constexpr double kOpposite = 1e-12;

template <int N, class Solver>
Eigenpairs<N> pairsOf(const Solver& solver) {
    return {solver.eigenvalues(), solver.eigenvectors(), solver.info() == Eigen::Success};
}

}  // namespace

SingularValues singularValuesOf(const Eigen::Matrix3d& m) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
    return {svd.matrixU(), svd.matrixV(), svd.singularValues()};
}

Eigenpairs<3> eigenpairsOf(const Eigen::Matrix3d& m) { return pairsOf<3>(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(m)); }
Eigenpairs<4> eigenpairsOf(const Eigen::Matrix4d& m) { return pairsOf<4>(Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(m)); }
Eigenpairs<6> eigenpairsOf(const Eigen::Matrix<double, 6, 6>& m) { return pairsOf<6>(Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(m)); }
Eigenpairs<Eigen::Dynamic> eigenpairsOf(const Eigen::MatrixXd& m) { return pairsOf<Eigen::Dynamic>(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(m)); }

Eigenpairs<Eigen::Dynamic> eigenpairsOf(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return pairsOf<Eigen::Dynamic>(Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(a, b));
}

Eigen::VectorXd solveSymmetric(const Eigen::MatrixXd& m, const Eigen::VectorXd& right) { return m.ldlt().solve(right); }

Eigen::VectorXd leastSquares(const Eigen::MatrixXd& m, const Eigen::VectorXd& right) { return m.completeOrthogonalDecomposition().solve(right); }
Eigen::MatrixXd leastSquares(const Eigen::MatrixXd& m, const Eigen::MatrixXd& right) { return m.completeOrthogonalDecomposition().solve(right); }

Eigen::Quaterniond shortestRotation(const Vec3& from, const Vec3& to) {
    const Vec3 a = from.stableNormalized(), b = to.stableNormalized();
    const double cosine = a.dot(b);
    // Eigen's own asks an SVD of 3 x 2 for the axis of opposite directions, which takes ten seconds to compile.
    if (cosine < -1.0 + kOpposite) return Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, a.unitOrthogonal()));
    const double twice = std::sqrt(2.0 * (1.0 + cosine));  // of the half angle's cosine
    const Vec3 axis = a.cross(b) / twice;
    return {0.5 * twice, axis.x(), axis.y(), axis.z()};
}

Eigen::Matrix4d nearestMotion(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to) { return Eigen::umeyama(from, to, false); }

}  // namespace imomushi
