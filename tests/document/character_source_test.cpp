// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <random>
#include <set>

#include "core/base/clock.h"
#include "core/document/character_cuts.h"
#include "core/document/character_input.h"
#include "core/document/embed_model.h"
#include "core/mesh/connectivity.h"
#include "tests/document/tamper.h"
#include "tests/document/workbench.h"
#include "tests/support/obj.h"

using namespace imomushi;

namespace {

Json planeAt(double z, double normal = 1.0) { return {{"origin", {0, 0, z}}, {"normal", {0, 0, normal}}}; }
Json cutAt(const std::string& element, double z) { return {{"do", "cut"}, {"element", element}, {"plane", planeAt(z)}}; }

const Element& elementNamed(const Workbench& w, const std::string& name) {
    const Element* element = w.session.document().elementNamed(name);
    REQUIRE(element != nullptr);
    return *element;
}

double volumeOf(const Element& element) { return element.mesh->connectivity().facts().volume; }

/// The trunk as three elements "low", "middle", "high" with cuts "first" at z = 3.1 and "second" at 8.3, faces at its ends and a bone through each.
void buildTrunk(Workbench& w) {
    w.good({{"do", "import-character"}, {"path", "trunk"}, {"name", "worm"}});
    w.good({{"do", "rename"}, {"target", "worm body"}, {"name", "low"}});
    w.addFace("low", "in", 0, -1);
    w.addFace("low", "out", 12, 1);
    w.good({{"do", "cut"}, {"element", "low"}, {"plane", planeAt(3.1)}, {"names", {"low", "middle"}}, {"name", "first"}});
    w.good({{"do", "cut"}, {"element", "middle"}, {"plane", planeAt(8.3)}, {"names", {"middle", "high"}}, {"name", "second"}});
    for (const char* element : {"low", "middle", "high"}) w.good({{"do", "set"}, {"target", element}, {"property", "solver-mesh"}, {"value", "as-is"}});
    w.good({{"do", "add-bone"}, {"name", "a"}, {"from", "low/in"}, {"to", "low/first"}});
    w.good({{"do", "add-bone"}, {"name", "b"}, {"from", "a/end"}, {"to", "middle/second"}});
    w.good({{"do", "add-bone"}, {"name", "c"}, {"from", "b/end"}, {"to", "high/out"}});
}

std::string tempPath(const char* name) { return (Workbench::folder() / name).string(); }

}  // namespace

TEST_CASE("characters: a closed mesh is its own body, and its file's vertices come out again bit for bit") {
    Workbench w;
    const Json answer = w.good({{"do", "import-character"}, {"path", "ball"}, {"name", "ball"}});
    CHECK(answer["body"]["how"] == "exact");
    CHECK(answer["body"]["distance"]["largest"] == 0.0);
    CHECK(answer["body"]["volume_error"] == 0.0);
    CHECK(answer["skeleton"] == Json::array());
    CHECK(answer["elements"] == Json::array({"ball body"}));
    const TriangleMesh file = shapes::sphere(1.0, 3).mesh;
    CHECK(answer["parts"] == Json::array({{{"name", "ball"}, {"vertices", file.vertices.rows()}, {"part", "ball"}, {"mode", "auto"}}}));
    const Json listed = w.good({{"do", "list"}})["characters"];
    REQUIRE(listed.size() == 1);
    CHECK(listed[0] == answer["characters"][0]);
    CHECK(listed[0]["name"] == "ball");

    const auto path = tempPath("rest.obj");
    w.good({{"do", "write-mesh"}, {"path", path}, {"character", "ball"}, {"state", "rest"}});
    const TriangleMesh back = readObj(path);
    CHECK(back.vertices == file.vertices);
    CHECK(back.triangles == file.triangles);
    // Every render vertex is a vertex of the body, so nothing is embedded.
    const Document& document = w.session.document();
    const EmbeddedModel model = embedModel(document, *document.characters.begin()->second);
    CHECK(model.points == std::vector<std::shared_ptr<const EmbeddedPoints>>{nullptr});
}

