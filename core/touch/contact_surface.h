// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/mesh/box_tree.h"
#include "core/mesh/vertex_corners.h"
#include "core/touch/touch_surface.h"

namespace imomushi {

/// The surface of one element as other flesh feels it: samples, body vertices that can press and be pressed, by the patch that each belongs to most. The same
/// in all frames.
class ContactSurface {
public:
    static constexpr std::size_t kPerPatch = 16;  ///< samples of a patch, at most: as far from each other as can be

    ContactSurface(const ElementMesh& mesh, std::shared_ptr<const TouchSurface> surface);

    [[nodiscard]] const TouchSurface& surface() const { return *surface_; }
    [[nodiscard]] const TouchPatches& patches() const { return surface_->touch().patches; }
    [[nodiscard]] std::size_t samples() const { return vertex_.size(); }
    [[nodiscard]] std::int32_t vertex(std::size_t sample) const { return vertex_[sample]; }
    /// The samples of a patch follow each other: from firstOf(patch) to firstOf(patch + 1).
    [[nodiscard]] std::size_t firstOf(int patch) const { return first_[static_cast<std::size_t>(patch)]; }
    /// m, at rest: no vertex that belongs to the patch is farther from its centre.
    [[nodiscard]] double radius(int patch) const { return radius_[static_cast<std::size_t>(patch)]; }
    /// m, at rest: the largest distance between neighbouring samples of a patch, about.
    [[nodiscard]] double spacing(int patch) const { return spacing_[static_cast<std::size_t>(patch)]; }
    [[nodiscard]] double spacing() const { return meanSpacing_; }  ///< of all patches, their mean
    /// Of the triangles around a vertex that can be touched.
    [[nodiscard]] std::span<const std::int32_t> corners(std::int32_t vertex) const { return corners_.at(vertex); }
    /// Patches that are no neighbours: they may press on each other.
    [[nodiscard]] bool areApart(int patch, int other) const;
    /// Surfaces can press where their normals are opposed by more than this cosine: at a right angle or so, one looks along the other.
    static constexpr double kOpposed = -0.1;
    /// Radians by which surfaces turn against each other, at most, for what is said of them at rest to hold.
    static constexpr double kMostTurn = 0.5;
    /// Smallest rest distance, m, of two samples whose normals can become opposed (kOpposed) by a turn of kMostTurn and as much deformation. If
    /// the boxes are farther apart than half the size of the smaller surface: the distance of the boxes. Infinite: there are no such samples.
    [[nodiscard]] static double clearance(const ContactSurface& a, const ContactSurface& b);
    [[nodiscard]] double ownClearance() const { return ownClearance_; }  ///< with itself
    /// Over the middles of patches at rest, each within its radius and `reach` times as far.
    [[nodiscard]] BoxTree patchTree(double reach) const;
    /// True if some triangle at this vertex cannot be touched.
    [[nodiscard]] bool onBorder(std::int32_t vertex) const { return border_[static_cast<std::size_t>(vertex)] != 0; }
    [[nodiscard]] std::size_t bytes() const { return corners_.bytes() + border_.size() + sizeof(std::int32_t) * vertex_.size(); }

private:
    std::shared_ptr<const TouchSurface> surface_;
    VertexCorners corners_;
    std::vector<char> border_;
    std::vector<std::int32_t> vertex_;
    std::vector<std::size_t> first_;
    std::vector<double> radius_, spacing_;
    double meanSpacing_ = 0.0;
    BoxTree tree_;  // over samples, at rest
    double ownClearance_ = 0.0;
};

}  // namespace imomushi
