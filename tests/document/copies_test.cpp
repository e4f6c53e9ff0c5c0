// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <random>

#include "core/document/side_names.h"
#include "core/mesh/connectivity.h"
#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

const Element& elementNamed(Workbench& w, const char* name) {
    const Element* found = w.session.document().elementNamed(name);
    REQUIRE(found);
    return *found;
}

Json listed(Workbench& w, const char* what, const std::string& name) {
    const Json list = w.good({{"do", "list"}})[what];
    for (const Json& line : list)
        if (line["name"] == name) return line;
    FAIL("there is no " << what << " " << name);
    return {};
}

/// Inverse kinematics has settled when it moves by 1e-6 of a bone's length (3 m) per solve, and some ten of these may be left; nothing else differs.
constexpr double kKinematics = 3e-5;

/// An arm of two bars away from the plane x = 0, with sides in its names.
void buildArm(Workbench& w) {
    w.good({{"do", "import-element"}, {"path", "bar0"}, {"name", "upper.L"}});
    w.good({{"do", "import-element"}, {"path", "bar1"}, {"name", "lower.L"}});
    for (const char* element : {"upper.L", "lower.L"}) w.good({{"do", "set"}, {"target", element}, {"property", "solver-mesh"}, {"value", "as-is"}});
    w.addFace("upper.L", "in", 0, -1);
    w.addFace("upper.L", "out", 3, 1);
    w.addFace("lower.L", "in", 3, -1);
    w.addFace("lower.L", "out", 6, 1);
    w.good({{"do", "join"}, {"a", "upper.L/out"}, {"b", "lower.L/in"}});
    w.good({{"do", "add-bone"}, {"name", "shoulder_l"}, {"from", "upper.L/in"}, {"to", "upper.L/out"}, {"roll", 0.3}});
    w.good({{"do", "add-bone"}, {"name", "leftElbow"}, {"from", "shoulder_l/end"}, {"to", "lower.L/out"}});
}

double largestDifference(const Points& a, const Points& b) { return (a - b).cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("names: the other side, there and back, and no side in words that only begin like one") {
    for (const auto& [left, right] : {std::pair{"arm.L", "arm.R"}, {"arm_l", "arm_r"}, {"arm-L 2", "arm-R 2"}, {"arm.L.001", "arm.R.001"}, {"L_arm", "R_arm"}, {"LeftArm", "RightArm"},
                                      {"mixamorig:LeftHand", "mixamorig:RightHand"}, {"left leg", "right leg"}, {"eyeLeft", "eyeRight"}, {"ARM_LEFT", "ARM_RIGHT"}, {"左腕", "右腕"}}) {
        CHECK(otherSide(left) == right);
        CHECK(otherSide(right) == left);
    }
    for (const char* name : {"spine", "leftover", "copyright", "BRIGHT", "L", ".L", "arm.LL", "hull", ""}) CHECK(otherSide(name) == name);
    CHECK(otherSide("brazo.izq", {".izq", ".der"}) == "brazo.der");
    CHECK(otherSide("brazo.der", {".izq", ".der"}) == "brazo.izq");
    CHECK(otherSide("arm.L", {".izq", ".der"}) == "arm.L");
}

TEST_CASE("duplicate: elements with bones, joints, pins and effects stand beside the first ones, their results with them, as one step") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "add-bone"}, {"name", "free"}, {"from", {5, 0, 0}}, {"to", {5, 0, 1}}});
    w.good({{"do", "enable"}, {"effect", "gravity"}, {"target", "A"}});
    w.good({{"do", "precompute"}});
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    const std::string before = w.content();
    const Json answer = w.good({{"do", "duplicate"}, {"names", {"A", "B"}}, {"offset", {4, 0.5, -0.25}}});
    CHECK(answer["elements"] == Json::array({{{"name", "A 2"}, {"from", "A"}}, {{"name", "B 2"}, {"from", "B"}}}));
    CHECK(answer["bones"] == Json::array({{{"name", "a 2"}, {"from", "a"}}, {{"name", "b 2"}, {"from", "b"}}}));
    for (const char* name : {"A 2", "B 2"}) CHECK(listed(w, "elements", name)["state"] == "fresh");
    CHECK(w.good({{"do", "list"}})["joints"] == Json::array({{"A/out", "B/in"}, {"A 2/out", "B 2/in"}}));
    const Document& d = w.session.document();
    CHECK(d.effects.has(EffectKind::Gravity, elementNamed(w, "A 2").id));
    CHECK_FALSE(d.effects.has(EffectKind::Gravity, elementNamed(w, "B 2").id));
    CHECK(d.goals.at({d.boneNamed("a 2")->id, false}).pinned);
    for (const Json all = w.good({{"do", "precompute"}}); const Json& line : all["elements"]) CHECK(line["cached"] == true);
    // The copies move as the first ones do.
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1, 0.4, 5.2}}});
    w.good({{"do", "drag"}, {"endpoint", "b 2/end"}, {"to", {5, 0.9, 4.95}}});
    for (const auto& [first, copy] : {std::pair{"A", "A 2"}, {"B", "B 2"}}) {
        const Points is = w.session.positionsOf(elementNamed(w, copy).id), was = w.session.positionsOf(elementNamed(w, first).id);
        CHECK(((is - was).rowwise() - Eigen::RowVector3d(4, 0.5, -0.25)).cwiseAbs().maxCoeff() < kKinematics);
    }
    const std::string after = w.content();
    w.good({{"do", "undo"}, {"count", 3}});
    CHECK(w.content() == before);
    w.good({{"do", "redo"}, {"count", 3}});
    CHECK(w.content() == after);
    // In the file, too.
    const auto path = (Workbench::folder() / "twice.imomushi").string();
    w.good({{"do", "save"}, {"path", path}});
    Workbench other;
    CHECK(other.good({{"do", "open"}, {"path", path}})["elements"].size() == 4);
    CHECK(listed(other, "elements", "B 2")["state"] == "fresh");
}

