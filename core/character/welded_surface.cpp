// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/welded_surface.h"

#include <limits>

#include "core/base/union_find.h"

namespace imomushi {

WeldedSurface weldedSurface(const CharacterInput& input, bool hidden) {
    WeldedSurface out;
    out.first = {0};
    std::vector<std::vector<char>> covered;
    for (const auto& e : input.elements) {
        out.first.push_back(out.first.back() + static_cast<int>(e.mesh->body.vertices.rows()));
        covered.emplace_back(static_cast<std::size_t>(e.mesh->body.triangles.rows()), 0);
    }
    const int count = out.first.back();
    out.vertices.resize(count, 3);
    out.same.resize(static_cast<std::size_t>(count));
    UnionFind sets(out.same.size());
    for (std::size_t e = 0; e < input.elements.size(); ++e)
        out.vertices.middleRows(out.first[e], out.first[e + 1] - out.first[e]) = input.elements[e].mesh->body.vertices;
    for (const auto& joint : input.joints) {
        if (joint.faces.size() < 2) continue;
        for (const auto& f : joint.faces)
            for (const auto t : input.elements[f.element].faces[f.face].triangles) covered[f.element][t] = 1;
        for (const auto& [a, b] : joint.welded) sets.unite(out.first[joint.faces[0].element] + a, out.first[joint.faces[1].element] + b);
    }
    for (std::int32_t v = 0; v < count; ++v) {
        out.same[v] = sets.find(v);
        out.vertices.row(v) = out.vertices.row(out.same[v]).eval();
    }
    std::vector<std::int32_t> corners;
    std::vector<char> seen(static_cast<std::size_t>(count), 0);
    for (std::size_t e = 0; e < input.elements.size(); ++e) {
        const auto& triangles = input.elements[e].mesh->body.triangles;
        for (Eigen::Index t = 0; t < triangles.rows(); ++t)
            for (int c = 0; c < 3 && !covered[e][t]; ++c) {
                corners.push_back(out.same[out.first[e] + triangles(t, c)]);
                seen[corners.back()] = 1;
            }
    }
    out.triangles = Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
    if (!hidden) return out;
    out.weightOf = out.same;
    for (std::int32_t v = 0; v < count; ++v) {
        if (seen[out.same[v]]) continue;
        double nearest = std::numeric_limits<double>::infinity();
        for (std::int32_t w = 0; w < count; ++w) {
            if (!seen[w]) continue;
            const double distance = (out.vertices.row(v) - out.vertices.row(w)).squaredNorm();
            if (distance < nearest) nearest = distance, out.weightOf[v] = w;
        }
    }
    return out;
}

}  // namespace imomushi
