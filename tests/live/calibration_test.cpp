// SPDX-License-Identifier: GPL-3.0-or-later
// Sources that are calibrated in poses, and what their rows drive then.
#include <cmath>
#include <map>
#include <numbers>

#include "core/base/rotation_vector.h"
#include "core/document/kept_pose.h"
#include "core/document/source_calibration.h"
#include "tests/live/puppet.h"
#include "tests/support/allocations.h"
#include "tests/support/input_values.h"

using namespace imomushi;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
const Vec3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);
Eigen::Quaterniond about(const Vec3& axis, double degrees) { return rotationOf(Vec3(degrees * kDegree * axis.normalized())); }

/// As a VMC sender says it.
std::vector<double> numbersOf(const Eigen::Quaterniond& q, const Vec3& at = Vec3(0.1, 0.9, -0.2)) {
    const Vec3 v = rotationVector(q);
    return {at.x(), at.y(), at.z(), q.x(), q.y(), q.z(), q.w(), v.x(), v.y(), v.z()};
}
InputValue valueOfAll(const std::string& source, const std::string& channel, const std::vector<double>& numbers) {
    InputValue made = valueOf(source, channel, {});
    std::copy(numbers.begin(), numbers.end(), made.numbers.begin());
    made.count = static_cast<int>(numbers.size());
    return made;
}

/// Bones a and b, one after the other, by the hips and an arm of "body"; the man smiles by "face".
struct Performed : Puppet {
    Performed() {
        for (const auto& [channel, bone] : {std::pair("bone/Hips", "a"), std::pair("bone/LeftUpperArm", "b")})
            for (int k = 0; k < 3; ++k)
                good({{"do", "map-input"}, {"source", "body"}, {"channel", channel}, {"component", 7 + k}, {"target", std::string("bone/") + bone + "/turn-" + "xyz"[k]}, {"in", {-std::numbers::pi, std::numbers::pi}}});
        map("jaw", "morph/man/smile");
    }
    Json calibrate(const Json& values, const std::string& pose = {}, const std::string& source = "body") {
        Json line{{"do", "calibrate-source"}, {"source", source}, {"values", values}};
        if (!pose.empty()) line["pose"] = pose;
        return good(line);
    }
};

Json saysJson(const Eigen::Quaterniond& hips, const Eigen::Quaterniond& arm) { return {{"bone/Hips", numbersOf(hips)}, {"bone/LeftUpperArm", numbersOf(arm)}}; }

/// Where it brings joint points within half a second.
std::map<int, Vec3> placesOf(InputDriver& driver, const CharacterPlan& plan, const Eigen::Quaterniond& hips, const Eigen::Quaterniond& arm) {
    REQUIRE(driver.take(valueOfAll("body", "bone/Hips", numbersOf(hips))));
    REQUIRE(driver.take(valueOfAll("body", "bone/LeftUpperArm", numbersOf(arm))));
    std::map<int, Vec3> places;
    for (int i = 0; i < 30; ++i)
        for (const LiveInput& input : driver.step(kStep))
            if (input.kind == LiveInput::Kind::End) places[plan.pointIndex(input.end)] = input.target;
    return places;
}

double apart(const std::map<int, Vec3>& a, const std::map<int, Vec3>& b) {
    REQUIRE(a.size() == b.size());
    double most = 0.0;
    for (const auto& [point, at] : a) most = std::max(most, (at - b.at(point)).norm());
    return most;
}

}  // namespace

