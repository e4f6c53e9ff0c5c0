// SPDX-License-Identifier: GPL-3.0-or-later
// Cuts and bones from the skeleton of a file.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/body/body.h"
#include "core/proposal/rig_flesh.h"
#include "core/proposal/rig_proposal.h"
#include "core/io/build_result.h"
#include "tests/support/capsules.h"
#include "tests/support/left_out.h"
#include "tests/support/shapes.h"

using namespace imomushi;
namespace fs = std::filesystem;

namespace {

/// Bones by name, parent and head, with nodes to match and guessed tails.
Rig rigOf(const std::vector<std::tuple<std::string, int, Vec3>>& bones) {
    Rig rig;
    for (const auto& [name, parent, head] : bones) {
        RigBone bone;
        bone.name = name;
        bone.parent = parent;
        bone.head = head;
        bone.node = static_cast<std::int32_t>(rig.nodes.size());
        RigNode node;
        node.parent = parent;
        node.translation = parent < 0 ? head : Vec3(head - rig.bones[static_cast<std::size_t>(parent)].head);
        rig.nodes.push_back(node);
        rig.bones.push_back(bone);
    }
    guessTails(rig);
    return rig;
}

/// Each vertex is moved by one bone.
template <class BoneAt>
void bind(Rig& rig, const TriangleMesh& mesh, const BoneAt& boneAt) {
    rig.weights = {};
    rig.weights.first.push_back(0);
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
        rig.weights.bone.push_back(boneAt(Vec3(mesh.vertices.row(v).transpose())));
        rig.weights.weight.push_back(1.0f);
        rig.weights.first.push_back(static_cast<std::int32_t>(v) + 1);
    }
}

/// A bar of 1 x 1 x 12 along z with a root that moves nothing, six bones of 2 m, and three short ones at the tip.
struct Worm {
    TriangleMesh mesh = shapes::box({-0.5, -0.5, 0.0}, {0.5, 0.5, 12.0}, 4, 4, 48).mesh;
    Rig rig = rigOf({{"root", -1, {0, 0, 0}}, {"s1", 0, {0, 0, 0}}, {"s2", 1, {0, 0, 2}}, {"s3", 2, {0, 0, 4}}, {"s4", 3, {0, 0, 6}}, {"s5", 4, {0, 0, 8}}, {"s6", 5, {0, 0, 10}},
                     {"f1", 6, {-0.3, 0, 11.9}}, {"f2", 6, {0, 0, 11.9}}, {"f3", 6, {0.3, 0, 11.9}}, {"ik", -1, {0, 5, 0}}});
    Worm() {
        bind(rig, mesh, [](const Vec3& p) { return p.z() > 11.9 ? (p.x() < -0.2 ? 7 : p.x() > 0.2 ? 9 : 8) : std::min(6, 1 + static_cast<int>(p.z() / 2.0)); });
    }
};

/// What every proposal promises.
void checkSound(const Proposal& proposal, const Rig& rig, const TriangleMesh& body) {
    std::vector<CutPlane> planes;
    std::set<std::string> names;
    for (const ProposedCut& cut : proposal.cuts) {
        planes.push_back(cut.plane);
        CHECK(names.insert(cut.name).second);
        CHECK(names.insert(cut.piece).second);
        CHECK(std::abs(cut.plane.normal.norm() - 1.0) < 1e-9);
    }
    const auto pieces = cutBody(body, planes);
    REQUIRE(pieces.has_value());
    CHECK(pieces->size() == planes.size() + 1);
    REQUIRE(!proposal.bones.empty());
    CHECK(proposal.bones[0].parent == -1);
    std::set<int> pieceHasBone;
    for (std::size_t b = 0; b < proposal.bones.size(); ++b) {
        const ProposedBone& bone = proposal.bones[b];
        CAPTURE(bone.name);
        CHECK(names.insert(bone.name).second);
        CHECK(bone.name.find('/') == std::string::npos);
        REQUIRE(bone.parent < static_cast<int>(b));
        CHECK((bone.parent >= 0) == (b > 0));
        if (bone.parent >= 0) {
            const ProposedBone& parent = proposal.bones[static_cast<std::size_t>(bone.parent)];
            CHECK(bone.start == (bone.fromParentStart ? parent.start : parent.end));
        }
        CHECK((bone.end - bone.start).norm() > 0.0);
        REQUIRE(bone.joint >= 0);
        CHECK((bone.start - rig.bones[static_cast<std::size_t>(bone.joint)].head).norm() < 1e-5 * (body.vertices.colwise().maxCoeff() - body.vertices.colwise().minCoeff()).norm());
        REQUIRE(bone.piece >= -1);
        REQUIRE(bone.piece < static_cast<int>(planes.size()));
        pieceHasBone.insert(bone.piece);
    }
    CHECK(pieceHasBone.size() == planes.size() + 1);
    for (const ProposedMerge& merge : proposal.merged) {
        CHECK(rig.boneIndex(merge.what) >= 0);
        CHECK(!merge.why.empty());
    }
    CHECK(!proposal.pins.empty());
}

}  // namespace

