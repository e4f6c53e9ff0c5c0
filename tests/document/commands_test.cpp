// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>

#include "tests/document/workbench.h"

using namespace imomushi;

TEST_CASE("command: what is not one is refused by its own code and changes nothing") {
    Workbench w;
    w.buildChain();
    const std::string before = w.content();
    const int steps = w.session.position();
    const double inf = std::numeric_limits<double>::infinity();
    CHECK(w.code(Json::array()) == "bad-command");
    CHECK(w.code({{"what", "new"}}) == "bad-command");
    CHECK(w.code({{"do", 3}}) == "bad-command");
    for (const char* later : {"no such thing", "Open", ""})
        CHECK(w.code({{"do", later}}) == "unknown-command");
    CHECK(w.code({{"do", "rest"}, {"extra", 1}}) == "unknown-key");
    CHECK(w.code({{"do", "drag"}, {"endpoint", "b/end"}}) == "missing-key");
    CHECK(w.code({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0, 0}}}) == "bad-type");
    CHECK(w.code({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0, 0, "z"}}}) == "bad-type");
    CHECK(w.code({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0, 0, inf}}}) == "not-finite");
    CHECK(w.code({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0, 0, 1e200}}}) == "bad-type");
    CHECK(w.code({{"do", "set"}, {"target", "A"}, {"property", "nu"}, {"value", std::nan("")}}) == "not-finite");
    CHECK(w.code({{"do", "set"}, {"target", "A"}, {"property", "nu"}, {"value", {{"a", {inf}}}}}) == "not-finite");
    CHECK(w.code({{"do", "step"}, {"frames", 1.5}}) == "bad-type");
    CHECK(w.code({{"do", "step"}, {"frames", 1e30}}) == "bad-type");
    CHECK(w.code({{"do", "step"}, {"frames", std::numeric_limits<std::int64_t>::min()}}) == "bad-type");
    CHECK(w.code({{"do", "step"}, {"frames", 0}}) == "bad-value");
    CHECK(w.code({{"do", "step"}, {"frames", 1}, {"dt", 0}}) == "bad-value");
    CHECK(w.code({{"do", "add-bone"}, {"name", "\xff"}, {"from", {0, 0, 0}}, {"to", {1, 0, 0}}}) == "bad-type");
    CHECK(w.content() == before);
    CHECK(w.session.position() == steps);
}

TEST_CASE("names: elements and bones share one name space, hold any Unicode, and reserved names are refused") {
    Workbench w;
    for (const char* bad : {"", "/", "a/b", "character", "gravity", "previous-model", "bone-dynamics"})
        CHECK(w.code({{"do", "import-element"}, {"path", "bar0"}, {"name", bad}}) == "bad-name");
    for (const char* good : {"芋虫", "🐛", "a\u0301", "two words", "a\nb", "-", "ñ.L"}) {
        w.good({{"do", "import-element"}, {"path", "bar0"}, {"name", good}});
        CHECK(w.code({{"do", "import-element"}, {"path", "bar0"}, {"name", good}}) == "name-taken");
        CHECK(w.code({{"do", "add-bone"}, {"name", good}, {"from", {0, 0, 0}}, {"to", {1, 0, 0}}}) == "name-taken");
        w.addFace(good, "面", 0, -1);
    }
    w.good({{"do", "add-bone"}, {"name", "骨"}, {"from", "芋虫/面"}, {"to", {0, 0, 1}}});
    CHECK(w.code({{"do", "import-element"}, {"path", "bar0"}, {"name", "骨"}}) == "name-taken");
    w.good({{"do", "rename"}, {"target", "骨"}, {"name", "ほね"}});
    w.good({{"do", "rename"}, {"target", "芋虫/面"}, {"name", "顔"}});
    CHECK(w.good({{"do", "list"}})["bones"][0]["start"] == "芋虫/顔");
}

TEST_CASE("import-element: bodies without a name of their own get free names, open ones are refused or left out and told") {
    Workbench w;
    const Json pair = w.good({{"do", "import-element"}, {"path", "pair"}});
    CHECK(pair["elements"][0]["name"] == "one");
    CHECK(pair["elements"][1]["name"] == "one 2");
    CHECK(pair["elements"][0]["volume"].get<double>() == doctest::Approx(3.0).epsilon(1e-12));
    CHECK(pair["elements"][0]["size"] == Json({1.0, 1.0, 3.0}));
    CHECK(w.code({{"do", "import-element"}, {"path", "open"}}) == "open");
    const Json half = w.good({{"do", "import-element"}, {"path", "half"}, {"name", "half"}});
    CHECK(half["elements"].size() == 1);
    CHECK(half["issues"][0]["code"] == "left-out");
    CHECK(w.code({{"do", "import-element"}, {"path", "nothing"}}) == "file-not-found");
    CHECK(w.code({{"do", "import-element"}, {"path", "bar0"}, {"unit", "inch"}}) == "bad-value");
    CHECK(w.code({{"do", "import-element"}, {"path", "bar0"}, {"up", "x"}}) == "bad-value");
}

