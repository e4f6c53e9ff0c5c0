// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "core/proposal/proposal_edit.h"

// Edits on both sides of a shape that mirrors itself: what is done to a cut, joint, bone, pin or handle is done to its mirror image, too, and what lies in the plane of symmetry stays in it.
namespace imomushi {

enum class Sides { One, Both };

/// What is the mirror image of what by the proposal's symmetry, within kMirrored of its size: the index of the image, its own where it lies in the plane, -1: there is none.
struct ProposalImages {
    std::vector<int> cuts, bones, handles;
    std::vector<char> reversed;  ///< per bone: it lies across the plane, its image is itself with the ends changed
};
ProposalImages imagesOf(const Proposal& proposal);
inline constexpr double kMirrored = 1e-6;

/// How far the proposal is from being its own mirror image, in parts of its size: places of cuts, bones, pins and handles against their images, normals of cuts as they are. Infinite: something has no
/// image, or hangs otherwise than that does. 0: it has no symmetry.
double mirrorError(const Proposal& proposal);

// As in proposal_edit.h. With Sides::Both a proposal that is its own mirror image (mirrorError() up to kMirrored) stays that; one that is not is changed on both sides where there is an image. Without a
// symmetry both are one. Further errors: "not-mirrored": it cannot be done on both sides.
Result<Proposal> withCutMoved(const Proposal& proposal, int cut, const CutPlane& plane, const Vec3& middle, Sides sides);
Result<Proposal> withoutCut(const Proposal& proposal, int cut, Sides sides);
/// A section that reaches well across the plane of symmetry becomes one cut at a right angle to it. Of two the one that is meant comes first.
Result<Proposal> withCutAdded(const Proposal& proposal, const CutPlane& plane, const Vec3& middle, double radius, const std::optional<Vec3>& tip, Sides sides);
Result<Proposal> withEndMoved(const Proposal& proposal, const ProposedEnd& end, const Vec3& to, Sides sides);
Result<Proposal> withoutBone(const Proposal& proposal, int bone, Sides sides);
/// A bone that runs along the plane of symmetry, in about a tenth of its length, is laid into it.
Result<Proposal> withBoneAdded(const Proposal& proposal, const ProposedEnd& from, const Vec3& to, int piece, Sides sides);
Result<Proposal> withBoneAdded(const Proposal& proposal, const Vec3& from, const Vec3& to, int piece, Sides sides);
Result<Proposal> withPinToggled(const Proposal& proposal, const ProposedEnd& end, Sides sides);
Result<Proposal> withHandlePinToggled(const Proposal& proposal, int handle, Sides sides);
Result<Proposal> withoutHandle(const Proposal& proposal, int handle, Sides sides);
Result<Proposal> withHandleMoved(const Proposal& proposal, int handle, const Vec3& to, Sides sides);

}  // namespace imomushi
