// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstring>

#include "core/commands/export_commands.h"
#include "core/export/morphs.h"
#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

/// A chain that waves for half a second, with effects.
void perform(Workbench& w, std::initializer_list<const char*> effects = {}, const char* basis = "affine") {
    w.buildChain();
    w.good({{"do", "set"}, {"target", "character"}, {"property", "basis"}, {"value", basis}});
    for (const char* effect : effects) w.good({{"do", "enable"}, {"effect", effect}});
    w.good({{"do", "precompute"}});
    w.good({{"do", "record"}, {"take", "波"}, {"action", "start"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.5, 0.4, 5.0}}, {"roll", 0.4}, {"seconds", 0.3}});
    w.good({{"do", "step"}, {"frames", 30}});
    w.good({{"do", "record"}, {"take", "波"}, {"action", "stop"}});
}

Json write(Workbench& w, Json arguments, const char* name = "a.glb") {
    arguments["do"] = "export";
    arguments["path"] = (Workbench::folder() / name).string();
    return w.good(arguments);
}

Json documentOf(const char* name = "a.glb") {
    const std::string bytes = readFile(Workbench::folder() / name);
    REQUIRE(bytes.size() > 20);
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, 4);
    return Json::parse(bytes.substr(20, length));
}

double worst(const Json& answer) { return answer["check"]["max_percent"].get<double>() / 100.0; }

const Json& effect(const Json& answer, const char* name) {
    for (const Json& e : answer["effects"])
        if (e["effect"] == name) return e;
    FAIL("no effect " << name);
    return answer;
}

// Single precision of coordinates, targets and rotations.
constexpr double kRounding = 2e-7;

}  // namespace

TEST_CASE("export: without large motions and fingers morph targets are exact, whatever basis and effects there are") {
    for (const char* basis : {"paper", "affine", "modes:6"}) {
        CAPTURE(basis);
        Workbench w;
        perform(w, {"smooth-joints", "bone-dynamics", "joint-dynamics", "gravity", "inflate"}, basis);
        for (const char* layout : {"baked", "rigged"}) {
            const Json answer = write(w, {{"layout", layout}});
            CHECK(worst(answer) < kRounding);
            CHECK(answer["check"]["frames"] == 10);
            for (const Json& e : answer["effects"]) CHECK(e["result"] == "exact");
        }
    }
}

TEST_CASE("export: the basis full has more columns than engines take, and few combinations of them say nearly all") {
    Workbench w;
    perform(w, {}, "full");
    const Json answer = write(w, {{"layout", "baked"}});
    CHECK(answer["targets"] <= kMaxTargets);
    CHECK(worst(answer) < 1e-6);
}

TEST_CASE("export: large motions and fingers are fitted, and the error that is told is that of the file") {
    Workbench w;
    perform(w, {"bend-warp"});
    const Json answer = write(w, {{"layout", "baked"}});
    CHECK(effect(answer, "bend-warp")["result"] == "fitted");
    const double told = effect(answer, "bend-warp")["error"]["max_percent"].get<double>() / 100.0;
    CHECK(worst(answer) <= told + kRounding);
    CHECK(told < 1e-3);
    CHECK(effect(write(w, {{"layout", "cache"}}, "a.pc2"), "bend-warp")["result"] == "exact");
}

TEST_CASE("export: fewer targets lose what is told, and more targets lose less") {
    Workbench w;
    perform(w, {"bone-dynamics", "gravity", "smooth-joints"}, "modes:6");
    double last = 1.0;
    for (const int targets : {1, 2, 4}) {
        const Json answer = write(w, {{"layout", "baked"}, {"targets", targets}});
        CHECK(answer["targets"] == targets);
        CHECK(worst(answer) <= answer["dropped_targets"]["max_percent"].get<double>() / 100.0 + kRounding);
        CHECK(worst(answer) < last);
        last = worst(answer);
    }
    CHECK(write(w, {{"layout", "baked"}, {"targets", "all"}}).contains("dropped_targets") == false);
}

