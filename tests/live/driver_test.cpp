// SPDX-License-Identifier: GPL-3.0-or-later
#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <thread>

#include "core/document/command_support.h"
#include "core/document/input_mapping.h"
#include "core/input/input_decoder.h"
#include "core/input/osc_packet.h"
#include "core/live/direct_names.h"
#include "core/live/input_driver.h"
#include "tests/live/puppet.h"
#include "tests/support/allocations.h"
#include "tests/support/input_values.h"

using namespace imomushi;

TEST_CASE("driver: mapped numbers become targets of handles, ends of bones and morph targets; axes that nothing drives stay") {
    Puppet p;
    p.map("x", "handle/tip/x");
    p.map("turn", "handle/tip/turn-z");
    p.map("y", "bone/b/end/y", {{"out", {0.0, -2.0}}});
    p.map("roll", "bone/b/end/roll");
    p.map("joy", "morph/man/smile");
    InputDriver driver = p.driver();
    CHECK(driver.step(kStep).empty());
    CHECK(!driver.take(valueOf("body", "x", {1.0})));
    for (const char* channel : {"x", "turn", "y", "roll", "joy"}) CHECK(driver.take(valueOf("face", channel, {0.5})));
    InputDriver again = p.driver();
    const auto handle = lastOf(driver, LiveInput::Kind::Handle);
    REQUIRE(handle);
    const JointFace& face = p.session.document().elementNamed("B")->faces.back();
    CHECK(handle->target == Vec3(face.frame.origin + Vec3(0.5, 0.0, 0.0)));
    CHECK((handle->rotation.coeffs() - Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Vec3::UnitZ())).coeffs()).norm() < 1e-15);
    for (const char* channel : {"y", "joy"}) CHECK(again.take(valueOf("face", channel, {0.5})));
    const auto end = lastOf(again, LiveInput::Kind::End);
    REQUIRE(end);
    CHECK((end->target - Vec3(0.0, -1.0, 6.0)).norm() < 1e-12);
    CHECK(again.mapper().winner(0) == -1);
    CHECK(!again.take(valueOf("face", "nose", {1.0})));
}

TEST_CASE("driver: everything has an OSC address of its own, behind the rows of the table") {
    Puppet p;
    std::set<std::string> names;
    for (const DirectName& name : directNames(p.session.document())) names.insert(name.address);
    for (const char* name : {"/imomushi/handle/tip/position", "/imomushi/handle/tip/turn", "/imomushi/bone/a/start/position", "/imomushi/bone/b/end/roll", "/imomushi/morph/man/frown"}) CHECK(names.contains(name));
    CHECK(names.size() == 2 + 2 * 2 * 2 + 2);
    InputDriver driver = p.driver();
    CHECK(driver.take(valueOf("osc", "/imomushi/handle/tip/position", {1.0, 2.0, 3.0})));
    CHECK(!driver.take(valueOf("hands", "/imomushi/handle/tip/position", {1.0, 2.0, 3.0})));  // no OSC
    const auto handle = lastOf(driver, LiveInput::Kind::Handle);
    REQUIRE(handle);
    CHECK((handle->target - Vec3(1.0, 2.0, 3.0)).norm() < 1e-9);
    // A row of the table wins as long as it is not silent; the address takes over then.
    p.map("joy", "morph/man/smile", {{"silence", "next"}, {"after", 0.5}});
    InputDriver both = p.driver();
    CHECK(both.take(valueOf("osc", "/imomushi/morph/man/smile", {0.2})));
    CHECK(both.take(valueOf("face", "joy", {0.9})));
    CHECK(lastOf(both, LiveInput::Kind::Morph)->weight == 0.9);
    CHECK(std::abs(lastOf(both, LiveInput::Kind::Morph, 60)->weight - 0.2) < 1e-9);
}

TEST_CASE("driver: muted rows drive nothing, and beside a solo row all others are muted") {
    Puppet p;
    p.map("joy", "morph/man/smile", {{"mute", true}});
    p.map("sad", "morph/man/frown");
    InputDriver driver = p.driver();
    CHECK(driver.take(valueOf("face", "joy", {0.9})));
    CHECK(!lastOf(driver, LiveInput::Kind::Morph));
    p.map("x", "handle/tip/x", {{"solo", true}});
    InputDriver solo = p.driver();
    CHECK(solo.take(valueOf("face", "sad", {0.9})));
    CHECK(solo.take(valueOf("osc", "/imomushi/morph/man/smile", {0.9})));
    CHECK(solo.take(valueOf("face", "x", {0.5})));
    CHECK(lastOf(solo, LiveInput::Kind::Handle));
    CHECK(!lastOf(solo, LiveInput::Kind::Morph));
}

