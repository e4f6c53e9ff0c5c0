// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/triangle_order.h"

#include <algorithm>
#include <utility>

namespace imomushi {
namespace {

constexpr int kBits = 21;  // of each coordinate

/// Every third bit of the result.
std::uint64_t spread(std::uint64_t x) {
    x = (x | x << 32) & 0x001f00000000ffffULL;
    x = (x | x << 16) & 0x001f0000ff0000ffULL;
    x = (x | x << 8) & 0x100f00f00f00f00fULL;
    x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
    return (x | x << 2) & 0x1249249249249249ULL;
}

}  // namespace

std::vector<std::int32_t> trianglesByPlace(const TriangleMesh& mesh) {
    const Eigen::Index count = mesh.triangles.rows();
    if (count == 0) return {};
    const Vec3 low = mesh.vertices.colwise().minCoeff().transpose();
    const double size = (mesh.vertices.colwise().maxCoeff().transpose() - low).maxCoeff();
    const double scale = size > 0.0 ? ((1 << kBits) - 1) / size : 0.0;
    std::vector<std::pair<std::uint64_t, std::int32_t>> order;
    order.reserve(static_cast<std::size_t>(count));
    for (std::int32_t t = 0; t < count; ++t) {
        const auto corner = [&](int c) -> Vec3 { return mesh.vertices.row(mesh.triangles(t, c)).transpose(); };
        const Vec3 at = scale * ((corner(0) + corner(1) + corner(2)) / 3.0 - low);
        std::uint64_t code = 0;
        for (int axis = 0; axis < 3; ++axis) code |= spread(static_cast<std::uint64_t>(std::max(at[axis], 0.0))) << axis;
        order.emplace_back(code, t);
    }
    std::sort(order.begin(), order.end());
    std::vector<std::int32_t> triangles;
    triangles.reserve(order.size());
    for (const auto& [code, t] : order) triangles.push_back(t);
    return triangles;
}

}  // namespace imomushi