TEST_CASE("add-joint-face: by plane or by vertices the same face, and faces keep apart") {
    Workbench w;
    w.good({{"do", "import-element"}, {"path", "bar0"}, {"name", "A"}});
    const Json byPlane = w.addFace("A", "top", 3, 1e-3);
    CHECK(byPlane["vertices"] == 9);
    CHECK(byPlane["frame"]["z"] == Json({0.0, 0.0, 1.0}));
    CHECK(byPlane["frame"]["x"] == Json({1.0, 0.0, 0.0}));
    CHECK(byPlane["planarity_error"].get<double>() <= 1e-15);
    CHECK(w.code({{"do", "add-joint-face"}, {"element", "A"}, {"name", "again"}, {"plane", {{"origin", {0, 0, 3}}, {"normal", {0, 0, 1}}}}}) == "shared-rim");
    CHECK(w.code({{"do", "add-joint-face"}, {"element", "A"}, {"name", "side"}, {"plane", {{"origin", {0.5, 0, 0}}, {"normal", {1, 0, 0}}}}}) == "shared-rim");
    CHECK(w.code({{"do", "add-joint-face"}, {"element", "A"}, {"name", "top"}, {"plane", {{"origin", {0, 0, 0}}, {"normal", {0, 0, -1}}}}}) == "name-taken");
    CHECK(w.code({{"do", "add-joint-face"}, {"element", "A"}, {"name", "x"}, {"plane", {{"origin", {0, 0, 9}}, {"normal", {0, 0, 1}}}}}) == "no-patch");
    CHECK(w.code({{"do", "add-joint-face"}, {"element", "A"}, {"name", "x"}, {"plane", {{"origin", {0, 0, 3}}, {"normal", {0, 0, 0}}}}}) == "bad-value");
    CHECK(w.code({{"do", "add-joint-face"}, {"element", "A"}, {"name", "x"}, {"plane", {{"origin", {0, 0, 3}}}}}) == "missing-key");
    CHECK(w.code({{"do", "add-joint-face"}, {"element", "A"}, {"name", "x"}, {"plane", {{"origin", {0, 0, 3}}, {"normal", {0, 0, 1}}, {"o", 1}}}}) == "unknown-key");
    CHECK(w.code({{"do", "add-joint-face"}, {"element", "A"}, {"name", "x"}}) == "missing-key");
    CHECK(w.code({{"do", "add-joint-face"}, {"element", "A"}, {"name", "x"}, {"vertices", {0, 1, 100000}}}) == "bad-index");
    CHECK(w.code({{"do", "add-joint-face"}, {"element", "A"}, {"name", "x"}, {"vertices", {0, -1}}}) == "bad-index");
    CHECK(w.code({{"do", "add-joint-face"}, {"element", "A"}, {"name", "x"}, {"vertices", {0, 0.5}}}) == "bad-index");
    const Json indices = byPlane["indices"];
    w.good({{"do", "remove-joint-face"}, {"face", "A/top"}});
    const Json byVertices = w.good({{"do", "add-joint-face"}, {"element", "A"}, {"name", "top"}, {"vertices", indices}});
    CHECK(byVertices["indices"] == indices);
    CHECK(byVertices["frame"] == byPlane["frame"]);
}

