// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/boundary_equation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/parallel.h"
#include "core/mesh/solid_angle.h"

namespace imomushi {
namespace {

/// Rows of right-hand sides done by one thread at a time.
constexpr std::size_t kNodeGrain = 16;

}  // namespace

BoundaryEquation::BoundaryEquation(const TriangleMesh& mesh, const EdgeTable& edges, std::span<const HeldPatch> held, std::span<const std::array<std::int32_t, 2>> bubbles,
                                   double nu)
    : mesh_(mesh), nu_(nu) {
    const Eigen::RowVector3d low = mesh.vertices.colwise().minCoeff(), high = mesh.vertices.colwise().maxCoeff();
    size_ = (high - low).norm();
    mesh_.vertices = ((mesh.vertices.rowwise() - 0.5 * (low + high)) / size_).eval();
    const auto triangleCount = static_cast<std::size_t>(mesh.triangles.rows());

    // Nodes.
    std::vector<std::int32_t> nodeOf(static_cast<std::size_t>(mesh.vertices.rows()), -1);
    for (const HeldPatch& patch : held)
        for (const std::int32_t v : patch.vertices) {
            nodeOf[static_cast<std::size_t>(v)] = 0;
            heldVertices_.push_back(v);
        }
    for (std::size_t v = 0; v < nodeOf.size(); ++v)
        if (nodeOf[v] < 0) {
            nodeOf[v] = static_cast<std::int32_t>(freeVertices_.size());
            freeVertices_.push_back(static_cast<std::int32_t>(v));
        }
    freeCount_ = static_cast<std::int32_t>(freeVertices_.size());
    bubbleCount_ = static_cast<std::int32_t>(bubbles.size());
    heldCount_ = static_cast<std::int32_t>(heldVertices_.size());
    for (std::int32_t j = 0; j < heldCount_; ++j)
        nodeOf[static_cast<std::size_t>(heldVertices_[static_cast<std::size_t>(j)])] = freeCount_ + bubbleCount_ + j;
    points_.resize(freeCount_ + bubbleCount_ + heldCount_, 3);
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) points_.row(nodeOf[static_cast<std::size_t>(v)]) = mesh_.vertices.row(v);

    inPatch_.assign(triangleCount, 0);
    for (const HeldPatch& patch : held)
        for (const std::int32_t f : patch.triangles) inPatch_[static_cast<std::size_t>(f)] = 1;
    std::vector<std::int32_t> bubbleOf(static_cast<std::size_t>(edges.size()), -1);
    if (!bubbles.empty()) {
        std::vector<std::array<std::int32_t, 2>> keys(static_cast<std::size_t>(edges.size()));
        for (int e = 0; e < edges.size(); ++e) keys[static_cast<std::size_t>(e)] = {edges.uses(e)[0].low, edges.uses(e)[0].high};
        for (std::int32_t b = 0; b < bubbleCount_; ++b) {
            const auto& [from, to] = bubbles[static_cast<std::size_t>(b)];
            const std::array<std::int32_t, 2> key{std::min(from, to), std::max(from, to)};
            bubbleOf[static_cast<std::size_t>(std::lower_bound(keys.begin(), keys.end(), key) - keys.begin())] = freeCount_ + b;
            ends_.push_back({nodeOf[static_cast<std::size_t>(from)], nodeOf[static_cast<std::size_t>(to)]});
            points_.row(freeCount_ + b) = 0.5 * (mesh_.vertices.row(from) + mesh_.vertices.row(to));
        }
    }

