// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/quadratic_stiffness.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/parallel.h"

namespace imomushi {
namespace {

using Index = std::int32_t;

/// Corners at the ends of each middle: nodes 4...9 of a tetrahedron.
constexpr std::array<std::array<int, 2>, 6> kMiddleOf{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
/// Tetrahedra that a thread integrates at once.
constexpr std::size_t kTetrahedronGrain = 256;
/// Columns that a thread multiplies at once.
constexpr std::size_t kProductGrain = 24;

std::uint64_t edgeKey(Index a, Index b) { return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(std::min(a, b))) << 32) | static_cast<std::uint32_t>(std::max(a, b)); }

/// Stiffness of one tetrahedron for shear modulus 1: blocks (a, b) with a >= b, at a (a + 1) / 2 + b. Exact: gradients are linear, the rule has degree 2.
using TetrahedronBlocks = std::array<QuadraticStiffness::Block, 55>;
void quadraticStiffnessOf(const std::array<Vec3, 4>& corner, double lambda, TetrahedronBlocks& out) {
    Eigen::Matrix3d edges;
    for (int c = 0; c < 3; ++c) edges.row(c) = corner[static_cast<std::size_t>(c + 1)] - corner[0];
    const double volume = edges.determinant() / 6.0;
    const Eigen::Matrix3d inverse = edges.inverse();
    std::array<Vec3, 4> slope;
    slope[0] = -inverse.rowwise().sum();
    for (int c = 0; c < 3; ++c) slope[static_cast<std::size_t>(c + 1)] = inverse.col(c);
    constexpr double kNear = 0.585410196624968454, kFar = 0.138196601125010515;  // (5 + 3 sqrt 5) / 20, (5 - sqrt 5) / 20
    const double weight = std::sqrt(0.25 * volume);
    std::array<Eigen::Matrix<double, 3, 4>, 10> g;  // gradient of each node's function at each point, times the root of its weight
    for (int q = 0; q < 4; ++q) {
        const auto l = [&](int c) { return c == q ? kNear : kFar; };
        for (int c = 0; c < 4; ++c) g[static_cast<std::size_t>(c)].col(q) = weight * (4.0 * l(c) - 1.0) * slope[static_cast<std::size_t>(c)];
        for (std::size_t e = 0; e < 6; ++e) {
            const auto [a, b] = kMiddleOf[e];
            g[4 + e].col(q) = weight * 4.0 * (l(a) * slope[static_cast<std::size_t>(b)] + l(b) * slope[static_cast<std::size_t>(a)]);
        }
    }
    std::size_t k = 0;
    for (std::size_t a = 0; a < 10; ++a)
        for (std::size_t b = 0; b <= a; ++b, ++k) {
            const QuadraticStiffness::Block m = g[a] * g[b].transpose();
            out[k] = lambda * m + m.transpose();
            out[k].diagonal().array() += m.trace();
        }
}

}  // namespace

QuadraticNodes::QuadraticNodes(const TetrahedralMesh& mesh) : corners_(static_cast<Index>(mesh.vertices.rows())) {
    const Eigen::Index count = mesh.tetrahedra.rows();
    struct Use {
        std::uint64_t key;
        Index at;
    };
    std::vector<Use> uses(static_cast<std::size_t>(6 * count));
    for (Eigen::Index t = 0; t < count; ++t)
        for (std::size_t e = 0; e < 6; ++e)
            uses[static_cast<std::size_t>(6 * t) + e] = {edgeKey(mesh.tetrahedra(t, kMiddleOf[e][0]), mesh.tetrahedra(t, kMiddleOf[e][1])), static_cast<Index>(6 * t) + static_cast<Index>(e)};
    std::sort(uses.begin(), uses.end(), [](const Use& x, const Use& y) { return x.key != y.key ? x.key < y.key : x.at < y.at; });
    nodes.resize(count, 10);
    nodes.leftCols<4>() = mesh.tetrahedra;
    for (const Use& use : uses) {
        if (keys_.empty() || keys_.back() != use.key) keys_.push_back(use.key);
        nodes(use.at / 6, 4 + use.at % 6) = corners_ + static_cast<Index>(keys_.size()) - 1;
    }
}

Index QuadraticNodes::at(Index a, Index b) const {
    const auto place = std::lower_bound(keys_.begin(), keys_.end(), edgeKey(a, b));
    return place != keys_.end() && *place == edgeKey(a, b) ? corners_ + static_cast<Index>(place - keys_.begin()) : -1;
}

