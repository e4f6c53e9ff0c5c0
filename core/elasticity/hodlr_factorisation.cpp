// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/hodlr_factorisation.h"

#include <cblas.h>
#include <lapacke.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "core/base/finite.h"
#include "core/base/parallel.h"

namespace imomushi {

namespace {

using Block = HierarchicalMatrix::Block;
using Cluster = ClusterTree::Cluster;
using FloatArray = std::vector<float>;
static_assert(std::is_same_v<lapack_int, std::int32_t>);

/// Off-diagonal blocks are truncated at singular values below this times HierarchicalMatrix::rowScale(): a preconditioner may miss by as much, GMRES then
/// takes few iterations more.
constexpr double kTruncation = 0.002;
/// They keep at most this rank times the square root of the cluster's nodes, within these bounds: two halves of a surface couple most across the curve
/// between them, which about sqrt(nodes) nodes lie along.
constexpr double kRankGrowth = 3.0, kMinRank = 96.0, kMaxRank = 320.0;
/// Columns of the random matrix beyond the wanted rank (Halko, Martinsson and Tropp 2011, section 4.2).
constexpr std::int32_t kOversampling = 16;
/// In single precision, eigenvalues of a Gram matrix below this share of the largest one are rounding.
constexpr double kGramRounding = 1e-6;
/// Rows of a task.
constexpr std::int32_t kTaskRows = 1536;

/// The largest rank of the blocks between the children of a cluster of so many nodes.
std::int32_t rankLimit(double nodes) {
    return static_cast<std::int32_t>(std::clamp(kRankGrowth * std::sqrt(nodes), kMinRank, kMaxRank));
}

int depthOf(std::int32_t nodes) {
    return static_cast<int>(std::ceil(std::log2(std::max(1.0, nodes / static_cast<double>(HierarchicalMatrix::kDiagonalSize)))));
}

}  // namespace

std::vector<HodlrFactorisation::RowRange> HodlrFactorisation::rangesOf(const std::vector<Cluster>& clusters, int depth) {
    std::vector<RowRange> out;
    for (std::int32_t i = (1 << depth) - 1; i < (2 << depth) - 1; ++i) {
        const Cluster& c = clusters[static_cast<std::size_t>(i)];
        const std::int32_t rows = 3 * c.size(), parts = (rows + kTaskRows - 1) / kTaskRows;
        for (std::int32_t p = 0; p < parts; ++p)
            out.push_back({i, 3 * c.begin + static_cast<std::int32_t>(static_cast<std::int64_t>(rows) * p / parts),
                           3 * c.begin + static_cast<std::int32_t>(static_cast<std::int64_t>(rows) * (p + 1) / parts)});
    }
    return out;
}

/// For every cluster of a depth a^T b over its rows, rank x columns, into `out` cluster after cluster; a is n x rank, b n x columns. Ranges of rows run in
/// parallel and are summed in a fixed order.
bool HodlrFactorisation::innerProducts(const std::vector<RowRange>& ranges, std::int32_t firstCluster, std::int32_t clusters, std::int32_t n, const float* a,
                   std::int32_t rank, const float* b, std::int32_t columns, FloatArray& out, int threads, const Progress& progress) {
    const std::size_t size = static_cast<std::size_t>(rank) * static_cast<std::size_t>(columns);
    FloatArray parts(size * ranges.size());
    parallelFor(threads, ranges.size(), 1, [&](std::size_t i, std::size_t) {
        if (progress.cancelled()) return;
        const RowRange& p = ranges[i];
        cblas_sgemm(CblasColMajor, CblasTrans, CblasNoTrans, rank, columns, p.end - p.begin, 1.0f, a + p.begin, n, b + p.begin, n, 0.0f,
                    parts.data() + i * size, rank);
    });
    out.assign(size * static_cast<std::size_t>(clusters), 0.0f);
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        float* to = out.data() + static_cast<std::size_t>(ranges[i].cluster - firstCluster) * size;
        for (std::size_t k = 0; k < size; ++k) to[k] += parts[i * size + k];
    }
    return !progress.cancelled();
}

bool HodlrFactorisation::factorise(Lu& lu, std::int32_t size) {
    lu.pivots.resize(static_cast<std::size_t>(size));
    return size == 0 || LAPACKE_sgetrf_work(LAPACK_COL_MAJOR, size, size, lu.a.data(), size, lu.pivots.data()) == 0;
}

