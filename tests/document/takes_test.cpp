// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>

#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

/// Positions and normals of all elements as they are seen, in bytes.
std::string seen(Session& session) {
    std::string bytes;
    const Character& character = *session.character();
    for (std::size_t e = 0; e < character.input().elements.size(); ++e) {
        const auto surface = character.surface(static_cast<int>(e));
        for (const float* numbers : {surface.positions, surface.normals})
            bytes.append(reinterpret_cast<const char*>(numbers), sizeof(float) * 3 * static_cast<std::size_t>(surface.vertices));
    }
    return bytes;
}

Points positions(Session& session, int element) { return session.character()->positions(element); }

Json play(Workbench& w, double time) { return w.good({{"do", "play"}, {"take", "踊り"}, {"time", time}}); }

/// Records 20 frames of a drag and a release, and what was seen in each.
std::vector<std::string> recordDance(Workbench& w) {
    std::vector<std::string> frames;
    w.good({{"do", "record"}, {"take", "踊り"}, {"action", "start"}});
    const auto step = [&](int count) {
        for (; count > 0; --count) {
            w.good({{"do", "step"}, {"frames", 1}, {"dt", 0.025}});
            frames.push_back(seen(w.session));
        }
    };
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.2, 0.4, 5.2}}, {"roll", 0.4}, {"seconds", 0.2}});
    step(10);
    w.good({{"do", "release"}});
    step(10);
    w.good({{"do", "record"}, {"take", "踊り"}, {"action", "stop"}});
    return frames;
}

void enable(Workbench& w, std::initializer_list<const char*> effects) {
    for (const char* effect : effects) w.good({{"do", "enable"}, {"effect", effect}});
    w.good({{"do", "precompute"}});
}

}  // namespace

TEST_CASE("takes: one that ends in the middle of a drag is a step of its own, which undoing the drag leaves alone") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    const int before = w.session.position();
    const auto drag = [&](double x) { w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {x, 0.1, 5.5}}}); };
    w.good({{"do", "record"}, {"take", "舞"}, {"action", "start"}});
    w.session.beginGesture();
    drag(0.1);
    w.good({{"do", "step"}, {"frames", 3}});
    w.good({{"do", "record"}, {"take", "舞"}, {"action", "stop"}});
    drag(0.4);
    drag(0.5);
    w.session.endGesture();
    CHECK(w.session.position() == before + 3);
    const Document whole = w.session.document();
    w.good({{"do", "undo"}});
    CHECK(w.session.document().takeNamed("舞"));
    CHECK(w.session.document().goals.size() == 1);  // as when the take ended
    w.good({{"do", "undo"}});
    CHECK_FALSE(w.session.document().takeNamed("舞"));
    CHECK(w.session.document().goals.size() == 1);
    w.good({{"do", "undo"}});
    CHECK(w.session.document().goals.empty());
    w.good({{"do", "redo"}, {"count", 3}});
    CHECK(w.session.document().takes == whole.takes);
    CHECK(w.session.document().goals == whole.goals);
    // A drag that is given up after that takes back what it did since.
    w.good({{"do", "record"}, {"take", "二"}, {"action", "start"}});
    w.session.beginGesture();
    drag(0.2);
    w.good({{"do", "step"}, {"frames", 3}});
    w.good({{"do", "record"}, {"take", "二"}, {"action", "stop"}});
    const auto goals = w.session.document().goals;
    drag(0.3);
    w.session.cancelGesture();
    CHECK(w.session.document().takeNamed("二"));
    CHECK(w.session.document().goals == goals);
}

