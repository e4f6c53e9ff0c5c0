// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/proposal/proposal_edit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/mesh/bounds.h"

namespace imomushi {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

bool goodPoint(const Vec3& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() <= kMaxCoordinate; }
bool goodPlane(const CutPlane& plane) { return goodPoint(plane.origin) && goodPoint(plane.normal) && plane.normal.stableNorm() > 0.0; }

tl::unexpected<Error> faulty(const std::string& what) { return fail("bad-proposal", what); }
tl::unexpected<Error> badPlane() { return fail("bad-value", "A plane needs a finite origin and a normal that is not zero."); }
tl::unexpected<Error> badPlace() { return fail("bad-value", "A place needs three finite coordinates."); }
tl::unexpected<Error> noLength(const std::string& bone) { return fail("no-length", "The bone \"" + bone + "\" would have no length: choose a place farther away."); }

/// The first of "base", "base 2", ... that `taken` does not hold.
std::string freeOf(const std::string& base, const std::set<std::string>& taken) {
    if (!taken.contains(base)) return base;
    for (int n = 2;; ++n)
        if (std::string name = base + " " + std::to_string(n); !taken.contains(name)) return name;
}

/// Cuts, pieces, bones and handles share one name space in the document.
std::set<std::string> namesOf(const Proposal& p) {
    std::set<std::string> names{p.root};
    for (const ProposedCut& cut : p.cuts) names.insert({cut.name, cut.piece});
    for (const ProposedBone& bone : p.bones) names.insert(bone.name);
    for (const ProposedHandle& handle : p.handles) names.insert(handle.name);
    return names;
}

/// A name without the number at its end: "arm.L 2" is another piece of "arm.L".
std::string stem(const std::string& name) {
    const std::size_t last = name.find_last_not_of("0123456789");
    return last != std::string::npos && last + 1 < name.size() && last > 0 && name[last] == ' ' ? name.substr(0, last) : name;
}

const std::string& pieceName(const Proposal& p, int piece) { return piece < 0 ? p.root : p.cuts[at(piece)].piece; }

/// Bones that hang on a bone's end, with theirs. `atStart`: on its start, too.
std::vector<char> hangingOn(const Proposal& p, int bone, bool atStart) {
    std::vector<char> hangs(p.bones.size(), 0);
    for (int b = bone + 1; b < static_cast<int>(p.bones.size()); ++b) {
        const ProposedBone& other = p.bones[at(b)];
        if (other.parent < 0) continue;
        hangs[at(b)] = other.parent == bone ? atStart || !other.fromParentStart : hangs[at(other.parent)];
    }
    return hangs;
}

int insertBone(Proposal& p, ProposedBone bone) {
    p.bones.push_back(std::move(bone));
    return static_cast<int>(p.bones.size()) - 1;
}

/// Puts the bone at `from` before that at `to` < `from`: parents come first.
void moveBone(Proposal& p, int from, int to) {
    std::vector<int> place(p.bones.size());
    for (int b = 0; b < static_cast<int>(p.bones.size()); ++b) place[at(b)] = b == from ? to : b >= to && b < from ? b + 1 : b;
    std::rotate(p.bones.begin() + to, p.bones.begin() + from, p.bones.begin() + from + 1);
    for (ProposedBone& bone : p.bones)
        if (bone.parent >= 0) bone.parent = place[at(bone.parent)];
    for (ProposedPin& pin : p.pins) pin.bone = place[at(pin.bone)];
}

Result<Proposal> checkedLengths(Proposal p) {
    for (const ProposedBone& bone : p.bones) {
        if (!goodPoint(bone.start) || !goodPoint(bone.end)) return badPlace();
        if (!((bone.end - bone.start).stableNorm() > 0.0)) return noLength(bone.name);
    }
    return p;
}

/// The joint nearest to a place; bone -1: there is none.
ProposedEnd nearestEnd(const Proposal& p, const Vec3& place) {
    ProposedEnd best{-1, true};
    double nearest = std::numeric_limits<double>::infinity();
    for (int b = 0; b < static_cast<int>(p.bones.size()); ++b)
        for (const bool atEnd : {true, false})
            if (const double d = (placeOf(p, {b, atEnd}) - place).norm(); d < nearest) nearest = d, best = {b, atEnd};
    return best;
}

}  // namespace

