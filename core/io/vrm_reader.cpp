// SPDX-License-Identifier: GPL-3.0-or-later
// Source: "VRMC_vrm-1.0", "VRMC_springBone-1.0" and "VRM 0.x", VRM Consortium, and its guide of how 0.x becomes 1.0.
#include "core/io/vrm_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "core/base/base64.h"
#include "core/io/reader_support.h"
#include "core/mesh/avatar.h"

namespace imomushi {

namespace {

using Json = GltfFileReader::Json;

constexpr std::size_t kMostExpressions = 512, kMostSprings = 4096;
constexpr std::size_t kLongestText = 16384;  // bytes of a field of the licence
constexpr std::size_t kLargestThumbnail = std::size_t{2} << 20;  // bytes
constexpr int kLongestChain = 256;                // joints of a spring

const Json& member(const Json& object, const char* key) { return GltfFileReader::member(object, key); }
std::string text(const Json& value) {
    std::string t = GltfFileReader::text(value);
    return t.size() > kLongestText ? std::string() : t;
}

class VrmReader {
public:
    VrmReader(GltfFileReader& file, const VrmNames& names, Rig& rig) : file_(file), names_(names), rig_(rig), nodes_(file.list("nodes").size()) {}

    Json read(Vrm version) {
        Json avatar = Json::object();
        if (version == Vrm::One)
            one(member(member(file_.root(), "extensions"), "VRMC_vrm"), avatar);
        else
            zero(member(member(file_.root(), "extensions"), "VRM"), avatar);
        // Parents come first there.
        std::sort(rig_.roles.begin(), rig_.roles.end(), [](const RigRole& a, const RigRole& b) { return humanRole(a.role) < humanRole(b.role); });
        return avatar;
    }
    std::size_t damaged_ = 0, dropped_ = 0;  // what makes no sense; what has no counterpart

private:
    /// One item of a list: what is wrong with it concerns no other.
    template <class Do>
    void item(Do&& read) {
        try {
            read();
        } catch (const GltfFileReader::Refused&) {
            ++damaged_;
        }
    }
    [[nodiscard]] std::size_t node(const Json& value) const { return file_.index(value, nodes_, "node"); }

    void role(const std::string& name, const Json& at) {
        const int bone = names_.bone(node(at));
        const auto taken = [&](const RigRole& known) { return known.role == name || known.bone == bone; };
        if (!humanRole(name) || bone < 0 || std::any_of(rig_.roles.begin(), rig_.roles.end(), taken))
            ++damaged_;
        else
            rig_.roles.push_back({name, bone});
    }

    void addMorph(Json& to, std::size_t node, std::size_t target, double weight) {
        const std::string name = names_.morph(node, target);
        const auto same = [&](const Json& known) { return known["target"] == name; };
        if (name.empty())
            ++dropped_;
        else if (std::none_of(to.begin(), to.end(), same))  // meshes that share a target by its name move together
            to.push_back({{"target", name}, {"weight", std::clamp(weight, 0.0, 1.0)}});
    }

    /// A value that says nothing of nodes: numbers, texts and lists of these.
    static Json plain(const Json& value, int depth = 0) {
        if (value.is_string()) return text(value);
        if (value.is_boolean() || (value.is_number() && std::abs(value.get<double>()) < 1e9)) return value;
        Json out;
        if (depth < 4 && value.is_array()) {
            out = Json::array();
            for (const Json& v : value) out.push_back(plain(v, depth + 1));
        } else if (depth < 4 && value.is_object()) {
            out = Json::object();
            for (const auto& [key, v] : value.items()) out[key] = plain(v, depth + 1);
        }
        return out;
    }
    static void copy(const Json& from, std::initializer_list<const char*> keys, Json& to) {
        for (const char* key : keys)
            if (const Json value = plain(member(from, key)); !value.is_null()) to[key] = value;
    }

    /// The picture by which people know the avatar.
    void thumbnail(const Json& reference, Json& avatar) {
        if (reference.is_null()) return;
        item([&] {
            const Json& image = file_.list("images")[file_.index(reference, file_.list("images").size(), "image")];
            const std::string type = GltfFileReader::text(member(image, "mimeType"));
            if ((type != "image/png" && type != "image/jpeg") || member(image, "bufferView").is_null()) return void(++dropped_);
            const std::string_view bytes = file_.bufferView(file_.index(member(image, "bufferView"), file_.list("bufferViews").size(), "buffer view"));
            if (bytes.size() > kLargestThumbnail) return void(++dropped_);
            avatar["thumbnail"] = {{"mimeType", type}, {"data", toBase64(bytes)}};
        });
    }

