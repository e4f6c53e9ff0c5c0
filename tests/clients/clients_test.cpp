// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/folder.h"

using Json = nlohmann::ordered_json;

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
    if (!there) MESSAGE("skipped: node or its packages are not installed (packaging/install.sh test)");
    return there;
}

bool hasBlender() {
    int status = 0;
    run("blender --version", status);
    if (status != 0) MESSAGE("skipped: Blender is not installed");
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
    std::vector<Json> lines = {{{"do", "open"}, {"path", project}}, {{"do", "write-mesh"}, {"path", "rest.obj"}, {"state", "rest"}}, {{"do", "record"}, {"take", "t"}, {"action", "start"}}};
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
        MESSAGE("skipped: WebGL, as Chromium is not installed (packaging/install.sh test)");
        out = run("node '" IMOMUSHI_CLIENTS "/check_node.js' jobs.json", status);
    }
    INFO(jobs.dump() << "\n" << out << readFile(folder() / "err"));
    REQUIRE(status == 0);
    return Json::parse(out);
}

/// What a file may be away: 1e-5, or what the export said.
double room(const Json& answer) {
    double most = kExact;
    for (const char* what : {"skin", "dropped_targets"})
        if (answer.contains(what)) most += answer[what]["max_percent"].get<double>() / 100.0;
    return most;
}

}  // namespace

TEST_CASE("clients: the validator finds nothing in any layout of any sample, and three.js shows what the studio shows") {
    if (!hasNode()) return;
    for (const Sample& sample : samples()) {
        CAPTURE(sample.name);
        std::vector<Json> exports = {exported("baked.glb", "baked"), exported("rigged.glb", "rigged"), exported("skinned.glb", "skinned"), exported("unity.glb", "rigged", "unity"),
                                     exported("web.glb", "baked", "threejs"), exported("eight.glb", "baked")};
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
    if (!fs::exists(IMOMUSHI_SHARED_MESHES)) {
        MESSAGE("skipped: no folder " IMOMUSHI_SHARED_MESHES);
        return;
    }
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

TEST_CASE("clients: Blender shows what the studio shows, baked and rigged") {
    if (!hasBlender()) return;
    for (const Sample& sample : samples()) {
        CAPTURE(sample.name);
        exportSample(sample, {exported("baked.glb", "baked", "blender"), exported("rigged.glb", "rigged", "blender")});
        for (const char* file : {"baked.glb", "rigged.glb"}) {
            std::string command = std::string("blender --background --python-exit-code 2 --python '" IMOMUSHI_CLIENTS "/check_blender.py' -- ") + file + " rest.obj 60";
            for (int k = 0; k < kKeys; ++k) command += " " + std::to_string(frameOf(k)) + " " + number(k) + " " + std::to_string(kExact);
            int status = 0;
            const std::string out = run(command, status);
            INFO(command << "\n" << out << readFile(folder() / "err"));
            CHECK(status == 0);
        }
    }
}

TEST_CASE("clients: FBX files are made by Blender and come back from it as they were, or are refused with the reason") {
    const bool there = hasBlender();
    std::vector<Json> lines = {{{"do", "open"}, {"path", IMOMUSHI_SAMPLES "/caterpillar.imomushi"}}, {{"do", "record"}, {"take", "t"}, {"action", "start"}}, samples()[0].drags[0],
                               {{"do", "step"}, {"frames", kFrames}}, {{"do", "record"}, {"take", "t"}, {"action", "stop"}}};
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
    std::vector<Json> lines = {{{"do", "open"}, {"path", IMOMUSHI_SAMPLES "/caterpillar.imomushi"}}, {{"do", "drag"}, {"endpoint", "head-bone/end"}, {"to", {0.72, 1.0, 0.62}}},
                               {{"do", "write-mesh"}, {"path", "pose.obj"}}};
    std::vector<std::string> names;
    const Json file = contentOf("rigged.glb");
    for (const Json& node : file["nodes"])
        if (node.contains("extras") && node["extras"].contains("imomushi"))
            for (const Json& point : node["extras"]["imomushi"]["points"]) names.push_back(point["name"]);
    REQUIRE(!names.empty());
    for (const std::string& name : names) lines.push_back({{"do", "measure"}, {"what", "position"}, {"endpoint", name}});
    const auto answers = perform(lines);
    Json drag;
    for (std::size_t i = 0; i < names.size(); ++i) drag[names[i]] = answers[3 + i]["value"];
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
