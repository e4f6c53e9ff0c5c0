// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
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
        std::vector<CutPlane> planes;  ///< normals outward, unit: at the head, and where the skin goes over
        std::vector<CutPlane> more;    ///< along the bone and towards its parent, and leaning by up to 40 degrees: where those of other limbs are in the way
        std::vector<double> own;       ///< per vertex of the body, 0...1, how much of its flesh belongs beyond the joint
        double reach = 0.0;            ///< m, how far they may be moved
        double importance = 0.0;       ///< length of what lies beyond over the radius of the section: limbs before spines
    };
    /// For a kept bone that is not the root. `mirror`: of the body, so that planes lean along it or across.
    [[nodiscard]] Wish wish(const MergedRig& merged, std::size_t kept, const std::optional<CutPlane>& mirror) const;
    /// Where a kept bone points, unit: towards its next joint in the file, or else the middle of its flesh.
    [[nodiscard]] Vec3 direction(const MergedRig& merged, std::size_t kept) const;

private:
    const Rig& rig_;
    const RigFlesh& flesh_;
    const TriangleMesh& body_;
    std::vector<std::int32_t> firstNeighbour_, neighbour_;  // vertices of the body
    double diagonal_ = 0.0;
};

}  // namespace imomushi
