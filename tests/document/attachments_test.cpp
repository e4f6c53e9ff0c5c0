// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of characters that follow the body as the artist says.
#include <cmath>
#include <numbers>

#include "core/document/attachments.h"
#include "core/document/character_input.h"
#include "tests/document/tamper.h"
#include "tests/document/workbench.h"
#include "tests/support/obj.h"

using namespace imomushi;

namespace {

/// A bar of 1 x 1 x 12 m with an eye, and a part "teeth" of two balls that lie apart.
void setShapes(Workbench& w) {
    w.session.services().importCharacter = [](const ImportRequest& request, const Progress& progress) -> Result<CharacterFile> {
        if (request.path != "face") return Workbench::characterFile(request, progress);
        const auto ball = [](const Vec3& at) {
            TriangleMesh mesh = shapes::sphere(0.05, 1).mesh;
            mesh.vertices.rowwise() += at.transpose();
            return mesh;
        };
        const TriangleMesh left = ball({-0.2, 0.56, 8.0}), right = ball({0.2, 0.56, 8.0});
        TriangleMesh teeth;
        teeth.vertices.resize(2 * left.vertices.rows(), 3);
        teeth.vertices << left.vertices, right.vertices;
        teeth.triangles.resize(2 * left.triangles.rows(), 3);
        teeth.triangles << left.triangles, right.triangles.array() + static_cast<std::int32_t>(left.vertices.rows());
        return Workbench::characterOf({Workbench::longBar(), ball({0.0, 0.56, 6.03}), teeth}, {"trunk", "eye", "teeth"});
    };
}

/// The character "worm" of two elements "low" and "high" with a bone through each, cut beside the eye.
void buildFace(Workbench& w) {
    setShapes(w);
    w.good({{"do", "import-character"}, {"path", "face"}, {"name", "worm"}, {"body", "mended"}});
    w.good({{"do", "rename"}, {"target", "worm body"}, {"name", "low"}});
    w.addFace("low", "in", 0, -1);
    w.addFace("low", "out", 12, 1);
    w.good({{"do", "cut"}, {"element", "low"}, {"plane", {{"origin", {0, 0, 6.35}}, {"normal", {0, 0, 1}}}}, {"names", {"low", "high"}}, {"name", "waist"}});
    w.good({{"do", "add-bone"}, {"name", "a"}, {"from", "low/in"}, {"to", "low/waist"}});
    w.good({{"do", "add-bone"}, {"name", "b"}, {"from", "a/end"}, {"to", "high/out"}});
    for (const char* element : {"low", "high"}) w.good({{"do", "set"}, {"target", element}, {"property", "solver-mesh"}, {"value", "as-is"}});
    w.good({{"do", "precompute"}});
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
}

Json attached(const char* part, const char* mode) { return {{"do", "attach"}, {"character", "worm"}, {"part", part}, {"mode", mode}}; }
Json turned(const char* part, double angle) {
    return {{"do", "turn-part"}, {"character", "worm"}, {"part", part}, {"rotation", {0, std::sin(angle / 2), 0, std::cos(angle / 2)}}};
}
const Json kBend = {{"do", "drag"}, {"endpoint", "b/end"}, {"to", {3, 0, 11}}};

const CharacterSource& worm(const Workbench& w) { return *w.session.document().characters.begin()->second; }

/// Where the vertices of a part are.
Points shown(Workbench& w, const char* part) {
    const auto path = (Workbench::folder() / "shown.obj").string();
    w.good({{"do", "write-mesh"}, {"path", path}, {"character", "worm"}});
    const Points all = readObj(path).vertices;
    return all(worm(w).model->namedParts().verticesOf(*modelPartNamed(worm(w), part)), Eigen::indexing::all);
}
Points rest(const Workbench& w, const char* part) {
    return worm(w).model->mesh.body.vertices(worm(w).model->namedParts().verticesOf(*modelPartNamed(worm(w), part)), Eigen::indexing::all);
}

/// The largest change of a distance between two points, relative.
double deformation(const Points& was, const Points& now) {
    double worst = 0.0;
    for (Eigen::Index a = 0; a < was.rows(); ++a)
        for (Eigen::Index b = 0; b < a; ++b)
            if (const double before = (was.row(a) - was.row(b)).norm(); before > 0.0)
                worst = std::max(worst, std::abs((now.row(a) - now.row(b)).norm() - before) / before);
    return worst;
}

}  // namespace

