// SPDX-License-Identifier: GPL-3.0-or-later
// Avatars of VRM files: what a project keeps of them, their expressions, and VRM 1.0 out again.
#include <cstring>
#include <map>

#include "core/document/avatar.h"
#include "tests/document/read_character.h"
#include "tests/document/tamper.h"
#include "tests/document/workbench.h"
#include "tests/io/glb.h"

using namespace imomushi;

namespace {

const std::filesystem::path kAvatarFiles = std::filesystem::path(IMOMUSHI_TEST_DATA) / "characters";

struct AvatarBench : Workbench {
    explicit AvatarBench(const char* file = "avatar.glb") {
        session.services().importCharacter = readCharacter;
        imported = good({{"do", "import-character"}, {"path", kAvatarFiles / file}, {"name", "avatar"}});
    }
    [[nodiscard]] const CharacterSource& avatar() const { return *session.document().characters.begin()->second; }
    Json imported;
};

Json vrmJson(const std::filesystem::path& path) {
    const std::string bytes = readFile(path);
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, 4);
    return Json::parse(bytes.substr(20, length));
}

/// For comparisons: the order of keys says nothing.
nlohmann::json unordered(const Json& json) { return nlohmann::json::parse(json.dump()); }

}  // namespace

TEST_CASE("avatars: import says licence, expressions and humanoid bones, and a project keeps them") {
    AvatarBench w;
    CHECK(w.imported["avatar"]["version"] == "1.0");
    CHECK(w.imported["avatar"]["licence"]["commercialUsage"] == "corporation");
    CHECK(w.imported["avatar"]["licence"]["authors"] == "Imomushi test characters");
    CHECK(w.imported["avatar"]["springs"] == 1);
    CHECK(w.imported["avatar"]["expressions"].size() == 3);
    std::map<std::string, std::string> roles;
    for (const Json& bone : w.imported["skeleton"])
        if (bone.contains("role")) roles[bone["role"]] = bone["name"];
    CHECK(roles.size() == 19);
    CHECK(roles["rightLowerLeg"] == "lowerLeg.R");
    const auto path = w.folder() / "avatar.imomushi";
    w.good({{"do", "save"}, {"path", path}});
    Workbench other;
    other.good({{"do", "open"}, {"path", path}});
    const Rig &a = *w.avatar().rig, &b = *other.session.document().characters.begin()->second->rig;
    CHECK(a.avatar == b.avatar);
    REQUIRE(a.roles.size() == b.roles.size());
    for (std::size_t i = 0; i < a.roles.size(); ++i) CHECK((a.roles[i].role == b.roles[i].role && a.roles[i].bone == b.roles[i].bone));
    CHECK(other.content() == w.content());
    // Of version 0 its own words are shown.
    const AvatarBench zero("avatar_vrm0.vrm");
    CHECK(zero.imported["avatar"]["version"] == "0.x");
    CHECK(zero.imported["avatar"]["licence"]["licenseName"] == "CC0");
    CHECK(zero.imported["avatar"]["licence"]["sexualUssageName"] == "Disallow");
}

TEST_CASE("avatars: an expression sets its targets and takes those of another back") {
    AvatarBench w;
    CHECK(w.good({{"do", "express"}, {"character", "avatar"}, {"expression", "happy"}})["morphs"] == Json{{"happy", 1.0}});
    CHECK(w.good({{"do", "express"}, {"character", "avatar"}, {"expression", "aa"}, {"weight", 0.5}})["morphs"] == Json{{"aa", 0.5}});
    CHECK(w.session.document().morphs.size() == 1);
    CHECK(w.session.document().morphs.begin()->second == 0.5);
    w.good({{"do", "undo"}});
    CHECK(w.session.document().morphs.begin()->second == 1.0);
    CHECK(w.code({{"do", "express"}, {"character", "avatar"}, {"expression", "sulky"}}) == "no-such-target");
    CHECK(w.code({{"do", "express"}, {"character", "avatar"}, {"expression", "aa"}, {"weight", 2}}) == "bad-value");
}