TEST_CASE("characters: parts that overlap and meshes that are open get a body, too") {
    for (const char* name : {"two balls", "tube"}) {
        CAPTURE(name);
        Workbench w;
        const auto start = Clock::now();
        const Json answer = w.good({{"do", "import-character"}, {"path", name}});
        const double whole = secondsSince(start);
        CHECK(answer["body"]["how"] != "exact");
        CHECK(answer["body"]["distance"]["largest"].get<double>() < 0.25);  // what lies inside the other ball is up to a radius off
        CHECK(answer["body"]["seconds"].get<double>() > 0.0);
        CHECK(answer["body"]["seconds"].get<double>() < whole);  // making it is a part of the command
        const Element& body = *w.session.document().elements.begin()->second;
        CHECK(body.mesh->connectivity().facts().outward);
        const auto path = tempPath("rest.obj");
        w.good({{"do", "write-mesh"}, {"path", path}, {"character", w.good({{"do", "list"}})["characters"][0]["name"]}, {"state", "rest"}});
        CHECK(readObj(path).vertices == Workbench::characterFile({.path = name}, {})->renderModel.mesh.body.vertices);
        CHECK(w.good({{"do", "write-mesh"}, {"path", path}, {"character", w.good({{"do", "list"}})["characters"][0]["name"]}})["vertices"] ==
              Workbench::characterFile({.path = name}, {})->renderModel.mesh.body.vertices.rows());
        const Points rest = Workbench::characterFile({.path = name}, {})->renderModel.mesh.body.vertices;
        CHECK((readObj(path).vertices - rest).cwiseAbs().maxCoeff() < 1e-12);
    }
    Workbench w;
    const Json parts = w.good({{"do", "import-character"}, {"path", "two balls"}})["parts"];
    REQUIRE(parts.size() == 2);
    CHECK(parts[0]["vertices"] == parts[1]["vertices"]);
    CHECK(w.code({{"do", "import-character"}, {"path", "tube"}, {"body", "exact"}}) == "not-exact");
    CHECK(w.code({{"do", "import-character"}, {"path", "tube"}, {"body", "best"}}) == "bad-value");
    CHECK(w.code({{"do", "import-character"}, {"path", "tube"}, {"detail", 0.5}}) == "bad-value");
    for (const Json& bad : {Json{3}, Json{{{"from", {0, 0, 0}}, {"radius", 1}}}, Json{{{"from", {0, 0, 0}}, {"to", {0, 0}}, {"radius", 1}}}, Json{{{"from", {0, 0, 0}}, {"to", {0, 0, 1}}}}})
        CHECK(w.code({{"do", "import-character"}, {"path", "tube"}, {"links", bad}}) == "bad-type");
    for (const double radius : {-1.0, 0.0})
        CHECK(w.code({{"do", "import-character"}, {"path", "tube"}, {"links", {{{"from", {0, 0, 0}}, {"to", {0, 0, 1}}, {"radius", radius}}}}}) == "bad-value");
    CHECK(w.code({{"do", "import-character"}, {"path", "tube"}, {"body", "wrapped"}, {"links", Json::array()}}) == "bad-value");
    CHECK(w.code({{"do", "import-character"}, {"path", "nothing"}}) == "file-not-found");
    CHECK(w.good({{"do", "import-character"}, {"path", "ball"}, {"body", "wrapped"}, {"detail", 0.05}})["body"]["how"] == "wrapped");
}

TEST_CASE("cut: the piece behind stays the element, the one in front is new, and they are joined") {
    Workbench w;
    w.good({{"do", "import-character"}, {"path", "trunk"}, {"name", "worm"}});
    const PartId whole = elementNamed(w, "worm body").id;
    w.addFace("worm body", "in", 0, -1);
    w.addFace("worm body", "out", 12, 1);
    w.good({{"do", "add-bone"}, {"name", "near"}, {"from", "worm body/in"}, {"to", {0, 0, 4}}});
    w.good({{"do", "add-bone"}, {"name", "far"}, {"from", {0, 0, 7}}, {"to", "worm body/out"}});
    w.good({{"do", "add-bone"}, {"name", "across"}, {"element", "worm body"}, {"from", "near/end"}, {"to", "far/start"}});
    const double volume = volumeOf(elementNamed(w, "worm body"));
    const std::string before = w.content();

    const Json answer = w.good({{"do", "cut"}, {"element", "worm body"}, {"plane", planeAt(5.3)}, {"names", {"tail", "head"}}, {"name", "waist"}});
    CHECK(answer["elements"] == Json::array({"tail", "head"}));
    CHECK(answer["faces"] == Json::array({"tail/waist", "head/waist"}));
    CHECK(answer["smallest_angle"].get<double>() > 0.0);
    const Element &tail = elementNamed(w, "tail"), &head = elementNamed(w, "head");
    CHECK(tail.id == whole);
    CHECK(tail.mesh->connectivity().facts().outward);
    CHECK(head.mesh->connectivity().facts().outward);
    CHECK(volumeOf(tail) + volumeOf(head) == doctest::Approx(volume).epsilon(1e-12));
    CHECK(volumeOf(tail) == doctest::Approx(5.3).epsilon(0.01));
    CHECK(tail.faceIndex("in") == 0);
    CHECK(tail.faceIndex("out") < 0);
    CHECK(head.faceIndex("out") == 0);
    const Json list = w.good({{"do", "list"}});
    CHECK(list["joints"] == Json::array({{"tail/waist", "head/waist"}}));
    CHECK(list["bones"][0]["element"] == "tail");
    CHECK(list["bones"][1]["element"] == "head");
    CHECK(list["bones"][1]["end"] == "head/out");
    CHECK(list["bones"][2]["element"] == "tail");
    CHECK(list["characters"][0]["cuts"] == Json::array({{{"name", "waist"}, {"origin", {0.0, 0.0, 5.3}}, {"normal", {0.0, 0.0, 1.0}}, {"elements", {"tail", "head"}}}}));
    CHECK(w.good({{"do", "measure"}, {"what", "gap"}})["value"] == 0.0);
    w.good({{"do", "undo"}});
    CHECK(w.content() == before);
}

