// SPDX-License-Identifier: GPL-3.0-or-later
// Skeletons of files: what import answers and projects keep, and takes of clips.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <optional>
#include <tuple>

#include "core/proposal/rig_proposal.h"
#include "core/document/rig_follower.h"
#include "tests/document/read_character.h"
#include "tests/document/tamper.h"
#include "tests/document/workbench.h"
#include "tests/support/left_out.h"

using namespace imomushi;

namespace {

/// Bones of 2 m along the bar, "spine 1" to "spine 6" under a "hips" that stands at its foot and moves no vertex. Clip "wave": each bends by 0.25 within a second, the
/// hips move and turn. Clip "still" keeps them. All hang on a node "Armature" that is no bone.
Rig spine(const TriangleMesh& mesh, bool skin = true) {
    Rig rig;
    rig.nodes.emplace_back().name = "Armature";
    const auto add = [&](const std::string& name, int parent, const Vec3& local) {
        RigNode node;
        node.parent = parent + 1;
        node.translation = local;
        rig.nodes.push_back(node);
        RigBone bone;
        bone.name = name;
        bone.parent = parent;
        bone.node = static_cast<std::int32_t>(rig.nodes.size()) - 1;
        bone.head = parent < 0 ? local : Vec3(rig.bones[static_cast<std::size_t>(parent)].head + local);
        rig.bones.push_back(bone);
    };
    add("hips", -1, {0, 0, 0});
    for (int i = 1; i <= 6; ++i) add("spine " + std::to_string(i), i - 1, {0, 0, i == 1 ? 0.0 : 2.0});
    guessTails(rig);
    if (skin) {
        rig.weights.first.push_back(0);
        for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
            // A quarter of a metre before each joint goes over to the next bone, which has half of it there.
            const double z = mesh.vertices(v, 2) / 2.0, over = z - std::floor(z);
            const int bone = std::min(6, static_cast<int>(std::floor(z)) + 1);
            const float next = over > 0.875 && bone < 6 ? static_cast<float>((over - 0.875) / 0.25) : 0.0f;
            rig.weights.bone.push_back(bone);
            rig.weights.weight.push_back(1.0f - next);
            if (next > 0.0f) {
                rig.weights.bone.push_back(bone + 1);
                rig.weights.weight.push_back(next);
            }
            rig.weights.first.push_back(static_cast<std::int32_t>(rig.weights.bone.size()));
        }
    }
    RigClip wave{"wave", 1.0, {}};
    for (int n = 0; n <= 6; ++n) {
        RigTrack turn;
        turn.node = n + 1;
        turn.path = RigTrack::Path::Rotation;
        turn.times = {0.0, 1.0};
        const Eigen::Quaterniond to(Eigen::AngleAxisd(0.25, n % 2 ? Vec3::UnitX() : Vec3(0.6, 0.0, 0.8)));
        turn.values = {0, 0, 0, 1, to.x(), to.y(), to.z(), to.w()};
        wave.tracks.push_back(turn);
    }
    wave.tracks.push_back({1, RigTrack::Path::Translation, RigTrack::Interpolation::Linear, {0.0, 0.5, 1.0}, {0, 0, 0, 1, 2, 0, 1, 2, 3}});
    rig.clips = {wave, {"still", 0.5, {{1, RigTrack::Path::Translation, RigTrack::Interpolation::Step, {0.5}, {0, 0, 0}}}}};
    return rig;
}

struct RigBench : Workbench {
    RigBench() {
        session.services().importCharacter = [](const ImportRequest& request, const Progress& progress) -> Result<CharacterFile> {
            const std::string name = request.path.string();
            if (name == "bones") {
                if (!request.bonesSuffice) return fail("empty-mesh", "It holds bones but no mesh.");
                CharacterFile file;
                file.format = "shape";
                file.rig = spine(longBar(), false);
                return file;
            }
            auto file = characterFile({name.ends_with("worm") ? "trunk" : request.path, {}, {}, {}, {}}, progress);
            if (file && name == "worm") file->rig = spine(file->renderModel.mesh.body);
            if (name == "finer worm") return characterOf({shapes::box({-0.5, -0.5, 0.0}, {0.5, 0.5, 12.0}, 4, 4, 41).mesh}, {"trunk"});
            return file;
        };
    }

