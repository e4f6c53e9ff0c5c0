// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/index.h"
#include "core/mesh/mend.h"
#include "core/mesh/topology.h"

// Of mend() and core/body alone: the surface that their steps work on, one file for each.
namespace imomushi {

struct MendFace {
    std::array<std::int32_t, 3> v;  ///< body vertices
    std::array<std::int32_t, 3> r;  ///< render vertices
    std::int32_t material = -1;
    std::int32_t part = 0;
    std::int32_t source = -1;  ///< the triangle of the file that it is, -1: of a cap
    bool turned = false;  ///< wound the other way than in the file

    void turn();
};

struct MendSurface {
    explicit MendSurface(RawSurface raw);

    Points points;
    RenderMesh renderMesh;
    std::vector<MendFace> faces;
    bool attributes = false;                           ///< the render mesh has normals, texture coordinates or colours
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();      ///< bounding box of the used vertices
    std::size_t collapsed = 0;                         ///< faces without area that were removed
    std::vector<MeshIssue> issues;                     ///< what was mended

    [[nodiscard]] Triangles triangles() const;
    /// Adds an issue that was mended.
    void say(const char* code, std::string text, std::size_t count);
    /// Removes faces with the same vertex twice.
    void dropCollapsed();
};

/// Tells of vertices without a face and takes the box of the others. First of all steps: welding tolerances follow the box.
void dropUnused(MendSurface& s);
/// Keeps one of faces with the same vertices.
void dropDuplicates(MendSurface& s);
/// Merges vertices at the same place, then nearly the same place, where that closes open edges.
void weldVertices(MendSurface& s);
/// Triangles without area are removed where an edge of theirs is open or has too many triangles, collapsed where two corners (nearly)
/// coincide, else flipped with the neighbour at the longest side.
/// `flatness`: height over longest side below which a triangle counts as one without area.
void mendDegenerate(MendSurface& s, double flatness = kFlat);
/// Both, and says how many had no area.
void dropUseless(MendSurface& s);
/// Turns triangles so that neighbours are wound alike, the fewer of each piece.
void windConsistently(MendSurface& s);
/// Closes holes with caps where these are small and leave the surface sound.
void capHoles(MendSurface& s);
/// Turns shells outward and cavities inward, and makes a body of each connected surface (`split`), or one of all.
MendResult makeBodies(MendSurface& s, bool split);

/// Whether each component is closed, manifold at its edges and vertices, and consistently wound.
std::vector<char> soundComponents(const Triangles& triangles, const EdgeTable& edges, const std::vector<std::int32_t>& component, int count);

}  // namespace imomushi