TEST_CASE("takes: steps that are too short for a time of their own make no frame, and add up; the project opens again") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    w.good({{"do", "record"}, {"take", "短"}, {"action", "start"}});
    w.good({{"do", "step"}, {"frames", 1}, {"dt", 1.0}});
    for (int i = 0; i < 3; ++i) w.good({{"do", "step"}, {"frames", 1}, {"dt", 1e-16}});
    w.good({{"do", "step"}, {"frames", 1}, {"dt", 0.5}});
    w.good({{"do", "record"}, {"take", "短"}, {"action", "stop"}});
    const std::vector<double> times = w.session.document().takeNamed("短")->times;
    REQUIRE(times.size() == 4);  // 0, 1, the next number after 1 (2.2e-16), 1.5
    for (std::size_t i = 1; i < times.size(); ++i) CHECK(times[i] > times[i - 1]);
    const TestFolder folder;
    w.good({{"do", "save"}, {"path", (folder.path() / "a.imomushi").string()}});
    w.good({{"do", "open"}, {"path", (folder.path() / "a.imomushi").string()}});
    CHECK(w.session.document().takeNamed("短")->times == times);
}

TEST_CASE("takes: what was seen is what a take plays, byte for byte, in any order, with any effects") {
    const std::vector<std::vector<const char*>> scenes = {{},
                                                          {"bone-dynamics", "joint-dynamics", "gravity", "inflate"},
                                                          {"smooth-joints", "bone-dynamics"},
                                                          {"bend-warp", "joint-dynamics", "gravity", "touch"},
                                                          {"bend-warp", "bone-dynamics", "touch"}};
    for (const auto& scene : scenes) {
        CAPTURE(scene.size());
        Workbench w;
        w.buildChain();
        if (scene.size() == 2) w.good({{"do", "set"}, {"target", "character"}, {"property", "basis"}, {"value", "modes:6"}});
        for (const char* effect : scene) w.good({{"do", "enable"}, {"effect", effect}});
        if (scene.size() == 3) w.good({{"do", "set"}, {"target", "touch"}, {"property", "tip"}, {"value", 0.1}});
        w.good({{"do", "precompute"}});
        if (!scene.empty() && std::string(scene.back()) == "touch")
            w.good({{"do", "touch"}, {"element", "A"}, {"point", {0.5, 0, 1.5}}, {"to", {0.35, 0, 1.5}}});
        const auto frames = recordDance(w);
        // To and fro, from a pose far away.
        w.good({{"do", "drag"}, {"endpoint", "a/start"}, {"to", {0.3, 0.6, -1}}});
        w.good({{"do", "step"}, {"frames", 3}});
        int different = 0;
        for (const std::size_t i : {19, 4, 0, 1, 2, 12, 11, 12}) {
            const Json answer = play(w, w.session.document().takeNamed("踊り")->times[i + 1]);
            CHECK(answer["exact"] == true);
            different += seen(w.session) != frames[i];
        }
        CHECK(different == 0);
        w.good({{"do", "play"}, {"take", "踊り"}});
        CHECK(seen(w.session) == frames.back());
    }
}

TEST_CASE("takes: the dynamics of the previous model are recorded too") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "set"}, {"target", "character"}, {"property", "basis"}, {"value", "full"}});
    enable(w, {"previous-model"});
    const auto frames = recordDance(w);
    CHECK(play(w, 0.25)["exact"] == true);
    CHECK(seen(w.session) == frames[9]);
    CHECK(play(w, 0.5)["exact"] == true);
    CHECK(seen(w.session) == frames[19]);
}

TEST_CASE("takes: they begin with what was shown, and times between frames move evenly") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    const std::string before = seen(w.session);
    recordDance(w);
    const Take& take = *w.session.document().takeNamed("踊り");
    REQUIRE(take.times.size() == 21);
    CHECK(take.duration() == doctest::Approx(0.5));
    play(w, 0.0);
    CHECK(seen(w.session) == before);
    CHECK(w.session.showsTake());
    CHECK(!w.session.moving());
    play(w, take.times[3]);
    const Points from = positions(w.session, 1);
    play(w, take.times[4]);
    const Points to = positions(w.session, 1);
    play(w, 0.5 * (take.times[3] + take.times[4]));
    const Points middle = positions(w.session, 1);
    // A chord and its arc differ by an eighth of the square of the angle, which one frame keeps below a fifth.
    CHECK((middle - 0.5 * (from + to)).rowwise().norm().maxCoeff() < 0.04 / 8.0 * 7.0);
    CHECK((middle - from).rowwise().norm().maxCoeff() > 0.3 * (to - from).rowwise().norm().maxCoeff());
}