TEST_CASE("flesh of a rig: the share of each bone is the volume that it moves, by skin or by nearness") {
    Worm worm;
    for (const bool skinned : {true, false}) {
        CAPTURE(skinned);
        if (!skinned) worm.rig.weights = {};
        const RigFlesh flesh = rigFlesh(worm.rig, worm.mesh, worm.mesh);
        CHECK(flesh.skinned == skinned);
        CHECK(std::abs(std::accumulate(flesh.share.begin(), flesh.share.end(), 0.0) - 1.0) < 1e-12);
        CHECK(flesh.share[10] == 0.0);
        // Each of the inner bones has 2 of 12 m, give or take a row of vertices (0.25 m), which belongs to one side.
        for (const std::size_t b : {2U, 3U, 4U, 5U}) {
            CHECK(std::abs(flesh.share[b] - 2.0 / 12.0) < 0.25 / 12.0);
            CHECK(std::abs(flesh.middle[b].z() - (2.0 * static_cast<double>(b) - 1.0)) < 0.25);
            CHECK(flesh.middle[b].head<2>().norm() < 1e-9);
        }
    }
}

TEST_CASE("merging a rig: what moves little flesh goes to what carries it, the root to its largest child, and the rest keeps its order") {
    const Worm worm;
    const RigFlesh flesh = rigFlesh(worm.rig, worm.mesh, worm.mesh);
    const auto namesOf = [&](const MergedRig& merged) {
        std::string names;
        for (const int b : merged.kept) names += worm.rig.bones[static_cast<std::size_t>(b)].name + " ";
        return names;
    };
    const MergedRig merged = mergeRig(worm.rig, flesh, 0.05);
    CHECK(namesOf(merged) == "s1 s2 s3 s4 s5 s6 ");
    CHECK(merged.parent == std::vector<int>{-1, 0, 1, 2, 3, 4});
    CHECK(merged.mover == std::vector<int>{0, 0, 1, 2, 3, 4, 5, 5, 5, 5, 0});
    CHECK(std::abs(std::accumulate(merged.share.begin(), merged.share.end(), 0.0) - 1.0) < 1e-12);
    REQUIRE(merged.merges.size() == 5);
    CHECK(merged.merges[0].why == "It moves no flesh.");
    CHECK(merged.merges[1].why.find("less than 5 %") != std::string::npos);
    // Less and less stays, and always something.
    std::size_t before = worm.rig.bones.size();
    for (const double least : {0.0, 0.01, 0.1, 0.2, 0.4, 0.9, 1.0}) {
        const std::size_t kept = mergeRig(worm.rig, flesh, least).kept.size();
        CHECK(kept <= before);
        CHECK(kept >= 1);
        before = kept;
    }
    CHECK(before == 1);
    CHECK(namesOf(mergeRig(worm.rig, flesh, 0.2)) == "s1 s3 s5 ");  // two and two
    CHECK(namesOf(mergeRig(worm.rig, flesh, 0.05, {{3, "It may not."}})) == "s1 s2 s4 s5 s6 ");
}