TEST_CASE("avatars: VRM 1.0 out has the humanoid map, expressions, licence, first person, look-at and springs that came in") {
    for (const char* file : {"avatar.glb", "avatar_vrm0.vrm"}) {
        CAPTURE(file);
        AvatarBench w(file);
        w.good({{"do", "make-soft"}, {"character", "avatar"}, {"draft", true}, {"precompute", false}});
        const auto path = w.folder() / "out.vrm";
        CHECK(w.code({{"do", "export"}, {"path", path}, {"layout", "baked"}}) == "bad-value");
        const Json told = w.good({{"do", "export"}, {"path", path}, {"layout", "skinned"}});
        CHECK(told["check"]["max_percent"].get<double>() < 5.0);
        const Json out = vrmJson(path), in = vrmJson(kAvatarFiles / "avatar.glb");
        const auto name = [](const Json& json, const Json& node) { return json["nodes"][node.get<std::size_t>()]["name"]; };
        const Json &vrm = out["extensions"]["VRMC_vrm"], &before = in["extensions"]["VRMC_vrm"];
        CHECK(vrm["specVersion"] == "1.0");
        for (const auto& [role, bone] : before["humanoid"]["humanBones"].items()) {
            CAPTURE(role);
            REQUIRE(vrm["humanoid"]["humanBones"].contains(role));
            CHECK(name(out, vrm["humanoid"]["humanBones"][role]["node"]) == name(in, bone["node"]));
        }
        CHECK(vrm["humanoid"]["humanBones"].size() == before["humanoid"]["humanBones"].size());
        for (const char* expression : {"aa", "blink", "happy"}) {
            const Json& bind = vrm["expressions"]["preset"][expression]["morphTargetBinds"][0];
            const Json& mesh = out["meshes"][out["nodes"][bind["node"].get<std::size_t>()]["mesh"].get<std::size_t>()];
            CHECK(mesh["extras"]["targetNames"][bind["index"].get<std::size_t>()] == expression);
            CHECK(bind["weight"] == 1.0);
        }
        const Json &springs = out["extensions"]["VRMC_springBone"]["springs"], &hair = in["extensions"]["VRMC_springBone"]["springs"];
        REQUIRE(springs.size() == 1);
        REQUIRE(springs[0]["joints"].size() == 2);
        CHECK(name(out, springs[0]["joints"][1]["node"]) == "hair2");
        CHECK(springs[0]["joints"][0]["hitRadius"] == hair[0]["joints"][0]["hitRadius"]);
        CHECK(name(out, vrm["firstPerson"]["meshAnnotations"][0]["node"]) == "body");
        CHECK(vrm["lookAt"]["offsetFromHeadBone"][1] == 0.2);
        if (file == std::string("avatar.glb")) {
            CHECK(unordered(vrm["meta"]) == unordered(before["meta"]));
            CHECK(unordered(vrm["lookAt"]) == unordered(before["lookAt"]));
            CHECK(vrm["expressions"]["preset"]["aa"]["overrideMouth"] == "none");
        } else {
            CHECK(vrm["meta"]["thirdPartyLicenses"] == "VRM 0.x licence: CC0");
        }
        CHECK(out["extensionsUsed"] == Json{"VRMC_vrm", "VRMC_springBone"});
        // It comes in again as it went out, looking along +Z.
        Workbench again;
        again.session.services().importCharacter = readCharacter;
        const Json back = again.good({{"do", "import-character"}, {"path", path}, {"name", "avatar"}});
        CHECK(back["avatar"]["expressions"] == w.imported["avatar"]["expressions"]);
        for (const Json& bone : w.imported["skeleton"])
            for (const Json& other : back["skeleton"])
                if (other["name"] == bone["name"]) {
                    CHECK(other.value("role", "") == bone.value("role", ""));
                    for (std::size_t k = 0; k < 3; ++k) CHECK(std::abs(other["start"][k].get<double>() - bone["start"][k].get<double>()) < 1e-5);
                }
    }
    // What is no avatar is none.
    Workbench w;
    w.session.services().importCharacter = readCharacter;
    w.good({{"do", "import-character"}, {"path", kAvatarFiles / "panda.glb"}, {"name", "panda"}});
    CHECK(w.code({{"do", "export"}, {"path", w.folder() / "panda.vrm"}, {"layout", "skinned"}}) == "not-an-avatar");
}

