// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/elasticity/block_source.h"

namespace imomushi {

/// A low-rank approximation U V^T of a block, or why there is none.
struct LowRank {
    enum class Outcome { done, full, cancelled, notFinite } outcome = Outcome::done;  ///< full: the dense block needs less memory
    std::int32_t rank = 0;
    std::vector<double> u, v;  ///< rows x rank, columns x rank, by columns
};

/// Adaptive cross approximation (ACA: Bebendorf, Numer. Math. 86 (2000) 565) of the block of rowNodes x columnNodes, three rows and columns each, to a
/// quarter of the absolute error `tolerance` (Frobenius norm); recompress() may take the rest. Pivot rows and columns are taken three at a time, those of
/// a node, and the residual is checked on sampled rows before the approximation is accepted.
LowRank partiallyPivotedCross(const BlockSource& source, std::span<const std::int32_t> rowNodes, std::span<const std::int32_t> columnNodes,
                              double tolerance, const Progress& progress);

/// The same for a block of which all entries are known: a, m x n by columns, is replaced by the residual. Every pivot is the largest entry of the
/// residual, so that no part of the block can be overlooked.
LowRank fullyPivotedCross(std::vector<double>& a, std::int32_t m, std::int32_t n, double tolerance);

/// Truncates U V^T, m x n, to the smallest rank with an error of at most `tolerance` (Frobenius norm), by QR of both factors and the singular values of
/// their core (Bebendorf, Hierarchical Matrices, 2008, section 1.1.4). The singular values go into U. False: LAPACK did not converge.
bool recompress(LowRank& block, std::int32_t m, std::int32_t n, double tolerance);

}  // namespace imomushi