TEST_CASE("edit-joint-face: a face grows by rings and gives them back, takes named vertices, keeps its name, and undo brings it back") {
    Workbench w;
    w.good({{"do", "import-element"}, {"path", "coarse0"}, {"name", "A"}});
    const Json made = w.addFace("A", "top", 3, 1e-3);
    REQUIRE(made["vertices"] == 16);
    const std::string before = w.content();
    const auto edit = [](const char* key, Json value) { return Json{{"do", "edit-joint-face"}, {"face", "A/top"}, {key, std::move(value)}}; };

    // One ring more is the 12 vertices about the sides, one less the 4 in the middle.
    const Json grown = w.good(edit("grow", 1));
    CHECK(grown["vertices"] == 28);
    CHECK(std::includes(grown["indices"].begin(), grown["indices"].end(), made["indices"].begin(), made["indices"].end()));
    CHECK(w.session.document().elementNamed("A")->faces.at(0).name == "top");
    w.good({{"do", "undo"}});
    CHECK(w.content() == before);
    w.good({{"do", "redo"}});
    CHECK(w.good(edit("grow", -1))["indices"] == made["indices"]);
    CHECK(w.content() == before);
    const Json small = w.good(edit("grow", -1));
    CHECK(small["vertices"] == 4);
    CHECK(small["area"].get<double>() == doctest::Approx(1.0 / 9.0));
    CHECK(w.code(edit("grow", -1)) == "nothing-left");
    CHECK(w.good(edit("vertices", made["indices"]))["frame"] == made["frame"]);

    CHECK(w.code(edit("grow", 0)) == "bad-value");
    CHECK(w.code(edit("grow", 0.5)) == "bad-type");
    CHECK(w.code(edit("grow", 100)) == "not-planar");
    CHECK(w.code(edit("vertices", {0, 1, 100000})) == "bad-index");
    CHECK(w.code(edit("vertices", Json::array())) == "no-patch");
    CHECK(w.code({{"do", "edit-joint-face"}, {"face", "A/top"}}) == "missing-key");
    CHECK(w.code({{"do", "edit-joint-face"}, {"face", "A/top"}, {"grow", 1}, {"vertices", made["indices"]}}) == "missing-key");
    CHECK(w.code({{"do", "edit-joint-face"}, {"face", "A/top"}, {"grow", 1}, {"tolerance", 0.1}}) == "unknown-key");
    CHECK(w.content() == before);
}

TEST_CASE("edit-joint-face: it takes no vertex of another face, and a handle or a joined face stays as it is") {
    Workbench w;
    w.buildChain();
    CHECK(w.code({{"do", "edit-joint-face"}, {"face", "A/out"}, {"grow", 1}}) == "face-fixed");
    w.good({{"do", "unjoin"}, {"face", "A/out"}});
    CHECK(w.good({{"do", "edit-joint-face"}, {"face", "A/out"}, {"grow", 1}})["vertices"].get<int>() > 9);
    const Json other = w.session.document().elementNamed("A")->faces.at(0).vertices;
    REQUIRE(w.session.document().elementNamed("A")->faces.at(0).name == "in");
    Json both = w.session.document().elementNamed("A")->faces.at(1).vertices;
    both.push_back(other.at(0));
    CHECK(w.code({{"do", "edit-joint-face"}, {"face", "A/out"}, {"vertices", other}}) == "shared-rim");
    CHECK(w.code({{"do", "edit-joint-face"}, {"face", "A/out"}, {"vertices", both}}) == "not-connected");
    w.good({{"do", "handle"}, {"element", "B"}, {"point", {0.5, 0, 4.5}}, {"radius", 0.3}, {"name", "grip"}});
    CHECK(w.code({{"do", "edit-joint-face"}, {"face", "B/grip"}, {"grow", 1}}) == "face-fixed");
}

TEST_CASE("join: equal faces are welded, unequal ones share one joint, a gap is refused, and nothing moves") {
    Workbench w;
    w.buildChain();
    CHECK(w.code({{"do", "join"}, {"a", "A/out"}, {"b", "B/in"}}) == "already-joined");
    CHECK(w.code({{"do", "join"}, {"a", "A/out"}, {"b", "A/in"}}) == "same-element");
    CHECK(w.code({{"do", "join"}, {"a", "A/in"}, {"b", "B/out"}}) == "gap-too-large");
    CHECK(w.code({{"do", "join"}, {"a", "A/none"}, {"b", "B/out"}}) == "no-such-face");
    CHECK(w.code({{"do", "join"}, {"a", "N/none"}, {"b", "B/out"}}) == "no-such-element");
    w.good({{"do", "unjoin"}, {"face", "A/out"}});
    CHECK(w.session.document().joints.empty());
    const Json joined = w.good({{"do", "join"}, {"a", "A/out"}, {"b", "B/in"}});
    CHECK(joined["welded"] == 9);
    CHECK(joined["largest_gap"] == 0.0);
    w.good({{"do", "import-element"}, {"path", "coarse2"}, {"name", "C"}});
    w.addFace("C", "in", 6, -1);
    const Json unequal = w.good({{"do", "join"}, {"a", "B/out"}, {"b", "C/in"}});
    CHECK(unequal["welded"] == 4);  // the corners alone
    CHECK(unequal["largest_gap"].get<double>() <= 1e-15);
    CHECK(w.good({{"do", "measure"}, {"what", "gap"}})["value"].get<double>() <= 1e-15);
}

