// SPDX-License-Identifier: GPL-3.0-or-later
// The headless runner, performed by a game controller of SDL's own.
#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>

#include "app/headless/runner.h"
#include "tests/support/virtual_pad.h"

using namespace imomushi;
using namespace std::chrono_literals;

namespace {

std::filesystem::path folder() {
    const auto made = std::filesystem::temp_directory_path() / "imomushi_live_pad";
    std::filesystem::create_directories(made);
    return made;
}

std::string bytesOf(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<Json> answersOf(const std::vector<Json>& script) {
    std::stringstream lines, out, err;
    for (const Json& line : script) lines << line.dump() << "\n";
    const int status = runMain({"-"}, lines, out, err);
    INFO(out.str() << err.str());
    REQUIRE(status == 0);
    std::vector<Json> answers;
    for (std::string line; std::getline(out, line);) answers.push_back(Json::parse(line));
    return answers;
}

std::vector<Json> script(const Json& perform, const std::string& mesh) {
    return {{{"do", "open"}, {"path", IMOMUSHI_SAMPLES "/caterpillar.imomushi"}},
            {{"do", "map-input"}, {"source", "pad"}, {"channel", "left-x"}, {"target", "bone/head-bone/end/x"}, {"in", {-1, 1}}, {"out", {-0.3, 0.3}}},
            {{"do", "map-input"}, {"source", "pad"}, {"channel", "right-trigger"}, {"target", "bone/head-bone/end/y"}, {"out", {0, 0.3}}},
            perform,
            {{"do", "measure"}, {"what", "position"}, {"endpoint", "head-bone/end"}},
            {{"do", "write-mesh"}, {"path", mesh}}};
}

}  // namespace

TEST_CASE("live: a pad that is plugged in and out moves the caterpillar; what was recorded is replayed to the same bytes") {
    const std::string recording = (folder() / "pad.input").string(), seen = (folder() / "seen.obj").string(), again = (folder() / "again.obj").string();
    std::atomic<bool> over = false;
    VirtualPad pad;
    std::thread player([&] {
        for (int i = 0; !over; ++i) {
            std::this_thread::sleep_for(10ms);
            pad.axis(SDL_CONTROLLER_AXIS_LEFTX, std::min(32767, 1000 * (i % 40)));
            pad.axis(SDL_CONTROLLER_AXIS_TRIGGERRIGHT, 32767);
            if (i % 50 == 30) pad.unplug(), pad.plug();
        }
    });
    const auto performed = answersOf(script({{"do", "live"}, {"seconds", 2.0}, {"record", recording}, {"sources", Json::array({{{"protocol", "pad"}}})}}, seen));
    over = true;
    player.join();
    const Json& live = performed[3];
    CHECK(live["devices"]["pad"] == VirtualPad::kName);
    CHECK(live["sources"][0]["values"].get<int>() > 50);
    CHECK(live["sources"][0]["malformed"] == 0);
    const auto replayed = answersOf(script({{"do", "replay"}, {"path", recording}}, again));
    CHECK(replayed[3]["frames"] == live["frames"]);
    CHECK(replayed[3]["sources"] == live["sources"]);
    CHECK(replayed[4] == performed[4]);
    CHECK(bytesOf(seen) == bytesOf(again));
    // It was moved at all.
    const auto rest = answersOf({{{"do", "open"}, {"path", IMOMUSHI_SAMPLES "/caterpillar.imomushi"}}, {{"do", "measure"}, {"what", "position"}, {"endpoint", "head-bone/end"}}});
    CHECK(performed[4]["value"][1].get<double>() > rest[1]["value"][1].get<double>() + 0.1);
    std::filesystem::remove_all(folder());
}

TEST_CASE("live: a pad shakes when the caterpillar falls on the ground, and only then") {
    VirtualPad pad;
    const auto perform = [&](double height) {
        std::vector<Json> lines{{{"do", "open"}, {"path", IMOMUSHI_SAMPLES "/caterpillar.imomushi"}}, {{"do", "unpin"}, {"endpoint", "tail-bone/start"}}};
        for (const char* effect : {"gravity", "ground"}) lines.push_back({{"do", "enable"}, {"effect", effect}});
        lines.push_back({{"do", "set"}, {"target", "ground"}, {"property", "height"}, {"value", height}});
        lines.push_back({{"do", "map-input"}, {"source", "pad"}, {"channel", "left-x"}, {"target", "bone/head-bone/end/x"}});
        lines.push_back({{"do", "live"}, {"seconds", 1.0}, {"sources", Json::array({{{"protocol", "pad"}}})}});
        (void)answersOf(lines);
    };
    perform(-50.0);
    CHECK(pad.shaken() == 0);
    perform(-0.5);
    CHECK(pad.shaken() > 0);
    CHECK(pad.shaken() < 10);
}