bool HodlrFactorisation::factoriseDiagonal(const HierarchicalMatrix& matrix, int threads, const Progress& progress) {
    const int depth = matrix.levels() - 1;
    const std::span<const Block> blocks = matrix.level(depth);
    const std::int32_t first = (1 << depth) - 1, count = 1 << depth;
    diagonal_.resize(static_cast<std::size_t>(count));
    std::vector<char> bad(static_cast<std::size_t>(count));
    parallelFor(threads, static_cast<std::size_t>(count), 1, [&](std::size_t i, std::size_t) {
        if (progress.cancelled()) return;
        const Cluster& c = (*clusters_)[static_cast<std::size_t>(first) + i];
        const std::int32_t size = 3 * c.size();
        Lu& lu = diagonal_[i];
        lu.a.resize(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
        const auto from = std::partition_point(blocks.begin(), blocks.end(), [&](const Block& b) { return b.rowEnd <= c.begin; });
        for (auto b = from; b != blocks.end() && b->rowBegin < c.end; ++b) {
            const std::int32_t rows = 3 * (b->rowEnd - b->rowBegin), columns = 3 * (b->columnEnd - b->columnBegin);
            float* to = lu.a.data() + static_cast<std::size_t>(3 * (b->columnBegin - c.begin)) * static_cast<std::size_t>(size) + 3 * (b->rowBegin - c.begin);
            if (b->rank > 0)
                cblas_sgemm(CblasColMajor, CblasNoTrans, CblasTrans, rows, columns, b->rank, 1.0f, b->u.get(), rows, b->v.get(), columns, 0.0f, to, size);
            else if (b->rank < 0)
                for (std::int32_t k = 0; k < columns; ++k)
                    std::copy_n(b->u.get() + static_cast<std::size_t>(k) * rows, rows, to + static_cast<std::size_t>(k) * size);
        }
        bad[i] = !factorise(lu, size);
    });
    singular_ = std::find(bad.begin(), bad.end(), 1) != bad.end();
    return !progress.cancelled();
}

/// Finds U (into x) and V of a level by a randomised range finder (Halko, Martinsson and Tropp, SIAM Review 53 (2011) 217): the range of every block from
/// its product with a matrix of random signs.
bool HodlrFactorisation::compress(const HierarchicalMatrix& matrix, int depth, int threads, const Progress& progress) {
    Level& level = levels_[static_cast<std::size_t>(depth)];
    level.ranges = rangesOf(*clusters_, depth + 1);
    const std::int32_t first = (2 << depth) - 1, count = 2 << depth;
    const std::int32_t smallest = 3 * (*clusters_)[static_cast<std::size_t>(first + count - 1)].size();
    const std::int32_t limit = rankLimit((*clusters_)[static_cast<std::size_t>((1 << depth) - 1)].size());
    const std::int32_t k = std::min(limit + kOversampling, smallest);
    const std::size_t square = static_cast<std::size_t>(k) * static_cast<std::size_t>(k);
    LargeArray<float> q = columnsOf(k), w = columnsOf(k);
    parallelFor(threads, static_cast<std::size_t>(k), 1, [&](std::size_t column, std::size_t) {
        if (progress.cancelled()) return;
        std::uint64_t random = 0x9e3779b97f4a7c15u * (static_cast<std::uint64_t>(depth) * 4096 + column + 1);
        float* to = w.data() + column * static_cast<std::size_t>(n_);
        for (std::int32_t i = 0; i < n_; ++i) {
            random = random * 6364136223846793005u + 1442695040888963407u;
            to[i] = random >> 63 ? 1.0f : -1.0f;
        }
    });
    if (!matrix.multiply(matrix.level(depth), w.data(), q.data(), k, false, threads, progress)) return false;
    std::swap(w, q);
    // Orthogonal bases from the eigenvectors of Gram matrices, so that every large step is a matrix product. `turn`: per cluster the eigenvectors, scaled.
    FloatArray gram, turn(square * static_cast<std::size_t>(count));
    std::vector<std::int32_t> kept(static_cast<std::size_t>(count));
    std::vector<char> failed(static_cast<std::size_t>(count));
    const double negligible = kTruncation * matrix.rowScale();
    const auto eigen = [&](bool orthogonalise) {
        parallelFor(threads, static_cast<std::size_t>(count), 1, [&](std::size_t c, std::size_t) {
            if (progress.cancelled()) return;
            std::vector<double> a(gram.begin() + static_cast<std::ptrdiff_t>(c * square), gram.begin() + static_cast<std::ptrdiff_t>((c + 1) * square));
            std::vector<double> lambda(static_cast<std::size_t>(k));
            if (!allFinite(a) || LAPACKE_dsyevd(LAPACK_COL_MAJOR, 'V', 'U', k, a.data(), k, lambda.data()) != 0) {
                failed[c] = 1;
                return;
            }
            std::fill_n(turn.begin() + static_cast<std::ptrdiff_t>(c * square), square, 0.0f);
            const double largest = lambda.back();
            std::int32_t rank = 0;
            for (std::int32_t j = k; j-- > 0; ++rank) {  // eigenvalues ascend
                const double value = lambda[static_cast<std::size_t>(j)];
                if (!(value > kGramRounding * largest)) break;
                if (!orthogonalise && (std::sqrt(value) < negligible || rank >= limit)) break;
                const double factor = orthogonalise ? 1.0 / std::sqrt(value) : 1.0;
                for (std::int32_t i = 0; i < k; ++i)
                    turn[c * square + static_cast<std::size_t>(rank) * k + i] = static_cast<float>(a[static_cast<std::size_t>(j) * k + i] * factor);
            }
            kept[c] = rank;
        });
        return !progress.cancelled();
    };
    const auto rotate = [&](const LargeArray<float>& from, const LargeArray<float>& to, std::int32_t rank, bool sibling) {
        parallelFor(threads, level.ranges.size(), 1, [&](std::size_t i, std::size_t) {
            if (progress.cancelled()) return;
            const RowRange& p = level.ranges[i];
            const std::int32_t cluster = p.cluster - first, source = sibling ? cluster ^ 1 : cluster;
            cblas_sgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, p.end - p.begin, rank, k, 1.0f, from.data() + p.begin, n_,
                        turn.data() + static_cast<std::size_t>(source) * square, k, 0.0f, to.data() + p.begin, n_);
        });
        return !progress.cancelled();
    };
    if (!innerProducts(level.ranges, first, count, n_, w.data(), k, w.data(), k, gram, threads, progress)) return false;
    if (!eigen(true) || !rotate(w, q, k, false)) return false;
    if (!matrix.multiply(matrix.level(depth), q.data(), w.data(), k, true, threads, progress)) return false;
    if (!innerProducts(level.ranges, first, count, n_, w.data(), k, w.data(), k, gram, threads, progress)) return false;
    if (!eigen(false)) return false;
    level.rank = *std::max_element(kept.begin(), kept.end());
    if (level.rank > 0) {
        level.x = columnsOf(level.rank);
        level.v = columnsOf(level.rank);
        if (!rotate(q, level.x, level.rank, true) || !rotate(w, level.v, level.rank, false)) return false;
    }
    if (std::find(failed.begin(), failed.end(), 1) != failed.end()) singular_ = true;
    return true;
}

