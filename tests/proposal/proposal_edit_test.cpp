// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "core/mesh/bounds.h"
#include "core/proposal/proposal_mirror.h"
#include "core/proposal/shape_proposal.h"
#include "tests/support/capsules.h"
#include "tests/support/proposals.h"
#include "tests/support/random_edits.h"

using namespace imomushi;

namespace {

/// Every bit of what an artist can change.
std::string written(const Proposal& p) {
    std::ostringstream out;
    out << std::hexfloat << p.root;
    const auto point = [&](const Vec3& v) { out << ' ' << v.x() << ' ' << v.y() << ' ' << v.z(); };
    for (const ProposedCut& cut : p.cuts) out << "\ncut " << cut.name << '/' << cut.piece, point(cut.plane.origin), point(cut.plane.normal);
    for (const ProposedBone& b : p.bones)
        out << "\nbone " << b.name << ' ' << b.parent << b.fromParentStart << ' ' << b.piece << ' ' << b.startCut << ' ' << b.endCut << ' ' << b.joint, point(b.start), point(b.end);
    for (const ProposedPin& pin : p.pins) out << "\npin " << pin.bone << pin.atEnd;
    for (const ProposedHandle& h : p.handles) out << "\nhandle " << h.name << ' ' << h.radius << h.pinned, point(h.point);
    return out.str();
}

const Proposal& animalProposal() {
    static const Proposal proposal = *proposeFromShape(capsules::animal(), kLeastShare, {});
    return proposal;
}

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Both tips are pinned.
Proposal threeBones() {
    Proposal p = trunkWithTwoLimbs(1.0, 3.0);
    p.pins = {{1, true}, {2, true}};
    return p;
}

Proposal mirroredByX(Proposal p) {
    p.symmetry = CutPlane{Vec3::Zero(), Vec3::UnitX()};
    return p;
}

}  // namespace

TEST_CASE("edited proposals: ends of bones move with the cut they lie on, and with nothing else") {
    const Proposal p = threeBones();
    REQUIRE(checkProposal(p).has_value());
    const auto moved = withCutMoved(p, 0, {Vec3(1.5, 0.1, 0), Vec3(2, 0, 0)}, Vec3(1.5, 0, 0));
    REQUIRE(moved.has_value());
    REQUIRE(checkProposal(*moved).has_value());
    CHECK(moved->cuts[0].plane.normal == Vec3(1, 0, 0));
    CHECK(moved->bones[0].end == Vec3(1.5, 0, 0));
    CHECK(moved->bones[1].start == Vec3(1.5, 0, 0));
    CHECK(moved->bones[0].start == p.bones[0].start);
    CHECK(withEndMoved(p, {1, false}, Vec3(2, 0, 0)).error().code == "on-a-cut");
    CHECK(withEndMoved(p, {1, true}, Vec3(2, 1, 0))->bones[1].end == Vec3(2, 1, 0));
    CHECK(withEndMoved(p, {1, true}, Vec3(1, 0, 0)).error().code == "no-length");
    CHECK(withCutMoved(p, 0, {Vec3::Zero(), Vec3::Zero()}, Vec3::Zero()).error().code == "bad-value");
    CHECK(withCutMoved(p, 0, p.cuts[0].plane, Vec3(-1, 0, 0)).error().code == "no-length");
}

