// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "core/mesh/mesh.h"
#include "tests/support/shapes.h"

/// Bodies of cubes: any topology, and feet and forks with sharp edges.
namespace imomushi::shapes {

using Voxels = std::set<std::array<int, 3>>;

inline Voxels block(const std::array<int, 3>& low, const std::array<int, 3>& high) {
    Voxels out;
    for (int i = low[0]; i < high[0]; ++i)
        for (int j = low[1]; j < high[1]; ++j)
            for (int k = low[2]; k < high[2]; ++k) out.insert({i, j, k});
    return out;
}

inline Voxels operator+(Voxels a, const Voxels& b) {
    a.insert(b.begin(), b.end());
    return a;
}

/// The surface of cubes of this side, two triangles per square. Cubes that meet in an edge or a corner only are no body.
inline TriangleMesh surfaceOf(const Voxels& voxels, double side) {
    std::map<std::array<int, 3>, int> index;
    std::vector<Vec3> points;
    std::vector<std::array<int, 3>> corners;
    for (const auto& cube : voxels)
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (const int step : {0, 1}) {
                auto beyond = cube;
                beyond[axis] += 2 * step - 1;
                if (voxels.contains(beyond)) continue;
                std::array<int, 4> q{};
                for (std::size_t k = 0; k < 4; ++k) {
                    auto p = cube;
                    p[axis] += step;
                    p[(axis + 1) % 3] += k == 1 || k == 2 ? 1 : 0;
                    p[(axis + 2) % 3] += k >= 2 ? 1 : 0;
                    const auto [it, fresh] = index.try_emplace(p, static_cast<int>(points.size()));
                    if (fresh) points.emplace_back(side * p[0], side * p[1], side * p[2]);
                    q[k] = it->second;
                }
                if (step == 0) std::swap(q[1], q[3]);
                if ((cube[0] + cube[1] + cube[2] + step) % 2 != 0) {
                    corners.push_back({q[0], q[1], q[2]});
                    corners.push_back({q[0], q[2], q[3]});
                } else {
                    corners.push_back({q[0], q[1], q[3]});
                    corners.push_back({q[1], q[2], q[3]});
                }
            }
    return detail::meshOf(points, corners);
}

}  // namespace imomushi::shapes
