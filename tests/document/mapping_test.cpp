// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>

#include "core/document/input_mapping.h"
#include "core/mesh/render_model.h"
#include "tests/document/tamper.h"
#include "tests/document/workbench.h"
#include "tests/support/thorough.h"

using namespace imomushi;

namespace {

/// A chain with a handle, and a man who can smile.
struct Mapped : Workbench {
    Mapped() {
        buildChain();
        good({{"do", "handle"}, {"element", "B"}, {"name", "tip"}, {"point", {0.5, 0.0, 4.5}}, {"radius", 0.4}});
        session.services().importCharacter = [](const ImportRequest& request, const Progress& progress) {
            auto file = characterFile(request, progress);
            MorphTarget smile;
            smile.name = "smile/left";
            smile.vertices = {0};
            smile.deltas.setConstant(1, 3, 0.01);
            file->renderModel.morphs.push_back(smile);
            return file;
        };
        good({{"do", "import-character"}, {"path", "ball"}, {"name", "man"}});
    }
    Json map(const std::string& channel, const std::string& target, Json more = Json::object()) {
        Json line{{"do", "map-input"}, {"source", "osc"}, {"channel", channel}, {"target", target}};
        line.update(more);
        return line;
    }
    [[nodiscard]] const InputMappings& table() const { return *session.document().mappings; }
};

}  // namespace

TEST_CASE("mappings: a row is made, changed and removed, and each is undone and redone like anything else") {
    Mapped w;
    CHECK(w.session.document().mappings == nullptr);
    CHECK(w.good(w.map("/x", "handle/tip/x", {{"in", {-1, 1}}, {"out", {0.5, -0.5}}, {"hertz", 2.0}}))["position"] == 0);
    CHECK(w.good(w.map("/smile", "morph/man/smile/left"))["mappings"] == 2);
    CHECK(w.good(w.map("/b", "bone/b/end/roll", {{"position", 0}}))["position"] == 0);
    REQUIRE(w.table().size() == 3);
    CHECK(w.table()[0].target == "bone/b/end/roll");
    // What is not said of a line that is there stays as it is.
    w.good(w.map("/x", "handle/tip/x", {{"mute", true}}));
    REQUIRE(w.table().size() == 3);
    CHECK(w.table()[1].row.muted);
    CHECK(w.table()[1].row.curve.outLow == 0.5);
    CHECK(w.table()[1].row.filter.hertz == 2.0);
    CHECK(w.good({{"do", "list"}})["mappings"].size() == 3);
    CHECK(w.good({{"do", "unmap-input"}, {"source", "osc"}, {"channel", "/x"}})["mappings"] == 2);
    w.good({{"do", "unmap-input"}});
    CHECK(w.session.document().mappings == nullptr);
    CHECK(w.code({{"do", "unmap-input"}}) == "not-mapped");
    const std::string none = w.content();
    w.good({{"do", "undo"}, {"count", 2}});
    CHECK(w.table().size() == 3);
    w.good({{"do", "undo"}, {"count", 4}});
    CHECK(w.session.document().mappings == nullptr);
    CHECK(w.content() == none);
    w.good({{"do", "redo"}, {"count", 4}});
    CHECK(w.table().size() == 3);
    CHECK(w.table()[1].row.muted);
}

TEST_CASE("mappings: a command that changes nothing leaves the table itself") {
    Mapped w;
    w.good(w.map("/x", "handle/tip/x"));
    const auto before = w.session.document().mappings;
    w.good(w.map("/x", "handle/tip/x"));
    w.good(w.map("/x", "handle/tip/x", {{"position", 0}, {"exponent", 1.0}}));
    w.good({{"do", "rename"}, {"target", "a"}, {"name", "c"}});
    CHECK(w.session.document().mappings == before);
}