    // --- VRM 1.0 ---

    void one(const Json& vrm, Json& avatar) {
        avatar["version"] = "1.0";
        Json& meta = avatar["meta"] = Json::object();
        copy(member(vrm, "meta"),
             {"name", "version", "authors", "copyrightInformation", "contactInformation", "references", "thirdPartyLicenses", "licenseUrl", "avatarPermission", "allowExcessivelyViolentUsage",
              "allowExcessivelySexualUsage", "commercialUsage", "allowPoliticalOrReligiousUsage", "allowAntisocialOrHateUsage", "creditNotation", "allowRedistribution", "modification", "otherLicenseUrl"},
             meta);
        thumbnail(member(member(vrm, "meta"), "thumbnailImage"), avatar);
        if (const Json& bones = member(member(vrm, "humanoid"), "humanBones"); bones.is_object())
            for (const auto& [name, bone] : bones.items()) item([&, &name = name, &bone = bone] { role(name, member(bone, "node")); });
        Json& expressions = avatar["expressions"] = Json::array();
        for (const char* group : {"preset", "custom"})
            if (const Json& list = member(member(vrm, "expressions"), group); list.is_object())
                for (const auto& [name, from] : list.items()) {
                    if (expressions.size() == kMostExpressions || name.empty()) {
                        ++damaged_;
                        continue;
                    }
                    item([&, &name = name, &from = from] { expressions.push_back(expression(name, group[0] == 'p', from)); });
                }
        if (const Json& look = member(vrm, "lookAt"); look.is_object())
            copy(look, {"type", "offsetFromHeadBone", "rangeMapHorizontalInner", "rangeMapHorizontalOuter", "rangeMapVerticalDown", "rangeMapVerticalUp"}, avatar["lookAt"] = Json::object());
        Json& seen = avatar["firstPerson"] = Json::array();
        item([&] {
            for (const Json& from : file_.array(member(member(vrm, "firstPerson"), "meshAnnotations")))
                item([&] { annotate(seen, names_.part(node(member(from, "node"))), text(member(from, "type"))); });
        });
        springs(member(member(file_.root(), "extensions"), "VRMC_springBone"), avatar);
    }

    Json expression(const std::string& name, bool preset, const Json& from) {
        Json to{{"name", name}, {"preset", preset}};
        copy(from, {"isBinary", "overrideBlink", "overrideLookAt", "overrideMouth"}, to);
        Json& morphs = to["morphs"] = Json::array();
        for (const Json& bind : file_.array(member(from, "morphTargetBinds")))
            item([&] { addMorph(morphs, node(member(bind, "node")), static_cast<std::size_t>(file_.number(member(bind, "index"), "morph target")), file_.number(member(bind, "weight"), 1.0)); });
        for (const auto& [binds, key] : {std::pair{"materialColorBinds", "colors"}, {"textureTransformBinds", "textures"}})
            for (const Json& bind : file_.array(member(from, binds)))
                item([&, key = key] {
                    Json out{{"material", names_.material(file_.index(member(bind, "material"), file_.list("materials").size(), "material"))}};
                    copy(bind, {"type", "targetValue", "scale", "offset"}, out);
                    to[key].push_back(std::move(out));
                });
        return to;
    }

    void annotate(Json& seen, const std::string& part, const std::string& type) {
        static const std::array<const char*, 4> kTypes = {"auto", "both", "thirdPersonOnly", "firstPersonOnly"};
        if (std::find(kTypes.begin(), kTypes.end(), type) == kTypes.end())
            ++damaged_;
        else if (part.empty())
            ++dropped_;
        else
            seen.push_back({{"part", part}, {"type", type}});
    }

