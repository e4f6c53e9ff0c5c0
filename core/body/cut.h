// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <tl/expected.hpp>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// A plane that cuts one section of a body: of all closed regions in which plane and body meet, the one that `origin` lies in (projected onto the
/// plane), else the nearest one. Its holes (cavities of the body) are part of it. Elsewhere the body stays whole.
struct CutPlane {
    Vec3 origin = Vec3::Zero();   ///< m, space of the body
    Vec3 normal = Vec3::UnitX();  ///< of any length but zero; the front is where it points
};

/// What cuts make of a body.
struct BodyPiece {
    /// The side of a cut that belongs to this piece.
    struct Cap {
        int cut = 0;                          ///< index of the cut
        bool front = false;                   ///< the piece lies in front of the plane, its cap looks against the normal
        std::vector<std::int32_t> vertices;   ///< both caps of a cut have the same ones in the same order, bit for bit at the same places
        std::vector<std::int32_t> triangles;  ///< of `body`, those of the one cap in the order of the other's
        double smallestAngle = 0.0;           ///< of its triangles, radians
    };
    TriangleMesh body;                         ///< closed
    std::vector<std::int32_t> source;          ///< #V: vertex of the whole body, -1: made by a cut
    std::vector<std::int32_t> sourceTriangle;  ///< #F: triangle of the whole body that it lies on, -1: of a cap
    std::vector<Cap> caps;                     ///< ascending by cut
};

/// Why cuts are refused. Codes:
/// "bad-value": the plane is not finite, or its normal zero
/// "not-closed": the body is not a closed surface that faces outward
/// "no-section": the plane misses the body
/// "section-touches-itself": the section is pinched at a point, or crosses itself, so that a piece would not be closed
/// "cuts-touch": two sections meet, or share too narrow a strip
/// "does-not-separate": the body still hangs together around the cut
/// "empty-piece": there is no volume on one side
/// "cancelled", and those of askWorker()
struct CutRefusal : Error {
    int cut = -1;                     ///< index of the cut at fault, -1: none
    int other = -1;                   ///< the other one of "cuts-touch"
    std::optional<CutPlane> nearest;  ///< the plane moved along its normal to the nearest place that works, as far as one was found
};

/// Applies all cuts together. Pieces ascend by their lowest vertex of the body; those without any come last. A piece's vertices are those of the body in its
/// order, then those of its cuts. If it has vertices of cuts alone, each clipped polygon of more than three corners gets one in its middle, so that some vertices are free. Its bytes depend on its own cuts alone: other cuts may move, come and go without changing a bit.
///
/// Caps are flat to 1e-10 of the body's size. Where the plane passes a vertex within kSnap, that vertex is slid onto it, along the surface, so that the volume
/// stays as it is: the volumes of the pieces add up to the body's, up to rounding. It moves by at most 2.5 kSnap of its shortest edge. A tip of the
/// surface, such as the bottom of a pocket, that ends within kSnap of a cap is moved back until it is that far from it. Nothing else of the surface changes its place. Loops keep short sides that this leaves; caps then have points on the longer ones beside them.
///
/// A loop around a ring does not separate, two of them do: whether a cut separates is judged with all cuts done. Closed surfaces that no cut meets (cavities,
/// parts that lie apart) stay with the piece around them, else with the one of the nearest vertex.
tl::expected<std::vector<BodyPiece>, CutRefusal> cutBody(const TriangleMesh& body, std::span<const CutPlane> cuts, const Progress& progress = {});

/// The same for one body whose cuts are tried again and again, in this process: what belongs to the body or to one cut alone is done once.
class BodyCutter {
public:
    explicit BodyCutter(const TriangleMesh& body);  ///< stays where it is
    ~BodyCutter();
    BodyCutter(const BodyCutter&) = delete;
    BodyCutter& operator=(const BodyCutter&) = delete;
    tl::expected<std::vector<BodyPiece>, CutRefusal> cut(std::span<const CutPlane> cuts, const Progress& progress = {});

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Vertices of the section that are nearer to the plane than this part of the smallest height of the triangles around are moved onto it.
inline constexpr double kSnap = 2e-2;

}  // namespace imomushi
