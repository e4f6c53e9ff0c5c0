// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include "core/body/body.h"
#include "core/proposal/fit_cuts.h"
#include "core/proposal/mirror_plane.h"
#include "core/proposal/proposal_mirror.h"
#include "core/proposal/shape_proposal.h"
#include "core/proposal/surface_tips.h"
#include "core/io/build_result.h"
#include "core/mesh/bounds.h"
#include "core/mesh/health.h"
#include "tests/support/capsules.h"
#include "tests/support/left_out.h"
#include "tests/support/shapes.h"

using namespace imomushi;
namespace fs = std::filesystem;

namespace {

Proposal proposed(const TriangleMesh& body, double least = kLeastShare) {
    auto made = proposeFromShape(body, least, {});
    REQUIRE_MESSAGE(made.has_value(), made.error().message);
    return std::move(*made);
}

std::vector<CutPlane> planesOf(const Proposal& proposal) {
    std::vector<CutPlane> planes;
    for (const ProposedCut& cut : proposal.cuts) planes.push_back(cut.plane);
    return planes;
}

/// Whether a direction looks along another, to within an angle in degrees.
bool along(const Vec3& a, const Vec3& b, double degrees) { return a.normalized().dot(b.normalized()) >= std::cos(degrees * std::numbers::pi / 180.0); }

/// What every proposal promises of itself and of the body.
void checkProposal(const TriangleMesh& body, const Proposal& proposal) {
    const double size = diagonalOf(body.vertices);
    std::set<std::string> names;
    for (const ProposedCut& cut : proposal.cuts) {
        CHECK(names.insert(cut.name).second);
        CHECK(names.insert(cut.piece).second);
    }
    const auto pieces = cutBody(body, planesOf(proposal));
    REQUIRE_MESSAGE(pieces.has_value(), pieces.error().message);
    if (!proposal.cuts.empty()) CHECK(pieces->size() == proposal.cuts.size() + 1);
    const int cuts = static_cast<int>(proposal.cuts.size());
    for (int b = 0; b < static_cast<int>(proposal.bones.size()); ++b) {
        const ProposedBone& bone = proposal.bones[static_cast<std::size_t>(b)];
        CAPTURE(bone.name);
        CHECK(names.insert(bone.name).second);
        CHECK(bone.parent < b);
        if (bone.parent >= 0) {
            const ProposedBone& parent = proposal.bones[static_cast<std::size_t>(bone.parent)];
            CHECK(bone.start == (bone.fromParentStart ? parent.start : parent.end));
        } else {
            CHECK(b == 0);  // one tree
        }
        CHECK((bone.end - bone.start).norm() > 1e-3 * size);
        for (const int cut : {bone.startCut, bone.endCut, bone.piece}) CHECK((cut >= -1 && cut < cuts));
        if (bone.endCut >= 0) CHECK(bone.end == proposal.cuts[static_cast<std::size_t>(bone.endCut)].plane.origin);
    }
    if (proposal.bones.empty())
        CHECK(!proposal.handles.empty());
    else
        CHECK(!proposal.pins.empty());
}

int count(const Proposal& proposal, const std::string& begin) {
    return static_cast<int>(std::count_if(proposal.cuts.begin(), proposal.cuts.end(), [&](const ProposedCut& cut) { return cut.piece.starts_with(begin); }));
}

/// A heavy animal, 2 m long, on short legs, with what a skeleton loses: a short tail (.15 m out of the rump), ears and horns on a head whose neck is hardly thinner than it is.
TriangleMesh calf() {
    std::vector<capsules::Capsule> body{{Vec3(0, 0.8, -0.5), Vec3(0, 0.85, 0.4), 0.36, 0.34},
                                        {Vec3(0, 0.9, 0.4), Vec3(0, 1.4, 0.7), 0.24, 0.2},
                                        {Vec3(0, 1.5, 0.7), Vec3(0, 1.4, 1.0), 0.27, 0.2},
                                        {Vec3(0, 0.95, -0.8), Vec3(0, 0.9, -1.0), 0.07, 0.03}};
    for (const double x : {-1.0, 1.0}) {
        for (const double z : {-0.55, 0.4}) body.push_back({Vec3(0.2 * x, 0.7, z), Vec3(0.24 * x, 0.13, z), 0.16, 0.13});
        body.push_back({Vec3(0.2 * x, 1.6, 0.6), Vec3(0.48 * x, 1.66, 0.55), 0.07, 0.05});
        body.push_back({Vec3(0.1 * x, 1.7, 0.75), Vec3(0.15 * x, 1.95, 0.75), 0.05, 0.03});
    }
    return capsules::surface(body, 0.03, 0.03);
}

TriangleMesh ofDiagonal1(TriangleMesh mesh) {
    mesh.vertices /= diagonalOf(mesh.vertices);
    return mesh;
}

}  // namespace

