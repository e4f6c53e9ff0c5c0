// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/topology.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include "core/base/union_find.h"

namespace imomushi {
namespace {

std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

}  // namespace

EdgeTable::EdgeTable(const Triangles& triangles) : edgeOf_(static_cast<std::size_t>(triangles.rows()) * 3, -1) {
    // Counted into the edges' lower vertices, then each of these few is sorted: as good as linear in the number of triangles.
    const std::size_t vertices = triangles.rows() == 0 ? 0 : index(triangles.maxCoeff()) + 1;
    std::vector<std::int32_t> begin(vertices + 1, 0);
    const auto eachSide = [&](const auto& visit) {
        for (std::int32_t f = 0; f < triangles.rows(); ++f)
            for (int k = 0; k < 3; ++k) {
                const std::int32_t a = triangles(f, k), b = triangles(f, (k + 1) % 3);
                if (a != b) visit(EdgeUse{std::min(a, b), std::max(a, b), f, static_cast<std::int8_t>(k), a < b});
            }
    };
    eachSide([&](const EdgeUse& use) { ++begin[index(use.low) + 1]; });
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    uses_.resize(vertices == 0 ? 0 : index(begin.back()));
    std::vector<std::int32_t> next(begin.begin(), begin.end() - (vertices == 0 ? 0 : 1));
    eachSide([&](const EdgeUse& use) { uses_[index(next[index(use.low)]++)] = use; });
    for (std::size_t v = 0; v < vertices; ++v)
        std::sort(uses_.begin() + begin[v], uses_.begin() + begin[v + 1],
                  [](const EdgeUse& x, const EdgeUse& y) { return std::tie(x.high, x.triangle, x.corner) < std::tie(y.high, y.triangle, y.corner); });
    first_.reserve(uses_.size() / 2 + 1);
    for (std::size_t i = 0; i < uses_.size(); ++i) {
        if (i == 0 || uses_[i].low != uses_[i - 1].low || uses_[i].high != uses_[i - 1].high) first_.push_back(static_cast<std::int32_t>(i));
        edgeOf_[index(uses_[i].triangle) * 3 + static_cast<std::size_t>(uses_[i].corner)] = static_cast<std::int32_t>(first_.size()) - 1;
    }
    first_.push_back(static_cast<std::int32_t>(uses_.size()));
}

std::vector<std::int32_t> edgeComponents(const Triangles& triangles, const EdgeTable& edges, int& count) {
    UnionFind sets(static_cast<std::size_t>(triangles.rows()));
    for (int e = 0; e < edges.size(); ++e)
        for (const EdgeUse& use : edges.uses(e)) sets.unite(edges.uses(e).front().triangle, use.triangle);
    std::vector<std::int32_t> component(static_cast<std::size_t>(triangles.rows()));
    count = 0;
    for (std::int32_t f = 0; f < triangles.rows(); ++f) {
        const std::int32_t root = sets.find(f);
        component[index(f)] = root == f ? count++ : component[index(root)];
    }
    return component;
}

std::vector<std::vector<std::int32_t>> boundaryLoops(const EdgeTable& edges) {
    // What a cap must run along: each lonely side backwards. A vertex may have several ways out.
    std::unordered_map<std::int32_t, std::vector<std::int32_t>> next;
    std::vector<std::pair<std::int32_t, std::int32_t>> sides;
    for (int e = 0; e < edges.size(); ++e) {
        const auto uses = edges.uses(e);
        if (uses.size() != 1) continue;
        const EdgeUse& use = uses.front();
        sides.emplace_back(use.forward ? use.high : use.low, use.forward ? use.low : use.high);
    }
    for (auto side = sides.rbegin(); side != sides.rend(); ++side) next[side->first].push_back(side->second);  // taken from the back

    std::vector<std::vector<std::int32_t>> loops;
    for (const auto& [start, unused] : sides) {
        while (!next[start].empty()) {
            std::vector<std::int32_t> chain{start};
            std::unordered_map<std::int32_t, std::size_t> place{{start, 0}};
            for (;;) {
                auto& ways = next[chain.back()];
                if (ways.empty()) break;  // mixed winding: the chain ends nowhere and bounds nothing
                const std::int32_t to = ways.back();
                ways.pop_back();
                if (const auto seen = place.find(to); seen != place.end()) {
                    std::vector<std::int32_t> loop(chain.begin() + static_cast<std::ptrdiff_t>(seen->second), chain.end());
                    for (std::size_t i = 1; i < loop.size(); ++i) place.erase(loop[i]);
                    chain.resize(seen->second + 1);
                    loops.push_back(std::move(loop));
                    if (chain.size() == 1) break;
                } else {
                    place.emplace(to, chain.size());
                    chain.push_back(to);
                }
            }
        }
    }
    return loops;
}

std::vector<std::int32_t> nonManifoldVertices(const Triangles& triangles, const EdgeTable& edges) {
    // Corners at a vertex belong to one fan when a common edge of exactly two triangles leads from one to the other.
    UnionFind fans(static_cast<std::size_t>(triangles.rows()) * 3);
    const auto cornerAt = [&](std::int32_t f, std::int32_t v) {
        for (int k = 0; k < 3; ++k)
            if (triangles(f, k) == v) return f * 3 + k;
        return f * 3;
    };
    for (int e = 0; e < edges.size(); ++e) {
        const auto uses = edges.uses(e);
        if (uses.size() != 2) continue;
        for (const std::int32_t v : {uses[0].low, uses[0].high}) fans.unite(cornerAt(uses[0].triangle, v), cornerAt(uses[1].triangle, v));
    }
    std::vector<char> hasFan(triangles.rows() == 0 ? 0 : index(triangles.maxCoeff()) + 1, 0);
    std::vector<std::int32_t> bad;
    for (std::int32_t c = 0; c < triangles.rows() * 3; ++c) {
        if (fans.find(c) != c) continue;
        char& has = hasFan[index(triangles(c / 3, c % 3))];
        if (has) bad.push_back(triangles(c / 3, c % 3));
        has = 1;
    }
    std::sort(bad.begin(), bad.end());
    bad.erase(std::unique(bad.begin(), bad.end()), bad.end());
    return bad;
}

std::vector<std::int32_t> duplicateTriangles(const Triangles& triangles) {
    struct Corners {
        std::array<std::int32_t, 3> v;
        std::int32_t triangle;
        bool operator<(const Corners& o) const { return std::tie(v, triangle) < std::tie(o.v, o.triangle); }
    };
    std::vector<Corners> all(static_cast<std::size_t>(triangles.rows()));
    for (std::int32_t f = 0; f < triangles.rows(); ++f) {
        all[index(f)] = {{triangles(f, 0), triangles(f, 1), triangles(f, 2)}, f};
        std::sort(all[index(f)].v.begin(), all[index(f)].v.end());
    }
    std::sort(all.begin(), all.end());
    std::vector<std::int32_t> copies;
    for (std::size_t i = 1; i < all.size(); ++i)
        if (all[i].v == all[i - 1].v) copies.push_back(all[i].triangle);
    std::sort(copies.begin(), copies.end());
    return copies;
}

Vec3 areaVector(const TriangleMesh& mesh, std::int32_t f) {
    const Vec3 a = mesh.vertices.row(mesh.triangles(f, 0));
    const Vec3 b = mesh.vertices.row(mesh.triangles(f, 1));
    const Vec3 c = mesh.vertices.row(mesh.triangles(f, 2));
    return (b - a).cross(c - a);
}

double surfaceArea(const TriangleMesh& mesh) {
    double twice = 0.0;
    for (std::int32_t f = 0; f < mesh.triangles.rows(); ++f) twice += areaVector(mesh, f).norm();
    return 0.5 * twice;
}

double enclosedVolume(const Points& vertices, const Triangles& triangles) {
    if (vertices.rows() == 0) return 0.0;
    const Vec3 middle = vertices.colwise().mean().transpose();
    double six = 0.0;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        const Vec3 a = vertices.row(triangles(t, 0)).transpose() - middle;
        const Vec3 b = vertices.row(triangles(t, 1)).transpose() - middle;
        const Vec3 c = vertices.row(triangles(t, 2)).transpose() - middle;
        six += a.dot(b.cross(c));
    }
    return six / 6.0;
}

bool degenerate(const TriangleMesh& mesh, std::int32_t f) {
    const std::int32_t i = mesh.triangles(f, 0), j = mesh.triangles(f, 1), k = mesh.triangles(f, 2);
    if (i == j || j == k || k == i) return true;
    const Vec3 a = mesh.vertices.row(i), b = mesh.vertices.row(j), c = mesh.vertices.row(k);
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    if (longest == 0.0) return true;
    // Divided before it is squared: no underflow for tiny meshes.
    return (((b - a) / longest).cross((c - a) / longest)).norm() < kFlat;
}

Points vertexNormals(const TriangleMesh& mesh) {
    Points normals = Points::Zero(mesh.vertices.rows(), 3);
    for (std::int32_t f = 0; f < mesh.triangles.rows(); ++f) {
        const Vec3 n = areaVector(mesh, f);
        for (int k = 0; k < 3; ++k) normals.row(mesh.triangles(f, k)) += n.transpose();
    }
    for (Eigen::Index v = 0; v < normals.rows(); ++v)
        if (const double length = normals.row(v).norm(); length > 0.0) normals.row(v) /= length;
    return normals;
}

}  // namespace imomushi