    /// Three elements that meet at the heads of "spine 3" and "spine 5", and bones from head to head under the names of the file.
    void buildWorm() {
        good({{"do", "import-character"}, {"path", "worm"}, {"name", "worm"}});
        good({{"do", "cut"}, {"element", "worm body"}, {"plane", {{"origin", {0, 0, 4.0}}, {"normal", {0, 0, 1}}}}, {"names", {"low", "rest"}}});
        good({{"do", "cut"}, {"element", "rest"}, {"plane", {{"origin", {0, 0, 8.0}}, {"normal", {0, 0, 1}}}}, {"names", {"middle", "high"}}});
        for (const char* element : {"low", "middle", "high"}) good({{"do", "set"}, {"target", element}, {"property", "solver-mesh"}, {"value", "as-is"}});
        good({{"do", "add-bone"}, {"name", "spine 1"}, {"element", "low"}, {"from", {0, 0, 0}}, {"to", {0, 0, 4}}});
        good({{"do", "add-bone"}, {"name", "spine 3"}, {"element", "middle"}, {"from", "spine 1/end"}, {"to", {0, 0, 8}}});
        good({{"do", "add-bone"}, {"name", "spine 5"}, {"element", "high"}, {"from", "spine 3/end"}, {"to", {0, 0, 11}}});
    }
};

/// Where the nodes of an exported file are at the keys of a clip, as another program sees it: floats, and all channels of a node have the same keys.
struct PlayedGlb {
    Json json;
    std::vector<double> times;  ///< of the clip

    PlayedGlb(const std::filesystem::path& path, const std::string& clip) {
        const std::string bytes = readFile(path);
        std::uint32_t length = 0;
        std::memcpy(&length, bytes.data() + 12, 4);
        json = Json::parse(bytes.substr(20, length));
        const char* binary = bytes.data() + 20 + length + 8;
        const auto floats = [&](const Json& index) {
            const Json& accessor = json["accessors"][index.get<std::size_t>()];
            REQUIRE(accessor["componentType"] == 5126);
            const Json& view = json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
            const std::size_t width = accessor["type"] == "SCALAR" ? 1 : accessor["type"] == "VEC3" ? 3 : 4;
            std::vector<float> values(width * accessor["count"].get<std::size_t>());
            std::memcpy(values.data(), binary + view.value("byteOffset", std::size_t{0}) + accessor.value("byteOffset", std::size_t{0}), values.size() * sizeof(float));
            return values;
        };
        parent_.assign(json["nodes"].size(), -1);
        for (std::size_t n = 0; n < parent_.size(); ++n)
            for (const Json& child : json["nodes"][n].value("children", Json::array())) parent_[child.get<std::size_t>()] = static_cast<int>(n);
        for (const Json& animation : json["animations"]) {
            if (animation["name"] != clip) continue;
            for (const Json& channel : animation["channels"]) {
                const Json& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
                const auto keys = floats(sampler["input"]);
                times.assign(keys.begin(), keys.end());
                keys_[{channel["target"]["node"].get<int>(), channel["target"]["path"].get<std::string>()}] = floats(sampler["output"]);
            }
        }
    }

    [[nodiscard]] int nodeNamed(const std::string& name) const {
        for (std::size_t n = 0; n < parent_.size(); ++n)
            if (json["nodes"][n]["name"] == name) return static_cast<int>(n);
        return -1;
    }
    /// To the scene; without a key at rest.
    [[nodiscard]] Eigen::Affine3d world(int node, std::optional<std::size_t> key) const {
        Eigen::Affine3d out = Eigen::Affine3d::Identity();
        for (; node >= 0; node = parent_[static_cast<std::size_t>(node)]) {
            const auto numbers = [&](const char* path, std::vector<double> otherwise) {
                const auto found = keys_.find({node, path});
                if (key && found != keys_.end()) {
                    const auto from = found->second.begin() + static_cast<std::ptrdiff_t>(*key * otherwise.size());
                    return std::vector<double>(from, from + static_cast<std::ptrdiff_t>(otherwise.size()));
                }
                return json["nodes"][static_cast<std::size_t>(node)].value(path, otherwise);
            };
            const auto t = numbers("translation", {0, 0, 0}), r = numbers("rotation", {0, 0, 0, 1}), s = numbers("scale", {1, 1, 1});
            out = Eigen::Translation3d(t[0], t[1], t[2]) * Eigen::Quaterniond(r[3], r[0], r[1], r[2]) * Eigen::Scaling(s[0], s[1], s[2]) * out;
        }
        return out;
    }
    /// The names of the nodes above a node, upward.
    [[nodiscard]] std::vector<std::string> above(int node) const {
        std::vector<std::string> out;
        for (int n = parent_[static_cast<std::size_t>(node)]; n >= 0; n = parent_[static_cast<std::size_t>(n)]) out.push_back(json["nodes"][static_cast<std::size_t>(n)]["name"]);
        return out;
    }
    [[nodiscard]] bool isJoint(int node) const {
        const Json& joints = json["skins"][0]["joints"];
        return std::find(joints.begin(), joints.end(), node) != joints.end();
    }

private:
    std::vector<int> parent_;
    std::map<std::pair<int, std::string>, std::vector<float>> keys_;
};

