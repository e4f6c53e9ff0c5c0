// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <map>
#include <stop_token>

#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

/// How well elements are solved does not matter here.
void solveAsIs(Workbench& w) {
    for (const auto& [id, element] : w.session.document().elements)
        w.good({{"do", "set"}, {"target", element->name}, {"property", "solver-mesh"}, {"value", "as-is"}});
}

}  // namespace

TEST_CASE("paper: the document's character in both models, and the document stays as it was") {
    Workbench w;
    w.buildChain();
    solveAsIs(w);
    const std::string before = w.content();
    const Json answer = w.good({{"do", "paper"}});
    CHECK(answer["character"] == "document");
    REQUIRE(answer["rows"].size() == 2);
    const Json &proposed = answer["rows"][0], &previous = answer["rows"][1];
    CHECK(proposed["model"] == "proposed");
    CHECK(previous["model"] == "previous");
    CHECK(proposed["vertices"] == previous["vertices"]);
    CHECK(proposed["columns"] == 2 * 12);
    CHECK(previous["columns"] == 2 * 54);  // two faces of nine vertices each
    // A cross-section of 8 vertices in 5 rows is free.
    CHECK(proposed["bytes"] == 2 * 4 * 3 * 40 * 12);
    CHECK(previous["bytes"] == 2 * 4 * (3 * 40 + 54) * 54);
    CHECK(answer["ratios"]["bytes"].get<double>() == doctest::Approx(174.0 * 54.0 / (120.0 * 12.0)));
    CHECK(answer["errors"].size() == 6);
    CHECK(answer["paper"][0]["vertices"] == 1978);
    CHECK(w.content() == before);
    CHECK(w.session.responses().store().count() == 0);
    CHECK(w.session.steps().size() == w.session.position());
}

TEST_CASE("paper: a character of the paper's size where the document is empty") {
    Workbench w;
    const auto path = Workbench::folder() / "表.md";
    const Json answer = w.good({{"do", "paper"}, {"path", path.string()}, {"seconds", 0}});
    CHECK(answer["character"] == "built-in caterpillar");
    CHECK(answer["rows"][0]["elements"] == 5);
    CHECK(answer["rows"][0]["vertices"] == 1978);
    CHECK(answer["ratios"]["bytes"].get<double>() > 15.0);
    const std::string bytes = readFile(path);
    CHECK(bytes.find("| vertices | 1978 | 1978 |") != std::string::npos);
    CHECK(bytes.find("28257") != std::string::npos);
}

TEST_CASE("paper: the caterpillar grows until frames are too slow, and the previous model diverges at long steps, the stiffer the sooner") {
    Workbench w;
    const auto plot = Workbench::folder() / "divergence.svg";
    const Json answer = w.good({{"do", "paper"}, {"seconds", 0.05}, {"svg", plot.string()}});
    const Json& grown = answer["measured_vertices_at_60_fps"];
    REQUIRE(grown.size() >= 2);
    for (const Json& g : grown) {
        REQUIRE_FALSE(g["points"].empty());
        CHECK(g["points"][0]["vertices"] == 1978);
    }
    // The stable step falls with the root of the stiffness: never longer for a stiffer one, and with a thousand times the stiffness strictly shorter.
    std::map<double, double> stable;
    for (const Json& d : answer["divergence"]) {
        double& longest = stable[d["shear_modulus"].get<double>()];
        if (!d["diverged"].get<bool>()) longest = std::max(longest, d["step"].get<double>());
    }
    REQUIRE(stable.size() == 4);
    CHECK(stable[3e3] >= stable[3e4]);
    CHECK(stable[3e4] >= stable[3e5]);
    CHECK(stable[3e5] >= stable[3e6]);
    CHECK(stable[3e3] > stable[3e6]);
    CHECK(readFile(plot).starts_with("<svg"));
    CHECK(readFile(Workbench::folder() / "divergence-growth.svg").starts_with("<svg"));
}

TEST_CASE("paper: writes the kind of file that the path ends in") {
    Workbench w;
    w.buildChain();
    solveAsIs(w);
    for (const char* suffix : {".json", ".csv"}) {
        const auto path = Workbench::folder() / (std::string("table") + suffix);
        const Json answer = w.good({{"do", "paper"}, {"path", path.string()}});
        const std::string bytes = readFile(path);
        if (std::string(suffix) == ".json")
            CHECK(Json::parse(bytes) == answer);
        else
            CHECK(bytes.starts_with("\"\",\"proposed\",\"previous\""));
    }
}

TEST_CASE("paper: says what is missing, before it works for minutes") {
    Workbench w;
    CHECK(w.code({{"do", "paper"}, {"path", ""}}) == "bad-value");
    CHECK(w.code({{"do", "paper"}, {"path", "table.txt"}}) == "unknown-format");
    CHECK(w.code({{"do", "paper"}, {"path", (Workbench::folder() / "nowhere" / "table.md").string()}}) == "not-writable");
    CHECK(w.code({{"do", "paper"}, {"svg", (Workbench::folder() / "nowhere" / "table.svg").string()}}) == "not-writable");
    w.good({{"do", "import-element"}, {"path", "bar0"}, {"name", "A"}});
    CHECK(w.code({{"do", "paper"}}) == "no-bone");
    w.good({{"do", "add-bone"}, {"name", "a"}, {"element", "A"}, {"from", {0, 0, 0}}, {"to", {0, 0, 3}}});
    CHECK(w.code({{"do", "paper"}}) == "no-face");
    w.addFace("A", "in", 0, -1);
    solveAsIs(w);
    std::stop_source stop;
    stop.request_stop();
    const auto answer = w.session.execute({{"do", "paper"}}, Progress({}, stop.get_token()));
    REQUIRE_FALSE(answer);
    CHECK(answer.error().code == kCancelled);
    CHECK(w.code({{"do", "paper"}}) == "ok");  // one face is enough
}

TEST_CASE("paper: an element without joint faces follows its bone in both models") {
    Workbench w;
    w.buildChain();
    solveAsIs(w);
    w.good({{"do", "import-element"}, {"path", "bar2"}, {"name", "hat"}});
    w.good({{"do", "add-bone"}, {"name", "c"}, {"element", "hat"}, {"from", "b/end"}, {"to", {0, 0, 9}}});
    const Json answer = w.good({{"do", "paper"}});
    CHECK(answer["rows"][0]["elements"] == 3);
    CHECK(answer["rows"][0]["columns"] == 24);
}
