// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/finite.h"
#include "core/io/character_file.h"
#include "tests/io/files.h"
#include "tests/support/left_out.h"

using namespace imomushi;
namespace fs = std::filesystem;

namespace {

/// The simplest reading of a GLB's positions, node by node: each accessor as single precision, its node's own transformation left out.
struct PlainGlb {
    std::vector<double> positions;
    std::size_t triangles = 0;
    bool moved = false;  ///< a node with a mesh and without a skin has a transformation above it
};

PlainGlb plainGlb(const fs::path& path) {
    const std::string bytes = readFile(path);
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, 4);
    const auto json = nlohmann::json::parse(bytes.substr(20, length));
    const char* binary = bytes.data() + 20 + length + 8;
    PlainGlb plain;
    const std::function<void(const nlohmann::json&, bool)> node = [&](const nlohmann::json& at, bool moved) {
        moved = moved || at.contains("matrix") || at.contains("translation") || at.contains("rotation") || at.contains("scale");
        if (at.contains("mesh"))
            for (const auto& primitive : json["meshes"][at["mesh"].get<std::size_t>()]["primitives"]) {
                plain.moved = plain.moved || (moved && !at.contains("skin"));
                const auto& accessor = json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
                const auto& view = json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
                const std::size_t offset = view.value("byteOffset", std::size_t{0}) + accessor.value("byteOffset", std::size_t{0}), stride = view.value("byteStride", std::size_t{12});
                const auto count = accessor["count"].get<std::size_t>();
                for (std::size_t i = 0; i < count; ++i) {
                    float x[3];
                    std::memcpy(x, binary + offset + i * stride, sizeof x);
                    plain.positions.insert(plain.positions.end(), x, x + 3);
                }
                plain.triangles += (primitive.contains("indices") ? json["accessors"][primitive["indices"].get<std::size_t>()]["count"].get<std::size_t>() : count) / 3;
            }
        if (at.contains("children"))
            for (const auto& child : at["children"]) node(json["nodes"][child.get<std::size_t>()], moved);
    };
    for (const auto& root : json["scenes"][json.value("scene", std::size_t{0})]["nodes"]) node(json["nodes"][root.get<std::size_t>()], false);
    return plain;
}

}  // namespace

TEST_CASE("third-party skeletons: bones, skins and clips come as another program counts them") {
    if (!fs::exists(IMOMUSHI_SHARED_MESHES)) return leaveOut("no folder " IMOMUSHI_SHARED_MESHES);
    struct Counts {
        std::size_t bones, clips;
        bool skin;
    };
    // Of the folder's index.md; of character.glb the nodes that its clips move.
    const std::map<std::string, Counts> files = {{"Fox.glb", {24, 3, true}},       {"snake-animations.glb", {28, 8, true}}, {"human-zombie.glb", {42, 0, true}}, {"rig-spider.glb", {56, 0, false}},
                                                 {"rig-snake.glb", {28, 0, false}}, {"character.glb", {7, 4, true}},         {"model-fox.glb", {0, 0, false}},    {"model-dragon.glb", {0, 0, false}}};
    for (const auto& [name, counts] : files) {
        CAPTURE(name);
        ImportRequest request;
        request.path = fs::path(IMOMUSHI_SHARED_MESHES) / name;
        request.bonesSuffice = true;
        const auto file = importCharacter(request, {});
        REQUIRE(file);
        REQUIRE(file->rig.has_value() == (counts.bones > 0));
        if (!file->rig) continue;
        const Rig& rig = *file->rig;
        CHECK(rig.bones.size() == counts.bones);
        CHECK(rig.clips.size() == counts.clips);
        CHECK(rig.weights.empty() == !counts.skin);
        // Each vertex is bound; where the file has a clip of its rest pose, that leaves the bones where they are.
        const auto vertices = static_cast<std::size_t>(file->renderModel.mesh.body.vertices.rows());
        for (std::size_t v = 0; counts.skin && v < vertices; ++v) REQUIRE(rig.weights.first[v] < rig.weights.first[v + 1]);
        const RigClip still{"still", 0.0, {}};
        const auto pose = posedRig(rig, still, 0.0);
        double reach = 0.0;
        for (const RigBone& bone : rig.bones) reach = std::max(reach, (bone.head - rig.bones[0].head).norm());
        for (std::size_t b = 0; b < rig.bones.size(); ++b) {
            CHECK((pose[b].head - rig.bones[b].head).norm() < 1e-9 * reach);
            CHECK(pose[b].rotation.angularDistance(rig.bones[b].rotation) < 1e-6);
        }
    }
}