    void springs(const Json& from, Json& avatar) {
        if (!from.is_object()) return;
        Json out{{"colliders", Json::array()}, {"colliderGroups", Json::array()}, {"springs", Json::array()}};
        std::vector<int> kept;  // of colliders
        item([&] {
            for (const Json& collider : file_.array(member(from, "colliders"))) {
                kept.push_back(-1);
                item([&] {
                    const std::string bone = boneName(member(collider, "node"));
                    if (bone.empty()) return void(++dropped_);
                    kept.back() = static_cast<int>(out["colliders"].size());
                    out["colliders"].push_back({{"bone", bone}, {"shape", plain(member(collider, "shape"))}});
                });
            }
            for (const Json& group : file_.array(member(from, "colliderGroups"))) {
                Json to{{"colliders", Json::array()}};
                copy(group, {"name"}, to);
                for (const Json& c : file_.array(member(group, "colliders")))
                    item([&] {
                        if (const int k = kept[file_.index(c, kept.size(), "collider")]; k >= 0) to["colliders"].push_back(k);
                    });
                out["colliderGroups"].push_back(std::move(to));
            }
            for (const Json& spring : file_.array(member(from, "springs"))) {
                if (out["springs"].size() == kMostSprings) break;
                Json to{{"joints", Json::array()}};
                copy(spring, {"name"}, to);
                if (const Json& center = member(spring, "center"); !center.is_null())
                    item([&] {
                        if (const std::string bone = boneName(center); !bone.empty()) to["center"] = bone;
                    });
                for (const Json& joint : file_.array(member(spring, "joints")))
                    item([&] {
                        const std::string bone = boneName(member(joint, "node"));
                        if (bone.empty()) return void(++dropped_);
                        Json j{{"bone", bone}};
                        copy(joint, {"hitRadius", "stiffness", "gravityPower", "gravityDir", "dragForce"}, j);
                        to["joints"].push_back(std::move(j));
                    });
                for (const Json& group : file_.array(member(spring, "colliderGroups")))
                    item([&] { to["colliderGroups"].push_back(file_.index(group, out["colliderGroups"].size(), "collider group")); });
                if (!to["joints"].empty()) out["springs"].push_back(std::move(to));
            }
        });
        avatar["springBone"] = std::move(out);
    }
    std::string boneName(const Json& at) {
        const int bone = names_.bone(node(at));
        return bone < 0 ? std::string() : rig_.bones[static_cast<std::size_t>(bone)].name;
    }

    // --- VRM 0.x ---

    void zero(const Json& vrm, Json& avatar) {
        avatar["version"] = "0.x";
        licence(member(vrm, "meta"), avatar);
        item([&] {
            for (const Json& bone : file_.array(member(member(vrm, "humanoid"), "humanBones")))
                item([&] {
                    std::string name = text(member(bone, "bone"));
                    // 1.0 gave the bones of the thumbs other names.
                    for (const char* side : {"left", "right"}) {
                        if (name == std::string(side) + "ThumbProximal") name = std::string(side) + "ThumbMetacarpal";
                        else if (name == std::string(side) + "ThumbIntermediate") name = std::string(side) + "ThumbProximal";
                    }
                    role(name, member(bone, "node"));
                });
        });
        Json& expressions = avatar["expressions"] = Json::array();
        item([&] { expressionsOfZero(vrm, expressions); });
        const Json& first = member(vrm, "firstPerson");
        Json& seen = avatar["firstPerson"] = Json::array();
        item([&] {
            for (const Json& from : file_.array(member(first, "meshAnnotations")))
                item([&] {
                    std::string type = text(member(from, "firstPersonFlag"));
                    if (!type.empty()) type[0] = static_cast<char>(type[0] | 0x20);
                    for (const std::size_t n : nodesOf(member(from, "mesh"))) annotate(seen, names_.part(n), type);
                });
        });
        lookAtOfZero(first, avatar);
        springsOfZero(member(vrm, "secondaryAnimation"), avatar);
    }

    std::vector<std::size_t> nodesOf(const Json& mesh) const {
        const std::size_t wanted = file_.index(mesh, file_.list("meshes").size(), "mesh");
        std::vector<std::size_t> out;
        for (std::size_t n = 0; n < nodes_; ++n)
            if (const Json& own = member(file_.list("nodes")[n], "mesh"); !own.is_null() && file_.number(own, "mesh") == wanted) out.push_back(n);
        return out;
    }

