// SPDX-License-Identifier: GPL-3.0-or-later
// VRM files: humanoid bones, expressions, licence, springs, the front of version 0.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "core/base/base64.h"
#include "tests/io/glb.h"
#include "tests/io/raw_scene.h"
#include "tests/support/thorough.h"

using namespace imomushi;
using namespace io_test;
namespace fs = std::filesystem;

TEST_CASE("VRM: both versions give one figure: humanoid bones, expressions, springs, and a front along +Z") {
    const TestFolder folder;
    const auto one = characterAt(folder.write("avatar.vrm", readFile(kCharacters / "avatar.glb"))), zero = characterAt(kCharacters / "avatar_vrm0.vrm");
    CAPTURE((one ? "" : one.error().message));
    CAPTURE((zero ? "" : zero.error().message));
    REQUIRE(one);
    REQUIRE(zero);
    REQUIRE(one->rig);
    REQUIRE(zero->rig);
    // The same shape: version 0 of the file is the other one turned, in single precision.
    REQUIRE(one->renderModel.mesh.body.vertices.rows() == zero->renderModel.mesh.body.vertices.rows());
    CHECK((one->renderModel.mesh.body.vertices - zero->renderModel.mesh.body.vertices).cwiseAbs().maxCoeff() < 1e-6);
    CHECK((one->renderModel.mesh.renderMesh.normals - zero->renderModel.mesh.renderMesh.normals).cwiseAbs().maxCoeff() < 1e-4f);
    REQUIRE(one->renderModel.morphs.size() == 3);
    REQUIRE(zero->renderModel.morphs.size() == 3);
    for (std::size_t t = 0; t < 3; ++t) CHECK((one->renderModel.morphs[t].deltas - zero->renderModel.morphs[t].deltas).cwiseAbs().maxCoeff() < 1e-6f);
    for (const auto* file : {&*one, &*zero}) {
        const Rig& rig = *file->rig;
        CHECK(rig.bones.size() == 21);
        CHECK(rig.roles.size() == 19);
        CHECK(rig.roles.front().role == "hips");
        CHECK(rig.bones[static_cast<std::size_t>(rig.boneOfRole("leftUpperArm"))].name == "upperArm.L");
        CHECK(rig.bones[static_cast<std::size_t>(rig.boneOfRole("leftUpperArm"))].head.x() > 0.1);  // its left is at +X when it looks along +Z
        CHECK(rig.bones[static_cast<std::size_t>(rig.boneOfRole("leftToes"))].head.z() > 0.01);
        CHECK(rig.boneOfRole("jaw") == -1);
        // Where the nodes say that bones are is where they are.
        const auto pose = posedRig(rig, {"still", 0.0, {}}, 0.0);
        for (std::size_t b = 0; b < rig.bones.size(); ++b) CHECK((pose[b].head - rig.bones[b].head).norm() < 1e-9);
        const auto avatar = nlohmann::json::parse(rig.avatar);
        REQUIRE(avatar["expressions"].size() == 3);
        std::map<std::string, std::string> targets;
        for (const auto& e : avatar["expressions"]) {
            CHECK(e["preset"] == true);
            REQUIRE(e["morphs"].size() == 1);
            CHECK(e["morphs"][0]["weight"] == 1.0);
            targets[e["name"]] = e["morphs"][0]["target"];
        }
        CHECK(targets == std::map<std::string, std::string>{{"aa", "aa"}, {"blink", "blink"}, {"happy", "happy"}});
        CHECK(avatar["meta"]["authors"][0] == "Imomushi test characters");
        CHECK(avatar["lookAt"]["type"] == "expression");
        REQUIRE(avatar["springBone"]["springs"].size() == 1);
        REQUIRE(avatar["springBone"]["springs"][0]["joints"].size() == 2);
        CHECK(avatar["springBone"]["springs"][0]["joints"][0]["bone"] == "hair1");
        CHECK(avatar["springBone"]["springs"][0]["joints"][0]["dragForce"] == 0.4);
        CHECK(avatar["firstPerson"][0]["part"] == "body");
        CHECK(std::any_of(file->issues.begin(), file->issues.end(), [](const MeshIssue& i) { return i.code == "avatar" && i.text.find("19 humanoid bones") != std::string::npos; }));
        // The toon shader's colours; skin and hair are no metal.
        REQUIRE(file->renderModel.mesh.renderMesh.materials.size() == 2);
        CHECK(file->renderModel.mesh.renderMesh.materials[1].baseColor[0] == doctest::Approx(0.45));
        CHECK(file->renderModel.mesh.renderMesh.materials[0].baseColorTexture == 0);
        CHECK(file->renderModel.mesh.renderMesh.materials[0].metallic == 0.0f);
    }
    const auto a = nlohmann::json::parse(one->rig->avatar), b = nlohmann::json::parse(zero->rig->avatar);
    CHECK(a["version"] == "1.0");
    CHECK(a["meta"]["licenseUrl"] == "https://vrm.dev/licenses/1.0/");
    CHECK(a["meta"]["commercialUsage"] == "corporation");
    CHECK(a["firstPerson"][1]["type"] == "thirdPersonOnly");
    CHECK(b["version"] == "0.x");
    CHECK(b["original"]["licenseName"] == "CC0");
    CHECK(b["meta"]["thirdPartyLicenses"] == "VRM 0.x licence: CC0");
    CHECK(b["meta"]["allowExcessivelySexualUsage"] == false);
    // As an element it faces +Z as well.
    const auto element = io_test::import(kCharacters / "avatar_vrm0.vrm");
    REQUIRE(element);
}

