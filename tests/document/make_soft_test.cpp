// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <functional>
#include <set>
#include <thread>

#include "core/commands/proposal_commands.h"
#include "core/session/prepared_step.h"
#include "tests/document/workbench.h"
#include "tests/support/capsules.h"
#include "tests/support/random_edits.h"

using namespace imomushi;

namespace {

/// Characters: "animal" of capsules.h, "large animal" 128 times as large, "starfish", and those of the workbench.
void useCapsules(Workbench& w) {
    w.session.services().importCharacter = [](const ImportRequest& request, const Progress& progress) -> Result<CharacterFile> {
        const std::string name = request.path.string();
        static const TriangleMesh animal = capsules::animal(), starfish = capsules::starfish();
        if (name == "animal") return Workbench::characterOf({animal}, {"animal"});
        if (name == "starfish") return Workbench::characterOf({starfish}, {"starfish"});
        if (name == "large animal") {
            TriangleMesh large = animal;
            large.vertices *= 128.0;  // exact
            return Workbench::characterOf({large}, {"animal"});
        }
        return Workbench::characterFile(request, progress);
    };
}

Json makeSoft(const std::string& path) { return {{"do", "make-soft"}, {"path", path}, {"precompute", false}}; }

std::set<std::string> commandsOf(const Workbench& w) {
    std::set<std::string> names;
    for (const Json& line : w.session.script()) names.insert(line.at("do").get<std::string>());
    return names;
}

}  // namespace

TEST_CASE("propose: tells cuts, bones and pins, and changes nothing") {
    Workbench w;
    useCapsules(w);
    w.good({{"do", "import-character"}, {"path", "animal"}, {"name", "it"}});
    const std::string before = w.content();
    const auto position = w.session.position();
    const Json answer = w.good({{"do", "propose"}, {"character", "it"}});
    CHECK(w.content() == before);
    CHECK(w.session.position() == position);
    CHECK(answer["from"] == "shape");
    CHECK(answer["cuts"].size() >= 6);
    CHECK(answer["bones"].size() > answer["cuts"].size());
    CHECK(answer["pins"].size() == 4);
    CHECK(answer["symmetry"].is_object());
    CHECK(!answer["size"].contains("suggested_unit"));
    for (const Json& cut : answer["cuts"])
        for (const char* key : {"name", "origin", "normal"}) CHECK(cut.contains(key));
    CHECK(w.good({{"do", "propose"}, {"character", "it"}, {"from", "shape"}})["cuts"] == answer["cuts"]);
    CHECK(w.good({{"do", "propose"}, {"character", "it"}, {"least", 0.05}})["cuts"].size() < answer["cuts"].size());
    CHECK(w.code({{"do", "propose"}, {"character", "it"}, {"from", "skeleton"}}) == "no-skeleton");
    CHECK(w.code({{"do", "propose"}, {"character", "it"}, {"from", "nothing"}}) == "bad-value");
    CHECK(w.code({{"do", "propose"}, {"character", "it"}, {"least", 2.0}}) == "bad-value");
    CHECK(w.code({{"do", "propose"}, {"character", "other"}}) == "no-such-character");
}

