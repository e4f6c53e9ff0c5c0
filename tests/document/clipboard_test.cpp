// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/character_input.h"
#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

std::vector<std::string> clipNames(const Json& list) {
    std::vector<std::string> names;
    for (const Json& line : list) names.push_back(line.at("name").get<std::string>());
    return names;
}

Json clipOf(Workbench& w, const std::vector<std::string>& names) { return w.good({{"do", "copy"}, {"names", names}})["commands"]; }

Vec3 endAtRest(Workbench& w, const char* bone, bool atEnd) {
    const Bone* found = w.session.document().boneNamed(bone);
    REQUIRE(found);
    const auto at = restPosition(w.session.document(), atEnd ? found->end : found->start);
    REQUIRE(at);
    return *at;
}

/// A chain of three bones, with limits, besides one that is not copied.
void buildClippedArm(Workbench& w) {
    w.good({{"do", "add-bone"}, {"name", "trunk"}, {"from", {0, 0, 0}}, {"to", {0, 1, 0}}});
    w.good({{"do", "add-bone"}, {"name", "upper"}, {"from", "trunk/end"}, {"to", {1, 1, 0}}, {"roll", 0.25}});
    w.good({{"do", "add-bone"}, {"name", "lower"}, {"from", "upper/end"}, {"to", {2, 1, 0}}, {"parent", "upper"}});
    w.good({{"do", "set"}, {"target", "lower"}, {"property", "max-bend"}, {"value", 0.5}});
}

}  // namespace

TEST_CASE("copy and paste: a chain of bones stands beside itself with its parents, roll and limits, and one undo takes it back") {
    Workbench w;
    buildClippedArm(w);
    const std::string before = w.content();
    const Json commands = clipOf(w, {"lower", "upper"});
    CHECK(w.content() == before);
    const Json answer = w.good({{"do", "paste"}, {"commands", commands}});
    CHECK(clipNames(answer["bones"]) == std::vector<std::string>{"upper 2", "lower 2"});
    const Document& d = w.session.document();
    CHECK(d.boneNamed("lower 2")->parent == d.boneNamed("upper 2")->id);
    CHECK(d.boneNamed("upper 2")->roll == 0.25);
    CHECK(d.boneNamed("lower 2")->maxBend == 0.5);
    CHECK(std::get<EndpointRef>(d.boneNamed("lower 2")->start) == EndpointRef{d.boneNamed("upper 2")->id, true});
    const Vec3 shift = endAtRest(w, "upper 2", false) - endAtRest(w, "upper", false);
    CHECK(shift.x() > 2.0);  // beside, along x, with room between
    CHECK((endAtRest(w, "lower 2", true) - endAtRest(w, "lower", true) - shift).norm() < 1e-12);
    // What it hung on is elsewhere, and that is said.
    REQUIRE(answer["not_pasted"].size() == 1);
    CHECK(answer["not_pasted"][0]["name"] == "upper 2/start");
    w.good({{"do", "undo"}});
    CHECK(w.content() == before);
    w.good({{"do", "redo"}});
    CHECK(w.session.document().bones.size() == 5);
}

TEST_CASE("copy and paste: in another project bones keep their places and names, and hang on what is there at the same place") {
    Workbench w, other;
    buildClippedArm(w);
    const Json commands = clipOf(w, {"upper", "lower"});
    other.good({{"do", "add-bone"}, {"name", "trunk"}, {"from", {0, 0, 0}}, {"to", {0, 1, 0}}});
    const Json answer = other.good({{"do", "paste"}, {"commands", commands}});
    CHECK(answer["not_pasted"].empty());
    const Document& d = other.session.document();
    CHECK(std::get<EndpointRef>(d.boneNamed("upper")->start) == EndpointRef{d.boneNamed("trunk")->id, true});
    CHECK((endAtRest(other, "lower", true) - Vec3(2, 1, 0)).norm() == 0.0);
    // Elsewhere its end would not be where it was.
    Workbench third;
    third.good({{"do", "add-bone"}, {"name", "trunk"}, {"from", {0, 0, 0}}, {"to", {0, 3, 0}}});
    CHECK(third.good({{"do", "paste"}, {"commands", commands}})["not_pasted"][0]["code"] == "loose-end");
    CHECK((endAtRest(third, "upper", false) - Vec3(0, 1, 0)).norm() == 0.0);
}

TEST_CASE("copy and paste: joint faces and handles go on the same element, on a copy of it elsewhere, and by their plane on another mesh") {
    Workbench w;
    w.good({{"do", "import-element"}, {"path", "bar0"}, {"name", "A"}});
    w.good({{"do", "import-element"}, {"path", "bar1"}, {"name", "B"}});
    w.good({{"do", "import-element"}, {"path", "coarse0"}, {"name", "C"}});
    w.addFace("A", "in", 0, -1);
    w.good({{"do", "handle"}, {"element", "A"}, {"name", "knob"}, {"point", {0.5, 0.1, 1.4}}, {"radius", 0.4}});
    const Json commands = clipOf(w, {"A/in", "knob"});
    // A shifted copy of the mesh: the same vertices, and the handle moves along.
    const Json onB = w.good({{"do", "paste"}, {"commands", commands}, {"onto", "B"}});
    CHECK(clipNames(onB["faces"]) == std::vector<std::string>{"B/in"});
    CHECK(clipNames(onB["handles"]) == std::vector<std::string>{"knob 2"});
    const Document& d = w.session.document();
    CHECK(d.elementNamed("B")->faces[0].vertices == d.elementNamed("A")->faces[0].vertices);
    CHECK((d.elementNamed("B")->handles[0].point - d.elementNamed("A")->handles[0].point - Vec3(0, 0, 3)).norm() < 1e-9);
    // Other triangles: by the plane.
    const Json onC = w.good({{"do", "paste"}, {"commands", commands}, {"onto", "C"}});
    CHECK(onC["not_pasted"].empty());
    CHECK(d.elementNamed("C")->faces[0].frame.origin.z() == doctest::Approx(0.0));
    // Where it is already there is no room.
    CHECK(w.session.execute({{"do", "paste"}, {"commands", clipOf(w, {"A/in"})}}).error().code == "nothing-to-paste");
    w.good({{"do", "remove-joint-face"}, {"face", "A/in"}});
    CHECK(clipNames(w.good({{"do", "paste"}, {"commands", commands}})["faces"]) == std::vector<std::string>{"A/in"});
}

