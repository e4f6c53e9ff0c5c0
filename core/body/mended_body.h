// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/body/body.h"
#include "core/body/prepared_surface.h"

// Of makeBody() alone.
namespace imomushi {

struct MendedSurface {
    TriangleMesh mesh;                   ///< closed, outward
    std::vector<std::int32_t> vertexOf;  ///< per vertex of the prepared mesh its vertex here, -1: none
    double volumeLeftOut = 0.0;          ///< of closed parts that the body carries, m^3
    std::vector<FleshLink> links;        ///< between closed surfaces that do not touch
    bool whole = false;                  ///< all of the prepared mesh, triangle by triangle
    std::vector<MeshIssue> issues;
};

/// A closed body of the closed surfaces of a prepared mesh:
/// * surfaces that cross are united;
/// * surfaces that do not touch are linked by tubes of flesh (planLinks());
/// * a surface inside another one is left out, or, if it faces inward, is a cavity and stays;
/// * surfaces that others carry are left out.
/// Errors: "not-mendable" (what is open, or crosses itself, matters), "cancelled".
/// `bones`: of the vertices of `surface`. `links`: as BodySetting has them. `carry`: whether parts without a motion of their own are left out for the others to carry.
Result<MendedSurface> mendedBody(const PreparedSurface& surface, const BodyBones& bones, const std::optional<std::vector<FleshLink>>& links, bool carry, const Progress& progress);

/// A union of closed surfaces without its voids, which nobody modelled, and without the flat triangles that it leaves.
TriangleMesh tidied(const TriangleMesh& mesh);
/// A closed surface that touches itself, in edges and vertices of its own there for each side.
TriangleMesh separated(TriangleMesh mesh);

}  // namespace imomushi