TEST_CASE("merging a rig: hands of a human and hair that swings stay from a fifth of the least share on") {
    Worm worm;  // f1, f2, f3 have .28 % each
    const auto keptOf = [&] {
        const MergedRig merged = mergeRig(worm.rig, rigFlesh(worm.rig, worm.mesh, worm.mesh), 0.01);
        std::string names;
        for (const int b : merged.kept) names += worm.rig.bones[static_cast<std::size_t>(b)].name + " ";
        return names;
    };
    CHECK(keptOf() == "s1 s2 s3 s4 s5 s6 ");
    worm.rig.bones[7].name = "Hand.L";
    CHECK(keptOf() == "s1 s2 s3 s4 s5 s6 Hand.L ");
    worm.rig.avatar = R"({"springBone": {"springs": [{"joints": [{"bone": "f3"}, {"bone": "f2"}]}]}})";
    CHECK(keptOf() == "s1 s2 s3 s4 s5 s6 Hand.L f3 ");
    // What a file says of its avatar is not believed.
    for (const char* broken : {"{", "[]", "{\"springBone\": 1}", R"({"springBone": {"springs": {"a": 1}}})", R"({"springBone": {"springs": [1, {}, {"joints": []}, {"joints": [1]}, {"joints": [{"bone": 2}]}, {"joints": [{"bone": "none"}]}]}})"}) {
        worm.rig.avatar = broken;
        CHECK(keptOf() == "s1 s2 s3 s4 s5 s6 Hand.L ");
    }
}

TEST_CASE("flesh of a rig: a foot that the file hangs on its root is carried by its leg") {
    const TriangleMesh mesh = shapes::box({-0.5, 0.0, -0.5}, {0.5, 6.0, 0.5}, 4, 24, 4).mesh;
    Rig rig = rigOf({{"root", -1, {0, 0, 0}}, {"body", 0, {0, 6, 0}}, {"thigh", 1, {0, 4, 0}}, {"calf", 2, {0, 2, 0}}, {"foot", 0, {0, 0.5, 0}}, {"toe", 4, {0, 0.2, 0}}, {"target", 0, {0, 3, 3}}});
    bind(rig, mesh, [](const Vec3& p) { return p.y() > 4.0 ? 1 : p.y() > 2.0 ? 2 : p.y() > 0.9 ? 3 : p.y() > 0.3 ? 4 : 5; });
    const RigFlesh flesh = rigFlesh(rig, mesh, mesh);
    CHECK(flesh.carrier == std::vector<int>{-1, 0, 1, 2, 3, 4, 0});
    const MergedRig merged = mergeRig(rig, flesh, 0.1);
    std::string names;
    for (const int b : merged.kept) names += rig.bones[static_cast<std::size_t>(b)].name + " ";
    CHECK(names == "body thigh calf foot ");
    CHECK(merged.parent == std::vector<int>{-1, 0, 1, 2});
    CHECK(merged.mover == std::vector<int>{0, 0, 1, 2, 3, 3, 0});
}

TEST_CASE("proposal from a rig: cuts across the flesh at the joints, bones exactly at the file's") {
    const Worm worm;
    const auto proposal = proposeFromRig(worm.rig, worm.mesh, worm.mesh, 0.05, {});
    REQUIRE(proposal);
    CHECK(proposal->from == Proposal::Source::Skeleton);
    checkSound(*proposal, worm.rig, worm.mesh);
    REQUIRE(proposal->cuts.size() == 5);
    REQUIRE(proposal->bones.size() == 6);
    for (std::size_t c = 0; c < 5; ++c) {
        CHECK((proposal->cuts[c].plane.normal - Vec3::UnitZ()).norm() < 1e-9);
        CHECK(std::abs(proposal->cuts[c].plane.origin.z() - 2.0 * static_cast<double>(c + 1)) <= 0.125 + 1e-9);  // the skin goes over half an edge before the joint
        CHECK(proposal->bones[c].name == "s" + std::to_string(c + 1));
        CHECK(proposal->bones[c].end == worm.rig.bones[c + 2].head);
    }
    CHECK(proposal->bones[5].end.z() > 11.0);
    CHECK(proposal->bones[5].end.z() < 12.0);
    CHECK(proposal->merged.size() == 5);
    CHECK(proposal->merged[0].into == "s1");
    // The same bytes again.
    const auto again = proposeFromRig(worm.rig, worm.mesh, worm.mesh, 0.05, {});
    for (std::size_t c = 0; c < 5; ++c) CHECK(again->cuts[c].plane.origin == proposal->cuts[c].plane.origin);
}