TEST_CASE("duplicate: in takes copies do what the first ones do, which stay as they were to the byte, with any effects") {
    const Vec3 offset(4, 0.5, -0.25);
    constexpr double kSingle = 5e-6;  // m: single precision at ten metres
    for (const std::vector<const char*>& effects : {std::vector<const char*>{}, {"bend-warp", "joint-dynamics", "gravity", "smooth-joints"}}) {
        CAPTURE(effects.size());
        Workbench w;
        w.buildChain();
        if (!effects.empty()) w.good({{"do", "set"}, {"target", "character"}, {"property", "basis"}, {"value", "modes:6"}});
        for (const char* effect : effects) w.good({{"do", "enable"}, {"effect", effect}});
        w.good({{"do", "precompute"}});
        w.good({{"do", "record"}, {"take", "dance"}, {"action", "start"}});
        w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.2, 0.4, 5.2}}, {"roll", 0.4}, {"seconds", 0.1}});
        w.good({{"do", "step"}, {"frames", 12}});
        w.good({{"do", "release"}});
        w.good({{"do", "record"}, {"take", "dance"}, {"action", "stop"}});
        const auto first = [&](const char* name) {
            w.good({{"do", "play"}, {"take", "dance"}, {"time", 0.1}});
            return w.session.positionsOf(elementNamed(w, name).id);
        };
        const std::map<std::string, Points> was = {{"A", first("A")}, {"B", first("B")}};
        w.good({{"do", "step"}, {"frames", 1}});
        const std::string before = w.content();
        CHECK(w.good({{"do", "duplicate"}, {"names", {"A", "B"}}, {"offset", {offset.x(), offset.y(), offset.z()}}})["takes"] == Json::array({"dance"}));
        CHECK(w.good({{"do", "play"}, {"take", "dance"}, {"time", 0.1}})["exact"] == true);
        for (const char* name : {"A", "B"}) {
            CHECK(first(name) == was.at(name));
            CHECK(((first((std::string(name) + " 2").c_str()) - was.at(name)).rowwise() - offset.transpose()).cwiseAbs().maxCoeff() < kSingle);
        }
        // Between frames, too, and in poses alone, which is what another character shows.
        w.good({{"do", "play"}, {"take", "dance"}, {"time", 0.109}});
        CHECK(((w.session.positionsOf(elementNamed(w, "B 2").id) - w.session.positionsOf(elementNamed(w, "B").id)).rowwise() - offset.transpose()).cwiseAbs().maxCoeff() < kSingle);
        const Json end = w.good({{"do", "measure"}, {"what", "position"}, {"endpoint", "b/end"}})["value"], copy = w.good({{"do", "measure"}, {"what", "position"}, {"endpoint", "b 2/end"}})["value"];
        for (std::size_t k = 0; k < 3; ++k) CHECK(copy[k].get<double>() - end[k].get<double>() == doctest::Approx(offset[static_cast<Eigen::Index>(k)]));
        CHECK(w.session.document().takeNamed("dance")->targets.size() == 2);
        w.good({{"do", "step"}, {"frames", 1}});
        const std::string after = w.content();
        w.good({{"do", "undo"}});
        CHECK(w.content() == before);
        w.good({{"do", "redo"}});
        CHECK(w.content() == after);
        // An arm alone performs where it is put, but for what smooth joints made of its neighbour; bones that are put onto others are led by these, and rest in takes.
        CHECK(w.good({{"do", "duplicate"}, {"names", {"B"}}, {"offset", {-4, 0, 0}}})["takes"] == Json::array({"dance"}));
        CHECK(((first("B 3") - was.at("B")).rowwise() - Eigen::RowVector3d(-4, 0, 0)).cwiseAbs().maxCoeff() < (effects.empty() ? kSingle : 0.15));
        CHECK(w.good({{"do", "duplicate"}, {"names", {"B 3"}}, {"offset", {0, 0, 3}}})["takes"] == Json::array());
    }
}