TEST_CASE("export: split targets have weights of 0 to 1, others of -1 to 1, and both say the same") {
    Workbench w;
    perform(w);
    const auto plan = planExport(w.session, {{"do", "export"}, {"layout", "baked"}, {"path", "a.glb"}});
    REQUIRE(plan);
    auto motion = Motion::build(plan->scene, 0.0, {});
    REQUIRE(motion);
    for (const bool split : {false, true}) {
        ExportOptions options;
        options.split = split;
        MorphErrors errors;
        const auto morphs = buildMorphs(*motion, plan->scene, options, false, errors, {});
        REQUIRE(morphs);
        for (const ElementMorphs& m : *morphs) {
            CHECK(m.tracks[0].weights.maxCoeff() <= 1.0);
            CHECK(m.tracks[0].weights.minCoeff() >= (split ? 0.0 : -1.0));
        }
    }
    CHECK(worst(write(w, {{"layout", "baked"}, {"split", true}})) < kRounding);
    CHECK(worst(write(w, {{"layout", "rigged"}, {"preset", "unity"}})) < kRounding);
}

TEST_CASE("export: sixteen bits per coordinate round by what is told, in every layout") {
    Workbench w;
    perform(w);
    for (const char* layout : {"baked", "rigged", "skinned"}) {
        CAPTURE(layout);
        const double skin = std::string(layout) == "skinned" ? write(w, {{"layout", layout}})["skin"]["max_percent"].get<double>() / 100.0 : 0.0;
        const Json answer = write(w, {{"layout", layout}, {"quantise", true}});
        const double told = answer["quantised"]["max_percent"].get<double>() / 100.0;
        CHECK(worst(answer) <= skin + told + kRounding);
        // Half a step of position, and of a few weighed targets or four weights.
        CHECK(told < 4e-4);
        const Json file = documentOf();
        CHECK(file["extensionsRequired"] == Json::array({"KHR_mesh_quantization"}));
        const Json& attributes = file["meshes"][0]["primitives"][0]["attributes"];
        CHECK(file["accessors"][attributes["POSITION"].get<std::size_t>()]["componentType"] == 5122);
        CHECK(file["accessors"][attributes["NORMAL"].get<std::size_t>()]["componentType"] == 5120);
        if (std::string(layout) != "baked") CHECK(file["accessors"][attributes["WEIGHTS_0"].get<std::size_t>()]["componentType"] == 5123);
    }
}

TEST_CASE("export: a tolerance leaves out keys and keeps its word at all recorded times") {
    Workbench w;
    perform(w);
    const Json all = write(w, {{"layout", "baked"}}), few = write(w, {{"layout", "baked"}, {"tolerance", 1e-3}});
    CHECK(few["keys"].get<int>() < all["keys"].get<int>() / 2);
    CHECK(worst(few) <= 1e-3 + kRounding);
}

TEST_CASE("export: a rate makes keys at its times") {
    Workbench w;
    perform(w);
    const Json answer = write(w, {{"layout", "baked"}, {"fps", 24}});
    CHECK(answer["clips"][0]["frames"] == 13);  // half a second, both ends
    CHECK(worst(answer) < kRounding);
}

TEST_CASE("export: skins follow the elastic body, and caches are it") {
    Workbench w;
    perform(w);
    const Json skin = write(w, {{"layout", "skinned"}});
    CHECK(worst(skin) <= skin["skin"]["max_percent"].get<double>() / 100.0 + kRounding);
    CHECK(worst(skin) < 0.03);  // bars of 1 x 1 x 3 that bend by half a radian
    for (const char* name : {"a.pc2", "a.mdd", "a.ply", "a.obj"}) CHECK(worst(write(w, {{"layout", "cache"}}, name)) < kRounding);
    CHECK(std::filesystem::exists(Workbench::folder() / "a_0031.ply"));
    // 32 bytes of head, then three floats per vertex and frame.
    CHECK(std::filesystem::file_size(Workbench::folder() / "a.pc2") == 32 + 31 * 12 * write(w, {{"layout", "cache"}}, "a.pc2")["vertices"].get<std::size_t>());
}

