// SPDX-License-Identifier: GPL-3.0-or-later
// Skeletons, weights and animations of files.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "core/base/finite.h"
#include "core/base/floating_point_guard.h"
#include "core/io/build_result.h"
#include "tests/io/glb.h"
#include "tests/io/raw_scene.h"
#include "tests/support/shapes.h"

using namespace imomushi;
using namespace io_test;
namespace fs = std::filesystem;
using nlohmann::json;

namespace {

Result<CharacterFile> rigged(const std::string& bytes, const std::string& name = "a.glb", bool bonesSuffice = false, Unit unit = Unit::AsInFile, UpAxis up = UpAxis::AsInFile) {
    const FloatingPointGuard guard;  // damaged files hold infinities
    ImportRequest request;
    request.path = fs::path("/nonexistent") / name;
    request.bonesSuffice = bonesSuffice;
    request.unit = unit;
    request.up = up;
    auto scene = readScene({request.path, bytes}, SceneUse::Character);
    if (!scene) return tl::unexpected(scene.error());
    return buildCharacter(std::move(*scene), request, {});
}

std::string why(const Result<CharacterFile>& r) { return r ? "" : r.error().code + ": " + r.error().message; }

bool told(const CharacterFile& file, const std::string& code) {
    for (const MeshIssue& i : file.issues)
        if (i.code == code) return true;
    return false;
}

/// A box of two bones along x, the upper one turned a quarter about z at rest; a clip bends it.
Glb arm() {
    Glb glb;
    const TriangleMesh box = shapes::box({0, 0, 0}, {2, 1, 1}, 2, 1, 1).mesh;
    std::vector<float> positions, weights;
    std::vector<std::uint8_t> joints;
    std::vector<std::uint16_t> corners;
    for (Eigen::Index v = 0; v < box.vertices.rows(); ++v) {
        for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(box.vertices(v, k)));
        const float upper = static_cast<float>(box.vertices(v, 0)) / 2.0f;
        joints.insert(joints.end(), {0, 1, 1, 0});
        weights.insert(weights.end(), {2.0f * (1.0f - upper), upper, upper, 0.0f});  // sums of 2, one bone twice
    }
    for (Eigen::Index i = 0; i < box.triangles.size(); ++i) corners.push_back(static_cast<std::uint16_t>(box.triangles.data()[i]));
    const float s = static_cast<float>(std::numbers::sqrt2 / 2.0);
    const int at = glb.floats(positions, "VEC3", 3), index = glb.indices(corners), j = glb.bytes(joints, "VEC4", 4), w = glb.floats(weights, "VEC4", 4);
    const int inverse = glb.floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1}, "MAT4", 16);
    const int times = glb.floats({0.0f, 1.0f, 2.0f}, "SCALAR", 1), turn = glb.floats({0, 0, s, s, 0, 0, 0, 1, 0, 0, -s, s}, "VEC4", 4), move = glb.floats({0, 0, 0, 0, 0, 3, 0, 0, 6}, "VEC3", 3);
    glb.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", at}, {"JOINTS_0", j}, {"WEIGHTS_0", w}}}, {"indices", index}}}}}};
    glb.json["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"name", "body"}}, {{"name", "lower"}, {"children", {2}}}, {{"name", "upper"}, {"translation", {1, 0, 0}}, {"rotation", {0, 0, s, s}}}};
    glb.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", inverse}}};
    glb.json["scenes"] = {{{"nodes", {0, 1}}}};
    glb.json["animations"] = {{{"name", "bend"},
                               {"samplers", {{{"input", times}, {"output", turn}}, {{"input", times}, {"output", move}, {"interpolation", "STEP"}}}},
                               {"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}}, {{"sampler", 1}, {"target", {{"node", 1}, {"path", "translation"}}}}}}}};
    return glb;
}

double angleBetween(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) { return a.angularDistance(b); }

const Eigen::Quaterniond quarter(Eigen::AngleAxisd(std::numbers::pi / 2.0, Vec3::UnitZ()));

}  // namespace

TEST_CASE("rig: the bones of a skin come with their places at rest, the weights of vertices add up to 1, and a clip moves them as the file says") {
    const auto file = rigged(arm().file());
    CAPTURE(why(file));
    REQUIRE(file);
    REQUIRE(file->rig);
    const Rig& rig = *file->rig;
    CHECK(!told(*file, "bones"));
    REQUIRE(rig.bones.size() == 2);
    CHECK(rig.boneIndex("lower") == 0);
    CHECK(rig.boneIndex("upper") == 1);
    CHECK(rig.boneIndex("body") == -1);
    CHECK(rig.bones[0].parent == -1);
    CHECK(rig.bones[1].parent == 0);
    CHECK((rig.bones[0].head - Vec3(0, 0, 0)).norm() == 0.0);
    CHECK((rig.bones[1].head - Vec3(1, 0, 0)).norm() == 0.0);
    CHECK((rig.bones[0].tail - Vec3(1, 0, 0)).norm() == 0.0);
    CHECK((rig.bones[1].tail - Vec3(2, 0, 0)).norm() == 0.0);  // as long again
    CHECK(angleBetween(rig.bones[1].rotation, quarter) < 1e-6);
    const Points& vertices = file->renderModel.mesh.body.vertices;
    REQUIRE(rig.weights.first.size() == static_cast<std::size_t>(vertices.rows()) + 1);
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
        double sum = 0.0, upper = 0.0;
        for (auto i = static_cast<std::size_t>(rig.weights.first[static_cast<std::size_t>(v)]); i < static_cast<std::size_t>(rig.weights.first[static_cast<std::size_t>(v) + 1]); ++i) {
            sum += static_cast<double>(rig.weights.weight[i]);
            if (rig.weights.bone[i] == 1) upper += static_cast<double>(rig.weights.weight[i]);
        }
        CHECK(std::abs(sum - 1.0) < 1e-6);
        CHECK(std::abs(upper - vertices(v, 0) / 2.0) < 1e-6);
    }
    REQUIRE(rig.clips.size() == 1);
    CHECK(rig.clipIndex("bend") == 0);
    CHECK(rig.clips[0].seconds == 2.0);
    const auto at = [&](double t) { return posedRig(rig, rig.clips[0], t); };
    CHECK(angleBetween(at(0.0)[1].rotation, quarter) < 1e-6);
    CHECK(angleBetween(at(0.5)[1].rotation, Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 4.0, Vec3::UnitZ()))) < 1e-6);  // spherical
    CHECK(angleBetween(at(1.0)[1].rotation, Eigen::Quaterniond::Identity()) < 1e-6);
    CHECK(angleBetween(at(7.0)[1].rotation, quarter.conjugate()) < 1e-6);
    CHECK((at(0.999)[1].head - Vec3(1, 0, 0)).norm() == 0.0);  // steps
    CHECK((at(1.0)[1].head - Vec3(1, 0, 3)).norm() == 0.0);
    CHECK((at(9.0)[0].head - Vec3(0, 0, 6)).norm() == 0.0);
}

