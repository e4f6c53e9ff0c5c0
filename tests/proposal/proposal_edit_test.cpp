// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "core/mesh/bounds.h"
#include "core/proposal/proposal_edit.h"
#include "core/proposal/shape_proposal.h"
#include "tests/support/capsules.h"
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

/// A trunk from x = -1 to 1 with a cut at both ends, each with a limb and its bone.
Proposal threeBones() {
    Proposal p;
    p.root = "trunk";
    p.cuts = {{"right cut", "right", {Vec3(1, 0, 0), Vec3(1, 0, 0)}}, {"left cut", "left", {Vec3(-1, 0, 0), Vec3(-1, 0, 0)}}};
    ProposedBone bone;
    bone.name = "trunk bone", bone.start = Vec3(-1, 0, 0), bone.end = Vec3(1, 0, 0), bone.startCut = 1, bone.endCut = 0;
    p.bones.push_back(bone);
    bone = {};
    bone.name = "right bone", bone.parent = 0, bone.start = Vec3(1, 0, 0), bone.end = Vec3(3, 0, 0), bone.piece = bone.startCut = 0;
    p.bones.push_back(bone);
    bone = {};
    bone.name = "left bone", bone.parent = 0, bone.fromParentStart = true, bone.start = Vec3(-1, 0, 0), bone.end = Vec3(-3, 0, 0), bone.piece = bone.startCut = 1;
    p.bones.push_back(bone);
    p.pins = {{1, true}, {2, true}};
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

TEST_CASE("edited proposals: 1,000 random sequences hang together, undo to the start and redo to the end") {
    Proposal handles;
    for (int h = 0; h < 4; ++h) handles.handles.push_back({"handle " + std::to_string(h), Vec3(h, 0, 0), 0.3, false});
    const std::vector<Proposal> starts{animalProposal(), threeBones(), handles};
    RandomEdits random(20260);
    int made = 0, refused = 0, faults = 0;
    for (int sequence = 0; sequence < 1000; ++sequence) {
        ProposalHistory history(starts[at(sequence) % starts.size()]);
        std::vector<std::string> states{written(history.now())};
        for (int step = 0; step < 10; ++step) {
            if (random.below(8) == 0 && history.undo()) continue;
            auto changed = random.edit(history.now());
            refused += changed ? 0 : 1;
            if (!changed) continue;
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
}