TEST_CASE("export: a skin of a body that sags follows the settled body") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "enable"}, {"effect", "gravity"}});
    // Flesh that sags by much, and hardly feels how it is moved.
    w.good({{"do", "set"}, {"target", "gravity"}, {"property", "shear-modulus"}, {"value", 30000}});
    w.good({{"do", "set"}, {"target", "gravity"}, {"property", "inertia"}, {"value", 0}});
    w.good({{"do", "precompute"}});
    w.good({{"do", "record"}, {"take", "t"}, {"action", "start"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.5, 0.4, 5.0}}, {"seconds", 0.3}});
    w.good({{"do", "step"}, {"frames", 40}});
    w.good({{"do", "record"}, {"take", "t"}, {"action", "stop"}});
    const Json answer = write(w, {{"layout", "skinned"}});
    const double told = answer["skin"]["max_percent"].get<double>() / 100.0;
    CHECK(worst(answer) <= told + kRounding);
    // How far the body sags, which a skin on the body at rest would miss by.
    const auto plan = planExport(w.session, {{"do", "export"}, {"layout", "skinned"}, {"path", "a.glb"}});
    REQUIRE(plan);
    auto motion = Motion::build(plan->scene, 0.0, {});
    REQUIRE(motion);
    motion->character.show(motion->restShape.data());
    double sag = 0.0;
    for (int e = 0; e < 2; ++e)
        sag = std::max(sag, (motion->character.positions(e) - plan->scene.character.elements[static_cast<std::size_t>(e)].mesh->body.vertices).rowwise().norm().maxCoeff() / motion->diagonal);
    CHECK(told < 0.25 * sag);
}

TEST_CASE("export: caches of several takes are files and folders after their names") {
    Workbench w;
    perform(w);
    w.good({{"do", "record"}, {"take", "b: 水?"}, {"action", "start"}});
    w.good({{"do", "step"}, {"frames", 3}});
    w.good({{"do", "record"}, {"take", "b: 水?"}, {"action", "stop"}});
    const auto points = write(w, {{"layout", "cache"}}, "c.pc2");
    CHECK(points["clips"].size() == 2);
    CHECK(worst(points) < kRounding);
    for (const char* name : {"c_波.pc2", "c_b_ 水_.pc2", "c.obj"}) CHECK(std::filesystem::exists(Workbench::folder() / name));
    CHECK(!std::filesystem::exists(Workbench::folder() / "c.pc2"));
    write(w, {{"layout", "cache"}}, "d.ply");
    CHECK(std::filesystem::exists(Workbench::folder() / "d_波" / "d_0031.ply"));
    CHECK(std::filesystem::exists(Workbench::folder() / "d_b_ 水_" / "d_0004.ply"));
    write(w, {{"layout", "cache"}, {"take", "波"}}, "e.mdd");
    CHECK(std::filesystem::exists(Workbench::folder() / "e.mdd"));
}

TEST_CASE("export: the pose of now goes out beside takes, or alone") {
    Workbench w;
    perform(w);
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0.0, 1.0, 5.5}}});
    const auto names = [&](Json arguments) {
        arguments["layout"] = "baked";
        const Json answer = write(w, arguments);
        CHECK(worst(answer) < kRounding);
        std::vector<std::string> out;
        for (const Json& clip : answer["clips"]) out.push_back(clip["name"]);
        return out;
    };
    using Names = std::vector<std::string>;
    CHECK(names({}) == Names{"波"});
    CHECK(names({{"pose", true}}) == Names{"波", "pose"});
    CHECK(names({{"pose", "波"}}) == Names{"波", "波 2"});
    CHECK(names({{"take", Json::array()}, {"pose", "のび"}}) == Names{"のび"});
    CHECK(names({{"take", {"波", "波"}}, {"pose", false}}) == Names{"波"});
    const auto code = [&](const char* key, Json value) {
        Json command{{"do", "export"}, {"layout", "baked"}, {"path", "a.glb"}};
        command[key] = std::move(value);
        return w.code(command);
    };
    CHECK(code("take", 1) == "bad-type");
    CHECK(code("take", {"none"}) == "no-such-take");
    CHECK(code("pose", 1) == "bad-type");
    CHECK(code("pose", "") == "bad-value");
}