TEST_CASE("attach: parts and their shells are listed with how they follow, and each choice is one step of the history") {
    Workbench w;
    buildFace(w);
    const std::string before = w.content();
    Json parts = w.good({{"do", "list"}})["characters"][0]["parts"];
    REQUIRE(parts.size() == 3);
    const auto ball = shapes::sphere(0.05, 1).mesh.vertices.rows();
    CHECK(parts[1] == Json{{"name", "eye"}, {"vertices", ball}, {"part", "eye"}, {"mode", "auto"}});
    CHECK(parts[2]["shells"] == Json::array({{{"vertices", ball}, {"part", "teeth#1"}, {"mode", "auto"}}, {{"vertices", ball}, {"part", "teeth#2"}, {"mode", "auto"}}}));

    const Json answer = w.good(attached("eye", "rigid"));
    CHECK(answer["vertices"] == ball);
    CHECK(answer["pivot"][2].get<double>() == doctest::Approx(6.03));
    Json pivot = attached("teeth#2", "rigid");
    pivot["pivot"] = {0.2, 0.5, 8.0};
    pivot["element"] = "high";
    CHECK(w.good(pivot)["pivot"] == Json::array({0.2, 0.5, 8.0}));
    w.good(turned("eye", 0.4));
    parts = w.good({{"do", "list"}})["characters"][0]["parts"];
    CHECK(parts[1]["mode"] == "rigid");
    CHECK(parts[1]["rotation"][1].get<double>() == doctest::Approx(std::sin(0.2)));
    CHECK(parts[2]["mode"] == "auto");
    CHECK(parts[2]["shells"][0]["mode"] == "auto");
    CHECK(parts[2]["shells"][1]["mode"] == "rigid");
    CHECK(parts[2]["shells"][1]["element"] == "high");
    CHECK(parts[2]["shells"][1]["pivot"] == Json::array({0.2, 0.5, 8.0}));
    // What is left out stays as it is; null is the middle.
    w.good(attached("teeth#2", "rigid"));
    CHECK(w.good({{"do", "list"}})["characters"][0]["parts"][2]["shells"][1]["pivot"] == Json::array({0.2, 0.5, 8.0}));
    pivot["pivot"] = nullptr;
    pivot.erase("element");
    CHECK(w.good(pivot)["pivot"][1].get<double>() == doctest::Approx(0.56));

    const std::string after = w.content();
    w.good({{"do", "undo"}, {"count", 5}});
    CHECK(w.content() == before);
    w.good({{"do", "redo"}, {"count", 5}});
    CHECK(w.content() == after);
    // The script leads to the same document.
    Workbench again;
    setShapes(again);
    for (const Json& line : w.session.script()) again.good(line);
    CHECK(again.content() == after);
    // Whole again.
    for (const char* part : {"eye", "teeth#2"}) w.good(attached(part, "auto"));
    CHECK(worm(w).attachments.empty());
    CHECK(w.session.document().turns.empty());
}

TEST_CASE("attach: what cannot be is refused with a reason, and nothing changes") {
    Workbench w;
    buildFace(w);
    w.good({{"do", "import-element"}, {"path", "bar9"}, {"name", "other"}});
    const std::string before = w.content();
    CHECK(w.code({{"do", "attach"}, {"character", "nobody"}, {"part", "eye"}, {"mode", "rigid"}}) == "no-such-character");
    CHECK(w.code(attached("nose", "rigid")) == "no-such-part");
    CHECK(w.code(attached("eye#1", "rigid")) == "no-such-part");
    CHECK(w.code(attached("eye", "stiff")) == "bad-value");
    const auto with = [](const char* mode, const char* key, const Json& value) {
        Json command = attached("eye", mode);
        command[key] = value;
        return command;
    };
    CHECK(w.code(with("flesh", "pivot", {0, 0, 0})) == "bad-value");
    CHECK(w.code(with("auto", "element", "low")) == "bad-value");
    CHECK(w.code(with("rigid", "pivot", "here")) == "bad-type");
    CHECK(w.code(with("rigid", "pivot", {0, 0})) == "bad-type");
    CHECK(w.code(with("rigid", "pivot", {0, 0, 1e300})) == "bad-type");
    CHECK(w.code(with("rigid", "element", "nobody")) == "no-such-element");
    CHECK(w.code(with("rigid", "element", "other")) == "bad-value");
    CHECK(w.code(turned("eye", 0.3)) == "not-rigid");
    w.good(attached("teeth", "rigid"));
    CHECK(w.code(turned("teeth#1", 0.3)) == "not-rigid");
    Json turn = turned("teeth", 0.3);
    for (const Json& bad : {Json::array({0, 0, 0, 0}), Json::array({0, 0, 1e300, 1}), Json::array({0, 0, 1}), Json("round")}) {
        turn["rotation"] = bad;
        CHECK(w.code(turn) != "ok");
    }
    turn = turned("teeth", 0.3);
    turn["seconds"] = -1;
    CHECK(w.code(turn) == "bad-value");
    w.good({{"do", "undo"}});
    CHECK(w.content() == before);
    // A part whose shells all have their own attachment has nothing left to turn.
    for (const char* part : {"teeth", "teeth#1", "teeth#2"}) w.good(attached(part, "rigid"));
    CHECK(w.code(turned("teeth", 0.3)) == "not-rigid");
    CHECK(w.code(turned("teeth#2", 0.3)) == "ok");
}

