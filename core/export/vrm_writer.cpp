// SPDX-License-Identifier: GPL-3.0-or-later
// Source: "VRMC_vrm-1.0" and "VRMC_springBone-1.0", VRM Consortium.
#include "core/export/vrm_writer.h"

#include "core/base/base64.h"
#include "core/base/json_member.h"
#include "core/mesh/avatar.h"

namespace imomushi {

namespace {

using Json = GltfFile::Json;

std::string text(const Json& value) { return value.is_string() ? value.get<std::string>() : std::string(); }

/// `value` without what names things of the scene; null: nothing is left.
Json without(const Json& value, std::initializer_list<const char*> keys) {
    Json out = value.is_object() ? value : Json::object();
    for (const char* key : keys) out.erase(key);
    return out;
}

class AvatarWriter {
public:
    AvatarWriter(const Rig& rig, const VrmPlaces& places, GltfFile& file) : rig_(rig), places_(places), file_(file), avatar_(Json::parse(rig.avatar, nullptr, false)) {}

    void write() {
        Json vrm{{"specVersion", "1.0"}, {"meta", meta()}, {"humanoid", humanoid()}};
        if (Json list = expressions(); !list.empty()) vrm["expressions"] = std::move(list);
        Json seen = Json::array();
        for (const Json& from : jsonMember(avatar_, "firstPerson"))
            for (const int node : places_.parts(text(jsonMember(from, "part")))) seen.push_back({{"node", node}, {"type", jsonMember(from, "type")}});
        if (!seen.empty()) vrm["firstPerson"] = {{"meshAnnotations", std::move(seen)}};
        if (const Json& look = jsonMember(avatar_, "lookAt"); look.is_object()) vrm["lookAt"] = look;
        use("VRMC_vrm", std::move(vrm));
        springs();
    }

private:
    void use(const char* extension, Json value) {
        file_.root["extensionsUsed"].push_back(extension);
        file_.root["extensions"][extension] = std::move(value);
    }

    /// What 1.0 wants is there, whatever a project says.
    Json meta() {
        Json out = jsonMember(avatar_, "meta").is_object() ? jsonMember(avatar_, "meta") : Json::object();
        if (text(jsonMember(out, "name")).empty()) out["name"] = "avatar";
        if (!jsonMember(out, "authors").is_array() || out["authors"].empty()) out["authors"] = {"unknown"};
        if (text(jsonMember(out, "licenseUrl")).empty()) out["licenseUrl"] = "https://vrm.dev/licenses/1.0/";
        const Json& picture = jsonMember(avatar_, "thumbnail");
        const std::string type = text(jsonMember(picture, "mimeType"));
        const auto bytes = fromBase64(text(jsonMember(picture, "data")));
        if (bytes && !bytes->empty() && (type == "image/png" || type == "image/jpeg"))
            out["thumbnailImage"] = file_.add("images", {{"bufferView", file_.view(bytes->data(), bytes->size(), GltfFile::Target::None)}, {"mimeType", type}, {"name", "thumbnail"}});
        return out;
    }

    Json humanoid() const {
        Json bones = Json::object();
        for (const RigRole& role : rig_.roles)
            if (const int node = places_.node(role.bone); node >= 0) bones[role.role] = {{"node", node}};
        return {{"humanBones", std::move(bones)}};
    }

    Json expressions() const {
        Json out = Json::object();
        for (const Json& from : jsonMember(avatar_, "expressions")) {
            const std::string name = text(jsonMember(from, "name"));
            if (name.empty()) continue;
            Json to = without(from, {"name", "preset", "morphs", "colors", "textures"});
            Json binds = Json::array();
            for (const Json& morph : jsonMember(from, "morphs"))
                for (const int node : places_.meshNodes) {
                    const Json& mesh = file_.root["meshes"][file_.root["nodes"][static_cast<std::size_t>(node)]["mesh"].get<std::size_t>()];
                    int index = 0;
                    for (const Json& target : jsonMember(jsonMember(mesh, "extras"), "targetNames")) {
                        if (target == jsonMember(morph, "target")) binds.push_back({{"node", node}, {"index", index}, {"weight", jsonMember(morph, "weight")}});
                        ++index;
                    }
                }
            if (!binds.empty()) to["morphTargetBinds"] = std::move(binds);
            for (const auto& [key, bind] : {std::pair{"colors", "materialColorBinds"}, {"textures", "textureTransformBinds"}})
                for (const Json& material : jsonMember(from, key)) {
                    const Json& known = jsonMember(file_.root, "materials");
                    for (std::size_t m = 0; m < known.size(); ++m)
                        if (known[m]["name"] == jsonMember(material, "material")) {
                            Json item = without(material, {"material"});
                            item["material"] = m;
                            to[bind].push_back(std::move(item));
                            break;
                        }
                }
            out[jsonMember(from, "preset") == true ? "preset" : "custom"][name] = std::move(to);
        }
        return out;
    }

