// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// The connected, closed surfaces of a mesh and how they lie in each other.
struct Shells {
    struct Shell {
        std::vector<std::int32_t> triangles;  ///< ascending
        double volume = 0.0;  ///< signed, m^3
        int parent = -1;      ///< the innermost shell around this one, -1: none
        int depth = 0;        ///< how many shells are around it: odd depths are cavities and wind inward
        [[nodiscard]] bool cavity() const { return depth % 2 == 1; }
        [[nodiscard]] bool inverted() const { return (volume < 0.0) != cavity(); }
    };
    std::vector<Shell> shells;  ///< in the order of their first triangles
};

/// `component` per triangle (-1: left out), `count` of them, each closed and consistently wound. A shell lies in another when its box and a
/// sample of its vertices do; shells that cross each other are side by side.
Shells findShells(const TriangleMesh& mesh, const std::vector<std::int32_t>& component, int count);

}  // namespace imomushi
