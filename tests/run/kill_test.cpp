// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <random>
#include <set>
#include <string>

#include "core/mesh/write_mesh.h"
#include "tests/run/program.h"
#include "tests/support/shapes.h"
#include "tests/support/thorough.h"
#include "tests/support/victim.h"

using namespace imomushi;

namespace {

std::string lines(const std::vector<Json>& commands) {
    std::string text;
    for (const Json& command : commands) text += command.dump() + "\n";
    return text;
}

/// What step `number` does to a project, saved last: it renames the body, solves it anew, lets a worker read a guest, and keeps one take.
std::vector<Json> stepOfWork(int number) {
    const std::string before = std::to_string(number - 1), now = std::to_string(number);
    return {{{"do", "rename"}, {"target", "body " + before}, {"name", "body " + now}},
            {{"do", "set"}, {"target", "body " + now}, {"property", "nu"}, {"value", number % 2 ? 0.3 + 1e-4 * (number % 1000) : 0.4}},
            {{"do", "precompute"}},
            {{"do", "record"}, {"take", "take " + now}, {"action", "start"}},
            {{"do", "drag"}, {"endpoint", "bone/end"}, {"to", {0.001 * number, 0, 3}}},
            {{"do", "step"}, {"frames", 5}},
            {{"do", "record"}, {"take", "take " + now}, {"action", "stop"}},
            {{"do", "remove-take"}, {"take", "take " + before}},
            {{"do", "import-element"}, {"path", (folder() / "bar.obj").string()}, {"name", "guest"}},
            {{"do", "remove-element"}, {"name", "guest"}},
            {{"do", "save"}}};
}

/// Names of files, in order.
std::string filesIn(const std::filesystem::path& folder) {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) names.insert(entry.path().filename().string());
    std::string text;
    for (const auto& name : names) text += name + " ";
    return text;
}

}  // namespace

TEST_CASE("killed: whatever moment it is, nothing that was acknowledged is lost, and the next start leaves nothing behind") {
    const std::filesystem::path place = folder() / "killed";
    std::filesystem::create_directory(place);
    const TriangleMesh bar = shapes::bar(2).mesh;
    REQUIRE(writeMesh(folder() / "bar.obj", bar.vertices, bar.triangles).has_value());
    const std::string project = (place / "work.imomushi").string(), cache = (folder() / "killed-responses").string();
    const Run made = script(lines({{{"do", "new"}},
                                   {{"do", "import-element"}, {"path", "bar.obj"}, {"name", "body 0"}},
                                   {{"do", "add-joint-face"}, {"element", "body 0"}, {"name", "in"}, {"plane", {{"origin", {0, 0, 0}}, {"normal", {0, 0, -1}}}}},
                                   {{"do", "add-joint-face"}, {"element", "body 0"}, {"name", "out"}, {"plane", {{"origin", {0, 0, 3}}, {"normal", {0, 0, 1}}}}},
                                   {{"do", "set"}, {"target", "body 0"}, {"property", "solver-mesh"}, {"value", "as-is"}},  // the fastest
                                   {{"do", "add-bone"}, {"name", "bone"}, {"from", "body 0/in"}, {"to", "body 0/out"}},
                                   {{"do", "precompute"}},
                                   {{"do", "record"}, {"take", "take 0"}, {"action", "start"}},
                                   {{"do", "step"}, {"frames", 1}},
                                   {{"do", "record"}, {"take", "take 0"}, {"action", "stop"}},
                                   {{"do", "save"}, {"path", project}}}),
                            "--cache '" + cache + "'");
    REQUIRE(made.status == 0);

    std::mt19937 random(21);
    const int kills = repeats(20, 400);
    constexpr int kSteps = 40, kPerStep = 11;
    int saved = 0, inTheMiddle = 0;
    for (int kill = 0; kill < kills; ++kill) {
        // One start opens what the last one left, works, and is killed.
        std::vector<Json> work = {{{"do", "open"}, {"path", project}}};
        for (int step = 1; step <= kSteps; ++step)
            for (const Json& command : stepOfWork(saved + step)) work.push_back(command);
        const auto file = writeFile("killed.jsonl", lines(work));
        const Killed killed = killAfter({IMOMUSHI_PROGRAM, "run", "--cache", cache, file.string()}, std::chrono::microseconds(random() % 500'000));
        int acknowledged = -1;  // "open" is the first
        for (std::size_t at = 0; (at = killed.out.find("\"ok\":true", at)) != std::string::npos; ++at) ++acknowledged;
        CHECK(killed.out.find("\"ok\":false") == std::string::npos);
        CHECK((!killed.ended || killed.status == 0));
        CHECK(killed.left == 0);
        if (acknowledged >= 0 && acknowledged % kPerStep != 0) ++inTheMiddle;

        const Run next = script(lines({{{"do", "open"}, {"path", project}}, {{"do", "precompute"}}, {{"do", "save"}}}), "--cache '" + cache + "'");
        REQUIRE(next.status == 0);
        const std::string name = next.answers[0]["elements"][0]["name"];
        const int found = std::stoi(name.substr(5));
        CHECK(found >= saved + std::max(acknowledged, 0) / kPerStep);
        CHECK(found <= saved + std::max(acknowledged, 0) / kPerStep + 1);  // the one that was being saved
        CHECK(next.answers[0]["takes"] == Json::array({"take " + std::to_string(found)}));
        CHECK(next.answers[0]["elements"][0]["state"] == "fresh");
        saved = found;
        CHECK(filesIn(place) == "work.imomushi work.imomushi-versions ");
        const std::string responses = filesIn(cache);
        CHECK_MESSAGE(responses.find(".part") == std::string::npos, responses);
    }
    const Run versions = script(lines({{{"do", "versions"}, {"path", project}}}));
    REQUIRE(versions.status == 0);
    CHECK(versions.answers[0]["versions"].size() == std::min<std::size_t>(10, static_cast<std::size_t>(saved) + 1));
    MESSAGE(kills << " kills, " << saved << " saves acknowledged, " << inTheMiddle << " kills between commands of a save");
}
