// SPDX-License-Identifier: GPL-3.0-or-later
// Characters that a program compressed, and that were renamed: the same figure as the plain file, to the quantisation.
#include <doctest/doctest.h>

#include <cmath>
#include <set>

#include "core/body/body.h"
#include "core/mesh/topology.h"
#include "core/mesh/triangle_tree.h"
#include "tests/io/raw_scene.h"
#include "tests/support/farthest.h"

using namespace imomushi;
using namespace io_test;

namespace {

double extent(const Points& v) { return (v.colwise().maxCoeff() - v.colwise().minCoeff()).maxCoeff(); }

/// How far a place can be from the plain file's: half a step along each axis, of the 13 bits and a sign that places have in these files, and as much again where it was put
/// together with another one.
double within(const Points& plain) { return std::sqrt(3.0) * extent(plain) / 8191.0; }

/// The share of all corners of triangles that each bone moves.
std::vector<double> movedCorners(const CharacterFile& file) {
    const RigWeights& weights = file.rig->weights;
    const Triangles& triangles = file.renderModel.mesh.body.triangles;
    std::vector<double> moves(file.rig->bones.size(), 0.0);
    for (Eigen::Index i = 0; !weights.empty() && i < triangles.size(); ++i) {
        const auto v = static_cast<std::size_t>(triangles.data()[i]);
        for (auto k = static_cast<std::size_t>(weights.first[v]); k < static_cast<std::size_t>(weights.first[v + 1]); ++k)
            moves[static_cast<std::size_t>(weights.bone[k])] += static_cast<double>(weights.weight[k]) / static_cast<double>(triangles.size());
    }
    return moves;
}

/// `moved`: bones whose heads are elsewhere in the twin.
void isTwin(const CharacterFile& twin, const CharacterFile& plain, const std::set<std::string>& moved) {
    const RenderModel &a = twin.renderModel, &b = plain.renderModel;
    CHECK(std::multiset<std::string>(a.parts.begin(), a.parts.end()) == std::multiset<std::string>(b.parts.begin(), b.parts.end()));
    CHECK(a.mesh.body.triangles.rows() == b.mesh.body.triangles.rows());
    CHECK(farthest(a.mesh.body.vertices, b.mesh.body.vertices) <= within(b.mesh.body.vertices));
    CHECK(farthest(b.mesh.body.vertices, a.mesh.body.vertices) <= within(b.mesh.body.vertices));
    CHECK(a.mesh.renderMesh.textures.size() == b.mesh.renderMesh.textures.size());
    REQUIRE(a.morphs.size() == b.morphs.size());
    for (std::size_t i = 0; i < a.morphs.size(); ++i) CHECK(a.morphs[i].name == b.morphs[i].name);
    REQUIRE(twin.rig);
    REQUIRE(plain.rig);
    REQUIRE(twin.rig->bones.size() == plain.rig->bones.size());
    const auto bones = plain.rig->bones.size();
    for (std::size_t i = 0; i < bones; ++i) {
        const RigBone &x = twin.rig->bones[i], &y = plain.rig->bones[i];
        CAPTURE(y.name);
        CHECK(x.name == y.name);
        CHECK(x.parent == y.parent);
        if (!moved.contains(y.name)) CHECK((x.head - y.head).norm() < 1e-6);
    }
    REQUIRE(twin.rig->clips.size() == plain.rig->clips.size());
    for (std::size_t i = 0; i < plain.rig->clips.size(); ++i) {
        const RigClip &x = twin.rig->clips[i], &y = plain.rig->clips[i];
        CHECK(x.name == y.name);
        CHECK(x.seconds == doctest::Approx(y.seconds));
        // Rotations of clips are quantised to 16 bits of a component.
        for (const double part : {0.0, 0.3, 0.8}) {
            const auto p = posedRig(*twin.rig, x, part * y.seconds), q = posedRig(*plain.rig, y, part * y.seconds);
            for (std::size_t k = 0; k < bones; ++k) {
                if (!moved.contains(plain.rig->bones[k].name)) CHECK((p[k].head - q[k].head).norm() < 1e-3);
                CHECK(p[k].rotation.angularDistance(q[k].rotation) < 1e-3);
            }
        }
    }
    // Weights are quantised to 8 bits.
    CHECK(twin.rig->weights.empty() == plain.rig->weights.empty());
    const std::vector<double> m = movedCorners(twin), n = movedCorners(plain);
    for (std::size_t i = 0; i < bones; ++i) CHECK(std::abs(m[i] - n[i]) <= 0.004);
}

/// The farthest vertex of one from the surface of the other. `behind`: vertices of less z are not looked at.
double apart(const TriangleMesh& from, const TriangleMesh& to, double behind) {
    const TriangleTree tree(to);
    double most = 0.0;
    for (Eigen::Index v = 0; v < from.vertices.rows(); ++v)
        if (from.vertices(v, 2) >= behind) most = std::max(most, std::sqrt(tree.nearest(from.vertices.row(v).transpose()).squaredDistance));
    return most;
}

Body bodyOf(const CharacterFile& file, const BodySetting& setting = {}) {
    auto body = makeBody(file.renderModel, &*file.rig, setting, {});
    REQUIRE(body);
    return std::move(*body);
}

}  // namespace

