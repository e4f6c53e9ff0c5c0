// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/body/cut.h"
#include "core/proposal/rig_flesh.h"

// Of proposeFromRig() alone.
namespace imomushi {

/// Planes between the flesh of kept bones and that of their parents.
class RigCuts {
public:
    RigCuts(const Rig& rig, const RigFlesh& flesh, const TriangleMesh& body);

    struct Wish {
        std::vector<CutPlane> planes;  ///< to be tried one after the other, normals outward, unit; the first at the head, along the bisector, unless another one is much better
        double reach = 0.0;            ///< m, how far they may be moved
        double importance = 0.0;       ///< length of what lies beyond over the radius of the section: limbs before spines
    };
    /// For a kept bone that is not the root.
    [[nodiscard]] Wish wish(const MergedRig& merged, std::size_t kept) const;
    /// Where a kept bone points, unit: towards its next joint in the file, or else the middle of its flesh.
    [[nodiscard]] Vec3 direction(const MergedRig& merged, std::size_t kept) const;

private:
    /// How much flesh lies on the wrong side of a plane, in parts of the whole: `own`: per vertex, what of it lies beyond the joint.
    [[nodiscard]] double misplaced(const std::vector<double>& own, const CutPlane& plane) const;

    const Rig& rig_;
    const RigFlesh& flesh_;
    const TriangleMesh& body_;
    std::vector<std::int32_t> firstNeighbour_, neighbour_;  // vertices of the body
    double diagonal_ = 0.0;
};

}  // namespace imomushi