TEST_CASE("VRM 0.x: a toon shader without a material beside it gives colour and picture") {
    const auto file = scene("a.vrm", changedGlb(kCharacters / "avatar_vrm0.vrm", [](auto& j) {
        for (auto& m : j["materials"]) m.erase("pbrMetallicRoughness");
        j["extensions"]["VRM"]["materialProperties"][1]["vectorProperties"]["_Color"] = {0.5, 0, 0, 1};
    }));
    REQUIRE(file);
    const auto& materials = file->surface.mesh.renderMesh.materials;
    CHECK(materials[0].baseColorTexture == 0);
    CHECK(materials[1].baseColor[0] == doctest::Approx(0.2140).epsilon(1e-3));  // of sRGB
}

TEST_CASE("VRM: what it says wrongly is left out and told; the figure comes all the same") {
    const auto told = [&](const std::function<void(nlohmann::json&)>& change, const char* issue) {
        const TestFolder folder;
        const auto file = characterAt(folder.write("a.vrm", changedGlb(kCharacters / "avatar.glb", change)));
        CAPTURE((file ? "" : file.error().message));
        REQUIRE(file);
        REQUIRE(file->rig);
        CHECK(file->rig->bones.size() == 21);
        CHECK(std::any_of(file->issues.begin(), file->issues.end(), [&](const MeshIssue& i) { return i.code == issue; }));
    };
    told([](auto& j) { j["extensions"]["VRMC_vrm"]["humanoid"]["humanBones"]["jaw"] = {{"node", 99}}; }, "avatar-damaged");
    told([](auto& j) { j["extensions"]["VRMC_vrm"]["humanoid"]["humanBones"]["tail"] = {{"node", 3}}; }, "avatar-damaged");
    told([](auto& j) { j["extensions"]["VRMC_vrm"]["humanoid"]["humanBones"]["jaw"] = {{"node", 0}}; }, "avatar-damaged");
    told([](auto& j) { j["extensions"]["VRMC_vrm"]["humanoid"]["humanBones"]["hips"] = 7; }, "avatar-damaged");
    told([](auto& j) { j["extensions"]["VRMC_vrm"]["expressions"]["preset"]["aa"]["morphTargetBinds"] = 7; }, "avatar-damaged");
    told([](auto& j) { j["extensions"]["VRMC_vrm"]["expressions"]["preset"]["aa"]["morphTargetBinds"][0]["index"] = 12; }, "avatar-dropped");
    told([](auto& j) { j["extensions"]["VRMC_vrm"]["firstPerson"]["meshAnnotations"] = "all"; }, "avatar-damaged");
    told([](auto& j) { j["extensions"]["VRMC_springBone"]["springs"][0]["joints"][0]["node"] = 99; }, "avatar-damaged");
    told([](auto& j) { j["extensions"]["VRMC_springBone"]["springs"] = {{"a", 1}}; }, "avatar-damaged");
}