TEST_CASE("add-bone: endpoints at joined faces are one point, parents and elements are found, and no loop can be built") {
    Workbench w;
    w.buildChain();
    CHECK(w.session.pointIndex({w.session.document().boneNamed("a")->id, true}) ==
          w.session.pointIndex({w.session.document().boneNamed("b")->id, false}));
    const Json bones = w.good({{"do", "list"}})["bones"];
    CHECK(bones[0]["parent"].is_null());
    CHECK(bones[1]["parent"] == "a");
    CHECK(bones[0]["element"] == "A");
    CHECK(bones[1]["element"] == "B");
    CHECK(w.code({{"do", "add-bone"}, {"name", "c"}, {"from", "A/in"}, {"to", "B/out"}}) == "bone-loop");
    CHECK(w.code({{"do", "add-bone"}, {"name", "c"}, {"from", "A/out"}, {"to", "B/in"}}) == "zero-length");
    CHECK(w.code({{"do", "add-bone"}, {"name", "c"}, {"from", {1, 2, 3}}, {"to", {1, 2, 3}}}) == "zero-length");
    CHECK(w.code({{"do", "add-bone"}, {"name", "c"}, {"from", "b/middle"}, {"to", {1, 2, 3}}}) == "bad-value");
    CHECK(w.code({{"do", "add-bone"}, {"name", "c"}, {"from", "z/end"}, {"to", {1, 2, 3}}}) == "no-such-place");
    CHECK(w.code({{"do", "add-bone"}, {"name", "c"}, {"from", true}, {"to", {1, 2, 3}}}) == "bad-type");
    CHECK(w.code({{"do", "add-bone"}, {"name", "c"}, {"from", "b/end"}, {"to", {0, 0, 9}}, {"parent", "a"}}) == "bad-parent");
    CHECK(w.code({{"do", "add-bone"}, {"name", "c"}, {"from", "b/end"}, {"to", {0, 0, 9}}, {"parent", "q"}}) == "no-such-bone");
    w.good({{"do", "add-bone"}, {"name", "c"}, {"from", "b/end"}, {"to", {0, 0, 9}}, {"parent", "b"}, {"roll", 0.5}});
    CHECK(w.code({{"do", "edit-bone"}, {"name", "b"}, {"to", "c/start"}}) == "bad-place");
    CHECK(w.code({{"do", "edit-bone"}, {"name", "b"}, {"parent", "c"}}) == "bad-parent");  // c hangs on it
    w.good({{"do", "remove-bone"}, {"name", "b"}});
    CHECK(w.good({{"do", "list"}})["bones"][1]["parent"].is_null());
    CHECK(w.good({{"do", "list"}})["bones"][1]["start"] == "B/out");
}

TEST_CASE("add-bone: a point at the centroid of a face, and points typed twice, are one joint point") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "add-bone"}, {"name", "c"}, {"from", {0, 0, 6}}, {"to", {0, 0, 8}}});
    w.good({{"do", "add-bone"}, {"name", "d"}, {"from", {0, 0, 8}}, {"to", {1, 0, 8}}});
    const auto& document = w.session.document();
    CHECK(w.session.pointIndex({document.boneNamed("c")->id, false}) == w.session.pointIndex({document.boneNamed("b")->id, true}));
    CHECK(w.session.pointIndex({document.boneNamed("d")->id, false}) == w.session.pointIndex({document.boneNamed("c")->id, true}));
    CHECK(w.good({{"do", "list"}})["bones"][3]["parent"] == "c");
}