Result<void> checkProposal(const Proposal& p) {
    std::set<std::string> cuts, pieces{p.root}, bones, handles;
    const int count = static_cast<int>(p.cuts.size());
    for (const ProposedCut& cut : p.cuts) {
        if (cut.name.empty() || !cuts.insert(cut.name).second) return faulty("Cuts need names that differ: \"" + cut.name + "\".");
        if (!cut.piece.empty() && !pieces.insert(cut.piece).second) return faulty("Pieces need names that differ: \"" + cut.piece + "\".");
        if (!goodPlane(cut.plane)) return faulty("The plane of the cut \"" + cut.name + "\" needs a finite origin and a normal that is not zero.");
    }
    for (std::size_t b = 0; b < p.bones.size(); ++b) {
        const ProposedBone& bone = p.bones[b];
        const std::string what = "The bone \"" + bone.name + "\" ";
        if (bone.name.empty() || !bones.insert(bone.name).second) return faulty("Bones need names that differ: \"" + bone.name + "\".");
        if (!goodPoint(bone.start) || !goodPoint(bone.end) || !((bone.end - bone.start).stableNorm() > 0.0)) return faulty(what + "needs two different ends of finite coordinates.");
        if (bone.parent < -1 || bone.parent >= static_cast<int>(b)) return faulty(what + "must come after its parent.");
        for (const int cut : {bone.piece, bone.startCut, bone.endCut})
            if (cut < -1 || cut >= count) return faulty(what + "names a cut that is not there.");
        if (bone.parent >= 0) {
            const ProposedBone& parent = p.bones[at(bone.parent)];
            if (bone.start != (bone.fromParentStart ? parent.start : parent.end)) return faulty(what + "must start where its parent \"" + parent.name + "\" starts or ends.");
        } else if (bone.fromParentStart) {
            return faulty(what + "has no parent to start with.");
        }
    }
    for (const ProposedPin& pin : p.pins)
        if (pin.bone < 0 || pin.bone >= static_cast<int>(p.bones.size())) return faulty("A pin names a bone that is not there.");
    for (const ProposedHandle& handle : p.handles) {
        if (handle.name.empty() || !handles.insert(handle.name).second) return faulty("Handles need names that differ: \"" + handle.name + "\".");
        if (!goodPoint(handle.point) || !(handle.radius > 0.0 && handle.radius <= kMaxCoordinate)) return faulty("The handle \"" + handle.name + "\" needs a place and a radius above 0.");
    }
    return {};
}

// ---- cuts --------------------------------------------------------------------------------------------------------------

Result<Proposal> withCutMoved(const Proposal& proposal, int cut, const CutPlane& plane, const Vec3& middle) {
    if (!goodPlane(plane)) return badPlane();
    if (!goodPoint(middle)) return badPlace();
    Proposal p = proposal;
    p.cuts[at(cut)].plane = {plane.origin, plane.normal.stableNormalized()};
    for (int b = 0; b < static_cast<int>(proposal.bones.size()); ++b)
        for (const bool atEnd : {false, true})
            if (const ProposedEnd end{b, atEnd}; cutAt(proposal, end) == cut) (atEnd ? p.bones[at(b)].end : p.bones[at(b)].start) = middle;
    return checkedLengths(std::move(p));
}

