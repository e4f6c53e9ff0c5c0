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

BoundaryEquation::BoundaryEquation(const TriangleMesh& mesh, std::span<const HeldPatch> held, std::span<const std::array<std::int32_t, 2>> bubbles,
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

    // Triangles, and those around each node.
    inPatch_.assign(triangleCount, 0);
    for (const HeldPatch& patch : held)
        for (const std::int32_t f : patch.triangles) inPatch_[static_cast<std::size_t>(f)] = 1;
    const EdgeTable edges(mesh.triangles);
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
    cornerNode_.resize(triangleCount);
    bubbleNode_.resize(triangleCount);
    around_.assign(static_cast<std::size_t>(nodes()) + 1, 0);
    const auto eachNode = [&](std::size_t f, const auto& visit) {
        for (std::size_t c = 0; c < 3; ++c) {
            visit(cornerNode_[f][c]);
            if (bubbleNode_[f][c] >= 0) visit(bubbleNode_[f][c]);
        }
    };
    for (std::size_t f = 0; f < triangleCount; ++f) {
        for (int c = 0; c < 3; ++c) {
            const auto k = static_cast<std::size_t>(c);
            cornerNode_[f][k] = nodeOf[static_cast<std::size_t>(mesh.triangles(static_cast<Eigen::Index>(f), c))];
            bubbleNode_[f][k] = bubbleOf[static_cast<std::size_t>(edges.edgeOf(static_cast<std::int32_t>(f), c))];
        }
        eachNode(f, [&](std::int32_t node) { ++around_[static_cast<std::size_t>(node) + 1]; });
    }
    for (std::size_t i = 1; i < around_.size(); ++i) around_[i] += around_[i - 1];
    triangles_.resize(around_.back());
    std::vector<std::size_t> next(around_.begin(), around_.end() - 1);
    for (std::size_t f = 0; f < triangleCount; ++f)
        eachNode(f, [&](std::int32_t node) { triangles_[next[static_cast<std::size_t>(node)]++] = static_cast<std::int32_t>(f); });

    // Minus the sum of D_a over the whole surface / (4 pi), but found from the triangles around a node alone.
    freeTerm_.resize(static_cast<std::size_t>(nodes()));
    const std::vector<double> solidAngle = vertexSolidAngles(mesh_);
    for (std::size_t v = 0; v < nodeOf.size(); ++v) freeTerm_[static_cast<std::size_t>(nodeOf[v])] = solidAngle[v];
    for (int e = 0; e < edges.size(); ++e)
        if (const std::int32_t b = bubbleOf[static_cast<std::size_t>(e)]; b >= 0)
            freeTerm_[static_cast<std::size_t>(b)] = 0.5 - edgeBend(mesh_, edges.uses(e)) / (2.0 * std::numbers::pi);

    // Traction columns are scaled to the size of H: by what a vertex's traction does to the vertex itself, however thin the triangles around.
    columnScale_.assign(static_cast<std::size_t>(heldCount_), 0.0);
    const std::int32_t firstHeld = freeCount_ + bubbleCount_;
    for (std::size_t f = 0; f < triangleCount; ++f) {
        if (!inPatch_[f]) continue;
        std::array<Vec3, 3> p;
        for (std::size_t c = 0; c < 3; ++c) p[c] = points_.row(cornerNode_[f][c]).transpose();
        for (std::size_t c = 0; c < 3; ++c) columnScale_[static_cast<std::size_t>(cornerNode_[f][c] - firstHeld)] += pairBlocks(p[c], p, nu).g[c].trace() / 3.0;
    }
    for (double& scale : columnScale_) scale = 0.5 / scale;

    std::vector<std::int32_t> every(static_cast<std::size_t>(nodes()));
    for (std::int32_t i = 0; i < nodes(); ++i) every[static_cast<std::size_t>(i)] = i;
    all_ = gather(every, Wanted::Displacements);
}

std::int32_t BoundaryEquation::vertexOf(std::int32_t node) const {
    if (bubble(node)) return vertexOf(ends_[static_cast<std::size_t>(node - freeCount_)][0]);
    return node < freeCount_ ? freeVertices_[static_cast<std::size_t>(node)] : heldVertices_[static_cast<std::size_t>(node - freeCount_ - bubbleCount_)];
}

std::span<const std::int32_t> BoundaryEquation::trianglesOf(std::int32_t node) const {
    const auto i = static_cast<std::size_t>(node);
    return std::span(triangles_).subspan(around_[i], around_[i + 1] - around_[i]);
}