const Rig& rigOf(Session& session) { return *session.document().characters.begin()->second->rig; }

}  // namespace

TEST_CASE("skeletons: import answers bones and clips, projects keep them, and undo takes them back") {
    RigBench w;
    const Json answer = w.good({{"do", "import-character"}, {"path", "worm"}, {"name", "worm"}});
    REQUIRE(answer["skeleton"].size() == 7);
    CHECK(answer["skeleton"][0]["name"] == "hips");
    CHECK(answer["skeleton"][0]["parent"].is_null());
    CHECK(answer["skeleton"][6]["parent"] == "spine 5");
    CHECK(answer["skeleton"][6]["start"] == Json::array({0.0, 0.0, 10.0}));
    CHECK(answer["skeleton"][6]["end"] == Json::array({0.0, 0.0, 12.0}));
    CHECK(answer["clips"] == Json::parse(R"([{"name": "wave", "seconds": 1.0}, {"name": "still", "seconds": 0.5}])"));
    const Json list = w.good({{"do", "list"}});
    CHECK(list["characters"][0]["skeleton"] == answer["skeleton"]);

    const auto path = w.folder() / "rig.imomushi", again = w.folder() / "rig again.imomushi";
    w.good({{"do", "save"}, {"path", path}});
    Workbench other;
    CHECK(other.good({{"do", "open"}, {"path", path}}) == list);
    CHECK(other.content() == w.content());
    other.good({{"do", "save"}, {"path", again}});
    CHECK(readFile(again) == readFile(path));
    CHECK(rigOf(other.session).weights.weight == rigOf(w.session).weights.weight);
    CHECK(rigOf(other.session).nodes[0].name == "Armature");
    CHECK(posedRig(rigOf(other.session), rigOf(other.session).clips[0], 0.7)[6].head == posedRig(rigOf(w.session), rigOf(w.session).clips[0], 0.7)[6].head);

    w.good({{"do", "undo"}});
    CHECK(w.session.document().characters.empty());
    w.good({{"do", "import-character"}, {"path", "trunk"}, {"name", "worm"}});
    const std::string before = w.content();
    CHECK(w.code({{"do", "take-clip"}, {"character", "worm"}, {"clip", "wave"}}) == "no-clip");

    // Bones alone are brought to it.
    CHECK(w.code({{"do", "import-character"}, {"path", "bones"}}) == "empty-mesh");
    CHECK(w.code({{"do", "import-skeleton"}, {"path", "bones"}, {"character", "snake"}}) == "no-such-character");
    CHECK(w.code({{"do", "import-skeleton"}, {"path", "ball"}, {"character", "worm"}}) == "no-skeleton");
    const Json brought = w.good({{"do", "import-skeleton"}, {"path", "bones"}, {"character", "worm"}});
    CHECK(brought["skeleton"] == answer["skeleton"]);
    CHECK(brought["weights"] == false);
    w.good({{"do", "undo"}});
    CHECK(w.content() == before);
    w.good({{"do", "redo"}});
    // Of the very same mesh weights come along.
    CHECK(w.good({{"do", "import-skeleton"}, {"path", "worm"}, {"character", "worm"}})["weights"] == true);
}

TEST_CASE("skeletons: a project appended beside brings its bones along") {
    RigBench w;
    w.good({{"do", "import-character"}, {"path", "worm"}, {"name", "worm"}});
    const auto path = w.folder() / "beside.imomushi";
    w.good({{"do", "save"}, {"path", path}});
    RigBench other;
    other.good({{"do", "append"}, {"path", path}, {"offset", {5, 0, 1}}});
    const Rig &here = rigOf(other.session), &there = rigOf(w.session);
    for (const double t : {0.0, 0.4, 1.0}) CHECK((posedRig(here, here.clips[0], t)[6].head - posedRig(there, there.clips[0], t)[6].head - Vec3(5, 0, 1)).norm() < 1e-12);
    CHECK((here.bones[6].tail - there.bones[6].tail - Vec3(5, 0, 1)).norm() < 1e-12);
}

