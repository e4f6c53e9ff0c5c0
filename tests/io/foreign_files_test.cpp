// SPDX-License-Identifier: GPL-3.0-or-later
// Clips by pointers, empty takes, and files that are not read: each says what it is and what to do.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "tests/io/glb.h"
#include "tests/io/raw_scene.h"
#include "tests/support/thorough.h"

using namespace imomushi;
using namespace io_test;
namespace fs = std::filesystem;

namespace {

Result<CharacterFile> pointerClip(const std::function<void(nlohmann::json&)>& change) {
    auto json = nlohmann::json::parse(readFile(kCharacters / "pointer_clip.gltf"));
    change(json);
    const TestFolder folder;
    return characterAt(folder.write("a.gltf", json.dump()), true);
}

bool says(const CharacterFile& file, const char* code) {
    return std::any_of(file.issues.begin(), file.issues.end(), [&](const MeshIssue& i) { return i.code == code; });
}

/// A triangle as a glTF file of one primitive.
Glb triangleFile() {
    Glb glb;
    const int p = glb.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
    glb.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", p}}}}}}}};
    glb.json["nodes"] = {{{"mesh", 0}, {"name", "it"}}};
    glb.json["scenes"] = {{{"nodes", {0}}}};
    return glb;
}

}  // namespace

TEST_CASE("KHR_animation_pointer: weights and rotations of nodes are a clip like any other") {
    const auto file = characterAt(kCharacters / "pointer_clip.gltf", true);
    REQUIRE(file);
    REQUIRE(file->rig);
    REQUIRE(file->rig->clips.size() == 1);
    const RigClip& clip = file->rig->clips[0];
    CHECK(clip.name == "pointers");
    CHECK(clip.tracks.size() == 1);
    CHECK(clip.tracks[0].path == RigTrack::Path::Rotation);
    REQUIRE(clip.morphs.size() == 2);
    // The same clip as channels of nodes.
    const auto plain = pointerClip([](auto& j) {
        for (auto& channel : j["animations"][0]["channels"]) {
            const std::string pointer = channel["target"]["extensions"]["KHR_animation_pointer"]["pointer"];
            channel["target"] = {{"node", pointer[7] - '0'}, {"path", pointer.substr(9)}};
        }
    });
    REQUIRE(plain);
    REQUIRE(plain->rig);
    REQUIRE(plain->rig->clips.size() == 1);
    CHECK(plain->rig->clips[0].tracks[0].values == clip.tracks[0].values);
    CHECK(plain->rig->clips[0].morphs[1].weights == clip.morphs[1].weights);
    CHECK(plain->rig->clips[0].morphs[1].target == clip.morphs[1].target);
    CHECK(plain->rig->bones.size() == file->rig->bones.size());

    // By the mesh instead of its node.
    const auto byMesh = pointerClip([](auto& j) { j["animations"][0]["channels"][0]["target"]["extensions"]["KHR_animation_pointer"]["pointer"] = "/meshes/0/weights"; });
    REQUIRE(byMesh);
    CHECK(byMesh->rig->clips[0].morphs.size() == 2);
    // What is no part of a figure is left out and told; the rest comes.
    const auto light = pointerClip([](auto& j) { j["animations"][0]["channels"][0]["target"]["extensions"]["KHR_animation_pointer"]["pointer"] = "/materials/0/pbrMetallicRoughness/baseColorFactor"; });
    REQUIRE(light);
    CHECK(light->rig->clips[0].morphs.empty());
    CHECK(light->rig->clips[0].tracks.size() == 1);
    CHECK(says(*light, "clip-pointers"));
    const auto missing = pointerClip([](auto& j) { j["animations"][0]["channels"][1]["target"]["extensions"]["KHR_animation_pointer"]["pointer"] = "/nodes/17/rotation"; });
    REQUIRE(missing);
    CHECK(says(*missing, "clip"));
    for (const char* odd : {"", "/", "nodes/0/weights", "/nodes/-1/weights", "/nodes/99999999999999999999/weights", "/nodes/0/weights/x", "/nodes/0/weights/7", "/nodes/0/rotation/1", "/nodes//weights", "/meshes/0/rotation"}) {
        CAPTURE(odd);
        CHECK(pointerClip([&](auto& j) { j["animations"][0]["channels"][0]["target"]["extensions"]["KHR_animation_pointer"]["pointer"] = odd; }));
    }
}

