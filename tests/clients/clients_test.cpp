// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

using Json = nlohmann::ordered_json;

namespace {

constexpr int kFrames = 45, kKeys = 10;  // of a take at 60 frames per second, and times that are compared
constexpr const char* kExact = "1e-5";   // of the diagonal

const std::filesystem::path& folder() {
    static const struct Folder {
        std::filesystem::path path = std::filesystem::temp_directory_path() / ("imomushi-clients-" + std::to_string(::getpid()));
        Folder() { std::filesystem::create_directories(path); }
        ~Folder() { std::filesystem::remove_all(path); }
    } folder;
    return folder.path;
}

std::string read(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Runs a command in the folder; what it printed.
std::string run(const std::string& command, int& status) {
    const int code = std::system(("cd '" + folder().string() + "' && " + command + " >out 2>err").c_str());
    status = WIFEXITED(code) ? WEXITSTATUS(code) : -1;
    return read(folder() / "out");
}

bool hasNode() {
    int status = 0;
    run("node --version", status);
    const bool there = status == 0 && std::filesystem::exists(IMOMUSHI_CLIENTS "/node_modules/three") && std::filesystem::exists(IMOMUSHI_CLIENTS "/node_modules/gltf-validator");
    if (!there) MESSAGE("skipped: node, gltf-validator or three.js is not installed (packaging/install.sh test)");
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

std::vector<Json> imomushi(const std::vector<Json>& lines) {
    std::ofstream script(folder() / "script.jsonl");
    for (const Json& line : lines) script << line.dump() << "\n";
    script.close();
    int status = 0;
    std::istringstream out(run("'" IMOMUSHI_PROGRAM "' run script.jsonl", status));
    std::vector<Json> answers;
    for (std::string line; std::getline(out, line);) answers.push_back(Json::parse(line));
    INFO(read(folder() / "out"));
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
        const auto opened = imomushi({{{"do", "open"}, {"path", project}}, {{"do", "measure"}, {"what", "bounds"}}});
        const std::string end = opened[0]["bones"].back()["name"].get<std::string>() + "/end";
        const auto at = imomushi({{{"do", "open"}, {"path", project}}, {{"do", "measure"}, {"what", "position"}, {"endpoint", end}}})[1]["value"];
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
    auto answers = imomushi(lines);
    answers.erase(answers.begin(), answers.end() - static_cast<std::ptrdiff_t>(exports.size()));
    return answers;
}

Json exported(const char* path, const char* layout, const char* preset = "exact") { return {{"do", "export"}, {"path", path}, {"layout", layout}, {"preset", preset}}; }

/// What a file may be away: 1e-5, or what the export said.
std::string room(const Json& answer) {
    double most = std::stod(kExact);
    for (const char* what : {"skin", "dropped_targets"})
        if (answer.contains(what)) most += answer[what]["max_percent"].get<double>() / 100.0;
    return std::to_string(most);
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
        for (std::size_t i = 0; i < exports.size(); ++i) {
            std::string command = "node '" IMOMUSHI_CLIENTS "/check_gltf.js' " + exports[i]["path"].get<std::string>() + " rest.obj";
            for (int k = 0; k < kKeys; ++k) command += " " + std::to_string(frameOf(k) / 60.0) + " " + number(k) + " " + room(answers[i]);
            int status = 0;
            const std::string out = run(command, status);
            INFO(command << "\n" << out << read(folder() / "err"));
            CHECK(status == 0);
        }
    }
}

TEST_CASE("clients: Blender shows what the studio shows, baked and rigged") {
    if (!hasBlender()) return;
    for (const Sample& sample : samples()) {
        CAPTURE(sample.name);
        exportSample(sample, {exported("baked.glb", "baked", "blender"), exported("rigged.glb", "rigged", "blender")});
        for (const char* file : {"baked.glb", "rigged.glb"}) {
            std::string command = std::string("blender --background --python-exit-code 2 --python '" IMOMUSHI_CLIENTS "/check_blender.py' -- ") + file + " rest.obj 60";
            for (int k = 0; k < kKeys; ++k) command += " " + std::to_string(frameOf(k)) + " " + number(k) + " " + kExact;
            int status = 0;
            const std::string out = run(command, status);
            INFO(command << "\n" << out << read(folder() / "err"));
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
    const auto answers = imomushi(lines);
    for (std::size_t i = answers.size() - 2; i < answers.size(); ++i) CHECK(answers[i]["check"]["max_percent"].get<double>() / 100.0 <= std::stod(kExact));
    CHECK(read(folder() / "a.fbx").substr(0, 18) == "Kaydara FBX Binary");
}

TEST_CASE("clients: the driver for three.js follows a drag as the studio does") {
    if (!hasNode()) return;
    exportSample(samples()[0], {exported("rigged.glb", "rigged")});
    const std::string bytes = read(folder() / "rigged.glb");
    std::uint32_t length = 0;
    std::copy_n(bytes.data() + 12, 4, reinterpret_cast<char*>(&length));
    const Json file = Json::parse(bytes.substr(20, length));
    std::vector<Json> lines = {{{"do", "open"}, {"path", IMOMUSHI_SAMPLES "/caterpillar.imomushi"}}, {{"do", "drag"}, {"endpoint", "head-bone/end"}, {"to", {0.72, 1.0, 0.62}}},
                               {{"do", "write-mesh"}, {"path", "pose.obj"}}};
    std::vector<std::string> names;
    for (const Json& node : file["nodes"])
        if (node.contains("extras") && node["extras"].contains("imomushi"))
            for (const Json& point : node["extras"]["imomushi"]["points"]) names.push_back(point["name"]);
    REQUIRE(!names.empty());
    for (const std::string& name : names) lines.push_back({{"do", "measure"}, {"what", "position"}, {"endpoint", name}});
    const auto answers = imomushi(lines);
    Json points;
    for (std::size_t i = 0; i < names.size(); ++i) points[names[i]] = answers[3 + i]["value"];
    std::ofstream(folder() / "points.json") << points.dump();
    int status = 0;
    const std::string out = run("node '" IMOMUSHI_CLIENTS "/check_driver.js' rigged.glb rest.obj points.json pose.obj 1e-4", status);
    INFO(out << read(folder() / "err"));
    CHECK(status == 0);
}