TEST_CASE("surface tips: what stands out of a surface, and nothing of what is round") {
    TriangleMesh egg = shapes::sphere(1.0, 4).mesh;
    for (const double longer : {1.0, 1.4, 1.4}) {
        egg.vertices.col(2) *= longer;
        for (const SurfaceTip& tip : findSurfaceTips(ofDiagonal1(egg)).tips) CHECK(tip.line.empty());
    }
    const TriangleMesh body = ofDiagonal1(capsules::starfish());
    const SurfaceTips found = findSurfaceTips(body);
    CHECK(found.tips.size() == 5);
    for (const SurfaceTip& tip : found.tips) {
        REQUIRE(tip.line.size() > 2);
        // From the middle of an arm, which is in the plane y = 0 and leads outward, to its end.
        for (std::size_t i = 1; i < tip.line.size(); ++i) {
            CHECK(std::abs(tip.line[i].y()) < 0.05);
            CHECK(tip.line[i].norm() > tip.line[i - 1].norm());
        }
        CHECK(found.tipOf[static_cast<std::size_t>(tip.vertex)] == &tip - found.tips.data());
        CHECK(tip.share < 0.3);
    }
    CHECK(findSurfaceTips({}).tips.empty());
}

TEST_CASE("proposals: limbs that a skeleton loses are found on the surface") {
    const TriangleMesh body = calf();
    const Proposal proposal = proposed(body);
    checkProposal(body, proposal);
    REQUIRE(proposal.symmetry.has_value());
    CHECK(mirrorError(proposal) <= kMirrored);
    for (const char* piece : {"head", "tail"}) CHECK_MESSAGE(count(proposal, piece) > 0, piece);
    // Each is cut off where it leaves the rest: the tip of each lies in a piece that is small, and in another one than the others.
    const auto pieces = cutBody(body, planesOf(proposal));
    REQUIRE(pieces.has_value());
    const auto pieceAt = [&](const Vec3& place) {
        std::size_t nearest = 0;
        double least = HUGE_VAL;
        for (std::size_t p = 0; p < pieces->size(); ++p)
            if (const double d = ((*pieces)[p].body.vertices.rowwise() - place.transpose()).rowwise().squaredNorm().minCoeff(); d < least) least = d, nearest = p;
        return nearest;
    };
    const std::vector<std::pair<Vec3, double>> tips = {{Vec3(0, 0.9, -1.03), 0.01},     {Vec3(0.53, 1.66, 0.55), 0.015}, {Vec3(-0.53, 1.66, 0.55), 0.015},
                                                       {Vec3(0.15, 1.98, 0.75), 0.01}, {Vec3(-0.15, 1.98, 0.75), 0.01}, {Vec3(0, 1.4, 1.2), 0.3},
                                                       {Vec3(0.24, 0, 0.4), 0.1},      {Vec3(-0.24, 0, -0.55), 0.1}};
    std::set<std::size_t> different;
    for (const auto& [tip, most] : tips) {
        CAPTURE(tip.transpose());
        const std::size_t piece = pieceAt(tip);
        CHECK(different.insert(piece).second);
        CHECK(meshFacts((*pieces)[piece].body).volume < most * meshFacts(body).volume);
    }
    CHECK(proposal.pins.size() == 4);
}

