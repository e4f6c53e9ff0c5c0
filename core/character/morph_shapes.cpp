// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/morph_shapes.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>

namespace imomushi {

namespace {

constexpr double kLeastSine = 1e-4;  // of two tangents: at less they span no plane

/// Tangents and unit normal of a stencil of vertex v as columns; 0: it has no area.
template <class Number>
Eigen::Matrix<Number, 3, 3> frameAt(const NormalStencil& s, std::int32_t v, const Number* positions) {
    using Vector = Eigen::Matrix<Number, 3, 1>;
    const auto at = [positions](std::int32_t i) { return Eigen::Map<const Vector>(positions + 3 * static_cast<std::ptrdiff_t>(i)); };
    const Vector e = at(v) - at(s.c);
    Eigen::Matrix<Number, 3, 3> out;
    out.col(0) = at(s.a) - at(s.b) + static_cast<Number>(s.part[0]) * e;
    out.col(1) = at(s.d) - at(s.c) + static_cast<Number>(s.part[1]) * e;
    const Vector across = out.col(0).cross(out.col(1));
    const Number area = across.norm();
    if (!(area > static_cast<Number>(kLeastSine) * out.col(0).norm() * out.col(1).norm())) return Eigen::Matrix<Number, 3, 3>::Zero();
    out.col(2) = across / area;
    return out;
}

}  // namespace

std::shared_ptr<const MorphTables> MorphTables::build(const EmbeddedMesh& mesh, const Points& rest, const std::vector<NormalStencil>& stencils) {
    auto made = std::make_shared<MorphTables>();
    made->model = mesh.model;
    std::vector<std::int32_t> place(mesh.vertices.size(), -1);
    for (const MorphTarget& target : mesh.model->morphs)
        for (const std::int32_t v : target.vertices) place[static_cast<std::size_t>(v)] = 0;
    for (std::size_t v = 0; v < place.size(); ++v) {
        if (place[v] < 0) continue;
        place[v] = static_cast<std::int32_t>(made->vertices.size());
        Vertex& vertex = made->vertices.emplace_back();
        vertex.vertex = static_cast<std::int32_t>(v);
        const Eigen::Matrix3d frame = frameAt(stencils[v], vertex.vertex, rest.data());
        vertex.fromRest = frame.isZero(0.0) ? Eigen::Matrix3f(Eigen::Matrix3f::Zero()) : Eigen::Matrix3f(frame.inverse().cast<float>());
    }
    for (const MorphTarget& target : mesh.model->morphs) {
        Target& to = made->targets.emplace_back();
        to.atRest = static_cast<float>(target.atRest);
        to.deltas = target.deltas.data();
        for (const std::int32_t v : target.vertices) to.moved.push_back(place[static_cast<std::size_t>(v)]);
    }
    return made;
}

MorphShapes::MorphShapes(std::shared_ptr<const MorphTables> tables) : tables_(std::move(tables)), sums_(tables_->vertices.size()) {}

std::vector<double> MorphShapes::restWeights() const {
    std::vector<double> out;
    for (const MorphTarget& target : tables_->model->morphs) out.push_back(target.atRest);
    return out;
}

bool MorphShapes::active(const std::vector<double>& weights) const {
    for (std::size_t t = 0; t < weights.size(); ++t)
        if (weights[t] != tables_->model->morphs[t].atRest) return true;
    return false;
}

template <class Number>
void MorphShapes::add(const std::vector<double>& weights, const NormalStencil* stencils, Number* positions) {
    using Vector = Eigen::Matrix<Number, 3, 1>;
    std::fill(sums_.begin(), sums_.end(), Eigen::Vector3f::Zero());
    for (std::size_t t = 0; t < weights.size(); ++t) {
        const auto& target = tables_->targets[t];
        const auto weight = static_cast<float>(weights[t] - tables_->model->morphs[t].atRest);
        if (weight == 0.0f) continue;
        for (std::size_t i = 0; i < target.moved.size(); ++i) sums_[static_cast<std::size_t>(target.moved[i])] += weight * Eigen::Map<const Eigen::Vector3f>(target.deltas + 3 * i);
    }
    // Gradients are those of the surface without what is added.
    for (std::size_t i = 0; i < sums_.size(); ++i) {
        if (sums_[i].isZero(0.0f)) continue;
        const auto& vertex = tables_->vertices[i];
        const auto now = frameAt(stencils[vertex.vertex], vertex.vertex, positions);
        if (vertex.fromRest.isZero(0.0f) || now.isZero(0)) continue;
        sums_[i] = (now * (vertex.fromRest.cast<Number>() * sums_[i].cast<Number>())).template cast<float>();
    }
    for (std::size_t i = 0; i < sums_.size(); ++i)
        Eigen::Map<Vector>(positions + 3 * static_cast<std::ptrdiff_t>(tables_->vertices[i].vertex)) += sums_[i].template cast<Number>();
}

template void MorphShapes::add<float>(const std::vector<double>&, const NormalStencil*, float*);
template void MorphShapes::add<double>(const std::vector<double>&, const NormalStencil*, double*);

}  // namespace imomushi