TEST_CASE("avatars: a thumbnail goes through a project and out again, bit for bit") {
    const TestFolder folder;
    const auto in = folder.write("in.vrm", io_test::changedGlb(kAvatarFiles / "avatar.glb", [](auto& j) { j["extensions"]["VRMC_vrm"]["meta"]["thumbnailImage"] = 0; }));
    Workbench w;
    w.session.services().importCharacter = readCharacter;
    w.good({{"do", "make-soft"}, {"path", in}, {"name", "avatar"}, {"draft", true}, {"precompute", false}});
    w.good({{"do", "save"}, {"path", folder.path() / "avatar.imomushi"}});
    Workbench other;
    other.good({{"do", "open"}, {"path", folder.path() / "avatar.imomushi"}});
    for (const bool compress : {false, true}) {
        const auto out = folder.path() / "out.vrm";
        other.good({{"do", "export"}, {"path", out}, {"layout", "skinned"}, {"compress", compress}});
        const auto pictureOf = [](const std::filesystem::path& path) {
            const Json json = vrmJson(path);
            const Json& image = json["images"][json["extensions"]["VRMC_vrm"]["meta"]["thumbnailImage"].get<std::size_t>()];
            CHECK(image["mimeType"] == "image/png");
            const Json& view = json["bufferViews"][image["bufferView"].get<std::size_t>()];
            const std::string bytes = readFile(path);
            std::uint32_t length = 0;
            std::memcpy(&length, bytes.data() + 12, 4);
            return bytes.substr(28 + length + view.value("byteOffset", std::size_t{0}), view["byteLength"].get<std::size_t>());
        };
        CHECK(pictureOf(out) == pictureOf(in));
        CHECK(pictureOf(out).substr(1, 3) == "PNG");
    }
}

TEST_CASE("avatars: what a project file says of them is not trusted") {
    AvatarBench w;
    const auto good = w.folder() / "good.imomushi";
    w.good({{"do", "save"}, {"path", good}});
    const auto refused = [&](const char* change) {
        const auto path = w.folder() / "bad.imomushi";
        std::filesystem::copy_file(good, path, std::filesystem::copy_options::overwrite_existing);
        sql(path, change);
        sign(path);
        Workbench other;
        return other.code({{"do", "open"}, {"path", path}});
    };
    CHECK(refused("UPDATE rig_roles SET bone = 99 WHERE position = 3") == "damaged");
    CHECK(refused("UPDATE rig_roles SET role = 'tail' WHERE position = 3") == "damaged");
    CHECK(refused("UPDATE rig_roles SET role = 'hips' WHERE position = 3") == "damaged");
    // An avatar that says nonsense is one that says nothing.
    for (const char* nonsense : {"no JSON", "[1, 2]", "{\"expressions\": 3, \"meta\": [], \"springBone\": {\"springs\": \"x\", \"colliders\": {\"a\": 1}}, \"firstPerson\": true}",
                                 "{\"expressions\": [{\"name\": \"aa\", \"morphs\": [{\"target\": 1, \"weight\": \"x\"}, 7]}, 4, {\"name\": []}]}"}) {
        CAPTURE(nonsense);
        const auto path = w.folder() / "odd.imomushi";
        std::filesystem::copy_file(good, path, std::filesystem::copy_options::overwrite_existing);
        sql(path, std::string("UPDATE rigs SET avatar = '") + nonsense + "'");
        sign(path);
        Workbench other;
        other.good({{"do", "open"}, {"path", path}});
        CHECK(other.good({{"do", "list"}})["characters"].size() == 1);
        other.good({{"do", "export"}, {"path", w.folder() / "odd.vrm"}, {"layout", "skinned"}});
    }
}