Result<Proposal> withoutCut(const Proposal& proposal, int cut) {
    Proposal p = proposal;
    // What lies behind: the piece of the nearest bone towards the root that is not in front of it.
    int behind = -1;
    for (const ProposedBone& bone : p.bones) {
        if (bone.piece != cut || bone.parent < 0 || p.bones[at(bone.parent)].piece == cut) continue;
        behind = p.bones[at(bone.parent)].piece;
        break;
    }
    const auto renumbered = [cut](int c) { return c == cut ? -1 : c > cut ? c - 1 : c; };
    for (ProposedBone& bone : p.bones) {
        if (bone.piece == cut) bone.piece = behind;
        bone.piece = renumbered(bone.piece);
        bone.startCut = renumbered(bone.startCut);
        bone.endCut = renumbered(bone.endCut);
    }
    p.cuts.erase(p.cuts.begin() + cut);
    return p;
}

CutPlace placeOfCut(const Proposal& p, const CutPlane& plane, const Vec3& middle, double radius) {
    const Vec3 normal = plane.normal.stableNormalized();
    CutPlace place;
    double nearest = std::max(radius, 0.0);
    for (int b = 0; b < static_cast<int>(p.bones.size()); ++b) {
        const ProposedBone& bone = p.bones[at(b)];
        const double s = normal.dot(bone.start - middle), e = normal.dot(bone.end - middle);
        if (s * e >= 0.0) continue;
        if (const double off = (bone.start + s / (s - e) * (bone.end - bone.start) - middle).norm(); off <= nearest) nearest = off, place.crossed = b;
    }
    if (place.crossed < 0) place.from = nearestEnd(p, middle);
    return place;
}

Result<Proposal> withCutAdded(const Proposal& proposal, const CutPlane& plane, const Vec3& middle, double radius, const std::optional<Vec3>& tip) {
    if (!goodPlane(plane) || !std::isfinite(radius)) return badPlane();
    if (!goodPoint(middle)) return badPlace();
    return withCutAdded(proposal, plane, middle, placeOfCut(proposal, plane, middle, radius), tip);
}

Result<Proposal> withCutAdded(const Proposal& proposal, const CutPlane& plane, const Vec3& middle, const CutPlace& place, const std::optional<Vec3>& tip) {
    if (!goodPlane(plane)) return badPlane();
    if (!goodPoint(middle) || (tip && !goodPoint(*tip))) return badPlace();
    Proposal p = proposal;
    Vec3 normal = plane.normal.stableNormalized();
    const int crossed = place.crossed;
    const int added = static_cast<int>(p.cuts.size());
    ProposedCut cut;
    const auto nameIt = [&](int piece) {
        auto names = namesOf(p);
        cut.piece = freeOf(stem(pieceName(p, piece).empty() ? "piece" : pieceName(p, piece)), names);
        names.insert(cut.piece);
        cut.name = freeOf(cut.piece + " cut", names);
    };
    if (crossed >= 0) {
        // Bones lead away from the root.
        const ProposedBone& whole = p.bones[at(crossed)];
        if (normal.dot(whole.end - whole.start) < 0.0) normal = -normal;
        nameIt(whole.piece);
        ProposedBone outer = whole;
        outer.name = freeOf(cut.piece + " bone", namesOf(p));
        outer.parent = crossed;
        outer.fromParentStart = false;
        outer.start = middle;
        outer.startCut = added;
        outer.piece = added;
        outer.joint = -1;
        const auto beyond = hangingOn(p, crossed, false);
        const int piece = whole.piece;
        for (std::size_t b = 0; b < p.bones.size(); ++b) {
            if (!beyond[b]) continue;
            if (p.bones[b].piece == piece) p.bones[b].piece = added;
        }
        p.bones[at(crossed)].end = middle;
        p.bones[at(crossed)].endCut = added;
        for (ProposedBone& bone : p.bones)
            if (bone.parent == crossed && !bone.fromParentStart) bone.parent = static_cast<int>(p.bones.size());
        for (ProposedPin& pin : p.pins)
            if (pin.bone == crossed && pin.atEnd) pin.bone = static_cast<int>(p.bones.size());
        insertBone(p, std::move(outer));
        moveBone(p, static_cast<int>(p.bones.size()) - 1, crossed + 1);
    } else {
        const ProposedEnd& from = place.from;
        const Vec3 away = tip ? *tip - middle : from.bone < 0 ? Vec3(normal) : Vec3(middle - placeOf(p, from));
        if (normal.dot(away) < 0.0) normal = -normal;
        const int behind = from.bone < 0 ? -1 : p.bones[at(from.bone)].piece;
        nameIt(behind);
        if (tip) {
            ProposedBone outer;
            outer.piece = outer.startCut = added;
            outer.start = middle;
            outer.end = *tip;
            if (from.bone >= 0 && placeOf(p, from) != middle) {
                ProposedBone base;
                base.name = freeOf(cut.piece + " base", namesOf(p));
                base.parent = from.bone;
                base.fromParentStart = !from.atEnd;
                base.start = placeOf(p, from);
                base.end = middle;
                base.piece = behind;
                base.startCut = cutAt(p, from);
                base.endCut = added;
                outer.parent = insertBone(p, std::move(base));
            }
            outer.name = freeOf(cut.piece + " bone", namesOf(p));
            insertBone(p, std::move(outer));
        }
    }
    cut.plane = {plane.origin, normal};
    p.cuts.push_back(std::move(cut));
    return checkedLengths(std::move(p));
}

