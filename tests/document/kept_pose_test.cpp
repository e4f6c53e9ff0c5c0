// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/kept_pose.h"

#include "core/document/character_input.h"
#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

/// A sample without motion of its own.
struct Sample : Workbench {
    explicit Sample(const std::string& name) {
        good({{"do", "open"}, {"path", std::string(IMOMUSHI_SAMPLES) + "/" + name + ".imomushi"}});
        if (document().effects.has(EffectKind::BoneDynamics)) good({{"do", "disable"}, {"effect", "bone-dynamics"}});
    }
    const Document& document() { return session.document(); }
    void drag(const char* end, const Vec3& to) { good({{"do", "drag"}, {"endpoint", end}, {"to", {to.x(), to.y(), to.z()}}}); }
    Vec3 at(const char* end) {
        const auto place = session.positionOf(*document().endpoint(end));
        REQUIRE(place.has_value());
        return *place;
    }
    std::string refused(const Json& command) {
        const auto answer = run(command);
        return answer ? "" : answer.error().code;
    }
};

}  // namespace

TEST_CASE("kept pose: applied again it is what was kept, to the byte, with what held it, in one step") {
    Sample s("caterpillar");
    s.drag("head-bone/end", {1.1, 0.8, 0.3});
    s.good({{"do", "pin"}, {"endpoint", "rear-bone/end"}});
    CHECK(s.good({{"do", "keep-pose"}})["name"] == "pose 1");
    const Pose kept = s.document().pose;
    const auto goals = s.document().goals;
    REQUIRE(!kept.points.empty());
    s.good({{"do", "unpin"}, {"endpoint", "rear-bone/end"}});
    s.good({{"do", "rest"}});
    const int before = s.session.position();
    s.good({{"do", "apply-pose"}, {"name", "pose 1"}});
    CHECK(s.session.position() == before + 1);
    CHECK(s.document().pose.points == kept.points);
    CHECK(s.document().pose.roll == kept.roll);
    REQUIRE(s.document().goals.size() == goals.size());
    for (const auto& [end, goal] : goals) {
        CHECK(s.document().goals.at(end).target == goal.target);
        CHECK(s.document().goals.at(end).pinned == goal.pinned);
    }
    s.good({{"do", "undo"}});
    CHECK(s.document().pose.points.empty());
    s.good({{"do", "redo"}});
    CHECK(s.document().pose.points == kept.points);
    // Nothing pulls it elsewhere as time passes.
    const Vec3 head = s.at("head-bone/end");
    s.good({{"do", "step"}, {"frames", 30}});
    CHECK((s.at("head-bone/end") - head).norm() < 1e-3);
}

TEST_CASE("kept pose: a part of the way leads between the pose that is and the kept one") {
    Sample s("caterpillar");
    s.drag("head-bone/end", {1.1, 0.8, 0.3});
    const Vec3 up = s.at("head-bone/end");
    s.good({{"do", "keep-pose"}, {"name", "up"}});
    s.good({{"do", "rest"}});
    const Vec3 rest = s.at("head-bone/end");
    double last = 0.0;
    for (const double share : {0.0, 0.25, 0.5, 0.75}) {
        CAPTURE(share);
        s.good({{"do", "apply-pose"}, {"name", "up"}, {"share", share}});
        const double way = (s.at("head-bone/end") - rest).norm();
        CHECK((s.at("head-bone/end") - (rest + share * (up - rest))).norm() < 0.05 * (up - rest).norm());
        CHECK(way >= last);
        last = way;
        s.good({{"do", "undo"}});
    }
    CHECK(s.refused({{"do", "apply-pose"}, {"name", "up"}, {"share", 1.5}}) == "bad-value");
}

TEST_CASE("kept pose: poses are saved with the project, in their order, and renamed and removed by their names") {
    Sample s("caterpillar");
    const TestFolder folder;
    s.drag("head-bone/end", {1.1, 0.8, 0.3});
    s.good({{"do", "keep-pose"}, {"name", "up"}});
    s.drag("head-bone/end", {1.0, 0.3, -0.4});
    s.good({{"do", "keep-pose"}, {"name", "down"}});
    const Json before = keptPosesJson(keptPoses(s.document()));
    CHECK(before.size() == 2);
    const std::string file = (folder / "poses.imomushi").string();
    s.good({{"do", "save"}, {"path", file}});
    s.good({{"do", "new"}});
    CHECK(keptPoses(s.document()).empty());
    s.good({{"do", "open"}, {"path", file}});
    CHECK(keptPosesJson(keptPoses(s.document())) == before);
    CHECK(s.good({{"do", "keep-pose"}, {"name", "down"}})["replaced"] == true);
    CHECK(s.refused({{"do", "rename-pose"}, {"pose", "down"}, {"name", "up"}}) == "name-taken");
    s.good({{"do", "rename-pose"}, {"pose", "down"}, {"name", "low"}});
    CHECK(s.refused({{"do", "apply-pose"}, {"name", "down"}}) == "no-such-pose");
    s.good({{"do", "remove-pose"}, {"pose", "up"}});
    REQUIRE(keptPoses(s.document()).size() == 1);
    CHECK(keptPoses(s.document()).front().name == "low");
    s.good({{"do", "undo"}});
    CHECK(keptPoses(s.document()).size() == 2);
    // A bone that is gone takes no part.
    s.good({{"do", "remove-bone"}, {"name", "head-bone"}});
    s.good({{"do", "apply-pose"}, {"name", "up"}});
}