TEST_CASE("cut-all: many cuts are one command, whose pieces are those of the same cuts one by one") {
    Workbench one, all;
    for (Workbench* w : {&one, &all}) {
        w->good({{"do", "import-character"}, {"path", "trunk"}, {"name", "worm"}});
        w->addFace("worm body", "in", 0, -1);
        w->addFace("worm body", "out", 12, 1);
        w->good({{"do", "add-bone"}, {"name", "far"}, {"element", "worm body"}, {"from", {0, 0, 9}}, {"to", "worm body/out"}});
    }
    const double heights[] = {8.3, 3.1, 5.7};
    const char* names[] = {"head", "middle", "chest"};
    Json cuts = Json::array();
    for (int c = 0; c < 3; ++c) cuts.push_back({{"plane", planeAt(heights[c])}, {"piece", names[c]}, {"name", std::string(names[c]) + " cut"}});
    const std::string before = all.content();
    const Json answer = all.good({{"do", "cut-all"}, {"element", "worm"}, {"cuts", cuts}});
    CHECK(answer["refused"].empty());
    REQUIRE(answer["cuts"].size() == 3);
    CHECK(answer["cuts"][0]["elements"] == Json::array({"chest", "head"}));
    CHECK(answer["cuts"][1]["elements"] == Json::array({"worm body", "middle"}));
    CHECK(answer["cuts"][2]["elements"] == Json::array({"middle", "chest"}));
    for (const int c : {0, 1, 2}) {  // points of caps are numbered by the order of cuts
        Json line{{"do", "cut"}, {"element", c == 2 ? "middle" : "worm body"}, {"plane", planeAt(heights[c])}, {"name", std::string(names[c]) + " cut"}};
        line["names"] = {line["element"], names[c]};
        one.good(line);
    }
    for (const char* element : {"worm body", "middle", "chest", "head"}) {
        CAPTURE(element);
        const Element &a = elementNamed(one, element), &b = elementNamed(all, element);
        CHECK(a.mesh->body.vertices == b.mesh->body.vertices);
        CHECK(a.mesh->body.triangles == b.mesh->body.triangles);
        CHECK(a.faces.size() == b.faces.size());
    }
    CHECK(elementNamed(all, "head").faceIndex("out") >= 0);
    CHECK(all.good({{"do", "list"}})["bones"][0]["element"] == "head");
    CHECK(all.good({{"do", "list"}})["joints"].size() == 3);
    all.good({{"do", "undo"}});
    CHECK(all.content() == before);
}

TEST_CASE("cut-all: a cut that is refused is left out and told, as long as one is made") {
    Workbench w;
    w.good({{"do", "import-character"}, {"path", "trunk"}, {"name", "worm"}});
    const std::string before = w.content();
    const auto code = [&](const Json& cuts) { return w.code({{"do", "cut-all"}, {"element", "worm"}, {"cuts", cuts}}); };
    CHECK(code(Json::array()) == "bad-value");
    CHECK(code({{{"plane", planeAt(30.0)}}}) == "no-section");
    CHECK(code({{{"name", "x"}}}) == "missing-key");
    CHECK(code({{{"plane", planeAt(3.0)}, {"names", "x"}}}) == "unknown-key");
    CHECK(code({{{"plane", planeAt(3.0)}, {"name", "x"}}, {{"plane", planeAt(5.0)}, {"piece", "x"}}}) == "name-taken");
    CHECK(w.content() == before);
    const Json answer = w.good({{"do", "cut-all"}, {"element", "worm"}, {"cuts", {{{"plane", planeAt(3.1)}}, {{"plane", planeAt(30.0)}}, {{"plane", planeAt(3.1001)}}, {{"plane", planeAt(7.3)}}}}});
    CHECK(answer["cuts"][0].is_object());
    CHECK(answer["cuts"][1].is_null());
    CHECK(answer["cuts"][2].is_null());
    CHECK(answer["cuts"][3].is_object());
    REQUIRE(answer["refused"].size() == 2);
    std::set<std::string> codes;
    for (const Json& refused : answer["refused"]) codes.insert(refused["code"].get<std::string>());
    CHECK(codes == std::set<std::string>{"no-section", "cuts-touch"});
    CHECK(w.session.document().elements.size() == 3);
}

TEST_CASE("cut-all: parts of a body that touch nowhere fall apart where each is cut") {
    Workbench w;
    w.session.services().importCharacter = [](const ImportRequest&, const Progress&) -> Result<CharacterFile> {
        TriangleMesh other = Workbench::longBar();
        other.vertices.col(0).array() += 30.0;
        return Workbench::characterOf({Workbench::longBar(), other}, {"left", "right"});
    };
    w.good({{"do", "import-character"}, {"path", "pair"}, {"name", "pair"}});
    Json right = planeAt(5.3);
    right["origin"][0] = 30.0;
    const Json answer = w.good({{"do", "cut-all"}, {"element", "pair"}, {"cuts", {{{"plane", planeAt(5.3)}}, {{"plane", right}}}}});
    CHECK(answer["refused"].empty());
    CHECK(w.session.document().elements.size() == 4);
    CHECK(w.good({{"do", "list"}})["joints"].size() == 2);
    double volume = 0.0;
    for (const auto& [id, element] : w.session.document().elements) volume += volumeOf(*element);
    CHECK(volume == doctest::Approx(24.0).epsilon(1e-12));
}

