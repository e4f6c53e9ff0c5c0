// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/triangle_clusters.h"

#include <limits>

#include "core/mesh/triangle_order.h"

namespace imomushi {
namespace {

/// Boxes are larger than their triangles by this, relative to their distance from the origin of the ray: more than a test of a triangle can be off by.
constexpr double kPadding = 1e-9;

}  // namespace

TriangleClusters::TriangleClusters(const TriangleMesh& mesh) {
    triangles_ = trianglesByPlace(mesh);
    firstVertex_.push_back(0);
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
