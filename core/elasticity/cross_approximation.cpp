// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/cross_approximation.h"

#include <cblas.h>
#include <lapacke.h>

#include <algorithm>
#include <cmath>

#include "core/base/finite.h"


namespace imomushi {

namespace {

/// Crosses are added until the residual is this share of the allowed error; recompression may spend the rest.
constexpr double kCrossShare = 0.25;
/// Sampled rows of a block in which the residual is checked.
constexpr std::int32_t kCheckedRows = 8;
/// A pivot below this share of the largest entry in its row would amplify rounding errors.
constexpr double kPivotShare = 0.1;

}  // namespace

LowRank fullyPivotedCross(std::vector<double>& a, std::int32_t m, std::int32_t n, double tolerance) {
    LowRank out;
    const std::int32_t worthwhile = m * n / (m + n);  // above, the dense block is smaller
    const double negligible = kCrossShare * tolerance;
    if (!allFinite(a)) {
        out.outcome = LowRank::Outcome::notFinite;
        return out;
    }
    for (;; ++out.rank) {
        if (std::sqrt(cblas_ddot(m * n, a.data(), 1, a.data(), 1)) <= negligible) return out;
        if (out.rank >= worthwhile) {
            out.outcome = LowRank::Outcome::full;
            return out;
        }
        const auto at = static_cast<std::int32_t>(cblas_idamax(m * n, a.data(), 1));
        const std::int32_t i = at % m, j = at / m;
        const double pivot = a[static_cast<std::size_t>(at)];
        out.u.insert(out.u.end(), a.begin() + static_cast<std::ptrdiff_t>(m) * j, a.begin() + static_cast<std::ptrdiff_t>(m) * (j + 1));
        for (std::int32_t l = 0; l < n; ++l) out.v.push_back(a[static_cast<std::size_t>(m) * l + i] / pivot);
        cblas_dger(CblasColMajor, m, n, -1.0, out.u.data() + static_cast<std::size_t>(m) * out.rank, 1,
                   out.v.data() + static_cast<std::size_t>(n) * out.rank, 1, a.data(), m);
    }
}

LowRank partiallyPivotedCross(const BlockSource& source, std::span<const std::int32_t> rowNodes, std::span<const std::int32_t> columnNodes,
                          double tolerance, const Progress& progress) {
    LowRank out;
    const auto m = static_cast<std::int32_t>(rowNodes.size()), n = static_cast<std::int32_t>(columnNodes.size());
    const std::int32_t m3 = 3 * m, n3 = 3 * n;
    const std::int32_t worthwhile = m3 * n3 / (m3 + n3);  // above, the dense block is smaller
    const std::unique_ptr<BlockSource::Columns> columns = source.columns(columnNodes);
    std::vector<double> row(static_cast<std::size_t>(3 * n3)), rowRight(row.size()), column(static_cast<std::size_t>(3 * m3));
    std::vector<char> usedRow(static_cast<std::size_t>(m));
    auto& u = out.u;
    auto& v = out.v;
    auto& rank = out.rank;

    // The residual in the three rows of node i into `row`: row[3 j + a], 3 x n3 by columns.
    const auto takeRow = [&](std::int32_t i) {
        columns->rows(rowNodes.subspan(static_cast<std::size_t>(i), 1), row.data());
        if (!allFinite(row)) return false;
        if (rank > 0)
            cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, 3, n3, rank, -1.0, u.data() + 3 * i, m3, v.data(), n3, 1.0, row.data(), 3);
        return true;
    };
    const auto squared = [](const std::vector<double>& x) { return cblas_ddot(static_cast<int>(x.size()), x.data(), 1, x.data(), 1); };
    // Rows are in the order of the tree, so that one random row of each of some equal shares samples the whole block.
    std::uint64_t random = 0x9e3779b97f4a7c15u;
    const auto randomRowOf = [&](std::int32_t share, std::int32_t shares) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        const std::int64_t begin = static_cast<std::int64_t>(m) * share / shares, end = static_cast<std::int64_t>(m) * (share + 1) / shares;
        return static_cast<std::int32_t>(begin + static_cast<std::int64_t>((random >> 33) % static_cast<std::uint64_t>(end - begin)));
    };
    const double negligible = kCrossShare * tolerance;
    std::vector<double> seen(static_cast<std::size_t>(m));  // per node: sum of squares of the residual in the columns of the last cross

    std::int32_t next = randomRowOf(0, 1);
    bool taken = false;  // `row` already holds the residual of node `next`
    while (true) {
        if (progress.cancelled()) {
            out.outcome = LowRank::Outcome::cancelled;
            return out;
        }
        double added = 0.0;
        if (next >= 0) {
            if (!taken && !takeRow(next)) {
                out.outcome = LowRank::Outcome::notFinite;
                return out;
            }
            taken = false;
            usedRow[static_cast<std::size_t>(next)] = 1;
            std::fill(seen.begin(), seen.end(), 0.0);
            // One column node often has no pivot for all three rows: on a plane, displacement across it and along it do not couple.
            for (int round = 0; round < 3; ++round) {
                std::int32_t best = -1;
                double largest = 0.0;
                for (std::int32_t j = 0; j < n; ++j) {
                    double sum = 0.0;
                    for (int k = 0; k < 9; ++k) sum += row[static_cast<std::size_t>(9 * j + k)] * row[static_cast<std::size_t>(9 * j + k)];
                    if (sum > largest) {
                        largest = sum;
                        best = j;
                    }
                }
                // A cross through rows below the tolerance would add rounding only.
                if (best < 0 || std::sqrt(squared(row) * m) <= negligible) break;
                source.columns(columnNodes.subspan(static_cast<std::size_t>(best), 1))->rows(rowNodes, column.data());
                if (!allFinite(column)) {
                    out.outcome = LowRank::Outcome::notFinite;
                    return out;
                }
                if (rank > 0)
                    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, m3, 3, rank, -1.0, u.data(), m3, v.data() + 3 * best, n3, 1.0,
                                column.data(), m3);
                for (std::int32_t i = 0; i < m; ++i)
                    for (std::int32_t l = 0; l < 3; ++l)
                        for (int k = 0; k < 3; ++k) {
                            const double entry = column[static_cast<std::size_t>(m3 * l + 3 * i + k)];
                            seen[static_cast<std::size_t>(i)] += entry * entry;
                        }
                for (int step = 0; step < 3; ++step) {
                    int a = 0, b = 0;
                    double pivot = 0.0;
                    for (int i = 0; i < 3; ++i)
                        for (int j = 0; j < 3; ++j) {
                            const double entry = column[static_cast<std::size_t>(m3 * j + 3 * next + i)];
                            if (std::abs(entry) > std::abs(pivot)) pivot = entry, a = i, b = j;
                        }
                    double inRow = 0.0;
                    for (std::int32_t j = 0; j < n3; ++j) inRow = std::max(inRow, std::abs(row[static_cast<std::size_t>(3 * j + a)]));
                    if (pivot == 0.0 || std::abs(pivot) < kPivotShare * inRow) break;
                    u.resize(u.size() + static_cast<std::size_t>(m3));
                    v.resize(v.size() + static_cast<std::size_t>(n3));
                    double* newU = u.data() + static_cast<std::size_t>(rank) * m3;
                    double* newV = v.data() + static_cast<std::size_t>(rank) * n3;
                    ++rank;
                    for (std::int32_t i = 0; i < m3; ++i) newU[i] = column[static_cast<std::size_t>(m3 * b + i)] / pivot;
                    for (std::int32_t j = 0; j < n3; ++j) newV[j] = row[static_cast<std::size_t>(3 * j + a)];
                    cblas_dger(CblasColMajor, m3, 3, -1.0, newU, 1, newV + 3 * best, 1, column.data(), m3);
                    cblas_dger(CblasColMajor, 3, n3, -1.0, newU + 3 * next, 1, newV, 1, row.data(), 3);
                    added = std::max(added, cblas_dnrm2(m3, newU, 1) * cblas_dnrm2(n3, newV, 1));
                }
                if (rank >= worthwhile) {
                    out.outcome = LowRank::Outcome::full;
                    return out;
                }
            }
            // The next pivot row is where the residual in the columns of this cross is largest.
            next = -1;
            double largest = 0.0;
            for (std::int32_t i = 0; i < m; ++i)
                if (!usedRow[static_cast<std::size_t>(i)] && seen[static_cast<std::size_t>(i)] > largest) {
                    largest = seen[static_cast<std::size_t>(i)];
                    next = i;
                }
        }
        if (added > negligible && next >= 0) continue;
        // A small cross does not prove a small residual (rows or columns of zeros, parts that do not couple): sample rows of the whole block.
        double sum = 0.0, worst = -1.0;
        std::int32_t looked = 0, worstRow = -1;
        for (std::int32_t share = 0; share < kCheckedRows; ++share) {
            const std::int32_t i = randomRowOf(share, kCheckedRows);
            if (usedRow[static_cast<std::size_t>(i)]) continue;
            if (!takeRow(i)) {
                out.outcome = LowRank::Outcome::notFinite;
                return out;
            }
            const double residual = squared(row);
            ++looked;
            sum += residual;
            if (residual > worst) {
                worst = residual;
                worstRow = i;
                row.swap(rowRight);
            }
        }
        if (looked == 0 || std::sqrt(sum * m / looked) <= 2.0 * negligible) return out;
        next = worstRow;
        row.swap(rowRight);
        taken = true;
    }
}