TEST_CASE("rig: units and axes turn bones and clips as they turn the mesh") {
    const auto plain = rigged(arm().file()), turned = rigged(arm().file(), "a.glb", false, Unit::Centimetre, UpAxis::Z);
    REQUIRE(plain);
    REQUIRE(turned);
    const auto placed = [](const Vec3& p) { return Vec3(0.01 * Vec3(p.x(), p.z(), -p.y())); };
    const Points &from = plain->renderModel.mesh.body.vertices, &to = turned->renderModel.mesh.body.vertices;
    CHECK((placed(from.row(3).transpose()) - Vec3(to.row(3).transpose())).norm() < 1e-15);
    for (std::size_t b = 0; b < 2; ++b) {
        CHECK((placed(plain->rig->bones[b].head) - turned->rig->bones[b].head).norm() < 1e-15);
        CHECK((placed(plain->rig->bones[b].tail) - turned->rig->bones[b].tail).norm() < 1e-15);
        for (const double t : {0.0, 0.3, 1.0, 1.7}) {
            const RigPose a = posedRig(*plain->rig, plain->rig->clips[0], t)[b], c = posedRig(*turned->rig, turned->rig->clips[0], t)[b];
            CHECK((placed(a.head) - c.head).norm() < 1e-15);
            // The turn from rest is that of the file, seen in other axes.
            const Vec3 along = (a.rotation * plain->rig->bones[b].rotation.conjugate()) * Vec3(1, 2, 3), other = (c.rotation * turned->rig->bones[b].rotation.conjugate()) * (100.0 * placed(Vec3(1, 2, 3)));
            CHECK((100.0 * placed(along) - other).norm() < 1e-12);
        }
    }
}