TEST_CASE("takes: a take is looked at, and the pose of the document stays") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    recordDance(w);
    w.good({{"do", "rest"}});
    const Json place{{"do", "measure"}, {"what", "position"}, {"endpoint", "b/end"}};
    const Json rest = w.good(place);
    const std::string before = seen(w.session);
    play(w, 0.25);
    CHECK(w.good(place) != rest);
    CHECK(w.session.document().pose.points.empty());
    w.good({{"do", "step"}, {"frames", 1}});
    CHECK(!w.session.showsTake());
    CHECK(w.good(place) == rest);
    CHECK(seen(w.session) == before);
    play(w, 0.25);
    w.good({{"do", "rename-take"}, {"take", "踊り"}, {"name", "b"}});
    CHECK(w.session.showsTake());
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    CHECK(!w.session.showsTake());
    CHECK(seen(w.session) == before);
}

TEST_CASE("takes: recording, renaming and removing are single steps of the history") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    recordDance(w);
    const std::string recorded = w.content();
    const int steps = w.session.position();
    CHECK(w.session.steps().back().name == "record");
    CHECK(w.session.modified());
    w.good({{"do", "rename-take"}, {"take", "踊り"}, {"name", "A"}});  // an element is called so too
    w.good({{"do", "remove-take"}, {"take", "A"}});
    CHECK(w.session.document().takes.empty());
    CHECK(w.session.position() == steps + 2);
    w.good({{"do", "undo"}, {"count", 2}});
    CHECK(w.content() == recorded);
    w.good({{"do", "undo"}});
    CHECK(w.session.document().takes.empty());
    w.good({{"do", "redo"}});
    CHECK(w.content() == recorded);
    CHECK(play(w, 0.1)["exact"] == true);
}

TEST_CASE("takes: one whose name another take gets while it is recorded has a number, and the project is saved") {
    Workbench w;
    w.buildChain();
    for (const char* action : {"start", "stop"}) w.good({{"do", "record"}, {"take", "first"}, {"action", action}});
    w.good({{"do", "record"}, {"take", "second"}, {"action", "start"}});
    w.good({{"do", "step"}, {"frames", 2}});
    w.good({{"do", "rename-take"}, {"take", "first"}, {"name", "second"}});
    const Json answer = w.good({{"do", "record"}, {"take", "second"}, {"action", "stop"}});
    CHECK(answer["take"] == "second 2");
    CHECK(answer["warnings"].size() == 1);
    w.good({{"do", "save"}, {"path", (Workbench::folder() / "names.imomushi").string()}});
}

