// SPDX-License-Identifier: GPL-3.0-or-later
// Decompositions of small matrices by Eigen, instantiated once: a room that names JacobiSVD or SelfAdjointEigenSolver takes up to a third longer to compile.
#pragma once

#include <Eigen/Geometry>

#include "core/base/vec3.h"

namespace imomushi {

/// m = u * diag(values) * v^T; u and v orthogonal (rotations or reflections), values >= 0, largest first.
struct SingularValues {
    Eigen::Matrix3d u, v;
    Vec3 values;
};

/// `m`: finite. The signs of the columns are Eigen's.
SingularValues singularValuesOf(const Eigen::Matrix3d& m);

/// Columns of `vectors` with their `values`, least first. Not `converged`: neither may be read.
template <int N>
struct Eigenpairs {
    Eigen::Matrix<double, N, 1> values;
    Eigen::Matrix<double, N, N> vectors;
    bool converged;
};

/// Of a symmetric matrix, of which the lower triangle is read; the vectors are orthonormal.
Eigenpairs<3> eigenpairsOf(const Eigen::Matrix3d& m);
Eigenpairs<4> eigenpairsOf(const Eigen::Matrix4d& m);
Eigenpairs<6> eigenpairsOf(const Eigen::Matrix<double, 6, 6>& m);
Eigenpairs<Eigen::Dynamic> eigenpairsOf(const Eigen::MatrixXd& m);
/// Of a v = lambda b v with a symmetric, b symmetric and positive definite: v^T b v = 1.
Eigenpairs<Eigen::Dynamic> eigenpairsOf(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// The x of m x = right for a symmetric m, semidefinite at least (LDL^T with pivots).
Eigen::VectorXd solveSymmetric(const Eigen::MatrixXd& m, const Eigen::VectorXd& right);

/// The x with the least |m x - right|, of several the shortest (complete orthogonal decomposition); column by column.
Eigen::VectorXd leastSquares(const Eigen::MatrixXd& m, const Eigen::VectorXd& right);
Eigen::MatrixXd leastSquares(const Eigen::MatrixXd& m, const Eigen::MatrixXd& right);

/// The shortest rotation that turns the direction of `from` to that of `to`; both finite and not zero. Of opposite directions: half a turn about some axis across.
Eigen::Quaterniond shortestRotation(const Vec3& from, const Vec3& to);

/// The rigid motion that brings the points `from` (3 x n) nearest to `to` in the mean square (Umeyama 1991).
Eigen::Matrix4d nearestMotion(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to);

}  // namespace imomushi