TEST_CASE("rig: cubic keys are Hermite splines") {
    Glb glb = arm();
    const int times = glb.floats({0.0f, 2.0f}, "SCALAR", 1), keys = glb.floats({9, 9, 9, 0, 0, 0, 1, 0, 0, 0, 2, 0, 4, 0, 0, 9, 9, 9}, "VEC3", 3);
    glb.json["animations"] = {{{"samplers", {{{"input", times}, {"output", keys}, {"interpolation", "CUBICSPLINE"}}}}, {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}}}};
    const auto file = rigged(glb.file());
    REQUIRE(file);
    REQUIRE(file->rig->clips.size() == 1);
    CHECK(file->rig->clips[0].name == "clip");
    const auto at = [&](double t) { return posedRig(*file->rig, file->rig->clips[0], t)[0].head; };
    CHECK((at(0.0) - Vec3(0, 0, 0)).norm() == 0.0);
    CHECK((at(2.0) - Vec3(4, 0, 0)).norm() == 0.0);
    // Halfway: (from + to) / 2 + length (out - in) / 8.
    CHECK((at(1.0) - Vec3(2.0 + 2.0 * 1.0 / 8.0, -2.0 * 2.0 / 8.0, 0)).norm() < 1e-12);
}

TEST_CASE("rig: parts that clips move or that hang on each other have bones without a skin; a static scene of parts has none") {
    Glb glb;
    const int at = glb.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3), times = glb.floats({0.0f, 1.0f}, "SCALAR", 1), move = glb.floats({0, 0, 0, 0, 0, 1}, "VEC3", 3);
    glb.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", at}}}}}}}};
    glb.json["nodes"] = {{{"name", "scene"}, {"children", {1, 4}}}, {{"name", "mover"}, {"children", {2, 3}}}, {{"name", "part"}, {"mesh", 0}, {"translation", {5, 0, 0}}}, {{"name", "part"}, {"mesh", 0}}, {{"name", "rock"}, {"mesh", 0}}};
    glb.json["scenes"] = {{{"nodes", {0}}}};
    CHECK(!rigged(glb.file())->rig);
    glb.json["animations"] = {{{"samplers", {{{"input", times}, {"output", move}}}}, {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}}}};
    auto file = rigged(glb.file());
    REQUIRE(file->rig);
    REQUIRE(file->rig->bones.size() == 1);
    CHECK(file->rig->bones[0].name == "mover");
    CHECK(file->rig->weights.first == std::vector<std::int32_t>{0, 1, 2, 3, 4, 5, 6, 6, 6, 6});  // the rock stays
    glb.json.erase("animations");
    glb.json["nodes"][2]["children"] = {3};
    glb.json["nodes"][1]["children"] = {2};
    file = rigged(glb.file());
    REQUIRE(file->rig);
    REQUIRE(file->rig->bones.size() == 2);
    CHECK(file->rig->bones[0].name == "part");
    CHECK(file->rig->bones[1].name == "part (2)");
    CHECK(file->rig->bones[1].parent == 0);
    CHECK(file->rig->weights.bone == std::vector<std::int32_t>{0, 0, 0, 1, 1, 1});
}

TEST_CASE("rig: a file of bones without a mesh brings its bones to whom they suffice, and says so to whom they do not") {
    Glb glb = arm();
    glb.json.erase("meshes");
    glb.json["nodes"][0].erase("mesh");
    glb.json["nodes"][0].erase("skin");
    const auto refused = rigged(glb.file()), file = rigged(glb.file(), "a.glb", true);
    REQUIRE(!refused);
    CHECK(refused.error().code == "empty-mesh");
    CHECK(refused.error().message.find("holds bones but no mesh") != std::string::npos);
    CAPTURE(why(file));
    REQUIRE(file);
    CHECK(file->renderModel.mesh.body.triangles.rows() == 0);
    CHECK(file->rig->bones.size() == 2);
    CHECK(file->rig->weights.empty());
    const auto again = inMessage<CharacterFile>(messageOf(file));
    REQUIRE(again);
    CHECK(again->rig->bones.size() == 2);
}

