// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <stop_token>

#include "core/body/repair.h"
#include "core/mesh/connectivity.h"
#include "tests/body/messes.h"
#include "tests/document/workbench.h"

using namespace imomushi;
using namespace imomushi::messes;

namespace {

/// "torn ball" has a seam all over, a hole and triangles that are turned; "crossed" is a ball with a dent that comes out of its other side; other names as on the workbench.
Result<CharacterFile> messyFile(const ImportRequest& request, const Progress& progress) {
    const std::string name = request.path.string();
    const TriangleMesh ball = shapes::sphere(1.0, 3).mesh;
    if (name == "torn ball") return Workbench::characterOf({exploded(broken(without(ball, {0, 7, 100}), 3, 0.0, 0.1, 0.0, 0.0), 1.0)}, {"ball"});
    if (name == "holed ball") return Workbench::characterOf({broken(without(ball, {0, 7, 100}), 3, 0.0, 0.1, 0.0, 0.0)}, {"ball"});
    if (name == "crossed") {
        TriangleMesh mesh = ball;
        for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v)
            if (mesh.vertices(v, 2) > 0.93) mesh.vertices(v, 2) -= 2.2;
        return Workbench::characterOf({mesh}, {"ball"});
    }
    return Workbench::characterFile(request, progress);
}

struct MessyBench : Workbench {
    MessyBench() {
        session.services().importCharacter = messyFile;
    }
    Json import(const char* path, const char* body = "auto") { return good({{"do", "import-character"}, {"path", path}, {"name", "it"}, {"body", body}}); }
    const CharacterSource& it() {
        REQUIRE(session.document().characters.size() == 1);
        return *session.document().characters.begin()->second;
    }
};

bool has(const Json& issues, const char* code) {
    return std::any_of(issues.begin(), issues.end(), [&](const Json& i) { return i["code"] == code; });
}

const MeshIssue* issueOf(const CharacterSource& character, std::string_view code) {
    for (const MeshIssue& issue : character.issues)
        if (issue.code == code) return &issue;
    return nullptr;
}

/// Two balls that overlap, as one element.
void importTwo(Workbench& w) {
    w.session.services().import = [](const ImportRequest&, const Progress&) -> Result<ImportResult> {
        ImportResult result;
        result.format = "shape";
        const TriangleMesh ball = shapes::sphere(1.0, 3).mesh;
        result.bodies.push_back(importedBody("two", both(ball, moved(ball, 1.0, {1.2, 0.1, 0.05}))));
        return result;
    };
    w.good({{"do", "import-element"}, {"path", "two"}});
}

}  // namespace

TEST_CASE("repair: a mesh that comes in unmended has a wrap and lists its issues with their places; repair makes the body that an import would have made") {
    MessyBench mended;
    CHECK(mended.import("torn ball")["body"]["how"] == "mended");
    MessyBench w;
    const Json answer = w.import("torn ball", "unmended");
    CHECK(answer["body"]["how"] == "wrapped");
    for (const char* code : {"unwelded", "open", "mixed-winding"}) {
        CAPTURE(code);
        const MeshIssue* issue = issueOf(w.it(), code);
        REQUIRE(issue != nullptr);
        CHECK(!issue->fixed);
        CHECK(issue->severity != Severity::Error);
        CHECK(!issue->triangles.empty());
        for (const std::int32_t t : issue->triangles) CHECK((t >= 0 && t < w.it().model->mesh.body.triangles.rows()));
    }
    const std::string before = w.content();
    const auto model = w.it().model;
    const int steps = w.session.position();

    const Json repaired = w.good({{"do", "repair"}, {"element", "it"}});
    CHECK(has(repaired["before"], "open"));
    CHECK(has(repaired["before"], "unwelded"));
    CHECK(has(repaired["before"], "mixed-winding"));
    CHECK(repaired["after"] == Json::array());
    CHECK(has(repaired["done"], "open"));
    CHECK(repaired["unneeded"] == Json::array());
    CHECK(repaired["body"]["how"] == "mended");
    CHECK(repaired["stale"] == Json::array({"it body"}));
    CHECK(w.session.position() == steps + 1);
    CHECK(w.it().model == model);  // what is seen stays
    CHECK(w.it().body->mesh.vertices == mended.it().body->mesh.vertices);
    CHECK(w.it().body->mesh.triangles == mended.it().body->mesh.triangles);
    CHECK(w.content() == mended.content());

    w.good({{"do", "undo"}});
    CHECK(w.content() == before);
    w.good({{"do", "redo"}});
    CHECK(w.content() == mended.content());
    CHECK(w.good({{"do", "repair"}, {"element", "it body"}})["done"] == Json::array());  // nothing is left
}