TEST_CASE("skeletons: a mesh of other vertices loses the skin, which is told, and stays a project that can be opened") {
    RigBench w;
    w.good({{"do", "import-character"}, {"path", "worm"}, {"name", "worm"}});
    REQUIRE(!rigOf(w.session).weights.empty());
    w.good({{"do", "replace-mesh"}, {"character", "worm"}, {"path", "worm"}});
    CHECK(!rigOf(w.session).weights.empty());
    const Json answer = w.good({{"do", "replace-mesh"}, {"character", "worm"}, {"path", "finer worm"}});
    CHECK(answer["lost"][0]["what"] == "skin");
    CHECK(rigOf(w.session).weights.empty());
    CHECK(!rigOf(w.session).bones.empty());
    CHECK(w.good({{"do", "propose"}, {"character", "worm"}})["bones"].size() > 1);
    const auto path = w.folder() / "other-mesh.imomushi";
    w.good({{"do", "save"}, {"path", path}});
    CHECK(RigBench().good({{"do", "open"}, {"path", path}})["characters"].size() == 1);
}

TEST_CASE("skeletons: what a project file says of them is not trusted") {
    RigBench w;
    w.good({{"do", "import-character"}, {"path", "worm"}, {"name", "worm"}});
    const auto path = w.folder() / "tampered.imomushi";
    for (const char* change : {"UPDATE rig_bones SET parent=6 WHERE position=2", "UPDATE rig_bones SET node=99 WHERE position=2", "UPDATE rig_bones SET name='hips' WHERE position=2",
                               "UPDATE rig_bones SET position=9 WHERE position=2", "DELETE FROM rig_bones", "DELETE FROM rig_nodes WHERE position=6", "UPDATE rigs SET first=x'00'",
                               // in the middle an index beyond all: the fourth of 32 bits
                               "UPDATE rigs SET first=CAST(substr(first,1,12)||x'40420f00'||substr(first,17) AS BLOB)",
                               "UPDATE rigs SET bone=zeroblob(8)", "UPDATE rigs SET character=77", "UPDATE rig_tracks SET node=-1 WHERE position=1", "UPDATE rig_tracks SET times=zeroblob(16) WHERE position=1",
                               "UPDATE rig_tracks SET path=7 WHERE position=1", "UPDATE rig_clips SET seconds=-1.0", "UPDATE rig_clips SET seconds=0.25", "DELETE FROM rig_clips WHERE position=0",
                               "UPDATE rig_bones SET rotation=zeroblob(32)", "UPDATE rigs SET to_scene=x''", "UPDATE rig_nodes SET name=x'ff' WHERE position=0"}) {
        CAPTURE(change);
        w.good({{"do", "save"}, {"path", path}});
        sql(path, change);
        CHECK(Workbench().code({{"do", "open"}, {"path", path}}) == "damaged");
        sign(path);
        CHECK(Workbench().code({{"do", "open"}, {"path", path}}) == "damaged");
    }
}

TEST_CASE("skeletons: a clip becomes a take that moves joints exactly where the file does, and the flesh with them") {
    RigBench w;
    w.buildWorm();
    w.good({{"do", "precompute"}});
    CHECK(w.code({{"do", "take-clip"}, {"character", "worm"}, {"clip", "dance"}}) == "no-clip");
    CHECK(w.code({{"do", "take-clip"}, {"character", "worm"}, {"clip", "wave"}, {"fps", 0}}) == "bad-value");
    const std::string before = w.content();
    const Json taken = w.good({{"do", "take-clip"}, {"character", "worm"}, {"clip", "wave"}, {"fps", 30}});
    CHECK(taken["take"] == "wave");
    CHECK(taken["frames"] == 31);
    CHECK(taken["bones"] == 3);
    CHECK(taken["exact_joints"] == 3);  // the tip lies within the last bone
    CHECK(taken["carried_joints"] == 1);
    CHECK(w.code({{"do", "take-clip"}, {"character", "worm"}, {"clip", "wave"}}) == "name-taken");

    const Rig& rig = rigOf(w.session);
    const auto end = [&](const char* bone, bool atEnd) { return *w.session.positionOf({w.session.document().boneNamed(bone)->id, atEnd}); };
    for (const double t : {0.0, 0.5, 0.7, 1.0}) {
        CAPTURE(t);
        const Json shown = w.good({{"do", "play"}, {"take", "wave"}, {"time", t}});
        CHECK(shown["exact"] == true);
        const auto file = posedRig(rig, rig.clips[0], t);
        CHECK((end("spine 1", false) - file[1].head).norm() < 1e-12);
        CHECK((end("spine 3", false) - file[3].head).norm() < 1e-12);
        CHECK((end("spine 5", false) - file[5].head).norm() < 1e-12);
        CHECK((end("spine 5", true) - (file[5].head + file[5].rotation * Vec3(0, 0, 3))).norm() < 1e-12);
        // The flesh of the last element turns with its bone, twist and all: its rigid motion is the bone's, but for the elastic bend at the joint.
        const Points rest = w.session.document().elementNamed("high")->mesh->body.vertices, now = w.session.positionsOf(w.session.document().elementNamed("high")->id);
        double worst = 0.0;
        for (Eigen::Index v = 0; v < rest.rows(); ++v)
            if (rest(v, 2) > 11.0) worst = std::max(worst, (Vec3(now.row(v).transpose()) - file[5].head - file[5].rotation * (Vec3(rest.row(v).transpose()) - Vec3(0, 0, 8))).norm());
        CHECK(worst < 0.35);
    }
    w.good({{"do", "rest"}});
    w.good({{"do", "undo"}, {"count", 2}});
    CHECK(w.content() == before);
    w.good({{"do", "redo"}});
    CHECK(w.session.document().takes.size() == 1);

    // A clip between frames ends with its last key; the same twice.
    const Json slow = w.good({{"do", "take-clip"}, {"character", "worm"}, {"clip", "still"}, {"take", "stays"}, {"fps", 3}});
    CHECK(slow["frames"] == 3);
    CHECK(std::abs(slow["seconds"].get<double>() - 0.5) < 1e-12);
    w.good({{"do", "take-clip"}, {"character", "worm"}, {"clip", "wave"}, {"take", "again"}, {"fps", 30}});
    const Take &a = *w.session.document().takeNamed("wave"), &b = *w.session.document().takeNamed("again");
    CHECK(a.poses == b.poses);
    CHECK(a.shapes == b.shapes);
}