TEST_CASE("make-soft: one step of ordinary commands, and every bone can be dragged by its end") {
    Workbench w;
    useCapsules(w);
    const std::string empty = w.content();
    const Json answer = w.good(makeSoft("animal"));
    CHECK(answer["refused"] == Json::array());
    CHECK(answer["elements"].size() == answer["proposal"]["cuts"].size() + 1);
    CHECK(answer["cuts"].size() == answer["proposal"]["cuts"].size());
    CHECK(answer["bones"].size() == answer["proposal"]["bones"].size());
    CHECK(answer["pins"].size() == 4);
    // Stages follow each other, and making a body is more than a tick of the clock.
    const Json& seconds = answer["seconds"];
    double stages = 0.0;
    for (const char* stage : {"body", "propose", "cut", "bones"}) stages += seconds[stage].get<double>();
    CHECK(seconds["body"].get<double>() > 0.0);
    CHECK(seconds["all"].get<double>() >= stages * (1.0 - 1e-12));
    CHECK(!seconds.contains("precompute"));
    const std::string made = w.content();

    REQUIRE(w.session.steps().size() == 1);
    CHECK(w.session.steps()[0].name == "make-soft");
    const auto commands = commandsOf(w);
    CHECK(!commands.contains("make-soft"));
    for (const char* command : {"import-character", "cut-all", "rename", "add-bone", "pin"}) CHECK_MESSAGE(commands.contains(command), command);
    const auto script = w.session.script();

    w.good({{"do", "undo"}});
    CHECK(w.content() == empty);
    CHECK(w.code({{"do", "undo"}}) == "nothing-to-undo");
    w.good({{"do", "redo"}});
    CHECK(w.content() == made);

    // All bones of the list, by their ends; each runs through an element.
    const Json listed = w.good({{"do", "list"}});
    REQUIRE(listed["bones"].size() == answer["bones"].size());
    for (const Json& bone : listed["bones"]) {
        CAPTURE(bone["name"]);
        CHECK(bone["element"].is_string());
        const std::string end = bone["name"].get<std::string>() + "/end";
        const Json at = w.good({{"do", "measure"}, {"what", "position"}, {"endpoint", end}})["value"];
        const Json dragged = w.good({{"do", "drag"}, {"endpoint", end}, {"to", {at[0].get<double>() + 0.05, at[1].get<double>() + 0.04, at[2].get<double>()}}});
        CHECK(std::isfinite(dragged["distance"].get<double>()));
        w.good({{"do", "release"}, {"endpoint", end}});
    }

    // The script makes the same character again.
    Workbench again;
    useCapsules(again);
    for (const Json& line : script) again.good(line);
    CHECK(again.content() == made);
}

TEST_CASE("make-soft: drafts make it soft at once") {
    Workbench w;
    useCapsules(w);
    Json line = makeSoft("starfish");
    line["draft"] = true;
    const Json answer = w.good(line);
    CHECK(answer["drafts"] == answer["elements"].size());
    CHECK(answer["seconds"]["draft"].get<double>() > 0.0);
    // An arm that is lifted at its tip bends: its render vertices do not move as one rigid piece.
    const std::string end = answer["bones"].back().get<std::string>() + "/end";
    const Json at = w.good({{"do", "measure"}, {"what", "position"}, {"endpoint", end}})["value"];
    w.good({{"do", "drag"}, {"endpoint", end}, {"to", {at[0], at[1].get<double>() + 0.3, at[2]}}});
    CHECK(w.good({{"do", "measure"}, {"what", "gap"}})["value"].get<double>() < 1e-6);
    const auto& elements = w.session.document().elements;
    int soft = 0;
    for (const auto& [id, element] : elements) {
        const auto response = w.session.responses().fittingOf(id);
        soft += response && response->quality.tetrahedra > 0 ? 1 : 0;
    }
    CHECK(soft == static_cast<int>(elements.size()));
}

TEST_CASE("make-soft: a shape without limbs gets handles") {
    Workbench w;
    useCapsules(w);
    const Json answer = w.good(makeSoft("ball"));
    CHECK(answer["bones"] == Json::array());
    CHECK(answer["cuts"] == Json::array());
    REQUIRE(answer["handles"].size() >= 2);
    CHECK(answer["pins"] == Json::array({"bottom"}));
    CHECK(answer["refused"] == Json::array());
    w.good({{"do", "drag"}, {"endpoint", "top"}, {"to", {0.1, 1.2, 0.0}}});
    CHECK(w.session.steps().front().name == "make-soft");
}

TEST_CASE("make-soft: takes a character that is there, once") {
    Workbench w;
    useCapsules(w);
    w.good({{"do", "import-character"}, {"path", "animal"}, {"name", "it"}});
    const Json answer = w.good({{"do", "make-soft"}, {"character", "it"}, {"precompute", false}});
    CHECK(answer["character"] == "it");
    const std::string made = w.content();
    CHECK(w.code({{"do", "make-soft"}, {"character", "it"}}) == "already-cut");
    CHECK(w.content() == made);
    // Another one with the same limbs gets names of its own.
    const Json second = w.good(makeSoft("large animal"));
    CHECK(second["refused"] == Json::array());
    CHECK(second["elements"].size() == answer["elements"].size());
}