bool HodlrFactorisation::build(const HierarchicalMatrix& matrix, int threads, const Progress& progress) {
    n_ = matrix.size();
    clusters_ = &matrix.tree().clusters();
    const int depth = matrix.levels() - 1;
    levels_.resize(static_cast<std::size_t>(depth));
    if (!factoriseDiagonal(matrix, threads, progress)) return false;
    for (int d = depth - 1; d >= 0 && !singular_; --d) {
        Level& level = levels_[static_cast<std::size_t>(d)];
        if (!compress(matrix, d, threads, progress)) return false;
        if (level.rank == 0) continue;
        if (!solveFrom(d + 1, level.x.data(), level.rank, threads, progress)) return false;
        const std::int32_t r = level.rank, first = (2 << d) - 1, count = 1 << d;
        const std::size_t square = static_cast<std::size_t>(r) * static_cast<std::size_t>(r);
        FloatArray products;  // V^T X per child
        if (!innerProducts(level.ranges, first, 2 * count, n_, level.v.data(), r, level.x.data(), r, products, threads, progress)) return false;
        level.capacitance.resize(static_cast<std::size_t>(count));
        std::vector<char> bad(static_cast<std::size_t>(count));
        parallelFor(threads, static_cast<std::size_t>(count), 1, [&](std::size_t i, std::size_t) {
            if (progress.cancelled()) return;
            Lu& lu = level.capacitance[i];
            lu.a.assign(4 * square, 0.0f);
            const auto at = [&](std::int32_t row, std::int32_t column) { return lu.a.data() + static_cast<std::size_t>(column) * 2 * r + row; };
            for (std::int32_t j = 0; j < r; ++j) {
                *at(j, j) = *at(r + j, r + j) = 1.0f;
                std::copy_n(products.data() + (2 * i + 1) * square + static_cast<std::size_t>(j) * r, r, at(0, r + j));
                std::copy_n(products.data() + 2 * i * square + static_cast<std::size_t>(j) * r, r, at(r, j));
            }
            bad[i] = !factorise(lu, 2 * r);
        });
        singular_ |= std::find(bad.begin(), bad.end(), 1) != bad.end();
        progress.report("factorise", static_cast<double>(depth - d) / depth);
    }
    return !progress.cancelled();
}