// ---- bones -------------------------------------------------------------------------------------------------------------

std::vector<ProposedEnd> jointOf(const Proposal& p, const ProposedEnd& end) {
    // Down to the bone that has the place first, then all that start there.
    ProposedEnd root = end;
    while (!root.atEnd && p.bones[at(root.bone)].parent >= 0) root = {p.bones[at(root.bone)].parent, !p.bones[at(root.bone)].fromParentStart};
    std::vector<ProposedEnd> joint{root};
    std::vector<char> starts(p.bones.size(), 0);  // at the joint
    if (!root.atEnd) starts[at(root.bone)] = 1;
    for (int b = root.bone + 1; b < static_cast<int>(p.bones.size()); ++b) {
        const ProposedBone& bone = p.bones[at(b)];
        if (bone.parent < 0) continue;
        if (!(bone.fromParentStart ? starts[at(bone.parent)] : root.atEnd && bone.parent == root.bone)) continue;
        starts[at(b)] = 1;
        joint.push_back({b, false});
    }
    return joint;
}

int cutAt(const Proposal& p, const ProposedEnd& end) {
    for (const ProposedEnd& other : jointOf(p, end)) {
        const ProposedBone& bone = p.bones[at(other.bone)];
        if (const int cut = other.atEnd ? bone.endCut : bone.startCut; cut >= 0) return cut;
    }
    return -1;
}

Result<Proposal> withEndMoved(const Proposal& proposal, const ProposedEnd& end, const Vec3& to) {
    if (!goodPoint(to)) return badPlace();
    if (const int cut = cutAt(proposal, end); cut >= 0) return fail("on-a-cut", "That end lies on the cut \"" + proposal.cuts[at(cut)].name + "\": move the cut.");
    Proposal p = proposal;
    for (const ProposedEnd& other : jointOf(proposal, end)) (other.atEnd ? p.bones[at(other.bone)].end : p.bones[at(other.bone)].start) = to;
    return checkedLengths(std::move(p));
}

Result<Proposal> withoutBone(const Proposal& proposal, int bone) {
    Proposal p = proposal;
    const ProposedBone gone = p.bones[at(bone)];
    for (ProposedBone& other : p.bones) {
        if (other.parent != bone) continue;
        if (other.startCut < 0) other.startCut = other.fromParentStart ? gone.startCut : gone.endCut;
        if (other.fromParentStart) {
            other.parent = gone.parent;
            other.fromParentStart = gone.fromParentStart;
        } else {
            other.parent = -1;
        }
    }
    std::erase_if(p.pins, [&](const ProposedPin& pin) { return pin.bone == bone; });
    const auto renumbered = [bone](int b) { return b > bone ? b - 1 : b; };
    p.bones.erase(p.bones.begin() + bone);
    for (ProposedBone& other : p.bones) other.parent = renumbered(other.parent);
    for (ProposedPin& pin : p.pins) pin.bone = renumbered(pin.bone);
    return p;
}

