// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/scene/rim.h"

#include <map>
#include <set>
#include <utility>

namespace imomushi {

std::vector<std::vector<std::int32_t>> rimLoops(const Triangles& triangles, std::span<const std::int32_t> patch) {
    // An edge of the rim has the patch on one side only: its opposite direction does not occur.
    std::set<std::pair<std::int32_t, std::int32_t>> edges;
    for (const std::int32_t t : patch)
        for (int c = 0; c < 3; ++c) edges.emplace(triangles(t, c), triangles(t, (c + 1) % 3));
    std::multimap<std::int32_t, std::int32_t> next;
    for (const auto& [from, to] : edges)
        if (!edges.contains({to, from})) next.emplace(from, to);
    std::vector<std::vector<std::int32_t>> loops;
    while (!next.empty()) {
        std::vector<std::int32_t> loop;
        for (auto edge = next.begin(); edge != next.end();) {
            loop.push_back(edge->first);
            const std::int32_t to = edge->second;
            next.erase(edge);
            edge = next.find(to);
        }
        loops.push_back(std::move(loop));
    }
    return loops;
}

}  // namespace imomushi