TEST_CASE("mappings: what cannot be is refused and changes nothing") {
    Mapped w;
    CHECK(w.code(w.map("/x", "handle/nobody/x")) == "no-such-handle");
    CHECK(w.code(w.map("/x", "bone/nobody/end/x")) == "no-such-bone");
    CHECK(w.code(w.map("/x", "morph/nobody/smile")) == "no-such-character");
    CHECK(w.code(w.map("/x", "morph/man/frown")) == "no-such-target");
    for (const char* target : {"", "/", "tip", "handle", "handle/tip", "handle/tip/w", "handle//x", "bone/b/x", "bone/b/middle/x", "morph/man", "morph/man/", "take/one", "bone/b/end/turn-x", "bone/b/turn-w"}) CHECK(w.code(w.map("/x", target)) == "bad-value");
    CHECK(w.code(w.map("", "handle/tip/x")) == "bad-value");
    CHECK(w.code(w.map(std::string(200, 'x'), "handle/tip/x")) == "bad-value");
    for (const Json& in : {Json{1, 0}, Json{1, 1}, Json{-1e10, 0}}) CHECK(w.code(w.map("/x", "handle/tip/x", {{"in", in}})) == "bad-value");
    for (const Json& in : {Json{1}, Json{"a", 1}, Json{0, 1, 2}}) CHECK(w.code(w.map("/x", "handle/tip/x", {{"in", in}})) == "bad-type");
    CHECK(w.code(w.map("/x", "morph/man/smile/left", {{"out", {0, 1e7}}})) == "bad-value");
    CHECK(w.code(w.map("/x", "morph/man/smile/left", {{"in", {0, 1e8}}})) == "bad-value");
    const std::vector<std::pair<std::string, Json>> wrong = {{"component", 16}, {"component", -1}, {"exponent", 0}, {"dead_zone", 1}, {"hertz", -1}, {"reaction", 1e4}, {"after", 1e4}, {"silence", "loud"}, {"position", -1}};
    for (const auto& [key, value] : wrong)
        CHECK_MESSAGE(w.code(w.map("/x", "handle/tip/x", {{key, value}})) == "bad-value", key);
    CHECK(w.code(w.map("/x", "handle/tip/x", {{"mute", 1}})) == "bad-type");
    CHECK(w.code(w.map("/x", "handle/tip/x", {{"loud", 1}})) == "unknown-key");
    CHECK(w.session.document().mappings == nullptr);
}

TEST_CASE("mappings: rows follow what gets another name, and wait for what is removed") {
    Mapped w;
    w.good(w.map("/x", "handle/tip/x"));
    w.good(w.map("/b", "bone/b/start/y"));
    w.good(w.map("/s", "morph/man/smile/left"));
    w.good({{"do", "rename"}, {"target", "tip"}, {"name", "nose"}});
    w.good({{"do", "rename"}, {"target", "b"}, {"name", "leg"}});
    w.good({{"do", "rename"}, {"target", "man"}, {"name", "woman"}});
    w.good({{"do", "rename"}, {"target", "B/out"}, {"name", "x"}});
    CHECK(w.table()[0].target == "handle/nose/x");
    CHECK(w.table()[1].target == "bone/leg/start/y");
    CHECK(w.table()[2].target == "morph/woman/smile/left");
    w.good({{"do", "remove-handle"}, {"handle", "nose"}});
    const Json list = w.good({{"do", "list"}})["mappings"];
    CHECK(list[0].value("missing", false));
    CHECK(!list[1].contains("missing"));
    w.good({{"do", "undo"}, {"count", 5}});
    CHECK(w.table()[0].target == "handle/tip/x");
    CHECK(w.table()[2].target == "morph/man/smile/left");
}

