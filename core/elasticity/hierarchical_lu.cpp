// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/hierarchical_lu.h"

#include <cblas.h>
#include <lapacke.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
#include <string>

#include "core/base/finite.h"
#include "core/base/parallel.h"
#include "core/elasticity/dense_lu.h"

namespace imomushi {
namespace {

using Clock = std::chrono::steady_clock;
using Block = HierarchicalMatrix::Block;
using Cluster = ClusterTree::Cluster;

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// The factorisation keeps of each block off the diagonal the singular values above this share of a usual row: those below hardly disturb GMRES...
constexpr double kFactorTolerance = 0.002;
/// ...and at most this many times the square root of the cluster's nodes (as many lie along the cut through a surface), within these bounds.
constexpr double kFactorRankGrowth = 3.0, kFactorRankLow = 96.0, kFactorRankHigh = 320.0;
/// As many more vectors are tried as the randomised range finder wants (Halko, Martinsson, Tropp 2011).
constexpr std::int32_t kOversampling = 16;
/// Gram matrices in single precision tell no directions below this share of the largest eigenvalue from rounding.
constexpr double kGramRounding = 1e-6;
/// Rows of a task.
constexpr std::int32_t kRows = 1536;
/// Right-hand sides that are solved together, and steps of GMRES until it starts anew: the basis takes kBatch * kSteps vectors.
constexpr std::int32_t kBatch = 16;
constexpr std::int32_t kSteps = 25;
/// A restart gains at most this: the basis is in single precision.
constexpr double kStepGain = 1e-4;
constexpr int kRestarts = 20;
/// A restart that gains less has met the limit of single precision, or of the preconditioner.
constexpr double kWorthwhile = 0.7;
/// The true residual is computed from the entries themselves, in pieces of this many nodes.
constexpr std::int32_t kPieceRows = 64, kPieceColumns = 1024;
/// Each correction solves for what is left by about the error of the hierarchical matrix, which is what it gains.
constexpr double kInnerShare = 0.5;
constexpr int kCorrections = 8;

Error wasCancelled() { return {kCancelled, "The precompute was cancelled."}; }

Error noMemory(std::int32_t nodes, std::size_t bytes) {
    const auto tenths = std::to_string(std::lround(static_cast<double>(bytes) / 1e8));
    const std::string size = bytes == 0 ? std::string("more memory than there is")
                                        : (tenths.size() > 1 ? tenths.substr(0, tenths.size() - 1) : std::string("0")) + "." + tenths.back() +
                                              " GB of memory, more than there is";
    return {"no-memory", "Solving " + std::to_string(nodes) + " vertices in compressed form needs " + size +
                             "; use a coarser mesh or close other programs."};
}

/// The largest rank of the blocks between the halves of a cluster.
std::int32_t rankLimit(double nodes) {
    return static_cast<std::int32_t>(std::clamp(kFactorRankGrowth * std::sqrt(nodes), kFactorRankLow, kFactorRankHigh));
}

/// Rows [begin, end) of unknowns that belong to one cluster.
struct Piece {
    std::int32_t cluster, begin, end;
};

std::vector<Piece> piecesOf(const std::vector<Cluster>& clusters, int depth) {
    std::vector<Piece> out;
    for (std::int32_t i = (1 << depth) - 1; i < (2 << depth) - 1; ++i) {
        const Cluster& c = clusters[static_cast<std::size_t>(i)];
        const std::int32_t rows = 3 * c.size(), parts = (rows + kRows - 1) / kRows;
        for (std::int32_t p = 0; p < parts; ++p)
            out.push_back({i, 3 * c.begin + static_cast<std::int32_t>(static_cast<std::int64_t>(rows) * p / parts),
                           3 * c.begin + static_cast<std::int32_t>(static_cast<std::int64_t>(rows) * (p + 1) / parts)});
    }
    return out;
}

using FloatArray = std::vector<float>;

/// For every cluster of a depth the rank x columns product of its rows of `a` (n x rank, transposed) and `b` (n x columns), in parallel, the sums
/// always in the same order. out: cluster after cluster, by columns.
bool innerProducts(const std::vector<Piece>& pieces, std::int32_t firstCluster, std::int32_t clusters, std::int32_t n, const float* a,
                   std::int32_t rank, const float* b, std::int32_t columns, FloatArray& out, int threads, const Progress& progress) {
    const std::size_t size = static_cast<std::size_t>(rank) * static_cast<std::size_t>(columns);
    FloatArray parts(size * pieces.size());
    parallelFor(threads, pieces.size(), 1, [&](std::size_t i, std::size_t) {
        if (progress.cancelled()) return;
        const Piece& p = pieces[i];
        cblas_sgemm(CblasColMajor, CblasTrans, CblasNoTrans, rank, columns, p.end - p.begin, 1.0f, a + p.begin, n, b + p.begin, n, 0.0f,
                    parts.data() + i * size, rank);
    });
    out.assign(size * static_cast<std::size_t>(clusters), 0.0f);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        float* to = out.data() + static_cast<std::size_t>(pieces[i].cluster - firstCluster) * size;
        for (std::size_t k = 0; k < size; ++k) to[k] += parts[i * size + k];
    }
    return !progress.cancelled();
}

/// The diagonal blocks of the deepest clusters dense; the blocks between the halves of every cluster above as U V^T. With D the two halves,
/// D + U V^T = D (I + X V^T), X = D^-1 U, whose inverse needs a small matrix only (Woodbury).
class HalvedFactor {
public:
    bool build(const HierarchicalMatrix& matrix, int threads, const Progress& progress);
    /// x := A^-1 x, x of n x columns in the order of the tree. False: cancelled.
    bool solve(float* x, std::int32_t columns, int threads, const Progress& progress) const { return solveFrom(0, x, columns, threads, progress); }
    [[nodiscard]] bool singular() const { return singular_; }
    [[nodiscard]] std::size_t bytes() const;

private:
    struct Lu {
        FloatArray a;
        std::vector<lapack_int> pivots;
    };
    struct Level {
        std::int32_t rank = 0;
        LargeArray<float> x, v;       ///< n x rank
        std::vector<Lu> middle;       ///< per cluster, 2 rank x 2 rank
        std::vector<Piece> pieces;    ///< of the halves
    };
    bool factoriseDiagonal(const HierarchicalMatrix& matrix, int threads, const Progress& progress);
    bool compress(const HierarchicalMatrix& matrix, int depth, int threads, const Progress& progress);
    [[nodiscard]] LargeArray<float> columnsOf(std::int32_t count) const {
        return LargeArray<float>(static_cast<std::size_t>(n_) * static_cast<std::size_t>(count));
    }
    /// The inverse of the block diagonal of the clusters of depth `top`.
    bool solveFrom(int top, float* x, std::int32_t columns, int threads, const Progress& progress) const;
    bool factorise(Lu& lu, std::int32_t size);