TEST_CASE("skeletons: bones without a counterpart are carried by what is nearest, and other characters stay at rest") {
    RigBench w;
    w.good({{"do", "import-character"}, {"path", "worm"}, {"name", "worm"}});
    CHECK(w.code({{"do", "take-clip"}, {"character", "worm"}, {"clip", "wave"}}) == "no-bone");
    w.good({{"do", "import-character"}, {"path", "ball"}, {"name", "ball"}});
    w.good({{"do", "add-bone"}, {"name", "own"}, {"element", "worm body"}, {"from", {0.1, 0, 4.5}}, {"to", {0, 0.1, 5.5}}});
    w.good({{"do", "add-bone"}, {"name", "other"}, {"element", "ball body"}, {"from", {0, 0, -0.5}}, {"to", {0, 0, 0.5}}});
    const Json taken = w.good({{"do", "take-clip"}, {"character", "worm"}, {"clip", "wave"}});
    CHECK(taken["bones"] == 1);
    CHECK(taken["exact_joints"] == 0);
    w.good({{"do", "play"}, {"take", "wave"}, {"time", 1.0}});
    const auto file = posedRig(rigOf(w.session), rigOf(w.session).clips[0], 1.0);
    CHECK((*w.session.positionOf({w.session.document().boneNamed("own")->id, true}) - (file[3].head + file[3].rotation * Vec3(0, 0.1, 1.5))).norm() < 1e-12);
    CHECK(*w.session.positionOf({w.session.document().boneNamed("other")->id, true}) == Vec3(0, 0, 0.5));
}