TEST_CASE("duplicate: characters with attached parts and morph targets perform as the first ones") {
    Workbench w;
    w.session.services().importCharacter = [](const ImportRequest&, const Progress& progress) -> Result<CharacterFile> {
        auto file = Workbench::characterFile({"snowman", {}, {}, {}, {}}, progress);
        MorphTarget smile{"smile", 0.0, {0, 1, 2}, {}};
        smile.deltas = decltype(smile.deltas)::Constant(3, 3, 0.1f);
        file->renderModel.morphs.push_back(smile);
        return file;
    };
    w.good({{"do", "import-character"}, {"path", "snowman"}, {"name", "man"}});
    w.good({{"do", "attach"}, {"character", "man"}, {"part", "eye"}, {"mode", "rigid"}});
    w.good({{"do", "add-bone"}, {"name", "back"}, {"from", {0, 0, 0.5}}, {"to", {0, 0, 11.5}}});
    w.good({{"do", "record"}, {"take", "look"}, {"action", "start"}});
    w.good({{"do", "turn-part"}, {"character", "man"}, {"part", "eye"}, {"rotation", {0.0, 0.6, 0.0, 0.8}}});
    w.good({{"do", "morph"}, {"character", "man"}, {"target", "smile"}, {"weight", 0.75}});
    w.good({{"do", "drag"}, {"endpoint", "back/end"}, {"to", {3.0, 1.0, 10.0}}});
    w.good({{"do", "step"}, {"frames", 3}});
    w.good({{"do", "record"}, {"take", "look"}, {"action", "stop"}});
    CHECK(w.good({{"do", "duplicate"}, {"names", {"man"}}, {"offset", {5, 0, 0}}})["takes"] == Json::array({"look"}));
    CHECK(w.good({{"do", "play"}, {"take", "look"}, {"time", 0.03}})["exact"] == true);
    const auto seen = [&](const char* name) { return w.session.renderPositionsOf(w.session.document().characterNamed(name)->id); };
    CHECK(((seen("man 2") - seen("man")).rowwise() - Eigen::RowVector3d(5, 0, 0)).cwiseAbs().maxCoeff() < 1e-5);
    CHECK(w.session.character()->morphWeights(1)[0] == 0.75);
}

TEST_CASE("duplicate: beside the first unless told, bones alone, a whole character for its piece; what is not there is refused") {
    Workbench w;
    w.buildChain();
    CHECK(w.good({{"do", "duplicate"}, {"names", {"A"}}})["offset"] == Json::array({1.1, 0.0, 0.0}));  // as wide as a bar, and a tenth
    const Json bone = w.good({{"do", "duplicate"}, {"names", {"b"}}, {"offset", {0, 3, 0}}});
    CHECK(bone["bones"][0]["name"] == "b 2");
    CHECK(bone["elements"].empty());
    CHECK(w.good({{"do", "duplicate"}, {"names", {"A 2"}}})["elements"][0]["name"] == "A 3");
    w.good({{"do", "import-character"}, {"path", "trunk"}, {"name", "T"}});
    w.good({{"do", "cut"}, {"element", "T"}, {"plane", {{"origin", {0, 0, 4}}, {"normal", {0, 0, 1}}}}, {"names", {"low", "high"}}, {"name", "waist"}});
    w.good({{"do", "handle"}, {"element", "high"}, {"name", "tip"}, {"point", {0.5, 0, 9}}, {"radius", 0.4}});
    const Json whole = w.good({{"do", "duplicate"}, {"names", {"high"}}, {"offset", {9, 0, 0}}});
    CHECK(whole["characters"] == Json::array({{{"name", "T 2"}, {"from", "T"}}}));
    CHECK(whole["cuts"][0]["name"] == "waist 2");
    CHECK(whole["handles"][0]["name"] == "tip 2");
    CHECK(whole["elements"].size() == 2);
    w.good({{"do", "move-cut"}, {"cut", "waist 2"}, {"plane", {{"origin", {9, 0, 5}}, {"normal", {0, 0, 1}}}}});
    const std::string before = w.content();
    CHECK(w.code({{"do", "duplicate"}, {"names", Json::array()}}) == "no-element");
    CHECK(w.code({{"do", "duplicate"}, {"names", {"none"}}}) == "no-such-element");
    CHECK(w.code({{"do", "duplicate"}, {"names", {1}}}) == "bad-type");
    CHECK(w.code({{"do", "duplicate"}, {"names", {"A"}}, {"offset", {1e9, 0, 0}}}) == "bad-value");
    CHECK(w.code({{"do", "duplicate"}, {"names", {"B"}}, {"offset", {0, 0, 0}}}) == "bone-loop");  // in the very same place
    CHECK(w.content() == before);
}

