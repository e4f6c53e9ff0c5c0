// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/winding_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>

#include "core/mesh/topology.h"
#include "core/mesh/winding_number.h"

namespace imomushi {
namespace {

constexpr std::int32_t kTriangles = 2;  ///< of a leaf
constexpr double kFar = 1.6;            ///< radii of a node around its middle, from which on it counts as one area vector
constexpr std::size_t kDeepest = 64;    ///< halving 2^31 triangles cannot go deeper

}  // namespace

WindingTree::WindingTree(const TriangleMesh& mesh) : mesh_(mesh) {
    if (mesh.triangles.rows() > 0) grow(0, static_cast<std::int32_t>(mesh.triangles.rows()));
}

std::int32_t WindingTree::grow(std::int32_t begin, std::int32_t end) {
    const auto self = static_cast<std::int32_t>(nodes_.size());
    const auto middleOf = [&](std::int32_t f) -> Vec3 {
        return (mesh_.vertices.row(mesh_.triangles(f, 0)) + mesh_.vertices.row(mesh_.triangles(f, 1)) + mesh_.vertices.row(mesh_.triangles(f, 2))).transpose() / 3.0;
    };
    Node node;
    node.begin = begin, node.end = end;
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
    double area = 0.0;
    for (std::int32_t f = begin; f < end; ++f) {
        const Vec3 vector = 0.5 * areaVector(mesh_, f), middle = middleOf(f);
        node.area += vector;
        node.middle += vector.norm() * middle;
        area += vector.norm();
        low = low.cwiseMin(middle);
        high = high.cwiseMax(middle);
    }
    node.middle = area > 0.0 ? Vec3(node.middle / area) : low;
    for (std::int32_t f = begin; f < end; ++f)
        for (int k = 0; k < 3; ++k) node.far = std::max(node.far, kFar * kFar * (mesh_.vertices.row(mesh_.triangles(f, k)).transpose() - node.middle).squaredNorm());
    nodes_.push_back(node);
    if (end - begin <= kTriangles) return self;
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const std::int32_t half = begin + (end - begin) / 2;
    std::vector<std::int32_t> order(static_cast<std::size_t>(end - begin));
    std::iota(order.begin(), order.end(), begin);
    std::nth_element(order.begin(), order.begin() + (half - begin), order.end(), [&](std::int32_t f, std::int32_t g) {
        const double a = middleOf(f)[axis], b = middleOf(g)[axis];
        return a < b || (a == b && f < g);
    });
    const Triangles sorted = mesh_.triangles(order, Eigen::all);
    mesh_.triangles.middleRows(begin, end - begin) = sorted;
    grow(begin, half);
    const std::int32_t right = grow(half, end);
    nodes_[static_cast<std::size_t>(self)].right = right;
    return self;
}

double WindingTree::at(const Vec3& point) const {
    double sum = 0.0;
    if (nodes_.empty()) return sum;
    std::array<std::int32_t, kDeepest> open{};
    std::array<std::int32_t, kTriangles> near{};
    std::size_t count = 0;
    open[count++] = 0;
    while (count > 0) {
        const std::int32_t n = open[--count];
        const Node& node = nodes_[static_cast<std::size_t>(n)];
        const Vec3 to = node.middle - point;
        const double squared = to.squaredNorm();
        if (squared > node.far) {
            sum += node.area.dot(to) / (4.0 * std::numbers::pi * squared * std::sqrt(squared));
        } else if (node.right >= 0) {
            open[count++] = node.right;
            open[count++] = n + 1;
        } else {
            std::iota(near.begin(), near.end(), node.begin);
            sum += windingNumber(mesh_, std::span(near).first(static_cast<std::size_t>(node.end - node.begin)), point);
        }
    }
    return sum;
}

}  // namespace imomushi