TEST_CASE("make-soft: an element of its own becomes the whole character that an import would have made of its file, in one step") {
    Workbench w, imported;
    useCapsules(imported);
    const Json expected = imported.good(makeSoft("starfish"));
    w.session.services().import = [](const ImportRequest&, const Progress&) -> Result<ImportResult> {
        ImportResult result;
        result.bodies.push_back(importedBody("starfish", capsules::starfish()));
        return result;
    };
    w.good({{"do", "import-element"}, {"path", "starfish"}});
    w.good({{"do", "set"}, {"target", "starfish"}, {"property", "nu"}, {"value", 0.3}});
    const std::string before = w.content();
    const Json answer = w.good({{"do", "make-soft"}, {"element", "starfish"}, {"precompute", false}});
    CHECK(answer["character"] == "starfish");
    for (const char* key : {"cuts", "bones", "pins", "refused", "elements"}) CHECK_MESSAGE(answer[key] == expected[key], key);
    for (const auto& [id, element] : w.session.document().elements) CHECK(element->nu == 0.3);  // what was set for it stays
    CHECK(w.session.steps().back().name == "make-soft");
    CHECK(commandsOf(w).contains("make-character"));
    const std::string made = w.content();
    w.good({{"do", "undo"}});
    CHECK(w.content() == before);
    w.good({{"do", "redo"}});
    CHECK(w.content() == made);
    // By its piece the character is meant, which is soft already.
    CHECK(w.code({{"do", "make-soft"}, {"element", answer["elements"][0]}, {"precompute", false}}) == "already-cut");
    CHECK(w.code({{"do", "make-character"}, {"element", answer["elements"][0]}}) == "part-of-character");
    CHECK(w.code({{"do", "make-soft"}, {"element", "nobody"}}) == "no-such-element");
    CHECK(w.code({{"do", "make-soft"}, {"element", "starfish"}, {"unit", "cm"}}) == "bad-value");
    CHECK(w.code({{"do", "make-soft"}, {"element", "starfish"}, {"character", "starfish"}}) == "bad-value");
    CHECK(w.content() == made);

    // One that is moved by something already is refused, and stays an element.
    Workbench chain;
    chain.buildChain();
    const std::string as = chain.content();
    CHECK(chain.code({{"do", "make-soft"}, {"element", "A"}}) == "already-cut");
    CHECK(chain.content() == as);
}

TEST_CASE("make-soft: what fails leaves nothing behind") {
    Workbench w;
    useCapsules(w);
    const std::string empty = w.content();
    CHECK(w.code(makeSoft("nowhere")) == "file-not-found");
    CHECK(w.code({{"do", "make-soft"}}) == "missing-key");
    CHECK(w.code({{"do", "make-soft"}, {"character", "it"}}) == "no-such-character");
    CHECK(w.code({{"do", "make-soft"}, {"path", "animal"}, {"character", "it"}}) == "bad-value");
    Json line = makeSoft("animal");
    line["from"] = "skeleton";
    CHECK(w.code(line) == "no-skeleton");
    std::stop_source stop;
    stop.request_stop();
    const auto cancelled = w.session.execute(makeSoft("animal"), Progress({}, stop.get_token()));
    REQUIRE(!cancelled.has_value());
    CHECK(cancelled.error().code == kCancelled);
    CHECK(w.content() == empty);
    CHECK(w.session.steps().empty());
    CHECK(w.session.script().size() == 1);  // "new"
    w.good(makeSoft("animal"));
}

TEST_CASE("make-soft: a size that cannot be meant is told with the unit to import it with") {
    Workbench w;
    useCapsules(w);
    const Json answer = w.good({{"do", "import-character"}, {"path", "large animal"}, {"name", "it"}});
    const Json size = w.good({{"do", "propose"}, {"character", "it"}})["size"];
    CHECK(size["suggested_unit"] == "cm");
    CHECK(size["note"].get<std::string>().find("\"cm\"") != std::string::npos);
    CHECK(size["height"].get<double>() > 100.0);
}

