// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/body/cut.h"
#include "core/mesh/model_parts.h"

namespace imomushi {

/// A plane that would cut a body. Its normal points away from the root: the limb lies in front.
struct ProposedCut {
    std::string name;
    std::string piece;  ///< a name for the element in front
    CutPlane plane;
};

/// A bone that would run through a body.
struct ProposedBone {
    std::string name;
    int parent = -1;                              ///< into Proposal::bones, before this one; -1: a root
    Vec3 start = Vec3::Zero(), end = Vec3::Zero();  ///< m. The start is the end of its parent or, with `fromParentStart`, the parent's start, bit for bit
    bool fromParentStart = false;
    int piece = -1;                               ///< it runs through the piece in front of this cut (and behind those farther out), -1: the root's
    int startCut = -1, endCut = -1;               ///< the cut whose section it starts or ends in the middle of, -1: none. The middle may differ from the points here
    int joint = -1;                               ///< of the file's skeleton that it was made from, -1: none
};

/// The end of a bone that would be pinned.
struct ProposedPin {
    int bone = 0;
    bool atEnd = true;
};

/// A handle on a body that is not cut.
struct ProposedHandle {
    std::string name;
    Vec3 point = Vec3::Zero();  ///< on the surface, m
    double radius = 0.0;        ///< m, along the surface
    bool pinned = false;
};

/// A part of what is seen that would keep its shape.
struct ProposedPart {
    ModelPart part;
    std::optional<Vec3> pivot;  ///< m; none: the middle of its box
};

/// What was left out on purpose.
struct ProposedMerge {
    std::string what;    ///< a bone of the file's skeleton, or a branch of the shape
    std::string into;    ///< the name of the bone that moves its flesh
    double share = 0.0;  ///< of the flesh, 0...1
    std::string why;     ///< one sentence
};

/// How a body would be made soft: cuts, bones, pins and rigid parts, for an artist to change and accept. Names are unique within the proposal. Without cuts the
/// body stays one element. Cuts, bones and handles of a document share one name space with its elements; names that are taken get a number.
struct Proposal {
    enum class Source { Shape, Skeleton } from = Source::Shape;
    std::string root;                  ///< a name for the element that no cut has in front
    std::vector<ProposedCut> cuts;     ///< each separates a limb from what lies nearer to the root; together they can be done (cutBody())
    std::vector<ProposedBone> bones;   ///< parents before children
    std::vector<ProposedPin> pins;
    std::vector<ProposedHandle> handles;  ///< where the shape suits them better than cuts
    std::vector<ProposedPart> parts;
    std::vector<ProposedMerge> merged;
    std::vector<double> share;         ///< of the flesh, 0...1, that each bone of the file's skeleton moves by itself; empty: from the shape
    std::vector<Error> notes;          ///< cuts that were moved or left out, and other things to know: a code and a sentence each
    std::optional<CutPlane> symmetry;  ///< the plane that mirrors the shape onto itself; then the proposal is mirrored by it, too
};

}  // namespace imomushi
