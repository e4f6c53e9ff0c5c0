// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/scene/rim.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/base/kept_with.h"

namespace imomushi {

RimLoops rimLoops(const Triangles& triangles, std::span<const std::int32_t> patch) {
    using Edge = std::pair<std::int32_t, std::int32_t>;
    std::vector<Edge> edges, rim;  // ascending
    edges.reserve(3 * patch.size());
    for (const std::int32_t t : patch)
        for (int c = 0; c < 3; ++c) edges.emplace_back(triangles(t, c), triangles(t, (c + 1) % 3));
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    // An edge of the rim has the patch on one side only: its opposite direction does not occur.
    for (const auto& [from, to] : edges)
        if (!std::binary_search(edges.begin(), edges.end(), Edge{to, from})) rim.emplace_back(from, to);
    std::vector<char> used(rim.size(), 0);
    const auto nextFrom = [&](std::int32_t vertex) {
        auto i = static_cast<std::size_t>(std::lower_bound(rim.begin(), rim.end(), Edge{vertex, std::numeric_limits<std::int32_t>::min()}) - rim.begin());
        while (i < rim.size() && rim[i].first == vertex && used[i]) ++i;
        return i < rim.size() && rim[i].first == vertex ? i : rim.size();
    };
    RimLoops loops;
    for (std::size_t first = 0; first < rim.size(); ++first) {
        if (used[first]) continue;
        std::vector<std::int32_t>& loop = loops.emplace_back();
        for (std::size_t i = first; i < rim.size(); i = nextFrom(rim[i].second)) {
            used[i] = 1;
            loop.push_back(rim[i].first);
        }
    }
    return loops;
}

std::shared_ptr<const std::vector<RimLoops>> rimsOf(const std::shared_ptr<const Element>& element) {
    static KeptWith<Element, std::vector<RimLoops>> all;
    return all.of(element, [&] {
        std::vector<RimLoops> rims;
        for (const JointFace& face : element->faces) rims.push_back(rimLoops(element->mesh->body.triangles, face.triangles));
        return rims;
    });
}

}  // namespace imomushi