TEST_CASE("prepared steps: a command that was executed on a copy is taken over as the same step, if the document is still the same") {
    Workbench w;
    useCapsules(w);
    w.good({{"do", "import-character"}, {"path", "animal"}, {"name", "it"}});
    const Json command{{"do", "make-soft"}, {"character", "it"}, {"precompute", false}};
    const auto prepared = [&](const Json& what) {
        Result<PreparedStep> made;
        std::thread([&, project = w.session.project()] { made = prepareStep(coreRegistry(), project, {what}, {}, {}); }).join();
        return made;
    };
    const std::string before = w.content();
    auto made = prepared(command);
    REQUIRE(made);
    CHECK(w.content() == before);
    CHECK(made->step.name == "make-soft");

    Workbench direct;
    useCapsules(direct);
    direct.good({{"do", "import-character"}, {"path", "animal"}, {"name", "it"}});
    Json expected = direct.good(command);

    // As the same step, with the same script, undone and redone as any other. Nothing is proposed again.
    int asked = 0;
    w.session.services().propose = [&](const CharacterSource& character, const ProposalRequest& request, const Progress& progress) {
        ++asked;
        return proposeFor(character, request, progress);
    };
    const auto step = std::make_shared<const PreparedStep>(std::move(*made));
    w.good({{"do", "rename"}, {"target", "it"}, {"name", "that"}});
    CHECK(!step->fits(w.session.document()));
    w.good({{"do", "undo"}});
    CHECK(step->fits(w.session.document()));
    int told = 0;
    w.session.setListener([&](const Session::Change& change) { told += change.structure(); });
    const auto taken = w.session.takePrepared(*step);
    REQUIRE(taken);
    Json answer = *taken;
    CHECK(asked == 0);
    CHECK(told == 1);
    for (Json* json : {&answer, &expected}) json->erase("seconds");
    CHECK(answer == expected);
    CHECK(w.content() == direct.content());
    CHECK(w.session.script() == direct.session.script());
    REQUIRE(w.session.steps().size() == 2);
    CHECK(w.session.steps()[1].name == "make-soft");
    CHECK(w.good({{"do", "measure"}, {"what", "position"}, {"endpoint", answer["bones"][0].get<std::string>() + "/end"}}) ==
          direct.good({{"do", "measure"}, {"what", "position"}, {"endpoint", answer["bones"][0].get<std::string>() + "/end"}}));
    const std::string after = w.content();
    w.good({{"do", "undo"}});
    CHECK(w.content() == before);
    w.good({{"do", "redo"}});
    CHECK(w.content() == after);

    // What fails there fails with the command's own reason.
    const auto refused = prepared({{"do", "make-soft"}, {"character", "nobody"}});
    REQUIRE(!refused);
    CHECK(refused.error().code == "no-such-character");
}

TEST_CASE("prepared steps: several commands are one step, as in a gesture; where one is refused, none was done") {
    Workbench w, direct;
    for (Workbench* of : {&w, &direct}) of->buildChain();
    const std::vector<Json> commands{{{"do", "remove-bone"}, {"name", "b"}}, {{"do", "remove-element"}, {"name", "B"}}};
    direct.session.beginGesture();
    for (const Json& command : commands) direct.good(command);
    direct.session.endGesture();
    const int before = w.session.position();
    const auto made = prepareStep(coreRegistry(), w.session.project(), commands, {}, {});
    REQUIRE(made);
    CHECK(w.session.position() == before);
    REQUIRE(w.session.takePrepared(*made));
    CHECK(w.session.position() == before + 1);
    CHECK(w.content() == direct.content());
    CHECK(w.session.script() == direct.session.script());
    CHECK(w.session.steps().back().name == direct.session.steps().back().name);
    w.good({{"do", "undo"}});
    CHECK(w.session.document().elementNamed("B"));
    CHECK(w.session.document().boneNamed("b"));

    const auto refused = prepareStep(coreRegistry(), w.session.project(), {commands[0], commands[0]}, {}, {});
    REQUIRE(!refused);
    CHECK(refused.error().code == "no-such-bone");
}