TEST_CASE("rig: what is wrong with bones and clips is told; the mesh comes all the same where it can") {
    const auto file = [](const std::function<void(json&)>& change) {
        Glb glb = arm();
        change(glb.json);
        return rigged(glb.file());
    };
    // Clips: no such node, no such sampler, counts that do not fit, times that fall: left out.
    for (const auto& change : std::vector<std::function<void(json&)>>{
             [](json& j) { j["animations"][0]["channels"][0]["target"]["node"] = 77; }, [](json& j) { j["animations"][0]["channels"][0]["sampler"] = 2; },
             [](json& j) { j["animations"][0]["samplers"][0]["input"] = 0; }, [](json& j) { j["animations"][0]["samplers"][0]["output"] = 999; },
             [](json& j) { j["animations"][0]["samplers"][0]["interpolation"] = "CUBICSPLINE"; }, [](json& j) { j["animations"][0]["channels"][0] = j["animations"][0]["channels"][1]; }}) {
        const auto r = file(change);
        CAPTURE(why(r));
        REQUIRE(r);
        CHECK(told(*r, "clip"));
        CHECK(r->rig->clips.empty());
        CHECK(r->rig->bones.size() == 2);
    }
    // Joints that do not exist, cycles: the whole file.
    CHECK(why(file([](json& j) { j["skins"][0]["joints"] = {1, 99}; })).substr(0, 8) == "bad-file");
    CHECK(why(file([](json& j) { j["nodes"][2]["children"] = {1}; })).substr(0, 8) == "bad-file");
    // A vertex on a joint that does not exist, in a skin that moves nothing.
    const auto fewer = file([](json& j) { j["skins"][0]["joints"] = {1}; });
    REQUIRE(fewer);
    CHECK(told(*fewer, "skeleton"));
    CHECK(fewer->rig->bones.size() == 1);
    // Names that are used twice, empty or not text.
    const auto names = file([](json& j) {
        j["nodes"][1]["name"] = "x";
        j["nodes"][2]["name"] = "x";
    });
    CHECK(names->rig->bones[1].name == "x (2)");
    CHECK(file([](json& j) { j["nodes"][1]["name"] = 5; })->rig->bones[0].name == "bone");
    // Far away: bones that cannot be computed with are left out, of a mesh that they do not move.
    const auto far = file([](json& j) {
        j["nodes"].push_back({{"name", "far"}, {"translation", {1e60, 0, 0}}});
        j["nodes"][1]["children"] = {2, 3};
        j["skins"][0]["joints"] = {1, 2, 3};
        j["skins"][0].erase("inverseBindMatrices");
    });
    REQUIRE(far);
    CHECK(!far->rig);
    CHECK(told(*far, "skeleton"));
}

TEST_CASE("rig: more bones than can be kept are left out in a moment, and so are clips with too many keys") {
    Glb glb = arm();
    json children = json::array({2}), joints = json::array({1, 2});
    for (int i = 0; i < 200'000; ++i) {
        children.push_back(3 + i);
        joints.push_back(3 + i);
        glb.json["nodes"].push_back(json::object());
    }
    glb.json["nodes"][1]["children"] = children;
    glb.json["skins"][0]["joints"] = joints;
    glb.json["skins"][0].erase("inverseBindMatrices");
    const auto file = rigged(glb.file());
    CAPTURE(why(file));
    REQUIRE(file);
    CHECK(!file->rig);
    CHECK(told(*file, "skeleton"));
    Glb many = arm();
    const json clip = many.json["animations"][0];
    for (std::size_t i = 0; i < kMostRigClips + 10; ++i) many.json["animations"].push_back(clip);
    const auto clips = rigged(many.file());
    REQUIRE(clips);
    CHECK(clips->rig->clips.size() == kMostRigClips);
    CHECK(clips->rig->clips[1].name == "bend (2)");
    CHECK(told(*clips, "clip"));
}