TEST_CASE("proposals: the arms of a starfish are cut where they leave its middle") {
    const TriangleMesh body = capsules::starfish();
    const Proposal proposal = proposed(body);
    checkProposal(body, proposal);
    CHECK(proposal.handles.empty());
    // Five bones leave the middle, one for each arm, each to a cut across that arm outside the ball of .25 m, and further ones follow out to the tip.
    for (int k = 0; k < 5; ++k) {
        const double a = 2.0 * std::numbers::pi * k / 5.0;
        const Vec3 arm(std::sin(a), 0, std::cos(a));
        CAPTURE(k);
        double nearest = HUGE_VAL, farthest = 0.0;
        for (const ProposedCut& cut : proposal.cuts) {
            if (!along(cut.plane.origin, arm, 20.0)) continue;
            CHECK(along(cut.plane.normal, arm, 20.0));
            nearest = std::min(nearest, cut.plane.origin.norm());
        }
        for (const ProposedBone& bone : proposal.bones)
            if (along(bone.end, arm, 10.0)) farthest = std::max(farthest, bone.end.norm());
        CHECK(nearest > 0.2);
        CHECK(nearest < 0.55);
        CHECK(farthest > 0.9);
        CHECK(farthest < 1.08);
    }
    REQUIRE(proposal.symmetry.has_value());
    CHECK(mirrorError(proposal) <= kMirrored);
    CHECK(proposal.pins.size() == 1);  // it lies on the ground as a whole: held in the middle
}

TEST_CASE("proposals: a snake is divided by its length over twice its thickness") {
    const TriangleMesh body = capsules::snake();
    const Proposal proposal = proposed(body);
    checkProposal(body, proposal);
    // The middle line is 6.5 m long, with both caps 6.8 m: 11.3 lengths of .6 m, an odd number of pieces.
    CHECK(proposal.cuts.size() >= 10);
    CHECK(proposal.cuts.size() <= 12);
    for (const ProposedCut& cut : proposal.cuts) {
        const double z = cut.plane.origin.z();
        CHECK(std::abs(cut.plane.origin.x() - 0.4 * std::sin(1.5 * z)) < 0.04);
        CHECK(std::abs(cut.plane.origin.y() - 0.15) < 0.03);
        const Vec3 tangent(0.6 * std::cos(1.5 * z), 0, 1);
        CHECK((along(cut.plane.normal, tangent, 20.0) || along(-cut.plane.normal, tangent, 20.0)));
    }
    CHECK(proposal.bones.size() == proposal.cuts.size() + 1);
    CHECK(proposal.pins.size() == 1);
}

TEST_CASE("proposals: an animal has legs on the ground, a head and a tail, and is its own mirror image") {
    const TriangleMesh body = capsules::animal();
    const Proposal proposal = proposed(body);
    checkProposal(body, proposal);
    REQUIRE(proposal.symmetry.has_value());
    CHECK((proposal.symmetry->normal - Vec3::UnitX()).norm() < 1e-9);
    CHECK(std::abs(proposal.symmetry->origin.x()) < 0.01);
    CHECK(mirrorError(proposal) <= kMirrored);
    for (const char* piece : {"leg 1", "leg 2", "head", "tail"}) CHECK_MESSAGE(count(proposal, piece) > 0, piece);
    // Legs are cut below the trunk, which reaches down to y = .75, and their ends are pinned near the ground.
    for (const ProposedCut& cut : proposal.cuts)
        if (cut.piece.starts_with("leg")) {
            CHECK(cut.plane.origin.y() < 0.85);
            CHECK(along(cut.plane.normal, -Vec3::UnitY(), 25.0));
        }
    REQUIRE(proposal.pins.size() == 4);
    for (const ProposedPin& pin : proposal.pins) {
        CHECK(pin.atEnd);
        CHECK(proposal.bones[static_cast<std::size_t>(pin.bone)].end.y() < 0.15);
    }
    // No limb is cut twice at the same place, and the trunk keeps most of the flesh.
    const auto pieces = cutBody(body, planesOf(proposal));
    REQUIRE(pieces.has_value());
    double largest = 0.0;
    for (const BodyPiece& piece : *pieces) largest = std::max(largest, meshFacts(piece.body).volume);
    CHECK(largest > 0.4 * meshFacts(body).volume);

    SUBCASE("its size changes nothing") {
        TriangleMesh large = body;
        large.vertices *= 1024.0;  // exact
        const Proposal other = proposed(large);
        REQUIRE(other.cuts.size() == proposal.cuts.size());
        for (std::size_t c = 0; c < other.cuts.size(); ++c) CHECK((other.cuts[c].plane.origin - 1024.0 * proposal.cuts[c].plane.origin).norm() < 1e-6 * 1024.0);
    }
    SUBCASE("it is the same again, whatever was in memory") {
        const std::vector<std::vector<double>> other(1000, std::vector<double>(77, 1.0));
        const Proposal again = proposed(body);
        REQUIRE(again.cuts.size() == proposal.cuts.size());
        REQUIRE(again.bones.size() == proposal.bones.size());
        for (std::size_t c = 0; c < again.cuts.size(); ++c) {
            CHECK(again.cuts[c].plane.origin == proposal.cuts[c].plane.origin);
            CHECK(again.cuts[c].plane.normal == proposal.cuts[c].plane.normal);
            CHECK(again.cuts[c].name == proposal.cuts[c].name);
        }
        for (std::size_t b = 0; b < again.bones.size(); ++b) CHECK(again.bones[b].end == proposal.bones[b].end);
    }
    SUBCASE("a larger least share leaves small pieces with their neighbours") {
        const Proposal few = proposed(body, 0.03);
        CHECK(few.cuts.size() < proposal.cuts.size());
        checkProposal(body, few);
    }
}