    [[nodiscard]] int nodeOf(const Json& bone) const {
        const int index = rig_.boneIndex(text(bone));
        return index < 0 ? -1 : places_.node(index);
    }

    void springs() {
        const Json& from = jsonMember(avatar_, "springBone");
        Json out{{"specVersion", "1.0"}}, colliders = Json::array(), groups = Json::array(), list = Json::array();
        std::vector<int> kept;
        for (const Json& collider : jsonMember(from, "colliders")) {
            const int node = nodeOf(jsonMember(collider, "bone"));
            kept.push_back(node < 0 ? -1 : static_cast<int>(colliders.size()));
            if (node >= 0) colliders.push_back({{"node", node}, {"shape", jsonMember(collider, "shape")}});
        }
        for (const Json& group : jsonMember(from, "colliderGroups")) {
            Json to = without(group, {"colliders"});
            to["colliders"] = Json::array();
            for (const Json& c : jsonMember(group, "colliders"))
                if (c.is_number_unsigned() && c.get<std::size_t>() < kept.size() && kept[c.get<std::size_t>()] >= 0) to["colliders"].push_back(kept[c.get<std::size_t>()]);
            groups.push_back(std::move(to));
        }
        for (const Json& spring : jsonMember(from, "springs")) {
            Json to = without(spring, {"joints", "center", "colliderGroups"}), joints = Json::array(), near = Json::array();
            for (const Json& joint : jsonMember(spring, "joints")) {
                const int node = nodeOf(jsonMember(joint, "bone"));
                if (node < 0) continue;
                Json j = without(joint, {"bone"});
                j["node"] = node;
                joints.push_back(std::move(j));
            }
            if (joints.empty()) continue;
            to["joints"] = std::move(joints);
            if (const int center = nodeOf(jsonMember(spring, "center")); center >= 0) to["center"] = center;
            for (const Json& g : jsonMember(spring, "colliderGroups"))
                if (g.is_number_unsigned() && g.get<std::size_t>() < groups.size()) near.push_back(g);
            if (!near.empty()) to["colliderGroups"] = std::move(near);
            list.push_back(std::move(to));
        }
        if (list.empty()) return;
        // A group without colliders is none: groups keep their numbers only where all have some.
        bool full = !groups.empty();
        for (const Json& group : groups) full = full && !group["colliders"].empty();
        if (full) {
            out["colliders"] = std::move(colliders);
            out["colliderGroups"] = std::move(groups);
        } else {
            for (Json& spring : list) spring.erase("colliderGroups");
        }
        out["springs"] = std::move(list);
        use("VRMC_springBone", std::move(out));
    }

    const Rig& rig_;
    const VrmPlaces& places_;
    GltfFile& file_;
    const Json avatar_;
};

}  // namespace

Result<const Rig*> avatarOf(const std::vector<const Rig*>& rigs) {
    const Rig* found = nullptr;
    for (const Rig* rig : rigs) {
        if (rig->roles.empty()) continue;
        if (found) return fail("not-an-avatar", "A VRM file is one avatar, and there are several: export them by themselves.");
        found = rig;
    }
    if (!found) return fail("not-an-avatar", "Nothing here has humanoid bones, which a VRM file needs: export it as .glb, or begin with a VRM file.");
    for (const HumanRole& role : kHumanRoles)
        if (role.required && found->boneOfRole(role.name) < 0) return fail("not-an-avatar", "The avatar has no bone \"" + std::string(role.name) + "\", which a VRM file needs: export it as .glb.");
    return found;
}

void addAvatar(const Rig& rig, const VrmPlaces& places, GltfFile& file) { AvatarWriter(rig, places, file).write(); }

}  // namespace imomushi
