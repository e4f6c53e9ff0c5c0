// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/touch/contact_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/mesh/connectivity.h"

namespace imomushi {
namespace {

/// Patches of one body are neighbours where their middles at rest are nearer than this many times their radii together.
constexpr double kApart = 2.5;

/// The cosine of normals that are opposed after a turn by kMostTurn and as much strain at most.
const double kOpposedTurned = std::cos(std::acos(ContactSurface::kOpposed) - 2.0 * ContactSurface::kMostTurn);

/// The distance of two samples, where it is less and they may be opposed.
void nearer(const ContactSurface& a, std::int32_t i, const ContactSurface& b, std::int32_t k, double& least) {
    const std::int32_t v = a.vertex(static_cast<std::size_t>(i)), w = b.vertex(static_cast<std::size_t>(k));
    const double distance = (a.surface().vertex(v) - b.surface().vertex(w)).norm();
    if (distance < least && a.surface().normal(v).dot(b.surface().normal(w)) < kOpposedTurned) least = distance;
}

}  // namespace

ContactSurface::ContactSurface(const ElementMesh& mesh, std::shared_ptr<const TouchSurface> surface) : surface_(std::move(surface)) {
    const TriangleMesh& body = mesh.body;
    const auto vertices = static_cast<std::size_t>(body.vertices.rows());
    corners_ = VertexCorners({body.triangles.data(), static_cast<std::size_t>(body.triangles.size())}, vertices, surface_->touchable());
    border_.resize(vertices);
    for (std::size_t v = 0; v < vertices; ++v)
        border_[v] = corners_.at(static_cast<std::int32_t>(v)).size() != mesh.connectivity().corners().at(static_cast<std::int32_t>(v)).size();

    const TouchPatches& p = patches();
    const auto count = static_cast<std::size_t>(p.count());
    std::vector<std::vector<std::int32_t>> members(count);
    radius_.assign(count, 0.0);
    spacing_.assign(count, 0.0);
    const auto at = [&](std::int32_t v) -> Vec3 { return body.vertices.row(v).transpose(); };
    for (std::size_t v = 0; v < vertices; ++v) {
        const auto begin = p.weight.begin() + p.first[v], end = p.weight.begin() + p.first[v + 1];
        if (begin == end) continue;
        const auto patch = static_cast<std::size_t>(p.patch[static_cast<std::size_t>(std::max_element(begin, end) - p.weight.begin())]);
        const auto vertex = static_cast<std::int32_t>(v);
        radius_[patch] = std::max(radius_[patch], (at(vertex) - at(p.centre[patch])).norm());
        if (surface_->row(vertex) >= 0 && !border_[v]) members[patch].push_back(vertex);
    }
    // The farthest of those that are left, from the first on.
    std::vector<double> nearest;
    for (std::size_t k = 0; k < count; ++k) {
        auto& all = members[k];
        first_.push_back(vertex_.size());
        nearest.assign(all.size(), std::numeric_limits<double>::infinity());
        std::size_t next = 0;
        for (std::size_t taken = 0; taken < std::min(all.size(), kPerPatch); ++taken) {
            const std::int32_t chosen = all[next];
            vertex_.push_back(chosen);
            for (std::size_t i = 0; i < all.size(); ++i) nearest[i] = std::min(nearest[i], (at(all[i]) - at(chosen)).norm());
            next = static_cast<std::size_t>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
        }
        // Where all are taken, neighbours are as far as the radius and their number say.
        if (!all.empty())
            spacing_[k] = std::max(nearest[next], 2.0 * radius_[k] / std::sqrt(static_cast<double>(all.size())));
    }
    first_.push_back(vertex_.size());
    for (const double s : spacing_) meanSpacing_ += s / static_cast<double>(count);
    std::vector<Bounds> places;
    for (const std::int32_t v : vertex_) places.push_back({at(v), at(v)});
    tree_ = BoxTree(places);
    ownClearance_ = std::numeric_limits<double>::infinity();
    bool can = false;
    for (int i = 0; i < patches().count(); ++i)
        for (int k = i + 1; !can && k < patches().count(); ++k) can = areApart(i, k);
    if (can) tree_.near(ownClearance_, [&](std::int32_t i, std::int32_t k) { nearer(*this, i, *this, k, ownClearance_); });
}

bool ContactSurface::areApart(int i, int k) const {
    const auto& centre = patches().centre;
    return (surface_->vertex(centre[static_cast<std::size_t>(i)]) - surface_->vertex(centre[static_cast<std::size_t>(k)])).norm() >=
           kApart * (radius(i) + radius(k));
}

double ContactSurface::clearance(const ContactSurface& a, const ContactSurface& b) {
    double least = std::numeric_limits<double>::infinity();
    if (a.tree_.empty() || b.tree_.empty()) return least;
    const double apart = std::sqrt(BoxTree::squaredDistance(a.tree_.bounds(), b.tree_.bounds()));
    if (apart > 0.5 * std::min(a.surface().size(), b.surface().size())) return apart;
    a.tree_.near(b.tree_, least, [&](std::int32_t i, std::int32_t k) { nearer(a, i, b, k, least); });
    return least;
}

BoxTree ContactSurface::patchTree(double reach) const {
    std::vector<Bounds> boxes;
    for (int p = 0; p < patches().count(); ++p) {
        const Vec3 middle = surface_->vertex(patches().centre[static_cast<std::size_t>(p)]), far = Vec3::Constant(reach * radius(p));
        boxes.push_back({middle - far, middle + far});
    }
    return BoxTree(boxes);
}

}  // namespace imomushi