TEST_CASE("mirror: an arm becomes the other arm, names change sides, and its results are reflected instead of solved again") {
    Workbench w;
    buildArm(w);
    w.good({{"do", "set"}, {"target", "lower.L"}, {"property", "nu"}, {"value", 0.4}});
    w.good({{"do", "precompute"}});
    w.good({{"do", "pin"}, {"endpoint", "shoulder_l/start"}});
    const std::string before = w.content();
    const Json answer = w.good({{"do", "mirror"}, {"from", {"upper.L", "lower.L"}}, {"at", 2}});
    CHECK(answer["elements"] == Json::array({{{"name", "upper.R"}, {"from", "upper.L"}}, {{"name", "lower.R"}, {"from", "lower.L"}}}));
    CHECK(answer["bones"] == Json::array({{{"name", "shoulder_r"}, {"from", "shoulder_l"}}, {{"name", "rightElbow"}, {"from", "leftElbow"}}}));
    CHECK(answer["not_mirrored"].empty());
    const Document& d = w.session.document();
    CHECK(d.boneNamed("shoulder_r")->roll == -0.3);
    CHECK(elementNamed(w, "lower.R").nu == 0.4);
    for (const char* name : {"upper.R", "lower.R"}) {
        const MeshFacts& facts = elementNamed(w, name).mesh->connectivity().facts();
        CHECK(facts.outward);
        CHECK(facts.volume == doctest::Approx(3.0));
        CHECK(facts.low.x() == doctest::Approx(3.5));
        CHECK(listed(w, "elements", name)["state"] == "fresh");
    }
    const Json again = w.good({{"do", "precompute"}});
    CHECK(again["elements"][2]["cached"] == true);
    CHECK(again["elements"][2]["shared"] == "upper.L");
    CHECK(again["elements"][2]["mirrored"] == true);
    // Mirrored goals give the mirrored pose.
    w.good({{"do", "drag"}, {"endpoint", "leftElbow/end"}, {"to", {1, 0.4, 5.2}}});
    w.good({{"do", "drag"}, {"endpoint", "rightElbow/end"}, {"to", {3, 0.4, 5.2}}});
    for (const auto& [left, right] : {std::pair{"upper.L", "upper.R"}, {"lower.L", "lower.R"}}) {
        Points image = w.session.positionsOf(elementNamed(w, left).id);
        image.col(0) = (4.0 - image.col(0).array()).matrix().eval();
        CHECK(largestDifference(w.session.positionsOf(elementNamed(w, right).id), image) < kKinematics);
    }
    // Solved by itself in another session: as exact as stated, and the same up to quadrature on triangles as they are.
    const auto path = (Workbench::folder() / "mirrored.imomushi").string();
    w.good({{"do", "save"}, {"path", path}});
    const ElementResponse& reflected = *w.session.project().responses.at(elementNamed(w, "lower.R").id).response;
    Workbench fresh;
    fresh.good({{"do", "append"}, {"path", path}, {"elements", {"lower.R"}}});
    const PartId id = elementNamed(fresh, "lower.R").id;
    const auto solved = buildResponse(fresh.session.responseInput(id), {});
    REQUIRE(solved);
    CHECK((solved->response - reflected.response).norm() < 1e-5 * solved->response.norm());
    CHECK((solved->stiffness - reflected.stiffness).norm() < 1e-5 * solved->stiffness.norm());
    w.good({{"do", "undo"}, {"count", 3}});
    CHECK(w.content() == before);
}