    std::int32_t n_ = 0;
    const std::vector<Cluster>* clusters_ = nullptr;
    std::vector<Lu> diagonal_;
    std::vector<Level> levels_;
    bool singular_ = false;
};

bool HalvedFactor::factorise(Lu& lu, std::int32_t size) {
    lu.pivots.resize(static_cast<std::size_t>(size));
    return size == 0 || LAPACKE_sgetrf_work(LAPACK_COL_MAJOR, size, size, lu.a.data(), size, lu.pivots.data()) == 0;
}

bool HalvedFactor::factoriseDiagonal(const HierarchicalMatrix& matrix, int threads, const Progress& progress) {
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

/// Finds U (into x) and V of a level: the range of every block by its product with random signs.
bool HalvedFactor::compress(const HierarchicalMatrix& matrix, int depth, int threads, const Progress& progress) {
    Level& level = levels_[static_cast<std::size_t>(depth)];
    level.pieces = piecesOf(*clusters_, depth + 1);
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
    // Orthogonal bases by way of Gram matrices: every large step is a product. `turn` holds eigenvectors, scaled, per cluster.
    FloatArray gram, turn(square * static_cast<std::size_t>(count));
    std::vector<std::int32_t> kept(static_cast<std::size_t>(count));
    std::vector<char> failed(static_cast<std::size_t>(count));
    const double negligible = kFactorTolerance * matrix.rowScale();
    const auto eigen = [&](bool orthogonalise) {
        parallelFor(threads, static_cast<std::size_t>(count), 1, [&](std::size_t c, std::size_t) {
            if (progress.cancelled()) return;
            std::vector<double> a(gram.begin() + static_cast<std::ptrdiff_t>(c * square), gram.begin() + static_cast<std::ptrdiff_t>((c + 1) * square));
            std::vector<double> lambda(static_cast<std::size_t>(k));
            if (!allFinite(a.data(), a.size()) || LAPACKE_dsyevd(LAPACK_COL_MAJOR, 'V', 'U', k, a.data(), k, lambda.data()) != 0) {
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
        parallelFor(threads, level.pieces.size(), 1, [&](std::size_t i, std::size_t) {
            if (progress.cancelled()) return;
            const Piece& p = level.pieces[i];
            const std::int32_t cluster = p.cluster - first, source = sibling ? cluster ^ 1 : cluster;
            cblas_sgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, p.end - p.begin, rank, k, 1.0f, from.data() + p.begin, n_,
                        turn.data() + static_cast<std::size_t>(source) * square, k, 0.0f, to.data() + p.begin, n_);
        });
        return !progress.cancelled();
    };
    if (!innerProducts(level.pieces, first, count, n_, w.data(), k, w.data(), k, gram, threads, progress)) return false;
    if (!eigen(true) || !rotate(w, q, k, false)) return false;
    if (!matrix.multiply(matrix.level(depth), q.data(), w.data(), k, true, threads, progress)) return false;
    if (!innerProducts(level.pieces, first, count, n_, w.data(), k, w.data(), k, gram, threads, progress)) return false;
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

bool HalvedFactor::build(const HierarchicalMatrix& matrix, int threads, const Progress& progress) {
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
        FloatArray products;  // V^T X per half
        if (!innerProducts(level.pieces, first, 2 * count, n_, level.v.data(), r, level.x.data(), r, products, threads, progress)) return false;
        level.middle.resize(static_cast<std::size_t>(count));
        std::vector<char> bad(static_cast<std::size_t>(count));
        parallelFor(threads, static_cast<std::size_t>(count), 1, [&](std::size_t i, std::size_t) {
            if (progress.cancelled()) return;
            Lu& lu = level.middle[i];
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

bool HalvedFactor::solveFrom(int top, float* x, std::int32_t columns, int threads, const Progress& progress) const {
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
        if (!innerProducts(level.pieces, first, 2 * count, n_, level.v.data(), r, x, columns, inner, threads, progress)) return false;
        const std::size_t size = static_cast<std::size_t>(r) * static_cast<std::size_t>(columns);
        z.resize(2 * size * static_cast<std::size_t>(count));
        parallelFor(threads, static_cast<std::size_t>(count), 1, [&](std::size_t i, std::size_t) {
            if (progress.cancelled()) return;
            float* zi = z.data() + 2 * i * size;  // 2 r x columns: first what the second half gives
            for (std::int32_t k = 0; k < columns; ++k) {
                std::copy_n(inner.data() + (2 * i + 1) * size + static_cast<std::size_t>(k) * r, r, zi + static_cast<std::size_t>(k) * 2 * r);
                std::copy_n(inner.data() + 2 * i * size + static_cast<std::size_t>(k) * r, r, zi + static_cast<std::size_t>(k) * 2 * r + r);
            }
            LAPACKE_sgetrs_work(LAPACK_COL_MAJOR, 'N', 2 * r, columns, level.middle[i].a.data(), 2 * r, level.middle[i].pivots.data(), zi, 2 * r);
        });
        parallelFor(threads, level.pieces.size(), 1, [&](std::size_t i, std::size_t) {
            if (progress.cancelled()) return;
            const Piece& p = level.pieces[i];
            const std::int32_t half = p.cluster - first;
            cblas_sgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, p.end - p.begin, columns, r, -1.0f, level.x.data() + p.begin, n_,
                        z.data() + static_cast<std::size_t>(half / 2) * 2 * size + (half % 2) * r, 2 * r, 1.0f, x + p.begin, n_);
        });
    }
    return !progress.cancelled();
}

std::size_t HalvedFactor::bytes() const {
    std::size_t entries = 0;
    for (const Lu& lu : diagonal_) entries += lu.a.size();
    for (const Level& level : levels_) {
        entries += 2 * static_cast<std::size_t>(n_) * static_cast<std::size_t>(level.rank);
        for (const Lu& lu : level.middle) entries += lu.a.size();
    }
    return entries * sizeof(float);
}

int depthOf(std::int32_t nodes) {
    return static_cast<int>(std::ceil(std::log2(std::max(1.0, nodes / static_cast<double>(HierarchicalMatrix::kDiagonalSize)))));
}

/// The same before it is built, at full rank.
std::size_t factorBytes(std::int32_t nodes) {
    const double n = 3.0 * nodes;
    const int depth = depthOf(nodes);
    double entries = n * n / std::exp2(depth);
    for (int d = 0; d < depth; ++d) {
        const double rank = rankLimit(nodes / std::exp2(d));
        entries += 2.0 * n * rank + 4.0 * rank * rank * std::exp2(d);
    }
    return static_cast<std::size_t>(sizeof(float) * entries);
}

/// Beside the matrix and the factors: what factorising (of one level, which has about a third of the ranks at most), and what solving of one batch
/// holds for a while.
std::size_t factorisingBytes(std::int32_t nodes, std::size_t ranks) {
    const double n = 3.0 * nodes, k = rankLimit(nodes) + kOversampling;
    return static_cast<std::size_t>(n * k * 3 * sizeof(float) + 0.3 * static_cast<double>(ranks) * k * sizeof(float));
}

std::size_t batchBytes(std::int32_t nodes, std::size_t ranks) {
    const double n = 3.0 * nodes, batch = kBatch;
    return static_cast<std::size_t>(n * batch * ((kSteps + 2) * sizeof(float) + 6 * sizeof(double)) + static_cast<double>(ranks) * batch * sizeof(float));
}

}  // namespace

struct HierarchicalLu::State {
    std::shared_ptr<const BlockSource> source;
    Options options;
    HierarchicalMatrix matrix;
    HalvedFactor factor;
    Quality quality;

    std::vector<std::unique_ptr<BlockSource::Columns>> pieces;  ///< all columns, in the order of the tree
    std::size_t workBytes = 0;

    /// Solves for some columns with the hierarchical matrix, in the order of the tree. right: right-hand sides in, residuals out. False: cancelled.
    bool solveBatch(Eigen::MatrixXd& right, Eigen::MatrixXd& x, double goal, int& iterations, const Progress& progress) const;
    /// residual := right - A x for the true matrix, in the order of the tree. False: cancelled.
    bool trueResidual(const Eigen::MatrixXd& right, const Eigen::MatrixXd& x, Eigen::MatrixXd& residual, const Progress& progress);
};

bool HierarchicalLu::State::solveBatch(Eigen::MatrixXd& right, Eigen::MatrixXd& x, double goal, int& iterations, const Progress& progress) const {
    const std::int32_t n = matrix.size(), k = static_cast<std::int32_t>(right.cols());
    const auto size = static_cast<std::size_t>(n) * static_cast<std::size_t>(k);
    const int threads = options.threads;
    const auto column = [n](auto* base, std::int32_t c) { return base + static_cast<std::size_t>(c) * static_cast<std::size_t>(n); };
    const Eigen::VectorXd rightNorm = right.colwise().norm();
    Eigen::MatrixXd& residual = right;
    const Eigen::MatrixXd b = right;
    x.setZero(n, k);
    std::vector<FloatArray> basis;
    FloatArray z(size);
    std::vector<double> product(size);
    struct Small {
        std::vector<double> h, g, cosine, sine;
        std::int32_t steps = 0;
        bool done = false;
        double beta = 0.0, aim = 0.0;
    };
    std::vector<Small> small(static_cast<std::size_t>(k));
    double worst = 1.0;
    for (int restart = 0; restart < kRestarts; ++restart) {
        if (basis.empty()) basis.emplace_back(size);
        bool any = false;
        for (std::int32_t c = 0; c < k; ++c) {
            Small& s = small[static_cast<std::size_t>(c)];
            s = {};
            s.beta = residual.col(c).norm();
            s.done = !(s.beta > goal * rightNorm[c]);
            if (s.done) {
                std::fill_n(column(basis[0].data(), c), n, 0.0f);
                continue;
            }
            any = true;
            s.aim = std::max(0.5 * goal * rightNorm[c] / s.beta, kStepGain);
            s.h.assign(static_cast<std::size_t>((kSteps + 1) * kSteps), 0.0);
            s.g.assign(kSteps + 1, 0.0);
            s.g[0] = 1.0;
            s.cosine.assign(kSteps, 0.0);
            s.sine.assign(kSteps, 0.0);
            float* v = column(basis[0].data(), c);
            const double* r = column(residual.data(), c);
            for (std::int32_t i = 0; i < n; ++i) v[i] = static_cast<float>(r[i] / s.beta);
        }
        if (!any) break;
        for (std::int32_t j = 0; j < kSteps; ++j) {
            if (static_cast<std::size_t>(j) + 1 >= basis.size()) basis.emplace_back(size);
            z = basis[static_cast<std::size_t>(j)];
            if (!factor.solve(z.data(), k, threads, progress)) return false;
            if (!matrix.multiply(matrix.blocks(), z.data(), product.data(), k, false, threads, progress)) return false;
            ++iterations;
            parallelFor(threads, static_cast<std::size_t>(k), 1, [&](std::size_t c_, std::size_t) {
                const auto c = static_cast<std::int32_t>(c_);
                Small& s = small[c_];
                float* w = column(basis[static_cast<std::size_t>(j) + 1].data(), c);
                if (s.done || progress.cancelled()) {
                    std::fill_n(w, n, 0.0f);
                    return;
                }
                const double* from = column(product.data(), c);
                for (std::int32_t i = 0; i < n; ++i) w[i] = static_cast<float>(from[i]);
                double* h = s.h.data() + j * (kSteps + 1);
                const double before = static_cast<double>(cblas_snrm2(n, w, 1));
                for (std::int32_t i = 0; i <= j; ++i) {
                    const float* v = column(basis[static_cast<std::size_t>(i)].data(), c);
                    const float dot = cblas_sdot(n, v, 1, w, 1);
                    h[i] = static_cast<double>(dot);
                    cblas_saxpy(n, -dot, v, 1, w, 1);
                }
                const double norm = static_cast<double>(cblas_snrm2(n, w, 1));
                h[j + 1] = norm;
                for (std::int32_t i = 0; i < j; ++i) {
                    const double above = h[i], below = h[i + 1];
                    h[i] = s.cosine[static_cast<std::size_t>(i)] * above + s.sine[static_cast<std::size_t>(i)] * below;
                    h[i + 1] = s.cosine[static_cast<std::size_t>(i)] * below - s.sine[static_cast<std::size_t>(i)] * above;
                }
                const auto J = static_cast<std::size_t>(j);
                const double length = std::hypot(h[j], h[j + 1]);
                if (!(length > 0.0) || !std::isfinite(length)) {
                    s.done = true;
                    std::fill_n(w, n, 0.0f);
                    return;
                }
                s.cosine[J] = h[j] / length;
                s.sine[J] = h[j + 1] / length;
                h[j] = length;
                s.g[J + 1] = -s.sine[J] * s.g[J];
                s.g[J] *= s.cosine[J];
                s.steps = j + 1;
                if (std::abs(s.g[J + 1]) <= s.aim || norm <= kStepGain * 1e-2 * before) {
                    s.done = true;
                    std::fill_n(w, n, 0.0f);
                    return;
                }
                cblas_sscal(n, static_cast<float>(1.0 / norm), w, 1);
            });
            if (progress.cancelled()) return false;
            double slowest = goal;
            for (std::int32_t c = 0; c < k; ++c) {
                const Small& s = small[static_cast<std::size_t>(c)];
                if (!s.done) slowest = std::max(slowest, std::abs(s.g[static_cast<std::size_t>(j) + 1]) * s.beta / rightNorm[c]);
            }
            if (std::all_of(small.begin(), small.end(), [](const Small& s) { return s.done; })) break;
            progress.report("solve", std::clamp(std::log(slowest) / std::log(goal), 0.0, 1.0));
        }
        parallelFor(threads, static_cast<std::size_t>(k), 1, [&](std::size_t c_, std::size_t) {
            if (progress.cancelled()) return;
            const auto c = static_cast<std::int32_t>(c_);
            Small& s = small[c_];
            float* to = column(z.data(), c);
            std::fill_n(to, n, 0.0f);
            for (std::int32_t i = s.steps; i-- > 0;) {
                for (std::int32_t l = i + 1; l < s.steps; ++l) s.g[static_cast<std::size_t>(i)] -= s.h[static_cast<std::size_t>(l * (kSteps + 1) + i)] * s.g[static_cast<std::size_t>(l)];
                s.g[static_cast<std::size_t>(i)] /= s.h[static_cast<std::size_t>(i * (kSteps + 1) + i)];
            }
            for (std::int32_t i = 0; i < s.steps; ++i)
                cblas_saxpy(n, static_cast<float>(s.g[static_cast<std::size_t>(i)]), column(basis[static_cast<std::size_t>(i)].data(), c), 1, to, 1);
        });
        if (progress.cancelled() || !factor.solve(z.data(), k, threads, progress)) return false;
        if (!allFinite(z.data(), z.size())) break;
        Eigen::MatrixXd next = x;
        for (std::int32_t c = 0; c < k; ++c) next.col(c) += Eigen::Map<const Eigen::VectorXf>(column(z.data(), c), n).cast<double>() * small[static_cast<std::size_t>(c)].beta;
        Eigen::Map<Eigen::MatrixXf>(z.data(), n, k) = next.cast<float>();
        if (!matrix.multiply(matrix.blocks(), z.data(), product.data(), k, false, threads, progress)) return false;
        Eigen::MatrixXd nextResidual = b - Eigen::Map<const Eigen::MatrixXd>(product.data(), n, k);
        double reached = 0.0;
        for (std::int32_t c = 0; c < k; ++c)
            if (rightNorm[c] > 0.0) reached = std::max(reached, nextResidual.col(c).norm() / rightNorm[c]);
        if (!(reached < worst)) break;
        const bool gains = reached < kWorthwhile * worst;
        x.swap(next);
        residual.swap(nextResidual);
        worst = reached;
        if (worst <= goal || !gains) break;
    }
    return true;
}

bool HierarchicalLu::State::trueResidual(const Eigen::MatrixXd& right, const Eigen::MatrixXd& x, Eigen::MatrixXd& residual,
                                         const Progress& progress) {
    const std::vector<std::int32_t>& order = matrix.tree().order();
    const auto nodes = static_cast<std::int32_t>(order.size());
    const auto columns = static_cast<std::int32_t>(x.cols());
    const auto nodesOf = [&](std::int32_t begin, std::int32_t count) {
        return std::span(order).subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(std::min(count, nodes - begin)));
    };
    if (pieces.empty()) {
        pieces.resize(static_cast<std::size_t>((nodes + kPieceColumns - 1) / kPieceColumns));
        parallelFor(options.threads, pieces.size(), 1, [&](std::size_t p, std::size_t) {
            if (!progress.cancelled()) pieces[p] = source->columns(nodesOf(static_cast<std::int32_t>(p) * kPieceColumns, kPieceColumns));
        });
        if (progress.cancelled()) {
            pieces.clear();
            return false;
        }
    }
    residual = right;
    const auto tasks = static_cast<std::size_t>((nodes + kPieceRows - 1) / kPieceRows);
    parallelFor(options.threads, tasks, 1, [&](std::size_t task, std::size_t) {
        const std::int32_t row = static_cast<std::int32_t>(task) * kPieceRows;
        const auto rows = nodesOf(row, kPieceRows);
        thread_local std::vector<double> entries;
        entries.resize(static_cast<std::size_t>(9) * kPieceRows * kPieceColumns);
        for (std::size_t p = 0; p < pieces.size(); ++p) {
            if (progress.cancelled()) return;
            pieces[p]->rows(rows, entries.data());
            const std::int32_t column = static_cast<std::int32_t>(p) * kPieceColumns, height = 3 * static_cast<std::int32_t>(rows.size());
            cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, height, columns, 3 * std::min(kPieceColumns, nodes - column), -1.0, entries.data(),
                        height, x.data() + 3 * column, static_cast<int>(x.rows()), 1.0, residual.data() + 3 * row, static_cast<int>(residual.rows()));
        }
    });
    return !progress.cancelled();
}

Result<HierarchicalLu::Estimate> HierarchicalLu::estimate(const BlockSource& source, const Options& options, std::int32_t columns, double goal,
                                                          const Progress& progress) {
    const std::int32_t nodes = source.nodes();
    auto matrix = HierarchicalMatrix::estimate(source, {.tolerance = options.tolerance, .threads = options.threads}, progress);
    if (!matrix) return tl::make_unexpected(matrix.error());
    Estimate out;
    const double n = 3.0 * nodes, crew = std::clamp(options.threads, 1, hardwareThreads()), g = std::max(columns, 1);
    out.bytes = matrix->bytes + factorBytes(nodes) +
                std::max(factorisingBytes(nodes, matrix->ranks), batchBytes(nodes, matrix->ranks) + static_cast<std::size_t>(40.0 * n * g));
    // Every entry is used twice per sampled vector of the factorisation and once per step of GMRES and column; every true entry is computed for
    // each correction.
    const double entries = static_cast<double>(matrix->bytes) / sizeof(float);
    const double rate = measureProductRate() * crew;
    double factorising = 2.0 * n * n * n * std::exp2(-2.0 * depthOf(nodes)) / 3.0;
    for (int d = 0; d < depthOf(nodes); ++d) {
        const double k = rankLimit(nodes / std::exp2(d)) + kOversampling;
        factorising += 2.0 * entries / depthOf(nodes) * 2.0 * k + 8.0 * n * k * k;
        for (int below = d + 1; below < depthOf(nodes); ++below) factorising += 4.0 * n * k * rankLimit(nodes / std::exp2(below));
    }
    // Compact bodies: the first answer misses by several times the tolerance, a second one by nearly the square of that, in about ten steps. Thin
    // ones take a correction and some fifty steps more. Between both:
    const double corrections = goal >= 8.0 * options.tolerance ? 1.5 : 2.5, steps = 40.0;
    constexpr double kSlower = 2.0;  // narrow products reach about half of the rate
    const double solving = steps * g * 2.0 * (entries + static_cast<double>(factorBytes(nodes)) / sizeof(float)) +
                           corrections * g * 2.0 * 2.0 * n * n;  // in double precision
    out.seconds += corrections * matrix->secondsPerEntry * n * n / crew;
    out.seconds += matrix->seconds + kSlower * (factorising + solving) / rate;
    return out;
}

Result<HierarchicalLu> HierarchicalLu::build(std::shared_ptr<const BlockSource> source, const Options& options, const Progress& progress) {
    useSingleThreadedBlas();
    const std::int32_t nodes = source->nodes();
    if (nodes == 0) return fail("bad-value", "There is nothing to solve.");
    auto state = std::make_unique<State>();
    state->source = source;
    state->options = options;
    state->options.threads = std::max(1, options.threads);
    const std::size_t others = factorBytes(nodes) + std::max(factorisingBytes(nodes, 0), batchBytes(nodes, 0));
    if (others > options.memoryLimit) return tl::make_unexpected(noMemory(nodes, others));
    try {
        auto start = Clock::now();
        auto matrix = HierarchicalMatrix::build(
            *source, {.tolerance = options.tolerance, .threads = state->options.threads, .memoryLimit = options.memoryLimit - others},
            progress.part(0.0, 0.8));
        if (!matrix) return tl::make_unexpected(matrix.error());
        state->matrix = std::move(*matrix);
        state->workBytes = batchBytes(nodes, state->matrix.ranks());
        Quality& q = state->quality;
        q.assembleSeconds = secondsSince(start);
        q.matrixBytes = state->matrix.bytes();
        q.compression = static_cast<double>(q.matrixBytes) / (36.0 * nodes * nodes);
        start = Clock::now();
        if (!state->factor.build(state->matrix, state->options.threads, progress.part(0.8, 1.0))) return tl::make_unexpected(wasCancelled());
        q.factoriseSeconds = secondsSince(start);
        q.factorBytes = state->factor.bytes();
    } catch (const std::bad_alloc&) {
        return tl::make_unexpected(noMemory(nodes, 0));
    }
    if (state->factor.singular())
        return fail("singular", "The equations of this body have no unique answer; check that every separate part of it has a joint face and that no "
                                "two vertices lie at the same point.");
    return HierarchicalLu(std::move(state));
}

Result<void> HierarchicalLu::solve(Eigen::MatrixXd& x, double goal, const Progress& progress) {
    State& s = *state_;
    const std::int32_t n = s.matrix.size();
    if (x.rows() != n) return fail("bad-value", "The right-hand sides do not match the equations.");
    if (!allFinite(x.data(), static_cast<std::size_t>(x.size()))) return fail("bad-value", "A right-hand side is not finite.");
    const auto start = Clock::now();
    const std::vector<std::int32_t>& order = s.matrix.tree().order();
    const auto k = static_cast<std::int32_t>(x.cols());
    const auto cancelled = [] { return tl::make_unexpected(wasCancelled()); };
    double worst = 1.0;
    s.quality.residual = 0.0;
    s.quality.iterations = s.quality.corrections = 0;
    try {
        Eigen::MatrixXd right(n, k), solution = Eigen::MatrixXd::Zero(n, k), residual;
        for (std::int32_t i = 0; i < n / 3; ++i) right.middleRows(3 * i, 3) = x.middleRows(3 * order[static_cast<std::size_t>(i)], 3);
        const Eigen::VectorXd rightNorm = right.colwise().norm();
        if (rightNorm.isZero(0.0)) {
            x.setZero();
            return {};
        }
        residual = right;
        s.quality.solveBytes = std::max(s.quality.solveBytes, s.workBytes + 40 * static_cast<std::size_t>(n) * static_cast<std::size_t>(k));
        const auto reached = [&](double left) { return std::clamp(std::log(std::min(left, 1.0)) / std::log(goal), 0.0, 1.0); };
        for (int round = 0; round < kCorrections && worst > goal; ++round) {
            const double inner = std::clamp(0.25 * goal / worst, kInnerShare * s.options.tolerance, 0.1);
            const double from = reached(worst), to = reached(worst * inner);
            Eigen::MatrixXd next = solution;
            int iterations = 0;
            for (std::int32_t begin = 0; begin < k; begin += kBatch) {
                const std::int32_t count = std::min(kBatch, k - begin);
                Eigen::MatrixXd part = residual.middleCols(begin, count), step;
                int steps = 0;
                const double share = (to - from) / k;
                if (!s.solveBatch(part, step, inner, steps, progress.part(from + share * begin, from + share * (begin + count)))) return cancelled();
                next.middleCols(begin, count) += step;
                iterations = std::max(iterations, steps);
            }
            s.quality.iterations += iterations;
            Eigen::MatrixXd nextResidual;
            if (!s.trueResidual(right, next, nextResidual, progress)) return cancelled();
            double left = 0.0;
            for (std::int32_t c = 0; c < k; ++c)
                if (rightNorm[c] > 0.0) left = std::max(left, nextResidual.col(c).norm() / rightNorm[c]);
            if (!(left < worst)) break;
            const bool gains = left < kWorthwhile * worst;
            worst = left;
            solution.swap(next);
            residual.swap(nextResidual);
            ++s.quality.corrections;
            progress.report("solve", reached(worst));
            if (!gains) break;
        }
        s.quality.residual = worst;
        s.quality.solveSeconds = secondsSince(start);
        if (!(worst <= goal))
            return fail("inaccurate", "The equations of this body are too ill-conditioned to be solved accurately; repair thin spikes and nearly "
                                      "coinciding surfaces, or remesh it more evenly.");
        for (std::int32_t i = 0; i < n / 3; ++i) x.middleRows(3 * order[static_cast<std::size_t>(i)], 3) = solution.middleRows(3 * i, 3);
    } catch (const std::bad_alloc&) {
        return tl::make_unexpected(noMemory(n / 3, 0));
    }
    return {};
}

HierarchicalLu::HierarchicalLu(std::unique_ptr<State> state) : state_(std::move(state)) {}
HierarchicalLu::HierarchicalLu(HierarchicalLu&&) noexcept = default;
HierarchicalLu& HierarchicalLu::operator=(HierarchicalLu&&) noexcept = default;
HierarchicalLu::~HierarchicalLu() = default;
const HierarchicalLu::Quality& HierarchicalLu::quality() const { return state_->quality; }
const HierarchicalMatrix& HierarchicalLu::matrix() const { return state_->matrix; }

}  // namespace imomushi
