// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/joints/joint_face.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// A body without its appendages (ears, horns, fingers, spikes), and how those follow it.
///
/// Nothing loads an appendage without a joint face, so that it hardly strains beyond one width from its foot (Saint-Venant; in a round rod
/// strain falls like exp(-5.4 z / width)) and moves rigidly. Collocation loses exactly this motion: a point of the appendage sees the body only
/// through the foot, a small solid angle S, and what discretisation leaves of the body's own equations is divided by S.
struct TrimmedBody {
    /// Closed and outward, of the body's topology: its kept vertices in their order, then one vertex in the middle of each cap.
    TriangleMesh mesh;
    std::vector<JointFace> faces;          ///< those of the body, with the vertices and triangles of `mesh`
    std::vector<std::int32_t> bodyVertex;  ///< per vertex of `mesh`; -1: the middle of a cap

    /// What lies beyond a closed loop of edges, where it is cut off and capped.
    struct Appendage {
        double width = 0.0, length = 0.0;   ///< m: perimeter of the cut / pi; from the cut to the tip along edges
        std::vector<std::int32_t> support;  ///< vertices of `mesh`: the loop, then the middle of the cap
        std::vector<std::int32_t> dropped;  ///< body vertices, ascending
    };
    std::vector<Appendage> appendages;  ///< none: `mesh` is the body

    /// The displacement of all body vertices, 3 * #V x k, from that of the vertices of `mesh`, 3 * #vertices x k (xyz per vertex): their own for kept
    /// vertices; for dropped ones the rigid motion that fits the support best, and what that leaves of the support fading out as strain does.
    /// Exact for rigid motions. `body`: the one that was trimmed.
    [[nodiscard]] Eigen::MatrixXd onBody(const Points& body, const Eigen::MatrixXd& displacement) const;
};

/// Cuts the appendages of an element's closed body off, along existing edges and somewhat above their feet. An appendage is a disc of the surface without a
/// joint face that is longer than kSlender widths, and as far from all joint faces as it is wide; what is cut off is longer than wide. What leads to a
/// joint face is none. Left as they are: bodies without joint faces, of several shells, or that would meet themselves. Independent of unit and place up to rounding; deterministic, one
/// thread, about n log n. Errors: "cancelled".
Result<TrimmedBody> withoutAppendages(const ElementMesh& element, std::span<const JointFace> faces, const Progress& progress);

/// Length over width of the stubbiest appendage. Against finite elements on a bent bar, the error of a horn relative to the motion of the bar is then, with
/// the default solver mesh: of 1.6 widths 1 % without cutting it off, 2.4 widths 1.7 %, 3.9 widths 7 %, 6.3 widths 33 %; 1 to 1.7 % for all where it is cut off.
inline constexpr double kSlender = 1.5;

}  // namespace imomushi
