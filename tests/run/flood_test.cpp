// SPDX-License-Identifier: GPL-3.0-or-later
// Floods: 15,000 datagrams a second that drive everything at once, a tenth of them broken.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <span>

#include "tests/run/performed.h"

using namespace imomushi;

namespace {

constexpr int kPerSecond = 15000;

/// Of each flood; packaging/thorough.sh asks for an hour.
int floodSeconds() {
    const char* wanted = std::getenv("IMOMUSHI_FLOOD_SECONDS");
    return wanted ? std::max(10, std::atoi(wanted)) : 24;
}

struct Flood {
    double sent = 0, broken = 0, names = 0;
    Json answer;                 ///< of "live"
    Json bounds;                 ///< of what is left
    std::vector<double> memory;  ///< kB that are not files, each second
};

Flood flood(const std::string& sample, const std::string& how, const std::string& record = {}) {
    const std::string source = IMOMUSHI_SOURCE_DIR;
    const std::string take = record.empty() ? "" : R"({"do":"record","take":"show","action":"start"})" "\n";
    writeFile("flood.jsonl", R"({"do":"open","path":")" + source + "/assets/samples/" + sample + ".imomushi\"}\n" + take +
                                 R"({"do":"live","sources":[{"protocol":"osc","port":0},{"protocol":"vmc","port":0}])" + record + "}\n" +
                                 R"({"do":"measure","what":"bounds"}
{"do":"measure","what":"gap"}
)");
    const Run run = performed("run flood.jsonl", "export PYTHONPATH=$senders\npython3 '" + source + "/tests/run/flood.py' $osc " + std::to_string(floodSeconds()) + " " + std::to_string(kPerSecond) + " " + how +
                                                     " >sent &\nflood=$!\nrm -f memory\nwhile kill -0 $flood 2>/dev/null; do sed -n 's/^RssAnon:[^0-9]*\\([0-9]*\\).*/\\1/p' /proc/$program/status >>memory; sleep 1; done\n"
                                                     "sleep 0.5; kill -INT $program");
    INFO(run.out << run.err);
    REQUIRE(run.status == 0);
    const std::size_t live = record.empty() ? 1 : 2;
    REQUIRE(run.answers.size() == live + 3);
    // Nothing that is sent is a place farther away than 1.5 m, and no number is so large that flesh leaves the room.
    const Json& bounds = run.answers[live + 1]["value"];
    for (const char* corner : {"low", "high"})
        for (const Json& x : bounds[corner]) {
            REQUIRE(x.is_number());
            CHECK(std::abs(x.get<double>()) < 50.0);
        }
    CHECK(run.answers[live + 2]["value"].get<double>() < 1e-6);
    Flood out;
    out.answer = run.answers[live];
    out.bounds = bounds;
    std::istringstream(readFile(folder() / "sent")) >> out.sent >> out.broken >> out.names;
    std::istringstream memory(readFile(folder() / "memory"));
    for (double kB; memory >> kB;) out.memory.push_back(kB);
    return out;
}

double mean(std::span<const double> values) { return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size()); }

void tell(const std::string& sample, const Flood& f) {
    const Json& osc = f.answer["sources"][0];
    MESSAGE(sample << ": " << f.sent << " datagrams sent, " << f.broken << " broken; taken " << osc["packets"] << ", malformed " << osc["malformed"] << ", ignored " << osc["ignored"] << "; frames " << f.answer["frames"] << ", late " << f.answer["late"] << "; processor ms a step "
                   << f.answer["processor_ms_per_step"] << ", by the clock " << f.answer["ms_per_step"] << "; first packet to step " << f.answer["latency_ms"] << " ms; memory " << f.memory.front() << " to " << f.memory.back() << " kB");
}

void checkCounts(const Flood& f) {
    REQUIRE(f.sent > 0.0);
    const Json& osc = f.answer["sources"][0];
    // The system drops datagrams where a busy machine takes none for long; the others are counted, and what is broken in them.
    const double taken = osc["packets"].get<double>(), broken = osc["malformed"].get<double>();
    CHECK(taken > 0.5 * f.sent);
    CHECK(taken <= f.sent + 1.0);  // the question for names
    CHECK(broken > 0.08 * taken);
    CHECK(broken < 0.12 * taken);
    CHECK(osc["values"].get<double>() > 0.8 * taken);
    CHECK(f.answer["frames"].get<int>() > 10 * floodSeconds());
}

/// The script of the session keeps what everything was told in each step, until it is too long (DocumentHistory::kScriptBytes): bytes of one input there, with those of its copy while they become a line.
constexpr double kBytesOfInput = 600.0, kMostBytes = 200e6;

void checkMemory(const Flood& f) {
    // All else that is needed is there after a third of it; the thirds that are compared are a third apart.
    REQUIRE(f.memory.size() >= 9);
    const std::span<const double> all(f.memory);
    const double early = mean(all.subspan(all.size() / 3, all.size() / 3)), late = mean(all.last(all.size() / 3));
    const double script = std::min(kMostBytes, kBytesOfInput * f.names * f.answer["frames"].get<double>() / 3.0);
    CHECK(1e3 * late < 1.02 * 1e3 * early + script);
}

void checkSample(const std::string& sample) {
    const Flood f = flood(sample, "swings");
    tell(sample, f);
    checkCounts(f);
    checkMemory(f);
}

}  // namespace

TEST_CASE("flood: the caterpillar stays finite and closed, and its memory flat") { checkSample("caterpillar"); }
TEST_CASE("flood: the figure stays finite and closed, and its memory flat") { checkSample("figure"); }
TEST_CASE("flood: the octopus stays finite and closed, and its memory flat") { checkSample("octopus"); }
TEST_CASE("flood: the dragon stays finite and closed, and its memory flat") { checkSample("dragon"); }

TEST_CASE("flood: where everything jumps, what came is recorded beside a take, and replayed it ends in the same place") {
    const Flood f = flood("octopus", "jumps", R"(,"record":"flood.input")");
    tell("octopus, everything jumps", f);
    checkCounts(f);
    const Run again = script(R"({"do":"open","path":")" IMOMUSHI_SOURCE_DIR R"(/assets/samples/octopus.imomushi"}
{"do":"replay","path":"flood.input"}
{"do":"measure","what":"bounds"}
)");
    INFO(again.err);
    REQUIRE(again.status == 0);
    CHECK(again.answers[1]["cut"] == false);
    CHECK(again.answers[1]["frames"] == f.answer["frames"]);
    CHECK(again.answers[1]["sources"] == f.answer["sources"]);
    CHECK(again.answers[2]["value"] == f.bounds);
}