TEST_CASE("kept pose: what a file says is not trusted") {
    Sample s("caterpillar");
    s.drag("head-bone/end", {1.1, 0.8, 0.3});
    s.good({{"do", "keep-pose"}});
    const Json good = keptPosesJson(keptPoses(s.document()));
    CHECK(keptPosesFrom(good).has_value());
    for (const char* pointer : {"/0/name", "/0/bones", "/0/bones/0/1/0", "/0/bones/0/3/2", "/0/goals/0/0", "/0/goals/0/2", "/0/morphs"})
        for (const Json& wrong : {Json("x"), Json(1e300), Json::object(), Json(nullptr)}) {
            Json tampered = good;
            tampered[Json::json_pointer(pointer)] = wrong;
            if (std::string(pointer) == "/0/name" && wrong.is_string()) continue;
            CHECK_MESSAGE(!keptPosesFrom(tampered).has_value(), pointer << " " << wrong.dump());
        }
    CHECK(!keptPosesFrom(Json::object()).has_value());
}

TEST_CASE("kept pose: left and right are exchanged by names, and twice is once") {
    Sample s("dragon");
    const Vec3 left = s.at("arm.L/end"), right = s.at("arm.R/end");
    s.drag("arm.L/end", left + Vec3(0.05, 0.2, 0.1));
    const Vec3 moved = s.at("arm.L/end") - left;
    REQUIRE(moved.norm() > 0.05);
    s.good({{"do", "keep-pose"}, {"name", "wave"}});
    const Vec3 along = s.at("arm.R/end") - right;
    s.good({{"do", "mirror-pose"}});
    const Vec3 other = s.at("arm.R/end") - right;
    CHECK((other - Vec3(-moved.x(), moved.y(), moved.z())).norm() < 0.02);
    CHECK((s.at("arm.L/end") - left - Vec3(-along.x(), along.y(), along.z())).norm() < 0.02);
    s.good({{"do", "mirror-pose"}});
    CHECK((s.at("arm.L/end") - left - moved).norm() < 0.02);
    s.good({{"do", "rest"}});
    s.good({{"do", "apply-pose"}, {"name", "wave"}, {"mirrored", true}});
    CHECK((s.at("arm.R/end") - right - other).norm() < 0.02);
}

TEST_CASE("kept pose: one bone or a chain goes back to rest, and the others keep their pose") {
    Sample s("caterpillar");
    s.drag("head-bone/end", {0.7, 1.0, 0.4});
    s.good({{"do", "release"}});
    const Vec3 tail = s.at("tail-bone/start");
    const auto bend = [&](const char* bone) {
        const auto& plan = s.session.plan();
        const int b = plan.boneIndex(s.document().boneNamed(bone)->id), parent = plan.input.skeleton.bones[std::size_t(b)].parent;
        const auto& frames = s.session.shownPose().frames;
        return frames[std::size_t(parent)].angularDistance(frames[std::size_t(b)]);
    };
    const double middle = bend("middle-bone"), front = bend("front-bone"), head = bend("head-bone");
    REQUIRE(middle > 0.01);
    REQUIRE(front > 0.01);
    s.good({{"do", "rest-bones"}, {"bones", {"front-bone"}}});
    CHECK(bend("front-bone") < 1e-6);
    CHECK(bend("middle-bone") == doctest::Approx(middle));
    CHECK(bend("head-bone") == doctest::Approx(head));
    s.good({{"do", "undo"}});
    CHECK(s.good({{"do", "rest-bones"}, {"bones", {"middle-bone"}}, {"chain", true}})["bones"] == 3);
    for (const char* bone : {"middle-bone", "front-bone", "head-bone"}) CHECK(bend(bone) < 1e-6);
    CHECK((s.at("tail-bone/start") - tail).norm() < 1e-9);
    CHECK(s.refused({{"do", "rest-bones"}, {"bones", {"no"}}}) == "no-such-bone");
}
