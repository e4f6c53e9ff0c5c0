// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/hierarchical_matrix.h"

#include <cblas.h>
#include <lapacke.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <ctime>
#include <new>
#include <string>
#include <thread>

#include "core/base/finite.h"
#include "core/base/parallel.h"
#include "core/elasticity/dense_lu.h"

namespace imomushi {
namespace {

/// Nodes of the smallest clusters, at most: a dense block of this size takes about what its approximation would.
constexpr std::int32_t kLeafSize = 48;
/// Blocks have a low rank when the smaller cluster is at most this many times larger than the distance.
constexpr double kAdmissible = 1.5;
/// Nodes on a side of a block, at most, so that one step of its approximation takes a few milliseconds (cancelling, sharing among threads).
constexpr std::int32_t kMaxSide = 4096;
/// Crosses are taken until they are this share of the allowed error; recompression throws away the rest.
constexpr double kCrossShare = 0.25;
/// Blocks of at most this many nodes by nodes are evaluated as a whole first: that costs no more than the crosses, and nothing can be overlooked.
constexpr std::size_t kWhole = 72 * 72;
/// Rows of a block on which an approximation is checked before it is believed.
constexpr std::int32_t kCheckedRows = 8;
/// A pivot below this share of the largest entry in its row would let rounding errors grow.
constexpr double kPivotShare = 0.1;
/// Nodes whose rows one task of a product adds up.
constexpr std::int32_t kRowChunk = 128;
/// Blocks of each size that an estimate builds.
constexpr std::size_t kSampled = 6;

double diameter(const Box& b) { return (b.high - b.low).norm(); }

double distance(const Box& a, const Box& b) {
    return (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0.0).norm();
}

Box merged(const Box& a, const Box& b) { return {a.low.cwiseMin(b.low), a.high.cwiseMax(b.high)}; }

using Cluster = ClusterTree::Cluster;

bool admissible(const Cluster& row, const Cluster& column) {
    if (row.size() > kMaxSide || column.size() > kMaxSide) return false;
    const double gap = distance(row.points, column.support);
    return gap > 0.0 && std::min(diameter(row.points), diameter(column.support)) <= kAdmissible * gap;
}

/// The smallest depth at which no cluster has more than `size` nodes.
int depthOf(std::int32_t nodes, std::int32_t size) {
    int depth = 0;
    while ((static_cast<std::int64_t>(nodes) + (std::int64_t{1} << depth) - 1) >> depth > size) ++depth;
    return depth;
}

struct Shape {
    std::int32_t row, column;  ///< clusters
    bool low;                  ///< of low rank
};

/// The blocks of each level, in a fixed order.
struct Structure {
    const std::vector<Cluster>& clusters;
    int diagonalDepth;
    std::vector<std::vector<Shape>> levels;

    Structure(const std::vector<Cluster>& all, int depth) : clusters(all), diagonalDepth(depth), levels(static_cast<std::size_t>(depth) + 1) { visit(0, 0, 0); }