TEST_CASE("cut: refusals say why and change nothing") {
    Workbench w;
    buildTrunk(w);
    const std::string before = w.content();
    const auto refused = [&](const Json& command, const std::string& code) {
        CAPTURE(command.dump());
        CHECK(w.code(command) == code);
        CHECK(w.content() == before);
    };
    refused(cutAt("nobody", 1.0), "no-such-element");
    refused(cutAt("low", 30.0), "no-section");
    refused(cutAt("low", 5.0), "other-element");
    refused(cutAt("middle", 3.1), "cuts-touch");
    refused({{"do", "cut"}, {"element", "low"}, {"plane", planeAt(1.0)}, {"names", Json::array({"x"})}}, "bad-type");
    refused({{"do", "cut"}, {"element", "low"}, {"plane", planeAt(1.0)}, {"names", {"x", "x"}}}, "name-taken");
    refused({{"do", "cut"}, {"element", "low"}, {"plane", planeAt(1.0)}, {"names", {"low", "middle"}}}, "name-taken");
    refused({{"do", "cut"}, {"element", "low"}, {"plane", planeAt(1.0)}, {"names", {"middle", "x"}}}, "name-taken");
    refused({{"do", "cut"}, {"element", "worm"}, {"plane", planeAt(1.0)}, {"names", {"middle", "x"}}}, "name-taken");
    refused({{"do", "cut"}, {"element", "low"}, {"plane", planeAt(1.0)}, {"names", {"low", "first"}}}, "name-taken");
    refused({{"do", "cut"}, {"element", "low"}, {"plane", planeAt(1.0)}, {"name", "worm"}}, "name-taken");
    refused({{"do", "cut"}, {"element", "low"}, {"plane", {{"origin", {0, 0, 1}}}}}, "missing-key");
    refused({{"do", "cut"}, {"element", "low"}, {"plane", {{"origin", {0, 0, 1}}, {"normal", {0, 0, 0}}}}}, "bad-value");
    refused({{"do", "move-cut"}, {"cut", "third"}, {"plane", planeAt(1.0)}}, "no-such-cut");
    refused({{"do", "move-cut"}, {"cut", "second"}, {"plane", planeAt(2.0)}}, "cut-passes");
    refused({{"do", "remove-cut"}, {"cut", "third"}}, "no-such-cut");
    refused({{"do", "remove-element"}, {"name", "middle"}}, "part-of-character");
    // A joint face across the plane.
    std::vector<std::int32_t> patch;
    const Points& v = elementNamed(w, "middle").mesh->body.vertices;
    for (std::int32_t i = 0; i < v.rows(); ++i)
        if (v(i, 0) == 0.5 && v(i, 2) > 4.9 && v(i, 2) < 6.3) patch.push_back(i);
    w.good({{"do", "add-joint-face"}, {"element", "middle"}, {"name", "side"}, {"vertices", patch}});
    CHECK(w.code(cutAt("middle", 5.5)) == "face-cut");
    CHECK(w.good(cutAt("middle", 7.1))["elements"] == Json::array({"middle", "middle 2"}));
    CHECK(elementNamed(w, "middle").faceIndex("side") >= 0);
}

TEST_CASE("cut: an element of its own becomes a character with its own mesh, and a character can be named instead of its element") {
    Workbench w;
    w.buildChain();
    const TriangleMesh before = elementNamed(w, "B").mesh->body;
    const Json answer = w.good({{"do", "cut"}, {"element", "B"}, {"plane", planeAt(4.7)}, {"names", {"B low", "B high"}}});
    CHECK(answer["character"] == "B");
    CHECK(answer["cut"] == "B high cut");
    const Json list = w.good({{"do", "list"}});
    CHECK(list["joints"][0] == Json::array({"A/out", "B low/in"}));
    CHECK(list["bones"][1]["end"] == "B high/out");
    CHECK(list["characters"][0]["body"]["how"] == "exact");
    CHECK(w.session.document().characters.begin()->second->model->mesh.body.vertices == before.vertices);
    CHECK(w.good({{"do", "cut"}, {"element", "B"}, {"plane", planeAt(5.4)}, {"names", {"B high", "tip"}}})["elements"] == Json::array({"B high", "tip"}));
    CHECK(w.good({{"do", "list"}})["characters"][0]["elements"] == Json::array({"B low", "B high", "tip"}));
    w.good({{"do", "undo"}, {"count", 2}});
    CHECK(w.session.document().characters.empty());
    CHECK(elementNamed(w, "B").mesh->body.vertices == before.vertices);
    w.good({{"do", "remove-element"}, {"name", "B"}});
    w.good({{"do", "undo"}});
    w.good({{"do", "redo"}});
}

TEST_CASE("cut: pieces and cuts that are given no names are counted, and none is called after a piece of a piece") {
    Workbench w;
    w.buildChain();
    Json first = w.good({{"do", "cut"}, {"element", "B"}, {"plane", planeAt(4.7)}});
    CHECK(first["elements"] == Json::array({"B", "B 2"}));
    CHECK(first["faces"] == Json::array({"B/cut 1", "B 2/cut 1"}));
    CHECK(first["cut"] == "cut 1");
    CHECK(first["character"] == "whole B");
    const Json second = w.good({{"do", "cut"}, {"element", "B 2"}, {"plane", planeAt(5.4)}});
    CHECK(second["elements"] == Json::array({"B 2", "B 3"}));
    CHECK(second["cut"] == "cut 2");
    // A number that became free is taken again, and so is that of a cut which was called so by hand.
    w.good({{"do", "remove-cut"}, {"cut", "cut 1"}});
    w.good({{"do", "rename"}, {"target", "cut 2"}, {"name", "wrist"}});
    const Json third = w.good({{"do", "cut"}, {"element", "B"}, {"plane", planeAt(4.6)}});
    CHECK(third["elements"] == Json::array({"B", "B 2"}));
    CHECK(third["cut"] == "cut 1");
    CHECK(w.good({{"do", "cut"}, {"element", "B"}, {"plane", planeAt(4.2)}, {"name", "hip"}})["cut"] == "hip");
}

