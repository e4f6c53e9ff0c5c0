// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/io/glb.h"
#include "tests/support/folder.h"
#include "tests/support/left_out.h"
#include "tests/support/plain_sample.h"
#include "tests/support/shapes.h"

using Json = nlohmann::ordered_json;
using imomushi::plainLines;

namespace {

constexpr int kFrames = 45, kKeys = 10;  // of a take at 60 frames per second, and times that are compared
constexpr double kExact = 1e-5;          // of the diagonal
constexpr double kJoints = 1e-4;         // joints of imported skeletons: of the diagonal
constexpr double kLive = 1e-4;           // what follows a drag
constexpr int kNoBrowser = 77;           // exit status of check_browser.js

const std::filesystem::path& folder() {
    static const imomushi::TestFolder folder("imomushi-clients");
    return folder.path();
}

using imomushi::leaveOut;
using imomushi::readFile;

/// Runs a command in the folder; what it printed.
std::string run(const std::string& command, int& status) {
    const int code = std::system(("cd '" + folder().string() + "' && " + command + " >out 2>err").c_str());
    status = WIFEXITED(code) ? WEXITSTATUS(code) : -1;
    return readFile(folder() / "out");
}

bool hasNode() {
    int status = 0;
    run("node --version", status);
    const bool there = status == 0 && std::filesystem::exists(IMOMUSHI_CLIENTS "/node_modules/.package-lock.json");
    if (!there) leaveOut("node or its packages are not installed (packaging/install.sh test)");
    return there;
}

bool hasBlender() {
    int status = 0;
    run("blender --version", status);
    if (status != 0) leaveOut("Blender is not installed");
    return status == 0;
}

std::string number(int i) { return "p" + std::to_string(i) + ".obj"; }
int frameOf(int key) { return key * kFrames / (kKeys - 1); }

std::vector<Json> perform(const std::vector<Json>& lines) {
    std::ofstream script(folder() / "script.jsonl");
    for (const Json& line : lines) script << line.dump() << "\n";
    script.close();
    int status = 0;
    std::istringstream out(run("'" IMOMUSHI_PROGRAM "' run script.jsonl", status));
    std::vector<Json> answers;
    for (std::string line; std::getline(out, line);) answers.push_back(Json::parse(line));
    INFO(readFile(folder() / "out"));
    REQUIRE(status == 0);
    return answers;
}

struct Sample {
    const char* name;
    std::vector<Json> drags;
};

const std::vector<Sample>& samples() {
    static const std::vector<Sample> all = {
        {"caterpillar", {{{"do", "drag"}, {"endpoint", "head-bone/end"}, {"to", {0.8, 1.0, 0.4}}, {"seconds", 0.5}}}},
        {"octopus", {}},
        {"figure", {}},
    };
    return all;
}

/// Records a sample and writes it in every way; positions at kKeys times into p0.obj ... and at rest into rest.obj.
std::vector<Json> exportSample(const Sample& sample, const std::vector<Json>& exports) {
    const std::string project = std::string(IMOMUSHI_SAMPLES "/") + sample.name + ".imomushi";
    std::vector<Json> drags = sample.drags;
    if (drags.empty()) {
        // The last bone's end, a fifth of the character away from where it is.
        const auto opened = perform({{{"do", "open"}, {"path", project}}, {{"do", "measure"}, {"what", "bounds"}}});
        const std::string end = opened[0]["bones"].back()["name"].get<std::string>() + "/end";
        const auto at = perform({{{"do", "open"}, {"path", project}}, {{"do", "measure"}, {"what", "position"}, {"endpoint", end}}})[1]["value"];
        const double size = opened[1]["value"]["high"][1].get<double>() - opened[1]["value"]["low"][1].get<double>();
        drags.push_back({{"do", "drag"}, {"endpoint", end}, {"to", {at[0].get<double>() + 0.1 * size, at[1].get<double>() + 0.1 * size, at[2].get<double>() + 0.2 * size}}, {"seconds", 0.5}});
    }
    std::vector<Json> lines = {{{"do", "open"}, {"path", project}}, {{"do", "write-mesh"}, {"path", "rest.obj"}, {"state", "rest"}}};
    for (const Json& line : plainLines(sample.name)) lines.push_back(line);
    lines.push_back({{"do", "record"}, {"take", "t"}, {"action", "start"}});
    lines.insert(lines.end(), drags.begin(), drags.end());
    lines.push_back({{"do", "step"}, {"frames", kFrames}});
    lines.push_back({{"do", "record"}, {"take", "t"}, {"action", "stop"}});
    for (int k = 0; k < kKeys; ++k) {
        lines.push_back({{"do", "play"}, {"take", "t"}, {"time", std::min(frameOf(k) / 60.0, kFrames / 60.0)}});
        lines.push_back({{"do", "write-mesh"}, {"path", number(k)}});
    }
    lines.insert(lines.end(), exports.begin(), exports.end());
    auto answers = perform(lines);
    answers.erase(answers.begin(), answers.end() - static_cast<std::ptrdiff_t>(exports.size()));
    return answers;
}

Json exported(const char* path, const char* layout, const char* preset = "exact") { return {{"do", "export"}, {"path", path}, {"layout", layout}, {"preset", preset}}; }

/// The JSON of a .glb file.
Json contentOf(const char* file) {
    const std::string bytes = readFile(folder() / file);
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, sizeof length);
    return Json::parse(bytes.substr(20, length));
}