TEST_CASE("set: every property is checked and what is not available is said") {
    Workbench w;
    w.buildChain();
    const auto set = [&](const char* target, const char* property, const Json& value) {
        return w.code({{"do", "set"}, {"target", target}, {"property", property}, {"value", value}});
    };
    CHECK(set("A", "nu", 0.3) == "ok");
    CHECK(set("A", "nu", 0.5) == "ok");
    CHECK(set("A", "nu", 0.51) == "bad-value");
    CHECK(set("A", "nu", -0.1) == "bad-value");
    CHECK(set("A", "nu", "soft") == "bad-type");
    CHECK(set("A", "stiffness", 0) == "bad-value");
    CHECK(set("A", "density", 900) == "ok");
    CHECK(set("A", "color", "#ff8000") == "ok");
    CHECK(set("A", "color", "red") == "bad-value");
    CHECK(set("A", "color", "#ff80g0") == "bad-value");
    CHECK(set("A", "visible", false) == "ok");
    CHECK(set("A", "visible", 1) == "bad-type");
    CHECK(set("A", "joint-planes", "element") == "ok");
    CHECK(set("A", "joint-planes", "none") == "bad-value");
    CHECK(set("A", "solver-mesh", "as-is") == "ok");
    CHECK(set("A", "solver-mesh", "refined:2000") == "ok");
    CHECK(set("A", "solver-mesh", "decimated:200") == "ok");
    CHECK(set("A", "solver-mesh", "refined:2") == "bad-value");
    CHECK(set("A", "solver-mesh", "best") == "ok");
    CHECK(set("A", "solver-mesh", "odd") == "bad-value");
    CHECK(set("A", "mass", 1) == "no-such-property");
    CHECK(set("a", "min-stretch", 0.9) == "ok");
    CHECK(set("a", "max-stretch", 0.5) == "bad-value");
    CHECK(set("a", "max-bend", 0.5) == "ok");
    CHECK(set("a", "max-bend", 3.2) == "bad-value");
    CHECK(set("a", "max-twist", 10) == "ok");
    CHECK(set("a", "max-twist", -1) == "bad-value");
    CHECK(set("a", "stiffness", 100) == "ok");
    CHECK(set("a", "stiffness", 0) == "bad-value");
    CHECK(set("a", "weight", 2) == "ok");
    CHECK(set("a", "weight", "heavy") == "bad-type");
    CHECK(set("a", "nu", 0.3) == "no-such-property");
    CHECK(set("character", "basis", "paper") == "ok");
    CHECK(set("character", "basis", "modes:12") == "ok");
    CHECK(set("character", "basis", "modes:0") == "bad-value");
    CHECK(set("character", "basis", "full") == "ok");
    CHECK(set("character", "basis", "odd") == "bad-value");
    CHECK(set("character", "format", "half") == "ok");
    CHECK(set("character", "format", "int16") == "ok");
    CHECK(set("character", "format", "int4") == "bad-value");
    CHECK(set("character", "threads", 2) == "ok");
    CHECK(set("character", "threads", 1.5) == "bad-value");
    CHECK(set("character", "rate", 120) == "ok");
    CHECK(set("character", "rate", 90) == "bad-value");
    CHECK(set("gravity", "x", 1) == "no-such-property");
    CHECK(set("nothing", "x", 1) == "no-such-target");
    CHECK(w.session.document().elementNamed("A")->color.x() == 1.0f);
}

TEST_CASE("precompute: what is known is not solved again, and undo switches to what is known") {
    Workbench w;
    w.buildChain();
    const PartId a = w.session.document().elementNamed("A")->id;
    CHECK(w.session.responseState(a) == Session::ResponseState::None);
    const Json first = w.good({{"do", "precompute"}});
    CHECK(first["elements"].size() == 2);
    CHECK(first["elements"][0]["cached"] == false);
    CHECK(first["elements"][0]["columns"] == 18);
    CHECK(first["elements"][0]["residual"].get<double>() <= 1e-6);
    CHECK(w.good({{"do", "precompute"}})["elements"][1]["cached"] == true);
    CHECK(w.session.responseState(a) == Session::ResponseState::Fresh);
    w.good({{"do", "set"}, {"target", "A"}, {"property", "nu"}, {"value", 0.3}});
    CHECK(w.session.responseState(a) == Session::ResponseState::Stale);
    CHECK(w.good({{"do", "list"}})["elements"][0]["state"] == "stale");
    CHECK(w.session.character()->input().elements[0].response != nullptr);  // the last one still fits
    w.good({{"do", "undo"}});
    CHECK(w.session.responseState(a) == Session::ResponseState::Fresh);
    w.good({{"do", "set"}, {"target", "character"}, {"property", "basis"}, {"value", "paper"}});
    CHECK(w.session.character()->input().elements[0].response == nullptr);  // other columns
    CHECK(w.code({{"do", "measure"}, {"what", "stiffness"}, {"element", "A"}}) == "not-precomputed");
    w.good({{"do", "undo"}});
    const Json stiffness = w.good({{"do", "measure"}, {"what", "stiffness"}, {"element", "A"}});
    CHECK(stiffness["value"].size() == 18);
    CHECK(stiffness["faces"][1]["first_column"] == 9);
    CHECK(w.code({{"do", "precompute"}, {"elements", {"nobody"}}}) == "no-such-element");
    CHECK(w.code({{"do", "precompute"}, {"elements", {3}}}) == "bad-type");
}