TEST_CASE("move-cut: two elements change, all else stays the same objects, and what ends at the cut follows it") {
    Workbench w;
    buildTrunk(w);
    w.good({{"do", "precompute"}});
    const auto meshOf = [&](const char* name) { return elementNamed(w, name).mesh; };
    const auto low = meshOf("low"), middle = meshOf("middle"), high = meshOf("high");
    (void)w.session.character();
    const auto lowRuntime = w.session.plan().input.elements[0];
    CHECK(w.good({{"do", "move-cut"}, {"cut", "second"}, {"plane", planeAt(9.2, -1)}}) == Json{{"stale", {"middle", "high"}}});
    const Json list = w.good({{"do", "list"}});
    CHECK(list["elements"][0]["state"] == "fresh");
    CHECK(list["elements"][1]["state"] == "stale");
    CHECK(list["elements"][2]["state"] == "stale");
    CHECK(meshOf("low") == low);
    CHECK(meshOf("middle") != middle);
    CHECK(volumeOf(elementNamed(w, "middle")) == doctest::Approx(9.2 - 3.1).epsilon(0.01));
    (void)w.session.character();
    CHECK(w.session.plan().input.elements[0].embedded == lowRuntime.embedded);
    CHECK(w.good({{"do", "measure"}, {"what", "position"}, {"endpoint", "b/end"}})["value"][2].get<double>() == doctest::Approx(9.2));
    CHECK(list["joints"] == Json::array({{"low/first", "middle/first"}, {"middle/second", "high/second"}}));
    CHECK(list["bones"][1]["end"] == "middle/second");
    // Back again every byte is as it was, results included.
    w.good({{"do", "move-cut"}, {"cut", "second"}, {"plane", planeAt(8.3)}});
    CHECK(meshOf("middle")->body.vertices == middle->body.vertices);
    CHECK(meshOf("high")->body.triangles == high->body.triangles);
    for (const Json all = w.good({{"do", "list"}}); const Json& element : all["elements"]) CHECK(element["state"] == "fresh");
    CHECK(w.good({{"do", "move-cut"}, {"cut", "second"}, {"plane", planeAt(8.3)}})["stale"] == Json::array());
    // Turned.
    w.good({{"do", "move-cut"}, {"cut", "first"}, {"plane", {{"origin", {0, 0, 3.1}}, {"normal", {0.2, 0.1, 1}}}}});
    CHECK(meshOf("high")->body.vertices == high->body.vertices);
    CHECK(volumeOf(elementNamed(w, "low")) + volumeOf(elementNamed(w, "middle")) == doctest::Approx(8.3).epsilon(0.01));
}

TEST_CASE("remove-cut: the element behind takes in the one in front, its faces and its bones") {
    Workbench w;
    buildTrunk(w);
    const PartId middle = elementNamed(w, "middle").id;
    const std::string before = w.content();
    CHECK(w.good({{"do", "remove-cut"}, {"cut", "second"}})["stale"] == Json::array({"middle"}));
    Json list = w.good({{"do", "list"}});
    CHECK(list["elements"].size() == 2);
    CHECK(elementNamed(w, "middle").id == middle);
    CHECK(list["elements"][1]["faces"] == Json::array({"first", "out"}));
    CHECK(list["bones"][2]["element"] == "middle");
    CHECK(list["bones"][2]["end"] == "middle/out");
    CHECK(list["bones"][2]["parent"] == "b");
    CHECK(list["joints"].size() == 1);
    w.good({{"do", "remove-cut"}, {"cut", "first"}});
    list = w.good({{"do", "list"}});
    CHECK(list["elements"].size() == 1);
    CHECK(elementNamed(w, "low").mesh->body.vertices == Workbench::longBar().vertices);
    CHECK(list["elements"][0]["faces"] == Json::array({"in", "out"}));
    CHECK(list["characters"][0]["cuts"].empty());
    w.good({{"do", "undo"}, {"count", 2}});
    CHECK(w.content() == before);
    // A removed cap face does not come back by itself when its cut moves.
    w.good({{"do", "remove-joint-face"}, {"face", "middle/second"}});
    w.good({{"do", "move-cut"}, {"cut", "second"}, {"plane", planeAt(9.0)}});
    CHECK(elementNamed(w, "middle").faceIndex("second") < 0);
    CHECK(elementNamed(w, "high").faceIndex("second") >= 0);
}

TEST_CASE("characters: names are one space, everything can be renamed, and a character goes as a whole") {
    Workbench w;
    buildTrunk(w);
    for (const char* taken : {"worm", "first", "low", "a"}) {
        CHECK(w.code({{"do", "import-element"}, {"path", "bar4"}, {"name", taken}}) == "name-taken");
        CHECK(w.code({{"do", "import-character"}, {"path", "ball"}, {"name", taken}}) == "name-taken");
    }
    w.good({{"do", "rename"}, {"target", "worm"}, {"name", "いもむし"}});
    w.good({{"do", "rename"}, {"target", "first"}, {"name", "neck"}});
    w.good({{"do", "rename"}, {"target", "middle/first"}, {"name", "ring"}});
    CHECK(w.code({{"do", "rename"}, {"target", "neck"}, {"name", "second"}}) == "name-taken");
    w.good({{"do", "move-cut"}, {"cut", "neck"}, {"plane", planeAt(3.7)}});
    CHECK(w.good({{"do", "list"}})["joints"][0] == Json::array({"low/first", "middle/ring"}));
    const std::string before = w.content();
    w.good({{"do", "enable"}, {"effect", "bend-warp"}, {"target", "middle"}});
    w.good({{"do", "undo"}});
    w.good({{"do", "remove-element"}, {"name", "いもむし"}});
    CHECK(w.session.document().elements.empty());
    CHECK(w.session.document().characters.empty());
    CHECK(w.session.document().joints.empty());
    CHECK(w.session.document().bones.size() == 3);
    w.good({{"do", "undo"}});
    CHECK(w.content() == before);
}