/// Checks jobs (check_browser.js) by three.js in Chromium, or without WebGL in node; the answer says "renderer" in Chromium only.
Json inThree(const Json& jobs) {
    std::ofstream(folder() / "jobs.json") << jobs.dump();
    int status = 0;
    std::string out = run("node '" IMOMUSHI_CLIENTS "/check_browser.js' jobs.json", status);
    if (status == kNoBrowser) {
        leaveOut("WebGL, as Chromium is not installed (packaging/install.sh test)");
        out = run("node '" IMOMUSHI_CLIENTS "/check_node.js' jobs.json", status);
    }
    INFO(jobs.dump() << "\n" << out << readFile(folder() / "err"));
    REQUIRE(status == 0);
    return Json::parse(out);
}

/// What a file may be away: 1e-5, or what the export said.
double room(const Json& answer) {
    double most = kExact;
    for (const char* what : {"skin", "dropped_targets", "render_mesh"})
        if (answer.contains(what)) most += answer[what]["max_percent"].get<double>() / 100.0;
    return most;
}

/// Checks jobs (check_blender.py) by Blender; an answer per job.
Json inBlender(const Json& jobs) {
    std::ofstream(folder() / "jobs.json") << jobs.dump();
    int status = 0;
    std::istringstream out(run("blender --background --factory-startup --python-exit-code 2 --python '" IMOMUSHI_CLIENTS "/check_blender.py' -- jobs.json", status));
    Json answers;
    for (std::string line; std::getline(out, line);)
        if (line.starts_with("imomushi ")) answers = Json::parse(line.substr(9));
    INFO(answers.dump() << "\n" << readFile(folder() / "err"));
    CHECK(status == 0);
    REQUIRE(answers.size() == jobs.size());
    return answers;
}

/// A PNG picture of one orange pixel.
const std::vector<std::uint8_t> kOrange = {
    137, 80, 78, 71, 13, 10, 26, 10, 0, 0, 0, 13, 73, 72, 68, 82, 0, 0, 0, 1, 0, 0, 0, 1, 8, 2, 0, 0, 0, 144, 119, 83, 222, 0, 0, 0, 12, 73, 68, 65, 84, 120,
    218, 99, 120, 208, 96, 0, 0, 3, 212, 1, 145, 127, 44, 229, 236, 0, 0, 0, 0, 73, 69, 78, 68, 174, 66, 96, 130};