Result<Proposal> withBoneAdded(const Proposal& proposal, const ProposedEnd& from, const Vec3& to, int piece) {
    Proposal p = proposal;
    ProposedBone bone;
    bone.name = freeOf("bone", namesOf(p));
    bone.parent = from.bone;
    bone.fromParentStart = !from.atEnd;
    bone.start = placeOf(p, from);
    bone.startCut = cutAt(p, from);
    bone.end = to;
    bone.piece = piece;
    insertBone(p, std::move(bone));
    return checkedLengths(std::move(p));
}

Result<Proposal> withBoneAdded(const Proposal& proposal, const Vec3& from, const Vec3& to, int piece) {
    Proposal p = proposal;
    ProposedBone bone;
    bone.name = freeOf("bone", namesOf(p));
    bone.start = from;
    bone.end = to;
    bone.piece = piece;
    insertBone(p, std::move(bone));
    return checkedLengths(std::move(p));
}

// ---- pins and handles --------------------------------------------------------------------------------------------------

bool isPinned(const Proposal& p, const ProposedEnd& end) {
    const auto joint = jointOf(p, end);
    return std::any_of(p.pins.begin(), p.pins.end(), [&](const ProposedPin& pin) { return std::find(joint.begin(), joint.end(), ProposedEnd{pin.bone, pin.atEnd}) != joint.end(); });
}

Proposal withPinToggled(const Proposal& proposal, const ProposedEnd& end) {
    Proposal p = proposal;
    const auto joint = jointOf(p, end);
    const auto removed = std::erase_if(p.pins, [&](const ProposedPin& pin) { return std::find(joint.begin(), joint.end(), ProposedEnd{pin.bone, pin.atEnd}) != joint.end(); });
    if (removed == 0) p.pins.push_back({joint.front().bone, joint.front().atEnd});
    return p;
}

Proposal withHandlePinToggled(const Proposal& proposal, int handle) {
    Proposal p = proposal;
    p.handles[at(handle)].pinned = !p.handles[at(handle)].pinned;
    return p;
}

Proposal withoutHandle(const Proposal& proposal, int handle) {
    Proposal p = proposal;
    p.handles.erase(p.handles.begin() + handle);
    return p;
}

Result<Proposal> withHandleMoved(const Proposal& proposal, int handle, const Vec3& to) {
    if (!goodPoint(to)) return badPlace();
    Proposal p = proposal;
    p.handles[at(handle)].point = to;
    return p;
}

// ---- trying ------------------------------------------------------------------------------------------------------------

Result<TriedCuts> tryCuts(const TriangleMesh& body, const Proposal& proposal, const Progress& progress) {
    TriedCuts tried;
    tried.refused.resize(proposal.cuts.size());
    tried.piece.assign(static_cast<std::size_t>(body.vertices.rows()), -1);
    // Every round leaves one cut out.
    while (true) {
        std::vector<int> which;
        std::vector<CutPlane> planes;
        for (int c = 0; c < static_cast<int>(proposal.cuts.size()); ++c)
            if (!tried.refused[at(c)]) which.push_back(c), planes.push_back(proposal.cuts[at(c)].plane);
        if (which.empty()) return tried;
        const auto pieces = cutBody(body, planes, progress);
        if (!pieces) {
            const CutRefusal& refusal = pieces.error();
            if (refusal.cut < 0) return tl::unexpected<Error>(refusal);
            tried.refused[at(which[at(std::max(refusal.cut, refusal.other))])] = Error(refusal);
            continue;
        }
        for (const BodyPiece& piece : *pieces) {
            const auto front = std::find_if(piece.caps.begin(), piece.caps.end(), [](const BodyPiece::Cap& cap) { return cap.front; });
            if (front == piece.caps.end()) continue;
            for (const std::int32_t v : piece.source)
                if (v >= 0) tried.piece[at(v)] = which[at(front->cut)];
        }
        return tried;
    }
}

}  // namespace imomushi
