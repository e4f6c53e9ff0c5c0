// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "core/elasticity/column_gather.h"
#include "core/elasticity/hierarchical_matrix.h"
#include "tests/support/shapes.h"

namespace imomushi {

/// The boundary equations of a body held at some patches, entry by entry: unknowns are displacements of free vertices and scaled tractions of
/// held ones, as in BoundaryProblem. Counts how often it was asked.
class SurfaceSource : public BlockSource {
public:
    SurfaceSource(const TriangleMesh& body, const std::vector<shapes::Patch>& held, double nu) : mesh_(body), nu_(nu), gather_(normalise(mesh_)) {
        const auto count = static_cast<std::size_t>(mesh_.vertices.rows());
        isHeld_.resize(count);
        scale_.resize(count);
        freeTerm_.resize(count);
        inPatch_.resize(static_cast<std::size_t>(mesh_.triangles.rows()));
        notInPatch_.assign(inPatch_.size(), 1);
        for (const auto& patch : held) {
            for (const std::int32_t v : patch.vertices) isHeld_[static_cast<std::size_t>(v)] = 1;
            for (const std::int32_t f : patch.triangles) {
                inPatch_[static_cast<std::size_t>(f)] = 1;
                notInPatch_[static_cast<std::size_t>(f)] = 0;
                const double area = 0.5 * normalOf(f).norm();
                for (int c = 0; c < 3; ++c) scale_[static_cast<std::size_t>(mesh_.triangles(f, c))] += area / 3.0;
            }
        }
        for (std::int32_t v = 0; v < nodes(); ++v) {
            auto& s = scale_[static_cast<std::size_t>(v)];
            s = isHeld_[static_cast<std::size_t>(v)] ? 2.0 / std::sqrt(s) : 0.0;
            freeTerm_[static_cast<std::size_t>(v)] = innerSolidAngle(mesh_, v, gather_.trianglesOf(v));
        }
    }

    [[nodiscard]] std::int32_t nodes() const override { return static_cast<std::int32_t>(mesh_.vertices.rows()); }
    [[nodiscard]] Vec3 position(std::int32_t node) const override { return mesh_.vertices.row(node).transpose(); }
    [[nodiscard]] Box support(std::int32_t node) const override {
        Box box{position(node), position(node)};
        for (const std::int32_t f : gather_.trianglesOf(node))
            for (int c = 0; c < 3; ++c) {
                const Vec3 p = mesh_.vertices.row(mesh_.triangles(f, c)).transpose();
                box.low = box.low.cwiseMin(p);
                box.high = box.high.cwiseMax(p);
            }
        return box;
    }
    [[nodiscard]] std::unique_ptr<Columns> columns(std::span<const std::int32_t> nodes) const override;

    /// -H_J C: the right-hand sides for prescribed displacements (3 #vertices x k; rows of free vertices are not read).
    [[nodiscard]] Eigen::MatrixXd rightHandSides(const Eigen::MatrixXd& prescribed, int threads) const {
        std::vector<std::int32_t> held;
        for (std::int32_t v = 0; v < nodes(); ++v)
            if (isHeld_[static_cast<std::size_t>(v)]) held.push_back(v);
        Eigen::MatrixXd known(3 * held.size(), prescribed.cols());
        for (std::size_t i = 0; i < held.size(); ++i)
            known.middleRows(static_cast<Eigen::Index>(3 * i), 3) = prescribed.middleRows(3 * held[i], 3);
        const TriangleBatch batch = gather_.around(held);
        Eigen::MatrixXd out(3 * nodes(), prescribed.cols());
        parallelFor(threads, static_cast<std::size_t>(nodes()), 16, [&](std::size_t begin, std::size_t end) {
            std::vector<double> h;
            Eigen::MatrixXd row(3, known.rows());
            for (auto x = static_cast<std::int32_t>(begin); x < static_cast<std::int32_t>(end); ++x) {
                h.assign(9 * (held.size() + 1), 0.0);
                addBlocks(batch, position(x), nu_, h.data(), nullptr);
                for (Eigen::Index i = 0; i < row.size() / 9; ++i)
                    for (int k = 0; k < 3; ++k)
                        for (int l = 0; l < 3; ++l) row(k, 3 * i + l) = h[static_cast<std::size_t>(9 * i + 3 * k + l)];
                out.middleRows(3 * x, 3).noalias() = -(row * known);
                if (isHeld_[static_cast<std::size_t>(x)])
                    out.middleRows(3 * x, 3) -= freeTerm_[static_cast<std::size_t>(x)] * prescribed.middleRows(3 * x, 3);
            }
        });
        return out;
    }