/// A worm of 1.2 m that stands up, in the way of many programs: a skeleton in centimetres under a node that makes metres of them, five bones along their own +Y, a skin. A texture under white vertex colours. "fat" is a morph target; the clip
/// "talk" bends the upper bones and weighs it, within half a second.
std::string wormGlb() {
    imomushi::io_test::Glb glb;
    constexpr int kBones = 5;
    const auto box = imomushi::shapes::box({-0.1, 0.0, -0.1}, {0.1, 1.2, 0.1}, 2, 24, 2).mesh;
    std::vector<float> positions, weights, fat, bind;
    std::vector<std::uint8_t> joints;
    std::vector<std::uint16_t> corners;
    for (Eigen::Index v = 0; v < box.vertices.rows(); ++v) {
        const imomushi::Vec3 at = box.vertices.row(v).transpose();
        for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(at[k])), fat.push_back(static_cast<float>(k == 1 || at.y() < 0.9 ? 0.0 : at[k]));
        const double along = at.y() / 0.24, over = along - std::floor(along);
        const int bone = std::min(kBones - 1, static_cast<int>(along));
        const float next = bone + 1 < kBones && over > 0.75 ? static_cast<float>((over - 0.75) / 0.5) : 0.0f;
        joints.insert(joints.end(), {static_cast<std::uint8_t>(bone), static_cast<std::uint8_t>(std::min(kBones - 1, bone + 1)), 0, 0});
        weights.insert(weights.end(), {1.0f - next, next, 0.0f, 0.0f});
    }
    for (Eigen::Index i = 0; i < box.triangles.size(); ++i) corners.push_back(static_cast<std::uint16_t>(box.triangles.data()[i]));
    for (int b = 0; b < kBones; ++b) bind.insert(bind.end(), {100, 0, 0, 0, 0, 100, 0, 0, 0, 0, 100, 0, 0, -24.0f * static_cast<float>(b), 0, 1});
    const int at = glb.floats(positions, "VEC3", 3), index = glb.indices(corners), j = glb.bytes(joints, "VEC4", 4), w = glb.floats(weights, "VEC4", 4), target = glb.floats(fat, "VEC3", 3);
    const int inverse = glb.floats(bind, "MAT4", 16), times = glb.floats({0.0f, 0.25f, 0.5f}, "SCALAR", 1), turn = glb.floats({0, 0, 0, 1, 0, 0, 0.2f, 0.979796f, 0.2f, 0, 0, 0.979796f}, "VEC4", 4),
              weigh = glb.floats({0.0f, 1.0f, -0.5f}, "SCALAR", 1);
    const auto vertices = positions.size() / 3;
    const int white = glb.floats(std::vector<float>(3 * vertices, 1.0f), "VEC3", 3), uv = glb.floats(std::vector<float>(2 * vertices, 0.5f), "VEC2", 2);
    const nlohmann::json picture = glb.json["accessors"][static_cast<std::size_t>(glb.bytes(kOrange, "SCALAR", 1))]["bufferView"];
    glb.json["images"] = {{{"bufferView", picture}, {"mimeType", "image/png"}}};
    glb.json["textures"] = {{{"source", 0}}};
    glb.json["materials"] = {{{"name", "skin"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    glb.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", at}, {"COLOR_0", white}, {"TEXCOORD_0", uv}, {"JOINTS_0", j}, {"WEIGHTS_0", w}}}, {"indices", index}, {"material", 0}, {"targets", {{{"POSITION", target}}}}}}},
                           {"weights", {0.0}}, {"extras", {{"targetNames", {"fat"}}}}}};
    glb.json["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"name", "skin"}}, {{"name", "Armature"}, {"scale", {0.01, 0.01, 0.01}}, {"children", {2}}}};
    nlohmann::json channels = nlohmann::json::array(), own = nlohmann::json::array();
    for (int b = 0; b < kBones; ++b) {
        nlohmann::json node{{"name", "bone " + std::to_string(b)}, {"translation", {0, b == 0 ? 0 : 24, 0}}};
        if (b + 1 < kBones) node["children"] = {b + 3};
        glb.json["nodes"].push_back(std::move(node));
        own.push_back(b + 2);
        if (b >= 2) channels.push_back({{"sampler", 0}, {"target", {{"node", b + 2}, {"path", "rotation"}}}});
    }
    channels.push_back({{"sampler", 1}, {"target", {{"node", 0}, {"path", "weights"}}}});
    glb.json["skins"] = {{{"joints", std::move(own)}, {"inverseBindMatrices", inverse}}};
    glb.json["scenes"] = {{{"nodes", {0, 1}}}};
    glb.json["animations"] = {{{"name", "talk"}, {"samplers", {{{"input", times}, {"output", turn}}, {{"input", times}, {"output", weigh}}}}, {"channels", std::move(channels)}}};
    return glb.file();
}

}  // namespace