TEST_CASE("twins: characters compressed by Draco or meshopt have joints, parts, clips and the body of the plain file, to the quantisation") {
    // A node that carries nothing but its mesh is moved by the program to where the mesh's grid is.
    const std::set<std::string> atTheirMesh{"Antenna", "Forearm.R", "Foot.L", "Foot.R", "Eyes"};
    for (const std::string name : {"mannequin", "robot", "robot_skinned", "panda", "two_materials", "avatar", "borders", "spider"}) {
        const auto plain = characterAt(kCharacters / (name + ".glb"));
        REQUIRE(plain);
        const Body body = bodyOf(*plain);
        for (const std::string how : {"_draco", "_meshopt", "_quantized"}) {
            const std::string file = name + how + ".glb";
            if (!std::filesystem::exists(kCharacters / file)) continue;  // of one of them there is a file that is quantised alone
            CAPTURE(file);
            const auto twin = characterAt(kCharacters / file);
            REQUIRE_MESSAGE(twin, twin.error().message);
            isTwin(*twin, *plain, file == "robot_meshopt.glb" ? atTheirMesh : std::set<std::string>());
            const Body same = bodyOf(*twin);
            CHECK(same.report.how == body.report.how);
            CHECK(same.report.components == body.report.components);
            CHECK(same.report.links.size() == body.report.links.size());
            // A link may be anywhere where two flat faces are equally far from each other: the same links are asked for.
            BodySetting setting;
            if (!body.report.links.empty()) setting.links = body.report.links;
            const Body a = setting.links ? bodyOf(*twin, setting) : same, b = setting.links ? bodyOf(*plain, setting) : body;
            // Each vertex is where the plain body is; but the panda's tail crosses itself by less than a millimetre, and what mends that depends on the last digit.
            const double quantum = within(plain->renderModel.mesh.body.vertices), behind = name == "panda" ? -0.45 : -1e9;
            CHECK(apart(a.mesh, b.mesh, behind) <= quantum);
            CHECK(apart(b.mesh, a.mesh, behind) <= quantum);
            CHECK(std::abs(meshFacts(same.mesh).volume - meshFacts(body.mesh).volume) <= quantum * surfaceArea(body.mesh));
        }
    }
}

TEST_CASE("twins: a character is what it holds, whatever its file is called") {
    const TestFolder folder;
    for (const auto& [from, to] : {std::pair{"avatar.glb", "avatar.vrm"}, {"panda.glb", "panda.vrm"}, {"avatar_vrm0.vrm", "avatar.glb"}, {"robot_skinned.glb", "robot.gltf"}}) {
        CAPTURE(from);
        const auto a = characterAt(kCharacters / from), b = characterAt(folder.write(to, readFile(kCharacters / from)));
        REQUIRE(a);
        REQUIRE_MESSAGE(b, b.error().message);
        CHECK(a->renderModel.sameVertices(b->renderModel));
        CHECK(a->renderModel.parts == b->renderModel.parts);
        CHECK(a->rig->roles.size() == b->rig->roles.size());
        CHECK(a->rig->avatar == b->rig->avatar);
        CHECK(a->rig->bones.size() == b->rig->bones.size());
        CHECK(a->rig->clips.size() == b->rig->clips.size());
    }
}