TEST_CASE("edited proposals: a cut that is dropped leaves its bones to what lies behind it; one that is added divides the bone it crosses") {
    const Proposal p = threeBones();
    const auto without = withoutCut(p, 0);
    REQUIRE(checkProposal(*without).has_value());
    CHECK(without->cuts.size() == 1);
    CHECK(without->bones[1].piece == -1);
    CHECK(without->bones[1].startCut == -1);
    CHECK(without->bones[2].piece == 0);
    CHECK(withEndMoved(*without, {0, true}, Vec3(1, 1, 0))->bones[1].start == Vec3(1, 1, 0));

    const auto with = withCutAdded(p, {Vec3(-2, 0, 0), Vec3(1, 0, 0)}, Vec3(-2, 0.1, 0), 0.5, std::nullopt);
    REQUIRE_MESSAGE(with.has_value(), with.error().message);
    REQUIRE(checkProposal(*with).has_value());
    REQUIRE(with->bones.size() == 4);
    CHECK(with->cuts[2].plane.normal == Vec3(-1, 0, 0));  // away from the root
    CHECK(with->cuts[2].piece == "left 2");
    CHECK(with->bones[2].end == Vec3(-2, 0.1, 0));
    CHECK(with->bones[2].piece == 1);
    CHECK(with->bones[3].parent == 2);
    CHECK(with->bones[3].piece == 2);
    CHECK(with->bones[3].end == Vec3(-3, 0, 0));
    CHECK(isPinned(*with, {3, true}));
    CHECK(!isPinned(*with, {2, true}));
    // Without a bone there, a limb gets one, from the nearest joint.
    const auto ear = withCutAdded(p, {Vec3(0.9, 1, 0), Vec3(0, -1, 0)}, Vec3(0.9, 1, 0), 0.2, Vec3(0.9, 2, 0));
    REQUIRE(ear.has_value());
    REQUIRE(checkProposal(*ear).has_value());
    REQUIRE(ear->bones.size() == 5);
    CHECK(ear->cuts[2].plane.normal == Vec3(0, 1, 0));
    CHECK(ear->bones[3].start == Vec3(1, 0, 0));
    CHECK(ear->bones[3].endCut == 2);
    CHECK(ear->bones[4].parent == 3);
    CHECK(ear->bones[4].piece == 2);
    // With the bone before them gone, limbs begin where they were.
    const auto legless = withoutBone(p, 0);
    REQUIRE(checkProposal(*legless).has_value());
    CHECK(legless->bones[0].parent == -1);
    CHECK(legless->bones[0].startCut == 0);
    CHECK(legless->bones[1].startCut == 1);
    CHECK(legless->pins.size() == 2);
}

TEST_CASE("edited proposals: what does not hang together is told") {
    const auto faulty = [](const std::function<void(Proposal&)>& spoil) {
        Proposal p = threeBones();
        spoil(p);
        const auto good = checkProposal(p);
        return good ? std::string() : good.error().code;
    };
    CHECK(faulty([](Proposal&) {}).empty());
    CHECK(faulty([](Proposal& p) { p.cuts[1].name = p.cuts[0].name; }) == "bad-proposal");
    CHECK(faulty([](Proposal& p) { p.cuts[1].piece = p.root; }) == "bad-proposal");
    CHECK(faulty([](Proposal& p) { p.cuts[1].plane.normal.setZero(); }) == "bad-proposal");
    CHECK(faulty([](Proposal& p) { p.bones[0].parent = 1; }) == "bad-proposal");
    CHECK(faulty([](Proposal& p) { p.bones[1].start.x() += 1e-12; }) == "bad-proposal");
    CHECK(faulty([](Proposal& p) { p.bones[1].end = p.bones[1].start; }) == "bad-proposal");
    CHECK(faulty([](Proposal& p) { p.bones[1].endCut = 2; }) == "bad-proposal");
    CHECK(faulty([](Proposal& p) { p.pins[0].bone = 3; }) == "bad-proposal");
    CHECK(faulty([](Proposal& p) { p.handles.push_back({"handle", Vec3::Zero(), 0.0, false}); }) == "bad-proposal");
}