TEST_CASE("mirror: results on the default solver mesh, where edges may collapse otherwise, equal those of a precompute within the stated error") {
    Workbench w;
    w.good({{"do", "import-element"}, {"path", "coarse1"}, {"name", "L_leg"}});
    w.addFace("L_leg", "in", 3, -1);
    w.good({{"do", "handle"}, {"element", "L_leg"}, {"name", "left knee"}, {"point", {0.5, 0.1, 4.2}}, {"radius", 0.4}});
    const Json own = w.good({{"do", "precompute"}})["elements"][0];
    w.good({{"do", "mirror"}, {"from", {"L_leg"}}, {"at", 1}});
    const PartId id = elementNamed(w, "R_leg").id;
    const auto reflected = w.session.response(id);
    REQUIRE(reflected);
    CHECK(reflected->quality.error == own["error"].get<double>());
    const auto solved = buildResponse(w.session.responseInput(id), {});
    REQUIRE(solved);
    const double difference = (solved->response - reflected->response).norm() / solved->response.norm();
    MESSAGE("mirrored against recomputed: " << difference << ", stated error " << reflected->quality.error);
    CHECK(difference <= reflected->quality.error);
}

TEST_CASE("mirror: half a body is joined to its mirror image, and to what its image meets") {
    Workbench w;
    w.good({{"do", "import-element"}, {"path", "bar1"}, {"name", "half"}});
    w.addFace("half", "middle", 3, -1);
    w.addFace("half", "end", 6, 1);
    w.good({{"do", "import-element"}, {"path", "bar-2"}, {"name", "beyond"}});
    w.addFace("beyond", "near", -3, 1);
    w.good({{"do", "add-bone"}, {"name", "b"}, {"from", "half/middle"}, {"to", "half/end"}});
    const Json answer = w.good({{"do", "mirror"}, {"from", {"half"}}, {"axis", "z"}, {"at", 3}});
    CHECK(answer["joined"] == Json::array({{"half 2/middle", "half/middle"}}));
    const Document& d = w.session.document();
    CHECK(std::holds_alternative<FaceRef>(d.boneNamed("b 2")->start));
    const Json far = w.good({{"do", "mirror"}, {"from", {"half"}}, {"axis", "z"}, {"at", 1.5}});
    CHECK(far["joined"] == Json::array({{"half 3/middle", "half 2/end"}, {"half 3/end", "beyond/near"}}));
    CHECK(w.session.character() != nullptr);
}

TEST_CASE("mirror: what lies in the plane, or is there already, is left out with the reason") {
    Workbench w;
    buildArm(w);
    const std::string before = w.content();
    CHECK(w.code({{"do", "mirror"}, {"from", {"upper.L"}}}) == "nothing-to-mirror");  // in the middle
    CHECK(w.code({{"do", "mirror"}, {"from", {"shoulder_l"}}}) == "nothing-to-mirror");
    CHECK(w.code({{"do", "mirror"}, {"from", Json::array()}}) == "nothing-to-mirror");
    CHECK(w.code({{"do", "mirror"}, {"from", {"none"}}}) == "no-such-target");
    CHECK(w.code({{"do", "mirror"}, {"from", {"upper.L/none"}}}) == "no-such-face");
    CHECK(w.code({{"do", "mirror"}, {"from", {2}}}) == "bad-type");
    CHECK(w.code({{"do", "mirror"}, {"from", {"upper.L"}}, {"axis", "w"}}) == "bad-value");
    CHECK(w.code({{"do", "mirror"}, {"from", {"upper.L"}}, {"at", 1e9}}) == "bad-value");
    CHECK(w.code({{"do", "mirror"}, {"from", {"upper.L"}}, {"suffixes", {".L"}}}) == "bad-type");
    CHECK(w.code({{"do", "mirror"}, {"from", {"upper.L"}}, {"at", 2}, {"suffixes", {".L", "/R"}}}) == "bad-name");
    CHECK(w.content() == before);
    // A bone whose start hangs on what is not mirrored is told to hang on nothing; once that is there, it hangs on it.
    const Json alone = w.good({{"do", "mirror"}, {"from", {"leftElbow"}}, {"at", 2}});
    CHECK(alone["bones"][0]["name"] == "rightElbow");
    CHECK(alone["not_mirrored"].size() == 2);
    w.good({{"do", "undo"}});
    w.good({{"do", "mirror"}, {"from", {"shoulder_l"}}, {"at", 2}});
    const Json on = w.good({{"do", "mirror"}, {"from", {"leftElbow"}}, {"at", 2}});
    CHECK(listed(w, "bones", "rightElbow")["start"] == "shoulder_r/end");
    CHECK(w.good({{"do", "mirror"}, {"from", {"upper.L"}}, {"at", 2}})["not_mirrored"][0]["why"] == "The bone \"shoulder_r\" is there already.");
}