TEST_CASE("clients: the validator finds nothing in any layout of any sample, and three.js shows what the studio shows") {
    if (!hasNode()) return;
    for (const Sample& sample : samples()) {
        CAPTURE(sample.name);
        std::vector<Json> exports = {exported("baked.glb", "baked"), exported("rigged.glb", "rigged"), exported("skinned.glb", "skinned"), exported("unity.glb", "rigged", "unity"),
                                     exported("web.glb", "baked", "threejs"), exported("small.glb", "rigged", "threejs"), exported("eight.glb", "baked")};
        exports[5]["compress"] = true;
        exports.back()["targets"] = 8;
        exports.back()["normals"] = true;
        const auto answers = exportSample(sample, exports);
        Json times = Json::array(), jobs = Json::array();
        std::string files;
        for (int k = 0; k < kKeys; ++k) times.push_back({{"time", frameOf(k) / 60.0}, {"positions", number(k)}});
        for (std::size_t i = 0; i < exports.size(); ++i) {
            const std::string file = exports[i]["path"];
            files += " " + file;
            jobs.push_back({{"file", file}, {"rest", "rest.obj"}, {"tolerance", room(answers[i])}, {"times", times}});
        }
        jobs[0]["picture"] = std::string(sample.name) + ".png";
        int status = 0;
        const std::string found = run("node '" IMOMUSHI_CLIENTS "/validate.js'" + files, status);
        INFO(found << readFile(folder() / "err"));
        CHECK(status == 0);

        const Json shown = inThree(jobs);
        if (!shown.contains("renderer")) continue;
        // A picture of the sample, not of nothing: with as many textures as were written.
        const Json picture = shown["checks"][0]["picture"];
        CHECK(picture["covered"].get<double>() > 0.05);
        CHECK(picture["covered"].get<double>() < 0.8);
        CHECK(picture["colors"].get<int>() > 1000);
        const Json file = contentOf("baked.glb");
        CHECK(picture["textures"] == (file.contains("images") ? file["images"].size() : 0));
        if (const char* keep = std::getenv("IMOMUSHI_SCREENSHOTS"))
            std::filesystem::copy_file(folder() / jobs[0]["picture"].get<std::string>(), std::filesystem::path(keep) / ("three-" + jobs[0]["picture"].get<std::string>()),
                                       std::filesystem::copy_options::overwrite_existing);
    }
}

TEST_CASE("clients: clips of imported skeletons, exported as takes, have the joints of the original file in three.js") {
    namespace fs = std::filesystem;
    if (!hasNode()) return;
    if (!fs::exists(IMOMUSHI_SHARED_MESHES)) return leaveOut("no folder " IMOMUSHI_SHARED_MESHES);
    struct Rigged {
        const char *file, *unit;
        double scale;
        std::vector<const char*> clips;
        double seconds;  // of the shortest of these
        int joints;      // that are not merged, at least
    };
    Json jobs = Json::array();
    std::vector<int> least;
    std::string files;
    for (const Rigged& of : {Rigged{"Fox.glb", "cm", 0.01, {"Survey", "Walk", "Run"}, 0.7, 6}, Rigged{"snake-animations.glb", "m", 1.0, {"Side winding", "Bite", "Dance"}, 0.5, 5}}) {
        CAPTURE(of.file);
        const fs::path original = fs::path(IMOMUSHI_SHARED_MESHES) / of.file;
        std::vector<Json> lines = {{{"do", "make-soft"}, {"path", original.string()}, {"unit", of.unit}, {"name", "it"}, {"precompute", false}}, {{"do", "list"}}};
        const Json list = perform(lines)[1];
        std::vector<const char*> clips;
        for (const char* clip : of.clips)
            for (const Json& known : list["characters"][0]["clips"])
                if (known["name"] == clip) clips.push_back(clip);
        REQUIRE(!clips.empty());
        for (const char* clip : clips) lines.push_back({{"do", "take-clip"}, {"character", "it"}, {"clip", clip}});
        for (const char* layout : {"skinned", "baked"}) lines.push_back(exported((original.stem().string() + "-" + layout + ".glb").c_str(), layout));
        perform(lines);
        Json names = Json::array(), times = Json::array();
        for (const Json& bone : list["bones"]) names.push_back(bone["name"]);
        // At keys of the takes: what lies between two is for each program to say.
        for (int k = 0; k <= 6; ++k) times.push_back(std::floor(of.seconds * k / 6.0 * 60.0) / 60.0);
        for (const char* layout : {"skinned", "baked"}) {
            const std::string file = original.stem().string() + "-" + layout + ".glb";
            files += " '" + file + "'";
            for (const char* clip : clips) {
                jobs.push_back({{"original", original.string()}, {"exported", file}, {"clip", clip}, {"scale", of.scale}, {"joints", names}, {"times", times}, {"tolerance", kJoints}});
                least.push_back(of.joints);
            }
        }
    }
    std::ofstream(folder() / "jobs.json") << jobs.dump();
    int status = 0;
    const std::string out = run("node '" IMOMUSHI_CLIENTS "/check_joints.js' jobs.json", status);
    INFO(out << readFile(folder() / "err"));
    REQUIRE(status == 0);
    const Json checks = Json::parse(out)["checks"];
    for (std::size_t i = 0; i < checks.size(); ++i) CHECK(checks[i]["joints"].get<int>() >= least[i]);
    const std::string found = run("node '" IMOMUSHI_CLIENTS "/validate.js'" + files, status);
    INFO(found);
    CHECK(status == 0);
}

