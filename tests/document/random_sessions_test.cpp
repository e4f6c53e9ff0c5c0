// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdlib>
#include <map>

#include "core/document/document_change.h"
#include "tests/document/hand.h"
#include "tests/document/workbench.h"
#include "tests/support/thorough.h"

using namespace imomushi;

namespace {

/// Without what passes with frames, which is no step: the pose, and how far a glide is.
Document atRest(Document document) {
    document.pose = {};
    for (auto& [end, goal] : document.goals) goal.elapsed = 0.0;
    for (auto& [handle, goal] : document.handleGoals) goal.elapsed = 0.0;
    for (auto& [part, goal] : document.turns) goal.elapsed = 0.0;
    return document;
}

}  // namespace

TEST_CASE("random sessions: what failed changed nothing, undo leads back through every step, redo to the end, and what is saved opens as it was") {
    // IMOMUSHI_SESSION runs one of them alone.
    const char* only = std::getenv("IMOMUSHI_SESSION");
    const int first = only ? std::atoi(only) : 0, sessions = only ? first + 1 : repeats(200, 10'000);
    const int commands = repeats(15, 200);
    {
        Workbench small;
        small.good({{"do", "import-element"}, {"path", "bar0"}, {"name", "C"}});
        small.good({{"do", "set"}, {"target", "C"}, {"property", "solver-mesh"}, {"value", "as-is"}});
        small.addFace("C", "in", 0, -1);
        small.good({{"do", "save"}, {"path", (Workbench::folder() / "added.imomushi").string()}});
    }
    std::map<std::string, std::pair<int, int>> tried;  // by command: done, refused
    for (int seed = first; seed < sessions; ++seed) {
        INFO("session " << seed);
        Workbench w;
        Hand hand(w.session, static_cast<unsigned>(seed), Workbench::folder().string());
        if (seed % 4) w.buildChain();
        w.good({{"do", "set"}, {"target", "character"}, {"property", "threads"}, {"value", 1}});
        std::vector<std::optional<Document>> at;  // by position, as it was when the next step began
        bool gesture = false;
        std::size_t lowest = 0;  // position since the gesture began
        int faults = 0;
        const auto run = [&](const Json& command) {
            const Document before = w.session.document();
            const auto position = static_cast<std::size_t>(w.session.position());
            lowest = std::min(lowest, position);
            if (!gesture) {
                at.resize(std::max(at.size(), position + 1));
                at[position] = before;
            }
            const auto answer = w.session.execute(command);
            auto& [done, refused] = tried[command["do"]];
            ++(answer ? done : refused);
            if (answer) hand.heard(command, *answer);
            if (!answer && !difference(before, w.session.document()).empty()) ++faults;
            if (!answer && (answer.error().code == "internal" || answer.error().message.empty())) ++faults;
            // What comes after a new step was another document.
            if (command["do"] != "undo" && command["do"] != "redo" && static_cast<std::size_t>(w.session.position()) != position) at.resize(position + 1);
            if (faults == 1) FAIL_CHECK(command.dump() << ": " << (answer ? "done" : answer.error().code + ": " + answer.error().message));
            if (!w.session.builtCharacter() && !w.session.document().elements.empty()) ++faults;
            return answer.has_value();
        };
        for (int i = 0; i < commands && faults == 0; ++i) {
            if (hand.below(12) == 0) {  // a drag by mouse
                w.session.beginGesture();
                gesture = true;
                lowest = static_cast<std::size_t>(w.session.position());
                at.resize(std::max(at.size(), lowest + 1));
                at[lowest] = w.session.document();
                for (std::size_t moves = hand.below(6); moves > 0; --moves) run(hand.command());
                if (hand.below(3))
                    w.session.endGesture();
                else
                    w.session.cancelGesture();
                gesture = false;
                at.resize(std::min(at.size(), lowest + 1));
            } else if (const Json command = hand.command(); run(command) && command["do"] != "undo" && command["do"] != "redo") {
                std::vector<std::string> anew;  // solved in no time from now on
                for (const auto& [id, element] : w.session.document().elements)
                    if (element->solverMesh.kind != SolverMeshSetting::Kind::AsIs) anew.push_back(element->name);
                for (const std::string& name : anew) run({{"do", "set"}, {"target", name}, {"property", "solver-mesh"}, {"value", "as-is"}});
            }
        }
        run({{"do", "rest"}});
        REQUIRE(faults == 0);

        const std::string end = w.content();
        const int last = w.session.position();
        int wrong = 0;
        while (w.session.position() > 0) {
            w.good({{"do", "undo"}});
            const auto& was = at[static_cast<std::size_t>(w.session.position())];
            if (!was) continue;
            const DocumentChange change = difference(atRest(*was), atRest(w.session.document()));
            if (!change.empty() && ++wrong == 1) {
                const auto& step = w.session.steps()[static_cast<std::size_t>(w.session.position())];
                FAIL_CHECK("undo to step " << w.session.position() << ", " << step.name << " " << step.subject << ", leads to another document");
            }
        }
        CHECK(wrong == 0);
        while (w.session.position() < last) w.good({{"do", "redo"}});
        CHECK(w.content() == end);

        if (!thorough() && seed % 8 != 0) continue;
        const std::string path = (Workbench::folder() / "random.imomushi").string();
        w.good({{"do", "save"}, {"path", path}, {"copy", true}});
        Workbench other;
        other.good({{"do", "open"}, {"path", path}});
        CHECK(other.content() == end);
        CHECK(other.session.document().elements.size() == w.session.document().elements.size());
    }
    std::string text;
    for (const auto& [name, times] : tried) text += name + " " + std::to_string(times.first) + "/" + std::to_string(times.second) + ", ";
    MESSAGE(sessions << " sessions; done/refused: " << text);
}