    [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
    [[nodiscard]] bool held(std::int32_t v) const { return isHeld_[static_cast<std::size_t>(v)] != 0; }
    /// Traction (shear modulus 1, of the body with a bounding box of diagonal 1) per unknown.
    [[nodiscard]] double tractionScale(std::int32_t v) const { return scale_[static_cast<std::size_t>(v)]; }
    [[nodiscard]] std::int64_t asked() const { return asked_; }

private:
    static const TriangleMesh& normalise(TriangleMesh& mesh) {
        const Eigen::RowVector3d low = mesh.vertices.colwise().minCoeff(), high = mesh.vertices.colwise().maxCoeff();
        mesh.vertices = ((mesh.vertices.rowwise() - 0.5 * (low + high)) / (high - low).norm()).eval();
        return mesh;
    }
    [[nodiscard]] Vec3 normalOf(std::int32_t f) const {
        const Eigen::Vector3d a = mesh_.vertices.row(mesh_.triangles(f, 0)), b = mesh_.vertices.row(mesh_.triangles(f, 1)),
                              c = mesh_.vertices.row(mesh_.triangles(f, 2));
        const Vec3 u = b - a, v = c - a;
        return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    }

    friend class SurfaceColumns;
    TriangleMesh mesh_;
    double nu_;
    ColumnGather gather_;
    std::vector<char> isHeld_, inPatch_, notInPatch_;
    std::vector<double> scale_, freeTerm_;
    mutable std::atomic<std::int64_t> asked_{0};
};

class SurfaceColumns : public BlockSource::Columns {
public:
    SurfaceColumns(const SurfaceSource& source, std::span<const std::int32_t> nodes) : source_(source), nodes_(nodes.begin(), nodes.end()) {
        std::vector<std::int32_t> freeNodes, heldNodes;
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            const bool held = source.isHeld_[static_cast<std::size_t>(nodes_[i])] != 0;
            (held ? heldAt_ : freeAt_).push_back(static_cast<std::int32_t>(i));
            (held ? heldNodes : freeNodes).push_back(nodes_[i]);
        }
        if (!freeAt_.empty()) free_ = source.gather_.around(freeNodes);
        if (!heldAt_.empty()) held_ = source.gather_.aroundForBoth(heldNodes, source.notInPatch_);
    }
    void rows(std::span<const std::int32_t> rowNodes, double* out) const override {
        ++source_.asked_;
        thread_local std::vector<double> h, g;
        const std::size_t ld = 3 * rowNodes.size();
        for (std::size_t r = 0; r < rowNodes.size(); ++r) {
            const std::int32_t x = rowNodes[r];
            const Vec3 p = source_.position(x);
            h.assign(9 * (std::max(freeAt_.size(), heldAt_.size()) + 1), 0.0);
            if (!freeAt_.empty()) addBlocks(free_, p, source_.nu_, h.data(), nullptr);
            for (std::size_t i = 0; i < freeAt_.size(); ++i) {
                double* to = out + 3 * static_cast<std::size_t>(freeAt_[i]) * ld + 3 * r;
                for (std::size_t k = 0; k < 3; ++k)
                    for (std::size_t l = 0; l < 3; ++l) to[l * ld + k] = h[9 * i + 3 * k + l];
                if (nodes_[static_cast<std::size_t>(freeAt_[i])] == x)
                    for (std::size_t k = 0; k < 3; ++k) to[k * ld + k] += source_.freeTerm_[static_cast<std::size_t>(x)];
            }
            if (heldAt_.empty()) continue;
            g.assign(9 * (heldAt_.size() + 1), 0.0);
            addBlocks(held_, p, source_.nu_, h.data(), g.data());
            for (std::size_t i = 0; i < heldAt_.size(); ++i) {
                const auto at = static_cast<std::size_t>(heldAt_[i]);
                double* to = out + 3 * at * ld + 3 * r;
                const double scale = -source_.scale_[static_cast<std::size_t>(nodes_[at])];
                for (std::size_t k = 0; k < 3; ++k)
                    for (std::size_t l = 0; l < 3; ++l) to[l * ld + k] = scale * g[9 * i + 3 * k + l];
            }
        }
    }

private:
    const SurfaceSource& source_;
    std::vector<std::int32_t> nodes_, freeAt_, heldAt_;
    TriangleBatch free_, held_;
};

inline std::unique_ptr<BlockSource::Columns> SurfaceSource::columns(std::span<const std::int32_t> nodes) const {
    return std::make_unique<SurfaceColumns>(*this, nodes);
}

}  // namespace imomushi