TEST_CASE("clients: an avatar that was made soft goes out as VRM 1.0: the validator has nothing against it, and three-vrm has its joints where the file has them") {
    namespace fs = std::filesystem;
    if (!hasNode()) return;
    if (!fs::exists(IMOMUSHI_CLIENTS "/node_modules/@pixiv/three-vrm")) return leaveOut("three-vrm is not installed (packaging/install.sh test)");
    for (const char* file : {"avatar.glb", "avatar_vrm0.vrm"}) {
        CAPTURE(file);
        const auto answers = perform({{{"do", "make-soft"}, {"path", (fs::path(IMOMUSHI_TEST_DATA) / "characters" / file).string()}, {"name", "avatar"}, {"draft", true}, {"precompute", false}},
                                      {{"do", "list"}}, exported("avatar.vrm", "skinned")});
        int status = 0;
        const std::string found = run("node '" IMOMUSHI_CLIENTS "/validate.js' avatar.vrm", status);
        INFO(found << readFile(folder() / "err"));
        CHECK(status == 0);
        const std::string out = run("node '" IMOMUSHI_CLIENTS "/check_vrm.js' avatar.vrm", status);
        INFO(out << readFile(folder() / "err"));
        REQUIRE(status == 0);
        const Json seen = Json::parse(out);
        int roles = 0;
        for (const Json& bone : answers[1]["characters"][0]["skeleton"]) {
            if (!bone.contains("role")) continue;
            ++roles;
            const Json& at = seen["bones"][bone["role"].get<std::string>()];
            for (std::size_t k = 0; k < 3; ++k) CHECK(std::abs(at[k].get<double>() - bone["start"][k].get<double>()) < 1e-4 * 1.5);  // of its height
        }
        CHECK(roles == 19);
        CHECK(seen["bones"].size() == 19);
        CHECK(seen["expressions"] == Json{{"aa", 1}, {"blink", 1}, {"happy", 1}});
        CHECK(seen["springs"] == 1);  // a joint that swings, and its end
        CHECK(seen["lookAt"] == true);
        CHECK(seen["meta"]["authors"][0] == "Imomushi test characters");
    }
}

TEST_CASE("clients: Blender shows what the studio shows, baked and rigged") {
    if (!hasBlender()) return;
    for (const Sample& sample : samples()) {
        CAPTURE(sample.name);
        exportSample(sample, {exported("baked.glb", "baked", "blender"), exported("rigged.glb", "rigged", "blender")});
        Json frames = Json::array(), jobs = Json::array();
        for (int k = 0; k < kKeys; ++k) frames.push_back({{"frame", frameOf(k)}, {"positions", number(k)}});
        for (const char* file : {"baked.glb", "rigged.glb"}) jobs.push_back({{"file", file}, {"rest", "rest.obj"}, {"fps", 60}, {"tolerance", kExact}, {"frames", frames}});
        inBlender(jobs);
    }
}

