// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/mesh/health.h"
#include "core/mesh/mesh.h"
#include "core/mesh/render_model.h"
#include "core/mesh/rig.h"

namespace imomushi {

/// How a body is made of a render mesh.
/// Exact: the render mesh, welded, is the body. Mended: holes closed, overlapping parts united, parts inside of others and small ones on them left out.
/// Wrapped: a new surface around everything (Portaneri et al. 2022, "Alpha wrapping with an offset"). Auto: the first of these that works.
enum class BodyKind { Auto, Exact, Mended, Wrapped };

/// "auto", "exact", "mended", "wrapped".
std::string_view nameOf(BodyKind how);

/// A tube of flesh that was made between two parts that do not touch, so that the body hangs together.
struct FleshLink {
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< the middles of the places where the parts face each other, m
    double radius = 0.0;                          ///< m
    double volume = 0.0;                          ///< that it adds, m^3
    bool operator==(const FleshLink&) const = default;
};

struct BodySetting {
    BodyKind how = BodyKind::Auto;
    double detail = 0.0;  ///< of a wrap: the radius of the ball that rolls over the surface, in diagonals of the render mesh, kFinestDetail...kCoarsestDetail;
                          ///< gaps narrower than its diameter are closed. 0: chosen from the gaps and limbs of the mesh, finer only where it needs to be
    /// Of a mended body: the links of flesh to make, each between the parts nearest to its ends (FleshLink::volume is not read). Nullopt: links are found.
    std::optional<std::vector<FleshLink>> links = std::nullopt;
    bool operator==(const BodySetting&) const = default;
};
inline constexpr double kFinestDetail = 1e-3, kCoarsestDetail = 0.2;

/// Gaps between two walls of the render mesh that a wrap has filled: what lies on their two sides moves as one.
struct ClosedGaps {
    double area = 0.0;              ///< of the walls, as a part of the whole surface
    double widest = 0.0, narrowest = 0.0;  ///< in diagonals
    std::vector<Vec3> places;       ///< in the middle of gaps, one for each group of places near each other, the largest group first; m
};

struct BodyReport {
    BodyKind how = BodyKind::Exact;  ///< never Auto
    double distanceRms = 0.0, distanceLargest = 0.0;  ///< of the render vertices from the body's surface, in diagonals; without those that nobody sees, in the flesh of other parts
    double volumeError = -1.0;       ///< relative to the volume inside the render mesh; negative: unknown, as the render mesh encloses none
    ClosedGaps gaps;
    std::vector<FleshLink> links;    ///< the volume that they add is no error
    double detail = 0.0;             ///< of a wrap: the finest that was used, in diagonals; 0 otherwise
    int components = 1;              ///< separate surfaces of the body
    double seconds = 0.0;
    std::vector<MeshIssue> issues;   ///< what was mended, left out or closed
};

/// The closed surface that moves a render mesh.
struct Body {
    TriangleMesh mesh;                     ///< closed, manifold, outward, finite, of positive volume; m
    std::vector<std::int32_t> bodyVertex;  ///< per render vertex the body vertex at the same place, -1: none. Exact: every used one has one
    BodyReport report;
};

/// What a file says about which flesh moves with which: the bone that moves a vertex most.
struct BodyBones {
    std::vector<std::int32_t> bone;    ///< #V of the render mesh, -1: none; empty: the file says nothing
    std::vector<std::int32_t> parent;  ///< per bone its parent, -1: a root
};

/// Makes a body of a file's own triangles. `render`: any triangles, of any number of parts; `part`: #F, the part of each triangle, or empty: one part.
/// Vertices that no triangle uses may hold anything. The same input gives the same bytes.
/// Errors: "empty-mesh", "bad-index", "non-finite", "no-volume" (nothing with a volume can be made of it), "not-exact", "not-mendable" (only where `how` asks for
/// one), "bad-detail", "too-large", "cancelled", and those of askWorker(). Where there are workers one does it; steps that break down are left out, and the issue "left-out" says so.
/// `bones`: which parts that do not touch are limbs, to be linked, and which are carried.
Result<Body> makeBody(const TriangleMesh& render, std::span<const std::int32_t> part, const BodySetting& setting, const Progress& progress, const BodyBones& bones = {});

/// The same of a file. `rig`: its skeleton, or null.
Result<Body> makeBody(const RenderModel& model, const Rig* rig, const BodySetting& setting, const Progress& progress);
/// What does that, or stands in for it.
using BodyMaker = std::function<Result<Body>(const RenderModel&, const Rig*, const BodySetting&, const Progress&)>;

}  // namespace imomushi
