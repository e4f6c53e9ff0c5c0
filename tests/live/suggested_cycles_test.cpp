// SPDX-License-Identifier: GPL-3.0-or-later
// Cycles that follow from a skeleton.
#include "core/live/suggested_cycles.h"

#include <cmath>
#include <map>
#include <numbers>

#include "core/live/input_driver.h"
#include "core/live/pose_parts.h"
#include "core/live/suggested_mappings.h"
#include "tests/live/puppet.h"
#include "tests/support/input_values.h"

using namespace imomushi;

namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

struct Sample : Workbench {
    explicit Sample(const std::string& name) { good({{"do", "open"}, {"path", std::string(IMOMUSHI_SAMPLES) + "/" + name + ".imomushi"}}); }
    const Document& document() { return session.document(); }
    PoseParts parts(const std::string& pose) { return partsOf(*keptPose(document(), pose), document(), session.plan(), boneTree(session.plan().input.skeleton)); }
    int bone(const std::string& name) { return session.plan().boneIndex(document().boneNamed(name)->id); }
};

Vec3 turnOf(const PoseParts& parts, int bone) {
    for (const PoseParts::Bone& b : parts.bones)
        if (b.bone == bone) return b.turn;
    return Vec3::Zero();
}

}  // namespace

TEST_CASE("suggested cycles: the caterpillar crawls, sways and breathes, in one step, and again it is the same") {
    Sample s("caterpillar");
    const int before = s.session.position();
    const Json answer = s.good({{"do", "suggest-cycles"}});
    CHECK(answer["cycles"] == Json({"crawl", "sway", "breathe"}));
    CHECK(s.session.position() == before + 1);
    CHECK(cycleNamed(s.document(), "crawl")->poses == std::vector<std::string>{"crawl 1", "crawl 2", "crawl 3"});
    const Json poses = keptPosesJson(keptPoses(s.document()));
    s.good({{"do", "suggest-cycles"}});
    CHECK(keptPosesJson(keptPoses(s.document())) == poses);
    CHECK(cyclesOf(s.document()).size() == 3);
    s.good({{"do", "undo"}, {"count", 2}});
    CHECK(s.document().cycles == nullptr);
    CHECK(s.document().poses == nullptr);
}

TEST_CASE("suggested cycles: they may have other names, and their poses with them; names of other kinds, or one name twice, are refused") {
    Sample caterpillar("caterpillar");
    const Json answer = caterpillar.good({{"do", "suggest-cycles"}, {"names", {{"crawl", "這う"}, {"breathe", "sigh"}}}});
    CHECK(answer["cycles"] == Json({"這う", "sway", "sigh"}));
    for (const Cycle& cycle : cyclesOf(caterpillar.document())) {
        CHECK(isWhole(caterpillar.document(), cycle));
        for (std::size_t p = 0; p < cycle.poses.size(); ++p) CHECK(cycle.poses[p] == cycle.name + " " + std::to_string(p + 1));
    }
    for (const Json& names : {Json{{"walk", "w"}}, Json{{"crawl", "c"}, {"sway", "c"}}, Json{{"crawl", "sway"}}, Json{{"crawl", 1}}, Json{{"crawl", ""}}}) CHECK(!caterpillar.run({{"do", "suggest-cycles"}, {"names", names}}));
    CHECK(cyclesOf(caterpillar.document()).size() == 3);
}

TEST_CASE("suggested cycles: three poses meet the wave of a chain exactly at every phase") {
    Sample s("caterpillar");
    s.good({{"do", "suggest-cycles"}});
    const CharacterPlan& plan = s.session.plan();
    const Skeleton& skeleton = plan.input.skeleton;
    // All bones are one chain, from the tail, which is pinned, to the head.
    double length = 0.0;
    std::vector<double> at = {0.0};
    for (const auto& bone : skeleton.bones) at.push_back(length += bone.length);
    for (double& a : at) a /= length;
    const auto g = [](double where) { return std::sin(0.5 * std::numbers::pi * where); };
    const PoseParts crawl[] = {s.parts("crawl 1"), s.parts("crawl 2"), s.parts("crawl 3")}, sway[] = {s.parts("sway 1"), s.parts("sway 2"), s.parts("sway 3")};
    for (const double t : {0.0, 0.11, 1.0 / 3.0, 0.5, 0.77}) {
        const auto blended = [&](const PoseParts(&poses)[3], int bone) {
            Vec3 turn = Vec3::Zero();
            for (std::size_t k = 0; k < 3; ++k) turn += cycleWeight(k, 3, t) * turnOf(poses[k], bone);
            return turn;
        };
        const auto height = [&](double where) { return 0.06 * length * g(where) * (1.0 + std::cos(kTurn * (t - where))); };
        // Its direction is +x and up to a little +y: it turns upwards about +z, and to its side about the axis across that is nearest to +y.
        const Vec3 axis = turnOf(sway[0], 3).normalized();
        CHECK(std::abs(axis.y()) > 0.99);
        double slope = 0.0, lean = 0.0;
        for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
            CAPTURE(b);
            const double next = (height(at[b + 1]) - height(at[b])) / skeleton.bones[b].length;
            CHECK((blended(crawl, int(b)) - (next - slope) * Vec3::UnitZ()).norm() < 1e-9);
            slope = next;
            const double middle = 0.5 * (at[b] + at[b + 1]), side = 0.4 * g(middle) * std::sin(kTurn * (t - 0.75 * middle - 0.25));
            CHECK(std::abs(std::abs(blended(sway, int(b)).dot(axis)) - std::abs(side - lean)) < 1e-9);
            lean = side;
        }
    }
}