TEST_CASE("takes: trimming keeps what was seen between two times, from 0 on, and is a single step") {
    Workbench w;
    w.buildChain();
    enable(w, {"bone-dynamics", "gravity"});
    const auto frames = recordDance(w);
    const std::string recorded = w.content();
    const auto take = [&]() -> const Take& { return *w.session.document().takeNamed("踊り"); };
    const std::vector<double> times = take().times;
    // A little off, as a hand is; both frames stay.
    const Json answer = w.good({{"do", "trim-take"}, {"take", "踊り"}, {"from", times[5] + 1e-9}, {"to", times[15] - 1e-9}});
    CHECK(answer["frames"] == 11);
    CHECK(take().times.front() == 0.0);
    CHECK(take().duration() == doctest::Approx(0.25));
    for (const std::size_t i : {0, 10, 4}) {
        CHECK(play(w, take().times[i])["exact"] == true);
        CHECK(seen(w.session) == frames[i + 4]);
    }
    // The drag was told before, the release is told later.
    REQUIRE(take().targets.size() == 2);
    CHECK(take().targets[0].held);
    CHECK(take().targets[0].time == 0.0);
    CHECK(take().targets[1].time == doctest::Approx(0.275 - 0.125));
    const auto path = (Workbench::folder() / "trimmed.imomushi").string();
    w.good({{"do", "save"}, {"path", path}});
    const std::string content = w.content();
    Workbench other;
    other.good({{"do", "open"}, {"path", path}});
    CHECK(other.content() == content);
    w.good({{"do", "undo"}});
    CHECK(w.content() == recorded);
    CHECK(play(w, times[19])["exact"] == true);
    CHECK(seen(w.session) == frames[18]);

    w.good({{"do", "trim-take"}, {"take", "踊り"}, {"from", 0.3}});
    CHECK(take().targets.empty());  // what was let go before is not held
    w.good({{"do", "trim-take"}, {"take", "踊り"}, {"from", 5}});
    CHECK(take().times.size() == 1);  // times after the end are the end
    w.good({{"do", "undo"}, {"count", 2}});
    CHECK(w.code({{"do", "trim-take"}, {"take", "踊り"}, {"from", 0.4}, {"to", 0.3}}) == "bad-value");
    CHECK(w.code({{"do", "trim-take"}, {"take", "踊り"}, {"from", 0.031}, {"to", 0.039}}) == "bad-value");
    CHECK(w.code({{"do", "trim-take"}, {"take", "踊り"}, {"to", -1}}) == "bad-value");
    CHECK(w.code({{"do", "trim-take"}, {"take", "x"}}) == "no-such-take");
    CHECK(w.content() == recorded);
}

TEST_CASE("takes: a copy plays the same and has a life of its own") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    const auto frames = recordDance(w);
    const std::string recorded = w.content();
    CHECK(w.good({{"do", "duplicate-take"}, {"take", "踊り"}, {"name", "b"}})["frames"] == 21);
    w.good({{"do", "trim-take"}, {"take", "踊り"}, {"to", 0.1}});
    w.good({{"do", "remove-take"}, {"take", "踊り"}});
    w.good({{"do", "play"}, {"take", "b"}, {"time", w.session.document().takeNamed("b")->times[13]}});
    CHECK(seen(w.session) == frames[12]);
    CHECK(w.code({{"do", "duplicate-take"}, {"take", "b"}, {"name", "b"}}) == "name-taken");
    CHECK(w.code({{"do", "duplicate-take"}, {"take", "c"}, {"name", "d"}}) == "no-such-take");
    w.good({{"do", "undo"}, {"count", 3}});
    CHECK(w.content() == recorded);
}

TEST_CASE("takes: they are saved with the project and play the same after opening it") {
    Workbench w;
    w.buildChain();
    enable(w, {"bone-dynamics", "bend-warp"});
    const auto frames = recordDance(w);
    const auto path = (Workbench::folder() / "takes.imomushi").string();
    w.good({{"do", "save"}, {"path", path}});
    const std::string content = w.content();
    Workbench other;
    CHECK(other.good({{"do", "open"}, {"path", path}})["takes"] == Json::array({"踊り"}));
    CHECK(other.content() == content);
    CHECK(play(other, other.session.document().takeNamed("踊り")->times[13])["exact"] == true);
    CHECK(seen(other.session) == frames[12]);
    CHECK(other.session.document().takeNamed("踊り")->targets.size() == w.session.document().takeNamed("踊り")->targets.size());
}

TEST_CASE("takes: what endpoints were told is kept") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    recordDance(w);
    const auto& targets = w.session.document().takeNamed("踊り")->targets;
    REQUIRE(targets.size() == 2);
    CHECK(targets[0].held);
    CHECK(targets[0].time == doctest::Approx(0.025));
    CHECK(targets[0].to == Vec3(1.2, 0.4, 5.2));
    CHECK(targets[0].roll == 0.4);
    CHECK(!targets[1].held);
    CHECK(targets[1].time == doctest::Approx(0.275));
}