TEST_CASE("skeletons: make-soft makes elements and bones of the skeleton of a file, which its clips move exactly") {
    RigBench w;
    const Json made = w.good({{"do", "make-soft"}, {"path", "worm"}, {"name", "worm"}, {"precompute", false}});
    CAPTURE(made.dump());
    CHECK(made["refused"].empty());
    const Json list = w.good({{"do", "list"}});
    CHECK(list["elements"].size() == 6);
    REQUIRE(list["bones"].size() == 6);
    for (int i = 1; i <= 6; ++i) CHECK(list["bones"][static_cast<std::size_t>(i - 1)]["name"] == "spine " + std::to_string(i));
    const Json taken = w.good({{"do", "take-clip"}, {"character", "worm"}, {"clip", "wave"}});
    CHECK(taken["exact_joints"] == 6);
    CHECK(taken["carried_joints"] == 1);
    w.good({{"do", "play"}, {"take", "wave"}, {"time", 1.0}});
    const auto file = posedRig(rigOf(w.session), rigOf(w.session).clips[0], 1.0);
    for (int i = 1; i <= 6; ++i)
        CHECK((*w.session.positionOf({w.session.document().boneNamed("spine " + std::to_string(i))->id, false}) - file[static_cast<std::size_t>(i)].head).norm() < 1e-12);
    // What is asked for counts: fewer pieces, the shape, or everything.
    RigBench other;
    other.good({{"do", "import-character"}, {"path", "worm"}, {"name", "worm"}});
    const auto pieces = [&](const Json& more) {
        Json line{{"do", "propose"}, {"character", "worm"}};
        line.update(more);
        const Json answer = other.good(line);
        return std::pair(answer["from"].get<std::string>(), answer["cuts"].size());
    };
    CHECK(pieces(Json::object()) == std::pair(std::string("skeleton"), std::size_t{5}));
    CHECK(pieces({{"least", 0.2}}) == std::pair(std::string("skeleton"), std::size_t{2}));
    CHECK(pieces({{"from", "shape"}}).first == "shape");
    // Bones that are chosen stay, all others are merged into them, whatever flesh they move.
    const Json chosen = other.good({{"do", "propose"}, {"character", "worm"}, {"bones", {"spine 2", "spine 4"}}});
    REQUIRE(chosen["bones"].size() == 2);
    CHECK(chosen["bones"][0]["name"] == "spine 2");
    CHECK(chosen["bones"][1]["name"] == "spine 4");
    CHECK(chosen["cuts"].size() == 1);
    CHECK(chosen["merged"].size() + 2 == list["characters"][0]["skeleton"].size());
    CHECK(other.good({{"do", "propose"}, {"character", "worm"}, {"bones", Json::array()}})["bones"].size() == 1);
    CHECK(other.code({{"do", "propose"}, {"character", "worm"}, {"bones", {"spine 2", "fin"}}}) == "no-such-bone");
    CHECK(other.code({{"do", "propose"}, {"character", "worm"}, {"bones", {"spine 2"}}, {"least", 0.1}}) == "bad-value");
    CHECK(other.code({{"do", "propose"}, {"character", "worm"}, {"bones", {2}}}) == "bad-type");
    other.good({{"do", "make-soft"}, {"character", "worm"}, {"bones", {"spine 2", "spine 4"}}, {"precompute", false}});
    CHECK(other.session.document().bones.size() == 2);
}

TEST_CASE("skeletons: an export has the skeleton of the file: its names, hierarchy and places at rest, and its bones where the clip has them") {
    RigBench w;
    w.buildWorm();
    w.good({{"do", "precompute"}});
    w.good({{"do", "take-clip"}, {"character", "worm"}, {"clip", "wave"}, {"fps", 30}});
    const auto path = w.folder() / "wave.glb";
    const Rig& rig = rigOf(w.session);
    for (const char* layout : {"skinned", "baked", "rigged"}) {
        CAPTURE(layout);
        const Json told = w.good({{"do", "export"}, {"path", path}, {"layout", layout}});
        const PlayedGlb played(path, "wave");
        REQUIRE(played.times.size() == 31);
        CHECK(played.above(played.nodeNamed("hips")).front() == "Armature");
        for (std::size_t b = 0; b < rig.bones.size(); ++b) {
            CAPTURE(rig.bones[b].name);
            const int node = played.nodeNamed(rig.bones[b].name);
            REQUIRE(node >= 0);
            CHECK(played.isJoint(node));
            const Eigen::Affine3d rest = played.world(node, std::nullopt);
            CHECK((rest.translation() - rig.bones[b].head).norm() < 1e-5);
            CHECK((rest.linear() - rig.bones[b].rotation.toRotationMatrix()).norm() < 1e-6);
            if (rig.bones[b].parent >= 0) CHECK(played.above(node).front() == rig.bones[static_cast<std::size_t>(rig.bones[b].parent)].name);
        }
        // Bones of the document start at heads of these,
        for (const std::size_t bone : {3U, 5U})
            for (std::size_t k = 0; k < 31; k += 6) CHECK((played.world(played.nodeNamed(rig.bones[bone].name), k).translation() - posedRig(rig, rig.clips[0], played.times[k])[bone].head).norm() < 1e-5);
        // and the others keep their place relative to what they were merged into.
        for (const std::size_t bone : {2U, 4U, 6U}) {
            const Eigen::Affine3d one = played.world(played.nodeNamed(rig.bones[bone - 1].name), 30), two = played.world(played.nodeNamed(rig.bones[bone].name), 30);
            CHECK((one.inverse() * two.translation() - Vec3(0, 0, 2)).norm() < 1e-5);
        }
        CHECK(told["check"]["max_percent"].get<double>() <= (layout == std::string("skinned") ? 1.1 * told["skin"]["max_percent"].get<double>() + 1e-4 : 1e-3));
    }
    // Weights are on bones of the file, merged ones among them as it has them: a bend of the old skeleton bends the flesh there.
    w.good({{"do", "export"}, {"path", path}, {"layout", "skinned"}});
    const PlayedGlb skin(path, "wave");
    for (const int bone : {1, 2, 3, 4, 5, 6}) CHECK(skin.isJoint(skin.nodeNamed("spine " + std::to_string(bone))));
    CHECK(skin.nodeNamed("worm body frame") == -1);
}