TEST_CASE("mirror: a limb of a character is mirrored on the same body, with cuts, bones, handles and joint faces") {
    Workbench w;
    w.good({{"do", "import-character"}, {"path", "trunk"}, {"name", "T"}});
    w.good({{"do", "cut"}, {"element", "T"}, {"plane", {{"origin", {0, 0, 8}}, {"normal", {0, 0, 1}}}}, {"names", {"trunk", "arm.L"}}, {"name", "shoulder.L"}});
    w.good({{"do", "set"}, {"target", "arm.L"}, {"property", "nu"}, {"value", 0.3}});
    w.addFace("arm.L", "tip", 12, 1);
    w.good({{"do", "handle"}, {"element", "arm.L"}, {"name", "hand.L"}, {"point", {0.5, 0, 10}}, {"radius", 0.3}});
    w.good({{"do", "add-bone"}, {"name", "bone.L"}, {"from", "arm.L/shoulder.L"}, {"to", "arm.L/tip"}});
    w.good({{"do", "add-bone"}, {"name", "spine"}, {"from", {0, 0, 6}}, {"to", "bone.L/start"}});
    const std::string before = w.content();
    const Json answer = w.good({{"do", "mirror"}, {"from", {"arm.L"}}, {"axis", "z"}, {"at", 6}});
    CHECK(answer["not_mirrored"].empty());
    CHECK(answer["elements"] == Json::array({{{"name", "arm.R"}, {"from", "arm.L"}}}));
    CHECK(answer["cuts"] == Json::array({{{"name", "shoulder.R"}, {"from", "shoulder.L"}}}));
    CHECK(answer["handles"] == Json::array({{{"name", "hand.R"}, {"from", "hand.L"}}}));
    CHECK(answer["bones"] == Json::array({{{"name", "bone.R"}, {"from", "bone.L"}}}));
    CHECK(answer["faces"] == Json::array({{{"name", "arm.R/tip"}, {"from", "arm.L/tip"}}}));
    const Element& arm = elementNamed(w, "arm.R");
    CHECK(arm.nu == 0.3);
    CHECK(arm.mesh->connectivity().facts().volume == doctest::Approx(4.0));
    CHECK(arm.mesh->connectivity().facts().high.z() == doctest::Approx(4.0));
    CHECK(elementNamed(w, "trunk").mesh->connectivity().facts().volume == doctest::Approx(4.0));
    CHECK(listed(w, "bones", "bone.R")["start"] == "arm.R/shoulder.R");
    CHECK(listed(w, "bones", "bone.R")["end"] == "arm.R/tip");
    CHECK(listed(w, "bones", "bone.R")["element"] == "arm.R");
    CHECK((arm.handleOf("hand.R")->point - Vec3(0.5, 0, 2)).norm() < 1e-12);
    // Once more there is nothing to do.
    CHECK(w.good({{"do", "mirror"}, {"from", {"shoulder.L", "arm.L/tip", "spine"}}, {"axis", "z"}, {"at", 6}})["not_mirrored"][0]["why"] == "The cut \"shoulder.R\" is there already.");
    w.good({{"do", "undo"}, {"count", 2}});
    CHECK(w.content() == before);
    // A handle of an uncut body alone.
    w.good({{"do", "import-element"}, {"path", "bar9"}, {"name", "uncut"}});
    w.good({{"do", "handle"}, {"element", "uncut"}, {"name", "left ear"}, {"point", {0.5, 0, 28}}, {"radius", 0.2}});
    CHECK(w.good({{"do", "mirror"}, {"from", {"left ear"}}})["handles"][0]["name"] == "right ear");
    CHECK((elementNamed(w, "uncut").handleOf("right ear")->point - Vec3(-0.5, 0, 28)).norm() < 1e-12);
}

TEST_CASE("mirror: limbs beside each other get an image each") {
    Workbench w;
    w.session.services().importCharacter = [](const ImportRequest&, const Progress&) { return Workbench::characterOf({shapes::box({-0.5, -0.5, 0.0}, {0.5, 0.5, 12.0}, 3, 3, 240).mesh}, {"trunk"}); };
    w.good({{"do", "import-character"}, {"path", "fine trunk"}, {"name", "T"}});
    // Two cuts nearer to each other than what still counts as the same place across a cut.
    w.good({{"do", "cut"}, {"element", "T"}, {"plane", {{"origin", {0, 0, 8}}, {"normal", {0, 0, 1}}}}, {"names", {"trunk", "arm.L"}}, {"name", "shoulder.L"}});
    w.good({{"do", "cut"}, {"element", "arm.L"}, {"plane", {{"origin", {0, 0, 8.1}}, {"normal", {0, 0, 1}}}}, {"names", {"ring.L", "hand.L"}}, {"name", "wrist.L"}});
    const Json answer = w.good({{"do", "mirror"}, {"from", {"shoulder.L", "wrist.L"}}, {"axis", "z"}, {"at", 6}});
    CHECK(answer["not_mirrored"].empty());
    CHECK(answer["cuts"].size() == 2);
    CHECK(w.session.document().elements.size() == 5);
}