    void licence(const Json& from, Json& avatar) {
        Json original = Json::object();
        if (from.is_object())
            for (const auto& [key, value] : from.items())
                if (value.is_string() && !text(value).empty()) original[key] = text(value);
        const auto said = [&](const char* key) { return text(member(from, key)); };
        // 1.0 has a licence of its own, in which each permission is said. What 0.x says otherwise stays beside it, and no permission is given that was not there.
        Json meta{{"name", said("title").empty() ? "avatar" : said("title")}, {"authors", {said("author").empty() ? "unknown" : said("author")}}, {"licenseUrl", "https://vrm.dev/licenses/1.0/"}};
        if (!said("version").empty()) meta["version"] = said("version");
        if (!said("contactInformation").empty()) meta["contactInformation"] = said("contactInformation");
        if (!said("reference").empty()) meta["references"] = {said("reference")};
        const std::string who = said("allowedUserName"), licence = said("licenseName");
        meta["avatarPermission"] = who == "Everyone" ? "everyone" : who == "ExplicitlyLicensedPerson" ? "onlySeparatelyLicensedPerson" : "onlyAuthor";
        meta["allowExcessivelyViolentUsage"] = said("violentUssageName") == "Allow";
        meta["allowExcessivelySexualUsage"] = said("sexualUssageName") == "Allow";
        meta["commercialUsage"] = said("commercialUssageName") == "Allow" ? "personalProfit" : "personalNonProfit";
        meta["creditNotation"] = licence == "CC0" ? "unnecessary" : "required";
        const bool common = licence.rfind("CC", 0) == 0, changeable = common && licence.find("ND") == std::string::npos;
        meta["allowRedistribution"] = common;
        meta["modification"] = changeable ? "allowModificationRedistribution" : "prohibited";
        std::string kept = licence.empty() ? std::string() : "VRM 0.x licence: " + licence;
        if (!said("otherPermissionUrl").empty()) kept += (kept.empty() ? "" : "; ") + ("other permissions: " + said("otherPermissionUrl"));
        if (!kept.empty()) meta["thirdPartyLicenses"] = kept;
        if (!said("otherLicenseUrl").empty()) meta["otherLicenseUrl"] = said("otherLicenseUrl");
        if (const Json& picture = member(from, "texture"); picture.is_number() && picture.get<double>() >= 0.0)
            item([&] { thumbnail(member(file_.list("textures")[file_.index(picture, file_.list("textures").size(), "texture")], "source"), avatar); });
        avatar["meta"] = std::move(meta);
        avatar["original"] = std::move(original);
    }

    void expressionsOfZero(const Json& vrm, Json& expressions) {
        static const std::map<std::string, const char*> kPresets = {{"a", "aa"}, {"i", "ih"}, {"u", "ou"}, {"e", "ee"}, {"o", "oh"}, {"blink", "blink"}, {"joy", "happy"}, {"angry", "angry"}, {"sorrow", "sad"},
            {"fun", "relaxed"}, {"lookup", "lookUp"}, {"lookdown", "lookDown"}, {"lookleft", "lookLeft"}, {"lookright", "lookRight"}, {"blink_l", "blinkLeft"}, {"blink_r", "blinkRight"}, {"neutral", "neutral"}};
        std::set<std::string> taken;
        for (const Json& group : file_.array(member(member(vrm, "blendShapeMaster"), "blendShapeGroups"))) {
            if (expressions.size() == kMostExpressions) break;
            item([&] {
                const auto preset = kPresets.find(text(member(group, "presetName")));
                const bool known = preset != kPresets.end() && !taken.contains(preset->second);
                Json to{{"name", known ? std::string(preset->second) : uniqueName(taken, cleanName(text(member(group, "name")), "expression"))}, {"preset", known}};
                if (known) taken.insert(preset->second);
                copy(group, {"isBinary"}, to);
                Json& morphs = to["morphs"] = Json::array();
                for (const Json& bind : file_.array(member(group, "binds")))
                    item([&] {
                        for (const std::size_t n : nodesOf(member(bind, "mesh")))
                            addMorph(morphs, n, static_cast<std::size_t>(file_.number(member(bind, "index"), "morph target")), file_.number(member(bind, "weight"), 100.0) / 100.0);
                    });
                dropped_ += file_.array(member(group, "materialValues")).size();
                expressions.push_back(std::move(to));
            });
        }
    }

    /// 0.x has its vectors as {x, y, z}, whose z points the other way where `turned`.
    static Json vector(const Json& from, bool turned, std::array<double, 3> otherwise) {
        const char* const axes[] = {"x", "y", "z"};
        Json out = Json::array();
        for (std::size_t k = 0; k < 3; ++k) {
            const Json& v = member(from, axes[k]);
            const double x = v.is_number() && std::abs(v.get<double>()) < 1e9 ? v.get<double>() : otherwise[k];
            out.push_back(turned && k == 2 ? 0.0 - x : x);
        }
        return out;
    }