TEST_CASE("repair: one step after the other, and the body follows when nothing is left") {
    MessyBench w;
    w.import("torn ball", "unmended");
    const auto wrap = w.it().body;
    const Json weld = w.good({{"do", "repair"}, {"element", "it"}, {"actions", {"weld", "drop"}}});
    CHECK(weld["unneeded"] == Json::array({"drop"}));
    CHECK(weld["done"].size() == 1);
    CHECK(weld["done"][0]["action"] == "weld");
    CHECK(!has(weld["after"], "unwelded"));
    CHECK(has(weld["after"], "open"));
    CHECK(weld["stale"] == Json::array());
    CHECK(w.it().body == wrap);
    CHECK(issueOf(w.it(), "unwelded")->fixed);
    CHECK(!issueOf(w.it(), "unwelded")->triangles.empty());
    const Json orient = w.good({{"do", "repair"}, {"element", "it"}, {"actions", {"orient"}}});
    CHECK(!has(orient["after"], "mixed-winding"));
    CHECK(has(orient["after"], "open"));

    // What is done is kept in a project.
    const auto path = Workbench::folder() / "half.imomushi";
    w.good({{"do", "save"}, {"path", path.string()}});
    MessyBench again;
    again.good({{"do", "open"}, {"path", path.string()}});
    for (MessyBench* bench : {&w, &again}) {
        const Json fill = bench->good({{"do", "repair"}, {"element", "it"}, {"actions", {"fill"}}});
        CHECK(fill["after"] == Json::array());
        CHECK(fill["body"]["how"] == "mended");
        CHECK(bench->it().body->mesh.vertices.rows() != wrap->mesh.vertices.rows());
    }
    CHECK(w.content() == again.content());
}

TEST_CASE("repair: a script of an unmended import and its steps makes the same again") {
    MessyBench w;
    w.import("holed ball", "unmended");
    w.good({{"do", "cut"}, {"element", "it"}, {"plane", {{"origin", {0, 0, 0.11}}, {"normal", {0, 0, 1}}}}, {"names", {"low", "high"}}});
    w.good({{"do", "handle"}, {"element", "high"}, {"point", {0, 0, 1}}, {"radius", 0.4}, {"name", "top"}});
    const Json answer = w.good({{"do", "repair"}, {"element", "low"}});
    CHECK(answer["stale"] == Json::array({"low", "high"}));
    const Element& high = *w.session.document().elementNamed("high");
    REQUIRE(high.handles.size() == 1);  // a disc of the new surface
    CHECK(high.handles[0].point.z() == doctest::Approx(1.0).epsilon(0.02));
    CHECK(high.mesh->connectivity().facts().outward);
    CHECK(w.session.document().joints.size() == 1);
    MessyBench again;
    for (const Json& line : w.session.script()) again.good(line);
    CHECK(again.content() == w.content());
}

TEST_CASE("repair: a wrap on purpose, finer ones, and none where it would be the same") {
    MessyBench w;
    w.import("ball");
    const Json wrap = w.good({{"do", "repair"}, {"element", "it"}, {"actions", {"wrap"}}, {"detail", 0.1}});
    CHECK(wrap["body"]["how"] == "wrapped");
    CHECK(has(wrap["done"], "wrapped"));
    CHECK(wrap["done"][0]["action"] == Json());
    const double coarse = wrap["body"]["distance"]["largest"];
    CHECK(w.good({{"do", "repair"}, {"element", "it"}, {"actions", {"wrap"}}})["unneeded"] == Json::array({"wrap"}));
    const Json finer = w.good({{"do", "repair"}, {"element", "it"}, {"actions", {"wrap"}}, {"detail", 0.03}});
    CHECK(finer["body"]["distance"]["largest"].get<double>() < coarse);
    w.good({{"do", "undo"}, {"count", 2}});
    CHECK(w.it().body->report.how == BodyKind::Wrapped);
}

