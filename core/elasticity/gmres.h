// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "core/base/progress.h"
#include "core/elasticity/hierarchical_matrix.h"
#include "core/elasticity/hodlr_factorisation.h"

namespace imomushi {

/// Right-hand sides that are best solved together.
constexpr std::int32_t kGmresColumns = 16;

/// Restarted GMRES with a right preconditioner (Saad, Iterative Methods for Sparse Linear Systems, 2003, algorithm 9.5), each right-hand side with its own
/// Krylov space, all advanced together so that every product reads the matrix once. Bases are in single precision; residuals and solutions in double.
/// Vectors are in the order of the cluster tree. right: right-hand sides in, residuals out. goal: relative residual at which a column stops. Stops earlier
/// where restarts gain nothing. Adds the steps to `iterations`. The same bytes for any number of threads. False: cancelled.
bool gmres(const HierarchicalMatrix& matrix, const HodlrFactorisation& preconditioner, Eigen::MatrixXd& right, Eigen::MatrixXd& x, double goal,
           int& iterations, int threads, const Progress& progress);

/// Bytes that gmres() holds for kGmresColumns columns; ranks: HierarchicalMatrix::ranks().
std::size_t gmresBytes(std::int32_t nodes, std::size_t ranks);

}  // namespace imomushi