    void lookAtOfZero(const Json& first, Json& avatar) {
        if (!first.is_object()) return;
        Json look{{"type", text(member(first, "lookAtTypeName")) == "BlendShape" ? "expression" : "bone"}, {"offsetFromHeadBone", vector(member(first, "firstPersonBoneOffset"), true, {0.0, 0.06, 0.0})}};
        for (const auto& [from, to] : {std::pair{"lookAtHorizontalInner", "rangeMapHorizontalInner"}, {"lookAtHorizontalOuter", "rangeMapHorizontalOuter"}, {"lookAtVerticalDown", "rangeMapVerticalDown"}, {"lookAtVerticalUp", "rangeMapVerticalUp"}})
            if (const Json& map = member(first, from); map.is_object()) {
                const double most = look["type"] == "expression" ? 1.0 : file_.number(member(map, "yRange"), 10.0);
                look[to] = {{"inputMaxValue", std::clamp(file_.number(member(map, "xRange"), 90.0), 0.0, 180.0)}, {"outputScale", std::clamp(most, -360.0, 360.0)}};
            }
        avatar["lookAt"] = std::move(look);
    }

    void springsOfZero(const Json& from, Json& avatar) {
        if (!from.is_object()) return;
        Json out{{"colliders", Json::array()}, {"colliderGroups", Json::array()}, {"springs", Json::array()}};
        item([&] {
            for (const Json& group : file_.array(member(from, "colliderGroups"))) {
                Json to{{"colliders", Json::array()}};
                item([&] {
                    const std::string bone = boneName(member(group, "node"));
                    for (const Json& collider : file_.array(member(group, "colliders"))) {
                        if (bone.empty()) {
                            ++dropped_;
                            continue;
                        }
                        to["colliders"].push_back(out["colliders"].size());
                        out["colliders"].push_back({{"bone", bone}, {"shape", {{"sphere", {{"offset", vector(member(collider, "offset"), true, {0, 0, 0})}, {"radius", file_.number(member(collider, "radius"), 0.0)}}}}}});
                    }
                });
                out["colliderGroups"].push_back(std::move(to));
            }
            for (const Json& group : file_.array(member(from, "boneGroups")))
                for (const Json& root : file_.array(member(group, "bones"))) item([&] { chain(group, node(root), 0, out); });
        });
        avatar["springBone"] = std::move(out);
    }

    /// All that hangs on a node swings: a spring down the first children, and one for each of the others.
    void chain(const Json& group, std::size_t from, int depth, Json& out) {
        if (depth > kLongestChain || out["springs"].size() >= kMostSprings) return;
        Json joint;
        joint["stiffness"] = file_.number(member(group, "stiffiness"), 1.0);  // so spelt there
        joint["gravityPower"] = file_.number(member(group, "gravityPower"), 0.0);
        joint["gravityDir"] = vector(member(group, "gravityDir"), false, {0.0, -1.0, 0.0});
        joint["dragForce"] = file_.number(member(group, "dragForce"), 0.4);
        joint["hitRadius"] = file_.number(member(group, "hitRadius"), 0.02);
        Json spring{{"joints", Json::array()}};
        if (!text(member(group, "comment")).empty()) spring["name"] = text(member(group, "comment"));
        for (const Json& g : file_.array(member(group, "colliderGroups"))) spring["colliderGroups"].push_back(file_.index(g, out["colliderGroups"].size(), "collider group"));
        std::vector<std::size_t> others;
        for (std::size_t at = from; depth <= kLongestChain; ++depth) {
            const int bone = names_.bone(at);
            if (bone < 0) break;
            joint["bone"] = rig_.bones[static_cast<std::size_t>(bone)].name;
            spring["joints"].push_back(joint);
            const Json& children = file_.array(member(file_.list("nodes")[at], "children"));
            if (children.empty()) break;
            for (std::size_t c = 1; c < children.size(); ++c) others.push_back(node(children[c]));
            at = node(children[0]);
        }
        if (!spring["joints"].empty()) out["springs"].push_back(std::move(spring));
        for (const std::size_t other : others) chain(group, other, depth + 1, out);
    }