TEST_CASE("takes: on another character a take shows its poses, and says so") {
    Workbench w;
    w.buildChain();
    enable(w, {"bone-dynamics"});
    recordDance(w);
    play(w, 0.25);
    const Pose shown = w.session.shownPose();
    w.good({{"do", "set"}, {"target", "character"}, {"property", "basis"}, {"value", "paper"}});
    w.good({{"do", "import-element"}, {"path", "bar4"}, {"name", "C"}});
    w.good({{"do", "add-bone"}, {"name", "c"}, {"from", "a/start"}, {"to", {0, 0, -2}}});
    w.good({{"do", "precompute"}});
    const Json answer = play(w, 0.25);
    CHECK(answer["exact"] == false);
    CHECK(answer["warnings"].size() == 1);
    for (std::size_t i = 0; i < shown.points.size(); ++i) CHECK(w.session.shownPose().points[i] == shown.points[i]);
    w.good({{"do", "undo"}, {"count", 3}});
    CHECK(play(w, 0.25)["exact"] == true);
}

TEST_CASE("takes: a recording ends where the character becomes another one") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    w.good({{"do", "record"}, {"take", "t"}, {"action", "start"}});
    w.good({{"do", "step"}, {"frames", 5}});
    CHECK(w.session.recording()->frames == 6);
    SUBCASE("by another bone") { w.good({{"do", "add-bone"}, {"name", "c"}, {"from", "b/end"}, {"to", {0, 1, 7}}}); }
    SUBCASE("by a bone that leaves its neighbour") { w.good({{"do", "edit-bone"}, {"name", "b"}, {"from", {0, 0, 3.5}}}); }
    w.good({{"do", "step"}, {"frames", 5}});
    const Json answer = w.good({{"do", "record"}, {"take", "t"}, {"action", "stop"}});
    CHECK(answer["frames"] == 6);
    CHECK(answer["whole"] == false);
    CHECK(!w.session.recording());
    w.good({{"do", "save"}, {"path", (Workbench::folder() / "ended.imomushi").string()}});
}

TEST_CASE("takes: bad input is refused with a reason") {
    Workbench w;
    CHECK(w.code({{"do", "record"}, {"take", "t"}, {"action", "start"}}) == "no-element");
    w.buildChain();
    CHECK(w.code({{"do", "record"}, {"take", "t"}, {"action", "go"}}) == "bad-value");
    CHECK(w.code({{"do", "record"}, {"take", "t"}, {"action", "stop"}}) == "not-recording");
    CHECK(w.code({{"do", "record"}, {"take", "a/b"}, {"action", "start"}}) == "bad-name");
    CHECK(w.code({{"do", "record"}, {"take", ""}, {"action", "start"}}) == "bad-name");
    CHECK(w.code({{"do", "play"}, {"take", "t"}}) == "no-such-take");
    w.good({{"do", "record"}, {"take", "t"}, {"action", "start"}});
    const int position = w.session.position();
    CHECK(w.code({{"do", "record"}, {"take", "u"}, {"action", "start"}}) == "already-recording");
    CHECK(w.code({{"do", "record"}, {"take", "u"}, {"action", "stop"}}) == "not-recording");
    CHECK(w.session.position() == position);
    w.good({{"do", "record"}, {"take", "t"}, {"action", "stop"}});
    CHECK(w.code({{"do", "record"}, {"take", "t"}, {"action", "start"}}) == "name-taken");
    CHECK(w.code({{"do", "play"}, {"take", "t"}, {"time", -0.1}}) == "bad-value");
    CHECK(w.code({{"do", "play"}, {"take", "t"}, {"time", 1.0}}) == "bad-value");
    w.good({{"do", "play"}, {"take", "t"}, {"time", 0.0}});  // a take of one frame is a pose
    w.good({{"do", "record"}, {"take", "u"}, {"action", "start"}});
    CHECK(w.code({{"do", "play"}, {"take", "t"}}) == "already-recording");
    w.good({{"do", "record"}, {"take", "u"}, {"action", "stop"}});
    CHECK(w.code({{"do", "rename-take"}, {"take", "u"}, {"name", "t"}}) == "name-taken");
    CHECK(w.code({{"do", "remove-take"}, {"take", "v"}}) == "no-such-take");
}

