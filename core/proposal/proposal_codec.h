// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/body/body_codec.h"
#include "core/proposal/proposal.h"
#include "core/worker/worker.h"

// The members of proposals as messages to and from workers carry them (core/worker/codec.h).
namespace imomushi {

constexpr Proposal::Source lastOf(Proposal::Source) { return Proposal::Source::Skeleton; }

void members(auto& archive, ModelPart& p) { archive(p.part, p.shell); }
void members(auto& archive, ProposedCut& c) { archive(c.name, c.piece, c.plane); }
void members(auto& archive, ProposedBone& b) {
    archive(b.name, b.parent, b.start, b.end, b.fromParentStart, b.piece, b.startCut, b.endCut, b.joint);
}
void members(auto& archive, ProposedPin& p) { archive(p.bone, p.atEnd); }
void members(auto& archive, ProposedHandle& h) { archive(h.name, h.point, h.radius, h.pinned); }
void members(auto& archive, ProposedPart& p) { archive(p.part, p.pivot); }
void members(auto& archive, ProposedMerge& m) { archive(m.what, m.into, m.share, m.why); }
void members(auto& archive, Proposal& p) {
    archive(p.from, p.root, p.cuts, p.bones, p.pins, p.handles, p.parts, p.merged, p.share, p.notes, p.symmetry);
}

/// Says what a worker left out, because it crashed or did not end there.
inline void noteLeftOut(Proposal& proposal) {
    for (const std::string& step : leftOutSteps())
        proposal.notes.push_back({"left-out", "Left out, because it breaks down or comes to no end on this body: " + step + "."});
}

}  // namespace imomushi