BoundaryEquation::Gathered BoundaryEquation::gather(std::span<const std::int32_t> columnNodes, Wanted wanted) const {
    // A column for every node. Each thread keeps its own: clearing it would cost more than a small set of columns.
    thread_local std::vector<std::int32_t> column, which;
    const auto ignored = static_cast<std::int32_t>(columnNodes.size());
    if (column.size() < static_cast<std::size_t>(points_.rows())) column.resize(static_cast<std::size_t>(points_.rows()));
    which.clear();
    for (const std::int32_t node : columnNodes)
        for (const std::int32_t f : trianglesOf(node))
            // The tractions of held vertices live on their patch only, the displacements on all triangles around.
            if (wanted == Wanted::Displacements || node < freeCount_ + bubbleCount_ || inPatch_[static_cast<std::size_t>(f)]) which.push_back(f);
    std::sort(which.begin(), which.end());
    which.erase(std::unique(which.begin(), which.end()), which.end());
    for (const std::int32_t f : which)
        for (std::size_t c = 0; c < 3; ++c) {
            column[static_cast<std::size_t>(cornerNode_[static_cast<std::size_t>(f)][c])] = ignored;
            if (const std::int32_t b = bubbleNode_[static_cast<std::size_t>(f)][c]; b >= 0) column[static_cast<std::size_t>(b)] = ignored;
        }
    for (std::int32_t i = 0; i < ignored; ++i) column[static_cast<std::size_t>(columnNodes[static_cast<std::size_t>(i)])] = i;

    // One batch per kind of columns that its triangles add to.
    std::vector<std::int32_t> plain, curved, held;
    TriangleBatch::Columns plainColumns, curvedColumns, heldColumns;
    for (const std::int32_t f : which) {
        const auto& nodes = cornerNode_[static_cast<std::size_t>(f)];
        const auto& bubbles = bubbleNode_[static_cast<std::size_t>(f)];
        std::array<std::int32_t, 3> corner{}, bubble{}, traction{};
        bool bends = false;
        for (std::size_t c = 0; c < 3; ++c) {
            corner[c] = traction[c] = column[static_cast<std::size_t>(nodes[c])];
            if (wanted == Wanted::Displacements) traction[c] = std::max(0, nodes[c] - freeCount_ - bubbleCount_);
            bubble[c] = bubbles[c] >= 0 ? column[static_cast<std::size_t>(bubbles[c])] : ignored;
            bends |= bubble[c] != ignored;
        }
        if (inPatch_[static_cast<std::size_t>(f)]) {
            held.push_back(f);
            heldColumns.corner.push_back(corner);
            heldColumns.traction.push_back(traction);
        } else if (bends) {
            curved.push_back(f);
            curvedColumns.corner.push_back(corner);
            curvedColumns.bubble.push_back(bubble);
        } else {
            plain.push_back(f);
            plainColumns.corner.push_back(corner);
        }
    }
    return {TriangleBatch(mesh_, plain, plainColumns), TriangleBatch(mesh_, curved, curvedColumns), TriangleBatch(mesh_, held, heldColumns)};
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
    double sumD = addBlocks(all_.plain, x, nu_, h, nullptr);
    sumD += addBlocks(all_.curved, x, nu_, h, nullptr);
    sumD += addBlocks(all_.held, x, nu_, h, g);
    // From the sum over the surface rather than from the triangles around: a rigid translation is then exact.
    const double freeTerm = -sumD / (4.0 * std::numbers::pi);
    addFreeTerm(node, freeTerm, h);
    for (std::size_t j = 0; j < columnScale_.size(); ++j)
        for (std::size_t k = 0; k < 9; ++k) g[9 * j + k] *= -columnScale_[j];
    return freeTerm;
}

Eigen::MatrixXd BoundaryEquation::rightHandSides(const Eigen::MatrixXd& held, int threads, const Progress& progress) const {
    std::vector<std::int32_t> heldNodes(static_cast<std::size_t>(heldCount_));
    for (std::int32_t j = 0; j < heldCount_; ++j) heldNodes[static_cast<std::size_t>(j)] = freeCount_ + bubbleCount_ + j;
    const Gathered columns = gather(heldNodes, Wanted::Displacements);
    Eigen::MatrixXd out(3 * nodes(), held.cols());
    parallelFor(threads, static_cast<std::size_t>(nodes()), kNodeGrain, [&](std::size_t begin, std::size_t end) {
        if (progress.cancelled()) return;
        std::vector<double> h;
        Eigen::MatrixXd row(3, held.rows());
        for (auto node = static_cast<std::int32_t>(begin); node < static_cast<std::int32_t>(end); ++node) {
            h.assign(9 * (static_cast<std::size_t>(heldCount_) + 1), 0.0);
            for (const TriangleBatch* batch : {&columns.plain, &columns.curved, &columns.held})
                addBlocks(*batch, position(node), nu_, h.data(), nullptr);
            const auto addIfHeld = [&](std::int32_t at, double value) {
                const std::ptrdiff_t j = at - freeCount_ - bubbleCount_;
                for (std::ptrdiff_t k = 0; k < 3 && j >= 0; ++k) h[static_cast<std::size_t>(9 * j + 4 * k)] += value;
            };
            const double freeTerm = freeTerm_[static_cast<std::size_t>(node)];
            addIfHeld(node, freeTerm);
            if (bubble(node))
                for (const std::int32_t e : ends_[static_cast<std::size_t>(node - freeCount_)]) addIfHeld(e, 0.5 * freeTerm);
            for (Eigen::Index j = 0; j < heldCount_; ++j)
                for (Eigen::Index k = 0; k < 3; ++k)
                    for (Eigen::Index l = 0; l < 3; ++l) row(k, 3 * j + l) = -h[static_cast<std::size_t>(9 * j + 3 * k + l)];
            out.middleRows(3 * node, 3).noalias() = row * held;
        }
    });
    return out;
}

