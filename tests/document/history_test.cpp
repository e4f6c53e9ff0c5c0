// SPDX-License-Identifier: GPL-3.0-or-later
#include <rapidcheck.h>

#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

/// A command out of small numbers: some are possible, some are not.
Json commandFrom(unsigned kind, unsigned a, unsigned b) {
    const auto pick = [](unsigned n, std::initializer_list<const char*> names) { return *(names.begin() + n % names.size()); };
    const double x = 0.25 * (static_cast<int>(b % 17) - 8);
    const char* end = pick(a, {"a/start", "a/end", "b/start", "b/end", "c/end"});
    const char* element = pick(a, {"A", "B", "C"});
    switch (kind % 20) {
        case 0: return {{"do", "drag"}, {"endpoint", end}, {"to", {x, 0.3 * x, 3.0 + x}}};
        case 1: return {{"do", "drag"}, {"endpoint", end}, {"to", {x, 0, 4.0}}, {"seconds", 0.1}, {"roll", 0.1 * x}};
        case 2: return {{"do", "release"}};
        case 3: return {{"do", "release"}, {"endpoint", end}};
        case 4: return {{"do", "rest"}};
        case 5: return {{"do", "pin"}, {"endpoint", end}};
        case 6: return {{"do", "unpin"}, {"endpoint", end}};
        case 7: return {{"do", "set"}, {"target", element}, {"property", "nu"}, {"value", 0.05 * (b % 10)}};
        case 8: return {{"do", "set"}, {"target", "character"}, {"property", "basis"}, {"value", b % 2 ? "paper" : "affine"}};
        case 9: return {{"do", "set"}, {"target", element}, {"property", "color"}, {"value", b % 2 ? "#102030" : "#ffffff"}};
        case 10: return {{"do", "add-bone"}, {"name", "c"}, {"from", end}, {"to", {x, x, 7.0}}};
        case 11: return {{"do", "remove-bone"}, {"name", pick(b, {"a", "b", "c"})}};
        case 12: return {{"do", "import-element"}, {"path", "coarse2"}, {"name", "C"}};
        case 13: return {{"do", "remove-element"}, {"name", element}};
        case 14: return {{"do", "add-joint-face"}, {"element", element}, {"name", "f"}, {"plane", {{"origin", {0, 0, b % 2 ? 6 : 9}}, {"normal", {0, 0, b % 2 ? -1 : 1}}}}};
        case 15: return {{"do", "join"}, {"a", "B/out"}, {"b", "C/f"}};
        case 16: return {{"do", "unjoin"}, {"face", b % 2 ? "A/out" : "B/in"}};
        case 17: return {{"do", "remove-joint-face"}, {"face", b % 2 ? "A/out" : "B/out"}};
        case 18: return {{"do", "rename"}, {"target", b % 2 ? element : "A/in"}, {"name", b % 3 ? "別名" : "C"}};
        default: return {{"do", "edit-bone"}, {"name", pick(a, {"a", "b"})}, {"to", {0.0, x, 5.0}}};
    }
}

}  // namespace

TEST_CASE("history: undoing everything gives the first document, redoing everything the last, and a refused command changes nothing") {
    const bool holds = rc::check([] {
        const auto choices = *rc::gen::resize(30, rc::gen::arbitrary<std::vector<std::tuple<unsigned, unsigned, unsigned>>>());
        Workbench w;
        w.buildChain();
        const int first = w.session.position();
        std::vector<std::string> contents{w.content()};
        for (const auto& [kind, a, b] : choices) {
            const auto answer = w.session.execute(commandFrom(kind, a, b));
            const std::string now = w.content();
            if (answer)
                contents.push_back(now);
            else
                RC_ASSERT(now == contents.back());
            RC_ASSERT(w.session.position() == first + static_cast<int>(contents.size()) - 1);
        }
        for (std::size_t i = contents.size() - 1; i > 0; --i) {
            w.good({{"do", "undo"}});
            RC_ASSERT(w.content() == contents[i - 1]);
        }
        const int steps = static_cast<int>(contents.size()) - 1;
        if (steps > 0) {
            w.good({{"do", "redo"}, {"count", steps}});
            RC_ASSERT(w.content() == contents.back());
            w.good({{"do", "undo"}, {"count", steps}});
            RC_ASSERT(w.content() == contents.front());
        }
    });
    CHECK(holds);
}