TEST_CASE("cut: handles go with the piece that they lie on, where they were dragged to included") {
    Workbench w;
    w.good({{"do", "import-character"}, {"path", "trunk"}, {"name", "worm"}});
    w.addFace("worm body", "in", 0, -1);
    w.good({{"do", "handle"}, {"element", "worm body"}, {"point", {0.5, 0, 2}}, {"name", "near"}, {"radius", 0.4}});
    w.good({{"do", "handle"}, {"element", "worm body"}, {"point", {0.5, 0, 9}}, {"name", "far"}, {"radius", 0.4}});
    w.good({{"do", "drag"}, {"endpoint", "far"}, {"to", {1.0, 0, 9}}});
    w.good({{"do", "cut"}, {"element", "worm"}, {"plane", planeAt(5.3)}, {"names", {"tail", "head"}}});
    CHECK(elementNamed(w, "tail").handleOf("near") != nullptr);
    CHECK(elementNamed(w, "tail").handleOf("far") == nullptr);
    CHECK(elementNamed(w, "head").handleOf("far") != nullptr);
    CHECK(w.session.document().handleGoals.contains({elementNamed(w, "head").id, "far"}));
    w.good({{"do", "remove-cut"}, {"cut", "head cut"}});
    CHECK(elementNamed(w, "tail").handleOf("far") != nullptr);
    CHECK(w.session.document().handleGoals.contains({elementNamed(w, "tail").id, "far"}));
}

TEST_CASE("characters: one render mesh over several elements moves as one, small parts on it stay whole") {
    Workbench w;
    w.good({{"do", "import-character"}, {"path", "snowman"}, {"name", "worm"}, {"body", "wrapped"}, {"detail", 0.02}});
    w.good({{"do", "rename"}, {"target", "worm body"}, {"name", "low"}});
    w.good({{"do", "cut"}, {"element", "low"}, {"plane", planeAt(6.05)}, {"names", {"low", "high"}}, {"name", "waist"}});
    w.good({{"do", "add-bone"}, {"name", "a"}, {"from", {0, 0, 0.3}}, {"to", "low/waist"}});
    w.good({{"do", "add-bone"}, {"name", "b"}, {"element", "high"}, {"from", "a/end"}, {"to", {0, 0, 11.7}}});
    for (const char* element : {"low", "high"}) w.good({{"do", "set"}, {"target", element}, {"property", "solver-mesh"}, {"value", "as-is"}});
    w.good({{"do", "precompute"}});
    const Document& document = w.session.document();
    const EmbeddedModel model = embedModel(document, *document.characters.begin()->second);
    std::set<std::int32_t> ofEye;
    const auto trunk = static_cast<std::size_t>(Workbench::longBar().vertices.rows());
    for (std::size_t v = trunk; v < model.mesh->vertices.size(); ++v) ofEye.insert(model.mesh->vertices[v].element);
    CHECK(ofEye.size() == 1);

    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {3, 0, 11}}});
    const auto path = tempPath("posed.obj");
    w.good({{"do", "write-mesh"}, {"path", path}, {"character", "worm"}});
    const Points now = readObj(path).vertices, rest = document.characters.begin()->second->model->mesh.body.vertices;
    REQUIRE(now.rows() == rest.rows());
    CHECK((now - rest).rowwise().norm().maxCoeff() > 1.0);
    CHECK(w.good({{"do", "measure"}, {"what", "gap"}})["value"].get<double>() < 1e-9);
    // No edge is torn at the joint: it stretches no more than edges do where a bar of this thickness bends.
    const Triangles& triangles = model.mesh->triangles;
    double largest = 0.0;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t)
        for (int k = 0; k < 3; ++k) {
            const auto a = triangles(t, k), b = triangles(t, (k + 1) % 3);
            largest = std::max(largest, (now.row(a) - now.row(b)).norm() / (rest.row(a) - rest.row(b)).norm());
        }
    CHECK(largest < 2.0);
    w.good({{"do", "rest"}});
    w.good({{"do", "write-mesh"}, {"path", path}, {"character", "worm"}});
    CHECK((readObj(path).vertices - rest).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("characters: the two sides of a sheet stay together, whichever surface each of them faces") {
    // A fin along a worm, as clothes and feathers are made: each triangle twice, facing either way, with vertices of its own. A wrap has two walls there, and no vertex of the sheet.
    const TriangleMesh trunk = Workbench::longBar();
    TriangleMesh fin = shapes::box({-0.02, 0.4, 3.0}, {0.02, 1.6, 9.0}, 1, 4, 12).mesh;
    std::vector<Eigen::Index> side;
    for (Eigen::Index t = 0; t < fin.triangles.rows(); ++t)
        if (fin.vertices(fin.triangles(t, 0), 0) > 0.0 && fin.vertices(fin.triangles(t, 1), 0) > 0.0 && fin.vertices(fin.triangles(t, 2), 0) > 0.0) side.push_back(t);
    fin.triangles = Triangles(fin.triangles(side, Eigen::indexing::all));
    TriangleMesh back = fin;
    back.triangles.col(1).swap(back.triangles.col(2));
    Workbench w;
    w.session.services().importCharacter = [&](const ImportRequest&, const Progress&) -> Result<CharacterFile> { return Workbench::characterOf({trunk, fin, back}, {"trunk", "front", "back"}); };
    w.good({{"do", "import-character"}, {"path", "fin"}, {"name", "worm"}, {"body", "wrapped"}, {"detail", 0.02}});
    w.good({{"do", "rename"}, {"target", "worm body"}, {"name", "low"}});
    w.good({{"do", "cut"}, {"element", "low"}, {"plane", planeAt(6.05)}, {"names", {"low", "high"}}, {"name", "waist"}});
    w.good({{"do", "add-bone"}, {"name", "a"}, {"from", {0, 0, 0.3}}, {"to", "low/waist"}});
    w.good({{"do", "add-bone"}, {"name", "b"}, {"element", "high"}, {"from", "a/end"}, {"to", {0, 0, 11.7}}});
    for (const char* element : {"low", "high"}) w.good({{"do", "set"}, {"target", element}, {"property", "solver-mesh"}, {"value", "as-is"}});
    w.good({{"do", "precompute"}});
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {3, 1, 11}}});
    CHECK(w.good({{"do", "measure"}, {"what", "gap"}})["value"].get<double>() < 1e-9);
}

