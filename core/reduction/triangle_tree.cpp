// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reduction/triangle_tree.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>

namespace imomushi {
namespace {

constexpr std::int32_t kLeaf = 4;   ///< triangles that are tested without a box of their own
constexpr std::size_t kDeepest = 64;  ///< halving 2^31 triangles cannot go deeper

double ratio(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

/// The nearest point of triangle a b c to the origin (Ericson, Real-Time Collision Detection, section 5.1.5), for triangles without area too.
Vec3 nearestToOrigin(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a;
    const double d1 = -ab.dot(a), d2 = -ac.dot(a);
    if (d1 <= 0.0 && d2 <= 0.0) return {1.0, 0.0, 0.0};
    const double d3 = -ab.dot(b), d4 = -ac.dot(b);
    if (d3 >= 0.0 && d4 <= d3) return {0.0, 1.0, 0.0};
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
        const double v = ratio(d1, d1 - d3);
        return {1.0 - v, v, 0.0};
    }
    const double d5 = -ab.dot(c), d6 = -ac.dot(c);
    if (d6 >= 0.0 && d5 <= d6) return {0.0, 0.0, 1.0};
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
        const double w = ratio(d2, d2 - d6);
        return {1.0 - w, 0.0, w};
    }
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
        const double w = ratio(d4 - d3, (d4 - d3) + (d5 - d6));
        return {0.0, 1.0 - w, w};
    }
    const double v = ratio(vb, va + vb + vc), w = ratio(vc, va + vb + vc);
    return {1.0 - v - w, v, w};
}

}  // namespace

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
            const Vec3 weight = nearestToOrigin(a, b, c);
            const double d = (weight[0] * a + weight[1] * b + weight[2] * c).squaredNorm();
            const std::int32_t t = order_[static_cast<std::size_t>(i)];
            if (d < best.squaredDistance || (d == best.squaredDistance && t < best.triangle)) best = {t, d, weight};
        }
    }
    return best;
}

template TriangleTree::Hit TriangleTree::search<false>(const Vec3&, const Vec3&) const;
template TriangleTree::Hit TriangleTree::search<true>(const Vec3&, const Vec3&) const;

}  // namespace imomushi