TEST_CASE("proposal from a rig: a trunk leads to each of its limbs, and limbs lie in front of their cuts") {
    // A table of two legs with a neck.
    TriangleMesh boxes;
    std::vector<std::int32_t> part;
    for (const auto& [low, high] : {std::pair(Vec3(-3, -0.5, -0.5), Vec3(3, 0.5, 0.5)), std::pair(Vec3(-2.9, -4, -0.4), Vec3(-2.1, 0, 0.4)), std::pair(Vec3(2.1, -4, -0.4), Vec3(2.9, 0, 0.4)),
                                    std::pair(Vec3(-0.4, 0, -0.4), Vec3(0.4, 3, 0.4))}) {
        const TriangleMesh box = shapes::box(low, high, 6, 6, 6).mesh;
        const Eigen::Index v = boxes.vertices.rows(), t = boxes.triangles.rows();
        boxes.vertices.conservativeResize(v + box.vertices.rows(), 3);
        boxes.vertices.bottomRows(box.vertices.rows()) = box.vertices;
        boxes.triangles.conservativeResize(t + box.triangles.rows(), 3);
        boxes.triangles.bottomRows(box.triangles.rows()) = box.triangles.array() + static_cast<std::int32_t>(v);
        part.resize(static_cast<std::size_t>(boxes.triangles.rows()), part.empty() ? 0 : part.back() + 1);
    }
    const auto body = makeBody(boxes, part, {BodyKind::Mended, 0.0}, {});
    REQUIRE(body);
    Rig rig = rigOf({{"hips", -1, {0, 0, 0}}, {"leg/L", 0, {-2.5, -0.3, 0}}, {"foot/L", 1, {-2.5, -2.5, 0}}, {"leg/R", 0, {2.5, -0.3, 0}}, {"foot/R", 3, {2.5, -2.5, 0}}, {"neck", 0, {0, 0.4, 0}}, {"head", 5, {0, 2, 0}}});
    rig.bones[2].tail = {-2.5, -4, 0};
    rig.bones[4].tail = {2.5, -4, 0};
    rig.bones[6].tail = {0, 3, 0};
    const auto proposal = proposeFromRig(rig, boxes, body->mesh, 0.03, {});
    REQUIRE(proposal);
    checkSound(*proposal, rig, body->mesh);
    std::map<std::string, const ProposedBone*> bones;
    for (const ProposedBone& bone : proposal->bones) bones[bone.name] = &bone;
    for (const char* name : {"hips", "leg-L", "foot-L", "leg-R", "foot-R", "neck", "head"}) REQUIRE_MESSAGE(bones.contains(name), name);
    // Two of the three limbs of the hips have bones of their own that lead to them.
    CHECK(proposal->bones.size() == 9);
    for (const auto& [name, bone] : bones) {
        if (name.find(" to ") == std::string::npos) continue;
        CHECK(bone->start == Vec3(0, 0, 0));
        CHECK(bone->fromParentStart);
        CHECK(bone->piece == -1);
        CHECK(bone->joint == 0);
    }
    CHECK(bones.at("leg-L")->end == rig.bones[2].head);
    for (const ProposedCut& cut : proposal->cuts) {
        CAPTURE(cut.name);
        const std::string limb = cut.name.substr(0, cut.name.find(' '));
        CHECK(cut.plane.normal.dot(bones.at(limb)->end - bones.at(limb)->start) > 0.0);
        CHECK(proposal->cuts[static_cast<std::size_t>(bones.at(limb)->piece)].name == cut.name);
    }
    // Both feet stand on the ground.
    REQUIRE(proposal->pins.size() == 2);
    for (const ProposedPin& pin : proposal->pins) CHECK(proposal->bones[static_cast<std::size_t>(pin.bone)].end.y() < -3.7);
    CHECK(std::any_of(proposal->notes.begin(), proposal->notes.end(), [](const Error& note) { return note.code == "no-skin"; }));
}