TEST_CASE("proposals: shapes without limbs get handles") {
    for (const TriangleMesh& body : {shapes::sphere(1.0, 3).mesh, shapes::torus(1.0, 0.3, 32, 16).mesh}) {
        const Proposal proposal = proposed(body);
        CHECK(proposal.cuts.empty());
        CHECK(proposal.bones.empty());
        REQUIRE(proposal.handles.size() >= 2);
        REQUIRE(proposal.symmetry.has_value());
        CHECK(mirrorError(proposal) <= kMirrored);
        const double size = diagonalOf(body.vertices);
        for (const ProposedHandle& handle : proposal.handles) {
            CHECK(handle.radius > 0.0);
            CHECK((body.vertices.rowwise() - handle.point.transpose()).rowwise().norm().minCoeff() < 0.2 * size);
        }
        CHECK(std::count_if(proposal.handles.begin(), proposal.handles.end(), [](const ProposedHandle& h) { return h.pinned; }) <= 1);
    }
}

TEST_CASE("proposals: bad bodies are refused") {
    TriangleMesh open = capsules::animal();
    open.triangles.conservativeResize(open.triangles.rows() - 1, 3);
    const auto refused = proposeFromShape(open, kLeastShare, {});
    REQUIRE(!refused.has_value());
    CHECK(refused.error().code == "not-closed");
    CHECK(proposeFromShape({}, kLeastShare, {}).error().code == "not-closed");
    const TriangleMesh body = capsules::animal();
    std::stop_source stop;
    stop.request_stop();
    const auto cancelled = proposeFromShape(body, kLeastShare, Progress({}, stop.get_token()));
    REQUIRE(!cancelled.has_value());
    CHECK(cancelled.error().code == kCancelled);
}

TEST_CASE("proposals: cuts that do not work are moved or left out with the reason") {
    const TriangleMesh bar = shapes::box({-0.5, -0.5, 0.0}, {0.5, 0.5, 12.0}, 3, 3, 30).mesh;
    const auto at = [](double z) { return CutPlane{Vec3(0, 0, z), Vec3::UnitZ()}; };
    const std::vector<WishedCut> wished = {{at(3.0), 0.5, -1, {}},
                                           {at(3.0), 0.5, -1, {}},           // on the first
                                           {at(20.0), 0.5, -1, {}},          // beside the body
                                           {{Vec3(0, 0, 8), -Vec3::UnitZ()}, 0.5, -1, Vec3(0, 0, 12)},  // the tip lies behind it
                                           {at(11.9999), 0.0, -1, {}}};      // nothing to speak of in front of it
    const auto fitted = fitCuts(bar, wished, std::nullopt, 1e-3, {});
    REQUIRE_MESSAGE(fitted.has_value(), fitted.error().message);
    // The second one is moved along until the two do not touch; the slab between them is too small then.
    CHECK((*fitted)[0].moved == 0.0);
    CHECK((*fitted)[1].code == "cuts-touch");
    CHECK((*fitted)[0].kept != (*fitted)[1].kept);
    CHECK((*fitted)[2].code == "no-section");
    CHECK(!(*fitted)[2].kept);
    CHECK((*fitted)[3].code == "other-limb");
    CHECK(!(*fitted)[3].kept);
    CHECK(!(*fitted)[4].kept);
    std::vector<CutPlane> kept;
    for (const FittedCut& cut : *fitted) {
        if (!cut.kept || cut.moved != 0.0) CHECK(!cut.why.empty());
        if (cut.kept) kept.push_back(cut.plane);
    }
    CHECK(cutBody(bar, kept).has_value());
}

