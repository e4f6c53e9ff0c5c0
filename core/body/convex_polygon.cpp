// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/convex_polygon.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace imomushi {
namespace {

double smallestAngle(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double twice = (b - a).cross(c - a).norm();
    return std::min({std::atan2(twice, (b - a).dot(c - a)), std::atan2(twice, (c - b).dot(a - b)), std::atan2(twice, (a - c).dot(b - c))});
}

}  // namespace

std::vector<std::array<std::int32_t, 3>> triangulateConvex(const std::vector<Vec3>& polygon) {
    const std::size_t n = polygon.size();
    std::vector<std::array<std::int32_t, 3>> result;
    if (n == 3) return {{0, 1, 2}};
    // Of the points i...j: the smallest angle of their best triangles, and the apex over the diagonal i j.
    std::vector<double> best(n * n, HUGE_VAL);
    std::vector<std::size_t> apex(n * n, 0);
    for (std::size_t length = 2; length < n; ++length)
        for (std::size_t i = 0; i + length < n; ++i) {
            const std::size_t j = i + length;
            best[i * n + j] = -1.0;
            for (std::size_t k = i + 1; k < j; ++k) {
                const double beside = std::min(best[i * n + k], best[k * n + j]);
                if (!(beside > best[i * n + j])) continue;  // cannot be better, whatever the triangle's angles: computing those of all took minutes for hundreds of points
                const double angle = std::min(beside, smallestAngle(polygon[i], polygon[k], polygon[j]));
                if (angle > best[i * n + j]) best[i * n + j] = angle, apex[i * n + j] = k;
            }
        }
    std::vector<std::array<std::size_t, 2>> open{{0, n - 1}};
    while (!open.empty()) {
        const auto [i, j] = open.back();
        open.pop_back();
        if (j < i + 2) continue;
        const std::size_t k = apex[i * n + j];
        result.push_back({static_cast<std::int32_t>(i), static_cast<std::int32_t>(k), static_cast<std::int32_t>(j)});
        open.push_back({k, j});
        open.push_back({i, k});
    }
    return result;
}

}  // namespace imomushi
