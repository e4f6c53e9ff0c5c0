// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/cycle.h"

#include <cmath>
#include <numbers>

#include "core/document/input_mapping.h"
#include "core/document/kept_pose.h"
#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

/// A chain with four kept poses.
struct Gait : Workbench {
    Gait() {
        buildChain();
        for (int i = 0; i < 4; ++i) {
            good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0.4 * i, 0.1 * i, 5.0}}});
            good({{"do", "keep-pose"}, {"name", std::string(1, static_cast<char>('p' + i))}});
        }
        good({{"do", "rest"}});
    }
    const Document& document() { return session.document(); }
    std::string refused(const Json& command) {
        const auto answer = run(command);
        return answer ? "" : answer.error().code;
    }
};

double interpolated(const std::vector<double>& values, double phase) {
    double sum = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) sum += values[k] * cycleWeight(k, values.size(), phase);
    return sum;
}

}  // namespace

TEST_CASE("cycle: each pose is met exactly, and weights sum to 1 between poses, too") {
    for (std::size_t count = Cycle::kFewestPoses; count <= Cycle::kMostPoses; ++count) {
        CAPTURE(count);
        for (std::size_t at = 0; at < count; ++at)
            for (std::size_t k = 0; k < count; ++k) CHECK(cycleWeight(k, count, double(at) / double(count)) == doctest::Approx(k == at ? 1.0 : 0.0).epsilon(1e-13));
        for (const double phase : {0.0, 0.013, 0.25, 0.4999999999, 0.5, 0.77, 1.0}) CHECK(interpolated(std::vector<double>(count, 1.0), phase) == doctest::Approx(1.0).epsilon(1e-12));
    }
}

TEST_CASE("cycle: the way is closed and smooth, and waves up to the order that so many poses tell apart are met exactly") {
    constexpr double kSmall = 1e-5;
    for (const std::size_t count : {2, 3, 4, 5, 8, 64}) {
        CAPTURE(count);
        std::vector<double> values;
        for (std::size_t k = 0; k < count; ++k) values.push_back(std::sin(3.0 + 7.0 * double(k * k)));
        const auto slope = [&](double phase) { return (interpolated(values, phase + kSmall) - interpolated(values, phase - kSmall)) / (2.0 * kSmall); };
        CHECK(interpolated(values, 1.0 - 1e-12) == doctest::Approx(values.front()).epsilon(1e-9));
        CHECK(slope(0.0) == doctest::Approx(slope(1.0)).epsilon(1e-6));
        // No corner at any pose: the slopes of both sides agree to the first order.
        for (std::size_t k = 0; k < count; ++k) {
            const double at = double(k) / double(count), before = (values[k] - interpolated(values, at - kSmall)) / kSmall, after = (interpolated(values, at + kSmall) - values[k]) / kSmall;
            CHECK(std::abs(after - before) < 1.01 * kSmall * std::pow(std::numbers::pi * double(count), 2) * std::sqrt(double(count)));
        }
        for (std::size_t order = 1; 2 * order < count; ++order) {
            std::vector<double> wave;
            for (std::size_t k = 0; k < count; ++k) wave.push_back(std::cos(2.0 * std::numbers::pi * double(order * k) / double(count) - 0.7));
            for (const double phase : {0.1, 0.37, 0.9}) CHECK(interpolated(wave, phase) == doctest::Approx(std::cos(2.0 * std::numbers::pi * double(order) * phase - 0.7)).epsilon(1e-11));
        }
    }
}

TEST_CASE("cycle: it is made of kept poses, changed, renamed with what is mapped to it, and removed, each in one step") {
    Gait g;
    CHECK(g.good({{"do", "add-cycle"}, {"poses", {"p", "q", "r"}}})["name"] == "cycle 1");
    CHECK(cyclesOf(g.document()).front().seconds == 2.0);
    CHECK(g.good({{"do", "add-cycle"}, {"name", "cycle 1"}, {"seconds", 1.5}})["replaced"] == true);
    CHECK(cyclesOf(g.document()).front() == Cycle{"cycle 1", {"p", "q", "r"}, 1.5});
    g.good({{"do", "map-input"}, {"source", "pad"}, {"channel", "left-trigger"}, {"target", "cycle/cycle 1/amount"}});
    g.good({{"do", "add-cycle"}, {"name", "to and fro"}, {"poses", {"p", "q", "p", "s"}}});
    CHECK(g.refused({{"do", "rename-cycle"}, {"cycle", "cycle 1"}, {"name", "to and fro"}}) == "name-taken");
    g.good({{"do", "rename-cycle"}, {"cycle", "cycle 1"}, {"name", "walk"}});
    CHECK((*g.document().mappings)[0].target == "cycle/walk/amount");
    const Json listed = g.good({{"do", "list"}});
    CHECK(listed["poses"] == Json({"p", "q", "r", "s"}));
    CHECK(listed["cycles"][0] == Json({{"name", "walk"}, {"poses", {"p", "q", "r"}}, {"seconds", 1.5}}));
    g.good({{"do", "undo"}});
    CHECK(cyclesOf(g.document()).front().name == "cycle 1");
    CHECK((*g.document().mappings)[0].target == "cycle/cycle 1/amount");
    g.good({{"do", "redo"}});
    CHECK(g.good({{"do", "remove-cycle"}, {"cycle", "walk"}})["removed_poses"].empty());
    CHECK(keptPoses(g.document()).size() == 4);
    CHECK(mappedTarget(g.document(), "cycle/walk/amount").error().code == "no-such-cycle");
    g.good({{"do", "undo"}});
    // "p" and "q" are of another cycle, too.
    CHECK(g.good({{"do", "remove-cycle"}, {"cycle", "walk"}, {"poses", true}})["removed_poses"] == Json({"r"}));
    CHECK(keptPoses(g.document()).size() == 3);
    g.good({{"do", "undo"}});
    CHECK(keptPoses(g.document()).size() == 4);
    CHECK(cyclesOf(g.document()).size() == 2);
}

