// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace imomushi {

/// Vertices whose coordinates were rounded to a grid of their own.
struct VertexGrid {
    std::size_t first = 0, count = 0;
    double step = 0.0;  ///< between neighbours of the grid, in the unit of the vertices; 0: they were not rounded
};

/// Normalised whole numbers are often rounded to fewer bits than they are stored in, the others repeating the highest ones. How many, is seen from all numbers of a kind together.
class StoredBits {
public:
    /// `largest`: what stands for 1, one less than a power of two.
    explicit StoredBits(std::uint32_t largest);
    /// A number in [-1, 1].
    void see(double x);
    /// Between neighbours, of numbers in [-1, 1].
    [[nodiscard]] double step() const;

private:
    int stored_;   // bits without the sign
    int spare_;    // of them, which repeat others in all numbers so far
};

/// What two meshes have at one place comes out at two once each is rounded to its grid. Makes such places one again: a place of a coarser grid goes to the nearest of a finer one
/// that rounding alone can have parted from it. Each place of a grid has at most one partner, vertices at one place of one grid stay together, and none moves farther than rounding could.
/// `points`: three numbers a vertex; what is not finite stays.
void joinGrids(std::vector<double>& points, std::vector<VertexGrid> grids);

}  // namespace imomushi