TEST_CASE("calibration: a sender who stands turned half round and leans drives the character to rest in its pose, and from there as one who stands straight") {
    Performed p;
    const Eigen::Quaterniond none = Eigen::Quaterniond::Identity(), turned = about(kY, 180.0), leans = about(kX, 10.0), hangs = about(kZ, -70.0);
    InputDriver straight = p.driver();
    const Json answer = p.calibrate(saysJson(turned * leans, hangs));
    REQUIRE(answer["poses"].size() == 1);
    CHECK(answer["poses"][0]["pose"].is_null());
    CHECK(answer["poses"][0]["rows"] == 6);
    CHECK(answer["poses"][0]["degrees"].get<double>() < 1e-6);
    InputDriver driver = p.driver();
    const CharacterPlan& plan = p.session.plan();
    (void)placesOf(driver, plan, turned * about(kX, 40.0) * leans, hangs);  // elsewhere, and back
    const auto rest = placesOf(driver, plan, turned * leans, hangs);
    REQUIRE(rest.size() == 3);
    for (const auto& [point, at] : rest) CHECK((at - plan.input.skeleton.points[static_cast<std::size_t>(point)]).norm() < 1e-6);
    for (const auto& [hips, arm] : {std::pair(about(kX, 30.0), none), std::pair(about(kZ, -25.0), about(kX, 60.0)), std::pair(about(Vec3(1, 2, 0), 80.0), about(kY, 40.0))}) {
        // Angles of bones of 3 m: a degree is 5 cm.
        CHECK(apart(placesOf(driver, plan, turned * hips * leans, arm * hangs), placesOf(straight, plan, hips, arm)) < 1e-6);
    }
    // Without it the same sender turns the chain elsewhere.
    p.good({{"do", "undo"}});
    InputDriver uncorrected = p.driver();
    CHECK(apart(placesOf(uncorrected, plan, turned * leans, hangs), rest) > 0.5);
}

TEST_CASE("calibration: in two and three kept poses each is met when the sender says them, though its axes are others; what it cannot meet is the residual") {
    Performed p;
    const CharacterPlan& plan = p.session.plan();
    std::vector<Pose> poses{restPose(plan.input.skeleton)};
    for (const auto& [name, to] : {std::pair("left", Vec3(2.0, 0.5, 5.0)), std::pair("up", Vec3(-0.3, 2.5, 4.9))}) {
        p.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {to.x(), to.y(), to.z()}}});
        p.good({{"do", "keep-pose"}, {"name", name}});
    }
    p.good({{"do", "rest"}});
    // What bones do there, as somebody says it whose axes are turned and whose sensors are worn askew.
    const auto parts = [&](const std::string& name) {
        std::array<Eigen::Quaterniond, 2> turns{Eigen::Quaterniond::Identity(), Eigen::Quaterniond::Identity()};
        if (name.empty()) return turns;
        const KeptPose& kept = *keptPose(p.session.document(), name);
        const auto frame = [&](const char* bone) { return kept.bones.at(p.session.document().boneNamed(bone)->id).frame; };
        turns = {frame("a").normalized(), (frame("a").conjugate() * frame("b")).normalized()};
        return turns;
    };
    const Eigen::Quaterniond axes = about(Vec3(1, 1, 0), 50.0), worn = about(kZ, 25.0);
    const auto says = [&](const std::string& name) {
        const auto turns = parts(name);
        return saysJson(axes * turns[0] * worn, worn * turns[1] * axes);
    };
    (void)p.calibrate(says(""));
    CHECK(p.calibrate(says("left"), "left")["poses"].size() == 2);
    const Json answer = p.calibrate(says("up"), "up");
    REQUIRE(answer["poses"].size() == 3);
    for (const Json& pose : answer["poses"]) CHECK(pose["degrees"].get<double>() < 1e-4);
    for (const char* name : {"", "left", "up"}) {
        CAPTURE(name);
        InputDriver driver = p.driver();
        const auto turns = parts(name);
        const auto places = placesOf(driver, plan, axes * turns[0] * worn, worn * turns[1] * axes);
        const Vec3 b = places.rbegin()->second;
        const Vec3 meant = 3.0 * (turns[0] * kZ) + 3.0 * (turns[0] * turns[1] * kZ);
        CHECK((b - meant).norm() < 1e-5);
    }
    // A fourth one is too many; that of a pose again replaces it.
    p.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.0, -2.0, 5.0}}});
    p.good({{"do", "keep-pose"}, {"name", "more"}});
    p.good({{"do", "rest"}});
    CHECK(p.code({{"do", "calibrate-source"}, {"source", "body"}, {"pose", "more"}, {"values", says("up")}}) == "too-many-calibrated");
    // Who is 12 degrees elsewhere in one of them cannot be met in all.
    const auto turns = parts("up");
    const Json off = p.calibrate(saysJson(about(kX, 12.0) * axes * turns[0] * worn, worn * turns[1] * axes), "up");
    double most = 0.0;
    for (const Json& pose : off["poses"]) most = std::max(most, pose["degrees"].get<double>());
    CHECK(most > 1.0);
    CHECK(most < 12.0);
}