bool HodlrFactorisation::solveFrom(int top, float* x, std::int32_t columns, int threads, const Progress& progress) const {
    const int depth = static_cast<int>(levels_.size());
    const std::int32_t firstDiagonal = (1 << depth) - 1;
    parallelFor(threads, diagonal_.size(), 1, [&](std::size_t i, std::size_t) {
        if (progress.cancelled()) return;
        const Cluster& c = (*clusters_)[static_cast<std::size_t>(firstDiagonal) + i];
        LAPACKE_sgetrs_work(LAPACK_COL_MAJOR, 'N', 3 * c.size(), columns, diagonal_[i].a.data(), 3 * c.size(), diagonal_[i].pivots.data(),
                            x + 3 * c.begin, n_);
    });
    FloatArray inner, z;
    for (int d = depth - 1; d >= top; --d) {
        if (progress.cancelled()) return false;
        const Level& level = levels_[static_cast<std::size_t>(d)];
        const std::int32_t r = level.rank, first = (2 << d) - 1, count = 1 << d;
        if (r == 0) continue;
        if (!innerProducts(level.ranges, first, 2 * count, n_, level.v.data(), r, x, columns, inner, threads, progress)) return false;
        const std::size_t size = static_cast<std::size_t>(r) * static_cast<std::size_t>(columns);
        z.resize(2 * size * static_cast<std::size_t>(count));
        parallelFor(threads, static_cast<std::size_t>(count), 1, [&](std::size_t i, std::size_t) {
            if (progress.cancelled()) return;
            float* zi = z.data() + 2 * i * size;  // 2 r x columns: V^T x of the second child, then of the first
            for (std::int32_t k = 0; k < columns; ++k) {
                std::copy_n(inner.data() + (2 * i + 1) * size + static_cast<std::size_t>(k) * r, r, zi + static_cast<std::size_t>(k) * 2 * r);
                std::copy_n(inner.data() + 2 * i * size + static_cast<std::size_t>(k) * r, r, zi + static_cast<std::size_t>(k) * 2 * r + r);
            }
            LAPACKE_sgetrs_work(LAPACK_COL_MAJOR, 'N', 2 * r, columns, level.capacitance[i].a.data(), 2 * r, level.capacitance[i].pivots.data(), zi, 2 * r);
        });
        parallelFor(threads, level.ranges.size(), 1, [&](std::size_t i, std::size_t) {
            if (progress.cancelled()) return;
            const RowRange& p = level.ranges[i];
            const std::int32_t child = p.cluster - first;
            cblas_sgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, p.end - p.begin, columns, r, -1.0f, level.x.data() + p.begin, n_,
                        z.data() + static_cast<std::size_t>(child / 2) * 2 * size + (child % 2) * r, 2 * r, 1.0f, x + p.begin, n_);
        });
    }
    return !progress.cancelled();
}

std::size_t HodlrFactorisation::bytes() const {
    std::size_t entries = 0;
    for (const Lu& lu : diagonal_) entries += lu.a.size();
    for (const Level& level : levels_) {
        entries += 2 * static_cast<std::size_t>(n_) * static_cast<std::size_t>(level.rank);
        for (const Lu& lu : level.capacitance) entries += lu.a.size();
    }
    return entries * sizeof(float);
}

std::size_t HodlrFactorisation::estimateBytes(std::int32_t nodes) {
    const double n = 3.0 * nodes;
    const int depth = depthOf(nodes);
    double entries = n * n / std::exp2(depth);
    for (int d = 0; d < depth; ++d) {
        const double rank = rankLimit(nodes / std::exp2(d));
        entries += 2.0 * n * rank + 4.0 * rank * rank * std::exp2(d);
    }
    return static_cast<std::size_t>(sizeof(float) * entries);
}

std::size_t HodlrFactorisation::estimateWorkBytes(std::int32_t nodes, std::size_t ranks) {
    const double n = 3.0 * nodes, k = rankLimit(nodes) + kOversampling;
    // One level at a time, which has at most about a third of the ranks.
    return static_cast<std::size_t>(n * k * 3 * sizeof(float) + 0.3 * static_cast<double>(ranks) * k * sizeof(float));
}

double HodlrFactorisation::estimateFlops(std::int32_t nodes, double entries) {
    // Every entry of the matrix is used twice per random vector.
    const double n = 3.0 * nodes;
    double flops = 2.0 * n * n * n * std::exp2(-2.0 * depthOf(nodes)) / 3.0;
    for (int d = 0; d < depthOf(nodes); ++d) {
        const double k = rankLimit(nodes / std::exp2(d)) + kOversampling;
        flops += 2.0 * entries / depthOf(nodes) * 2.0 * k + 8.0 * n * k * k;
        for (int below = d + 1; below < depthOf(nodes); ++below) flops += 4.0 * n * k * rankLimit(nodes / std::exp2(below));
    }
    return flops;
}

}  // namespace imomushi