TEST_CASE("mappings: a project and a file of mappings give the same rows back, to the bit") {
    Mapped w;
    w.good(w.map("/x", "handle/tip/x", {{"in", {-0.1, 1.0 / 3.0}}, {"out", {1e-7, -2}}, {"exponent", 1.7}, {"dead_zone", 0.1}, {"hertz", 1.5}, {"reaction", 0.01}, {"silence", "rest"}, {"after", 0.5}, {"spring", 2.5}, {"spring_damping", 0.3}, {"mirror", true}, {"mute", true}, {"solo", true}, {"component", 2}}));
    w.good(w.map("/ら", "morph/man/smile/left", {{"silence", "next"}}));
    const InputMappings made = w.table();
    const auto project = Workbench::folder() / "mapped.imomushi", file = Workbench::folder() / "mapped.json";
    w.good({{"do", "save"}, {"path", project.string()}});
    CHECK(w.good({{"do", "save-mappings"}, {"path", file.string()}})["mappings"] == 2);
    Workbench other;
    CHECK(other.good({{"do", "open"}, {"path", project.string()}})["mappings"].size() == 2);
    CHECK(*other.session.document().mappings == made);
    CHECK(other.session.document().unknown.settings.empty());
    CHECK(other.content() == w.content());
    // Where the targets are not there, rows wait for them.
    Workbench empty;
    CHECK(empty.good({{"do", "load-mappings"}, {"path", file.string()}}) == Json{{"loaded", 2}, {"mappings", 2}, {"missing", {"handle/tip/x", "morph/man/smile/left"}}});
    CHECK(*empty.session.document().mappings == made);
    // Lines that are there become those of the file; others stay before them.
    w.good(w.map("/x", "handle/tip/x", {{"mute", false}, {"component", 2}}));
    w.good(w.map("/first", "handle/tip/y", {{"position", 0}}));
    CHECK(w.good({{"do", "load-mappings"}, {"path", file.string()}})["missing"].empty());
    REQUIRE(w.table().size() == 3);
    CHECK(w.table()[1] == made[0]);
    CHECK(w.code({{"do", "load-mappings"}, {"path", "/nowhere/at all"}}) == "file-not-found");
    CHECK(w.code({{"do", "load-mappings"}, {"path", Workbench::folder().string()}}) == "not-readable");
    CHECK(w.code({{"do", "load-mappings"}, {"path", project.string()}}) == "not-mappings");
}

TEST_CASE("mappings: those that are suggested take limbs, handles and shapes that are there, in one step, and nothing where there is nothing") {
    Mapped w;
    const Json made = w.good({{"do", "suggest-mappings"}, {"protocol", "vmc"}});
    bool smiles = false;
    for (const Json& row : made["rows"]) smiles = smiles || (row["channel"] == "blend/smile/left" && row["target"] == "morph/man/smile/left");
    CHECK(smiles);
    CHECK(w.good({{"do", "suggest-mappings"}, {"protocol", "keys"}, {"source", "mine"}})["rows"][0]["source"] == "mine");
    w.good({{"do", "undo"}, {"count", 2}});
    CHECK(w.session.document().mappings == nullptr);
    CHECK(w.code({{"do", "suggest-mappings"}, {"protocol", "osc"}}) == "bad-value");
    Workbench empty;
    CHECK(empty.code({{"do", "suggest-mappings"}, {"protocol", "keys"}}) == "nothing-to-drive");
    CHECK(empty.session.document().mappings == nullptr);
}

TEST_CASE("mappings: a project whose mappings are broken is damaged") {
    Mapped w;
    w.good(w.map("/x", "handle/tip/x"));
    const auto path = Workbench::folder() / "broken.imomushi";
    for (const char* text : {"", "{}", "[1]", "[{\"source\":\"osc\"}]", "[{\"source\":\"osc\",\"channel\":\"/x\",\"target\":\"handle/tip/w\"}]"}) {
        w.good({{"do", "save"}, {"path", path.string()}});
        sql(path, std::string("UPDATE settings SET value='") + text + "' WHERE name='mappings'");
        sign(path);
        Workbench other;
        CHECK_MESSAGE(other.code({{"do", "open"}, {"path", path.string()}}) == "damaged", text);
    }
}

TEST_CASE("mappings: a table has a largest size") {
    Json list = Json::array();
    for (std::size_t i = 0; i <= InputMapping::kMost; ++i) list.push_back({{"source", "osc"}, {"channel", "/" + std::to_string(i)}, {"target", "handle/tip/x"}});
    const auto refused = mappingsFrom(list);
    REQUIRE(!refused);
    CHECK(refused.error().code == "too-many-mappings");
    list.erase(list.size() - 1);
    CHECK(mappingsFrom(list).has_value());
}

