// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/proposal/proposal.h"

namespace imomushi {

/// A trunk along x with a cut at x = `cut` and at -`cut` (m), in front of each a limb, "right" and "left", whose bone ends at x = `tip` and -`tip`; a bone in the trunk. Nothing is pinned.
inline Proposal trunkWithTwoLimbs(double cut, double tip) {
    Proposal p;
    p.root = "trunk";
    p.cuts = {{"right cut", "right", {Vec3(cut, 0, 0), Vec3(1, 0, 0)}}, {"left cut", "left", {Vec3(-cut, 0, 0), Vec3(-1, 0, 0)}}};
    ProposedBone bone;
    bone.name = "trunk bone", bone.start = Vec3(-cut, 0, 0), bone.end = Vec3(cut, 0, 0), bone.startCut = 1, bone.endCut = 0;
    p.bones.push_back(bone);
    bone = {};
    bone.name = "right bone", bone.parent = 0, bone.start = Vec3(cut, 0, 0), bone.end = Vec3(tip, 0, 0), bone.piece = bone.startCut = 0;
    p.bones.push_back(bone);
    bone = {};
    bone.name = "left bone", bone.parent = 0, bone.fromParentStart = true, bone.start = Vec3(-cut, 0, 0), bone.end = Vec3(-tip, 0, 0), bone.piece = bone.startCut = 1;
    p.bones.push_back(bone);
    return p;
}

}  // namespace imomushi
