// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "core/body/cut.h"
#include "core/mesh/bounds.h"
#include "core/mesh/mesh.h"
#include "core/mesh/topology.h"
#include "core/mesh/vertex_corners.h"

namespace imomushi {

/// What all cuts of a body need to know of it.
struct CutSurface {
    explicit CutSurface(const TriangleMesh& mesh);  ///< closed, see MeshFacts
    const TriangleMesh& mesh;
    EdgeTable edges;
    VertexCorners corners;
    std::vector<double> height;  ///< #V: smallest height of the triangles around, m
    double diagonal = 0.0;       ///< m
    double volume = 0.0;         ///< m^3
    Bounds box;
    /// Triangles that lie together: a plane asks only those whose box it crosses.
    struct Cluster {
        std::size_t begin = 0, end = 0;                   ///< of byPlace
        Vec3 middle = Vec3::Zero(), half = Vec3::Zero();  ///< m, of their box
        double height = 0.0;                              ///< the largest of its vertices
    };
    std::vector<Cluster> clusters;
    std::vector<std::int32_t> byPlace;  ///< trianglesByPlace()
};

/// A point of a loop: a vertex of the body, or where the plane crosses an edge.
struct SectionPoint {
    std::int32_t vertex = -1;  ///< -1: on an edge
    std::int32_t edge = -1;    ///< of CutSurface::edges, -1: a vertex
    double along = 0.0;        ///< on the edge from its low vertex, 0...1
    Vec3 place = Vec3::Zero();
};

/// A side of a loop, from the point of the same number to the next: through a triangle or along an edge.
struct SectionSide {
    std::int32_t triangle = -1;  ///< that it crosses, -1: none
    std::int32_t edge = -1;      ///< that it runs along, -1: none
};

/// The closed region in which a plane meets a body. Seen from in front, the body lies left of its loops.
struct Section {
    Vec3 normal = Vec3::UnitZ();                   ///< unit
    Eigen::Matrix<double, 3, 2> axes;              ///< of the plane; x, y and the normal are right-handed
    std::vector<std::vector<SectionPoint>> loops;  ///< outer one first
    std::vector<std::vector<SectionSide>> sides;
    std::vector<std::pair<std::int32_t, Vec3>> moved;  ///< vertices of the body that were moved onto the plane, or from the region away from it, ascending
    double spacing = 0.0;                              ///< m, mean length of the edges that it crosses
    [[nodiscard]] Eigen::Vector2d flat(const Vec3& p) const { return axes.transpose() * (p - loops[0][0].place); }
    [[nodiscard]] Vec3 lifted(const Eigen::Vector2d& p) const { return loops[0][0].place + axes * p; }
};

/// Errors: "bad-value", "no-section", "section-touches-itself".
Result<Section> findSection(const CutSurface& surface, const CutPlane& plane);

}  // namespace imomushi