bool recompress(LowRank& a, std::int32_t m, std::int32_t n, double tolerance) {
    const std::int32_t k = a.rank;
    if (k == 0) return true;
    const auto square = static_cast<std::size_t>(k) * k;
    std::vector<double> tauU(static_cast<std::size_t>(k)), tauV(tauU.size());
    if (k > m || k > n) return true;
    // The work_ functions of LAPACKE: the others search their arguments for NaN first.
    const std::int32_t room = 64 * k;
    std::vector<double> work(static_cast<std::size_t>(room));
    if (LAPACKE_dgeqrf_work(LAPACK_COL_MAJOR, m, k, a.u.data(), m, tauU.data(), work.data(), room) != 0) return false;
    if (LAPACKE_dgeqrf_work(LAPACK_COL_MAJOR, n, k, a.v.data(), n, tauV.data(), work.data(), room) != 0) return false;
    std::vector<double> core(square), left(square), right(square), sigma(static_cast<std::size_t>(k));
    for (std::int32_t j = 0; j < k; ++j)
        for (std::int32_t i = 0; i <= j; ++i) core[static_cast<std::size_t>(j) * k + i] = a.u[static_cast<std::size_t>(j) * m + i];
    cblas_dtrmm(CblasColMajor, CblasRight, CblasUpper, CblasTrans, CblasNonUnit, k, k, 1.0, a.v.data(), n, core.data(), k);
    if (LAPACKE_dgesvd_work(LAPACK_COL_MAJOR, 'S', 'S', k, k, core.data(), k, sigma.data(), left.data(), k, right.data(), k, work.data(), room) != 0)
        return false;
    std::int32_t rank = k;
    for (double tail = 0.0; rank > 0; --rank) {
        tail += sigma[static_cast<std::size_t>(rank) - 1] * sigma[static_cast<std::size_t>(rank) - 1];
        if (tail > tolerance * tolerance) break;
    }
    std::vector<double> u(static_cast<std::size_t>(m) * rank), v(static_cast<std::size_t>(n) * rank);
    for (std::int32_t j = 0; j < rank; ++j)
        for (std::int32_t i = 0; i < k; ++i) {
            u[static_cast<std::size_t>(j) * m + i] = left[static_cast<std::size_t>(j) * k + i] * sigma[static_cast<std::size_t>(j)];
            v[static_cast<std::size_t>(j) * n + i] = right[static_cast<std::size_t>(i) * k + j];
        }
    if (rank > 0) {
        LAPACKE_dormqr_work(LAPACK_COL_MAJOR, 'L', 'N', m, rank, k, a.u.data(), m, tauU.data(), u.data(), m, work.data(), room);
        LAPACKE_dormqr_work(LAPACK_COL_MAJOR, 'L', 'N', n, rank, k, a.v.data(), n, tauV.data(), v.data(), n, work.data(), room);
    }
    a.u.swap(u);
    a.v.swap(v);
    a.rank = rank;
    return true;
}

}  // namespace imomushi