TEST_CASE("VRM: its thumbnail is kept, and toon shading and constraints, which have no effect here, are told") {
    const TestFolder folder;
    const auto says = [](const CharacterFile& file, const char* issue) { return std::any_of(file.issues.begin(), file.issues.end(), [&](const MeshIssue& i) { return i.code == issue; }); };
    for (const char* name : {"avatar.glb", "avatar_vrm0.vrm"}) {
        CAPTURE(name);
        const auto file = characterAt(folder.write("a.vrm", changedGlb(kCharacters / name, [](auto& j) {
            auto& extensions = j["extensions"];
            if (extensions.contains("VRM")) extensions["VRM"]["meta"]["texture"] = 0;
            else extensions["VRMC_vrm"]["meta"]["thumbnailImage"] = 0;
            j["nodes"][3]["extensions"]["VRMC_node_constraint"] = {{"specVersion", "1.0"}, {"constraint", {{"rotation", {{"source", 1}}}}}};
        })));
        REQUIRE(file);
        const auto avatar = nlohmann::json::parse(file->rig->avatar);
        REQUIRE(avatar.contains("thumbnail"));
        CHECK(avatar["thumbnail"]["mimeType"] == "image/png");
        const auto& picture = file->renderModel.mesh.renderMesh.textures.at(0).bytes;
        CHECK(fromBase64(avatar["thumbnail"]["data"].get<std::string>()) == std::string(picture.begin(), picture.end()));
        CHECK(says(*file, "toon"));
        CHECK(says(*file, "avatar-constraints"));
        CHECK(!says(*file, "avatar-dropped"));
    }
    const auto odd = characterAt(folder.write("a.vrm", changedGlb(kCharacters / "avatar.glb", [](auto& j) { j["extensions"]["VRMC_vrm"]["meta"]["thumbnailImage"] = 99; })));
    REQUIRE(odd);
    CHECK(says(*odd, "avatar-damaged"));
    CHECK(!nlohmann::json::parse(odd->rig->avatar).contains("thumbnail"));
}

TEST_CASE("VRM files with flipped bytes give a reason or a character") {
    for (const char* name : {"avatar.glb", "avatar_vrm0.vrm"}) {
        const std::string good = readFile(kCharacters / name);
        const TestFolder folder;
        std::mt19937 random(11);
        for (int i = 0; i < repeats(30, 1000); ++i) {
            std::string bad = good;
            // Half of them in the JSON, which is where an avatar is.
            std::uint32_t length = 0;
            std::memcpy(&length, good.data() + 12, 4);
            const std::size_t end = i % 2 ? bad.size() : 20 + length;
            for (unsigned flips = 1 + random() % 3; flips-- > 0;) {
                char& c = bad[20 + random() % (end - 20)];
                c = i % 4 == 0 ? static_cast<char>('0' + random() % 10) : static_cast<char>(c ^ static_cast<char>(1 + random() % 255));
            }
            const auto file = characterAt(folder.write("bad.vrm", bad));
            CAPTURE(i);
            if (!file)
                CHECK_MESSAGE(isReason(file.error()), (file.error().code + ": " + file.error().message));
        }
    }
}
