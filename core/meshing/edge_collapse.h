// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/progress.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// A closed surface whose triangles belong to joint faces or to none.
struct LabelledSurface {
    std::vector<Vec3> points;
    std::vector<std::array<std::int32_t, 3>> corners;
    std::vector<std::int32_t> label;  ///< joint face of each triangle, -1: free
    std::vector<std::int32_t> place;  ///< body vertex at exactly the place of each vertex, -1: none
};

/// Collapses the edges of a surface, the least costly first (see decimate()). Call connect(), run(), result() in this order.
class EdgeCollapse {
public:
    /// `surface`: of size about 1. `limit`: per vertex, the longest edge that it may get. `uniform`: the edge of a uniform mesh of the wanted number of
    /// vertices. `tolerance`: per joint face, how far its rim may leave a straight line. `size`: per vertex, the wanted edge where it is less than `uniform`;
    /// empty: nowhere.
    EdgeCollapse(const LabelledSurface& surface, std::vector<double> limit, double uniform, std::vector<double> tolerance, std::vector<double> size = {});
    ~EdgeCollapse();
    EdgeCollapse(const EdgeCollapse&) = delete;
    EdgeCollapse& operator=(const EdgeCollapse&) = delete;

    /// Finds the neighbours. False: cancelled, or an edge has not exactly two triangles of opposite winding, or a vertex more than one fan of triangles.
    bool connect(const Progress& progress);
    /// Collapses until `vertices` are left or nothing more can be collapsed. False: cancelled.
    bool run(int vertices, const Progress& progress);
    /// What is left. `number`: for each vertex of the input the one that stands for it.
    LabelledSurface result(std::vector<std::int32_t>& number) const;

private:
    class State;
    std::unique_ptr<State> state_;
};

}  // namespace imomushi
