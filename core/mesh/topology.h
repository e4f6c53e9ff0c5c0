// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// One side of one triangle, seen as a use of an undirected edge.
struct EdgeUse {
    std::int32_t low = 0, high = 0;  ///< the edge's vertices, low < high
    std::int32_t triangle = 0;
    std::int8_t corner = 0;          ///< the side runs from this corner to the next
    bool forward = true;             ///< it runs from low to high
};

/// The edges of a surface with the triangles at each, of any number and winding. Indices of the triangles must not be negative;
/// sides from a vertex to itself are no edges.
class EdgeTable {
public:
    explicit EdgeTable(const Triangles& triangles);

    [[nodiscard]] int size() const { return static_cast<int>(first_.size()) - 1; }
    /// The sides at edge e, ascending by triangle. Edges ascend by (low, high).
    [[nodiscard]] std::span<const EdgeUse> uses(int e) const {
        return {uses_.data() + first_[static_cast<std::size_t>(e)], uses_.data() + first_[static_cast<std::size_t>(e) + 1]};
    }
    /// The edge along the side that begins at corner k of triangle f, -1 where it has no length.
    [[nodiscard]] int edgeOf(std::int32_t f, int k) const { return edgeOf_[static_cast<std::size_t>(f) * 3 + static_cast<std::size_t>(k)]; }

private:
    std::vector<EdgeUse> uses_;
    std::vector<std::int32_t> first_;
    std::vector<std::int32_t> edgeOf_;
};

/// The connected component of each triangle, over shared edges; numbered in the order of their first triangles. `count` gets their number.
std::vector<std::int32_t> edgeComponents(const Triangles& triangles, const EdgeTable& edges, int& count);

/// The rims of the holes: closed chains of vertices along the sides that have no partner, in the winding that a cap needs (against
/// that of the triangles there). A chain that touches itself is split where it does, so that no loop visits a vertex twice.
/// Sides at edges of three or more triangles belong to no loop. Ordered by their lowest edges.
std::vector<std::vector<std::int32_t>> boundaryLoops(const EdgeTable& edges);

/// Vertices where the triangles around fall into more than one fan. Ascending. Edges of three or more triangles separate fans.
std::vector<std::int32_t> nonManifoldVertices(const Triangles& triangles, const EdgeTable& edges);

/// Triangles with the same three vertices, in any order, as an earlier one. Ascending.
std::vector<std::int32_t> duplicateTriangles(const Triangles& triangles);

/// Twice the area vector of triangle f: (b - a) x (c - a).
Vec3 areaVector(const TriangleMesh& mesh, std::int32_t f);

/// Of all triangles, m^2.
double surfaceArea(const TriangleMesh& mesh);
/// Signed volume inside a closed surface, m^3: positive when its triangles look outward. About its own middle, so that nothing cancels far from the origin.
double enclosedVolume(const Points& vertices, const Triangles& triangles);

/// True for a triangle that is flatter than single precision can express: its height is below kFlat times its longest side, or two
/// corners are the same.
bool degenerate(const TriangleMesh& mesh, std::int32_t f);
inline constexpr double kFlat = 1e-7;

/// Unit normals at the vertices, weighted by the area of the triangles around; zero where there are none. #V x 3
Points vertexNormals(const TriangleMesh& mesh);

}  // namespace imomushi