TEST_CASE("export: warnings have a code and the name that they are about") {
    Workbench w;
    perform(w);
    w.good({{"do", "set"}, {"target", "character"}, {"property", "basis"}, {"value", "paper"}});
    const Json answer = write(w, {{"layout", "baked"}});
    bool poses = false, rigid = false;
    for (const Json& warning : answer["warnings"]) {
        poses = poses || (warning["code"] == "poses-only" && warning["subject"] == "波");
        rigid = rigid || (warning["code"] == "not-precomputed" && warning["subject"] == "A");
        CHECK(!warning["text"].get<std::string>().empty());
    }
    CHECK(poses);
    CHECK(rigid);
}

TEST_CASE("export: names, colours and clips go out, and seams have one normal") {
    Workbench w;
    perform(w);
    w.good({{"do", "rename"}, {"target", "A"}, {"name", "からだ"}});
    w.good({{"do", "set"}, {"target", "からだ"}, {"property", "color"}, {"value", "#ff0000"}});
    write(w, {{"layout", "baked"}});
    const Json file = documentOf();
    CHECK(file["animations"][0]["name"] == "波");
    CHECK(file["nodes"][0]["name"] == "からだ");
    CHECK(file["meshes"][0]["name"] == "からだ");
    CHECK(file["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] == Json::array({1.0, 0.0, 0.0, 1.0}));
    CHECK(file["meshes"][0]["extras"]["targetNames"].size() == file["meshes"][0]["primitives"][0]["targets"].size());
}

TEST_CASE("export: without a take the pose goes out, and what is motion alone is dropped") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "enable"}, {"effect", "bone-dynamics"}});
    w.good({{"do", "enable"}, {"effect", "gravity"}});
    w.good({{"do", "precompute"}});
    const Json answer = write(w, {{"layout", "baked"}});
    CHECK(answer["clips"][0]["name"] == "pose");
    CHECK(effect(answer, "bone-dynamics")["result"] == "dropped");
    CHECK(effect(answer, "gravity")["result"] == "exact");
    CHECK(worst(answer) < kRounding);
}

TEST_CASE("export: two exports of one take are the same bytes") {
    Workbench w;
    perform(w, {"bend-warp"});
    for (const char* layout : {"baked", "rigged", "skinned"}) {
        write(w, {{"layout", layout}});
        const std::string once = readFile(Workbench::folder() / "a.glb");
        write(w, {{"layout", layout}});
        CHECK(readFile(Workbench::folder() / "a.glb") == once);
    }
}

TEST_CASE("export: bad input is refused with a reason, and cancelling leaves no file") {
    Workbench w;
    const Json good{{"do", "export"}, {"layout", "baked"}, {"path", (Workbench::folder() / "none.glb").string()}};
    CHECK(w.code(good) == "no-element");
    perform(w);
    const auto with = [&](const char* key, Json value) {
        Json command = good;
        command[key] = std::move(value);
        return w.code(command);
    };
    CHECK(with("layout", "woven") == "bad-value");
    CHECK(with("preset", "maya") == "bad-value");
    CHECK(with("take", "none") == "no-such-take");
    CHECK(with("targets", 0) == "bad-value");
    CHECK(with("targets", Json::array()) == "bad-type");
    CHECK(with("fps", -1) == "bad-value");
    CHECK(with("tolerance", 2) == "bad-value");
    CHECK(with("path", "a.gltx") == "unknown-format");
    CHECK(with("path", "") == "bad-value");
    CHECK(with("path", (Workbench::folder() / "no folder" / "a.glb").string()) == "not-writable");
    std::stop_source stop;
    const auto cancelled = w.session.execute(good, Progress([&](std::string_view, double part) { if (part > 0.3) stop.request_stop(); }, stop.get_token()));
    REQUIRE(!cancelled);
    CHECK(cancelled.error().code == kCancelled);
    for (const auto& file : std::filesystem::directory_iterator(Workbench::folder())) CHECK(file.path().filename().string().substr(0, 4) != "none");
}
