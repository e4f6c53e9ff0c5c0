// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/body_geometry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <span>
#include <utility>

#include "core/base/union_find.h"
#include "core/mesh/vertex_corners.h"

namespace imomushi::render {

namespace {

using Float3 = Eigen::Map<const Eigen::Vector3f>;

Eigen::Vector3f facetNormal(const float* positions, const Triangles& t, int f) {
    const Float3 a(positions + 3 * t(f, 0)), b(positions + 3 * t(f, 1)), c(positions + 3 * t(f, 2));
    return (b - a).cross(c - a);
}

Eigen::Vector3f unit(const Eigen::Vector3f& v) {
    const float n = v.norm();
    return n > 1e-30f ? Eigen::Vector3f(v / n) : Eigen::Vector3f(0, 1, 0);
}

/// Splits the corners (triangle * 3 + corner) around one body vertex into groups; writes a group number per corner.
void groupCorners(std::span<const std::int32_t> corners, const ElementMesh& mesh, bool ownNormals, const std::vector<Eigen::Vector3f>& unitFacet,
                  std::vector<int>& group) {
    const int n = static_cast<int>(corners.size());
    group.resize(n);
    UnionFind sets(corners.size());
    const Triangles& t = mesh.body.triangles;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < i; ++j) {
            const int fi = corners[i] / 3, fj = corners[j] / 3;
            bool same = false;
            if (ownNormals) {
                const auto a = mesh.renderMesh.normals.row(mesh.renderMesh.triangles(fi, corners[i] % 3));
                const auto b = mesh.renderMesh.normals.row(mesh.renderMesh.triangles(fj, corners[j] % 3));
                same = a.dot(b) >= BodyGeometry::kSameNormal * a.norm() * b.norm();
            } else if (unitFacet[fi].dot(unitFacet[fj]) >= BodyGeometry::kCrease) {
                // Neighbours around the vertex: they share an edge at it.
                const int ni = t(fi, (corners[i] % 3 + 1) % 3), pi = t(fi, (corners[i] % 3 + 2) % 3);
                const int nj = t(fj, (corners[j] % 3 + 1) % 3), pj = t(fj, (corners[j] % 3 + 2) % 3);
                same = ni == pj || pi == nj;
            }
            if (same) sets.unite(i, j);
        }
    for (int i = 0; i < n; ++i) group[i] = sets.find(i);
}

}  // namespace