TEST_CASE("history: every command that changes the document is one step, named after it") {
    Workbench w;
    w.buildChain("default");
    CHECK(w.session.steps().size() == 9);
    CHECK(w.session.steps()[0].name == "import-element");
    CHECK(w.session.steps()[0].subject == "A");
    w.good({{"do", "step"}, {"frames", 1}});
    CHECK(w.session.steps().size() == 9);
    CHECK(w.code({{"do", "undo"}, {"count", 10}}) == "nothing-to-undo");
    CHECK(w.good({{"do", "undo"}, {"count", 9}})["undone"].size() == 9);
    CHECK(w.session.document().elements.empty());
    CHECK(w.code({{"do", "undo"}}) == "nothing-to-undo");
    CHECK(w.good({{"do", "redo"}, {"count", 2}})["redone"][1] == "import-element");
    w.addFace("A", "new", 3, 1);
    CHECK(w.code({{"do", "redo"}}) == "nothing-to-redo");
    CHECK(w.session.steps().size() == 3);
}

TEST_CASE("history: a gesture is one step, cancelled it leaves nothing, and undo in the middle cancels it") {
    Workbench w;
    w.buildChain();
    const std::string before = w.content();
    const int steps = w.session.position();
    w.session.beginGesture();
    for (int i = 1; i <= 5; ++i) w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0.1 * i, 0, 6}}});
    CHECK(w.session.position() == steps);
    w.session.cancelGesture();
    CHECK(w.content() == before);
    CHECK(w.session.position() == steps);

    w.session.beginGesture();
    for (int i = 1; i <= 5; ++i) w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0.1 * i, 0, 6}}});
    w.session.endGesture();
    CHECK(w.session.position() == steps + 1);
    w.good({{"do", "undo"}});
    CHECK(w.content() == before);

    w.session.beginGesture();
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1, 0, 6}}});
    w.good({{"do", "undo"}});
    CHECK(w.content() == before);
    w.session.endGesture();
    CHECK(w.session.position() == steps);

    w.session.beginGesture();
    w.session.endGesture();
    CHECK(w.session.position() == steps);
}

TEST_CASE("history: what is done in the step of live input before is undone with it, and redone; a step of another kind, a saved one and one with steps after it are left alone") {
    Workbench w;
    w.buildChain();
    const auto drag = [&](double x) { w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {x, 0, 6}}}); };
    const auto gesture = [&](const auto& act, const char* name) {
        w.session.beginGesture();
        act();
        w.session.endGesture({name, {}});
    };
    const auto added = [&](const auto& act) {
        const int before = w.session.position();
        w.session.beginGesture();
        act();
        w.session.endGestureInLast({"release", {}});
        return w.session.position() == before;
    };
    const auto release = [&] { w.good({{"do", "release"}}); };
    const std::string first = w.content();
    gesture([&] { drag(0.3); }, "live");
    CHECK(added(release));
    const std::string released = w.content();
    CHECK(w.session.steps().back().name == "live");
    Workbench again;
    for (const Json& line : w.session.script()) again.good(line);
    CHECK(again.content() == released);
    w.good({{"do", "undo"}});
    CHECK(w.content() == first);
    w.good({{"do", "redo"}});
    CHECK(w.content() == released);
    drag(0.2);
    CHECK(!added(release));
    CHECK(w.session.steps().back().name == "release");
    gesture([&] { drag(0.4); }, "live");
    w.good({{"do", "save"}, {"path", (Workbench::folder() / "joined.imomushi").string()}});
    CHECK(!added(release));
    gesture([&] { drag(0.1); }, "live");
    drag(0.5);
    w.good({{"do", "undo"}});
    CHECK(!added(release));
}

TEST_CASE("modified: by the saved position, also after undo and after the saved state is gone") {
    Workbench w;
    const std::string path = (Workbench::folder() / "modified.imomushi").string();
    CHECK(!w.session.modified());
    w.buildChain();
    CHECK(w.session.modified());
    w.good({{"do", "save"}, {"path", path}});
    CHECK(!w.session.modified());
    CHECK(w.session.path() == path);
    w.good({{"do", "undo"}});
    CHECK(w.session.modified());
    w.good({{"do", "redo"}});
    CHECK(!w.session.modified());
    w.good({{"do", "undo"}});
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    CHECK(w.session.modified());
    w.good({{"do", "undo"}});
    CHECK(w.session.modified());  // the saved state is out of reach
    w.good({{"do", "save"}});
    CHECK(!w.session.modified());
    w.good({{"do", "new"}});
    CHECK(!w.session.modified());
    CHECK(w.code({{"do", "undo"}}) == "nothing-to-undo");
}

