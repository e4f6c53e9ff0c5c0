// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/hierarchical_matrix.h"

#include <cblas.h>
#include <lapacke.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <ctime>
#include <new>
#include <string>
#include <thread>

#include "core/base/finite.h"
#include "core/base/parallel.h"
#include "core/elasticity/cross_approximation.h"
#include "core/elasticity/dense_lu.h"

namespace imomushi {
namespace {

/// Largest leaf of the cluster tree, in nodes: a dense block of this size takes about as much memory as its approximation.
constexpr std::int32_t kLeafSize = 48;
/// Admissibility: the smaller diameter of two clusters is at most this times their distance (Hackbusch 2015, section 5.2).
constexpr double kAdmissible = 1.5;
/// Largest side of a low-rank block, in nodes: one step of its approximation then takes a few milliseconds, so that a cancel is heard and threads
/// share the work evenly.
constexpr std::int32_t kMaxSide = 4096;
/// Blocks of at most so many nodes times nodes are computed as a whole and approximated with full pivoting, which costs no more there.
constexpr std::size_t kFullyPivoted = 72 * 72;
/// Nodes whose rows one task of a product sums.
constexpr std::int32_t kRowChunk = 128;
/// Blocks of each size that estimate() builds as samples.
constexpr std::size_t kSampled = 6;

double diameter(const Box& b) { return (b.high - b.low).norm(); }

double distance(const Box& a, const Box& b) {
    return (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0.0).norm();
}

using Cluster = ClusterTree::Cluster;

bool admissible(const Cluster& row, const Cluster& column) {
    if (row.size() > kMaxSide || column.size() > kMaxSide) return false;
    const double gap = distance(row.points, column.support);
    return gap > 0.0 && std::min(diameter(row.points), diameter(column.support)) <= kAdmissible * gap;
}

struct Shape {
    std::int32_t row, column;  ///< clusters
    bool low;                  ///< admissible: of low rank
};

/// The block cluster tree: the blocks of each level, in a fixed order.
struct BlockClusterTree {
    const std::vector<Cluster>& clusters;
    int diagonalDepth;
    std::vector<std::vector<Shape>> levels;

    BlockClusterTree(const std::vector<Cluster>& all, int depth) : clusters(all), diagonalDepth(depth), levels(static_cast<std::size_t>(depth) + 1) { visit(0, 0, 0); }

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
        // The squared errors of the blocks of one row add up to the square of rowError.
        const double tolerance = rowError * std::sqrt(3.0 * r.size() * c.size() / static_cast<double>(tree.order().size()));
        LowRank a;
        std::vector<double> whole;
        if (rows.size() * columns.size() <= kFullyPivoted) {
            whole.resize(9 * rows.size() * columns.size());
            source.columns(columns)->rows(rows, whole.data());
            a = fullyPivotedCross(whole, 3 * r.size(), 3 * c.size(), tolerance);
        } else {
            a = partiallyPivotedCross(source, rows, columns, tolerance, progress);
        }
        if (a.outcome == LowRank::Outcome::cancelled) return Outcome::cancelled;
        if (a.outcome == LowRank::Outcome::notFinite) return Outcome::notFinite;
        if (a.outcome == LowRank::Outcome::done && recompress(a, 3 * r.size(), 3 * c.size(), tolerance)) {
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
    if (!allFinite(dense)) return Outcome::notFinite;
    block.rank = -1;
    block.u = rounded(dense);
    return Outcome::done;
}

std::size_t bytesOf(const HierarchicalMatrix::Block& b) {
    const auto rows = 3 * static_cast<std::size_t>(b.rowEnd - b.rowBegin), columns = 3 * static_cast<std::size_t>(b.columnEnd - b.columnBegin);
    return sizeof(float) * (b.rank < 0 ? rows * columns : static_cast<std::size_t>(b.rank) * (rows + columns)) + sizeof(HierarchicalMatrix::Block);
}

/// Root mean square of the 2-norms of rows of diagonal 3 x 3 blocks: the norm of a typical row of the matrix.
double typicalRow(const BlockSource& source) {
    const std::int32_t nodes = source.nodes(), step = std::max(1, nodes / 256);
    double sum = 0.0;
    int count = 0;
    for (std::int32_t i = 0; i < nodes; i += step, count += 3) {
        std::array<double, 9> block;
        const std::int32_t node[1] = {i};
        source.columns(node)->rows(node, block.data());
        if (!allFinite(block.data(), block.size())) continue;
        for (const double entry : block) sum += entry * entry;
    }
    return std::sqrt(sum / std::max(count, 1));
}

/// CPU time of this thread: an estimate should not depend on the load of the machine.
double threadSeconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Error notFinite() { return {"bad-value", "The mesh gives integrals that are not finite; repair its degenerate triangles."}; }
Error assemblyCancelled() { return {kCancelled, "The precompute was cancelled."}; }

}  // namespace

Result<HierarchicalMatrix> HierarchicalMatrix::build(const BlockSource& source, const Options& options, const Progress& progress) {
    useSingleThreadedBlas();
    HierarchicalMatrix out;
    try {
        out.tree_ = ClusterTree(source, kLeafSize);
        const auto& clusters = out.tree_.clusters();
        const std::int32_t nodes = source.nodes();
        out.rowScale_ = typicalRow(source);
        const double rowError = options.tolerance * out.rowScale_;
        std::vector<Shape> shapes;
        {
            const BlockClusterTree structure(clusters, bisections(nodes, kDiagonalSize));
            for (const auto& level : structure.levels) {
                out.levelBegin_.push_back(shapes.size());
                shapes.insert(shapes.end(), level.begin(), level.end());
            }
            out.levelBegin_.push_back(shapes.size());
        }
        out.blocks_.resize(shapes.size());

        // The largest blocks first, so that threads end together.
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
        if (progress.cancelled()) return tl::make_unexpected(assemblyCancelled());
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
    const BlockClusterTree structure(clusters, bisections(source.nodes(), kDiagonalSize));
    // Blocks of the same size cost about the same.
    std::vector<std::vector<Shape>> kinds(2 * 32);
    for (const auto& level : structure.levels)
        for (const Shape& s : level) kinds[static_cast<std::size_t>(2 * clusters[static_cast<std::size_t>(s.row)].depth + (s.low ? 1 : 0))].push_back(s);
    const double rowError = options.tolerance * typicalRow(source);
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
            if (outcome == Outcome::cancelled) return tl::make_unexpected(assemblyCancelled());
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
    // First V^T x of every low-rank block; then each task sums the rows of one chunk over the blocks, always in the same order.
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