TEST_CASE("proposal from a rig: limbs whose heads are at one place hang on one bone that leads there") {
    // Two arms begin in the middle of the chest, as many a file has it; a bone to each would close a loop.
    const TriangleMesh body = capsules::surface({{Vec3(0, 0, 0), Vec3(0, 1.5, 0), 0.25, 0.25}, {Vec3(0, 1.5, 0), Vec3(0, 2.2, 0), 0.15, 0.2}, {Vec3(0, 1.2, 0), Vec3(1.2, 1.2, 0), 0.1, 0.1}, {Vec3(0, 1.2, 0), Vec3(-1.2, 1.2, 0), 0.1, 0.1}}, 0.06);
    Rig rig = rigOf({{"chest", -1, {0, 0.2, 0}}, {"head", 0, {0, 1.7, 0}}, {"arm.L", 0, {0, 1.2, 0}}, {"arm.R", 0, {0, 1.2, 1e-8}}});
    rig.bones[1].tail = Vec3(0, 2.3, 0);
    rig.bones[2].tail = Vec3(1.2, 1.2, 0);
    rig.bones[3].tail = Vec3(-1.2, 1.2, 0);
    bind(rig, body, [](const Vec3& p) { return p.y() > 1.72 ? 1 : p.x() > 0.3 ? 2 : p.x() < -0.3 ? 3 : 0; });
    const auto proposal = proposeFromRig(rig, body, body, 0.01, {});
    REQUIRE(proposal);
    checkSound(*proposal, rig, body);
    CHECK(proposal->cuts.size() == 3);
    REQUIRE(proposal->bones.size() == 5);  // one that leads from the chest to both arms
    std::set<std::pair<int, int>> ends;  // joint points by place
    const auto placed = [&](const Vec3& p) {
        for (int b = 0;; ++b)
            for (const bool atEnd : {false, true})
                if (const ProposedBone& bone = proposal->bones[static_cast<std::size_t>(b)]; ((atEnd ? bone.end : bone.start) - p).norm() < 1e-6) return 2 * b + atEnd;
    };
    for (const ProposedBone& bone : proposal->bones) CHECK(ends.emplace(placed(bone.start), placed(bone.end)).second);
}

TEST_CASE("proposal from a rig: feet are pinned where their flesh stands, whatever their bones end at, also on legs that are not equally long; a tail between them stays free") {
    // The front legs end .04 m above the others, of a height of 1.87 m. Feet look forward from ankles .2 m above the ground.
    std::vector<capsules::Capsule> shape{{Vec3(0, 1.0, -0.6), Vec3(0, 1.0, 0.6), 0.25, 0.25}, {Vec3(0, 1.1, 0.7), Vec3(0, 1.75, 1.2), 0.12, 0.12}, {Vec3(0, 1.1, -0.7), Vec3(0, 0.1, -1.5), 0.09, 0.08}};
    std::vector<std::tuple<std::string, int, Vec3>> bones{{"trunk", -1, {0, 1, -0.5}}, {"neck", 0, {0, 1.2, 0.75}}, {"tail", 0, {0, 0.95, -0.85}}};
    const std::vector<std::array<const char*, 2>> names{{"front.L", "front foot.L"}, {"front.R", "front foot.R"}, {"hind.L", "hind foot.L"}, {"hind.R", "hind foot.R"}};
    for (const auto& name : names) {
        const bool front = &name - names.data() < 2, left = (&name - names.data()) % 2 == 0;
        const double x = left ? 0.22 : -0.22, z = front ? 0.55 : -0.55, up = front ? 0.04 : 0.0;
        shape.push_back({Vec3(x, 0.95, z), Vec3(x, 0.2 + up, z), 0.13, 0.1});
        shape.push_back({Vec3(x, 0.1 + up, z), Vec3(x, 0.1 + up, z + 0.2), 0.1, 0.1});
        bones.emplace_back(name[0], 0, Vec3(x, 0.8, z));
        bones.emplace_back(name[1], static_cast<int>(bones.size()) - 1, Vec3(x, 0.2 + up, z));
    }
    const TriangleMesh body = capsules::surface(shape, 0.05);
    Rig rig = rigOf(bones);
    for (RigBone& bone : rig.bones) {
        if (bone.name.find("foot") != std::string::npos) bone.tail = bone.head + Vec3(0, 0, 0.3);
        if (bone.name == "neck") bone.tail = Vec3(0, 1.85, 1.28);
        if (bone.name == "tail") bone.tail = Vec3(0, 0.1, -1.55);
    }
    bind(rig, body, [](const Vec3& p) {
        const int limb = 3 + (p.z() > 0 ? 0 : 4) + (p.x() > 0 ? 0 : 2);
        if (p.z() < -0.85) return 2;
        if (p.y() > 1.2 && p.z() > 0.6) return 1;
        return p.y() > 0.75 ? 0 : p.y() > 0.22 ? limb : limb + 1;
    });
    const auto proposal = proposeFromRig(rig, body, body, 0.005, {});
    REQUIRE(proposal);
    checkSound(*proposal, rig, body);
    std::set<std::string> pinned;
    for (const ProposedPin& pin : proposal->pins) {
        CHECK(pin.atEnd);
        pinned.insert(proposal->bones[static_cast<std::size_t>(pin.bone)].name);
    }
    CHECK(pinned == std::set<std::string>{"front foot.L", "front foot.R", "hind foot.L", "hind foot.R"});
}

