// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/io/vertex_grids.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>

#include "core/base/finite.h"
#include "core/mesh/weld.h"

namespace imomushi {

namespace {

/// In steps: half of one along each axis, and what single precision adds.
constexpr double kRounded = 0.88;
/// Nobody rounds places to fewer: what looks like it are a few places.
constexpr int kFewestBits = 7;
/// Places of a cell that are searched. A grid that has more in a step of another one's shows nothing that the other could tell apart.
constexpr std::size_t kMostInCell = 64;

struct Place {
    Vec3 at;
    double step;  ///< of its grid
};

}  // namespace

StoredBits::StoredBits(std::uint32_t largest) : stored_(std::bit_width(largest)), spare_(stored_ - kFewestBits) {}

void StoredBits::see(double x) {
    const double largest = std::ldexp(1.0, stored_) - 1.0;
    if (!isFinite(x) || std::abs(x) > 1.0) return;
    const auto value = static_cast<std::uint32_t>(std::lround(std::abs(x) * largest));
    const auto repeats = [&](int spare) {
        const std::uint32_t rounded = value >> static_cast<unsigned>(spare);
        const int back = stored_ - 2 * spare;  // to the lowest bits
        return value == (rounded << static_cast<unsigned>(spare) | (back >= 0 ? rounded >> static_cast<unsigned>(back) : rounded << static_cast<unsigned>(-back)));
    };
    while (spare_ > 0 && !repeats(spare_)) --spare_;
}

double StoredBits::step() const { return 1.0 / (std::ldexp(1.0, stored_ - spare_) - 1.0); }

void joinGrids(std::vector<double>& points, std::vector<VertexGrid> grids) {
    if (grids.size() < 2) return;
    std::stable_sort(grids.begin(), grids.end(), [](const VertexGrid& a, const VertexGrid& b) { return a.step < b.step; });
    if (!(grids.back().step > 0.0)) return;
    const auto point = [&](std::size_t v) { return Eigen::Map<Vec3>(points.data() + 3 * v); };

    std::vector<Place> places;  // of the grids so far
    std::map<std::array<std::int64_t, 3>, std::vector<std::size_t>> cells;
    double cell = 0.0;
    const auto cellOf = [&](const Vec3& p) { return std::array{static_cast<std::int64_t>(std::floor(p[0] / cell)), static_cast<std::int64_t>(std::floor(p[1] / cell)), static_cast<std::int64_t>(std::floor(p[2] / cell))}; };
    const auto insert = [&](std::size_t place) {
        if (auto& in = cells[cellOf(places[place].at)]; in.size() < kMostInCell) in.push_back(place);
    };
    for (const VertexGrid& grid : grids) {
        // Cells as large as the largest reach: of grids that are twice as coarse, new ones.
        if (const double reach = 2.0 * kRounded * grid.step; reach > cell) {
            cell = 2.0 * reach;
            cells.clear();
            for (std::size_t p = 0; p < places.size(); ++p) insert(p);
        }
        Points own(static_cast<Eigen::Index>(grid.count), 3);
        std::vector<char> finite(grid.count, 0);
        for (std::size_t i = 0; i < grid.count; ++i) {
            own.row(static_cast<Eigen::Index>(i)) = point(grid.first + i).transpose();
            // Beyond that the number of a cell is none any more.
            finite[i] = allFinite(point(grid.first + i)) && (cell == 0.0 || point(grid.first + i).cwiseAbs().maxCoeff() / cell < 1e15);
        }
        const std::vector<std::int32_t> standsFor = weldExact(own, finite, {});
        struct Pair {
            double distance;
            std::size_t vertex, place;
        };
        std::vector<Pair> pairs;
        for (std::size_t i = 0; cell > 0.0 && i < grid.count; ++i) {
            if (!finite[i] || static_cast<std::size_t>(standsFor[i]) != i) continue;
            const Vec3 p = point(grid.first + i);
            const auto middle = cellOf(p);
            for (int k = 0; k < 27; ++k) {
                const auto found = cells.find({middle[0] + k % 3 - 1, middle[1] + k / 3 % 3 - 1, middle[2] + k / 9 - 1});
                if (found == cells.end()) continue;
                for (const std::size_t place : found->second)
                    if (const double distance = (places[place].at - p).norm(); distance <= kRounded * (grid.step + places[place].step)) pairs.push_back({distance, i, place});
            }
        }
        std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
        std::vector<char> placed(grid.count, 0), taken(places.size(), 0);
        for (const Pair& pair : pairs) {
            if (placed[pair.vertex] || taken[pair.place]) continue;
            placed[pair.vertex] = taken[pair.place] = 1;
            point(grid.first + pair.vertex) = places[pair.place].at;
        }
        for (std::size_t i = 0; i < grid.count; ++i) {
            if (!finite[i]) continue;
            if (const auto first = static_cast<std::size_t>(standsFor[i]); first != i) {
                point(grid.first + i) = point(grid.first + first);
            } else if (!placed[i]) {
                places.push_back({point(grid.first + i), grid.step});
                if (cell > 0.0) insert(places.size() - 1);
            }
        }
    }
}

}  // namespace imomushi