TEST_CASE("an empty first take is skipped, one that moves something is not") {
    const auto file = characterAt(kCharacters / "mannequin.glb", true);
    REQUIRE(file);
    REQUIRE(file->rig->clips.size() == 1);
    CHECK(file->rig->clips[0].name == "wave");
    CHECK(says(*file, "clip-empty"));
}

TEST_CASE("files that cannot be read say what they are and what to do") {
    const auto check = [](const char* name, const std::string& bytes, const char* expected, const char* part) {
        const auto r = scene(name, bytes);
        CAPTURE(name);
        CAPTURE(said(r));
        CHECK(code(r) == expected);
        CHECK(said(r).find(part) != std::string::npos);
        CHECK(said(r).find(": ") != std::string::npos);  // what to do
    };
    check("old.gltf", R"({"asset": {"version": "1.0"}, "meshes": {"m": {}}})", "old-gltf", "glTF version '1.0'");
    check("older.gltf", R"({"techniques": {}, "meshes": {"m": {}}})", "old-gltf", "glTF version '1'");
    std::string glb = "glTF";
    for (const std::uint32_t word : {1U, 28U, 4U, 0U, 0x20207D7BU}) put(glb, word);
    check("old.glb", glb + std::string(4, ' '), "old-gltf", "GLB version 1");
    std::string fbx("Kaydara FBX Binary  \0\x1a\0", 23);
    put(fbx, std::uint32_t{6100});
    check("old.fbx", fbx + std::string(100, '\0'), "old-fbx", "FBX version 6.1");
    check("text.fbx", "; FBX 6.1.0 project file\n; Copyright\nFBXHeaderExtension:  {\n    FBXHeaderVersion: 1003\n    FBXVersion: 6100\n}\n", "old-fbx", "FBX version 6.1");
    check("five.fbx", "; FBX 5.0.0 project file\n", "old-fbx", "FBX version 5.0");
    check("splats.ply",
          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty float f_dc_0\nproperty float opacity\nproperty float scale_0\nproperty float rot_0\nend_header\n0 0 0 1 1 1 1\n",
          "splats", "gaussian splats");
    Glb cloud = triangleFile();
    cloud.json["meshes"][0]["primitives"][0]["mode"] = 0;
    cloud.json["meshes"][0]["primitives"][0]["extensions"] = {{"KHR_gaussian_splatting", {{"kernel", "ellipse"}}}};
    cloud.json["extensionsRequired"] = {"KHR_gaussian_splatting"};
    check("splats.glb", cloud.file(), "splats", "gaussian splats");
}

TEST_CASE("KTX2 textures are left out and told, whatever asks for them; the mesh comes") {
    for (const bool plainToo : {false, true}) {
        Glb glb = triangleFile();
        glb.json["images"] = {{{"mimeType", "image/ktx2"}, {"bufferView", 0}}};
        glb.json["textures"] = {{{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}}};
        if (plainToo) glb.json["textures"] = {{{"source", 0}}};
        glb.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
        glb.json["meshes"][0]["primitives"][0]["material"] = 0;
        glb.json["extensionsRequired"] = {"KHR_texture_basisu"};
        const auto read = scene("a.glb", glb.file());
        CAPTURE(said(read));
        REQUIRE(read);
        REQUIRE(io_test::find(*read, "ktx2"));
        CHECK(io_test::find(*read, "ktx2")->count == 1);
        CHECK(io_test::find(*read, "ktx2")->text.find("PNG or JPEG") != std::string::npos);
    }
}

TEST_CASE("files of pointers with flipped bytes give a reason or a character") {
    const std::string good = readFile(kCharacters / "pointer_clip.gltf");
    const TestFolder folder;
    std::mt19937 random(13);
    const std::size_t clips = good.find("\"animations\"");
    REQUIRE(clips != std::string::npos);
    for (int i = 0; i < repeats(30, 1000); ++i) {
        std::string bad = good;
        for (unsigned flips = 1 + random() % 3; flips-- > 0;) {
            // Half of them in the clips.
            char& c = i % 2 ? bad[random() % bad.size()] : bad[clips + random() % std::min<std::size_t>(900, bad.size() - clips)];
            c = i % 4 == 0 ? static_cast<char>('0' + random() % 10) : static_cast<char>(c ^ static_cast<char>(1 + random() % 127));
        }
        const auto file = characterAt(folder.write("bad.gltf", bad), true);
        CAPTURE(i);
        if (!file)
            CHECK_MESSAGE(isReason(file.error()), (file.error().code + ": " + file.error().message));
    }
}