TEST_CASE("driver: what is taken hold of glides from where it is held, and lets go to rest") {
    Puppet p;
    p.map("x", "handle/tip/x");
    InputDriver driver = p.driver();
    CHECK(driver.take(valueOf("face", "x", {1.0})));
    const auto first = driver.step(kStep);
    REQUIRE(first.size() == 1);
    const Vec3 rest = p.session.document().elementNamed("B")->faces.back().frame.origin;
    const Vec3 at = rest + Vec3(-0.5, 0.25, 0.0);
    LiveInput held = first[0];
    held.target = at;
    driver.hold(held);
    double before = at.x();
    for (int i = 0; i < 30; ++i)
        for (const LiveInput& input : driver.step(kStep)) {
            CHECK(input.target.x() >= before);
            CHECK(input.target.x() - before <= 1.5 * 1.5 * kStep / InputMapper::kHandover + 1e-12);  // the steepest of the glide, 1.5 m long
            CHECK(input.target.y() == at.y());
            before = input.target.x();
        }
    CHECK(before == doctest::Approx(rest.x() + 1.0));
    driver.letGo();
    CHECK(lastOf(driver, LiveInput::Kind::Handle, 120)->target.x() == rest.x());
}

TEST_CASE("driver: bones are turned about their parents by forward kinematics, and twist") {
    Puppet p;
    p.map("a", "bone/a/turn-x");
    p.map("b", "bone/b/turn-x");
    p.map("twist", "bone/b/turn-z");
    InputDriver driver = p.driver();
    const auto ends = [&](std::initializer_list<std::pair<const char*, double>> turns) {
        for (const auto& [channel, turn] : turns) CHECK(driver.take(valueOf("face", channel, {turn})));
        std::map<EndpointRef, LiveInput> last;
        for (int i = 0; i < 30; ++i)
            for (const LiveInput& input : driver.step(kStep)) last.insert_or_assign(input.end, input);
        return last;
    };
    const auto turned = ends({{"a", 0.5}, {"b", 0.25}});
    REQUIRE(turned.size() == 3);  // the start of the chain is held where it is
    const auto start = turned.begin(), a = std::next(start), b = std::next(a);
    CHECK(start->second.target == Vec3(0.0, 0.0, 0.0));
    // Bars of 3 m along z, a from the origin; a turn about x takes z to -y.
    const auto way = [](double angle) { return Vec3(3.0 * Vec3(0.0, -std::sin(angle), std::cos(angle))); };
    CHECK((a->second.target - way(0.5)).norm() < 1e-12);
    CHECK((b->second.target - (way(0.5) + way(0.75))).norm() < 1e-12);
    CHECK(std::abs(b->second.roll) < 1e-12);
    const auto twisted = ends({{"a", 0.0}, {"b", 0.0}, {"twist", 0.75}});
    const LiveInput& end = twisted.at(b->first);
    CHECK((end.target - Vec3(0.0, 0.0, 6.0)).norm() < 1e-12);
    CHECK(end.hasRoll);
    CHECK(end.roll == doctest::Approx(0.75));
    // The character has the angles, to what inverse kinematics leaves.
    for (const auto& [at, input] : turned) p.good({{"do", "drag"}, {"endpoint", at == start->first ? "a/start" : at == a->first ? "a/end" : "b/end"}, {"to", {input.target.x(), input.target.y(), input.target.z()}}, {"roll", input.roll}});
    for (const auto& [path, angle] : {std::pair("a", 0.5), std::pair("b", 0.75)}) {
        const auto bone = p.session.plan().input.skeleton.bones[static_cast<std::size_t>(p.session.plan().boneIndex(p.session.document().boneNamed(path)->id))];
        const auto& points = p.session.shownPose().points;
        const Vec3 direction = (points[static_cast<std::size_t>(bone.end)] - points[static_cast<std::size_t>(bone.start)]).normalized();
        CHECK(std::acos(std::min(1.0, direction.dot(way(angle).normalized()))) < 0.0175);  // a degree
    }
}

TEST_CASE("driver: after everything let go a bone that is turned again takes its end along, though everybody may name the place of that end") {
    Puppet p;
    p.map("b", "bone/b/turn-x");
    InputDriver driver = p.driver();
    const auto end = [&](double turn) {
        CHECK(driver.take(valueOf("face", "b", {turn})));
        std::optional<Vec3> place;
        const int tip = p.session.plan().pointIndex(*p.session.document().endpoint("b/end"));
        for (int i = 0; i < 30; ++i)
            for (const LiveInput& input : driver.step(kStep))
                if (input.kind == LiveInput::Kind::End && p.session.plan().pointIndex(input.end) == tip) place = input.target;
        return place;
    };
    const auto first = end(0.5);
    driver.letGo();
    for (int i = 0; i < 10; ++i) (void)driver.step(kStep);
    const auto again = end(0.5);
    REQUIRE(first);
    REQUIRE(again);
    CHECK((*again - *first).norm() < 1e-12);
}