TEST_CASE("edited proposals: all cuts are tried together, and the one in the way of an earlier one is refused") {
    const TriangleMesh body = capsules::animal();
    Proposal p = animalProposal();
    auto tried = tryCuts(body, p);
    REQUIRE(tried.has_value());
    for (const auto& why : tried->refused) CHECK(!why.has_value());
    for (int c = 0; c < static_cast<int>(p.cuts.size()); ++c) CHECK(std::count(tried->piece.begin(), tried->piece.end(), c) > 0);
    ProposedCut same = p.cuts[0];
    same.name = "same", same.piece = "same piece";
    p.cuts.push_back(same);
    same.plane.origin = Vec3(100, 0, 0), same.plane.normal = Vec3(1, 0, 0), same.name = "outside", same.piece = "nothing";
    p.cuts.insert(p.cuts.begin(), same);
    tried = tryCuts(body, p);
    REQUIRE(tried.has_value());
    CHECK(tried->refused.front().value().code == "no-section");
    CHECK(tried->refused.back().value().code == "cuts-touch");
    for (std::size_t c = 1; c + 1 < p.cuts.size(); ++c) CHECK(!tried->refused[c].has_value());
}

TEST_CASE("edited proposals: what is done to one side of a shape that mirrors itself is done to the other") {
    const Proposal p = mirroredByX(threeBones());
    CHECK(mirrorError(p) == 0.0);
    const auto image = [](const Vec3& v) { return Vec3(-v.x(), v.y(), v.z()); };
    const auto moved = withCutMoved(p, 0, {Vec3(1.5, 0.1, 0), Vec3(2, 1, 0)}, Vec3(1.5, 0.125, 0), Sides::Both);
    REQUIRE(moved.has_value());
    CHECK(moved->cuts[1].plane.origin == image(moved->cuts[0].plane.origin));
    CHECK(moved->cuts[1].plane.normal == image(moved->cuts[0].plane.normal));
    CHECK(moved->bones[2].start == Vec3(-1.5, 0.125, 0));
    CHECK(mirrorError(*moved) <= kMirrored);
    CHECK(!(mirrorError(*withCutMoved(p, 0, {Vec3(1.5, 0, 0), Vec3(1, 0, 0)}, Vec3(1.5, 0, 0), Sides::One)) < 1.0));  // infinite
    CHECK(withEndMoved(p, {2, true}, Vec3(-2, 1, 0), Sides::Both)->bones[1].end == Vec3(2, 1, 0));
    CHECK(withoutCut(p, 0, Sides::Both)->cuts.empty());
    CHECK(withoutBone(p, 1, Sides::Both)->bones.size() == 1);
    CHECK(withPinToggled(p, {1, true}, Sides::Both)->pins.empty());

    // A second cut through each limb divides its bone; across the middle there is one cut, at a right angle to the plane of symmetry.
    const auto with = withCutAdded(p, {Vec3(-2, 0, 0), Vec3(1, 0.25, 0)}, Vec3(-2, 0, 0), 0.5, std::nullopt, Sides::Both);
    REQUIRE_MESSAGE(with.has_value(), with.error().message);
    REQUIRE(checkProposal(*with).has_value());
    REQUIRE(with->cuts.size() == 4);
    CHECK(with->cuts[2].piece == "left 2");
    CHECK(with->cuts[3].piece == "right 2");
    CHECK(with->bones.size() == 5);
    CHECK(mirrorError(*with) <= kMirrored);
    Proposal upright = p;
    upright.cuts.clear();
    upright.pins.clear();
    upright.bones = {p.bones[0]};
    upright.bones[0].start = Vec3(0, 0, 0), upright.bones[0].end = Vec3(0, 4, 0), upright.bones[0].startCut = upright.bones[0].endCut = -1;
    const auto neck = withCutAdded(upright, {Vec3(0.1, 2, 0), Vec3(0.2, -1, 0)}, Vec3(0.1, 2, 0), 0.5, std::nullopt, Sides::Both);
    REQUIRE_MESSAGE(neck.has_value(), neck.error().message);
    REQUIRE(neck->cuts.size() == 1);
    CHECK(neck->cuts[0].plane.normal == Vec3(0, 1, 0));
    CHECK(neck->bones[1].start == Vec3(0, 2, 0));
    // Two ears near to each other hang on the head, not one on the other.
    const auto ears = withCutAdded(upright, {Vec3(0.3, 5, 0), Vec3(0, 1, 0)}, Vec3(0.3, 5, 0), 0.2, Vec3(0.3, 6, 0), Sides::Both);
    REQUIRE_MESSAGE(ears.has_value(), ears.error().message);
    REQUIRE(ears->bones.size() == 5);
    CHECK(ears->bones[3].start == Vec3(0, 4, 0));
    CHECK(ears->cuts[0].piece == "trunk 2.L");
    CHECK(ears->cuts[1].piece == "trunk 2.R");
    CHECK(ears->bones[4].name == "trunk 2 bone.R");
    CHECK(ears->bones[4].end == Vec3(-0.3, 6, 0));
    CHECK(withEndMoved(upright, {0, true}, Vec3(1, 3, 0), Sides::Both)->bones[0].end == Vec3(0, 3, 0));
    // What has no mirror image on the same limbs is refused: the middle piece would be the root's on one side only.
    const auto inTrunk = withCutAdded(p, {Vec3(0.5, 0, 0), Vec3(1, 0, 0)}, Vec3(0.5, 0, 0), 0.5, std::nullopt, Sides::Both);
    REQUIRE(!inTrunk.has_value());
    CHECK(inTrunk.error().code == "not-mirrored");
    // Without a symmetry both sides are one.
    CHECK(withCutMoved(threeBones(), 0, {Vec3(1.5, 0, 0), Vec3(1, 0, 0)}, Vec3(1.5, 0, 0), Sides::Both)->cuts[1].plane.origin == p.cuts[1].plane.origin);
}