TEST_CASE("rig: the message of the worker brings it unchanged, and nothing that is damaged passes") {
    const auto file = rigged(arm().file());
    REQUIRE(file);
    const std::string bytes = messageOf(file);
    const auto again = inMessage<CharacterFile>(bytes);
    REQUIRE(again);
    REQUIRE(again->rig);
    CHECK(messageOf(again) == bytes);
    const auto vertices = static_cast<std::size_t>(file->renderModel.mesh.body.vertices.rows());
    std::mt19937 random(3);
    int sound = 0;
    for (int i = 0; i < 4000; ++i) {
        std::string damaged = bytes;
        for (int k = 0; k < 1 + i % 3; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
        const FloatingPointGuard guard;
        const auto r = inMessage<CharacterFile>(damaged);
        if (!r || !r->rig) continue;
        ++sound;
        REQUIRE(checkRig(*r->rig, vertices) == "");
        for (const RigClip& clip : r->rig->clips)
            for (const double t : {0.0, 0.7, 5.0})
                for (const RigPose& pose : posedRig(*r->rig, clip, t)) REQUIRE((allFinite(pose.head) && std::abs(pose.rotation.norm() - 1.0) < 1e-6));
    }
    CHECK(sound > 100);
}

TEST_CASE("rig: morph targets come with their names, turned with the skin and in metres, those of one name as one") {
    Glb glb = arm();
    const int up = glb.floats(std::vector<float>(3 * 12, 0.25f), "VEC3", 3), none = glb.floats(std::vector<float>(3 * 12, 0.0f), "VEC3", 3);
    json& mesh = glb.json["meshes"][0];
    REQUIRE(glb.json["accessors"][mesh["primitives"][0]["attributes"]["POSITION"].get<std::size_t>()]["count"] == 12);
    mesh["primitives"][0]["targets"] = {{{"POSITION", up}}, {{"POSITION", none}}, {{"POSITION", up}}};
    mesh["weights"] = {0.0, 0.0, 0.5};
    mesh["extras"]["targetNames"] = {"smile", "nothing", ""};
    // The same mesh again beside the skin: a target of the same name is the same.
    glb.json["nodes"].push_back({{"mesh", 0}, {"name", "other"}, {"translation", {5, 0, 0}}});
    glb.json["scenes"][0]["nodes"].push_back(3);
    const auto read = rigged(glb.file(), "a.glb", false, Unit::Centimetre);
    REQUIRE_MESSAGE(read, why(read));
    const auto& morphs = read->renderModel.morphs;
    REQUIRE(morphs.size() == 3);
    CHECK(morphs[0].name == "smile");
    CHECK(morphs[0].vertices.size() == 24);
    CHECK(morphs[1].name == "body 3");
    CHECK(morphs[1].atRest == 0.5);
    CHECK(morphs[2].name == "other 3");
    CHECK(morphs[2].vertices.front() == 12);
    // Of a node at rest as they are, in metres.
    CHECK((morphs[2].deltas.row(0) - Eigen::RowVector3f(0.0025f, 0.0025f, 0.0025f)).norm() < 1e-8f);
    // The worker's message brings them unchanged.
    const auto decoded = inMessage<CharacterFile>(messageOf(read));
    REQUIRE_MESSAGE(decoded, why(decoded));
    REQUIRE(decoded->renderModel.morphs.size() == 3);
    for (std::size_t t = 0; t < 3; ++t) CHECK(decoded->renderModel.morphs[t].deltas == morphs[t].deltas);
    // A number that is none makes the target, not the file, unusable.
    Glb broken = arm();
    std::vector<float> bad(3 * 12, 0.25f);
    bad[5] = std::numeric_limits<float>::quiet_NaN();
    const int at = broken.floats(bad, "VEC3", 3);
    broken.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", at}}};
    const auto without = rigged(broken.file());
    REQUIRE_MESSAGE(without, why(without));
    CHECK(without->renderModel.morphs.empty());
    CHECK(told(*without, "morph-targets"));
}

TEST_CASE("rig: clips weigh morph targets by their names, with or without bones, and what is wrong with them is told") {
    Glb glb = arm();
    json& root = glb.json;
    const int up = glb.floats(std::vector<float>(3 * 12, 0.25f), "VEC3", 3), none = glb.floats(std::vector<float>(3 * 12, 0.0f), "VEC3", 3);
    root["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", up}}, {{"POSITION", none}}, {{"POSITION", up}}};
    root["meshes"][0]["weights"] = {0.0, 0.0, 0.5};
    root["meshes"][0]["extras"]["targetNames"] = {"smile", "nothing", ""};
    const int times = glb.floats({0.0f, 1.0f, 3.0f}, "SCALAR", 1), weights = glb.floats({0, 9, 0.5f, 1, 9, 0.25f, -0.5f, 9, 0}, "SCALAR", 1);
    const int two = glb.floats({0.0f, 1.0f}, "SCALAR", 1), cubic = glb.floats({0, 0, 0, 0.5f, 9, 0.25f, 2, 0, 0, 0, 0, 0, 1, 9, 1, 0, 0, 0}, "SCALAR", 1);
    const auto weigh = [&](int input, int output, const char* how) {
        return json{{"samplers", {{{"input", input}, {"output", output}, {"interpolation", how}}}}, {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}, {"name", how}};
    };
    root["animations"].push_back(weigh(times, weights, "LINEAR"));
    root["animations"].push_back(weigh(times, weights, "STEP"));
    root["animations"].push_back(weigh(two, cubic, "CUBICSPLINE"));
    root["animations"].push_back(weigh(two, weights, "LINEAR"));
    root["animations"].back()["name"] = "wrong";
    const auto read = rigged(glb.file());
    REQUIRE_MESSAGE(read, why(read));
    CHECK(told(*read, "clip"));
    const auto decoded = inMessage<CharacterFile>(messageOf(read));
    REQUIRE_MESSAGE(decoded, why(decoded));
    REQUIRE(decoded->rig->clips.size() == 4);  // "bend", and three that weigh
    CHECK(decoded->rig->clips[0].morphs.empty());
    const RigClip &linear = decoded->rig->clips[1], &step = decoded->rig->clips[2], &spline = decoded->rig->clips[3];
    CHECK(linear.seconds == 3.0);
    REQUIRE(linear.morphs.size() == 2);  // not of the target that moves nothing
    CHECK(linear.morphs[0].target == read->renderModel.morphs[0].name);
    CHECK(linear.morphs[1].target == read->renderModel.morphs[1].name);
    for (const auto& [time, smile, other] : {std::array{-1.0, 0.0, 0.5}, {0.5, 0.5, 0.375}, {1.0, 1.0, 0.25}, {2.0, 0.25, 0.125}, {9.0, -0.5, 0.0}}) {
        CHECK(weightAt(linear.morphs[0], time) == doctest::Approx(smile));
        CHECK(weightAt(linear.morphs[1], time) == doctest::Approx(other));
    }
    CHECK(weightAt(step.morphs[0], 2.9) == 1.0);
    // From 0.5 with a slope of 2 to 1 with none.
    CHECK(weightAt(spline.morphs[0], 0.5) == doctest::Approx(0.5 * (0.5 + 1.0) + 2.0 * 0.125));
    CHECK(weightAt(spline.morphs[1], 0.5) == doctest::Approx(0.625));

    // Without a skeleton the clips come alone, and nothing else makes bones of it.
    root.erase("skins");
    root["nodes"][0].erase("skin");
    root["animations"].erase(0);
    const auto face = rigged(glb.file());
    REQUIRE_MESSAGE(face, why(face));
    REQUIRE(face->rig);
    CHECK(face->rig->bones.empty());
    CHECK(face->rig->weights.empty());
    CHECK(face->rig->clips.size() == 3);
    REQUIRE(inMessage<CharacterFile>(messageOf(face)));
    // Weights that no artist means make the clip unusable, not the file.
    const int huge = glb.floats({0, 0, 0, 1e9f, 0, 0}, "SCALAR", 1);
    root["animations"] = {weigh(two, huge, "LINEAR")};
    const auto wild = rigged(glb.file());
    REQUIRE_MESSAGE(wild, why(wild));
    CHECK_FALSE(wild->rig);
    CHECK(told(*wild, "clip"));
}