TEST_CASE("suggested cycles: a performed crawl stays on its ground and comes back to where it rests") {
    for (const char* name : {"caterpillar", "octopus"}) {
        CAPTURE(std::string(name));
        Sample s(name);
        s.good({{"do", "suggest-cycles"}});
        const CharacterPlan& plan = s.session.plan();
        InputDriver driver(s.document(), plan, kOsc);
        REQUIRE(driver.take(valueOf("osc", "/imomushi/cycle/crawl/amount", {1.0})));
        std::map<int, Vec3> last;
        double lowest = 0.0, highest = 0.0;
        for (int i = 0; i < 240; ++i)
            for (const LiveInput& input : driver.step(kStep)) {
                const int point = plan.pointIndex(input.end);
                const double up = input.target.y() - plan.input.skeleton.points[std::size_t(point)].y();
                last[point] = input.target;
                lowest = std::min(lowest, up), highest = std::max(highest, up);
            }
        const double size = characterSize(s.document());
        MESSAGE(std::string(name) << ": joint points go " << 100.0 * lowest / size << " % of the size below where they rest, and rise by " << 100.0 * highest / size << " %");
        // Turns of bones that stand in the wave sink what hangs on them a little.
        CHECK(lowest > -0.012 * size);
        CHECK(highest > 0.02 * size);
        CHECK(highest < 0.15 * size);
        REQUIRE(driver.take(valueOf("osc", "/imomushi/cycle/crawl/amount", {0.0})));
        for (int i = 0; i < 30; ++i)
            for (const LiveInput& input : driver.step(kStep)) last[plan.pointIndex(input.end)] = input.target;
        for (const auto& [point, place] : last) CHECK((place - plan.input.skeleton.points[std::size_t(point)]).norm() < 1e-9);
    }
}

TEST_CASE("suggested cycles: joint limits are kept to the half, and legs and what carries them stand") {
    Sample s("caterpillar");
    s.good({{"do", "set"}, {"target", "front-bone"}, {"property", "max-bend"}, {"value", 0.1}});
    s.good({{"do", "suggest-cycles"}});
    for (const char* pose : {"crawl 1", "crawl 2", "crawl 3", "sway 1", "sway 2", "sway 3"}) CHECK(turnOf(s.parts(pose), s.bone("front-bone")).norm() < 0.5 * 0.1 + 1e-9);
    CHECK(turnOf(s.parts("crawl 1"), s.bone("front-bone")).norm() > 0.0);

    Sample figure("figure");
    const Json answer = figure.good({{"do", "suggest-cycles"}});
    CHECK(answer["cycles"] == Json({"sway", "breathe"}));  // nothing lies
    for (const char* pose : {"sway 1", "sway 2", "sway 3"})
        for (const auto& [id, bone] : figure.document().bones)
            if (bone->name.find("leg") != std::string::npos || bone->name.find("foot") != std::string::npos || bone->name.find("trunk") != std::string::npos)
                CHECK_MESSAGE(turnOf(figure.parts(pose), figure.session.plan().boneIndex(id)).norm() < 1e-9, bone->name);
}

TEST_CASE("suggested cycles: handles alone rise by breathing, and where there is nothing, that is said") {
    Workbench w;
    CHECK(w.code({{"do", "suggest-cycles"}}) == "nothing-to-cycle");
    w.good({{"do", "import-element"}, {"path", "bar0"}, {"name", "A"}});
    w.good({{"do", "handle"}, {"element", "A"}, {"name", "top"}, {"point", {0.5, 0.0, 1.5}}, {"radius", 0.4}});
    CHECK(w.good({{"do", "suggest-cycles"}})["poses"] == Json({"breathe 1", "breathe 2"}));
    const auto& handles = keptPose(w.session.document(), "breathe 1")->handles;
    REQUIRE(handles.size() == 1);
    CHECK(handles.begin()->second.target.at.y() > 0.05);
}

TEST_CASE("suggested cycles: the triggers of a pad perform the first cycle, and shoulders do what triggers did") {
    Sample s("octopus");
    const auto rowOf = [&](const std::string& channel) -> std::string {
        for (const InputMapping& m : *s.document().mappings)
            if (m.row.channel == channel) return m.target + " " + std::to_string(int(m.row.curve.outLow)) + " " + std::to_string(int(m.row.curve.outHigh));
        return {};
    };
    s.good({{"do", "suggest-mappings"}, {"protocol", "pad"}});
    const std::string forward = rowOf("left-trigger");
    CHECK(forward.find("/end/z") != std::string::npos);
    s.good({{"do", "suggest-cycles"}});
    s.good({{"do", "suggest-mappings"}, {"protocol", "pad"}});
    CHECK(rowOf("left-trigger") == "cycle/crawl/amount 0 1");
    CHECK(rowOf("right-trigger") == "cycle/crawl/speed 1 3");
    CHECK(rowOf("left-shoulder") == forward);
    CHECK(rowOf("a").empty());  // poses of cycles are no buttons
    s.good({{"do", "suggest-mappings"}, {"protocol", "keys"}});
    CHECK(rowOf("q").find("/end/z") != std::string::npos);
}