TEST_CASE("attach: a rigid part keeps its shape in every pose, and no choice moves anything at rest") {
    Workbench w;
    buildFace(w);
    const Points eye = rest(w, "eye"), teeth = rest(w, "teeth");
    for (const char* mode : {"auto", "flesh", "rigid"}) {
        for (const char* part : {"eye", "teeth", "trunk"}) w.good(attached(part, mode));
        CHECK((shown(w, "eye") - eye).cwiseAbs().maxCoeff() < 1e-12);
        CHECK((shown(w, "teeth") - teeth).cwiseAbs().maxCoeff() < 1e-12);
        CHECK((shown(w, "trunk") - rest(w, "trunk")).cwiseAbs().maxCoeff() < 1e-12);
    }
    w.good(attached("trunk", "auto"));
    w.good(kBend);
    CHECK(deformation(eye, shown(w, "eye")) < 1e-9);
    CHECK(deformation(teeth, shown(w, "teeth")) < 1e-9);
    const Points rigid = shown(w, "eye");
    CHECK((rigid - eye).rowwise().norm().minCoeff() > 0.3);
    w.good(attached("eye", "flesh"));
    CHECK(deformation(eye, shown(w, "eye")) > 1e-3);
    // It is where the flesh is.
    CHECK((shown(w, "eye").colwise().mean() - rigid.colwise().mean()).norm() < 0.05);
    // Shells by themselves keep theirs, not their distance.
    w.good(attached("teeth", "auto"));
    for (const char* part : {"teeth#1", "teeth#2"}) w.good(attached(part, "rigid"));
    for (const char* part : {"teeth#1", "teeth#2"}) CHECK(deformation(rest(w, part), shown(w, part)) < 1e-9);
    CHECK(deformation(teeth, shown(w, "teeth")) > 1e-6);
    // With one pivot they are one.
    for (const char* part : {"teeth#1", "teeth#2"}) {
        Json same = attached(part, "rigid");
        same["pivot"] = {0, 0.5, 8};
        w.good(same);
    }
    CHECK(deformation(teeth, shown(w, "teeth")) < 1e-9);
    // The effects too.
    w.good({{"do", "enable"}, {"effect", "bend-warp"}});
    CHECK(deformation(teeth, shown(w, "teeth")) < 1e-9);
}

TEST_CASE("attach: a part follows the element that was chosen, also across a cut, and one that is there where that is gone") {
    Workbench w;
    buildFace(w);
    const auto elementOf = [&w] {
        (void)w.session.character();
        const auto& rigid = w.session.plan().rigid;
        return rigid.empty() ? std::string() : w.session.document().elements.at(w.session.plan().elements[static_cast<std::size_t>(rigid[0].element)])->name;
    };
    w.good(attached("eye", "rigid"));
    CHECK(elementOf() == "low");
    Json other = attached("eye", "rigid");
    other["element"] = "high";
    w.good(other);
    CHECK(elementOf() == "high");
    w.good(kBend);
    const Points high = shown(w, "eye");
    CHECK(deformation(rest(w, "eye"), high) < 1e-9);
    other["element"] = "";
    w.good(other);
    CHECK(elementOf() == "low");
    CHECK((shown(w, "eye") - high).cwiseAbs().maxCoeff() > 1e-6);
    other["element"] = "high";
    w.good(other);
    w.good({{"do", "remove-cut"}, {"cut", "waist"}});
    CHECK(elementOf() == "low");
    // The other one is stored as no choice, since it is not there.
    const auto path = (Workbench::folder() / "gone.imomushi").string();
    w.good({{"do", "save"}, {"path", path}});
    Workbench opened;
    CHECK(!opened.good({{"do", "open"}, {"path", path}})["characters"][0]["parts"][1].contains("element"));
    w.good({{"do", "undo"}});
    CHECK(elementOf() == "high");
    Json flesh = attached("eye", "flesh");
    flesh["element"] = "high";
    w.good(flesh);
    CHECK(elementOf().empty());
}