BodyGeometry::BodyGeometry(const ElementMesh& mesh, const std::vector<std::int32_t>* covered) : triangles_(mesh.body.triangles) {
    const int vertices = static_cast<int>(mesh.body.vertices.rows()), faces = static_cast<int>(triangles_.rows());
    const bool hasRenderMesh = mesh.renderMesh.triangles.rows() == faces && !mesh.renderMesh.bodyVertex.empty();
    const bool ownNormals = hasRenderMesh && mesh.renderMesh.normals.rows() == static_cast<Eigen::Index>(mesh.renderMesh.bodyVertex.size());
    std::vector<char> isCovered(faces, 0), isShown(faces, 1);
    if (covered)
        for (const std::int32_t f : *covered)
            if (f >= 0 && f < faces) isCovered[f] = 1, isShown[f] = 0;

    std::vector<Eigen::Vector3f> unitFacet(faces);
    const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> rest = mesh.body.vertices.cast<float>();
    for (int f = 0; f < faces; ++f) unitFacet[f] = unit(facetNormal(rest.data(), triangles_, f));

    const std::span<const std::int32_t> corners(triangles_.data(), static_cast<std::size_t>(triangles_.size()));
    const VertexCorners shownCorners(corners, static_cast<std::size_t>(vertices), isShown), coveredCorners(corners, static_cast<std::size_t>(vertices), isCovered);

    // Groups, and display vertices: one for each pair of render vertex and group.
    corner_.assign(3 * std::size_t(faces), 0);
    seamGroup_.assign(vertices, -1);
    groupStart_ = {0};
    std::vector<int> group;
    // Of one vertex, and so few that a search from the front is the fastest.
    struct DisplayVertex {
        int renderVertex, group;
        std::uint32_t index;
    };
    std::vector<DisplayVertex> known;
    std::vector<std::pair<int, int>> number;  // root -> group, -1: whole
    for (int v = 0; v < vertices; ++v) {
        const auto around = shownCorners.at(v), coveredAround = coveredCorners.at(v);
        groupCorners(around, mesh, ownNormals, unitFacet, group);
        known.clear();
        number.clear();
        const auto numberOf = [&](int root) { return std::find_if(number.begin(), number.end(), [&](const auto& entry) { return entry.first == root; }); };
        int partial = 0;
        for (std::size_t i = 0; i < around.size(); ++i) {
            if (numberOf(group[i]) != number.end()) continue;
            int& own = number.emplace_back(group[i], -1).second;
            const bool whole = coveredAround.empty() && std::count(group.begin(), group.end(), group[i]) == static_cast<long>(group.size());
            if (whole) continue;
            for (std::size_t k = 0; k < around.size(); ++k)
                if (group[k] == group[i]) groupTriangles_.push_back(around[k] / 3);
            own = static_cast<int>(groupStart_.size()) - 1;
            groupStart_.push_back(static_cast<int>(groupTriangles_.size()));
            seamGroup_[v] = own;
            ++partial;
        }
        if (partial != 1) seamGroup_[v] = -1;
        const auto place = [&](int corner, int g) {
            const int renderVertex = hasRenderMesh ? mesh.renderMesh.triangles(corner / 3, corner % 3) : -1;
            auto at = std::find_if(known.begin(), known.end(), [&](const DisplayVertex& d) { return d.renderVertex == renderVertex && d.group == g; });
            if (at == known.end()) {
                at = known.insert(at, {renderVertex, g, static_cast<std::uint32_t>(bodyVertex_.size())});
                bodyVertex_.push_back(v);
                renderVertex_.push_back(renderVertex);
                group_.push_back(g);
            }
            corner_[corner] = at->index;
        };
        for (std::size_t i = 0; i < around.size(); ++i) place(around[i], numberOf(group[i])->second);
        for (const int corner : coveredAround) place(corner, -1);
    }
    usedTriangles_ = groupTriangles_;
    std::sort(usedTriangles_.begin(), usedTriangles_.end());
    usedTriangles_.erase(std::unique(usedTriangles_.begin(), usedTriangles_.end()), usedTriangles_.end());
    if (!usedTriangles_.empty()) facet_.resize(faces);
    sums_.resize(groupStart_.size() - 1);
    welded_.resize(sums_.size());

    // Drawn triangles by material.
    const bool materials = hasRenderMesh && mesh.renderMesh.material.size() == static_cast<std::size_t>(faces);
    for (int f = 0; f < faces; ++f)
        if (!isCovered[f]) drawnTriangle_.push_back(f);
    const auto materialOf = [&](int f) {
        const int m = materials ? mesh.renderMesh.material[f] : -1;
        return m < static_cast<int>(mesh.renderMesh.materials.size()) ? m : -1;
    };
    std::stable_sort(drawnTriangle_.begin(), drawnTriangle_.end(), [&](int a, int b) { return materialOf(a) < materialOf(b); });
    indices_.reserve(3 * drawnTriangle_.size());
    for (const int f : drawnTriangle_) {
        if (ranges_.empty() || ranges_.back().material != materialOf(f)) ranges_.push_back({materialOf(f), static_cast<int>(indices_.size()), 0});
        indices_.insert(indices_.end(), &corner_[3 * f], &corner_[3 * f] + 3);
        ranges_.back().count += 3;
    }
}

void BodyGeometry::sumNormals(const float* positions) {
    for (const int f : usedTriangles_) facet_[f] = facetNormal(positions, triangles_, f);
    for (std::size_t g = 0; g < sums_.size(); ++g) {
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        for (int k = groupStart_[g]; k < groupStart_[g + 1]; ++k) sum += facet_[groupTriangles_[k]];
        sums_[g] = sum;
        welded_[g] = sum;
    }
}

void BodyGeometry::fill(const float* positions, const float* normals, float* out) {
    if (!normals) {
        ownNormals_.assign(3 * seamGroup_.size(), 0.0f);
        for (int f = 0; f < triangles_.rows(); ++f) {
            const Eigen::Vector3f n = facetNormal(positions, triangles_, f);
            for (int c = 0; c < 3; ++c) Eigen::Map<Eigen::Vector3f>(&ownNormals_[3 * triangles_(f, c)]) += n;
        }
        for (std::size_t v = 0; v < seamGroup_.size(); ++v) {
            Eigen::Map<Eigen::Vector3f> n(&ownNormals_[3 * v]);
            n = unit(n);
        }
        normals = ownNormals_.data();
    }
    for (std::size_t i = 0; i < bodyVertex_.size(); ++i, out += kFloats) {
        Eigen::Map<Eigen::Vector3f> position(out), normal(out + 3);
        position = Float3(positions + 3 * bodyVertex_[i]);
        normal = group_[i] < 0 ? Eigen::Vector3f(Float3(normals + 3 * bodyVertex_[i])) : unit(welded_[group_[i]]);
    }
}

}  // namespace imomushi::render