TEST_CASE("rig: COLLADA skins and animations, in their own unit") {
    const std::string dae = R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
 <asset><unit name="cm" meter="0.01"/><up_axis>Y_UP</up_axis></asset>
 <library_geometries><geometry id="g" name="g"><mesh>
  <source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
  <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
  <triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 1 2 3 0 3 2</p></triangles></mesh></geometry></library_geometries>
 <library_controllers><controller id="c"><skin source="#g"><bind_shape_matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</bind_shape_matrix>
  <source id="j"><Name_array id="ja" count="2">low high</Name_array><technique_common><accessor source="#ja" count="2" stride="1"><param name="JOINT" type="Name"/></accessor></technique_common></source>
  <source id="b"><float_array id="ba" count="32">1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 1 0 0 0 0 1 0 -1 0 0 1 0 0 0 0 1</float_array><technique_common><accessor source="#ba" count="2" stride="16"><param name="TRANSFORM" type="float4x4"/></accessor></technique_common></source>
  <source id="w"><float_array id="wa" count="2">0.25 0.75</float_array><technique_common><accessor source="#wa" count="2" stride="1"><param name="WEIGHT" type="float"/></accessor></technique_common></source>
  <joints><input semantic="JOINT" source="#j"/><input semantic="INV_BIND_MATRIX" source="#b"/></joints>
  <vertex_weights count="4"><input semantic="JOINT" source="#j" offset="0"/><input semantic="WEIGHT" source="#w" offset="1"/><vcount>2 2 2 2</vcount><v>0 0 1 1 0 0 1 1 0 0 1 1 0 0 1 1</v></vertex_weights></skin></controller></library_controllers>
 <library_animations><animation id="a"><source id="t"><float_array id="ta" count="2">0 2</float_array><technique_common><accessor source="#ta" count="2" stride="1"><param name="TIME" type="float"/></accessor></technique_common></source>
  <source id="o"><float_array id="oa" count="6">0 1 0 0 3 0</float_array><technique_common><accessor source="#oa" count="2" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
  <source id="i"><Name_array id="ia" count="2">LINEAR LINEAR</Name_array><technique_common><accessor source="#ia" count="2" stride="1"><param name="INTERPOLATION" type="Name"/></accessor></technique_common></source>
  <sampler id="s"><input semantic="INPUT" source="#t"/><input semantic="OUTPUT" source="#o"/><input semantic="INTERPOLATION" source="#i"/></sampler><channel source="#s" target="high/translate"/></animation></library_animations>
 <library_visual_scenes><visual_scene id="scene">
  <node id="low" sid="low" name="low" type="JOINT"><node id="high" sid="high" name="high" type="JOINT"><translate sid="translate">0 1 0</translate></node></node>
  <node id="m" name="m"><instance_controller url="#c"><skeleton>#low</skeleton></instance_controller></node></visual_scene></library_visual_scenes>
 <scene><instance_visual_scene url="#scene"/></scene></COLLADA>)";
    const auto file = rigged(dae, "a.dae");
    CAPTURE(why(file));
    REQUIRE(file);
    REQUIRE(file->rig);
    const Rig& rig = *file->rig;
    REQUIRE(rig.bones.size() == 2);
    CHECK(rig.bones[0].name == "low");
    CHECK(rig.bones[1].name == "high");
    CHECK((rig.bones[1].head - Vec3(0, 0.01, 0)).norm() < 1e-9);
    REQUIRE(rig.weights.bone.size() == 24);
    CHECK(std::abs(rig.weights.weight[0] - 0.25f) < 1e-6f);
    REQUIRE(rig.clips.size() == 1);
    CHECK(std::abs(rig.clips[0].seconds - 2.0) < 1e-6);
    CHECK((posedRig(rig, rig.clips[0], 1.0)[1].head - Vec3(0, 0.02, 0)).norm() < 1e-8);
}

