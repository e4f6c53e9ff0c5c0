// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <map>
#include <random>

#include "core/document/document_change.h"
#include "tests/document/workbench.h"
#include "tests/support/thorough.h"

using namespace imomushi;

namespace {

/// Somebody who tries everything: commands with arguments by chance, most of which fit the document.
class Hand {
public:
    Hand(const Session& session, unsigned seed) : session_(session), random_(seed) {}

    std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }
    double number(double low, double high) { return low + (high - low) * static_cast<double>(random_()) / 4294967295.0; }

    Json command() {
        const Document& d = session_.document();
        if (d.elements.size() < 2 || (d.elements.size() < 6 && below(12) == 0)) return import();
        if (d.bones.size() < 2 && below(2)) return below(2) ? addFace() : Json{{"do", "add-bone"}, {"name", name()}, {"from", face()}, {"to", face()}};
        if (d.takes.empty() && below(6) == 0) return {{"do", "record"}, {"take", "take"}, {"action", below(2) ? "start" : "stop"}};
        switch (below(34)) {
            case 0: return addFace();
            case 1:
            case 2: return {{"do", "join"}, {"a", face()}, {"b", face()}};
            case 3: return {{"do", "unjoin"}, {"face", face()}};
            case 4: return {{"do", below(3) ? "undo" : "remove-joint-face"}, {below(3) ? "count" : "face", below(2) ? Json(1) : Json(face())}};
            case 5:
            case 6: return {{"do", "add-bone"}, {"name", name()}, {"from", end()}, {"to", end()}};
            case 7: return {{"do", "edit-bone"}, {"name", bone()}, {below(2) ? "from" : "to", end()}};
            case 8: return {{"do", "remove-bone"}, {"name", bone()}};
            case 9: return below(4) ? import() : Json{{"do", "remove-element"}, {"name", element()}};
            case 10: return {{"do", "rename"}, {"target", below(2) ? element() : bone()}, {"name", name()}};
            case 11: return {{"do", "set"}, {"target", element()}, {"property", one({"nu", "stiffness", "density", "damping"})}, {"value", number(-0.1, 1.0)}};
            case 12: return {{"do", "set"}, {"target", bone()}, {"property", one({"min-stretch", "max-twist", "stiffness", "weight"})}, {"value", number(0.0, 2.0)}};
            case 13: return {{"do", "set"}, {"target", "character"}, {"property", one({"basis", "threads"})}, {"value", below(2) ? Json(one({"paper", "affine", "modes:6"})) : Json(below(3))}};
            case 14: return {{"do", below(3) ? "enable" : "disable"}, {"effect", effect()}};
            case 15: return {{"do", "set"}, {"target", effect()}, {"property", one({"damping", "strength", "height", "sag", "amount"})}, {"value", number(-1.0, 3.0)}};
            case 16:
            case 17:
            case 18: return {{"do", "drag"}, {"endpoint", end()}, {"to", place(8.0)}};
            case 19: return {{"do", "drag"}, {"endpoint", end()}, {"to", place(2.0)}, {"roll", number(-3.0, 3.0)}, {"seconds", number(0.0, 0.2)}};
            case 20: return {{"do", below(2) ? "pin" : "unpin"}, {"endpoint", end()}};
            case 21: return below(2) ? Json{{"do", "release"}} : Json{{"do", "release"}, {"endpoint", end()}};
            case 22: return {{"do", "rest"}};
            case 23: return {{"do", "step"}, {"frames", 1 + below(4)}};
            case 24: return {{"do", "touch"}, {"element", element()}, {"point", vertex()}, {"to", below(2) ? vertex() : Json()}};
            case 25: return {{"do", "handle"}, {"element", element()}, {"point", vertex()}, {"radius", number(0.2, 0.6)}};
            case 26: return {{"do", "remove-handle"}, {"handle", handle()}};
            case 27: return {{"do", "record"}, {"take", below(2) ? "take" : name()}, {"action", below(2) ? "start" : "stop"}};
            case 28: return {{"do", one({"remove-take", "play"})}, {"take", take()}};
            case 29: return {{"do", one({"rename-take", "duplicate-take"})}, {"take", take()}, {"name", name()}};
            case 30: return {{"do", "duplicate"}, {"names", {below(2) ? element() : bone()}}};
            case 31: return {{"do", "mirror"}, {"from", {below(2) ? element() : bone()}}};
            case 32: return {{"do", one({"undo", "redo"})}, {"count", 1 + below(4)}};
            default: return below(4) ? Json{{"do", "redo"}} : Json{{"do", "precompute"}};
        }
    }

private:
    std::string one(std::initializer_list<const char*> list) { return *(list.begin() + static_cast<std::ptrdiff_t>(below(list.size()))); }
    template <class Parts>
    std::string nameIn(const Parts& parts, const char* none) {
        if (parts.empty() || below(40) == 0) return none;
        return std::next(parts.begin(), static_cast<std::ptrdiff_t>(below(parts.size())))->second->name;
    }
    std::string element() { return nameIn(session_.document().elements, "nobody"); }
    std::string bone() { return nameIn(session_.document().bones, "no bone"); }
    std::string take() { return nameIn(session_.document().takes, "no take"); }
    std::string face() {
        const auto& elements = session_.document().elements;
        const auto& e = *std::next(elements.begin(), static_cast<std::ptrdiff_t>(below(elements.size())))->second;
        return e.name + "/" + (e.faces.empty() ? "in" : e.faces[below(e.faces.size())].name);
    }
    std::string handle() {
        for (const auto& [id, e] : session_.document().elements)
            if (!e->handles.empty() && below(2)) return e->handles[below(e->handles.size())].face;
        return "no handle";
    }
    std::string end() {
        if (below(6) == 0) return face();
        if (below(8) == 0) return handle();
        return bone() + one({"/start", "/end"});
    }
    std::string effect() { return one({"bone-dynamics", "smooth-joints", "bend-warp", "joint-dynamics", "gravity", "inflate", "touch", "contact", "ground"}); }
    /// Names that a person gives, and some that are taken or not allowed.
    std::string name() { return one({"arm", "Arm", "足", "tail.L", "tail.R", "a/b", "", "bar0", "いもむし 1"}) + (below(2) ? std::to_string(below(50)) : ""); }
    Json place(double reach) { return {number(-reach, reach), number(-reach, reach), number(-reach, reach + 6.0)}; }
    /// The end of a bar, mostly.
    Json addFace() {
        const auto& elements = session_.document().elements;
        const Element& e = *std::next(elements.begin(), static_cast<std::ptrdiff_t>(below(elements.size())))->second;
        const bool far = below(2);
        const auto z = e.mesh->body.vertices.col(2);
        const double side = far ? z.maxCoeff() : z.minCoeff();
        return {{"do", "add-joint-face"}, {"element", e.name}, {"name", far ? "out" : "in"}, {"plane", {{"origin", {0, 0, side}}, {"normal", {0, 0, far ? 1 : -1}}}}};
    }
    Json vertex() {
        const auto& elements = session_.document().elements;
        const Points& all = std::next(elements.begin(), static_cast<std::ptrdiff_t>(below(elements.size())))->second->mesh->body.vertices;
        const auto v = static_cast<Eigen::Index>(below(static_cast<std::size_t>(all.rows())));
        return {all(v, 0), all(v, 1), all(v, 2)};
    }
    Json import() {
        const std::string place = std::to_string(below(5));
        return {{"do", "import-element"}, {"path", one({"bar", "bar", "coarse"}) + place}, {"name", name()}};
    }

