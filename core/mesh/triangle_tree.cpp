// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/triangle_tree.h"

#include <Eigen/Geometry>
#include <cassert>
#include <numeric>

#include "core/mesh/closest_point.h"

namespace imomushi {
namespace {

constexpr std::int32_t kLeaf = 4;   ///< triangles that are tested without a box of their own

Vec3 barycentric(const ClosestOnTriangle& closest) {
    if (!closest.inside) return closest.weights;
    const double sum = closest.weights[0] + closest.weights[1] + closest.weights[2];
    if (!(sum > 0.0)) return {1.0, 0.0, 0.0};
    const double v = closest.weights[1] / sum, w = closest.weights[2] / sum;
    return {1.0 - v - w, v, w};
}

std::vector<std::int32_t> allOf(const TriangleMesh& mesh) {
    std::vector<std::int32_t> all(static_cast<std::size_t>(mesh.triangles.rows()));
    std::iota(all.begin(), all.end(), 0);
    return all;
}

}  // namespace

TriangleTree::TriangleTree(const TriangleMesh& mesh) : TriangleTree(mesh, allOf(mesh)) {}

TriangleTree::TriangleTree(const TriangleMesh& mesh, std::vector<std::int32_t> which) : order_(std::move(which)) {
    assert(!order_.empty());
    corners_.reserve(order_.size());
    for (const std::int32_t t : order_)
        corners_.push_back({mesh.vertices.row(mesh.triangles(t, 0)), mesh.vertices.row(mesh.triangles(t, 1)), mesh.vertices.row(mesh.triangles(t, 2))});
    nodes_.reserve(order_.size());

    // Halves are chosen over places in corners_; both arrays are put in the order of the leaves afterwards.
    std::vector<std::int32_t> triangle = std::move(order_);
    order_.resize(triangle.size());
    std::iota(order_.begin(), order_.end(), 0);
    grow(0, static_cast<std::int32_t>(order_.size()));
    std::vector<Corners> sorted;
    sorted.reserve(corners_.size());
    for (std::int32_t& place : order_) {
        sorted.push_back(corners_[static_cast<std::size_t>(place)]);
        place = triangle[static_cast<std::size_t>(place)];
    }
    corners_ = std::move(sorted);
}

std::int32_t TriangleTree::grow(std::int32_t begin, std::int32_t end) {
    const auto at = static_cast<std::int32_t>(nodes_.size());
    Node node;
    node.begin = begin, node.end = end;
    node.low = Vec3::Constant(std::numeric_limits<double>::max());
    node.high = -node.low;
    Vec3 lowMiddle = node.low, highMiddle = node.high;
    const auto middle = [&](std::int32_t place) -> Vec3 {
        const Corners& k = corners_[static_cast<std::size_t>(place)];
        return k.a + k.b + k.c;
    };
    for (std::int32_t i = begin; i < end; ++i) {
        const std::int32_t place = order_[static_cast<std::size_t>(i)];
        const Corners& k = corners_[static_cast<std::size_t>(place)];
        node.low = node.low.cwiseMin(k.a).cwiseMin(k.b).cwiseMin(k.c);
        node.high = node.high.cwiseMax(k.a).cwiseMax(k.b).cwiseMax(k.c);
        lowMiddle = lowMiddle.cwiseMin(middle(place));
        highMiddle = highMiddle.cwiseMax(middle(place));
    }
    nodes_.push_back(node);
    if (end - begin <= kLeaf) return at;
    int axis = 0;
    (highMiddle - lowMiddle).maxCoeff(&axis);
    const std::int32_t half = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end, [&](std::int32_t x, std::int32_t y) {
        const double p = middle(x)[axis], q = middle(y)[axis];
        return p < q || (p == q && x < y);
    });
    grow(begin, half);
    const std::int32_t right = grow(half, end);
    nodes_[static_cast<std::size_t>(at)].right = right;
    return at;
}

template <bool kFacing>
TriangleTree::Hit TriangleTree::search(const Vec3& point, const Vec3& direction) const {
    Hit best;
    const auto distance = [&](std::int32_t n) {
        const Node& node = nodes_[static_cast<std::size_t>(n)];
        return (node.low - point).cwiseMax(point - node.high).cwiseMax(0.0).squaredNorm();
    };
    struct Open {
        std::int32_t node;
        double squaredDistance;
    };
    std::array<Open, kDeepest> open;
    std::size_t count = 0;
    open[count++] = {0, distance(0)};
    while (count > 0) {
        const Open next = open[--count];
        if (next.squaredDistance > best.squaredDistance) continue;
        const Node& node = nodes_[static_cast<std::size_t>(next.node)];
        if (node.right >= 0) {
            Open near{next.node + 1, distance(next.node + 1)}, far{node.right, distance(node.right)};
            if (far.squaredDistance < near.squaredDistance) std::swap(near, far);
            open[count++] = far;
            open[count++] = near;
            continue;
        }
        for (std::int32_t i = node.begin; i < node.end; ++i) {
            const Corners& k = corners_[static_cast<std::size_t>(i)];
            if (kFacing && (k.b - k.a).cross(k.c - k.a).dot(direction) <= 0.0) continue;
            const Vec3 a = k.a - point, b = k.b - point, c = k.c - point;
            const Vec3 weight = barycentric(closestOnTriangle(b - a, c - a, -a, -b, -c));
            const double d = (weight[0] * a + weight[1] * b + weight[2] * c).squaredNorm();
            const std::int32_t t = order_[static_cast<std::size_t>(i)];
            if (d < best.squaredDistance || (d == best.squaredDistance && t < best.triangle)) best = {t, d, weight};
        }
    }
    return best;
}

std::vector<std::int32_t> TriangleTree::within(const Vec3& point, double distance) const {
    std::vector<std::int32_t> out, open{0};
    while (!open.empty()) {
        const std::int32_t n = open.back();
        const Node& node = nodes_[static_cast<std::size_t>(n)];
        open.pop_back();
        if ((node.low - point).cwiseMax(point - node.high).cwiseMax(0.0).norm() > distance) continue;
        if (node.right >= 0)
            open.insert(open.end(), {node.right, n + 1});
        else
            out.insert(out.end(), order_.begin() + node.begin, order_.begin() + node.end);
    }
    std::sort(out.begin(), out.end());
    return out;
}

template TriangleTree::Hit TriangleTree::search<false>(const Vec3&, const Vec3&) const;
template TriangleTree::Hit TriangleTree::search<true>(const Vec3&, const Vec3&) const;

}  // namespace imomushi