TEST_CASE("rig: a mesh on an unnamed node that nothing moves is its parent's, as in files that programs compressed; one that moves is a bone") {
    for (const bool moved : {false, true}) {
        CAPTURE(moved);
        io_test::Glb glb;
        const int p = glb.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3), times = glb.floats({0, 1}, "SCALAR", 1), places = glb.floats({0, 0, 0, 0, 1, 0}, "VEC3", 3);
        glb.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", p}}}}}}}};
        glb.json["nodes"] = {{{"name", "hip"}, {"children", {1, 2}}}, {{"mesh", 0}, {"scale", {0.5, 0.5, 0.5}}}, {{"name", "knee"}, {"translation", {0, -1, 0}}, {"children", {3}}}, {{"mesh", 0}}};
        glb.json["scenes"] = {{{"nodes", {0}}}};
        if (moved) glb.json["animations"] = {{{"name", "kick"}, {"channels", {{{"sampler", 0}, {"target", {{"node", 3}, {"path", "translation"}}}}}}, {"samplers", {{{"input", times}, {"output", places}}}}}};
        const std::string bytes = glb.file();
        const auto file = readScene({"a.glb", bytes}, SceneUse::Character);
        REQUIRE(file);
        CHECK(file->partNames == std::vector<std::string>{"hip", "knee"});
        REQUIRE(file->rig);
        // The knee's mesh belongs to a bone of its own where a clip moves it alone.
        REQUIRE(file->rig->bones.size() == 2);
        CHECK(file->rig->bones[0].name == "hip");
        CHECK(file->rig->bones[1].name == (moved ? "bone" : "knee"));
    }
}