TEST_CASE("edited proposals: 1,000 random sequences hang together, undo to the start and redo to the end; mirrored ones stay mirrored") {
    Proposal handles;
    for (int h = 0; h < 4; ++h) handles.handles.push_back({"handle " + std::to_string(h), Vec3(h - 1.5, 0, 0), 0.3, false});
    const std::vector<Proposal> starts{animalProposal(), mirroredByX(threeBones()), mirroredByX(handles)};
    RandomEdits random(20260);
    int made = 0, refused = 0, faults = 0, mirrored = 0, oneSided = 0;
    double error = 0.0;
    for (int sequence = 0; sequence < 1000; ++sequence) {
        ProposalHistory history(starts[at(sequence) % starts.size()]);
        std::vector<std::string> states{written(history.now())};
        random.sides = sequence % 2 == 0 ? Sides::Both : Sides::One;
        for (int step = 0; step < 10; ++step) {
            if (random.below(8) == 0 && history.undo()) continue;
            auto changed = random.edit(history.now());
            refused += changed ? 0 : 1;
            oneSided += !changed && changed.error().code == "not-mirrored" ? 1 : 0;
            if (!changed) continue;
            if (random.sides == Sides::Both) error = std::max(error, mirrorError(*changed)), ++mirrored;
            faults += checkProposal(*changed) ? 0 : 1;
            states.resize(history.position() + 1);
            states.push_back(written(*changed));
            history.push(std::move(*changed));
            ++made;
        }
        while (history.redo()) {
        }
        for (std::size_t s = states.size(); s-- > 0;) {
            faults += written(history.now()) == states[s] && history.position() == s ? 0 : 1;
            faults += history.undo() == (s > 0) ? 0 : 1;
        }
        for (std::size_t s = 0; s < states.size(); ++s) {
            faults += written(history.now()) == states[s] ? 0 : 1;
            faults += history.redo() == (s + 1 < states.size()) ? 0 : 1;
        }
        CHECK_MESSAGE(faults == 0, "sequence ", sequence);
        if (faults > 0) break;
    }
    CHECK(made > 5000);
    CHECK(refused < made);
    MESSAGE("mirrored edits: ", mirrored, ", refused as not to be mirrored: ", oneSided, ", largest error: ", error, " of the size");
    CHECK(error <= kMirrored);
    CHECK(oneSided < mirrored / 10);
}