TEST_CASE("mirror planes: found where they are, in any direction, and only there") {
    const TriangleMesh body = capsules::animal();
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    TriangleMesh turned = body;
    turned.vertices = (body.vertices * turn.transpose()).rowwise() + Eigen::RowVector3d(3, -2, 1);
    const auto plane = findMirrorPlane(turned);
    REQUIRE(plane.has_value());
    const Vec3 expected = turn * Vec3::UnitX();
    CHECK(std::abs(plane->normal.dot(expected)) > 0.9999);
    CHECK(std::abs(plane->normal.dot(Vec3(3, -2, 1) - plane->origin)) < 0.02);
    // Bent to one side it has none.
    TriangleMesh bent = body;
    for (Eigen::Index v = 0; v < bent.vertices.rows(); ++v) bent.vertices(v, 0) += 0.3 * bent.vertices(v, 2) * bent.vertices(v, 2);
    CHECK(!findMirrorPlane(bent).has_value());
}

TEST_CASE("proposals: characters of other people") {
    if (!fs::exists(IMOMUSHI_SHARED_MESHES)) return leaveOut("no folder " IMOMUSHI_SHARED_MESHES);
    struct Expected {
        const char* file;
        std::vector<std::string> pieces;  ///< beginnings of names that there must be
        bool symmetric;
    };
    const std::vector<Expected> all = {{"penguin.obj", {"leg", "arm", "tail", "head"}, true},
                                       {"scorpion_low_resolution.obj", {"leg 1", "leg 2", "leg 3", "leg 4", "arm"}, true},
                                       {"cat-low-resolution.obj", {"leg 1", "leg 2", "leg 3", "limb 1", "limb 2"}, false},
                                       {"model-dragon.glb", {"leg 1", "leg 2", "arm", "tail", "head", "head part 1", "head part 2"}, true},
                                       {"model-fox.glb", {"leg 1", "leg 2", "tail", "head", "head part 1"}, true},
                                       {"model-horse.glb", {"leg 1", "leg 2", "tail", "head", "head part 1"}, true},
                                       {"model-snake.glb", {"front", "middle", "back"}, true},
                                       {"model-spider.glb", {"leg"}, true},
                                       {"human-zombie.glb", {"leg", "arm", "head"}, true},
                                       {"Fox.glb", {"leg"}, true},
                                       {"character.glb", {"leg", "arm"}, true},
                                       {"spot.obj", {"leg 1", "leg 2", "head", "tail", "head part 1", "head part 2"}, true},
                                       {"spot_low_resolution.obj", {"leg 1", "leg 2", "head", "head part 1"}, true},
                                       {"koala_low_resolution.obj", {"leg 1", "leg 2", "head"}, true},
                                       {"fish_low_resolution.obj", {}, true}};
    for (const Expected& expected : all) {
        CAPTURE(expected.file);
        const fs::path path = fs::path(IMOMUSHI_SHARED_MESHES) / expected.file;
        std::ifstream file(path, std::ios::binary);
        const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
        const auto scene = readScene({path, bytes});
        REQUIRE(scene.has_value());
        const auto body = makeBody(scene->surface.mesh.body, scene->surface.part, {}, {});
        REQUIRE(body.has_value());
        const Proposal proposal = proposed(body->mesh);
        checkProposal(body->mesh, proposal);
        CHECK(!proposal.cuts.empty());
        CHECK(proposal.symmetry.has_value() == expected.symmetric);
        CHECK(mirrorError(proposal) <= kMirrored);
        MESSAGE(std::string(expected.file), ": ", proposal.cuts.size(), " cuts, off its mirror image by ", mirrorError(proposal), " of the size");
        // Whose feet stand, a heel left to the trunk or not.
        const std::map<std::string, std::size_t> pins = {{"penguin.obj", 2}, {"spot.obj", 4}, {"model-horse.glb", 4}};
        if (const auto known = pins.find(expected.file); known != pins.end()) CHECK(proposal.pins.size() == known->second);
        for (const std::string& piece : expected.pieces) CHECK_MESSAGE((piece == proposal.root || count(proposal, piece) > 0), piece);
    }
}