    // One batch per kind of columns that its triangles add to.
    const std::int32_t firstHeld = freeCount_ + bubbleCount_;
    std::vector<std::int32_t> plain, curved, heldTriangles;
    TriangleBatch::Columns plainColumns, curvedColumns, heldColumns;
    std::vector<std::array<std::int32_t, 3>> cornerNode(triangleCount);
    for (std::size_t f = 0; f < triangleCount; ++f) {
        std::array<std::int32_t, 3> bubble{}, traction{};
        bool bends = false;
        for (std::size_t c = 0; c < 3; ++c) {
            const std::int32_t node = nodeOf[static_cast<std::size_t>(mesh.triangles(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(c)))];
            const std::int32_t b = bubbleOf[static_cast<std::size_t>(edges.edgeOf(static_cast<std::int32_t>(f), static_cast<int>(c)))];
            cornerNode[f][c] = node;
            traction[c] = std::max(0, node - firstHeld);
            bubble[c] = b >= 0 ? b : nodes();  // the column without meaning
            bends |= b >= 0;
        }
        const auto triangle = static_cast<std::int32_t>(f);
        if (inPatch_[f]) {
            heldTriangles.push_back(triangle);
            heldColumns.corner.push_back(cornerNode[f]);
            heldColumns.traction.push_back(traction);
        } else if (bends) {
            curved.push_back(triangle);
            curvedColumns.corner.push_back(cornerNode[f]);
            curvedColumns.bubble.push_back(bubble);
        } else {
            plain.push_back(triangle);
            plainColumns.corner.push_back(cornerNode[f]);
        }
    }
    plain_ = TriangleBatch(mesh_, plain, plainColumns);
    curved_ = TriangleBatch(mesh_, curved, curvedColumns);
    held_ = TriangleBatch(mesh_, heldTriangles, heldColumns);

    // Minus the sum of D_a over the whole surface / (4 pi), but found from the triangles around a node alone.
    freeTerm_.resize(static_cast<std::size_t>(nodes()));
    const std::vector<double> solidAngle = vertexSolidAngles(mesh_);
    for (std::size_t v = 0; v < nodeOf.size(); ++v) freeTerm_[static_cast<std::size_t>(nodeOf[v])] = solidAngle[v];
    for (int e = 0; e < edges.size(); ++e)
        if (const std::int32_t b = bubbleOf[static_cast<std::size_t>(e)]; b >= 0)
            freeTerm_[static_cast<std::size_t>(b)] = 0.5 - edgeBend(mesh_, edges.uses(e)) / (2.0 * std::numbers::pi);

    // Traction columns are scaled to the size of H: by what a vertex's traction does to the vertex itself, however thin the triangles around.
    columnScale_.assign(static_cast<std::size_t>(heldCount_), 0.0);
    for (std::size_t f = 0; f < triangleCount; ++f) {
        if (!inPatch_[f]) continue;
        std::array<Vec3, 3> p;
        for (std::size_t c = 0; c < 3; ++c) p[c] = points_.row(cornerNode[f][c]).transpose();
        for (std::size_t c = 0; c < 3; ++c) columnScale_[static_cast<std::size_t>(cornerNode[f][c] - firstHeld)] += pairBlocks(p[c], p, nu).g[c].trace() / 3.0;
    }
    for (double& scale : columnScale_) scale = 0.5 / scale;
}

std::int32_t BoundaryEquation::vertexOf(std::int32_t node) const {
    if (bubble(node)) return vertexOf(ends_[static_cast<std::size_t>(node - freeCount_)][0]);
    return node < freeCount_ ? freeVertices_[static_cast<std::size_t>(node)] : heldVertices_[static_cast<std::size_t>(node - freeCount_ - bubbleCount_)];
}

void BoundaryEquation::addFreeTerm(std::int32_t node, double freeTerm, double* h) const {
    const auto add = [&](std::int32_t column, double value) {
        for (std::ptrdiff_t k = 0; k < 3; ++k) h[9 * static_cast<std::ptrdiff_t>(column) + 4 * k] += value;
    };
    add(node, freeTerm);
    if (bubble(node))
        for (const std::int32_t end : ends_[static_cast<std::size_t>(node - freeCount_)]) add(end, 0.5 * freeTerm);
}

double BoundaryEquation::row(std::int32_t node, double* h, double* g) const {
    std::fill_n(h, 9 * (static_cast<std::size_t>(nodes()) + 1), 0.0);
    std::fill_n(g, 9 * static_cast<std::size_t>(heldCount_), 0.0);
    const Vec3 x = position(node);
    double sumD = addBlocks(plain_, x, nu_, h, nullptr);
    sumD += addBlocks(curved_, x, nu_, h, nullptr);
    sumD += addBlocks(held_, x, nu_, h, g);
    // From the sum over the surface rather than from the triangles around: a rigid translation is then exact.
    const double freeTerm = -sumD / (4.0 * std::numbers::pi);
    addFreeTerm(node, freeTerm, h);
    for (std::size_t j = 0; j < columnScale_.size(); ++j)
        for (std::size_t k = 0; k < 9; ++k) g[9 * j + k] *= -columnScale_[j];
    return freeTerm;
}

