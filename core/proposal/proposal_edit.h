// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/mesh/mesh.h"
#include "core/proposal/proposal.h"

// What an artist changes in a proposal before it is accepted. Each function takes a proposal and gives back a changed one; places are m, in the space of the body.
// What comes in and what goes out passes checkProposal(); indices are those of the proposal's lists.
namespace imomushi {

/// Whether a proposal hangs together: names that differ, indices that lead somewhere, parents before children, bones that start where their parent does or ends, bones with a
/// length, planes with a normal, handles with a radius, finite numbers. Errors: "bad-proposal" with the first fault.
Result<void> checkProposal(const Proposal& proposal);

/// Moves and turns a cut; the ends of bones that lie on it go to `middle`, of its section. Errors: "bad-value", "no-length": a bone would have none.
Result<Proposal> withCutMoved(const Proposal& proposal, int cut, const CutPlane& plane, const Vec3& middle);
/// Takes a cut out. Its flesh stays with that behind it; ends of bones stay where they are.
Result<Proposal> withoutCut(const Proposal& proposal, int cut);
/// Adds a cut where a plane crosses a limb, `middle`: of its section. The plane is turned to face away from the root. A bone that crosses the section is divided there, and what hangs on it from there
/// on lies in front. Where no bone does, `tip`, a place in front of it, gets one: from the nearest joint to the section, and from there to the tip; without a tip none.
/// `radius`: of the section. Errors: "bad-value", "no-length".
Result<Proposal> withCutAdded(const Proposal& proposal, const CutPlane& plane, const Vec3& middle, double radius, const std::optional<Vec3>& tip);

/// An end of a bone.
struct ProposedEnd {
    int bone = 0;
    bool atEnd = true;
    bool operator==(const ProposedEnd&) const = default;
};
/// What a cut is added to: the bone that crosses its section nearest to the middle; where none does, -1, a bone begins at the joint nearest to it (bone -1: there is none).
struct CutPlace {
    int crossed = -1;
    ProposedEnd from{-1, true};
};
CutPlace placeOfCut(const Proposal& proposal, const CutPlane& plane, const Vec3& middle, double radius);
/// As above, at a place that is known.
Result<Proposal> withCutAdded(const Proposal& proposal, const CutPlane& plane, const Vec3& middle, const CutPlace& place, const std::optional<Vec3>& tip);

inline const Vec3& placeOf(const Proposal& proposal, const ProposedEnd& end) {
    const ProposedBone& bone = proposal.bones[static_cast<std::size_t>(end.bone)];
    return end.atEnd ? bone.end : bone.start;
}
/// The cut whose section it lies on, -1: none. It moves with that.
int cutAt(const Proposal& proposal, const ProposedEnd& end);
/// All ends that are the same joint, in ascending order; the first stands for it.
std::vector<ProposedEnd> jointOf(const Proposal& proposal, const ProposedEnd& end);

/// Moves an end with all that share it. Errors: "on-a-cut": it moves with its cut; "bad-value", "no-length".
Result<Proposal> withEndMoved(const Proposal& proposal, const ProposedEnd& end, const Vec3& to);
/// Takes a bone out. What hung on its start hangs on its parent now; what hung on its end begins there.
Result<Proposal> withoutBone(const Proposal& proposal, int bone);
/// Adds a bone from an end that there is, or from a place in the flesh, to a place in the flesh. `piece`: the cut behind which it lies, -1: the root's. Errors: "bad-value", "no-length".
Result<Proposal> withBoneAdded(const Proposal& proposal, const ProposedEnd& from, const Vec3& to, int piece);
Result<Proposal> withBoneAdded(const Proposal& proposal, const Vec3& from, const Vec3& to, int piece);

/// Pins a joint, or takes its pins away.
Proposal withPinToggled(const Proposal& proposal, const ProposedEnd& end);
[[nodiscard]] bool isPinned(const Proposal& proposal, const ProposedEnd& end);
/// The same of a handle.
Proposal withHandlePinToggled(const Proposal& proposal, int handle);
Proposal withoutHandle(const Proposal& proposal, int handle);
/// Errors: "bad-value".
Result<Proposal> withHandleMoved(const Proposal& proposal, int handle, const Vec3& to);

/// What the cuts of a proposal do together to a body.
struct TriedCuts {
    std::vector<std::optional<Error>> refused;  ///< per cut: why it is left out when the others are done; none: it works
    std::vector<int> piece;                     ///< per vertex of the body: the cut whose front it lies in, -1: the root
};
/// Tries all cuts (cutBody()); of those that are in each other's way the later ones are refused. Errors: "not-closed", "cancelled".
Result<TriedCuts> tryCuts(const TriangleMesh& body, const Proposal& proposal, const Progress& progress = {});

/// Proposals that came one from another: a value each.
class ProposalHistory {
public:
    explicit ProposalHistory(Proposal first) { states_.push_back(std::move(first)); }
    [[nodiscard]] const Proposal& now() const { return states_[position_]; }
    /// The next state; what was undone is gone.
    void push(Proposal next) {
        states_.resize(position_ + 1, next);
        states_.push_back(std::move(next));
        ++position_;
    }
    [[nodiscard]] std::size_t position() const { return position_; }
    /// False: there is nothing to undo, or redo.
    bool undo() { return position_ > 0 && (--position_, true); }
    bool redo() { return position_ + 1 < states_.size() && (++position_, true); }

private:
    std::vector<Proposal> states_;
    std::size_t position_ = 0;
};

}  // namespace imomushi