TEST_CASE("mappings: files with any bytes are either refused with a reason or sound rows") {
    InputMappings rows(2);
    rows[0].row.source = rows[1].row.source = "osc";
    rows[0].row.channel = "/x", rows[1].row.channel = "/y";
    rows[0].target = "handle/tip/x", rows[1].target = "morph/man/smile";
    const std::string good = mappingsText(rows);
    REQUIRE(mappingsFromText(good) == rows);
    std::mt19937 random(49);
    int kept = 0;
    for (int i = 0; i < repeats(20'000, 1'000'000); ++i) {
        std::string text = good;
        for (int n = 1 + static_cast<int>(random() % 3); n > 0; --n) {
            const std::size_t at = random() % text.size();
            switch (random() % 4) {
                case 0: text[at] = static_cast<char>(random()); break;
                case 1: text.erase(at, 1 + random() % 9); break;
                case 2: text.insert(at, good, random() % good.size(), 1 + random() % 30); break;
                default: text.insert(at, 1, "[]{}\",:0-e9"[random() % 11]); break;
            }
            if (text.empty()) text = "x";
        }
        const auto read = mappingsFromText(text);
        if (!read) {
            REQUIRE(read.error().code == "not-mappings");
            REQUIRE(!read.error().message.empty());
            continue;
        }
        ++kept;
        REQUIRE(mappingsFromText(mappingsText(*read)) == *read);  // sound: it is written and read again
        for (const InputMapping& m : *read) REQUIRE(std::isfinite(m.row.curve.at(0.3)));
    }
    CHECK(kept > 0);
    CHECK(!mappingsFromText(std::string(100'000, '[')).has_value());
    CHECK(!mappingsFromText(std::string(kMostMappingBytes + 1, ' ')).has_value());
}

TEST_CASE("mappings: settings of effects and triggers are targets; one that is solved anew, a vector without an axis and a take that is not there are refused") {
    Mapped w;
    w.good(w.map("/s", "effect/bone-dynamics/swing-hertz", {{"out", {1, 5}}}));
    w.good(w.map("/g", "effect/gravity/acceleration/y", {{"out", {0, -10}}}));
    w.good(w.map("/panic", "trigger/let-go"));
    const Document& document = w.session.document();
    CHECK(mappedTarget(document, "effect/gravity/acceleration/z")->value == 2);
    CHECK(mappedTarget(document, "trigger/let-go")->isTrigger());
    for (const auto& [target, code] : std::map<std::string, std::string>{{"effect/gravity/acceleration", "bad-value"}, {"effect/bone-dynamics/swing-hertz/x", "bad-value"}, {"effect/magic/x", "no-such-effect"}, {"effect/gravity/colour", "no-such-property"},
                                                                        {"effect/gravity", "bad-value"}, {"take/none/play", "no-such-take"}, {"take/none/rewind", "bad-value"}, {"trigger/fire", "bad-value"}, {"trigger/let-go/now", "bad-value"}})
        CHECK_MESSAGE(w.code(w.map("/x", target)) == code, target);
    // Of what is solved anew there is none that could be driven.
    for (std::size_t k = 0; k < kEffects; ++k)
        for (const EffectProperty& p : effectProperties(static_cast<EffectKind>(k)))
            if (p.rebuilds) CHECK(w.code(w.map("/x", "effect/" + std::string(effectName(static_cast<EffectKind>(k))) + "/" + std::string(p.name))) == "bad-value");
    // Rows follow a take that gets another name.
    w.good({{"do", "record"}, {"take", "wave"}, {"action", "start"}});
    w.good({{"do", "step"}, {"frames", 3}});
    w.good({{"do", "record"}, {"take", "wave"}, {"action", "stop"}});
    w.good(w.map("/play", "take/wave/play"));
    w.good({{"do", "rename-take"}, {"take", "wave"}, {"name", "bow"}});
    CHECK(w.table().back().target == "take/bow/play");
}