TEST_CASE("cycle: it follows a pose that gets another name, and a pose that it goes through is not removed") {
    Gait g;
    g.good({{"do", "add-cycle"}, {"name", "walk"}, {"poses", {"p", "q", "p"}}});
    g.good({{"do", "rename-pose"}, {"pose", "p"}, {"name", "first"}});
    CHECK(cycleNamed(g.document(), "walk")->poses == std::vector<std::string>{"first", "q", "first"});
    CHECK(g.refused({{"do", "remove-pose"}, {"pose", "q"}}) == "pose-in-cycle");
    CHECK(keptPoses(g.document()).size() == 4);
    g.good({{"do", "remove-pose"}, {"pose", "s"}});
    g.good({{"do", "remove-cycle"}, {"cycle", "walk"}});
    g.good({{"do", "remove-pose"}, {"pose", "q"}});
}

TEST_CASE("cycle: what is none is refused, and nothing changes") {
    Gait g;
    CHECK(g.refused({{"do", "add-cycle"}, {"name", "walk"}}) == "missing-key");
    CHECK(g.refused({{"do", "add-cycle"}, {"poses", {"p"}}}) == "cycle-poses");
    CHECK(g.refused({{"do", "add-cycle"}, {"poses", std::vector<std::string>(65, "p")}}) == "cycle-poses");
    CHECK(g.refused({{"do", "add-cycle"}, {"poses", {"p", "nobody"}}}) == "no-such-pose");
    CHECK(g.refused({{"do", "add-cycle"}, {"poses", {"p", 3}}}) == "bad-type");
    CHECK(g.refused({{"do", "add-cycle"}, {"poses", {"p", "q"}}, {"seconds", 0.0}}) == "bad-value");
    CHECK(g.refused({{"do", "add-cycle"}, {"poses", {"p", "q"}}, {"name", "a/b"}}) == "bad-name");
    CHECK(g.refused({{"do", "rename-cycle"}, {"cycle", "walk"}, {"name", "run"}}) == "no-such-cycle");
    CHECK(g.refused({{"do", "remove-cycle"}, {"cycle", "walk"}}) == "no-such-cycle");
    CHECK(g.document().cycles == nullptr);
    CHECK(!mappedTarget(g.document(), "cycle/walk/weight"));
}

TEST_CASE("cycle: cycles are saved with the project, in their order, and what a file says is not trusted") {
    Gait g;
    const TestFolder folder;
    g.good({{"do", "add-cycle"}, {"name", "walk"}, {"poses", {"p", "q", "r"}}, {"seconds", 0.7}});
    g.good({{"do", "add-cycle"}, {"name", "breathe"}, {"poses", {"p", "s"}}});
    const Json before = cyclesJson(cyclesOf(g.document()));
    const std::string file = (folder / "cycles.imomushi").string();
    g.good({{"do", "save"}, {"path", file}});
    g.good({{"do", "new"}});
    CHECK(cyclesOf(g.document()).empty());
    g.good({{"do", "open"}, {"path", file}});
    CHECK(cyclesJson(cyclesOf(g.document())) == before);
    REQUIRE(cyclesFrom(before).has_value());
    for (const char* pointer : {"/0/name", "/0/poses", "/0/poses/1", "/0/seconds"})
        for (const Json& wrong : {Json(""), Json(1e300), Json::object(), Json(nullptr), Json::array()}) {
            Json tampered = before;
            tampered[Json::json_pointer(pointer)] = wrong;
            // A pose that is not there is waited for, whatever its name.
            if (std::string(pointer) == "/0/poses/1" && wrong.is_string()) continue;
            CHECK_MESSAGE(!cyclesFrom(tampered).has_value(), pointer << " " << wrong.dump());
        }
    Json twice = before;
    twice[1]["name"] = "walk";
    CHECK(!cyclesFrom(twice).has_value());
    CHECK(!cyclesFrom(Json::object()).has_value());
}