TEST_CASE("takes: a broken take in a file is found, and files without takes open") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    recordDance(w);
    auto project = Project{w.session.document(), {}};
    const auto path = Workbench::folder() / "broken.imomushi";
    const auto code = [&](auto&& breakIt) {
        Project broken = project;
        auto take = std::make_shared<Take>(*broken.document.takes.begin()->second);
        breakIt(*take);
        broken.document.takes.begin()->second = take;
        const auto saved = saveProject(path, broken);  // reads it as it would be opened
        return saved ? std::string("ok") : saved.error().code;
    };
    CHECK(code([](Take&) {}) == "ok");
    CHECK(code([](Take& t) { t.times.pop_back(); }) == "not-sound");
    CHECK(code([](Take& t) { t.times[3] = t.times[2]; }) == "not-sound");
    CHECK(code([](Take& t) { t.name = "a/b"; }) == "not-sound");
    CHECK(code([](Take& t) { t.bones[0].end = t.points; }) == "not-sound");
    CHECK(code([](Take& t) { t.layout.joints += 1; }) == "not-sound");
    CHECK(code([](Take& t) {
        auto block = std::make_shared<FrameNumbers::Block>(*t.shapes.blocks().back());
        for (double& x : block->values) x *= 3.0;  // rotations are none
        FrameNumbers broken(t.shapes.first());
        broken.addBlock(block, t.times.size());
        t.shapes = broken;
    }) == "not-sound");
    CHECK(code([](Take& t) { t.targets[0].time = -1.0; }) == "not-sound");
    project.document.takes.clear();
    REQUIRE(saveProject(path, project));
    CHECK(openProject(path).has_value());
}

TEST_CASE("takes: numbers of frames are what was added, frame by frame, in parts and as files have them, and what rests costs next to nothing") {
    std::mt19937 random(4);
    for (const std::size_t frames : {0u, 1u, 255u, 256u, 257u, 1000u}) {
        constexpr std::size_t kWidth = 40;
        std::vector<std::vector<double>> rows;
        std::vector<double> row(kWidth, 0.5);
        FrameNumbers numbers;
        for (std::size_t f = 0; f < frames; ++f) {
            // Some never change, some for a while, one always.
            if (f / 300 == 1) row[3 + random() % 5] = static_cast<double>(random());
            row[20] = static_cast<double>(f);
            rows.push_back(row);
            numbers.add(row);
            std::vector<double> now(kWidth);
            numbers.at(f, now.data());
            REQUIRE(now == row);
        }
        numbers.finish();
        const FrameNumbers part = numbers.part(frames / 3, frames / 2);
        FrameNumbers read(numbers.first());
        for (std::size_t b = 0; b < numbers.blocks().size(); ++b) read.addBlock(numbers.blocks()[b], std::min(FrameNumbers::kRows, frames - b * FrameNumbers::kRows));
        CHECK(read == numbers);
        CHECK(numbers.blocks().size() == (frames + FrameNumbers::kRows - 1) / FrameNumbers::kRows);
        for (const auto& block : numbers.blocks()) CHECK(std::ssize(block->varying) <= 6);
        std::size_t wrong = 0;
        for (std::size_t f = 0; f < frames; ++f) {
            std::vector<double> a(kWidth), b(kWidth), c(kWidth);
            numbers.at(f, a.data());
            read.at(f, b.data());
            wrong += a != rows[f] || b != rows[f];
            if (f >= frames / 2) continue;
            part.at(f, c.data());
            wrong += c != rows[frames / 3 + f];
        }
        CHECK(wrong == 0);
        CHECK(numbers.bytes() < 8 * (kWidth + 4 * frames + 100));  // of 40 numbers a frame
    }
}