TEST_CASE("attach: nothing is precomputed again, and elements that do not carry the part stay the same objects") {
    Workbench w;
    buildFace(w);
    (void)w.session.character();
    const auto before = w.session.plan().input;
    w.good(attached("eye", "flesh"));  // by itself it is rigid
    (void)w.session.character();
    const auto& after = w.session.plan().input;
    CHECK(after.elements[0].embedded != before.elements[0].embedded);
    CHECK(after.elements[1].embedded == before.elements[1].embedded);
    CHECK(after.renderMeshes == before.renderMeshes);
    for (std::size_t e = 0; e < 2; ++e) CHECK(after.elements[e].response == before.elements[e].response);
    for (const Json all = w.good({{"do", "list"}}); const Json& element : all["elements"]) CHECK(element["state"] == "fresh");
    // What follows in the same way is the same again.
    w.good(attached("eye", "auto"));
    (void)w.session.character();
    CHECK(w.session.plan().rigid.empty());
}

TEST_CASE("turn-part: it turns about the pivot, glides as frames pass, and is undone; rest and other modes end it") {
    Workbench w;
    buildFace(w);
    Json attach = attached("eye", "rigid");
    const Vec3 pivot(0.0, 0.5, 6.0);
    attach["pivot"] = {0.0, 0.5, 6.0};
    w.good(attach);
    const Points eye = rest(w, "eye");
    const auto about = [&](double angle) -> Points {
        const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, Vec3::UnitY()).toRotationMatrix();
        return ((turn * (eye.rowwise() - pivot.transpose()).transpose()).transpose()).rowwise() + pivot.transpose();
    };
    CHECK(w.good(turned("eye", 0.5))["rotation"][3].get<double>() == doctest::Approx(std::cos(0.25)));
    CHECK((shown(w, "eye") - about(0.5)).cwiseAbs().maxCoeff() < 1e-12);
    w.good({{"do", "undo"}});
    CHECK((shown(w, "eye") - eye).cwiseAbs().maxCoeff() < 1e-12);
    w.good({{"do", "redo"}});
    CHECK((shown(w, "eye") - about(0.5)).cwiseAbs().maxCoeff() < 1e-12);

    Json glide = turned("eye", -0.5);
    glide["seconds"] = 1.0;
    w.good(glide);
    CHECK((shown(w, "eye") - about(0.5)).cwiseAbs().maxCoeff() < 1e-12);
    w.good({{"do", "step"}, {"frames", 30}});
    CHECK((shown(w, "eye") - about(0.0)).cwiseAbs().maxCoeff() < 1e-9);
    CHECK(w.session.moving());
    w.good({{"do", "step"}, {"frames", 31}});
    CHECK((shown(w, "eye") - about(-0.5)).cwiseAbs().maxCoeff() < 1e-9);
    CHECK(!w.session.moving());
    w.good(kBend);
    CHECK(deformation(eye, shown(w, "eye")) < 1e-9);
    w.good({{"do", "rest"}});
    CHECK(w.session.document().turns.empty());
    CHECK((shown(w, "eye") - eye).cwiseAbs().maxCoeff() < 1e-9);

    w.good(turned("eye", 0.5));
    const std::string before = w.content();
    w.good(attached("eye", "flesh"));
    CHECK(w.session.document().turns.empty());
    CHECK((shown(w, "eye") - eye).cwiseAbs().maxCoeff() < 1e-9);
    w.good({{"do", "undo"}});
    CHECK(w.content() == before);
    CHECK((shown(w, "eye") - about(0.5)).cwiseAbs().maxCoeff() < 1e-9);
    w.good({{"do", "remove-element"}, {"name", "worm"}});
    CHECK(w.session.document().turns.empty());
    w.good({{"do", "undo"}});
    CHECK(w.content() == before);
}