TEST_CASE("calibration: weights get an offset and a gain through their curves, places are moved; rows that toggle and triggers are left alone") {
    Performed p;
    p.map("press", "morph/man/frown", {{"toggle", true}});
    p.map("go", "trigger/let-go");
    for (int k = 0; k < 3; ++k) p.map("hand", std::string("handle/tip/") + "xyz"[k], {{"component", k}, {"in", {-1, 1}}});
    const Json first = p.calibrate({{"jaw", 0.2}, {"press", 0.7}, {"go", 0.7}, {"hand", {0.1, 0.2, 0.3}}}, {}, "face");
    CHECK(first["poses"][0]["rows"] == 4);
    CHECK(first["poses"][0]["percent"].get<double>() < 1e-9);
    CHECK(first["poses"][0]["mm"].get<double>() < 1e-9);
    p.good({{"do", "morph"}, {"character", "man"}, {"target", "smile"}, {"weight", 0.9}});
    p.good({{"do", "keep-pose"}, {"name", "laughs"}});
    p.good({{"do", "morph"}, {"character", "man"}, {"target", "smile"}, {"weight", 0.0}});
    (void)p.calibrate({{"jaw", {0.5}}, {"hand", {0.1, 0.2, 0.3}}}, "laughs", "face");
    InputDriver driver = p.driver();
    REQUIRE(driver.take(valueOf("face", "jaw", {0.35})));
    CHECK(lastOf(driver, LiveInput::Kind::Morph)->weight == doctest::Approx(0.45).epsilon(1e-9));
    REQUIRE(driver.take(valueOf("face", "press", {0.7})));
    CHECK(lastOf(driver, LiveInput::Kind::Morph)->weight == doctest::Approx(1.0));
    REQUIRE(driver.take(valueOf("face", "hand", {0.1, 0.2, 0.8})));
    const Vec3 up = lastOf(driver, LiveInput::Kind::Handle)->target;
    REQUIRE(driver.take(valueOf("face", "hand", {0.1, 0.2, 0.3})));
    CHECK((up - lastOf(driver, LiveInput::Kind::Handle)->target - Vec3(0, 0, 0.5)).norm() < 1e-9);
}

TEST_CASE("calibration: taking and stepping need no memory, and values that are cut short move nothing else") {
    Performed p;
    (void)p.calibrate(saysJson(about(kY, 180.0), about(kX, 20.0)));
    InputDriver driver = p.driver();
    const InputValue whole = valueOfAll("body", "bone/Hips", numbersOf(about(kY, 150.0))), cut = valueOf("body", "bone/Hips", {0, 1, 0, 0, 0, 0, 1, 0.5});
    (void)placesOf(driver, p.session.plan(), about(kY, 180.0), about(kX, 20.0));
    const std::size_t before = allocations();
    (void)driver.take(whole);
    (void)driver.step(kStep);
    (void)driver.take(cut);
    (void)driver.step(kStep);
    const std::size_t after = allocations();
    CHECK(after == before);
}