TEST_CASE("live: weights of morph targets are inputs of steps: the script has them, and makes the same again") {
    Puppet p;
    p.good({{"do", "record"}, {"take", "smiling"}, {"action", "start"}});
    p.good({{"do", "step"}, {"frames", 4}, {"inputs", {{{"frame", 1}, {"character", "man"}, {"morph", "smile"}, {"weight", 0.25}}, {{"frame", 2}, {"character", "man"}, {"morph", "frown"}, {"weight", 1.5}}, {{"frame", 3}, {"character", "man"}, {"morph", "smile"}, {"weight", 0.0}}}}});
    CHECK(p.session.document().morphs.size() == 1);  // what is at rest again has none
    p.good({{"do", "record"}, {"take", "smiling"}, {"action", "stop"}});
    Puppet again;
    bool inputs = false;
    for (const Json& line : p.session.script()) {
        inputs = inputs || line.contains("inputs");
        if (line["do"] == "record" || line["do"] == "step") again.good(line);
    }
    CHECK(inputs);
    CHECK(again.session.document().morphs == p.session.document().morphs);
    CHECK(again.content() == p.content());
    const Json bad = {{"do", "step"}, {"frames", 1}};
    for (const auto& [input, code] : std::vector<std::pair<Json, std::string>>{{{{"frame", 0}, {"character", "man"}, {"morph", "nose"}, {"weight", 1}}, "no-such-target"},
                                                                               {{{"frame", 0}, {"character", "nobody"}, {"morph", "smile"}, {"weight", 1}}, "no-such-character"},
                                                                               {{{"frame", 0}, {"character", "man"}, {"morph", "smile"}, {"weight", 1e7}}, "bad-value"},
                                                                               {{{"frame", 0}, {"character", "man"}, {"morph", "smile"}}, "bad-type"},
                                                                               {{{"frame", 0}, {"character", "man"}, {"morph", "smile"}, {"weight", 1}, {"to", {0, 0, 0}}}, "unknown-key"}}) {
        Json line = bad;
        line["inputs"] = Json::array({input});
        CHECK(p.code(line) == code);
    }
}