TEST_CASE("third-party skeletons: the frog of an FBX file") {
    const fs::path path = fs::path(IMOMUSHI_SHARED_MESHES) / "Easy_Animated_Enemy_Pack_-_Jan_2019__Frog.fbx";
    if (!fs::exists(path)) return leaveOut("no file " + path.string());
    ImportRequest request;
    request.path = path;
    const auto file = importCharacter(request, {});
    REQUIRE(file);
    REQUIRE(file->rig);
    const Rig& rig = *file->rig;
    CHECK(rig.bones.size() == 28);
    CHECK(rig.clips.size() == 4);
    // Bones lie within the mesh that they move.
    const Points& vertices = file->renderModel.mesh.body.vertices;
    const Vec3 low = vertices.colwise().minCoeff().transpose(), high = vertices.colwise().maxCoeff().transpose(), room = 0.5 * (high - low);
    std::vector<char> moves(rig.bones.size(), 0);
    for (const std::int32_t bone : rig.weights.bone) moves[static_cast<std::size_t>(bone)] = 1;
    for (std::size_t b = 0; b < rig.bones.size(); ++b) {
        const RigBone& bone = rig.bones[b];
        if (!moves[b]) continue;  // targets of its inverse kinematics stand outside
        CAPTURE(bone.name);
        CHECK(((bone.head - low + room).array() > 0.0).all());
        CHECK(((high + room - bone.head).array() > 0.0).all());
    }
}

TEST_CASE("third-party meshes as characters: each readable file gives its own vertices in order, whatever the surface; the others the right reason") {
    if (!fs::exists(IMOMUSHI_SHARED_MESHES)) return leaveOut("no folder " IMOMUSHI_SHARED_MESHES);
    const std::map<std::string, std::string> refused = {{"empty.obj", "empty-mesh"}, {"rig-snake.glb", "empty-mesh"}, {"rig-spider.glb", "empty-mesh"}, {"malformed.obj", "bad-file"}, {"truncated_chunk_data.glb", "bad-file"}, {"OutOfMemory.off", "unknown-format"}};
    std::set<std::string> read, bitwise;
    for (const auto& entry : fs::directory_iterator(IMOMUSHI_SHARED_MESHES)) {
        const fs::path& path = entry.path();
        const std::string name = path.filename().string(), suffix = path.extension().string();
        if (!std::set<std::string>{".obj", ".stl", ".glb", ".fbx", ".off"}.contains(suffix)) continue;
        CAPTURE(name);
        ImportRequest request;
        request.path = path;
        const auto file = importCharacter(request, {});
        if (!file) {
            REQUIRE(refused.contains(name));
            CHECK(file.error().code == refused.at(name));
            continue;
        }
        REQUIRE(!refused.contains(name));
        read.insert(name);
        const RenderModel& model = file->renderModel;
        const TriangleMesh& body = model.mesh.body;
        CHECK(allFinite(body.vertices));
        CHECK(model.mesh.renderMesh.triangles.rows() == body.triangles.rows());
        CHECK(model.part.size() == static_cast<std::size_t>(body.triangles.rows()));
        if (suffix == ".obj") {
            CHECK(io_test::sameBits(body.vertices, io_test::plainObj(path).vertices));
            bitwise.insert(name);
        } else if (suffix == ".glb") {
            const PlainGlb plain = plainGlb(path);
            const auto vertices = static_cast<Eigen::Index>(plain.positions.size() / 3);
            CHECK(body.vertices.rows() == vertices);
            CHECK(body.triangles.rows() == static_cast<Eigen::Index>(plain.triangles));
            if (plain.moved) continue;
            CHECK(io_test::sameBits(body.vertices, Eigen::Map<const Points>(plain.positions.data(), vertices, 3)));
            bitwise.insert(name);
        }
        // Counts from the folder's index.md, which another program made.
        if (name == "soup.stl") CHECK(body.vertices.rows() == 300);
        if (name == "multibody.stl") CHECK(body.vertices.rows() == 96 - 76);
        if (suffix == ".fbx") CHECK(body.triangles.rows() == 4920);
        if (name == "character.glb") {
            CHECK(body.vertices.rows() == 1038);
            CHECK(model.parts == std::vector<std::string>{"leg-left", "leg-right", "torso", "arm-left", "arm-right", "antenna"});
        }
    }
    CHECK(read.size() >= 27);
    for (const char* name : {"Easy_Animated_Enemy_Pack_-_Jan_2019__Frog.fbx", "Fox.glb", "character.glb", "model-dragon.glb", "triple_vierbein.obj", "moebius.obj", "soup.stl"}) CHECK(read.contains(name));
    for (const char* name : {"Fox.glb", "human-zombie.glb", "snake-animations.glb", "model-dragon.glb", "penguin.obj"}) CHECK(bitwise.contains(name));  // three have skins
}