TEST_CASE("storage: characters come back as they were") {
    Workbench w;
    buildTrunk(w);
    w.good({{"do", "precompute"}, {"elements", Json::array({"low"})}});
    w.good({{"do", "import-character"}, {"path", "two balls"}, {"name", "balls"}});
    const auto path = tempPath("characters.imomushi");
    w.good({{"do", "save"}, {"path", path}});
    Workbench other;
    CHECK(other.good({{"do", "open"}, {"path", path}}) == w.good({{"do", "list"}}));
    CHECK(other.content() == w.content());
    const auto again = tempPath("again.imomushi");
    other.good({{"do", "save"}, {"path", again}});
    CHECK(readFile(again) == readFile(path));
    CHECK(other.good({{"do", "move-cut"}, {"cut", "second"}, {"plane", planeAt(9.0)}})["stale"] == Json::array({"middle", "high"}));
    CHECK(other.good({{"do", "list"}})["elements"][0]["state"] == "fresh");
}

TEST_CASE("storage: what a file says of characters is not trusted") {
    Workbench w;
    buildTrunk(w);
    const auto whole = tempPath("whole.imomushi"), broken = tempPath("broken.imomushi");
    w.good({{"do", "save"}, {"path", whole}});
    const auto with = [&](const std::string& statement) {
        std::filesystem::copy_file(whole, broken, std::filesystem::copy_options::overwrite_existing);
        sql(broken, statement);
        sign(broken);
        const auto project = openProject(broken);
        return project ? std::string("ok") : project.error().code;
    };
    CHECK(with("UPDATE cuts SET position = position") == "ok");
    for (const char* statement : {"DELETE FROM characters", "DELETE FROM character_parts", "DELETE FROM cuts WHERE position = 0", "DELETE FROM pieces", "DELETE FROM piece_sides WHERE front = 1",
                                  "UPDATE characters SET name = 'low'", "UPDATE characters SET mesh = 99", "UPDATE characters SET body_vertices = x'00000000'",
                                  "UPDATE characters SET triangles = x'ffffff7f0000000000000000'", "UPDATE characters SET how = 0", "UPDATE cuts SET name = 'worm'",
                                  "UPDATE cuts SET character = 2", "UPDATE cuts SET id = 1 WHERE position = 0", "UPDATE pieces SET vertices = x'00'", "UPDATE pieces SET character = 2",
                                  "UPDATE piece_sides SET face = 'nothing' WHERE position = 0", "UPDATE piece_sides SET front = 0", "UPDATE piece_sides SET cut = 77 WHERE position = 0",
                                  "UPDATE cuts SET normal = zeroblob(24)", "UPDATE characters SET detail = 7"}) {
        CAPTURE(statement);
        CHECK(with(statement) == "damaged");
    }
}

TEST_CASE("append: a character comes whole, beside another of the same names, and can be cut on there") {
    Workbench w;
    buildTrunk(w);
    w.good({{"do", "precompute"}});
    const auto path = tempPath("worm.imomushi");
    w.good({{"do", "save"}, {"path", path}});
    const Json answer = w.good({{"do", "append"}, {"path", path}, {"elements", Json::array({"middle"})}, {"offset", {4.1, 0.3, 0.7}}});
    CHECK(answer["elements"] == Json::array({"low 2", "middle 2", "high 2"}));
    const Json characters = w.good({{"do", "list"}})["characters"];
    REQUIRE(characters.size() == 2);
    CHECK(characters[1]["name"] == "worm 2");
    CHECK(characters[1]["cuts"][1]["name"] == "second 2");
    CHECK(characters[1]["elements"] == answer["elements"]);
    for (const Json all = w.good({{"do", "list"}}); const Json& element : all["elements"]) CHECK(element["state"] == "fresh");
    const auto lowest = elementNamed(w, "low 2").mesh;
    CHECK(w.good({{"do", "move-cut"}, {"cut", "second 2"}, {"plane", {{"origin", {4.1, 0.3, 9.9}}, {"normal", {0, 0, 1}}}}})["stale"] == Json::array({"middle 2", "high 2"}));
    CHECK(elementNamed(w, "low 2").mesh == lowest);
    CHECK(w.good({{"do", "measure"}, {"what", "gap"}})["value"].get<double>() < 1e-9);
    w.good({{"do", "remove-cut"}, {"cut", "first 2"}});
    const auto text = tempPath("rest.obj");
    w.good({{"do", "write-mesh"}, {"path", text}, {"character", "worm"}, {"state", "rest"}});
    CHECK(readObj(text).vertices == Workbench::longBar().vertices);
}

