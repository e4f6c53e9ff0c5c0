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

TEST_CASE("third-party meshes as characters: each readable file gives its own vertices in order, whatever the surface; the others the right reason") {
    if (!fs::exists(IMOMUSHI_SHARED_MESHES)) {
        MESSAGE("skipped: no folder " IMOMUSHI_SHARED_MESHES);
        return;
    }
    setImportWorker(IMOMUSHI_TEST_IMPORT_WORKER);
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