Eigen::MatrixXd BoundaryEquation::loads(int threads, const Progress& progress) const {
    Eigen::MatrixXd out(3 * nodes(), kLoads);
    parallelFor(threads, static_cast<std::size_t>(nodes()), kNodeGrain, [&](std::size_t begin, std::size_t end) {
        if (progress.cancelled()) return;
        for (auto node = static_cast<std::int32_t>(begin); node < static_cast<std::int32_t>(end); ++node) {
            const LoadBlocks plain = sumLoads(all_.plain, position(node), nu_), curved = sumLoads(all_.curved, position(node), nu_),
                             held = sumLoads(all_.held, position(node), nu_);
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

double BoundaryEquation::surfaceSolidAngle(std::int32_t node) const {
    thread_local std::vector<double> unread;
    unread.assign(9 * (static_cast<std::size_t>(nodes()) + 1), 0.0);
    double sumD = 0.0;
    for (const TriangleBatch* batch : {&all_.plain, &all_.curved, &all_.held}) sumD += addBlocks(*batch, position(node), nu_, unread.data(), nullptr);
    return -sumD / (4.0 * std::numbers::pi);
}

Box BoundaryEquation::support(std::int32_t node) const {
    Box box{position(node), position(node)};
    for (const std::int32_t f : trianglesOf(node))
        for (int c = 0; c < 3; ++c) {
            const Vec3 p = mesh_.vertices.row(mesh_.triangles(f, c)).transpose();
            box.low = box.low.cwiseMin(p);
            box.high = box.high.cwiseMax(p);
        }
    return box;
}

class BoundaryEquation::SomeColumns final : public Columns {
public:
    SomeColumns(const BoundaryEquation& equation, std::span<const std::int32_t> nodes)
        : equation_(equation), nodes_(nodes.begin(), nodes.end()), gathered_(equation.gather(nodes, Wanted::Unknowns)) {}

    void rows(std::span<const std::int32_t> rowNodes, double* out) const override {
        thread_local std::vector<double> h, g;
        const std::size_t ld = 3 * rowNodes.size();
        const std::int32_t firstHeld = equation_.freeCount_ + equation_.bubbleCount_;
        for (std::size_t r = 0; r < rowNodes.size(); ++r) {
            const std::int32_t node = rowNodes[r];
            const Vec3 x = equation_.position(node);
            h.assign(9 * (nodes_.size() + 1), 0.0);
            g.assign(9 * (nodes_.size() + 1), 0.0);
            for (const TriangleBatch* batch : {&gathered_.plain, &gathered_.curved}) addBlocks(*batch, x, equation_.nu_, h.data(), nullptr);
            addBlocks(gathered_.held, x, equation_.nu_, h.data(), g.data());
            const double freeTerm = equation_.freeTerm_[static_cast<std::size_t>(node)];
            for (std::size_t i = 0; i < nodes_.size(); ++i) {
                const std::int32_t column = nodes_[i];
                const bool held = column >= firstHeld;
                const double factor = held ? -equation_.columnScale_[static_cast<std::size_t>(column - firstHeld)] : 1.0;
                const double* block = (held ? g : h).data() + 9 * i;
                double* to = out + 3 * i * ld + 3 * r;
                for (std::size_t k = 0; k < 3; ++k)
                    for (std::size_t l = 0; l < 3; ++l) to[l * ld + k] = factor * block[3 * k + l];
                double share = 0.0;
                if (column == node && !held) share = freeTerm;
                if (equation_.bubble(node))
                    for (const std::int32_t end : equation_.ends_[static_cast<std::size_t>(node - equation_.freeCount_)])
                        if (end == column && !held) share += 0.5 * freeTerm;
                if (share != 0.0)
                    for (std::size_t k = 0; k < 3; ++k) to[k * ld + k] += share;
            }
        }
    }

private:
    const BoundaryEquation& equation_;
    std::vector<std::int32_t> nodes_;
    Gathered gathered_;
};

std::unique_ptr<BlockSource::Columns> BoundaryEquation::columns(std::span<const std::int32_t> columnNodes) const {
    return std::make_unique<SomeColumns>(*this, columnNodes);
}

}  // namespace imomushi