namespace {

/// A command on characters out of small numbers: some are possible, some are not.
Json characterCommand(unsigned kind, unsigned a, unsigned b) {
    const auto pick = [](unsigned n, std::initializer_list<const char*> names) { return *(names.begin() + n % names.size()); };
    const double z = 0.25 + 0.71 * (b % 17);
    const Json plane = {{"origin", {0.1, 0, z}}, {"normal", {0.3 * (static_cast<int>(a % 3) - 1), 0.1 * (b % 3), b % 5 ? 1 : -1}}};
    const char* element = pick(a, {"low", "middle", "high", "worm", "low 2", "middle 2"});
    const char* cut = pick(a, {"first", "second", "cut 1", "cut 2"});
    switch (kind % 16) {
        case 0:
        case 1:
        case 2: return {{"do", "cut"}, {"element", element}, {"plane", plane}};
        case 3:
        case 4:
        case 5: return {{"do", "move-cut"}, {"cut", cut}, {"plane", plane}};
        case 6:
        case 7: return {{"do", "remove-cut"}, {"cut", cut}};
        case 8: return {{"do", "remove-joint-face"}, {"face", std::string(element) + "/" + cut}};
        case 9: return {{"do", "rename"}, {"target", b % 2 ? element : cut}, {"name", pick(b, {"low", "first", "別名"})}};
        case 10: return {{"do", "drag"}, {"endpoint", pick(a, {"a/end", "b/end", "c/end"})}, {"to", {0.3 * z, 0, z}}};
        case 11: return {{"do", "remove-element"}, {"name", b % 7 ? "middle" : "worm"}};
        case 13: {
            Json attach{{"do", "attach"}, {"character", "worm"}, {"part", "trunk"}, {"mode", pick(a, {"rigid", "flesh", "auto"})}};
            if (b % 2) attach["element"] = element;
            if (b % 3 == 0) attach["pivot"] = {0, 0, z};
            return attach;
        }
        case 14: return {{"do", "turn-part"}, {"character", "worm"}, {"part", "trunk"}, {"rotation", {0, 0.1 * (a % 5), 0, 1}}};
        case 12: return {{"do", "add-bone"}, {"name", "d"}, {"from", std::string(element) + "/" + cut}, {"to", {0, 3, z}}};
        default: return {{"do", "remove-bone"}, {"name", pick(b, {"a", "b", "c", "d"})}};
    }
}

/// Elements are closed and add up to the body, cuts have a face on each side, and all names are different.
void checkWhole(const Workbench& w) {
    const Document& document = w.session.document();
    std::set<std::string> names;
    for (const auto& [id, element] : document.elements) REQUIRE(names.insert(element->name).second);
    for (const auto& [id, bone] : document.bones) REQUIRE(names.insert(bone->name).second);
    for (const auto& [id, character] : document.characters) {
        REQUIRE(names.insert(character->name).second);
        for (const Cut& cut : character->cuts) REQUIRE(names.insert(cut.name).second);
        const auto elements = document.elementsOf(id);
        REQUIRE(elements.size() == character->cuts.size() + 1);
        double volume = 0.0;
        for (const PartId element : elements) {
            REQUIRE(document.elements.at(element)->mesh->connectivity().facts().outward);
            volume += volumeOf(*document.elements.at(element));
        }
        REQUIRE(std::abs(volume - meshFacts(character->body->mesh).volume) < 1e-9 * volume);
    }
    for (const auto& [id, joint] : document.joints)
        for (const FaceRef& face : joint->faces) REQUIRE(document.elements.at(face.element)->faceIndex(face.face) >= 0);
}

}  // namespace

TEST_CASE("characters: any commands leave closed pieces, undo leads back to the first document and redo to the last, and files hold it all") {
    int done = 0, refused = 0;
    for (unsigned seed = 0; seed < 200; ++seed) {
        CAPTURE(seed);
        std::mt19937 random(seed);
        Workbench w;
        buildTrunk(w);
        const int first = w.session.position();
        std::vector<std::string> contents{w.content()};
        for (unsigned commands = 1 + random() % 8; commands > 0; --commands) {
            const auto kind = static_cast<unsigned>(random()), a = static_cast<unsigned>(random()), b = static_cast<unsigned>(random());
            const Json command = characterCommand(kind, a, b);
            CAPTURE(command.dump());
            const bool answered = w.session.execute(command).has_value();
            ++(answered ? done : refused);
            const std::string now = w.content();
            if (answered)
                contents.push_back(now);
            else
                REQUIRE(now == contents.back());
            checkWhole(w);
            REQUIRE((w.session.character() != nullptr || (w.session.document().elements.empty() && w.session.document().bones.empty())));
        }
        const auto path = tempPath("walk.imomushi");
        w.good({{"do", "save"}, {"path", path}, {"copy", true}});
        Workbench other;
        other.good({{"do", "open"}, {"path", path}});
        REQUIRE(other.content() == contents.back());
        REQUIRE(w.session.position() == first + static_cast<int>(contents.size()) - 1);
        for (std::size_t i = contents.size() - 1; i > 0; --i) {
            w.good({{"do", "undo"}});
            REQUIRE(w.content() == contents[i - 1]);
        }
        if (const int steps = static_cast<int>(contents.size()) - 1; steps > 0) {
            w.good({{"do", "redo"}, {"count", steps}});
            REQUIRE(w.content() == contents.back());
        }
        w.good({{"do", "undo"}, {"count", w.session.position()}});
        REQUIRE(w.session.document().elements.empty());
        REQUIRE(w.session.document().characters.empty());
    }
    MESSAGE(done << " commands done, " << refused << " refused");
    CHECK(done > 200);
    CHECK(refused > 50);
}

TEST_CASE("characters: of two embedded models that are alike the latest one is given, which characters that were built lately have") {
    Workbench w;
    w.good({{"do", "import-character"}, {"path", "snowman"}});
    const Document& document = w.session.document();
    const CharacterSource& character = *document.characters.begin()->second;
    EmbeddedModels here, there;
    const auto first = here.of(document, character).mesh, second = there.of(document, character).mesh;
    REQUIRE(first != second);
    here.take(there);
    CHECK(here.of(document, character).mesh == second);
    CHECK(here.of(document, character).mesh == second);
    there.take(here);
    CHECK(there.of(document, character).mesh == second);
}