    void visit(std::int32_t row, std::int32_t column, std::size_t level) {
        const Cluster& r = clusters[static_cast<std::size_t>(row)];
        const Cluster& c = clusters[static_cast<std::size_t>(column)];
        if (row == column) level = static_cast<std::size_t>(std::min(r.depth, diagonalDepth));
        const bool low = row != column && admissible(r, c);
        if (low || r.leaf()) {  // all leaves have the same depth
            levels[level].push_back({row, column, low});
            return;
        }
        for (const std::int32_t i : {r.first, r.second})
            for (const std::int32_t j : {c.first, c.second}) visit(i, j, level);
    }
};

/// U V^T, or why not.
struct Approximation {
    enum class Outcome { done, full, cancelled, notFinite } outcome = Outcome::done;
    std::int32_t rank = 0;
    std::vector<double> u, v;
};

/// The same for a block that is evaluated as a whole, m x n by columns: the largest entry left is the next pivot, so that nothing is overlooked.
Approximation approximateWhole(std::vector<double>& a, std::int32_t m, std::int32_t n, double tolerance) {
    Approximation out;
    const std::int32_t worthwhile = m * n / (m + n);
    if (!allFinite(a.data(), a.size())) {
        out.outcome = Approximation::Outcome::notFinite;
        return out;
    }
    for (;; ++out.rank) {
        if (std::sqrt(cblas_ddot(m * n, a.data(), 1, a.data(), 1)) <= tolerance) return out;
        if (out.rank >= worthwhile) {
            out.outcome = Approximation::Outcome::full;
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

/// Adaptive cross approximation of rows x columns nodes to the absolute error `tolerance` (Frobenius norm).
Approximation approximate(const BlockSource& source, std::span<const std::int32_t> rowNodes, std::span<const std::int32_t> columnNodes,
                          double tolerance, const Progress& progress) {
    Approximation out;
    const auto m = static_cast<std::int32_t>(rowNodes.size()), n = static_cast<std::int32_t>(columnNodes.size());
    const std::int32_t m3 = 3 * m, n3 = 3 * n;
    const std::int32_t worthwhile = m3 * n3 / (m3 + n3);  // above, the dense block is smaller
    const std::unique_ptr<BlockSource::Columns> columns = source.columns(columnNodes);
    std::vector<double> row(static_cast<std::size_t>(3 * n3)), rowRight(row.size()), column(static_cast<std::size_t>(3 * m3));
    std::vector<char> usedRow(static_cast<std::size_t>(m));
    auto& u = out.u;
    auto& v = out.v;
    auto& rank = out.rank;

    // What is left of the three rows of node i: row[3 j + a], 3 x n3 by columns.
    const auto takeRow = [&](std::int32_t i) {
        columns->rows(rowNodes.subspan(static_cast<std::size_t>(i), 1), row.data());
        if (!allFinite(row.data(), row.size())) return false;
        if (rank > 0)
            cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, 3, n3, rank, -1.0, u.data() + 3 * i, m3, v.data(), n3, 1.0, row.data(), 3);
        return true;
    };
    const auto squared = [](const std::vector<double>& x) { return cblas_ddot(static_cast<int>(x.size()), x.data(), 1, x.data(), 1); };
    // Places are in the order of the tree, so that equal steps through them go everywhere in the block; every check looks at other rows.
    std::uint64_t random = 0x9e3779b97f4a7c15u;
    const auto rowInShare = [&](std::int32_t share, std::int32_t shares) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        const std::int64_t begin = static_cast<std::int64_t>(m) * share / shares, end = static_cast<std::int64_t>(m) * (share + 1) / shares;
        return static_cast<std::int32_t>(begin + static_cast<std::int64_t>((random >> 33) % static_cast<std::uint64_t>(end - begin)));
    };
    const double negligible = kCrossShare * tolerance;
    std::vector<double> seen(static_cast<std::size_t>(m));  // per row: squares of what the columns of the last cross left there

    std::int32_t next = rowInShare(0, 1);
    bool taken = false;  // `row` already holds what is left of row `next`
    while (true) {
        if (progress.cancelled()) {
            out.outcome = Approximation::Outcome::cancelled;
            return out;
        }
        double added = 0.0;
        if (next >= 0) {
            if (!taken && !takeRow(next)) {
                out.outcome = Approximation::Outcome::notFinite;
                return out;
            }
            taken = false;
            usedRow[static_cast<std::size_t>(next)] = 1;
            std::fill(seen.begin(), seen.end(), 0.0);
            // One column node often cannot serve all three rows: on a plane, some axes do not see each other.
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
                // Rows this small say nothing about the others, and neither would their crosses.
                if (best < 0 || std::sqrt(squared(row) * m) <= negligible) break;
                source.columns(columnNodes.subspan(static_cast<std::size_t>(best), 1))->rows(rowNodes, column.data());
                if (!allFinite(column.data(), column.size())) {
                    out.outcome = Approximation::Outcome::notFinite;
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
                    out.outcome = Approximation::Outcome::full;
                    return out;
                }
            }
            // The next cross goes through the row where the columns of this one were largest.
            next = -1;
            double largest = 0.0;
            for (std::int32_t i = 0; i < m; ++i)
                if (!usedRow[static_cast<std::size_t>(i)] && seen[static_cast<std::size_t>(i)] > largest) {
                    largest = seen[static_cast<std::size_t>(i)];
                    next = i;
                }
        }
        if (added > negligible && next >= 0) continue;
        // Small crosses do not prove a small error (rows or columns of zeros, patches that do not see each other): look at rows everywhere.
        double sum = 0.0, worst = -1.0;
        std::int32_t looked = 0, worstRow = -1;
        for (std::int32_t share = 0; share < kCheckedRows; ++share) {
            const std::int32_t i = rowInShare(share, kCheckedRows);
            if (usedRow[static_cast<std::size_t>(i)]) continue;
            if (!takeRow(i)) {
                out.outcome = Approximation::Outcome::notFinite;
                return out;
            }
            const double left = squared(row);
            ++looked;
            sum += left;
            if (left > worst) {
                worst = left;
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

/// Replaces U V^T by the product of smallest rank within `tolerance` (Frobenius norm), the singular values on the left. False: LAPACK gave up.
bool recompress(Approximation& a, std::int32_t m, std::int32_t n, double tolerance) {
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

std::unique_ptr<float[]> rounded(const std::vector<double>& x) {
    std::unique_ptr<float[]> out(new float[std::max<std::size_t>(x.size(), 1)]);
    for (std::size_t i = 0; i < x.size(); ++i) out[i] = static_cast<float>(x[i]);
    return out;
}

enum class Outcome { done, cancelled, notFinite };

Outcome buildBlock(const BlockSource& source, const ClusterTree& tree, const Shape& shape, double rowError, const Progress& progress,
                   HierarchicalMatrix::Block& block) {
    const Cluster& r = tree.clusters()[static_cast<std::size_t>(shape.row)];
    const Cluster& c = tree.clusters()[static_cast<std::size_t>(shape.column)];
    block.rowBegin = r.begin;
    block.rowEnd = r.end;
    block.columnBegin = c.begin;
    block.columnEnd = c.end;
    const auto rows = std::span(tree.order()).subspan(static_cast<std::size_t>(r.begin), static_cast<std::size_t>(r.size()));
    const auto columns = std::span(tree.order()).subspan(static_cast<std::size_t>(c.begin), static_cast<std::size_t>(c.size()));
    if (shape.low) {
        // The squares of the errors of all blocks beside each other add up to that of a row.
        const double tolerance = rowError * std::sqrt(3.0 * r.size() * c.size() / static_cast<double>(tree.order().size()));
        Approximation a;
        std::vector<double> whole;
        if (rows.size() * columns.size() <= kWhole) {
            whole.resize(9 * rows.size() * columns.size());
            source.columns(columns)->rows(rows, whole.data());
            a = approximateWhole(whole, 3 * r.size(), 3 * c.size(), kCrossShare * tolerance);
        } else {
            a = approximate(source, rows, columns, tolerance, progress);
        }
        if (a.outcome == Approximation::Outcome::cancelled) return Outcome::cancelled;
        if (a.outcome == Approximation::Outcome::notFinite) return Outcome::notFinite;
        if (a.outcome == Approximation::Outcome::done && recompress(a, 3 * r.size(), 3 * c.size(), tolerance)) {
            block.rank = a.rank;
            block.u = rounded(a.u);
            block.v = rounded(a.v);
            return Outcome::done;
        }
    }
    std::vector<double> dense(9 * rows.size() * columns.size());
    const auto prepared = source.columns(columns);
    if (progress.cancelled()) return Outcome::cancelled;
    prepared->rows(rows, dense.data());
    if (!allFinite(dense.data(), dense.size())) return Outcome::notFinite;
    block.rank = -1;
    block.u = rounded(dense);
    return Outcome::done;
}

std::size_t bytesOf(const HierarchicalMatrix::Block& b) {
    const auto rows = 3 * static_cast<std::size_t>(b.rowEnd - b.rowBegin), columns = 3 * static_cast<std::size_t>(b.columnEnd - b.columnBegin);
    return sizeof(float) * (b.rank < 0 ? rows * columns : static_cast<std::size_t>(b.rank) * (rows + columns)) + sizeof(HierarchicalMatrix::Block);
}

/// The root mean square of the rows of the blocks on the diagonal: what is usual for a row.
double usualRow(const BlockSource& source) {
    const std::int32_t nodes = source.nodes(), step = std::max(1, nodes / 256);
    double sum = 0.0;
    int count = 0;
    for (std::int32_t i = 0; i < nodes; i += step, count += 3) {
        double block[9];
        const std::int32_t node[1] = {i};
        source.columns(node)->rows(node, block);
        if (!allFinite(block, 9)) continue;
        for (const double entry : block) sum += entry * entry;
    }
    return std::sqrt(sum / std::max(count, 1));
}

/// What this thread has computed: an estimate should not depend on what else the machine does just now.
double threadSeconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Error notFinite() { return {"bad-value", "The mesh gives integrals that are not finite; repair its degenerate triangles."}; }
Error wasCancelled() { return {kCancelled, "The precompute was cancelled."}; }

}  // namespace

ClusterTree::ClusterTree(const BlockSource& source, std::int32_t leafSize) {
    const std::int32_t nodes = source.nodes();
    order_.resize(static_cast<std::size_t>(nodes));
    std::vector<Vec3> position(order_.size());
    for (std::int32_t i = 0; i < nodes; ++i) {
        order_[static_cast<std::size_t>(i)] = i;
        position[static_cast<std::size_t>(i)] = source.position(i);
    }
    if (nodes == 0) return;
    const int depth = depthOf(nodes, leafSize);
    clusters_.resize((std::size_t{2} << depth) - 1);
    clusters_[0].begin = 0;
    clusters_[0].end = nodes;
    for (std::size_t i = 0; i < clusters_.size(); ++i) {
        Cluster& c = clusters_[i];
        const auto begin = order_.begin() + c.begin, end = order_.begin() + c.end;
        c.points.low = c.points.high = position[static_cast<std::size_t>(*begin)];
        for (auto it = begin; it != end; ++it) {
            const Vec3& p = position[static_cast<std::size_t>(*it)];
            c.points = merged(c.points, {p, p});
        }
        if (c.depth == depth) {
            c.support = source.support(*begin);
            for (auto it = begin; it != end; ++it) c.support = merged(c.support, source.support(*it));
            continue;
        }
        int axis = 0;
        (c.points.high - c.points.low).maxCoeff(&axis);
        const auto middle = begin + (c.size() + 1) / 2;
        std::nth_element(begin, middle, end, [&](std::int32_t a, std::int32_t b) {
            const double pa = position[static_cast<std::size_t>(a)][axis], pb = position[static_cast<std::size_t>(b)][axis];
            return pa != pb ? pa < pb : a < b;
        });
        c.first = static_cast<std::int32_t>(2 * i + 1);
        c.second = static_cast<std::int32_t>(2 * i + 2);
        const auto split = static_cast<std::int32_t>(middle - order_.begin());
        Cluster &first = clusters_[static_cast<std::size_t>(c.first)], &second = clusters_[static_cast<std::size_t>(c.second)];
        first.begin = c.begin;
        first.end = second.begin = split;
        second.end = c.end;
        first.depth = second.depth = c.depth + 1;
    }
    for (std::size_t i = clusters_.size(); i-- > 0;)
        if (!clusters_[i].leaf())
            clusters_[i].support = merged(clusters_[static_cast<std::size_t>(clusters_[i].first)].support,
                                          clusters_[static_cast<std::size_t>(clusters_[i].second)].support);
}

Result<HierarchicalMatrix> HierarchicalMatrix::build(const BlockSource& source, const Options& options, const Progress& progress) {
    useSingleThreadedBlas();
    HierarchicalMatrix out;
    try {
        out.tree_ = ClusterTree(source, kLeafSize);
        const auto& clusters = out.tree_.clusters();
        const std::int32_t nodes = source.nodes();
        out.rowScale_ = usualRow(source);
        const double rowError = options.tolerance * out.rowScale_;
        std::vector<Shape> shapes;
        {
            const Structure structure(clusters, depthOf(nodes, kDiagonalSize));
            for (const auto& level : structure.levels) {
                out.levelBegin_.push_back(shapes.size());
                shapes.insert(shapes.end(), level.begin(), level.end());
            }
            out.levelBegin_.push_back(shapes.size());
        }
        out.blocks_.resize(shapes.size());

        // The largest first, so that threads end together.
        std::vector<std::size_t> turn(shapes.size());
        for (std::size_t i = 0; i < turn.size(); ++i) turn[i] = i;
        const auto side = [&](std::size_t i) {
            return clusters[static_cast<std::size_t>(shapes[i].row)].size() + clusters[static_cast<std::size_t>(shapes[i].column)].size();
        };
        std::stable_sort(turn.begin(), turn.end(), [&](std::size_t a, std::size_t b) { return side(a) > side(b); });
        double work = 0.0;
        for (const std::size_t i : turn) work += side(i);

        std::atomic<std::size_t> bytes{0};
        std::atomic<double> done{0.0};
        std::atomic<bool> stop{false}, bad{false};
        const std::thread::id builder = std::this_thread::get_id();
        parallelFor(options.threads, turn.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                if (stop.load(std::memory_order_relaxed) || progress.cancelled()) return;
                Block& block = out.blocks_[turn[i]];
                try {
                    const Outcome outcome = buildBlock(source, out.tree_, shapes[turn[i]], rowError, progress, block);
                    if (outcome == Outcome::notFinite) bad = stop = true;
                    if (outcome != Outcome::done) return;
                    if ((bytes += bytesOf(block)) > options.memoryLimit) stop = true;
                } catch (const std::bad_alloc&) {
                    stop = true;
                    return;
                }
                const double sum = done += side(turn[i]);
                if (std::this_thread::get_id() == builder) progress.report("assemble", sum / work);
            }
        });
        if (progress.cancelled()) return tl::make_unexpected(wasCancelled());
        if (bad) return tl::make_unexpected(notFinite());
        if (stop) throw std::bad_alloc();
        out.bytes_ = bytes;
        for (const Block& b : out.blocks_) out.ranks_ += static_cast<std::size_t>(std::max(b.rank, 0));
    } catch (const std::bad_alloc&) {
        return fail("no-memory", "The equations of " + std::to_string(source.nodes()) +
                                     " vertices do not fit into memory even in compressed form; use a coarser mesh or close other programs.");
    }
    return out;
}

Result<HierarchicalMatrix::Estimate> HierarchicalMatrix::estimate(const BlockSource& source, const Options& options, const Progress& progress) {
    useSingleThreadedBlas();
    Estimate out;
    const ClusterTree tree(source, kLeafSize);
    const auto& clusters = tree.clusters();
    const Structure structure(clusters, depthOf(source.nodes(), kDiagonalSize));
    // Blocks of the same size cost about the same.
    std::vector<std::vector<Shape>> kinds(2 * 32);
    for (const auto& level : structure.levels)
        for (const Shape& s : level) kinds[static_cast<std::size_t>(2 * clusters[static_cast<std::size_t>(s.row)].depth + (s.low ? 1 : 0))].push_back(s);
    const double rowError = options.tolerance * usualRow(source);
    {
        const auto some = std::span(tree.order()).first(std::min<std::size_t>(tree.order().size(), 1024));
        const auto rows = some.first(std::min<std::size_t>(some.size(), 8));
        std::vector<double> entries(9 * rows.size() * some.size());
        const auto prepared = source.columns(some);
        prepared->rows(rows, entries.data());  // once to warm up
        const double start = threadSeconds();
        prepared->rows(rows, entries.data());
        out.secondsPerEntry = (threadSeconds() - start) / static_cast<double>(entries.size());
    }
    for (const auto& kind : kinds) {
        if (kind.empty()) continue;
        const std::size_t sampled = std::min(kind.size(), kSampled);
        const double start = threadSeconds();
        double bytes = 0.0, ranks = 0.0;
        for (std::size_t i = 0; i < sampled; ++i) {
            Block block;
            const Outcome outcome =
                buildBlock(source, tree, kind[(2 * i + 1) * kind.size() / (2 * sampled)], rowError, progress, block);
            if (outcome == Outcome::notFinite) return tl::make_unexpected(notFinite());
            if (outcome == Outcome::cancelled) return tl::make_unexpected(wasCancelled());
            bytes += static_cast<double>(bytesOf(block));
            ranks += std::max(block.rank, 0);
        }
        const double share = static_cast<double>(kind.size()) / static_cast<double>(sampled);
        out.seconds += (threadSeconds() - start) * share / std::clamp(options.threads, 1, hardwareThreads());
        out.bytes += static_cast<std::size_t>(bytes * share);
        out.ranks += static_cast<std::size_t>(ranks * share);
    }
    return out;
}

template <class Real>
bool HierarchicalMatrix::product(std::span<const Block> blocks, const float* x, Real* y, std::int32_t columns, bool transposed, int threads,
                                 const Progress& progress) const {
    const std::int32_t n = size(), nodes = n / 3;
    // First V^T x of every block of low rank, then each task adds up what belongs to its rows, in the order of the blocks.
    std::vector<std::size_t> at(blocks.size() + 1);
    const std::size_t chunks = static_cast<std::size_t>((nodes + kRowChunk - 1) / kRowChunk);
    std::vector<std::vector<std::uint32_t>> ofChunk(chunks);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        const Block& b = blocks[i];
        at[i + 1] = at[i] + static_cast<std::size_t>(std::max(b.rank, 0)) * static_cast<std::size_t>(columns);
        const std::int32_t begin = transposed ? b.columnBegin : b.rowBegin, end = transposed ? b.columnEnd : b.rowEnd;
        for (std::int32_t c = begin / kRowChunk; c <= (end - 1) / kRowChunk; ++c) ofChunk[static_cast<std::size_t>(c)].push_back(static_cast<std::uint32_t>(i));
    }
    std::vector<float> inner(at.back());
    parallelFor(threads, blocks.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Block& b = blocks[i];
            if (b.rank <= 0) continue;
            if (progress.cancelled()) return;
            const std::int32_t from = 3 * (transposed ? b.rowBegin : b.columnBegin), to = 3 * (transposed ? b.rowEnd : b.columnEnd);
            cblas_sgemm(CblasColMajor, CblasTrans, CblasNoTrans, b.rank, columns, to - from, 1.0f, transposed ? b.u.get() : b.v.get(), to - from,
                        x + from, n, 0.0f, inner.data() + at[i], b.rank);
        }
    });
    if (progress.cancelled()) return false;
    parallelFor(threads, chunks, 1, [&](std::size_t c, std::size_t) {
        const std::int32_t begin = static_cast<std::int32_t>(c) * kRowChunk, end = std::min(nodes, begin + kRowChunk);
        const std::int32_t rows = 3 * (end - begin);
        thread_local std::vector<float> part;
        thread_local std::vector<double> sum;
        part.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns));
        sum.assign(part.size(), 0.0);
        for (const std::uint32_t i : ofChunk[c]) {
            const Block& b = blocks[i];
            if (b.rank == 0) continue;
            if (progress.cancelled()) return;
            const std::int32_t blockBegin = transposed ? b.columnBegin : b.rowBegin, blockEnd = transposed ? b.columnEnd : b.rowEnd;
            const std::int32_t from = std::max(begin, blockBegin), to = std::min(end, blockEnd);
            const std::int32_t count = 3 * (to - from), offset = 3 * (from - blockBegin), height = 3 * (blockEnd - blockBegin);
            if (b.rank > 0) {
                cblas_sgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, count, columns, b.rank, 1.0f,
                            (transposed ? b.v.get() : b.u.get()) + offset, height, inner.data() + at[i], b.rank, 0.0f, part.data(), count);
            } else if (transposed) {
                const std::int32_t blockRows = 3 * (b.rowEnd - b.rowBegin);
                cblas_sgemm(CblasColMajor, CblasTrans, CblasNoTrans, count, columns, blockRows, 1.0f,
                            b.u.get() + static_cast<std::size_t>(offset) * static_cast<std::size_t>(blockRows), blockRows, x + 3 * b.rowBegin, n, 0.0f,
                            part.data(), count);
            } else {
                cblas_sgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, count, columns, 3 * (b.columnEnd - b.columnBegin), 1.0f,
                            b.u.get() + offset, height, x + 3 * b.columnBegin, n, 0.0f, part.data(), count);
            }
            for (std::int32_t k = 0; k < columns; ++k) {
                double* to_ = sum.data() + static_cast<std::size_t>(k) * rows + 3 * (from - begin);
                const float* from_ = part.data() + static_cast<std::size_t>(k) * count;
                for (std::int32_t r = 0; r < count; ++r) to_[r] += static_cast<double>(from_[r]);
            }
        }
        for (std::int32_t k = 0; k < columns; ++k)
            std::transform(sum.begin() + static_cast<std::ptrdiff_t>(k) * rows, sum.begin() + static_cast<std::ptrdiff_t>(k + 1) * rows,
                           y + static_cast<std::size_t>(k) * n + 3 * begin, [](double value) { return static_cast<Real>(value); });
    });
    return !progress.cancelled();
}

bool HierarchicalMatrix::multiply(std::span<const Block> blocks, const float* x, double* y, std::int32_t columns, bool transposed, int threads,
                                  const Progress& progress) const {
    return product(blocks, x, y, columns, transposed, threads, progress);
}

bool HierarchicalMatrix::multiply(std::span<const Block> blocks, const float* x, float* y, std::int32_t columns, bool transposed, int threads,
                                  const Progress& progress) const {
    return product(blocks, x, y, columns, transposed, threads, progress);
}

}  // namespace imomushi