TEST_CASE("precompute: of congruent elements the first is solved and the others take its response over, whichever is asked for") {
    Workbench w;
    w.buildChain("default");
    const Json estimate = w.good({{"do", "estimate"}});
    CHECK(!estimate["elements"][0].contains("shared"));
    CHECK(estimate["elements"][1]["shared"] == "A");
    CHECK(estimate["elements"][1]["columns"] == 18);
    CHECK(estimate["elements"][1]["seconds"].get<double>() < 0.01 * estimate["elements"][0]["seconds"].get<double>());
    // B takes over A's response, so that A is estimated with it, as its memory shows; times are of a machine whose rates are measured again in between.
    const Json alone = w.good({{"do", "estimate"}, {"elements", {"B"}}});
    REQUIRE(alone["elements"].size() == 1);
    CHECK(alone["elements"][0]["bytes"].get<double>() < estimate["elements"][0]["bytes"].get<double>());
    CHECK(alone["peak_bytes"] == estimate["elements"][0]["bytes"]);
    CHECK(alone["seconds"].get<double>() > alone["elements"][0]["seconds"].get<double>());

    const Json one = w.good({{"do", "precompute"}, {"elements", {"B"}}});
    CHECK(one["elements"][0]["shared"] == "A");
    CHECK(one["elements"][0]["cached"] == false);
    const Json both = w.good({{"do", "precompute"}});
    CHECK(both["elements"][0]["cached"] == true);
    CHECK(both["elements"][1]["shared"] == "A");
    CHECK(both["elements"][1]["error"] == both["elements"][0]["error"]);
    CHECK(w.good({{"do", "measure"}, {"what", "gap"}})["value"].get<double>() <= 1e-9);

    // The same bytes in the other order, and by another way to the same document.
    const auto responses = [](Workbench& bench) {
        std::vector<Eigen::MatrixXd> all;
        for (const auto& [id, element] : bench.session.document().elements)
            all.push_back(bench.session.responses().store().find(responseKey(bench.session.responseInput(id)))->response);
        return all;
    };
    Workbench other;
    other.buildChain("default");
    other.good({{"do", "precompute"}, {"elements", {"A"}}});
    other.good({{"do", "set"}, {"target", "B"}, {"property", "nu"}, {"value", 0.3}});
    CHECK(!other.good({{"do", "estimate"}})["elements"][1].contains("shared"));
    other.good({{"do", "undo"}});
    other.good({{"do", "precompute"}, {"elements", {"B"}}});
    CHECK(responses(other) == responses(w));
}

TEST_CASE("precompute: cancelled it leaves everything as it was") {
    Workbench w;
    w.buildChain();
    std::stop_source stop;
    stop.request_stop();
    const auto answer = w.session.execute({{"do", "precompute"}}, Progress({}, stop.get_token()));
    REQUIRE(!answer);
    CHECK(answer.error().code == kCancelled);
    CHECK(w.session.responses().store().count() == 0);
}

TEST_CASE("drag: the endpoint goes where it is told, stays held, and comes back by undo, rest and release") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    const Json rest = w.good({{"do", "measure"}, {"what", "position"}, {"endpoint", "b/end"}})["value"];
    const Json dragged = w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.0, 0.5, 5.0}}});
    CHECK(dragged["settled"] == true);
    CHECK(dragged["distance"].get<double>() <= 1e-5);
    CHECK(w.good({{"do", "measure"}, {"what", "gap"}})["value"].get<double>() <= 1e-9);
    CHECK(w.good({{"do", "step"}, {"frames", 3}})["finite"] == true);
    CHECK(w.session.document().goals.size() == 2);
    w.good({{"do", "undo"}});
    CHECK(w.session.document().goals.size() == 1);
    CHECK(w.good({{"do", "measure"}, {"what", "position"}, {"endpoint", "b/end"}})["value"] == rest);
    w.good({{"do", "redo"}});
    const Json posed = w.good({{"do", "measure"}, {"what", "position"}, {"endpoint", "b/end"}})["value"];
    CHECK(posed != rest);
    CHECK(w.good({{"do", "release"}})["released"] == 2);
    CHECK(w.good({{"do", "measure"}, {"what", "position"}, {"endpoint", "b/end"}})["value"] == posed);
    CHECK(w.code({{"do", "release"}, {"endpoint", "b/end"}}) == "not-held");
    w.good({{"do", "rest"}});
    CHECK(w.good({{"do", "measure"}, {"what", "position"}, {"endpoint", "b/end"}})["value"] == rest);
    CHECK(w.session.document().goals.size() == 1);  // the pin
    w.good({{"do", "unpin"}, {"endpoint", "a/start"}});
    CHECK(w.code({{"do", "unpin"}, {"endpoint", "a/start"}}) == "not-pinned");
}

TEST_CASE("drag: a joint point has one target, whatever bone it is named after") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "drag"}, {"endpoint", "a/end"}, {"to", {0.1, 0, 3}}});
    w.good({{"do", "drag"}, {"endpoint", "b/start"}, {"to", {0.2, 0, 3}}});
    CHECK(w.session.document().goals.size() == 1);
    w.good({{"do", "pin"}, {"endpoint", "a/end"}});
    CHECK(w.session.document().goals.size() == 1);
    w.good({{"do", "unpin"}, {"endpoint", "b/start"}});
    CHECK(w.session.document().goals.empty());
}