TEST_CASE("skeletons: clips of third-party files as takes of their proposals, exported") {
    namespace fs = std::filesystem;
    if (!fs::exists(IMOMUSHI_SHARED_MESHES)) return leaveOut("no folder " IMOMUSHI_SHARED_MESHES);
    for (const auto& [file, clip] : {std::pair("Fox.glb", "Run"), std::pair("snake-animations.glb", "Side winding"), std::pair("character.glb", "walk")}) {
        CAPTURE(file);
        Workbench w;
        w.session.services().importCharacter = readCharacter;
        w.good({{"do", "import-character"}, {"path", fs::path(IMOMUSHI_SHARED_MESHES) / file}, {"name", "it"}});
        const auto character = w.session.document().characters.begin()->second;
        const auto proposal = proposeFromRig(*character->rig, character->model->mesh.body, character->body->mesh, std::nullopt, {});
        REQUIRE(proposal);
        for (std::size_t c = 0; c < proposal->cuts.size(); ++c) {
            const ProposedCut& cut = proposal->cuts[c];
            // The piece that it divides is that of its bone's parent.
            const auto own = std::find_if(proposal->bones.begin(), proposal->bones.end(), [&](const ProposedBone& bone) { return bone.piece == static_cast<int>(c); });
            const int above = proposal->bones[static_cast<std::size_t>(own->parent)].piece;
            w.good({{"do", "cut"}, {"element", "it"}, {"plane", {{"origin", {cut.plane.origin.x(), cut.plane.origin.y(), cut.plane.origin.z()}}, {"normal", {cut.plane.normal.x(), cut.plane.normal.y(), cut.plane.normal.z()}}}},
                    {"names", {above < 0 ? "it body" : proposal->cuts[static_cast<std::size_t>(above)].piece, cut.piece}}});
        }
        for (const ProposedBone& bone : proposal->bones) {
            const auto point = [](const Vec3& p) { return Json::array({p.x(), p.y(), p.z()}); };
            const Json from = bone.parent < 0 ? point(bone.start) : Json(proposal->bones[static_cast<std::size_t>(bone.parent)].name + (bone.fromParentStart ? "/start" : "/end"));
            w.good({{"do", "add-bone"}, {"name", bone.name}, {"element", bone.piece < 0 ? "it body" : proposal->cuts[static_cast<std::size_t>(bone.piece)].piece}, {"from", from}, {"to", point(bone.end)}});
        }
        const auto start = std::chrono::steady_clock::now();
        const Json taken = w.good({{"do", "take-clip"}, {"character", "it"}, {"clip", clip}});
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        // Where bones meet beside a section, the joint there is theirs all the same.
        for (const auto& joint : w.session.plan().input.joints)
            if (joint.faces.size() > 1 && file != std::string("character.glb")) CHECK(joint.point >= 0);
        const fs::path given = std::getenv("IMOMUSHI_RIG_EXPORTS") ? std::getenv("IMOMUSHI_RIG_EXPORTS") : w.folder();
        const fs::path path = given / (fs::path(file).stem().string() + "-take.glb");
        w.good({{"do", "export"}, {"path", path}, {"layout", "skinned"}});
        const PlayedGlb played(path, clip);
        const Rig& rig = *character->rig;
        const Points& vertices = character->model->mesh.body.vertices;
        const double diagonal = (vertices.colwise().maxCoeff() - vertices.colwise().minCoeff()).norm();
        const RigClip& asked = rig.clips[static_cast<std::size_t>(rig.clipIndex(clip))];
        double worst = 0.0;
        int joints = 0;
        for (const ProposedBone& bone : proposal->bones) {
            if (bone.name != rig.bones[static_cast<std::size_t>(bone.joint)].name || bone.parent < 0) continue;
            // As the take has it,
            const Take& take = *w.session.document().takeNamed(clip);
            for (std::size_t f = 0; f < take.times.size(); f += 7) {
                w.good({{"do", "play"}, {"take", clip}, {"time", take.times[f]}});
                CHECK((*w.session.positionOf({w.session.document().boneNamed(bone.name)->id, false}) - posedRig(rig, asked, take.times[f])[static_cast<std::size_t>(bone.joint)].head).norm() < 1e-9 * diagonal);
            }
            // and as the file has it.
            for (std::size_t k = 0; k < played.times.size(); k += 7)
                worst = std::max(worst, (played.world(played.nodeNamed(bone.name), k).translation() - posedRig(rig, asked, played.times[k])[static_cast<std::size_t>(bone.joint)].head).norm() / diagonal);
            ++joints;
        }
        for (const RigBone& bone : rig.bones) CHECK((played.world(played.nodeNamed(bone.name), std::nullopt).translation() - bone.head).norm() < 1e-6 * diagonal);
        std::printf("%-24s %-14s %3d frames %.2f s, %d exact joints, %d carried; %d joints of the export, within %.2g diagonals\n", file, clip, taken["frames"].get<int>(), seconds,
                    taken["exact_joints"].get<int>(), taken["carried_joints"].get<int>(), joints, worst);
        CHECK(worst < 1e-4);
        CHECK(joints >= 3);
    }
}

