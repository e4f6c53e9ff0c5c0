// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/connectivity.h"
#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

/// Characters of the workbench, and: "finer", the trunk with other triangles, a little bent and thicker; "short", the trunk as far as z = 7; "trunk in mm".
Result<CharacterFile> characterFile(const ImportRequest& request, const Progress& progress) {
    const std::string name = request.path.string();
    if (name == "finer") {
        TriangleMesh mesh = shapes::box({-0.55, -0.5, 0.0}, {0.55, 0.5, 12.0}, 4, 4, 41).mesh;
        for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) mesh.vertices(v, 1) += 0.01 * std::sin(mesh.vertices(v, 2));
        return Workbench::characterOf({mesh}, {"trunk"});
    }
    if (name == "short") return Workbench::characterOf({shapes::box({-0.5, -0.5, 0.0}, {0.5, 0.5, 7.0}, 3, 3, 20).mesh}, {"trunk"});
    if (name == "trunk in mm") {
        CharacterFile file = Workbench::characterOf({Workbench::longBar()}, {"trunk"});
        file.renderModel.mesh.body.vertices *= 1000.0;
        return file;
    }
    return Workbench::characterFile(request, progress);
}

void buildReplaced(Workbench& w) {
    w.session.services().importCharacter = characterFile;
    w.good({{"do", "import-character"}, {"path", "snowman"}, {"name", "T"}});
    w.good({{"do", "cut"}, {"element", "T"}, {"plane", {{"origin", {0, 0, 4}}, {"normal", {0, 0, 1}}}}, {"names", {"low", "mid"}}, {"name", "waist"}});
    w.good({{"do", "cut"}, {"element", "mid"}, {"plane", {{"origin", {0, 0, 8}}, {"normal", {0, 0, 1}}}}, {"names", {"mid", "top"}}, {"name", "neck"}});
    w.addFace("top", "tip", 12, 1);
    w.addFace("low", "foot", 0, -1);
    w.good({{"do", "handle"}, {"element", "mid"}, {"name", "belly"}, {"point", {0.5, 0, 6}}, {"radius", 0.3}});
    w.good({{"do", "add-bone"}, {"name", "a"}, {"from", "low/foot"}, {"to", "low/waist"}});
    w.good({{"do", "add-bone"}, {"name", "b"}, {"from", "a/end"}, {"to", "mid/neck"}});
    w.good({{"do", "add-bone"}, {"name", "c"}, {"from", "b/end"}, {"to", "top/tip"}});
    w.good({{"do", "attach"}, {"character", "T"}, {"part", "eye"}, {"mode", "rigid"}});
}

}  // namespace

TEST_CASE("replace-mesh: another mesh takes over cuts, joint faces, handles and bones of a character, as one step") {
    Workbench w;
    buildReplaced(w);
    const std::string before = w.content();
    const Json answer = w.good({{"do", "replace-mesh"}, {"character", "T"}, {"path", "finer"}});
    CHECK(answer["kept"]["cuts"] == Json::array({"waist", "neck"}));
    CHECK(answer["kept"]["handles"] == Json::array({"belly"}));
    CHECK(answer["kept"]["faces"].size() == 6);
    CHECK(answer["kept"]["bones"] == Json::array({"a", "b", "c"}));
    REQUIRE(answer["lost"].size() == 1);
    CHECK(answer["lost"][0]["name"] == "eye");
    CHECK(answer["stale"].size() == 3);
    const Document& d = w.session.document();
    CHECK(d.joints.size() == 2);
    const CharacterSource& T = *d.characterNamed("T");
    CHECK(T.attachments.empty());
    double volume = 0.0;
    for (const PartId id : d.elementsOf(T.id)) volume += d.elements.at(id)->mesh->connectivity().facts().volume;
    CHECK(volume == doctest::Approx(13.2).epsilon(1e-4));
    const Element& top = *d.elementNamed("top");
    const JointFace& tip = top.faces[static_cast<std::size_t>(top.faceIndex("tip"))];
    CHECK((tip.frame.origin - Vec3(0, 0.01 * std::sin(12.0), 12)).norm() < 1e-9);
    CHECK(tip.area == doctest::Approx(1.1).epsilon(1e-3));
    CHECK(w.good({{"do", "measure"}, {"what", "length"}, {"bone", "b"}})["value"].get<double>() == doctest::Approx(4.0).epsilon(1e-2));
    w.good({{"do", "move-cut"}, {"cut", "neck"}, {"plane", {{"origin", {0, 0, 9}}, {"normal", {0, 0, 1}}}}});
    CHECK(w.session.character() != nullptr);
    const auto path = (Workbench::folder() / "replaced.imomushi").string();
    w.good({{"do", "save"}, {"path", path}});
    CHECK(Workbench().good({{"do", "open"}, {"path", path}})["characters"][0]["cuts"].size() == 2);
    const std::string after = w.content();
    w.good({{"do", "undo"}, {"count", 2}});
    CHECK(w.content() == before);
    w.good({{"do", "redo"}, {"count", 2}});
    CHECK(w.content() == after);
}

