// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi::render {

/// The display vertices of one body: made once from its mesh, then filled each frame from its body vertices.
///
/// Normals. Every corner of a triangle belongs to a normal group of its body vertex: with look normals, the corners whose look normals
/// agree within kSameNormal; without, the corners that are connected around the vertex over edges flatter than kCrease. Covered
/// triangles belong to no group. A group of all corners takes the normal of the body; a smaller one (a hard edge, a flat facet, the rim
/// of a covered face) takes the area-weighted normal of its own triangles as they are now. So smooth characters stay
/// smooth, facets stay facets in every pose, and no normal is ever rotated by guesswork.
class BodyGeometry {
public:
    static constexpr float kSameNormal = 0.985f;  ///< cosine of 10 degrees: below what a modelling program smooths or splits
    static constexpr float kCrease = 0.643f;      ///< cosine of 50 degrees: smooths a cylinder of 8 sides, splits a cap
    static constexpr int kFloats = 6;             ///< of a display vertex: position, normal

    BodyGeometry(const ElementMesh& mesh, const std::vector<std::int32_t>* covered);

    /// One drawn run of triangles with one material (-1: none).
    struct Range {
        int material = -1;
        int first = 0;  ///< index of the first corner
        int count = 0;  ///< corners
    };
    [[nodiscard]] int vertexCount() const { return static_cast<int>(bodyVertex_.size()); }
    [[nodiscard]] const std::vector<std::int32_t>& bodyVertex() const { return bodyVertex_; }
    [[nodiscard]] const std::vector<std::int32_t>& renderVertex() const { return renderVertex_; }  ///< -1: the mesh has no look
    [[nodiscard]] const std::vector<std::uint32_t>& indices() const { return indices_; }
    [[nodiscard]] const std::vector<Range>& ranges() const { return ranges_; }
    [[nodiscard]] int bodyTriangle(int drawn) const { return drawnTriangle_[drawn]; }  ///< of the n-th drawn triangle
    /// Index of the display vertices of a body triangle's corners, also of covered ones.
    [[nodiscard]] const std::uint32_t* corners(int bodyTriangle) const { return &corner_[3 * bodyTriangle]; }

    /// Area-weighted sums of the groups that are not whole, from positions (#body vertices x 3). Allocates nothing.
    void sumNormals(const float* positions);
    /// The group of a display vertex that is not whole (-1: it is), and its triangles.
    [[nodiscard]] int group(int displayVertex) const { return group_[displayVertex]; }
    [[nodiscard]] std::span<const std::int32_t> groupTriangles(int group) const {
        return {groupTriangles_.data() + groupStart_[group], groupTriangles_.data() + groupStart_[group + 1]};
    }
    [[nodiscard]] const Triangles& triangles() const { return triangles_; }
    /// The group of a rim vertex where a seam may be welded: the only group there that is not whole; -1: none or several.
    [[nodiscard]] int seamGroup(std::int32_t bodyVertex) const { return seamGroup_.empty() ? -1 : seamGroup_[bodyVertex]; }
    [[nodiscard]] const Eigen::Vector3f& sum(int group) const { return sums_[group]; }
    void addToNormal(int group, const Eigen::Vector3f& more) { welded_[group] += more; }

    /// Fills vertexCount() x kFloats. `normals` may be null: then they are computed from the triangles.
    void fill(const float* positions, const float* normals, float* out);

private:
    const Triangles triangles_;              ///< of the body
    std::vector<std::int32_t> bodyVertex_;   ///< of each display vertex
    std::vector<std::int32_t> renderVertex_;
    std::vector<std::int32_t> group_;        ///< of each display vertex, -1: whole
    std::vector<std::uint32_t> corner_, indices_;
    std::vector<std::int32_t> drawnTriangle_;
    std::vector<Range> ranges_;
    std::vector<std::int32_t> groupStart_, groupTriangles_;  ///< triangles of each group that is not whole
    std::vector<std::int32_t> usedTriangles_;                ///< all of them, once
    std::vector<Eigen::Vector3f> facet_;                     ///< twice the area times the normal, of used triangles
    std::vector<Eigen::Vector3f> sums_, welded_;
    std::vector<std::int32_t> seamGroup_;
    std::vector<float> ownNormals_;
};

}  // namespace imomushi::render