TEST_CASE("pin: the bone that is named keeps its direction, and keeps it while the pin is dragged and let go") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1, 0, 5}}});
    w.good({{"do", "pin"}, {"endpoint", "a/end"}});
    const Document& document = w.session.document();
    const EndpointRef end = *document.endpoint("a/end"), start = *document.endpoint("b/start");
    w.good({{"do", "pin"}, {"endpoint", "b/start"}, {"orientation", true}});
    REQUIRE(document.goals.contains(start));
    CHECK(!document.goals.contains(end));
    const auto turn = document.goals.at(start).rotation;
    REQUIRE(turn);
    CHECK(*turn != std::array{0.0, 0.0, 0.0, 1.0});
    for (const char* name : {"b/start", "a/end"}) {
        w.good({{"do", "drag"}, {"endpoint", name}, {"to", {0.1, 0, 3}}});
        REQUIRE(document.goals.contains(start));
        CHECK(document.goals.at(start).rotation == turn);
        CHECK(document.goals.at(start).pinned);
        CHECK(document.goals.at(start).target == Vec3(0.1, 0, 3));
        w.good({{"do", "release"}, {"endpoint", name}});
        CHECK(document.goals.at(start).rotation == turn);
        w.good({{"do", "undo"}});
        w.good({{"do", "undo"}});
    }
    w.good({{"do", "pin"}, {"endpoint", "a/end"}, {"orientation", false}});
    CHECK(!document.goals.at(start).rotation);
}

TEST_CASE("drag: far out of reach it comes as near as the bones stretch and says so") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    const Json far = w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1e6, -1e6, 0}}});
    CHECK(far["distance"].get<double>() > 1e5);
    CHECK(!far["warnings"].empty());
    const Json stepped = w.good({{"do", "step"}, {"frames", 50}});
    CHECK(stepped["finite"] == true);
    CHECK(w.good({{"do", "measure"}, {"what", "length"}, {"bone", "a"}})["value"].get<double>() <= 2.0 * 3.0 * 1.01);
}

TEST_CASE("drag with seconds: the endpoint glides while frames are stepped and arrives on time") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0, 0, 6.6}}, {"seconds", 0.5}});
    const auto height = [&] { return w.good({{"do", "measure"}, {"what", "position"}, {"endpoint", "b/end"}})["value"][2].get<double>(); };
    CHECK(height() == 6.0);
    w.good({{"do", "step"}, {"frames", 15}});
    CHECK(height() > 6.15);
    CHECK(height() < 6.45);
    w.good({{"do", "step"}, {"frames", 30}});
    CHECK(height() == doctest::Approx(6.6).epsilon(1e-4));
    w.good({{"do", "undo"}});
    CHECK(height() == 6.0);
}

TEST_CASE("deform-element: statics of one element, and write-mesh writes them until the character moves") {
    Workbench w;
    w.buildChain();
    const Json bend = {{"do", "deform-element"}, {"element", "A"}, {"faces", {{"out", {{"theta2", 0.2}}}}}};
    // What it needs is precomputed by itself, and only that element.
    const Json reduced = w.good(bend);
    const Json precomputed = w.good({{"do", "precompute"}});
    CHECK(precomputed["elements"][0]["cached"] == true);
    CHECK(precomputed["elements"][1]["cached"] == false);
    CHECK(reduced["columns"] == 18);
    CHECK(reduced["basis_error"].get<double>() <= 1e-12);
    const auto rest = (Workbench::folder() / "rest.obj").string(), deformed = (Workbench::folder() / "deformed.obj").string(),
               after = (Workbench::folder() / "after.obj").string(), full = (Workbench::folder() / "full.obj").string();
    w.good({{"do", "write-mesh"}, {"path", deformed}, {"element", "A"}});
    w.good({{"do", "write-mesh"}, {"path", rest}, {"element", "A"}, {"state", "rest"}});
    CHECK(readFile(deformed) != readFile(rest));
    CHECK(w.code({{"do", "drag"}, {"endpoint", "nobody/end"}, {"to", {0, 0, 0}}}) == "no-such-bone");
    w.good({{"do", "write-mesh"}, {"path", after}, {"element", "A"}});
    CHECK(readFile(after) == readFile(deformed));
    w.good({{"do", "step"}, {"frames", 1}});
    w.good({{"do", "write-mesh"}, {"path", after}, {"element", "A"}});
    CHECK(readFile(after) == readFile(rest));
    for (const char* model : {"full", "previous"}) {
        Json other = bend;
        other["model"] = model;
        const Json answer = w.good(other);
        // Eq. (5) lies in the span of the basis, so nothing is lost by reducing (up to the refinement of the solver).
        CHECK(answer["max_displacement"].get<double>() == doctest::Approx(reduced["max_displacement"].get<double>()).epsilon(1e-6));
    }
    const auto refused = [&](const Json& faces) { return w.code({{"do", "deform-element"}, {"element", "A"}, {"faces", faces}}); };
    CHECK(refused({{"none", Json::object()}}) == "no-such-face");
    CHECK(refused({{"out", {{"theta3", 1}}}}) == "unknown-key");
    CHECK(refused({{"out", {{"a", "x"}}}}) == "bad-type");
    CHECK(refused({{"out", {{"vertices", {{"0", {0, 0, 0}}}}}}}) == "bad-index");
    CHECK(refused({{"out", {{"vertices", {{"x", {0, 0, 0}}}}}}}) == "bad-index");
    CHECK(refused({{"out", {{"vertices", 3}}}}) == "bad-type");
    CHECK(refused({{"out", 3}}) == "bad-type");
    CHECK(w.code({{"do", "deform-element"}, {"element", "A"}, {"faces", Json::object()}, {"model", "odd"}}) == "bad-value");
}