TEST_CASE("make-soft: takes what propose answered back, changed, dropped and added to") {
    Workbench w;
    useCapsules(w);
    w.good({{"do", "import-character"}, {"path", "animal"}, {"name", "it"}});
    Json proposal = w.good({{"do", "propose"}, {"character", "it"}});
    const Json unchanged = proposal;
    const Json command{{"do", "make-soft"}, {"character", "it"}, {"precompute", false}};
    const auto with = [&](const Json& changed) {
        Json line = command;
        line["proposal"] = changed;
        return line;
    };
    const std::string before = w.content();
    const Json same = w.good(with(unchanged));
    CHECK(same["refused"] == Json::array());
    CHECK(same["cuts"].size() == unchanged["cuts"].size());
    CHECK(same["pins"] == unchanged["pins"]);
    CHECK(same["proposal"]["cuts"] == unchanged["cuts"]);
    CHECK(same["proposal"]["bones"] == unchanged["bones"]);
    CHECK(w.session.steps().back().name == "make-soft");
    w.good({{"do", "undo"}});
    CHECK(w.content() == before);

    // Faults change nothing and are told.
    const auto faulty = [&](const std::function<void(Json&)>& spoil) {
        Json changed = unchanged;
        spoil(changed);
        return w.code(with(changed));
    };
    CHECK(faulty([](Json& p) { p["cuts"] = 3; }) == "bad-proposal");
    CHECK(faulty([](Json& p) { p["cuts"][0] = "neck"; }) == "bad-proposal");
    CHECK(faulty([](Json& p) { p["cuts"][0].erase("normal"); }) == "bad-proposal");
    CHECK(faulty([](Json& p) { p["cuts"][0]["normal"] = {0, 0, 0}; }) == "bad-proposal");
    CHECK(faulty([](Json& p) { p["bones"][1]["parent"] = "nobody"; }) == "bad-proposal");
    CHECK(faulty([](Json& p) { p["bones"][1]["piece"] = "nothing"; }) == "bad-proposal");
    CHECK(faulty([](Json& p) { p["bones"][1]["start"] = {0.125, 0, 0}; }) == "bad-proposal");
    CHECK(faulty([](Json& p) { p["pins"][0] = "nobody/end"; }) == "bad-proposal");
    CHECK(faulty([](Json& p) { p["pins"][0] = 7; }) == "bad-proposal");
    CHECK(faulty([](Json& p) { p["handles"].push_back({{"name", "h"}, {"point", {0, 0, 0}}}); }) == "bad-proposal");
    CHECK(faulty([](Json& p) { p["parts"].push_back({{"name", "hat"}}); }) == "no-such-part");
    Json both = with(unchanged);
    both["from"] = "shape";
    CHECK(w.code(both) == "bad-value");
    CHECK(w.content() == before);

    // Edited at random: one step, undone to the start and made again.
    for (const std::uint64_t seed : {1, 2}) {
        CAPTURE(seed);
        RandomEdits random(seed);
        Proposal edited = *proposalFrom(*w.session.document().characterNamed("it"), unchanged);
        for (int step = 0; step < 8; ++step)
            if (auto changed = random.edit(edited)) edited = std::move(*changed);
        const Json given = proposalJson(*w.session.document().characterNamed("it"), edited);
        const Json answer = w.good(with(given));
        CHECK(answer["proposal"]["cuts"] == given["cuts"]);
        CHECK(answer["proposal"]["bones"] == given["bones"]);
        CHECK(answer["elements"].size() == answer["cuts"].size() + 1);
        CHECK(answer["cuts"].size() + answer["refused"].size() >= given["cuts"].size());
        const std::string made = w.content();
        w.good({{"do", "undo"}});
        CHECK(w.content() == before);
        w.good({{"do", "redo"}});
        CHECK(w.content() == made);
        w.good({{"do", "undo"}});
    }
}