    GltfFileReader& file_;
    const VrmNames& names_;
    Rig& rig_;
    std::size_t nodes_;
};

/// Adds the nodes below one, itself included. A file may say that nodes are below themselves: each is visited once.
void addBelow(const GltfFileReader& file, std::size_t node, int depth, std::set<std::size_t>& visited) {
    if (!visited.insert(node).second || depth > kLongestChain) return;
    const Json& nodes = file.list("nodes");
    for (const Json& child : file.array(member(nodes[node], "children"))) addBelow(file, file.index(child, nodes.size(), "node"), depth + 1, visited);
}

}  // namespace

Vrm vrmOf(const GltfFileReader& file) {
    const Json& extensions = member(file.root(), "extensions");
    return member(extensions, "VRMC_vrm").is_object() ? Vrm::One : member(extensions, "VRM").is_object() ? Vrm::Zero : Vrm::None;
}

std::vector<std::size_t> vrmNodes(const GltfFileReader& file) {
    std::set<std::size_t> out, hanging;
    const std::size_t nodes = file.list("nodes").size();
    const Json& extensions = member(file.root(), "extensions");
    const auto take = [&](const Json& at, bool all) {
        try {
            const std::size_t n = file.index(at, nodes, "node");
            if (all)
                addBelow(file, n, 0, hanging);
            else
                out.insert(n);
        } catch (const GltfFileReader::Refused&) {  // told when it is read
        }
    };
    // A list that is none is told when it is read.
    const auto each = [](const Json& list, const auto& use) {
        if (list.is_array() || list.is_object())
            for (const Json& one : list) use(one);
    };
    if (vrmOf(file) == Vrm::One) {
        each(member(member(member(extensions, "VRMC_vrm"), "humanoid"), "humanBones"), [&](const Json& bone) { take(member(bone, "node"), false); });
        each(member(member(extensions, "VRMC_springBone"), "springs"), [&](const Json& spring) { each(member(spring, "joints"), [&](const Json& joint) { take(member(joint, "node"), false); }); });
    } else if (vrmOf(file) == Vrm::Zero) {
        each(member(member(member(extensions, "VRM"), "humanoid"), "humanBones"), [&](const Json& bone) { take(member(bone, "node"), false); });
        each(member(member(member(extensions, "VRM"), "secondaryAnimation"), "boneGroups"), [&](const Json& group) { each(member(group, "bones"), [&](const Json& bone) { take(bone, true); }); });
    }
    out.merge(hanging);
    return {out.begin(), out.end()};
}

void readVrm(GltfFileReader& file, const VrmNames& names, Rig& rig, RawScene& scene) {
    const Vrm version = vrmOf(file);
    if (version == Vrm::None) return;
    VrmReader reader(file, names, rig);
    const Json avatar = reader.read(version);
    rig.avatar = avatar.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (rig.avatar.size() > kLargestAvatar) {
        rig.avatar.clear();
        tell(scene, Severity::Warning, "avatar", "What the file says of its avatar is too large and was left out.", 1);
        return;
    }
    std::string known;
    const auto add = [&](std::size_t n, const char* one, const char* several) {
        if (n > 0) known += (known.empty() ? " of " : ", ") + std::to_string(n) + " " + (n == 1 ? one : several);
    };
    add(rig.roles.size(), "humanoid bone", "humanoid bones");
    add(avatar["expressions"].size(), "expression", "expressions");
    tell(scene, Severity::Info, "avatar", "A VRM avatar" + known + ".", 1, false);
    const std::size_t springs = avatar.contains("springBone") ? avatar["springBone"]["springs"].size() : 0;
    if (springs > 0 || avatar.contains("lookAt") || !avatar["firstPerson"].empty())
        tell(scene, Severity::Info, "avatar-kept", "Springs, first person and look-at of the avatar are kept for export and move nothing here.", springs + avatar["firstPerson"].size() + avatar.contains("lookAt"), false);
    std::size_t constraints = 0;
    for (const Json& node : file.list("nodes")) constraints += member(member(node, "extensions"), "VRMC_node_constraint").is_null() ? 0 : 1;
    if (constraints > 0) tell(scene, Severity::Info, "avatar-constraints", "Constraints between bones of the avatar have no effect here, and are not exported.", constraints, false);
    if (reader.dropped_ > 0) tell(scene, Severity::Info, "avatar-dropped", "Settings of the avatar for pictures, materials and things that were not imported were left out.", reader.dropped_, false);
    if (reader.damaged_ > 0) tell(scene, Severity::Warning, "avatar-damaged", "Settings of the avatar that are wrong, or about things that do not exist, were left out.", reader.damaged_, false);
}

}  // namespace imomushi