    const Session& session_;
    std::mt19937 random_;
};

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
    const int sessions = repeats(24, 10'000);
    constexpr int kCommands = 200;
    std::map<std::string, std::pair<int, int>> tried;  // by command: done, refused
    for (int seed = 0; seed < sessions; ++seed) {
        INFO("session " << seed);
        Workbench w;
        Hand hand(w.session, static_cast<unsigned>(seed));
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
            if (!answer && !difference(before, w.session.document()).empty()) ++faults;
            if (!answer && (answer.error().code == "internal" || answer.error().message.empty())) ++faults;
            // What comes after a new step was another document.
            if (command["do"] != "undo" && command["do"] != "redo" && static_cast<std::size_t>(w.session.position()) != position) at.resize(position + 1);
            if (faults == 1) FAIL_CHECK(command.dump() << ": " << (answer ? "done" : answer.error().code + ": " + answer.error().message));
            if (!w.session.builtCharacter() && !w.session.document().elements.empty()) ++faults;
            return answer.has_value();
        };
        for (int i = 0; i < kCommands && faults == 0; ++i) {
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
            } else if (const Json command = hand.command(); run(command) && command["do"] == "import-element") {
                for (const auto& [id, element] : w.session.document().elements) {  // solved in no time
                    if (element->solverMesh.kind == SolverMeshSetting::Kind::AsIs) continue;
                    run({{"do", "set"}, {"target", element->name}, {"property", "solver-mesh"}, {"value", "as-is"}});
                }
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
                FAIL_CHECK(w.session.position() << ": " << step.name << " " << step.subject << change.elements.size() << change.bones.size() << change.joints.size() << change.takes.size()<<change.goals.size()<<change.handleGoals.size()<<change.settings.has_value()<<change.effects.has_value()<<change.touches.has_value());
            }
        }
        CHECK(wrong == 0);
        while (w.session.position() < last) w.good({{"do", "redo"}});
        CHECK(w.content() == end);

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