TEST_CASE("copies: the disc of a handle stays apart from a joint face that gets its name, and drafts stay drafts") {
    Workbench w;
    w.good({{"do", "import-element"}, {"path", "bar0"}, {"name", "palm"}});
    w.addFace("palm", "grip.L", 0, -1);
    w.good({{"do", "handle"}, {"element", "palm"}, {"name", "grip.R"}, {"point", {0.5, 0, 1.5}}, {"radius", 0.3}});
    w.good({{"do", "mirror"}, {"from", {"palm"}}, {"at", 4}});
    const Element& image = *std::prev(w.session.document().elements.end())->second;
    REQUIRE(image.handles.size() == 1);
    const JointFace& disc = image.faces[static_cast<std::size_t>(image.faceIndex(image.handles[0].face))];
    CHECK((disc.frame.origin - image.handles[0].point).norm() < 0.1);

    // As drafts they are not solved again, and not out of date.
    Workbench drafts;
    drafts.good({{"do", "import-character"}, {"path", "trunk"}, {"name", "T"}});
    drafts.good({{"do", "make-soft"}, {"character", "T"}, {"draft", true}, {"precompute", false}});
    const Document& d = drafts.session.document();
    for (const auto& [id, element] : d.elements) REQUIRE(drafts.session.responses().isDraft(id));
    drafts.good({{"do", "duplicate"}, {"names", {"T"}}, {"offset", {4, 0, 0}}});
    for (const auto& [id, element] : d.elements) CHECK(drafts.session.responses().isDraft(id));
}

TEST_CASE("mirror: a whole character is copied with its cuts, which can be moved; textures stay where they are on it") {
    Workbench w;
    w.session.services().importCharacter = [](const ImportRequest& request, const Progress& progress) {
        auto file = Workbench::characterFile(request, progress);
        RenderMesh& seen = file->renderModel.mesh.renderMesh;
        const Points& v = file->renderModel.mesh.body.vertices;
        seen.texCoords = v.leftCols(2).cast<float>();
        seen.normals = v.rowwise().normalized().cast<float>();
        return file;
    };
    w.good({{"do", "import-character"}, {"path", "snowman"}, {"name", "left man"}});
    w.good({{"do", "cut"}, {"element", "left man"}, {"plane", {{"origin", {0, 0, 4}}, {"normal", {0.1, 0, 1}}}}, {"names", {"low", "high"}}, {"name", "waist"}});
    w.good({{"do", "cut"}, {"element", "high"}, {"plane", {{"origin", {0, 0, 8}}, {"normal", {0, 0.1, 1}}}}, {"names", {"high", "top"}}, {"name", "neck"}});
    w.good({{"do", "attach"}, {"character", "left man"}, {"part", "eye"}, {"mode", "rigid"}, {"pivot", {0.1, 0.56, 6}}});
    for (const char* element : {"low", "high", "top"}) w.good({{"do", "set"}, {"target", element}, {"property", "solver-mesh"}, {"value", "as-is"}});
    w.good({{"do", "precompute"}});
    const std::string before = w.content();
    const Json answer = w.good({{"do", "mirror"}, {"from", {"left man"}}, {"at", 3}});
    CHECK(answer["characters"] == Json::array({{{"name", "right man"}, {"from", "left man"}}}));
    const CharacterSource& was = *w.session.document().characterNamed("left man");
    const CharacterSource& is = *w.session.document().characterNamed("right man");
    CHECK(is.model->mesh.renderMesh.texCoords == was.model->mesh.renderMesh.texCoords);
    CHECK(is.model->mesh.renderMesh.normals.col(0) == -was.model->mesh.renderMesh.normals.col(0));
    CHECK(is.model->mesh.renderMesh.triangles.col(1) == was.model->mesh.renderMesh.triangles.col(2));
    CHECK(is.model->mesh.body.vertices.col(1) == was.model->mesh.body.vertices.col(1));
    CHECK((is.cuts[0].plane.origin - Vec3(6, 0, 4)).norm() < 1e-15);
    CHECK(is.cuts[0].plane.normal.x() < 0.0);
    CHECK((*is.attachments.begin()->second.pivot - Vec3(5.9, 0.56, 6)).norm() < 1e-12);
    for (const char* name : {"low 2", "high 2", "top 2"}) CHECK(listed(w, "elements", name)["state"] == "fresh");
    // The pieces beside a cut that is moved meet their neighbours, which stay as they were mirrored.
    w.good({{"do", "move-cut"}, {"cut", "waist 2"}, {"plane", {{"origin", {6, 0, 3}}, {"normal", {-0.1, 0, 1}}}}});
    CHECK(listed(w, "elements", "top 2")["state"] == "fresh");
    w.good({{"do", "precompute"}});
    CHECK(w.good({{"do", "measure"}, {"what", "gap"}})["value"].get<double>() < 1e-9);
    w.good({{"do", "remove-cut"}, {"cut", "neck 2"}});
    w.good({{"do", "undo"}, {"count", 3}});
    CHECK(w.content() == before);
}