TEST_CASE("clients: a character that was made soft goes to Blender as what the studio shows, in all formats, with the bones of its file") {
    if (!hasBlender()) return;
    std::ofstream(folder() / "worm.glb", std::ios::binary) << wormGlb();
    constexpr int kLast = 20;
    std::vector<Json> lines = {{{"do", "make-soft"}, {"path", "worm.glb"}, {"name", "worm"}, {"from", "skeleton"}, {"draft", true}}, {{"do", "save"}, {"path", "worm.imomushi"}}, {{"do", "list"}}};
    const Json bones = perform(lines)[2]["bones"];
    REQUIRE(bones.size() >= 4);
    lines = {{{"do", "open"}, {"path", "worm.imomushi"}}, {{"do", "write-mesh"}, {"path", "rest.obj"}, {"state", "rest"}, {"character", "worm"}},
             {{"do", "take-clip"}, {"character", "worm"}, {"clip", "talk"}}, {{"do", "record"}, {"take", "t"}, {"action", "start"}},
             {{"do", "drag"}, {"endpoint", bones.back()["name"].get<std::string>() + "/end"}, {"to", {0.5, 1.25, 0.2}}, {"seconds", 0.25}}, {{"do", "step"}, {"frames", kLast}},
             {{"do", "record"}, {"take", "t"}, {"action", "stop"}}};
    // Positions at three times of each take, and where joints are.
    std::map<std::string, std::vector<std::pair<int, std::size_t>>> played;  // frames, and lines of their joints
    for (const char* take : {"t", "talk"})
        for (const int frame : {0, 8, kLast}) {
            lines.push_back({{"do", "play"}, {"take", take}, {"time", frame / 60.0}});
            lines.push_back({{"do", "write-mesh"}, {"path", take + std::to_string(frame) + ".obj"}, {"character", "worm"}});
            played[take].emplace_back(frame, lines.size());
            for (const Json& bone : bones) lines.push_back({{"do", "measure"}, {"what", "position"}, {"endpoint", bone["name"].get<std::string>() + "/start"}});
        }
    const std::size_t first = lines.size();
    for (const auto& [path, layout] : {std::pair{"baked.glb", "baked"}, {"skinned.glb", "skinned"}, {"baked.fbx", "baked"}, {"skinned.fbx", "skinned"}, {"worm.pc2", "cache"}, {"worm.mdd", "cache"},
                                       {"talk.glb", "baked"}, {"talk.fbx", "skinned"}}) {
        lines.push_back(exported(path, layout, "blender"));
        lines.back()["take"] = std::string(path).starts_with("talk") ? "talk" : "t";
    }
    const auto answers = perform(lines);
    Json jobs = Json::array();
    for (std::size_t i = first; i < lines.size(); ++i) {
        const std::string file = lines[i]["path"], take = lines[i]["take"];
        Json frames = Json::array(), job{{"file", file}, {"rest", "rest.obj"}, {"fps", 60}, {"tolerance", room(answers[i])}};
        for (const auto& [frame, at] : played[take]) {
            Json joints;
            for (std::size_t b = 0; b < bones.size(); ++b) joints[bones[b]["name"].get<std::string>()] = answers[at + b]["value"];
            frames.push_back({{"frame", frame}, {"positions", take + std::to_string(frame) + ".obj"}, {"joints", std::move(joints)}});
        }
        job["frames"] = std::move(frames);
        if (lines[i]["layout"] == "cache") job["object"] = "worm.obj";
        if (const char* keep = std::getenv("IMOMUSHI_SCREENSHOTS")) job["picture"] = {{"path", (std::filesystem::path(keep) / ("blender-" + file + ".png")).string()}, {"frame", 8}};
        jobs.push_back(std::move(job));
    }
    const Json told = inBlender(jobs);
    for (std::size_t i = 0; i < told.size(); ++i) {
        CAPTURE(jobs[i].dump());
        CAPTURE(told[i].dump());
        const bool cache = jobs[i].contains("object");
        CHECK(told[i]["vertices"] == 202);
        CHECK(told[i]["textures"] == 1);
        CHECK(told[i]["joints"].get<std::size_t>() >= (cache ? 0 : bones.size()));
        for (const Json& distance : told[i]["joint_distances"]) CHECK(distance.get<double>() < kJoints);
    }
    // FBX comes back with the weights, too: by one after a quarter of a second "fat" makes the top twice as wide.
    const auto back = perform({{{"do", "import-character"}, {"path", "talk.fbx"}, {"name", "again"}}, {{"do", "write-mesh"}, {"path", "before.obj"}, {"character", "again"}},
                               {{"do", "take-clip"}, {"character", "again"}, {"clip", "talk"}, {"take", "again"}}, {{"do", "play"}, {"take", "again"}, {"time", 0.25}}, {{"do", "write-mesh"}, {"path", "again.obj"}, {"character", "again"}}});
    CHECK(back[2]["morphs"] == 1);
    const auto widest = [](const char* file) {
        double most = 0.0;
        std::istringstream written(readFile(folder() / file));
        for (std::string line; std::getline(written, line);)
            if (double x = 0.0, y = 0.0, z = 0.0; std::sscanf(line.c_str(), "v %lf %lf %lf", &x, &y, &z) == 3) most = std::max(most, std::abs(z));
        return most;
    };
    CHECK(widest("again.obj") == doctest::Approx(2.0 * widest("before.obj")).epsilon(1e-3));
}