TEST_CASE("repair: parts of an element that overlap become one body, and what is seen stays") {
    Workbench w;
    importTwo(w);
    const auto seen = w.session.document().elementNamed("two")->mesh;
    const PartId id = w.session.document().elementNamed("two")->id;
    const std::string before = w.content();
    const Json answer = w.good({{"do", "repair"}, {"element", "two"}});
    CHECK(has(answer["before"], "self-intersection"));
    CHECK(!has(answer["after"], "self-intersection"));
    CHECK(has(answer["done"], "united"));
    CHECK(answer["body"]["how"] == "mended");
    const Document& document = w.session.document();
    REQUIRE(document.characters.size() == 1);
    const CharacterSource& character = *document.characters.begin()->second;
    CHECK(character.model->mesh.body.vertices == seen->body.vertices);
    CHECK(character.model->mesh.body.triangles == seen->body.triangles);
    const Element& two = *document.elements.at(id);
    CHECK(two.name == "two");
    CHECK(two.mesh->connectivity().facts().components == 1);
    CHECK(checkMesh(two.mesh->body).empty());
    w.good({{"do", "undo"}});
    CHECK(w.content() == before);
}

TEST_CASE("repair: a surface that goes through itself is mended when it comes in: its body is the outer side, and nothing is left to repair") {
    MessyBench w;
    const Json imported = w.import("crossed");
    REQUIRE(imported["body"]["how"] == "mended");
    CHECK(has(imported["issues"], "untangled"));
    CHECK(!has(imported["issues"], "self-intersection"));
    CHECK(checkMesh(w.session.document().elements.begin()->second->mesh->body).empty());
    CHECK(w.session.document().elements.begin()->second->mesh->connectivity().facts().outward);
    const Json answer = w.good({{"do", "repair"}, {"element", "it"}, {"actions", {"wrap"}}});
    CHECK(answer["body"]["how"] == "wrapped");
    CHECK(!has(answer["after"], "self-intersection"));
    CHECK(w.session.document().elements.begin()->second->mesh->connectivity().facts().outward);
}

TEST_CASE("repair: what cannot be is refused with its reason, and changes nothing") {
    Workbench w;
    importTwo(w);
    w.good({{"do", "handle"}, {"element", "two"}, {"point", {-1, 0, 0}}, {"radius", 0.3}, {"name", "near"}});
    const std::string before = w.content();
    CHECK(w.code({{"do", "repair"}, {"element", "nobody"}}) == "no-such-element");
    CHECK(w.code({{"do", "repair"}}) == "missing-key");
    CHECK(w.code({{"do", "repair"}, {"element", "two"}, {"actions", "weld"}}) == "bad-type");
    CHECK(w.code({{"do", "repair"}, {"element", "two"}, {"actions", {"sew"}}}) == "bad-value");
    CHECK(w.code({{"do", "repair"}, {"element", "two"}, {"actions", {1}}}) == "bad-value");
    CHECK(w.code({{"do", "repair"}, {"element", "two"}, {"actions", Json::array()}}) == "bad-value");
    CHECK(w.code({{"do", "repair"}, {"element", "two"}, {"actions", {"wrap"}}, {"detail", 3.0}}) == "bad-value");
    CHECK(w.code({{"do", "repair"}, {"element", "two"}, {"detail", 0.01}}) == "bad-value");
    CHECK(w.good({{"do", "repair"}, {"element", "two"}, {"actions", {"fill", "weld"}}})["unneeded"] == Json::array({"fill", "weld"}));
    CHECK(w.session.document().characters.empty());
    CHECK(w.content() == before);
    std::stop_source stop;
    stop.request_stop();
    CHECK(w.session.execute({{"do", "repair"}, {"element", "two"}, {"actions", {"wrap"}}}, Progress({}, stop.get_token())).error().code == kCancelled);
    CHECK(w.content() == before);

    // A handle becomes a disc of the other surface, a joint face that was chosen by its triangles cannot.
    w.good({{"do", "import-element"}, {"path", "two"}, {"name", "other"}});
    w.good({{"do", "add-joint-face"}, {"element", "other"}, {"name", "left"}, {"plane", {{"origin", {-1, 0, 0}}, {"normal", {-1, 0, 0}}}}, {"tolerance", 0.02}});
    CHECK(w.code({{"do", "repair"}, {"element", "other"}, {"actions", {"wrap"}}}) == "face-lost");
    CHECK(w.good({{"do", "repair"}, {"element", "other"}})["body"]["how"] == "mended");  // a union leaves it where it is
    CHECK(w.good({{"do", "repair"}, {"element", "two"}, {"actions", {"wrap"}}})["body"]["how"] == "wrapped");
    CHECK(w.session.document().elementNamed("two")->handles.size() == 1);
}