TEST_CASE("script: holds what was done, without what was undone, and makes the same document again") {
    Workbench w;
    w.buildChain("default");
    w.good({{"do", "set"}, {"target", "A"}, {"property", "nu"}, {"value", 0.1}});
    w.good({{"do", "undo"}});
    w.good({{"do", "precompute"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1, 0, 5}}});
    Workbench again;
    for (const Json& line : w.session.script()) {
        CHECK(line["do"] != "set");
        again.good(line);
    }
    CHECK(again.content() == w.content());
}

TEST_CASE("script: makes takes again, whatever moved when they began and whatever was done while they ran") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "enable"}, {"effect", "bone-dynamics"}});
    w.good({{"do", "precompute"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1, 0, 5}}});
    w.good({{"do", "step"}, {"frames", 7}});
    w.good({{"do", "record"}, {"take", "one"}, {"action", "start"}});
    w.good({{"do", "step"}, {"frames", 3}, {"dt", {0.01, 0.02, 0.015}}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0, 1, 5}}, {"seconds", 0.1}});
    w.good({{"do", "step"}, {"frames", 10}});
    w.good({{"do", "record"}, {"take", "one"}, {"action", "stop"}});
    w.good({{"do", "record"}, {"take", "gone"}, {"action", "start"}});
    w.good({{"do", "step"}, {"frames", 2}});
    w.good({{"do", "record"}, {"take", "gone"}, {"action", "stop"}});
    w.good({{"do", "undo"}});
    w.session.beginGesture();
    w.session.stepFrame(0.01);
    w.session.endGesture();
    CHECK(w.session.steps().back().name == "record");
    w.good({{"do", "step"}, {"frames", 5}});
    Workbench again;
    for (const Json& line : w.session.script()) again.good(line);
    CHECK(again.session.script().back()["do"] == "record");
    REQUIRE(again.session.document().takes.size() == 1);
    const Take &is = *again.session.document().takeNamed("one"), &was = *w.session.document().takeNamed("one");
    CHECK(is.times == was.times);
    CHECK(is.poses == was.poses);
    CHECK(is.shapes == was.shapes);
}

TEST_CASE("step: a list of times has one for each frame") {
    Workbench w;
    w.buildChain();
    CHECK(w.code({{"do", "step"}, {"frames", 2}, {"dt", {0.1}}}) == "bad-value");
    CHECK(w.code({{"do", "step"}, {"frames", 2}, {"dt", {0.1, "x"}}}) == "bad-type");
    CHECK(w.code({{"do", "step"}, {"frames", 2}, {"dt", {0.1, 0.0}}}) == "bad-value");
    CHECK(w.code({{"do", "step"}, {"frames", 2}, {"dt", "x"}}) == "bad-type");
    CHECK(w.code({{"do", "step"}, {"frames", 2}, {"dt", {0.1, 0.2}}}) == "ok");
}

TEST_CASE("listener: says what changed") {
    Workbench w;
    Session::Change last;
    int calls = 0;
    w.session.setListener([&](const Session::Change& change) {
        last = change;
        ++calls;
    });
    w.buildChain();
    CHECK(calls == 11);
    CHECK(last.structure());
    REQUIRE(last.document.bones.size() == 1);  // that part alone, as it was
    CHECK(last.document.bones.begin()->second == nullptr);
    CHECK(last.document.elements.empty());
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1, 0, 5}}});
    CHECK(last.pose);
    CHECK(!last.structure());
    CHECK(last.document.goals.size() == 1);
    w.good({{"do", "precompute"}});
    CHECK(last.responses);
    w.good({{"do", "undo"}});
    CHECK(last.pose);
    w.good({{"do", "set"}, {"target", "A"}, {"property", "nu"}, {"value", 0.3}});
    w.good({{"do", "set"}, {"target", "B"}, {"property", "nu"}, {"value", 0.3}});
    w.good({{"do", "undo"}});
    CHECK(last.structure());
    REQUIRE(last.document.elements.size() == 1);
    CHECK(last.document.elements.begin()->second->nu == 0.3);
    w.good({{"do", "undo"}});
    const int before = calls;
    w.run({{"do", "drag"}, {"endpoint", "nobody/end"}, {"to", {1, 0, 5}}});
    CHECK(calls == before);
}