TEST_CASE("shared meshes: proposals from the skeletons of files") {
    if (!fs::exists(IMOMUSHI_SHARED_MESHES)) return leaveOut("no folder " IMOMUSHI_SHARED_MESHES);
    const auto read = [](const std::string& name) {
        const fs::path path = fs::path(IMOMUSHI_SHARED_MESHES) / name;
        std::ifstream file(path, std::ios::binary);
        const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
        ImportRequest request;
        request.path = path;
        request.bonesSuffice = true;
        auto scene = readScene({path, bytes}, SceneUse::Character);
        REQUIRE(scene);
        auto made = buildCharacter(std::move(*scene), request, {});
        REQUIRE(made);
        return std::move(*made);
    };
    const std::pair<const char*, const char*> files[] = {{"Fox.glb", ""},       {"snake-animations.glb", ""}, {"human-zombie.glb", ""}, {"model-spider.glb", "rig-spider.glb"},
                                                         {"model-snake.glb", "rig-snake.glb"}, {"character.glb", ""},        {"Easy_Animated_Enemy_Pack_-_Jan_2019__Frog.fbx", ""}};
    for (const auto& [mesh, bones] : files) {
        CAPTURE(mesh);
        const CharacterFile file = read(mesh);
        const auto body = makeBody(file.renderModel.mesh.body, file.renderModel.part, {}, {});
        REQUIRE(body);
        const Rig rig = *bones ? *read(bones).rig : *file.rig;
        const auto proposal = proposeFromRig(rig, file.renderModel.mesh.body, body->mesh, std::nullopt, {});
        REQUIRE(proposal);
        std::printf("%-28.28s %3d bones, %2d cuts, %2d kept, %2d merged, %2d notes, %d pins\n", mesh, static_cast<int>(rig.bones.size()), static_cast<int>(proposal->cuts.size()),
                    static_cast<int>(proposal->cuts.size()) + 1, static_cast<int>(proposal->merged.size()), static_cast<int>(proposal->notes.size()), static_cast<int>(proposal->pins.size()));
        checkSound(*proposal, rig, body->mesh);
        CHECK(proposal->cuts.size() >= 3);
        CHECK(proposal->cuts.size() < 20);
        CHECK(proposal->merged.size() + proposal->cuts.size() + 1 == rig.bones.size());
        if (std::getenv("IMOMUSHI_PRINT_PROPOSALS")) {
            for (const ProposedBone& b : proposal->bones)
                std::printf("   bone %-28s parent %2d piece %2d  (%.3g %.3g %.3g) (%.3g %.3g %.3g)\n", b.name.c_str(), b.parent, b.piece, b.start.x(), b.start.y(), b.start.z(), b.end.x(), b.end.y(), b.end.z());
            for (const ProposedMerge& m : proposal->merged) std::printf("   %s into %s: %s\n", m.what.c_str(), m.into.c_str(), m.why.c_str());
            for (const Error& n : proposal->notes) std::printf("   note %s: %s\n", n.code.c_str(), n.message.c_str());
        }
    }
}