TEST_CASE("clients: FBX files are made by Blender and come back from it as they were, or are refused with the reason") {
    const bool there = hasBlender();
    std::vector<Json> lines = {{{"do", "open"}, {"path", IMOMUSHI_SAMPLES "/caterpillar.imomushi"}}};
    for (const Json& line : plainLines("caterpillar")) lines.push_back(line);
    for (const Json& line : {Json{{"do", "record"}, {"take", "t"}, {"action", "start"}}, samples()[0].drags[0], Json{{"do", "step"}, {"frames", kFrames}}, Json{{"do", "record"}, {"take", "t"}, {"action", "stop"}}})
        lines.push_back(line);
    if (!there) {
        std::ofstream script(folder() / "script.jsonl");
        lines.push_back(exported("a.fbx", "baked"));
        for (const Json& line : lines) script << line.dump() << "\n";
        script.close();
        int status = 0;
        CHECK(run("'" IMOMUSHI_PROGRAM "' run script.jsonl", status).find("needs-blender") != std::string::npos);
        CHECK(!std::filesystem::exists(folder() / "a.fbx"));
        return;
    }
    for (const char* layout : {"baked", "rigged"}) lines.push_back(exported("a.fbx", layout));
    const auto answers = perform(lines);
    for (std::size_t i = answers.size() - 2; i < answers.size(); ++i) CHECK(answers[i]["check"]["max_percent"].get<double>() / 100.0 <= kExact);
    CHECK(readFile(folder() / "a.fbx").substr(0, 18) == "Kaydara FBX Binary");
}

TEST_CASE("clients: the driver for three.js follows a drag as the studio does, and the driver for Godot computes the same") {
    if (!hasNode()) return;
    exportSample(samples()[0], {exported("rigged.glb", "rigged")});
    std::vector<Json> lines = {{{"do", "open"}, {"path", IMOMUSHI_SAMPLES "/caterpillar.imomushi"}}};
    for (const Json& line : plainLines("caterpillar")) lines.push_back(line);
    lines.push_back({{"do", "drag"}, {"endpoint", "head-bone/end"}, {"to", {0.72, 1.0, 0.62}}});
    lines.push_back({{"do", "write-mesh"}, {"path", "pose.obj"}});
    const std::size_t measured = lines.size();
    std::vector<std::string> names;
    const Json file = contentOf("rigged.glb");
    for (const Json& node : file["nodes"])
        if (node.contains("extras") && node["extras"].contains("imomushi"))
            for (const Json& point : node["extras"]["imomushi"]["points"]) names.push_back(point["name"]);
    REQUIRE(!names.empty());
    for (const std::string& name : names) lines.push_back({{"do", "measure"}, {"what", "position"}, {"endpoint", name}});
    const auto answers = perform(lines);
    Json drag;
    for (std::size_t i = 0; i < names.size(); ++i) drag[names[i]] = answers[measured + i]["value"];
    inThree(Json::array({{{"file", "rigged.glb"}, {"rest", "rest.obj"}, {"tolerance", kLive}, {"drag", drag}, {"positions", "pose.obj"}}}));
    int status = 0;
    const std::string out = run("node '" IMOMUSHI_CLIENTS "/check_godot.js' '" IMOMUSHI_DRIVERS "/godot.gd' rigged.glb", status);
    INFO(out << readFile(folder() / "err"));
    CHECK(status == 0);
}

TEST_CASE("clients: the driver for Godot is GDScript, and what is none is found") {
    if (!hasNode()) return;
    const std::string driver = IMOMUSHI_DRIVERS "/godot.gd";
    int status = 0;
    const std::string found = run("node '" IMOMUSHI_CLIENTS "/check_godot.js' '" + driver + "'", status);
    INFO(found << readFile(folder() / "err"));
    CHECK(status == 0);
    std::string broken = readFile(driver);
    broken.erase(broken.find(".length()") + 7, 1);
    std::ofstream(folder() / "broken.gd") << broken;
    CHECK(run("node '" IMOMUSHI_CLIENTS "/check_godot.js' broken.gd", status).starts_with("broken.gd:"));
    CHECK(status == 1);
}
