// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/base/progress.h"
#include "core/body/cgal/rays.h"
#include "core/mesh/mesh.h"

// Of makeBody() alone. Lengths are in diagonals: meshes here have a bounding box of diagonal 1.
namespace imomushi {

/// A place on a surface, and how far it is to the next wall outside and inside.
struct SurfaceSample {
    Vec3 point, normal;
    double gap = std::numeric_limits<double>::infinity();    ///< to another part of the surface in front; infinite: none within reach
    Vec3 across = Vec3::Zero();                              ///< from the point to the other side of the gap, unit
    double width = std::numeric_limits<double>::infinity();  ///< of the gap in the middle of that way, at least half of it: walls that are round are nearer beside it
    double crease = std::numeric_limits<double>::infinity(); ///< to a wall in front that is no gap but the other side of a crease
    double thickness = std::numeric_limits<double>::infinity();  ///< to the far side of the flesh; infinite: none within reach
};

/// Samples of equal area. A wall in front counts as the other side of a gap when the way to it over the surface is much longer than through the air: a
/// crease is no gap. `reach`: of the rays. Fewer than asked where cancelled.
std::vector<SurfaceSample> studySurface(const TriangleMesh& mesh, const RayTree& rays, int samples, double reach, const Progress& progress);

/// The size that a surface needs from place to place: the smallest of some sources', each growing with the distance from it.
class SizeField {
public:
    struct Source {
        Vec3 point;
        double size;
    };
    /// size(x) = min(coarsest, min over sources of (size + growth max(0, |x - point| - around)))
    SizeField(std::vector<Source> sources, double coarsest, double growth, double around);
    [[nodiscard]] double at(const Vec3& point) const;
    [[nodiscard]] double coarsest() const { return coarsest_; }
    [[nodiscard]] double finest() const { return nodes_.empty() ? coarsest_ : nodes_.front().size; }

private:
    struct Node {
        Vec3 low, high;
        double size = 0.0;                ///< smallest of its sources
        std::int32_t begin = 0, end = 0;  ///< its sources
        std::int32_t right = -1;          ///< of an inner node; its left child is the next node. -1: leaf
    };
    std::int32_t grow(std::int32_t begin, std::int32_t end);

    std::vector<Source> sources_;
    std::vector<Node> nodes_;
    double coarsest_, growth_, around_;
};

}  // namespace imomushi