TEST_CASE("replace-mesh: the same mesh again changes nothing that was computed") {
    Workbench w;
    buildReplaced(w);
    for (const char* element : {"low", "mid", "top"}) w.good({{"do", "set"}, {"target", element}, {"property", "solver-mesh"}, {"value", "as-is"}});
    w.good({{"do", "precompute"}});
    const Json answer = w.good({{"do", "replace-mesh"}, {"character", "T"}, {"path", "snowman"}});
    CHECK(answer["lost"].empty());
    CHECK(answer["stale"].empty());
    CHECK(answer["kept"]["parts"] == Json::array({"eye"}));
    for (const Json all = w.good({{"do", "precompute"}}); const Json& line : all["elements"]) CHECK(line["cached"] == true);
}

TEST_CASE("replace-mesh: what has no place on the new mesh is lost with the reason, bones stay where they are") {
    Workbench w;
    buildReplaced(w);
    const Json answer = w.good({{"do", "replace-mesh"}, {"character", "T"}, {"path", "short"}});
    CHECK(answer["kept"]["cuts"] == Json::array({"waist"}));
    std::vector<std::string> lost;
    for (const Json& line : answer["lost"]) {
        lost.push_back(line["what"].get<std::string>() + " " + line["name"].get<std::string>());
        CHECK_FALSE(line["why"].get<std::string>().empty());
    }
    CHECK(lost == std::vector<std::string>{"cut neck", "face mid/tip", "part eye"});
    const Document& d = w.session.document();
    CHECK(d.elements.size() == 2);
    CHECK((std::get<Vec3>(d.boneNamed("c")->end) - Vec3(0, 0, 12)).norm() < 1e-12);
    CHECK(w.session.character() != nullptr);
}

TEST_CASE("replace-mesh: of an element faces are found again by plane and by place, joints that tear are let go") {
    Workbench w;
    w.buildChain();
    const std::string before = w.content();
    const Json answer = w.good({{"do", "replace-mesh"}, {"element", "B"}, {"path", "coarse1"}});
    CHECK(answer["kept"]["faces"] == Json::array({"B/in", "B/out"}));
    CHECK(answer["kept"]["bones"] == Json::array({"b"}));
    CHECK(answer["lost"].empty());
    CHECK(w.session.document().joints.size() == 1);
    w.good({{"do", "undo"}});
    CHECK(w.content() == before);
    // Another place: the face is not there, and nothing is joined any more.
    const Json elsewhere = w.good({{"do", "replace-mesh"}, {"element", "B"}, {"path", "bar5"}});
    CHECK(elsewhere["kept"]["faces"].empty());
    CHECK(elsewhere["lost"].size() == 2);
    CHECK(w.session.document().joints.empty());
    CHECK((std::get<Vec3>(w.session.document().boneNamed("b")->end) - Vec3(0, 0, 6)).norm() < 1e-12);
}

TEST_CASE("replace-mesh: what cannot be done is refused and changes nothing") {
    Workbench w;
    buildReplaced(w);
    w.good({{"do", "import-element"}, {"path", "bar9"}, {"name", "A"}});
    const std::string before = w.content();
    CHECK(w.code({{"do", "replace-mesh"}, {"character", "T"}, {"path", "trunk in mm"}}) == "other-size");
    CHECK(w.code({{"do", "replace-mesh"}, {"character", "T"}, {"path", "none"}}) == "file-not-found");
    CHECK(w.code({{"do", "replace-mesh"}, {"character", "none"}, {"path", "trunk"}}) == "no-such-character");
    CHECK(w.code({{"do", "replace-mesh"}, {"element", "mid"}, {"path", "bar1"}}) == "part-of-character");
    CHECK(w.code({{"do", "replace-mesh"}, {"element", "none"}, {"path", "bar1"}}) == "no-such-element");
    CHECK(w.code({{"do", "replace-mesh"}, {"element", "A"}, {"path", "pair"}}) == "several-bodies");
    CHECK(w.code({{"do", "replace-mesh"}, {"element", "A"}, {"path", "open"}}) == "open");
    CHECK(w.code({{"do", "replace-mesh"}, {"element", "A"}, {"character", "T"}, {"path", "bar1"}}) == "missing-key");
    CHECK(w.code({{"do", "replace-mesh"}, {"path", "bar1"}}) == "missing-key");
    CHECK(w.code({{"do", "replace-mesh"}, {"element", "A"}, {"path", "bar1"}, {"body", "auto"}}) == "unknown-key");
    CHECK(w.code({{"do", "replace-mesh"}, {"character", "T"}, {"path", "trunk"}, {"body", "best"}}) == "bad-value");
    CHECK(w.content() == before);
}
