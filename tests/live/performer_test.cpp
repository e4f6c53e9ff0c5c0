// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "core/document/character_input.h"
#include "core/document/take.h"
#include "core/live/live_input.h"
#include "tests/document/workbench.h"
#include "tests/support/folder.h"

using namespace imomushi;
using namespace std::chrono_literals;

namespace {

constexpr double kHertz = 60.0;

/// Two bars whose bones swing when they are pulled.
struct Swinging {
    std::atomic<int> steps{0};
    std::vector<InputTime> made;  ///< when each step was made; for whoever has parked the performer
    Workbench w;                  // last: its steps end first

    explicit Swinging(bool performing = true) {
        w.buildChain();
        w.good({{"do", "pin"}, {"endpoint", "a/start"}});
        w.good({{"do", "precompute"}});
        w.good({{"do", "enable"}, {"effect", "bone-dynamics"}});
        if (performing) perform();
    }
    void perform() {
        made.reserve(100'000);
        w.session.perform([this] {
            if (made.size() < made.capacity()) made.push_back(inputTime());
            ++steps;
        });
    }
    Json end() const { return "b/end"; }
    void pull(const Vec3& to) { w.good({{"do", "drag"}, {"endpoint", end()}, {"to", {to.x(), to.y(), to.z()}}}); }
    Vec3 at() {
        const Json value = w.good({{"do", "measure"}, {"what", "position"}, {"endpoint", end()}})["value"];
        return Vec3(value[0].get<double>(), value[1].get<double>(), value[2].get<double>());
    }
    /// The window looks 200 times a second until all has come to rest. False: not within `most`.
    bool untilAtRest(std::chrono::seconds most = 60s) {
        const auto start = std::chrono::steady_clock::now();
        while (w.session.moving()) {
            if (std::chrono::steady_clock::now() - start > most) return false;
            w.session.takeFrame();
            std::this_thread::sleep_for(5ms);
        }
        return true;
    }
};

/// The script of a session makes the same take, byte for byte.
void checkReplays(Workbench& w, const std::string& take) {
    Workbench again;
    for (const Json& line : w.session.script()) again.good(line);
    const Take& first = *w.session.document().takeNamed(take);
    const Take& second = *again.session.document().takeNamed(take);
    REQUIRE(first.times == second.times);
    std::vector<double> a(first.shapes.width()), b(second.shapes.width());
    REQUIRE(a.size() == b.size());
    REQUIRE(first.times.size() > 3);
    for (std::size_t f = 0; f < first.times.size(); ++f) {
        first.shapes.at(f, a.data());
        second.shapes.at(f, b.data());
        CHECK(a == b);
    }
}

}  // namespace

TEST_CASE("performer: what swings comes to the same rest as by steps that somebody makes, and then no step is made") {
    Swinging alone, stepped(false);
    const Vec3 to = alone.at() + Vec3(0.4, 0.3, 0.0);
    alone.pull(to);
    stepped.pull(to);
    REQUIRE(alone.w.session.moving());
    REQUIRE(alone.untilAtRest());
    const int made = alone.steps;
    CHECK(made > 10);
    while (stepped.w.session.moving()) stepped.w.session.stepFrame(1.0 / kHertz);
    CHECK((alone.at() - stepped.at()).norm() <= 1e-6 * to.norm());
    std::this_thread::sleep_for(300ms);
    CHECK(alone.steps == made);
    // Everything that is asked of it afterwards is as if steps had been made here.
    CHECK((alone.w.session.positionsOf(1) - stepped.w.session.positionsOf(1)).cwiseAbs().maxCoeff() <= 1e-5);
}

TEST_CASE("performer: steps are made in time while the window is blocked, and the recorded take is whole") {
    Swinging s;
    s.w.good({{"do", "record"}, {"take", "blocked"}, {"action", "start"}});
    s.pull(s.at() + Vec3(0.4, 0.3, 0.0));
    const int before = s.steps;
    const auto start = std::chrono::steady_clock::now();
    std::this_thread::sleep_for(2s);
    const double passed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const int made = s.steps - before;
    const double leftOut = s.w.session.performed()->leftOut;
    MESSAGE(made << " steps in " << passed << " s, " << leftOut << " s left out");
    // What a busy machine leaves out is said; all other steps are made.
    CHECK(std::abs(made - kHertz * (passed - leftOut)) <= 2.0);
    const Json taken = s.w.good({{"do", "record"}, {"take", "blocked"}, {"action", "stop"}});
    // While the window sleeps, one step follows the other.
    std::vector<double> spacing;
    for (int i = before + 1; i < before + made; ++i) spacing.push_back(1e-6 * static_cast<double>(s.made[static_cast<std::size_t>(i)] - s.made[static_cast<std::size_t>(i) - 1]));
    std::ranges::sort(spacing);
    MESSAGE("ms from step to step: median " << spacing[spacing.size() / 2] << ", 99 % " << spacing[spacing.size() * 99 / 100] << ", at most " << spacing.back());
    const Take& take = *s.w.session.document().takeNamed("blocked");
    CHECK(static_cast<int>(take.times.size()) >= made);
    for (std::size_t f = 1; f < take.times.size(); ++f)
        CHECK(take.times[f] - take.times[f - 1] == doctest::Approx(1.0 / kHertz).epsilon(1e-9));
}

TEST_CASE("performer: a project may choose 120 or 240 steps per second, also while it is performed") {
    for (const int rate : CharacterSettings::kRates) {
        CAPTURE(rate);
        Swinging s;
        s.pull(s.at() + Vec3(0.2, 0.1, 0.0));
        s.w.good({{"do", "set"}, {"target", "character"}, {"property", "rate"}, {"value", rate}});
        s.w.good({{"do", "record"}, {"take", "fast"}, {"action", "start"}});
        s.pull(s.at() + Vec3(0.2, 0.2, 0.0));
        const int before = s.steps;
        const double leftBefore = s.w.session.performed() ? s.w.session.performed()->leftOut : 0.0;
        const auto start = std::chrono::steady_clock::now();
        std::this_thread::sleep_for(500ms);
        const double passed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        const int made = s.steps - before;
        REQUIRE(s.w.session.performed());
        const double leftOut = s.w.session.performed()->leftOut - leftBefore;
        CHECK(std::abs(made - rate * (passed - leftOut)) <= 4.0);
        s.w.good({{"do", "record"}, {"take", "fast"}, {"action", "stop"}});
        const Take& take = *s.w.session.document().takeNamed("fast");
        REQUIRE(take.times.size() > 10);
        for (std::size_t f = 1; f < take.times.size(); ++f) CHECK(take.times[f] - take.times[f - 1] == doctest::Approx(1.0 / rate).epsilon(1e-9));
    }
}

TEST_CASE("performance: one of 200 elements that swing is edited: no other moves, and what swings goes on as if nothing had happened") {
    using Places = std::map<PartId, Points>;
    std::set<PartId> edited;
    double usual = 0.0;  // m, how far a step goes
    const auto farthest = [&](const Places& a, const Places& b) {
        double far = 0.0;
        for (const auto& [id, p] : a)
            if (!edited.contains(id)) far = std::max(far, (p - b.at(id)).rowwise().norm().maxCoeff());
        return far;
    };
    // Where everything is after the edit, and after each of ten steps.
    const auto swung = [&](bool edit) {
        Swinging s(false);
        Workbench& w = s.w;
        const Document& document = w.session.document();
        while (document.elements.size() < 200) {
            Json names = Json::array();
            for (const auto& [id, element] : document.elements)
                if (names.size() < 200 - document.elements.size()) names.push_back(element->name);
            w.good({{"do", "duplicate"}, {"names", names}, {"offset", {3.0 * static_cast<double>(document.elements.size()), 0.0, 0.0}}});
        }
        REQUIRE(document.elements.size() == 200);
        std::size_t chain = 0;
        for (const auto& [id, bone] : document.bones) {
            if (chain++ % 10 != 1) continue;  // the second bone of every fifth chain
            const std::string end = bone->name + "/end";
            const Json at = w.good({{"do", "measure"}, {"what", "position"}, {"endpoint", end}})["value"];
            w.good({{"do", "drag"}, {"endpoint", end}, {"to", {at[0].get<double>() + 0.5, at[1].get<double>() + 0.4, at[2].get<double>()}}});
        }
        const auto places = [&] {
            Places all;
            for (const auto& [id, element] : document.elements) all[id] = w.session.positionsOf(id);
            return all;
        };
        for (int i = 0; i < 8; ++i) w.session.stepFrame(1.0 / kHertz);
        const Places before = places();
        w.session.stepFrame(1.0 / kHertz);
        std::vector<Places> out{places()};
        usual = farthest(before, out[0]);
        const Element& last = *document.elements.rbegin()->second;
        // Its flesh is another one, and what it is joined with shares a face with it.
        edited = {last.id};
        for (const auto& [id, joint] : document.joints)
            if (std::ranges::any_of(joint->faces, [&](const FaceRef& face) { return face.element == last.id; }))
                for (const FaceRef& face : joint->faces) edited.insert(face.element);
        if (edit) {
            w.good({{"do", "set"}, {"target", std::string(last.name)}, {"property", "nu"}, {"value", 0.3}});
            CHECK(farthest(out[0], places()) == 0.0);
        }
        for (int i = 0; i < 10; ++i) {
            w.session.stepFrame(1.0 / kHertz);
            out.push_back(places());
        }
        return out;
    };
    const auto alone = swung(false), beside = swung(true);
    REQUIRE(edited.size() == 2);
    REQUIRE(usual > 1e-3);
    for (std::size_t i = 0; i < alone.size(); ++i) CHECK(farthest(alone[i], beside[i]) < 1e-3 * usual);
}

namespace {

/// Where the end of a chain that was let go is after commands, and after each of ten steps that follow. `effect`: one that waits until it is called for; may be empty.
std::vector<Vec3> swung(const std::vector<Json>& commands, const std::string& effect = {}) {
    Swinging s(false);
    if (!effect.empty()) s.w.good({{"do", "enable"}, {"effect", effect}, {"auto", true}});
    s.pull(s.at() + Vec3(0.5, 0.4, 0.0));
    for (int i = 0; i < 8; ++i) s.w.session.stepFrame(1.0 / kHertz);
    s.w.good({{"do", "release"}, {"endpoint", s.end()}});
    for (int i = 0; i < 8; ++i) s.w.session.stepFrame(1.0 / kHertz);
    for (const Json& command : commands) s.w.good(command);
    std::vector<Vec3> out{s.at()};
    for (int i = 0; i < 10; ++i) {
        s.w.session.stepFrame(1.0 / kHertz);
        out.push_back(s.at());
    }
    return out;
}

}  // namespace

TEST_CASE("performance: what swings goes on when a name, a material or an effect is undone and redone; undoing a drag brings the pose from before") {
    const Json undo{{"do", "undo"}}, redo{{"do", "redo"}};
    const auto alone = swung({});
    REQUIRE((alone[1] - alone[0]).norm() > 1e-3);
    for (const Json& edit : {Json{{"do", "rename"}, {"target", "B"}, {"name", "tail"}}, Json{{"do", "set"}, {"target", "B"}, {"property", "nu"}, {"value", 0.3}}, Json{{"do", "enable"}, {"effect", "bend-warp"}}}) {
        CAPTURE(edit.dump());
        const auto edited = swung({edit, undo, redo, undo});
        for (std::size_t i = 0; i < alone.size(); ++i) CHECK((alone[i] - edited[i]).norm() < 1e-6);
    }
    // What lets go is undone: the end is held again, where it was then.
    CHECK((swung({undo}).front() - alone.front()).norm() > 0.01);
}

TEST_CASE("performance: bones are added, moved, limited and removed while others swing: these go on from where they are, as fast as they were") {
    const auto alone = swung({});
    const double usual = (alone[1] - alone[0]).norm();
    REQUIRE(usual > 1e-3);
    const Json beside{{"do", "add-bone"}, {"name", "beside"}, {"from", {9, 0, 0}}, {"to", {10, 0, 0}}}, longer{{"do", "add-bone"}, {"name", "tip"}, {"from", "b/end"}, {"to", {0, 0, 7}}};
    const std::vector<std::pair<const char*, std::vector<Json>>> edits{
        {"a bone beside them", {beside}},
        {"one that is moved", {beside, {{"do", "edit-bone"}, {"name", "beside"}, {"to", {11, 0, 0}}}}},
        {"one that is removed again", {beside, {{"do", "remove-bone"}, {"name", "beside"}}}},
        {"a limit", {{{"do", "set"}, {"target", "a"}, {"property", "max-bend"}, {"value", 3.0}}}},
    };
    for (const auto& [name, commands] : edits) {
        CAPTURE(name);
        const auto edited = swung(commands);
        CHECK((edited[0] - alone[0]).norm() < 1e-6);
        for (std::size_t i = 1; i < alone.size(); ++i) CHECK((edited[i] - alone[i]).norm() < 0.02 * usual);
    }
    // One that hangs on the end makes it heavier, but does not stop it; also while contact waits for flesh that meets, where what swings is kept in another way.
    for (const std::string effect : {"", "contact"}) {
        CAPTURE(effect);
        const auto lighter = swung({}, effect), heavier = swung({longer}, effect);
        CHECK((heavier[0] - lighter[0]).norm() < 1e-6);
        CHECK((heavier[1] - lighter[1]).norm() < 0.5 * usual);
        CHECK((heavier[1] - heavier[0]).dot(lighter[1] - lighter[0]) > 0.5 * usual * usual);
    }
}

TEST_CASE("performance: a project that is opened is at rest, also where its bones are numbered as those that swung before") {
    const TestFolder folder;
    Swinging s(false);
    const Vec3 rest = s.at();
    s.w.good({{"do", "save"}, {"path", folder.file("rest.imomushi")}});
    s.pull(rest + Vec3(0.5, 0.4, 0.0));
    for (int i = 0; i < 8; ++i) s.w.session.stepFrame(1.0 / kHertz);
    REQUIRE((s.at() - rest).norm() > 0.01);
    s.w.good({{"do", "open"}, {"path", folder.file("rest.imomushi")}});
    CHECK((s.at() - rest).norm() < 1e-9);
    for (int i = 0; i < 8; ++i) s.w.session.stepFrame(1.0 / kHertz);
    CHECK((s.at() - rest).norm() < 1e-6);
}

TEST_CASE("performance: flesh that the ground has lifted stays where it is when an element far from it is edited") {
    Workbench w;
    w.good({{"do", "open"}, {"path", IMOMUSHI_SAMPLES "/figure.imomushi"}});
    for (const char* effect : {"ground", "bone-dynamics"}) w.good({{"do", "enable"}, {"effect", effect}});
    w.good({{"do", "drag"}, {"endpoint", "hand-bone.L/end"}, {"to", {0.5, -0.1, 0.5}}, {"seconds", 0.3}});
    w.good({{"do", "step"}, {"dt", 1.0 / kHertz}, {"frames", 30}});
    const Document& document = w.session.document();
    std::map<std::string, Points> before;
    for (const auto& [id, element] : document.elements) before[element->name] = w.session.positionsOf(id);
    w.good({{"do", "set"}, {"target", "hand.R"}, {"property", "nu"}, {"value", 0.3}});
    for (const auto& [id, element] : document.elements) {
        if (element->name == "hand.R" || element->name == "lower-arm.R") continue;  // edited, and joined with it
        CAPTURE(element->name);
        // Less than a thousandth of a millimetre, by loads that are followed anew; feet sank by 8 mm.
        CHECK((w.session.positionsOf(id) - before.at(element->name)).rowwise().norm().maxCoeff() < 1e-6);
    }
}

TEST_CASE("performer: answers between two frames that were taken are of one frame") {
    Swinging s;
    s.pull(s.at() + Vec3(0.4, 0.3, 0.0));
    int looks = 0;
    for (; looks < 50 && s.w.session.moving(); ++looks) {
        s.w.session.takeFrame();
        const Vec3 end = s.w.session.shownPose().points.back();
        const auto vertices = s.w.session.character()->surface(0);
        const std::vector<float> first(vertices.positions, vertices.positions + 3 * vertices.vertices);
        std::this_thread::sleep_for(20ms);  // steps go on
        CHECK(s.w.session.shownPose().points.back() == end);
        const auto again = s.w.session.character()->surface(0);
        CHECK(std::equal(first.begin(), first.end(), again.positions));
    }
    CHECK(looks > 3);
}

TEST_CASE("performer: commands, undo and gestures find the document as it is performed, and leave it whole") {
    Swinging s;
    const Vec3 rest = s.at();
    s.w.session.beginGesture();
    for (int i = 1; i <= 20; ++i) {
        s.pull(rest + 0.02 * i * Vec3(1.0, 0.5, 0.0));
        std::this_thread::sleep_for(16ms);
        s.w.session.takeFrame();
    }
    s.w.session.endGesture();
    CHECK(s.steps > 5);
    CHECK(s.w.session.steps().back().name == "drag");
    const Vec3 pulled = s.at();
    CHECK((pulled - rest).norm() > 0.05);
    s.w.good({{"do", "undo"}});
    REQUIRE(s.untilAtRest());
    CHECK((s.at() - rest).norm() <= 1e-6);
    s.w.good({{"do", "redo"}});
    CHECK(s.w.session.document().goals.size() == 2);
}

TEST_CASE("performer: what is recorded alone is replayed to the same bytes by the script that it left") {
    Swinging s;
    s.w.good({{"do", "record"}, {"take", "one"}, {"action", "start"}});
    const Vec3 rest = s.at();
    for (int i = 1; i <= 10; ++i) {
        s.pull(rest + 0.04 * i * Vec3(1.0, 0.5, 0.0));
        std::this_thread::sleep_for(20ms);
    }
    s.w.good({{"do", "record"}, {"take", "one"}, {"action", "stop"}});
    checkReplays(s.w, "one");
}

TEST_CASE("performer: a target that is given moves what is held with the next steps, wakes what rests, and waits for nobody") {
    Swinging s;
    const Vec3 rest = s.at();
    s.pull(rest + Vec3(0.05, 0.0, 0.0));
    REQUIRE(s.untilAtRest());
    const std::size_t steps = s.w.session.steps().size();
    LiveInput input;
    input.end = *s.w.session.document().endpoint("b/end");
    input.target = rest + Vec3(0.4, 0.3, 0.0);
    CHECK(s.w.session.give(input));
    CHECK(s.w.session.moving());
    // Who looks at the document while it moves sees what was given, as far as steps have taken it.
    const auto start = std::chrono::steady_clock::now();
    while (s.w.session.document().goals.at(input.end).target != input.target && std::chrono::steady_clock::now() - start < 60s) {
        std::this_thread::sleep_for(5ms);
        s.w.session.takeFrame();
    }
    CHECK(s.w.session.document().goals.at(input.end).target == input.target);
    CHECK(s.w.session.moving());
    REQUIRE(s.untilAtRest());
    CHECK((s.w.session.document().goals.at(input.end).target - input.target).norm() == 0.0);
    CHECK((s.at() - rest).norm() > 0.2);
    CHECK(s.w.session.steps().size() == steps);  // no step of the history
    // Whoever let go is not taken hold of again.
    s.w.good({{"do", "release"}});
    CHECK(s.w.session.give(input));
    REQUIRE(s.untilAtRest());
    CHECK(!s.w.session.document().goals.contains(input.end));
}

TEST_CASE("performer: who looks at a drag sees in the document where it is, and waits for no step") {
    std::atomic<bool> holding{false}, left{false}, waited{false};
    Swinging s(false);
    s.w.session.perform([&] {  // a step that does not end until somebody has looked
        const auto start = std::chrono::steady_clock::now();
        while (holding && !left && !waited) {
            std::this_thread::sleep_for(1ms);
            waited = std::chrono::steady_clock::now() - start > 10s;
        }
        ++s.steps;
    });
    const Vec3 rest = s.at();
    s.pull(rest + Vec3(0.05, 0.0, 0.0));
    LiveInput input;
    input.end = *s.w.session.document().endpoint("b/end");
    input.target = rest + Vec3(0.4, 0.3, 0.0);
    holding = true;
    REQUIRE(s.w.session.give(input));
    const auto target = [&] { return s.w.session.document().goals.at(input.end).target; };
    const auto start = std::chrono::steady_clock::now();
    int looks = 0;
    for (int seen = s.steps; target() != input.target && std::chrono::steady_clock::now() - start < 60s;) {
        std::this_thread::sleep_for(5ms);
        if (s.w.session.takeFrame()) ++looks;
        if (s.steps == seen && target() != input.target) {  // the step before took the input not yet
            left = true;
            while (s.steps == seen) std::this_thread::sleep_for(1ms);
            seen = s.steps;
            left = false;
        }
    }
    CHECK(target() == input.target);
    CHECK(looks > 0);
    CHECK(!waited);
    CHECK(s.w.session.document().pose.points.size() == s.w.session.plan().input.skeleton.points.size());
    left = true;
    holding = false;
    REQUIRE(s.untilAtRest());
}

TEST_CASE("performer: a frame says when the first input came that no frame before it follows, and what its step took") {
    Swinging s;
    s.pull(s.at() + Vec3(0.05, 0.0, 0.0));
    REQUIRE(s.untilAtRest());
    LiveInput input;
    input.end = *s.w.session.document().endpoint("b/end");
    input.target = s.at() + Vec3(0.2, 0.1, 0.0);
    for (int i = 0; i < 3; ++i) {
        REQUIRE(s.untilAtRest());
        const InputTime known = s.w.session.performed()->input, before = inputTime();
        REQUIRE(s.w.session.give(input));
        const InputTime given = inputTime();
        REQUIRE(s.w.session.give(input));  // a later one says nothing new
        while (!s.w.session.takeFrame() || s.w.session.performed()->input <= known) {
            REQUIRE(inputTime() - before < 60'000'000'000);
            std::this_thread::sleep_for(1ms);
        }
        CHECK(s.w.session.performed()->input >= before);
        CHECK(s.w.session.performed()->input <= given);
        CHECK(s.w.session.performed()->milliseconds > 0.0);
    }
    REQUIRE(s.untilAtRest());
}

TEST_CASE("performer: a handle on flesh that rests goes where a target says") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "handle"}, {"element", "B"}, {"name", "tip"}, {"point", {0.5, 0.0, 4.5}}, {"radius", 0.4}});
    w.good({{"do", "precompute"}});
    w.session.perform([] {});
    const FaceRef tip = *w.session.document().handle("tip");
    const Vec3 rest = w.session.poseOf(tip)->at;
    w.good({{"do", "drag"}, {"endpoint", "tip"}, {"to", {rest.x(), rest.y(), rest.z()}}});
    LiveInput input;
    input.kind = LiveInput::Kind::Handle;
    input.handle = w.session.plan().handleIndex(tip);
    for (const double far : {0.1, 0.2}) {
        input.target = rest + Vec3(far, 0.0, 0.0);
        REQUIRE(w.session.give(input));
        const auto start = std::chrono::steady_clock::now();
        while ((w.session.poseOf(tip)->at - input.target).norm() > 1e-9 && std::chrono::steady_clock::now() - start < 60s) {
            w.session.takeFrame();
            std::this_thread::sleep_for(5ms);
        }
        CHECK((w.session.poseOf(tip)->at - input.target).norm() <= 1e-9);
    }
}

TEST_CASE("performer: targets that were given while a take was recorded are in the script, and replay it to the same bytes") {
    Swinging s;
    const Vec3 rest = s.at();
    s.pull(rest + Vec3(0.05, 0.0, 0.0));
    s.w.good({{"do", "record"}, {"take", "given"}, {"action", "start"}});
    LiveInput input;
    input.end = *s.w.session.document().endpoint("b/end");
    for (int i = 1; i <= 40; ++i) {  // more often than steps are made
        input.target = rest + 0.01 * i * Vec3(1.0, 0.5, 0.0);
        CHECK(s.w.session.give(input));
        std::this_thread::sleep_for(7ms);
    }
    s.w.good({{"do", "record"}, {"take", "given"}, {"action", "stop"}});
    const auto script = s.w.session.script();
    int inputs = 0;
    for (const Json& line : script)
        if (line.contains("inputs")) {
            int last = -1;
            for (const Json& one : line["inputs"]) {
                CHECK(one["frame"].get<int>() > last);  // one of each target and step
                last = one["frame"].get<int>();
                ++inputs;
            }
        }
    CHECK(inputs > 5);
    CHECK(inputs < 40);
    checkReplays(s.w, "given");
}