TEST_CASE("live: weights that are given while a thread steps are in the document when it is asked, and one at rest is none") {
    Puppet p;
    p.session.perform([] {});
    LiveInput input;
    input.kind = LiveInput::Kind::Morph;
    input.morph = {p.session.document().characterNamed("man")->id, 1};
    const auto give = [&](double weight) {
        input.weight = weight;
        REQUIRE(p.session.give(input));
        const auto start = std::chrono::steady_clock::now();
        while (p.session.moving() && std::chrono::steady_clock::now() - start < std::chrono::seconds(60)) {
            p.session.takeFrame();
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        CHECK(!p.session.moving());
        p.good({{"do", "list"}});  // parks it
    };
    give(0.5);
    CHECK(p.session.document().morphs == std::map<MorphRef, double>{{input.morph, 0.5}});
    CHECK(p.session.character()->morphWeights(0)[1] == 0.5);
    give(0.0);
    CHECK(p.session.document().morphs.empty());
    CHECK(p.session.character()->morphWeights(0)[1] == 0.0);
    input.morph.target = 2;  // which it has not
    give(1.0);
    CHECK(p.session.document().morphs.empty());
}

TEST_CASE("driver: a row that is mirrored moves the other side, too, by names of sides; a row of that side wins, and what has no side stays alone") {
    Puppet p;
    p.good({{"do", "handle"}, {"element", "A"}, {"name", "hand.L"}, {"point", {0.5, 0.0, 1.5}}, {"radius", 0.4}});
    p.good({{"do", "handle"}, {"element", "A"}, {"name", "hand.R"}, {"point", {-0.5, 0.0, 1.5}}, {"radius", 0.4}});
    REQUIRE(p.session.builtCharacter());
    p.map("wave", "handle/hand.L/x", {{"mirror", true}});
    p.map("wave", "handle/hand.L/y", {{"mirror", true}});
    p.map("lift", "handle/hand.R/y");
    p.map("wave", "handle/tip/y", {{"mirror", true}});
    InputDriver driver = p.driver();
    CHECK(driver.take(valueOf("face", "wave", {0.3})));
    std::map<int, Vec3> last;
    const auto run = [&] {
        for (int i = 0; i < 30; ++i)
            for (const LiveInput& input : driver.step(kStep)) last[input.handle] = input.target;
    };
    run();
    const auto indexOf = [&](const char* name) { return p.session.plan().handleIndex(*handleNamed(p.session.document(), name)); };
    const auto restOf = [&](const char* name) { return faceOf(p.session.document(), *handleNamed(p.session.document(), name)).frame.origin; };
    CHECK((last.at(indexOf("hand.L")) - restOf("hand.L") - Vec3(0.3, 0.3, 0.0)).norm() < 1e-12);
    CHECK((last.at(indexOf("hand.R")) - restOf("hand.R") - Vec3(-0.3, 0.3, 0.0)).norm() < 1e-12);
    CHECK(driver.take(valueOf("face", "lift", {-0.1})));
    run();
    CHECK((last.at(indexOf("hand.R")) - restOf("hand.R") - Vec3(-0.3, 0.0, 0.0)).norm() < 1e-12);  // "in" begins at 0
    CHECK(otherSideOfTarget("handle/tip/y").empty());
    CHECK(otherSideOfTarget("bone/arm.L/turn-x") == "bone/arm.R/turn-x");
    CHECK(otherSideOfTarget("morph/man/blinkLeft") == "morph/man/blinkRight");
    CHECK(otherSideOfTarget("effect/gravity/acceleration/y").empty());
    CHECK(mirrorSign(*mappedTarget(p.session.document(), "handle/hand.L/turn-y")) == -1.0);
    CHECK(mirrorSign(*mappedTarget(p.session.document(), "handle/hand.L/turn-x")) == 1.0);
    CHECK(mirrorSign(*mappedTarget(p.session.document(), "bone/b/end/roll")) == -1.0);
}

TEST_CASE("driver: taking and stepping allocate nothing") {
    Puppet p;
    p.map("x", "handle/tip/x");
    p.map("joy", "morph/man/smile");
    InputDriver driver = p.driver();
    const auto x = valueOf("face", "x", {0.7}), joy = valueOf("face", "joy", {0.7}), direct = valueOf("osc", "/imomushi/bone/b/end/position", {1.0, 2.0, 3.0});
    std::size_t moved = 0;
    const auto before = allocations();
    for (int i = 0; i < 60; ++i) {
        driver.take(x), driver.take(joy), driver.take(direct);
        moved += driver.step(kStep).size();
    }
    const auto after = allocations();
    CHECK(moved > 3);
    CHECK(after == before);
}

TEST_CASE("driver: a bone between two that are turned goes along with the upper one and carries the lower one, but its end stays where it is pinned") {
    for (const bool pinned : {false, true}) {
        CAPTURE(pinned);
        Workbench w;
        for (int i = 0; i < 3; ++i) w.good({{"do", "import-element"}, {"path", "bar" + std::to_string(i)}, {"name", std::string(1, static_cast<char>('A' + i))}});
        std::string parent;
        for (int i = 0; i < 3; ++i) {
            const std::string name(1, static_cast<char>('a' + i));
            w.good({{"do", "add-bone"}, {"name", name}, {"element", std::string(1, static_cast<char>('A' + i))}, {"from", parent.empty() ? Json{0.5, 0.5, 0.0} : Json(parent + "/end")}, {"to", {0.5, 0.5, 3.0 * (i + 1)}}});
            parent = name;
        }
        if (pinned) w.good({{"do", "pin"}, {"endpoint", "b/end"}});
        for (const char* bone : {"a", "c"}) w.good({{"do", "map-input"}, {"source", "body"}, {"channel", bone}, {"target", std::string("bone/") + bone + "/turn-x"}, {"in", {-2, 2}}});
        REQUIRE(w.session.builtCharacter());
        InputDriver driver(w.session.document(), w.session.plan(), {});
        const double angle = 0.5;
        CHECK(driver.take(valueOf("body", "a", {angle})));
        std::map<EndpointRef, Vec3> last;
        for (int i = 0; i < 60; ++i)
            for (const LiveInput& input : driver.step(kStep)) last[input.end] = input.target;
        const auto at = [&](const char* end) {
            const int point = w.session.plan().pointIndex(*w.session.document().endpoint(end));
            for (const auto& [of, target] : last)
                if (w.session.plan().pointIndex(of) == point) return std::optional(target);
            return std::optional<Vec3>();
        };
        const Eigen::AngleAxisd turn(angle, Vec3::UnitX());
        const Vec3 root(0.5, 0.5, 0.0);
        REQUIRE(at("a/end"));
        CHECK((*at("a/end") - (root + turn * Vec3(0, 0, 3))).norm() < 1e-9);
        CHECK(at("b/end").has_value() == !pinned);
        if (!pinned) CHECK((*at("b/end") - (root + turn * Vec3(0, 0, 6))).norm() < 1e-9);
        REQUIRE(at("c/end"));
        CHECK((*at("c/end") - (root + turn * Vec3(0, 0, 9))).norm() < 1e-9);
    }
}