Eigen::MatrixXd BoundaryEquation::loads(int threads, const Progress& progress) const {
    Eigen::MatrixXd out(3 * nodes(), kLoads);
    parallelFor(threads, static_cast<std::size_t>(nodes()), kNodeGrain, [&](std::size_t begin, std::size_t end) {
        if (progress.cancelled()) return;
        for (auto node = static_cast<std::int32_t>(begin); node < static_cast<std::int32_t>(end); ++node) {
            const LoadBlocks plain = sumLoads(plain_, position(node), nu_), curved = sumLoads(curved_, position(node), nu_),
                             held = sumLoads(held_, position(node), nu_);
            out.block<3, 3>(3 * node, 0) = size_ * size_ * (plain.force + curved.force + held.force);
            out.block<3, 1>(3 * node, 3) = size_ * (plain.pressure + curved.pressure);
        }
    });
    return out;
}

Eigen::MatrixXd BoundaryEquation::tractionLoads(const Eigen::MatrixXd& sizes, int threads, const Progress& progress) const {
    // The vertices that carry tractions, and for each which.
    struct Part {
        Eigen::Index load;
        double size;
    };
    std::vector<std::int32_t> column(static_cast<std::size_t>(mesh_.vertices.rows()), -1);
    std::vector<Part> parts;
    std::vector<std::size_t> first{0};
    for (Eigen::Index v = 0; v < sizes.rows(); ++v) {
        for (Eigen::Index i = 0; i < sizes.cols(); ++i)
            if (sizes(v, i) != 0.0) parts.push_back({i, size_ * sizes(v, i)});
        if (parts.size() == first.back()) continue;
        column[static_cast<std::size_t>(v)] = static_cast<std::int32_t>(first.size()) - 1;
        first.push_back(parts.size());
    }
    const std::size_t loaded = first.size() - 1;
    std::vector<std::int32_t> which;
    TriangleBatch::Columns columns;
    for (std::int32_t f = 0; f < mesh_.triangles.rows(); ++f) {
        std::array<std::int32_t, 3> of{};
        bool carries = false;
        for (std::size_t c = 0; c < 3; ++c) {
            of[c] = column[static_cast<std::size_t>(mesh_.triangles(f, static_cast<Eigen::Index>(c)))];
            carries |= of[c] >= 0;
            if (of[c] < 0) of[c] = static_cast<std::int32_t>(loaded);
        }
        if (!carries || inPatch_[static_cast<std::size_t>(f)]) continue;
        which.push_back(f);
        columns.corner.push_back({0, 0, 0});
        columns.traction.push_back(of);
    }
    const TriangleBatch batch(mesh_, which, columns);

    Eigen::MatrixXd out(3 * nodes(), 3 * sizes.cols());
    parallelFor(threads, static_cast<std::size_t>(nodes()), kNodeGrain, [&](std::size_t begin, std::size_t end) {
        if (progress.cancelled()) return;
        std::array<double, 9> unread{};
        std::vector<double> g;
        Eigen::Matrix<double, 3, Eigen::Dynamic> row(3, out.cols());
        for (auto node = static_cast<std::int32_t>(begin); node < static_cast<std::int32_t>(end); ++node) {
            g.assign(9 * (loaded + 1), 0.0);
            addBlocks(batch, position(node), nu_, unread.data(), g.data());
            row.setZero();
            for (std::size_t v = 0; v < loaded; ++v) {
                const Eigen::Map<const Eigen::Matrix3d> block(g.data() + 9 * v);  // symmetric
                for (std::size_t i = first[v]; i < first[v + 1]; ++i) row.middleCols<3>(3 * parts[i].load) += parts[i].size * block;
            }
            out.middleRows<3>(3 * node) = row;
        }
    });
    return out;
}

}  // namespace imomushi
