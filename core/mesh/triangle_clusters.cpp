// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/triangle_clusters.h"

#include <limits>
#include <utility>

namespace imomushi {
namespace {

/// Boxes are larger than their triangles by this, relative to their distance from the origin of the ray: more than a test of a triangle can be off by.
constexpr double kPadding = 1e-9;
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

TriangleClusters::TriangleClusters(const TriangleMesh& mesh) {
    const Eigen::Index count = mesh.triangles.rows();
    firstVertex_.push_back(0);
    if (count == 0) return;
    const Vec3 low = mesh.vertices.colwise().minCoeff().transpose();
    const double size = (mesh.vertices.colwise().maxCoeff().transpose() - low).maxCoeff();
    const double scale = size > 0.0 ? ((1 << kBits) - 1) / size : 0.0;
    std::vector<std::pair<std::uint64_t, std::int32_t>> order;
    for (std::int32_t t = 0; t < count; ++t) {
        const auto corner = [&](int c) -> Vec3 { return mesh.vertices.row(mesh.triangles(t, c)).transpose(); };
        const Vec3 at = scale * ((corner(0) + corner(1) + corner(2)) / 3.0 - low);
        std::uint64_t code = 0;
        for (int axis = 0; axis < 3; ++axis) code |= spread(static_cast<std::uint64_t>(std::max(at[axis], 0.0))) << axis;
        order.emplace_back(code, t);
    }
    std::sort(order.begin(), order.end());
    for (const auto& [code, t] : order) triangles_.push_back(t);
    std::vector<std::int32_t> vertices;
    for (std::size_t begin = 0; begin < triangles_.size(); begin += kTriangles) {
        vertices.clear();
        for (std::size_t i = begin; i < std::min(begin + kTriangles, triangles_.size()); ++i)
            for (int c = 0; c < 3; ++c) vertices.push_back(mesh.triangles(triangles_[i], c));
        std::sort(vertices.begin(), vertices.end());
        vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
        vertices_.insert(vertices_.end(), vertices.begin(), vertices.end());
        firstVertex_.push_back(vertices_.size());
    }
}

bool TriangleClusters::meets(const Vec3& origin, const Vec3& direction, const Vec3& low, const Vec3& high) {
    const double padding = kPadding * std::max((low - origin).cwiseAbs().maxCoeff(), (high - origin).cwiseAbs().maxCoeff());
    double from = 0.0, to = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const double a = low[axis] - padding - origin[axis], b = high[axis] + padding - origin[axis];
        if (direction[axis] == 0.0) {
            if (a > 0.0 || b < 0.0) return false;
            continue;
        }
        const double enters = (direction[axis] > 0.0 ? a : b) / direction[axis], leaves = (direction[axis] > 0.0 ? b : a) / direction[axis];
        from = std::max(from, enters);
        to = std::min(to, leaves);
    }
    return from <= to;
}

}  // namespace imomushi