TEST_CASE("turn-part: takes record it, and play it after the project was saved and opened") {
    Workbench w;
    buildFace(w);
    w.good(attached("eye", "rigid"));
    w.good({{"do", "record"}, {"take", "look"}, {"action", "start"}});
    std::vector<Points> frames;
    for (int i = 1; i <= 6; ++i) {
        w.good(turned("eye", 0.2 * i));
        w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0.3 * i, 0, 11}}});
        w.good({{"do", "step"}, {"frames", 1}});
        frames.push_back(shown(w, "eye"));
    }
    w.good({{"do", "record"}, {"take", "look"}, {"action", "stop"}});
    w.good({{"do", "rest"}});
    const auto times = w.session.document().takeNamed("look")->times;
    const auto check = [&](Workbench& of) {
        for (const std::size_t i : {5u, 0u, 3u}) {
            CHECK(of.good({{"do", "play"}, {"take", "look"}, {"time", times[i + 1]}})["exact"] == true);
            CHECK((shown(of, "eye") - frames[i]).cwiseAbs().maxCoeff() == 0.0);
        }
    };
    check(w);
    const auto path = (Workbench::folder() / "look.imomushi").string();
    w.good({{"do", "save"}, {"path", path}});
    Workbench other;
    other.good({{"do", "open"}, {"path", path}});
    check(other);
    // On a character whose part is flesh, the take shows its poses.
    w.good(attached("eye", "flesh"));
    CHECK(w.good({{"do", "play"}, {"take", "look"}, {"time", times[3]}})["exact"] == false);
}

TEST_CASE("storage: attached parts and their turns come back, and broken ones are found") {
    Workbench w;
    buildFace(w);
    const auto path = (Workbench::folder() / "attached.imomushi").string(), broken = (Workbench::folder() / "broken attached.imomushi").string();
    Json eye = attached("eye", "rigid");
    eye["pivot"] = {0.0, 0.5, 6.0};
    eye["element"] = "high";
    w.good(eye);
    w.good(attached("teeth#1", "flesh"));
    Json turn = turned("eye", 0.6);
    turn["seconds"] = 0.5;
    w.good(turn);
    w.good({{"do", "step"}, {"frames", 6}});
    w.good({{"do", "save"}, {"path", path}});
    Workbench other;
    CHECK(other.good({{"do", "open"}, {"path", path}}) == w.good({{"do", "list"}}));
    CHECK(other.content() == w.content());
    CHECK((shown(other, "eye") - shown(w, "eye")).cwiseAbs().maxCoeff() < 1e-9);
    other.good({{"do", "step"}, {"frames", 60}});
    w.good({{"do", "step"}, {"frames", 60}});
    CHECK((shown(other, "eye") - shown(w, "eye")).cwiseAbs().maxCoeff() < 1e-9);

    const auto with = [&](const std::string& statement) {
        std::filesystem::copy_file(path, broken, std::filesystem::copy_options::overwrite_existing);
        sql(broken, statement);
        sign(broken);
        const auto project = openProject(broken);
        return project ? std::string("ok") : project.error().code;
    };
    CHECK(with("UPDATE attachments SET mode = mode") == "ok");
    for (const char* statement :
         {"UPDATE attachments SET character = 99", "UPDATE attachments SET part = 3 WHERE part = 1", "UPDATE attachments SET part = -1 WHERE part = 1", "UPDATE attachments SET shell = 0 WHERE part = 1",
          "UPDATE attachments SET mode = 2", "UPDATE attachments SET pivot = zeroblob(8)", "UPDATE attachments SET pivot = x'000000000000f07f00000000000000000000000000000000' WHERE part = 1",
          "UPDATE attachments SET element = 1", "UPDATE attachments SET element = 99", "UPDATE part_turns SET turn = zeroblob(32)", "UPDATE part_turns SET turn = zeroblob(8)",
          "UPDATE part_turns SET part = 0", "UPDATE part_turns SET seconds = -1", "DELETE FROM attachments WHERE part = 1"}) {
        CAPTURE(statement);
        CHECK(with(statement) == "damaged");
    }
}

TEST_CASE("append: attached parts come with their character, their pivots and elements too") {
    Workbench w;
    buildFace(w);
    Json eye = attached("eye", "rigid");
    eye["pivot"] = {0.0, 0.5, 6.0};
    eye["element"] = "high";
    w.good(eye);
    const auto path = (Workbench::folder() / "append attached.imomushi").string();
    w.good({{"do", "save"}, {"path", path}});
    w.good({{"do", "append"}, {"path", path}, {"offset", {4.0, 0.25, 0.5}}});
    const Json parts = w.good({{"do", "list"}})["characters"][1]["parts"];
    CHECK(parts[1]["mode"] == "rigid");
    CHECK(parts[1]["element"] == "high 2");
    CHECK(parts[1]["pivot"] == Json::array({4.0, 0.75, 6.5}));
    CHECK(w.code({{"do", "turn-part"}, {"character", "worm 2"}, {"part", "eye"}, {"rotation", {0, 1, 0, 1}}}) == "ok");
}
