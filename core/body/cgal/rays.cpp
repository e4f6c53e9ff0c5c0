// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/cgal/rays.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <numeric>

#include "core/base/floating_point_guard.h"

namespace imomushi {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Triangle = Kernel::Triangle_3;
using Place = std::vector<Triangle>::const_iterator;
using Boxes = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_triangle_primitive<Kernel, Place>>>;

Point point(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

std::vector<std::int32_t> allOf(const TriangleMesh& mesh) {
    std::vector<std::int32_t> all(static_cast<std::size_t>(mesh.triangles.rows()));
    std::iota(all.begin(), all.end(), 0);
    return all;
}

}  // namespace

struct RayTree::Tree {
    std::vector<Triangle> triangles;
    std::vector<std::int32_t> number;
    Boxes boxes;
};

RayTree::RayTree(const TriangleMesh& mesh) : RayTree(mesh, allOf(mesh)) {}

RayTree::RayTree(const TriangleMesh& mesh, const std::vector<std::int32_t>& which) : tree_(std::make_unique<Tree>()) {
    const FloatingPointGuard guard;
    for (const std::int32_t f : which) {
        const Triangle t(point(mesh.vertices.row(mesh.triangles(f, 0))), point(mesh.vertices.row(mesh.triangles(f, 1))),
                         point(mesh.vertices.row(mesh.triangles(f, 2))));
        if (t.is_degenerate()) continue;
        tree_->triangles.push_back(t);
        tree_->number.push_back(f);
    }
    tree_->boxes.insert(tree_->triangles.cbegin(), tree_->triangles.cend());
    if (!tree_->triangles.empty()) tree_->boxes.build();
}

RayTree::~RayTree() = default;

RayTree::Hit RayTree::first(const Vec3& from, const Vec3& direction, double reach, std::int32_t except) const {
    if (tree_->triangles.empty()) return {};
    const FloatingPointGuard guard;
    // Among all crossings of a short segment: a segment has no first_intersection() in CGAL, and a ray would look through the whole body.
    std::vector<Boxes::Primitive_id> met;
    tree_->boxes.all_intersected_primitives(Kernel::Segment_3(point(from), point(from + reach * direction)), std::back_inserter(met));
    Hit hit;
    for (const auto& id : met) {
        const std::int32_t f = tree_->number[static_cast<std::size_t>(id - tree_->triangles.cbegin())];
        if (f == except) continue;
        const Triangle& t = *id;
        const Kernel::Vector_3 n = CGAL::normal(t[0], t[1], t[2]);
        const double along = n.x() * direction.x() + n.y() * direction.y() + n.z() * direction.z();
        const Kernel::Vector_3 to = t[0] - point(from);
        const double distance = along != 0.0 ? (n * to) / along : std::sqrt(CGAL::squared_distance(point(from), t));
        if (distance < hit.distance || (distance == hit.distance && f < hit.triangle)) hit = {f, distance};
    }
    hit.distance = std::max(hit.distance, 0.0);
    return hit;
}

bool RayTree::inside(const Vec3& at) const {
    if (tree_->triangles.empty()) return false;
    const FloatingPointGuard guard;
    const auto odd = [&](double x, double y, double z) {  // directions that no modelled edge has
        return tree_->boxes.number_of_intersected_primitives(Kernel::Ray_3(point(at), Kernel::Vector_3(x, y, z))) % 2 == 1;
    };
    const bool one = odd(0.4142135, 0.7320508, 0.2360679), two = odd(-0.6457513, 0.3166247, -0.6055512);
    return one == two ? one : odd(0.1231056, -0.3588989, 0.7958315);
}

}  // namespace imomushi