TEST_CASE("calibration: what cannot be measured is refused with the reason, and nothing changes") {
    Performed p;
    const Json values = saysJson(Eigen::Quaterniond::Identity(), about(kX, 20.0));
    const auto said = [](const char* source, Json values) { return Json{{"do", "calibrate-source"}, {"source", source}, {"values", std::move(values)}}; };
    CHECK(p.code(said("nobody", values)) == "source-not-mapped");
    CHECK(p.code(said("body", Json::object())) == "nothing-measured");
    CHECK(p.code(said("body", {{"bone/Spine", {1, 2, 3}}})) == "nothing-measured");
    CHECK(p.code(said("body", {{"bone/Hips", {0.1, 0.2}}})) == "nothing-measured");
    CHECK(p.code(said("body", {{"bone/Hips", "left"}})) == "bad-type");
    CHECK(p.code(said("body", {{"bone/Hips", Json::array()}})) == "bad-type");
    CHECK(p.code(said("body", {{"bone/Hips", {1e300}}})) == "bad-value");
    CHECK(p.code(said("body", {{"", {1.0}}})) == "bad-value");
    Json there = said("body", values);
    there["pose"] = "nowhere";
    CHECK(p.code(there) == "no-such-pose");
    CHECK(p.code({{"do", "clear-calibration"}, {"source", "body"}}) == "not-calibrated");
    CHECK(calibratedSources(p.session.document()).empty());
    // In two poses of the character it says the same.
    (void)p.calibrate(values);
    p.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {2.0, 0.5, 5.0}}});
    p.good({{"do", "keep-pose"}, {"name", "left"}});
    p.good({{"do", "rest"}});
    there["pose"] = "left";
    CHECK(p.code(there) == "measured-alike");
    CHECK(calibrationOf(p.session.document(), "body")->poses.size() == 1);
    CHECK(p.code({{"do", "clear-calibration"}, {"source", "body"}, {"pose", "left"}}) == "not-calibrated");
}

TEST_CASE("calibration: it is undone, saved, kept by its source while that has rows, and follows its kept poses") {
    Performed p;
    const Document& document = p.session.document();
    p.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {2.0, 0.5, 5.0}}});
    p.good({{"do", "keep-pose"}, {"name", "left"}});
    p.good({{"do", "rest"}});
    (void)p.calibrate(saysJson(Eigen::Quaterniond::Identity(), about(kX, 20.0)));
    (void)p.calibrate(saysJson(about(kY, 40.0), about(kX, 60.0)), "left");
    const SourceCalibration both = *calibrationOf(document, "body");
    CHECK(both.poses.size() == 2);
    CHECK(!calibrationOf(document, "face"));
    p.good({{"do", "undo"}});
    CHECK(calibrationOf(document, "body")->poses.size() == 1);
    p.good({{"do", "redo"}});
    CHECK(*calibrationOf(document, "body") == both);

    const TestFolder folder;
    const std::string path = (folder.path() / "stands.imomushi").string(), table = (folder.path() / "rows.json").string();
    p.good({{"do", "save"}, {"path", path}});
    p.good({{"do", "save-mappings"}, {"path", table}});
    p.good({{"do", "open"}, {"path", path}});
    CHECK(*calibrationOf(p.session.document(), "body") == both);
    const Json list = p.good({{"do", "list"}});
    REQUIRE(list["calibrations"].size() == 1);
    CHECK(list["calibrations"][0]["source"] == "body");
    CHECK(list["calibrations"][0]["poses"] == Json::array({{{"pose", nullptr}, {"channels", 2}}, {{"pose", "left"}, {"channels", 2}}}));

    // Rows come and go, a file of mappings brings none with it.
    p.good({{"do", "map-input"}, {"source", "body"}, {"channel", "blend/A"}, {"target", "morph/man/frown"}});
    p.good({{"do", "unmap-input"}, {"source", "body"}, {"channel", "bone/Hips"}});
    CHECK(*calibrationOf(p.session.document(), "body") == both);
    p.good({{"do", "unmap-input"}, {"source", "body"}});
    CHECK(calibratedSources(p.session.document()).empty());
    p.good({{"do", "load-mappings"}, {"path", table}});
    CHECK(calibratedSources(p.session.document()).empty());
    p.good({{"do", "undo"}});
    p.good({{"do", "undo"}});
    p.good({{"do", "load-mappings"}, {"path", table}});
    CHECK(*calibrationOf(p.session.document(), "body") == both);

    p.good({{"do", "rename-pose"}, {"pose", "left"}, {"name", "aside"}});
    CHECK(calibrationOf(p.session.document(), "body")->poses[1].name == "aside");
    CHECK(p.good({{"do", "remove-pose"}, {"pose", "aside"}})["uncalibrated"] == Json::array({"body"}));
    CHECK(calibrationOf(p.session.document(), "body")->poses.size() == 1);
    CHECK(p.good({{"do", "clear-calibration"}, {"source", "body"}, {"pose", ""}})["cleared"] == 1);
    CHECK(calibratedSources(p.session.document()).empty());
}