TEST_CASE("deform-element: given vertices are projected onto the basis") {
    Workbench w;
    w.good({{"do", "import-element"}, {"path", "bar0"}, {"name", "A"}});
    const Json face = w.addFace("A", "out", 3, 1);
    w.addFace("A", "in", 0, -1);
    w.good({{"do", "precompute"}});
    Json shift = Json::object();
    for (const Json& v : face["indices"]) shift[std::to_string(v.get<int>())] = {0.0, 0.0, 0.1};
    const auto projected = w.good({{"do", "deform-element"}, {"element", "A"}, {"faces", {{"out", {{"vertices", shift}}}}}});
    CHECK(projected["basis_error"].get<double>() <= 1e-12);
    const auto same = w.good({{"do", "deform-element"}, {"element", "A"}, {"faces", {{"out", {{"dz", 0.1}}}}}});
    CHECK(projected["max_displacement"].get<double>() == doctest::Approx(same["max_displacement"].get<double>()).epsilon(1e-12));
    const auto one = w.good({{"do", "deform-element"}, {"element", "A"}, {"faces", {{"out", {{"vertices", {{std::to_string(face["indices"][0].get<int>()), {0, 0, 0.1}}}}}}}}});
    CHECK(one["basis_error"].get<double>() > 1e-3);  // one vertex alone is no motion of the basis
}

TEST_CASE("free ends: an element with one face leads its joint plane unless both sides have one face, which is warned of") {
    Workbench w;
    w.good({{"do", "import-element"}, {"path", "bar0"}, {"name", "A"}});
    w.good({{"do", "import-element"}, {"path", "bar1"}, {"name", "B"}});
    w.addFace("A", "out", 3, 1);
    w.addFace("B", "in", 3, -1);
    w.good({{"do", "join"}, {"a", "A/out"}, {"b", "B/in"}});
    w.good({{"do", "add-bone"}, {"name", "a"}, {"from", {0, 0, 0}}, {"to", "A/out"}});
    w.good({{"do", "add-bone"}, {"name", "b"}, {"from", "B/in"}, {"to", {0, 0, 6}}});
    CHECK(w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0, 1, 6}}})["warnings"].size() >= 1);
    CHECK(!w.session.character()->input().elements[0].leadsJointPlanes);
    w.addFace("B", "out", 6, 1);
    CHECK(w.session.character()->input().elements[0].leadsJointPlanes);
    CHECK(!w.session.character()->input().elements[1].leadsJointPlanes);
    CHECK(w.good({{"do", "step"}, {"frames", 1}})["warnings"].empty());
    w.good({{"do", "set"}, {"target", "A"}, {"property", "joint-planes"}, {"value", "bisector"}});
    CHECK(!w.session.character()->input().elements[0].leadsJointPlanes);
}

TEST_CASE("an empty document can be stepped, measured and saved") {
    Workbench w;
    CHECK(w.good({{"do", "step"}, {"frames", 2}})["finite"] == true);
    CHECK(w.good({{"do", "measure"}, {"what", "volume"}})["value"] == 0.0);
    CHECK(w.good({{"do", "measure"}, {"what", "gap"}})["value"] == 0.0);
    CHECK(w.good({{"do", "precompute"}})["elements"].empty());
    CHECK(w.code({{"do", "write-mesh"}, {"path", "x.obj"}}) == "no-element");
    w.good({{"do", "rest"}});
    w.good({{"do", "release"}});
    CHECK(w.session.character() == nullptr);
    w.good({{"do", "save"}, {"path", (Workbench::folder() / "empty.imomushi").string()}});
}

TEST_CASE("bones without elements can be posed") {
    Workbench w;
    w.good({{"do", "add-bone"}, {"name", "a"}, {"from", {0, 0, 0}}, {"to", {1, 0, 0}}});
    w.good({{"do", "add-bone"}, {"name", "b"}, {"from", "a/end"}, {"to", {2, 0, 0}}});
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    CHECK(w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.2, 1.2, 0}}})["distance"].get<double>() <= 1e-4);
}