TEST_CASE("skeletons: clips of a file of bones alone come to the skeleton of a character, in another rest pose, and say what they could not follow") {
    const std::filesystem::path characters = std::filesystem::path(IMOMUSHI_TEST_DATA) / "characters";
    for (const char* name : {"mannequin.glb", "avatar.glb", "avatar_vrm0.vrm"}) {
        CAPTURE(name);
        Workbench w;
        w.session.services().importCharacter = readCharacter;
        w.good({{"do", "import-character"}, {"path", characters / name}, {"name", "it"}});
        CHECK(w.code({{"do", "import-character"}, {"path", characters / "walk.glb"}}) == "empty-mesh");
        CHECK(w.code({{"do", "import-clips"}, {"character", "it"}, {"path", characters / "pointer_clip.gltf"}}) == "no-counterpart");
        const std::size_t before = rigOf(w.session).clips.size();
        const Json answer = w.good({{"do", "import-clips"}, {"character", "it"}, {"path", characters / "walk.glb"}});
        REQUIRE(answer["clips"].size() == 1);
        CHECK(answer["clips"][0]["name"] == "walk");
        CHECK(answer["clips"][0]["not_followed"].empty());
        CHECK(answer["clips"][0]["bones"].get<int>() >= 17);
        const Rig& rig = rigOf(w.session);
        REQUIRE(rig.clips.size() == before + 1);
        // As the source has it: arms and legs point the same way, within a degree.
        ImportRequest request;
        request.path = characters / "walk.glb";
        request.bonesSuffice = true;
        const auto walk = readCharacter(request, {});
        REQUIRE(walk);
        const bool vrm = name != std::string("mannequin.glb");
        double worst = 0.0;
        for (const double t : {0.0, 0.13, 0.3, 0.55, 0.9}) {
            const auto a = posedRig(*walk->rig, walk->rig->clips[0], t), b = posedRig(rig, rig.clips.back(), t);
            for (const auto& [from, to, own, next] : {std::tuple{"rig:LeftArm", "rig:LeftForeArm", "upperArm.L", "lowerArm.L"}, {"rig:RightForeArm", "rig:RightHand", "lowerArm.R", "hand.R"}}) {
                const auto at = [](const Rig& r, const std::vector<RigPose>& pose, const char* bone) {
                    REQUIRE(r.boneIndex(bone) >= 0);
                    return pose[static_cast<std::size_t>(r.boneIndex(bone))].head;
                };
                const Vec3 x = at(*walk->rig, a, to) - at(*walk->rig, a, from), y = at(rig, b, vrm ? next : to) - at(rig, b, vrm ? own : from);
                worst = std::max(worst, std::acos(std::min(1.0, x.normalized().dot(y.normalized()))));
            }
        }
        CHECK(worst < 1.0 * std::acos(-1.0) / 180.0);
        // It is a clip like any other: undone, kept by a project, and twice with another name.
        CHECK(w.good({{"do", "import-clips"}, {"character", "it"}, {"path", characters / "walk.glb"}})["clips"][0]["name"] == "walk 2");
        w.good({{"do", "undo"}});
        const auto path = w.folder() / "clips.imomushi";
        w.good({{"do", "save"}, {"path", path}});
        Workbench other;
        other.good({{"do", "open"}, {"path", path}});
        CHECK(rigOf(other.session).clips.back().tracks.size() == rigOf(w.session).clips.back().tracks.size());
        w.good({{"do", "undo"}});
        CHECK(rigOf(w.session).clips.size() == before);
    }
    Workbench w;
    w.good({{"do", "import-character"}, {"path", "trunk"}, {"name", "it"}});
    CHECK(w.code({{"do", "import-clips"}, {"character", "it"}, {"path", "x"}}) == "no-skeleton");
}