bool QuadraticStiffness::build(const TetrahedralMesh& mesh, const QuadraticNodes& of, const std::vector<Index>& place, Index freeNodes, double nu, int threads, const Progress& progress) {
    const auto n = place.size();
    // Tetrahedra around each node, by its place.
    std::vector<std::size_t> first(n + 1);
    const auto& nodes = of.nodes;
    for (Eigen::Index t = 0; t < nodes.rows(); ++t)
        for (int a = 0; a < 10; ++a) ++first[static_cast<std::size_t>(place[static_cast<std::size_t>(nodes(t, a))]) + 1];
    for (std::size_t i = 0; i < n; ++i) first[i + 1] += first[i];
    std::vector<Index> around(first[n]);
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (Eigen::Index t = 0; t < nodes.rows(); ++t)
        for (int a = 0; a < 10; ++a) around[next[static_cast<std::size_t>(place[static_cast<std::size_t>(nodes(t, a))])]++] = static_cast<Index>(t);
    std::vector<std::vector<Index>> rows(n);
    parallelFor(threads, n, 512, [&](std::size_t begin, std::size_t end) {
        std::vector<Index> some;
        for (std::size_t i = begin; i < end; ++i) {
            some.clear();
            for (std::size_t k = first[i]; k < first[i + 1]; ++k)
                for (int a = 0; a < 10; ++a)
                    if (const Index other = place[static_cast<std::size_t>(nodes(around[k], a))]; other >= static_cast<Index>(i)) some.push_back(other);
            std::sort(some.begin(), some.end());
            rows[i].assign(some.begin(), std::unique(some.begin(), some.end()));
        }
    });
    start.assign(n + 1, 0);
    for (std::size_t i = 0; i < n; ++i) start[i + 1] = start[i] + rows[i].size();
    row.resize(start[n]);
    for (std::size_t i = 0; i < n; ++i) std::copy(rows[i].begin(), rows[i].end(), row.begin() + static_cast<std::ptrdiff_t>(start[i]));
    for (std::size_t i = 0; i < static_cast<std::size_t>(freeNodes); ++i)
        freeRows.push_back(static_cast<std::size_t>(std::lower_bound(rows[i].begin(), rows[i].end(), freeNodes) - rows[i].begin()));
    if (progress.cancelled()) return false;

    const auto corners = [&](Eigen::Index t) {
        std::array<Vec3, 4> out;
        for (int c = 0; c < 4; ++c) out[static_cast<std::size_t>(c)] = mesh.vertices.row(mesh.tetrahedra(t, c)).transpose();
        return out;
    };
    block.assign(row.size(), Block::Zero());
    const double lambda = 2.0 * nu / (1.0 - 2.0 * nu);
    const auto count = static_cast<std::size_t>(nodes.rows());
    // Integrals by many threads, added up by one; few at once, as each is 4 kB of memory that would be fetched anew for each of many small bodies.
    constexpr std::size_t kRound = 8 * kTetrahedronGrain;
    std::vector<TetrahedronBlocks> blocks(std::min(count, kRound));
    for (std::size_t from = 0; from < count; from += kRound) {
        if (progress.cancelled()) return false;
        const std::size_t some = std::min(kRound, count - from);
        parallelFor(threads, some, kTetrahedronGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) quadraticStiffnessOf(corners(static_cast<Eigen::Index>(from + i)), lambda, blocks[i]);
        });
        for (std::size_t i = 0; i < some; ++i) {
            std::size_t k = 0;
            for (int a = 0; a < 10; ++a)
                for (int b = 0; b <= a; ++b, ++k) {
                    const Index p = place[static_cast<std::size_t>(nodes(static_cast<Eigen::Index>(from + i), a))], q = place[static_cast<std::size_t>(nodes(static_cast<Eigen::Index>(from + i), b))];
                    const auto column = static_cast<std::size_t>(std::min(p, q));
                    const auto at = std::lower_bound(row.begin() + static_cast<std::ptrdiff_t>(start[column]), row.begin() + static_cast<std::ptrdiff_t>(start[column + 1]), std::max(p, q)) - row.begin();
                    if (p >= q)
                        block[static_cast<std::size_t>(at)] += blocks[i][k];
                    else
                        block[static_cast<std::size_t>(at)] += blocks[i][k].transpose();
                }
        }
    }
    return true;
}

NodeValues QuadraticStiffness::times(const NodeValues& x, bool heldOnly, int threads) const {
    NodeValues y = NodeValues::Zero(x.rows(), x.cols());
    const auto width = static_cast<std::size_t>(x.cols());
    const auto all = static_cast<std::size_t>(start.size()) - 1;
    // Columns by threads: each of them reads the whole matrix.
    parallelFor(threads, width, kProductGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t j = 0; j < all; ++j) {
            const double* xj = x.data() + 3 * j * width;
            double* yj = y.data() + 3 * j * width;
            const std::size_t from = heldOnly && j < freeRows.size() ? start[j] + freeRows[j] : start[j];
            for (std::size_t k = from; k < start[j + 1]; ++k) {
                const auto i = static_cast<std::size_t>(row[k]);
                const double* b = block[k].data();
                const double* xi = x.data() + 3 * i * width;
                double* yi = y.data() + 3 * i * width;
                for (std::size_t c = begin; c < end; ++c) {
                    const double p = xj[c], q = xj[c + width], r = xj[c + 2 * width];
                    yi[c] += b[0] * p + b[1] * q + b[2] * r;
                    yi[c + width] += b[3] * p + b[4] * q + b[5] * r;
                    yi[c + 2 * width] += b[6] * p + b[7] * q + b[8] * r;
                }
                if (i == j) continue;
                for (std::size_t c = begin; c < end; ++c) {
                    const double p = xi[c], q = xi[c + width], r = xi[c + 2 * width];
                    yj[c] += b[0] * p + b[3] * q + b[6] * r;
                    yj[c + width] += b[1] * p + b[4] * q + b[7] * r;
                    yj[c + 2 * width] += b[2] * p + b[5] * q + b[8] * r;
                }
            }
        }
    });
    return y;
}

}  // namespace imomushi