TEST_CASE("history: only the last steps are kept, and what only older ones held goes; the script still makes the whole document again") {
    Workbench w;
    w.session.setHistoryDepth(5);
    w.good({{"do", "import-element"}, {"path", "bar0"}, {"name", "A"}});
    std::weak_ptr<const ElementMesh> mesh = w.session.document().elements.begin()->second->mesh;
    w.good({{"do", "remove-element"}, {"name", "A"}});
    CHECK_FALSE(mesh.expired());  // undo brings it back
    w.good({{"do", "import-element"}, {"path", "bar1"}, {"name", "B"}});
    const TestFolder folder;
    w.good({{"do", "save"}, {"path", (folder.path() / "a.imomushi").string()}});
    CHECK_FALSE(w.session.modified());
    for (int i = 0; i < 5; ++i) w.good({{"do", "set"}, {"target", "B"}, {"property", "stiffness"}, {"value", 2.0 + i}});
    CHECK(w.session.position() == 5);
    CHECK(w.session.steps().size() == 5);
    CHECK(mesh.expired());
    w.good({{"do", "undo"}, {"count", 5}});
    CHECK(w.code({{"do", "undo"}}) == "nothing-to-undo");
    CHECK_FALSE(w.session.modified());  // what was saved is the oldest state that is kept
    w.good({{"do", "redo"}, {"count", 5}});
    w.good({{"do", "set"}, {"target", "B"}, {"property", "stiffness"}, {"value", 9.0}});
    w.good({{"do", "undo"}, {"count", 5}});
    CHECK(w.session.modified());  // and is out of reach now
    w.good({{"do", "redo"}, {"count", 5}});
    Workbench again;
    for (const Json& line : w.session.script()) again.good(line);
    CHECK(again.session.document().elements.size() == 1);
    CHECK(again.session.document().elements.begin()->second->stiffness == 9.0);
    w.session.setHistoryDepth(2);
    CHECK(w.session.position() == 2);
}

TEST_CASE("script: beyond its bytes there is none, and it begins anew where the project is saved") {
    Workbench w;
    w.buildChain();
    const std::string path = (Workbench::folder() / "long.imomushi").string(), script = (Workbench::folder() / "long.jsonl").string();
    const auto drag = [&](double x) { w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {x, 0, 5}}}); };
    w.session.setScriptBytes(4000);
    CHECK(w.session.hasScript());
    for (int i = 0; w.session.hasScript() && i < 100; ++i) drag(0.01 * i);
    CHECK(!w.session.hasScript());
    CHECK(w.code({{"do", "save-script"}, {"path", script}}) == "script-too-long");
    drag(0.5);
    w.good({{"do", "undo"}});  // the history is whole
    w.good({{"do", "save"}, {"path", path}});
    CHECK(w.session.hasScript());
    drag(0.7);
    w.good({{"do", "set"}, {"target", "A"}, {"property", "nu"}, {"value", 0.2}});
    const std::string end = w.content();
    w.good({{"do", "save-script"}, {"path", script}});
    CHECK(w.session.script().size() == 3);
    Workbench again;
    for (const Json& line : w.session.script()) again.good(line);
    CHECK(again.content() == end);
    w.good({{"do", "undo"}, {"count", 3}});
    CHECK(!w.session.hasScript());  // it does not know what was before
    w.good({{"do", "redo"}, {"count", 3}});
    CHECK(w.session.hasScript());
    CHECK(w.session.script().size() == 3);
    w.good({{"do", "undo"}, {"count", 3}});
    drag(0.9);
    CHECK(!w.session.hasScript());
    w.good({{"do", "save"}, {"path", path}});
    CHECK(w.session.script().size() == 1);
}

TEST_CASE("script: what passed in a gesture that is taken back is not in it, and inputs stand at their frames") {
    DocumentHistory history;
    const auto record = [&](const char* action) {
        history.flushFrames();
        history.note({{"do", "record"}, {"take", "t"}, {"action", action}});
    };
    const auto give = [&](double x) { history.noteInput({{"endpoint", "b/end"}, {"to", {x, 0.0, 5.0}}}); };
    record("start");
    history.beginGesture();
    history.noteFrame(0.5);
    give(1.0);
    history.noteFrame(0.5);
    (void)history.cancelGesture();
    history.noteFrame(0.25);
    give(2.0);
    give(3.0);
    history.noteFrame(0.125);
    record("stop");
    const std::vector<Json> script = history.script();
    REQUIRE(script.size() == 4);
    CHECK(script[2] == Json({{"do", "step"}, {"frames", 2}, {"dt", {0.25, 0.125}},
                             {"inputs", {{{"endpoint", "b/end"}, {"to", {2.0, 0.0, 5.0}}, {"frame", 1}}, {{"endpoint", "b/end"}, {"to", {3.0, 0.0, 5.0}}, {"frame", 1}}}}}));
}