TEST_CASE("copies: any duplicates, mirror images and replacements leave closed bodies, what is refused changes nothing, undo and redo lead there and back") {
    int done = 0, refused = 0;
    for (unsigned seed = 0; seed < 40; ++seed) {
        CAPTURE(seed);
        std::mt19937 random(seed);
        const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random()) % n; };
        Workbench w;
        w.good({{"do", "import-character"}, {"path", "snowman"}, {"name", "T"}});
        w.good({{"do", "cut"}, {"element", "T"}, {"plane", {{"origin", {0, 0, 8}}, {"normal", {0, 0.1, 1}}}}, {"names", {"trunk", "arm.L"}}, {"name", "shoulder.L"}});
        w.good({{"do", "handle"}, {"element", "arm.L"}, {"name", "hand.L"}, {"point", {0.5, 0, 10}}, {"radius", 0.3}});
        w.good({{"do", "import-element"}, {"path", "bar5"}, {"name", "left bar"}});
        w.addFace("left bar", "end", 18, 1);
        w.good({{"do", "add-bone"}, {"name", "bone.L"}, {"from", "arm.L/shoulder.L"}, {"to", {0, 0, 12}}});
        w.good({{"do", "add-bone"}, {"name", "tail"}, {"from", {0, 0, 15}}, {"to", "left bar/end"}});
        std::vector<std::string> contents{w.content()};
        for (int commands = 0; commands < 5; ++commands) {
            const Document& d = w.session.document();
            std::vector<std::string> names;
            for (const auto& [id, element] : d.elements) {
                names.push_back(element->name);
                for (const JointFace& face : element->faces) names.push_back(element->handleOf(face.name) ? face.name : element->name + "/" + face.name);
            }
            for (const auto& [id, bone] : d.bones) names.push_back(bone->name);
            for (const auto& [id, character] : d.characters) {
                names.push_back(character->name);
                for (const Cut& cut : character->cuts) names.push_back(cut.name);
            }
            if (names.empty()) break;
            const std::string a = names[below(names.size())], b = names[below(names.size())];
            const char* axis = std::array{"x", "y", "z"}[below(3)];
            Json command;
            switch (below(6)) {
                case 0: command = {{"do", "duplicate"}, {"names", {a, b}}, {"offset", {2.0 * static_cast<double>(below(4)), 3, 0}}}; break;
                case 1: command = {{"do", "replace-mesh"}, {"character", a}, {"path", below(2) == 0 ? "trunk" : "tube"}}; break;
                case 2: command = {{"do", "replace-mesh"}, {"element", a}, {"path", below(2) == 0 ? "coarse5" : "bar5"}}; break;
                case 3: command = {{"do", "mirror"}, {"from", {a}}, {"axis", axis}}; break;
                default: command = {{"do", "mirror"}, {"from", {a, b}}, {"axis", axis}, {"at", static_cast<double>(below(9))}}; break;
            }
            CAPTURE(command.dump());
            const bool answered = w.session.execute(command).has_value();
            ++(answered ? done : refused);
            if (answered)
                contents.push_back(w.content());
            else
                REQUIRE(w.content() == contents.back());
            for (const auto& [id, element] : w.session.document().elements) REQUIRE(element->mesh->connectivity().facts().outward);
            REQUIRE(w.session.character() != nullptr);
        }
        const int steps = static_cast<int>(contents.size()) - 1;
        for (int i = steps; i > 0; --i) {
            w.good({{"do", "undo"}});
            REQUIRE(w.content() == contents[static_cast<std::size_t>(i - 1)]);
        }
        if (steps > 0) {
            w.good({{"do", "redo"}, {"count", steps}});
            REQUIRE(w.content() == contents.back());
        }
    }
    MESSAGE(done << " commands done, " << refused << " refused");
    CHECK(done > 50);
    CHECK(refused > 10);
}
