// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/weld.h"

#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <unordered_map>

namespace imomushi {
namespace {

std::uint64_t mix(std::uint64_t x) {  // the finaliser of MurmurHash3
    x ^= x >> 33;
    x *= 0xff51afd7ed558ccdULL;
    x ^= x >> 33;
    x *= 0xc4ceb9fe1a85ec53ULL;
    return x ^ (x >> 33);
}

}  // namespace

std::vector<std::int32_t> weldExact(const Points& points, const std::vector<char>& candidate, const std::vector<std::int32_t>& group) {
    const auto n = static_cast<std::size_t>(points.rows());
    std::vector<std::int32_t> standsFor(n);
    std::iota(standsFor.begin(), standsFor.end(), 0);
    const std::size_t size = std::bit_ceil(2 * n + 1);
    std::vector<std::int32_t> table(size, -1);  // open addressing
    for (std::size_t v = 0; v < n; ++v) {
        if (!candidate[v]) continue;
        std::uint64_t key = group.empty() ? 0 : static_cast<std::uint64_t>(group[v]) + 1;
        for (int k = 0; k < 3; ++k) key = mix(key ^ std::bit_cast<std::uint64_t>(points(static_cast<Eigen::Index>(v), k) + 0.0));
        for (std::size_t slot = key & (size - 1);; slot = (slot + 1) & (size - 1)) {
            const std::int32_t other = table[slot];
            if (other < 0) {
                table[slot] = static_cast<std::int32_t>(v);
                break;
            }
            if (points.row(other) == points.row(static_cast<Eigen::Index>(v)) &&
                (group.empty() || group[static_cast<std::size_t>(other)] == group[v])) {
                standsFor[v] = other;
                break;
            }
        }
    }
    return standsFor;
}

std::vector<std::int32_t> samePlaces(const Points& points, const Points& others) {
    Points both(others.rows() + points.rows(), 3);
    both << others, points;
    const std::vector<std::int32_t> standsFor = weldExact(both, std::vector<char>(static_cast<std::size_t>(both.rows()), 1), {});
    std::vector<std::int32_t> same(standsFor.begin() + others.rows(), standsFor.end());
    for (std::int32_t& s : same)
        if (s >= others.rows()) s = -1;
    return same;
}

std::vector<std::int32_t> weldNear(const Points& points, const std::vector<char>& candidate, double tolerance) {
    const auto n = static_cast<std::size_t>(points.rows());
    std::vector<std::int32_t> standsFor(n);
    std::iota(standsFor.begin(), standsFor.end(), 0);
    if (!(tolerance > 0.0) || n == 0) return standsFor;
    const Vec3 low = points.colwise().minCoeff();
    const auto cell = [&](const Vec3& p, int dx, int dy, int dz) {
        const std::array<int, 3> shift{dx, dy, dz};
        std::uint64_t key = 0;
        for (int k = 0; k < 3; ++k) {
            // At most 2^53 cells per axis by the callers' tolerances, which are relative to the size.
            const auto i = static_cast<std::int64_t>(std::floor((p[k] - low[k]) / (2 * tolerance))) + shift[static_cast<std::size_t>(k)];
            key = mix(key ^ static_cast<std::uint64_t>(i));
        }
        return key;
    };
    std::unordered_map<std::uint64_t, std::vector<std::int32_t>> grid;
    for (std::size_t v = 0; v < n; ++v) {
        if (!candidate[v]) continue;
        const Vec3 p = points.row(static_cast<Eigen::Index>(v));
        std::int32_t best = -1;
        for (int dx = -1; dx <= 1; ++dx)
            for (int dy = -1; dy <= 1; ++dy)
                for (int dz = -1; dz <= 1; ++dz) {
                    const auto found = grid.find(cell(p, dx, dy, dz));
                    if (found == grid.end()) continue;
                    for (const std::int32_t other : found->second)
                        if ((best < 0 || other < best) && (points.row(other).transpose() - p).norm() <= tolerance) best = other;
                }
        if (best >= 0)
            standsFor[v] = best;
        else
            grid[cell(p, 0, 0, 0)].push_back(static_cast<std::int32_t>(v));
    }
    return standsFor;
}

}  // namespace imomushi