TEST_CASE("copy and paste: an element comes with its bones and results into another project, and beside itself at home") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    const std::string path = (Workbench::folder() / "clip.imomushi").string();
    const Json commands = w.good({{"do", "copy"}, {"names", {"A", "a"}}, {"path", path}})["commands"];
    REQUIRE(commands.size() == 1);  // its bone comes with it
    Workbench other;
    const Json there = other.good({{"do", "paste"}, {"commands", commands}});
    CHECK(clipNames(there["elements"]) == std::vector<std::string>{"A"});
    CHECK(clipNames(there["bones"]) == std::vector<std::string>{"a"});
    CHECK(other.session.responseState(other.session.document().elementNamed("A")->id) == ResponseState::Fresh);
    const Json here = w.good({{"do", "paste"}, {"commands", commands}});
    CHECK(here["elements"][0]["name"] == "A 2");
    CHECK(here["elements"][0]["from"] == "A");
    const auto low = [&](const char* name) { return w.session.document().elementNamed(name)->mesh->body.vertices.col(0).minCoeff(); };
    CHECK(low("A 2") > low("A") + 1.0);
    CHECK(w.session.execute({{"do", "copy"}, {"names", {"A"}}}).error().code == "missing-key");
}

TEST_CASE("copy and paste: cuts go on another character, settings of effects into another project") {
    Workbench w, other;
    for (Workbench* one : {&w, &other}) one->good({{"do", "import-character"}, {"path", "trunk"}, {"name", "worm"}});
    w.good({{"do", "cut"}, {"element", "worm"}, {"plane", {{"origin", {0, 0, 5}}, {"normal", {0, 0, 1}}}}, {"name", "waist"}});
    w.good({{"do", "set"}, {"target", "bone-dynamics"}, {"property", "air-damping"}, {"value", 2.5}});
    w.good({{"do", "enable"}, {"effect", "bone-dynamics"}});
    const Json answer = other.good({{"do", "paste"}, {"commands", clipOf(w, {"waist", "bone-dynamics", "ground"})}});
    CHECK(clipNames(answer["cuts"]) == std::vector<std::string>{"waist"});
    CHECK(answer["not_pasted"].empty());
    const Document& d = other.session.document();
    CHECK(d.characters.begin()->second->cuts.size() == 1);
    CHECK(d.effects.has(EffectKind::BoneDynamics));
    CHECK(d.effects.number(EffectKind::BoneDynamics, "air-damping") == 2.5);
    CHECK_FALSE(d.effects.has(EffectKind::Ground));
}

TEST_CASE("paste: what anybody may have put there is told and left out, and changes nothing") {
    Workbench w;
    buildClippedArm(w);
    const std::string before = w.content();
    for (const Json& line : {Json(3), Json::array(), Json{{"do", "save"}, {"path", "/tmp/x.imomushi"}}, Json{{"do", "add-bone"}}, Json{{"do", "add-bone"}, {"name", "x"}, {"from", "y/end"}, {"to", 3}},
                             Json{{"do", "set"}, {"target", "trunk"}, {"property", "roll"}, {"value", 1}}, Json{{"do", "append"}, {"path", "/nowhere/x.imomushi"}},
                             Json{{"do", "add-bone"}, {"name", "x"}, {"from", {0, 0, 0}}, {"to", {0, 0, 1e300}}, {"was", 7}}}) {
        CAPTURE(line.dump());
        CHECK(w.session.execute({{"do", "paste"}, {"commands", Json::array({line})}}).error().code == "nothing-to-paste");
        CHECK(w.content() == before);
    }
    CHECK(w.session.execute({{"do", "paste"}, {"commands", Json::array()}}).error().code == "nothing-to-paste");
    CHECK(w.session.execute({{"do", "paste"}, {"commands", clipOf(w, {"upper"})}, {"onto", "nobody"}}).error().code == "no-such-element");
}

TEST_CASE("duplicate: bones alone stand beside themselves, with their chain") {
    Workbench w;
    buildClippedArm(w);
    const Json answer = w.good({{"do", "duplicate"}, {"names", {"upper", "lower"}}});
    CHECK(clipNames(answer["bones"]) == std::vector<std::string>{"upper 2", "lower 2"});
    CHECK((endAtRest(w, "lower 2", true) - endAtRest(w, "lower", true)).x() > 1.0);
    CHECK(w.session.document().boneNamed("lower 2")->parent == w.session.document().boneNamed("upper 2")->id);
}
