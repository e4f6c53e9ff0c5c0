// SPDX-License-Identifier: GPL-3.0-or-later
// Characters of files go out as their files' own meshes.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>

#include "core/io/build_result.h"
#include "core/io/character_file.h"
#include "core/mesh/bounds.h"
#include "tests/document/tamper.h"
#include "tests/document/workbench.h"
#include "tests/export/read_glb.h"
#include "tests/support/left_out.h"
#include "tests/support/obj.h"
#include "tests/support/printed.h"

using namespace imomushi;

namespace {

// Single precision of positions, targets, weights and rotations, each rounded by half a bit: over the diagonal.
constexpr double kSingle = 4e-7;
const char* const kTake = "踊り";

/// A bar of 12 m with an eye over it: texture coordinates that jump along a seam, two materials in the trunk, one of them with a texture, a vertex that no triangle uses.
CharacterFile wormFile() {
    TriangleMesh eye = shapes::sphere(0.2, 2).mesh;
    eye.vertices.rowwise() += Vec3(0.1, 0.62, 6.4).transpose();
    TriangleMesh trunk = Workbench::longBar();
    trunk.vertices.conservativeResize(trunk.vertices.rows() + 1, 3);
    trunk.vertices.bottomRows(1) << 0.1, 0.2, 5.0;
    CharacterFile file = Workbench::characterOf({trunk, eye}, {"からだ", "目"});
    RenderModel& model = file.renderModel;
    RenderMesh& render = model.mesh.renderMesh;
    const TriangleMesh& body = model.mesh.body;
    render.bodyVertex.clear();
    std::map<std::pair<std::int32_t, bool>, std::int32_t> known;
    std::vector<float> uv;
    for (Eigen::Index t = 0; t < body.triangles.rows(); ++t) {
        const bool above = body.vertices(body.triangles(t, 0), 1) + body.vertices(body.triangles(t, 1), 1) + body.vertices(body.triangles(t, 2), 1) > 0.0;
        render.material.push_back(model.part[static_cast<std::size_t>(t)] == 1 ? 2 : above ? 1 : 0);
        for (int c = 0; c < 3; ++c) {
            const std::int32_t v = body.triangles(t, c);
            const auto [at, isNew] = known.emplace(std::pair(v, above), static_cast<std::int32_t>(known.size()));
            render.triangles(t, c) = at->second;
            if (!isNew) continue;
            render.bodyVertex.push_back(v);
            uv.push_back(static_cast<float>(body.vertices(v, 2) / 12.0));
            uv.push_back(static_cast<float>(0.25 + 0.2 * body.vertices(v, 0)) + (above ? 0.5f : 0.0f));
        }
    }
    render.texCoords = Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, 2, Eigen::RowMajor>>(uv.data(), static_cast<Eigen::Index>(uv.size() / 2), 2);
    for (const char* name : {"腹", "背", "eye white"}) render.materials.push_back({.name = name});
    render.materials[0].baseColor << 1.0f, 0.5f, 0.25f, 1.0f;
    render.materials[1].baseColorTexture = 0;
    render.textures.push_back({"skin", "image/png", {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'}});
    return file;
}

/// The same with two morph targets: one lifts what lies beyond z = 9, one flattens the eye and is there by a quarter.
CharacterFile smilingWorm() {
    CharacterFile file = wormFile();
    RenderModel& model = file.renderModel;
    const Points& vertices = model.mesh.body.vertices;
    std::vector<char> ofEye(static_cast<std::size_t>(vertices.rows()), 0);
    for (Eigen::Index t = 0; t < model.mesh.body.triangles.rows(); ++t)
        for (int c = 0; c < 3; ++c) ofEye[static_cast<std::size_t>(model.mesh.body.triangles(t, c))] = model.part[static_cast<std::size_t>(t)] == 1;
    model.morphs = {{"笑顔", 0.0, {}, {}}, {"blink", 0.25, {}, {}}};
    for (const bool eye : {false, true}) {
        MorphTarget& to = model.morphs[eye ? 1 : 0];
        std::vector<float> deltas;
        for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
            if ((ofEye[static_cast<std::size_t>(v)] != 0) != eye || (!eye && vertices(v, 2) < 9.0)) continue;
            to.vertices.push_back(static_cast<std::int32_t>(v));
            deltas.insert(deltas.end(), {0.0f, static_cast<float>(eye ? 0.5 * (0.62 - vertices(v, 1)) : 0.2 * (vertices(v, 2) - 9.0)), 0.0f});
        }
        to.deltas = Eigen::Map<decltype(to.deltas)>(deltas.data(), static_cast<Eigen::Index>(to.vertices.size()), 3);
    }
    return file;
}

/// It says a word by a clip that weighs both targets, a second long; keys of one are between frames.
CharacterFile talkingWorm() {
    CharacterFile file = smilingWorm();
    RigClip word{"word", 1.0, {}, {}};
    word.morphs.push_back({"笑顔", RigTrack::Interpolation::Linear, {0.0, 0.25, 0.5, 1.0}, {0.0, 1.0, -0.25, 0.5}});
    word.morphs.push_back({"blink", RigTrack::Interpolation::Cubic, {0.0, 0.7}, {0, 0.25, 1.0, -1.0, 1.0, 0}});
    word.morphs.push_back({"of another file", RigTrack::Interpolation::Linear, {0.0}, {1.0}});
    file.rig = Rig{};
    file.rig->clips.push_back(std::move(word));
    return file;
}

struct Worm : Workbench {
    explicit Worm(const char* basis = "affine", std::initializer_list<const char*> effects = {}, const char* path = "worm") {
        session.services().importCharacter = [](const ImportRequest& request, const Progress& progress) -> Result<CharacterFile> {
            return request.path == "worm" ? wormFile() : request.path == "smiling worm" ? smilingWorm() : request.path == "talking worm" ? talkingWorm() : characterFile(request, progress);
        };
        good({{"do", "import-character"}, {"path", path}, {"name", "芋虫"}, {"body", "wrapped"}, {"detail", 0.03}});
        good({{"do", "set"}, {"target", "character"}, {"property", "basis"}, {"value", basis}});
        for (const char* effect : effects) good({{"do", "enable"}, {"effect", effect}});
        cut("芋虫 body", 4.1, "low", "middle");
        cut("middle", 8.3, "middle", "high");
        for (const char* element : {"low", "middle", "high"}) good({{"do", "set"}, {"target", element}, {"property", "solver-mesh"}, {"value", "as-is"}});
        good({{"do", "add-bone"}, {"name", "a"}, {"element", "low"}, {"from", {0, 0, 0.5}}, {"to", "low/low cut"}});
        good({{"do", "add-bone"}, {"name", "b"}, {"from", "a/end"}, {"to", "middle/middle cut"}});
        good({{"do", "add-bone"}, {"name", "c"}, {"element", "high"}, {"from", "b/end"}, {"to", {0, 0, 11.5}}});
    }
    void cut(const char* element, double z, const char* behind, const char* before) {
        good({{"do", "cut"}, {"element", element}, {"plane", {{"origin", {0, 0, z}}, {"normal", {0, 0, 1}}}}, {"names", {behind, before}}, {"name", std::string(behind) + " cut"}});
    }
    void perform() {
        good({{"do", "precompute"}});
        good({{"do", "pin"}, {"endpoint", "a/start"}});
        good({{"do", "record"}, {"take", kTake}, {"action", "start"}});
        good({{"do", "drag"}, {"endpoint", "c/end"}, {"to", {3.0, 1.0, 10.5}}, {"roll", 0.3}, {"seconds", 0.3}});
        good({{"do", "step"}, {"frames", 20}});
        good({{"do", "record"}, {"take", kTake}, {"action", "stop"}});
    }
    [[nodiscard]] const CharacterSource& source() const { return *session.document().characters.begin()->second; }
    /// The character's own vertices at a time of the take.
    Points live(double time) {
        const auto& times = session.document().takeNamed(kTake)->times;
        const auto at = std::min_element(times.begin(), times.end(), [&](double a, double b) { return std::abs(a - time) < std::abs(b - time); });
        good({{"do", "play"}, {"take", kTake}, {"time", *at}});
        return session.renderPositionsOf(source().id);
    }
    /// That errors are told over: of the bodies together, m.
    [[nodiscard]] double diagonal() const {
        Bounds all;
        for (const auto& [id, element] : session.document().elements) {
            const Bounds box = boundsOf(element->mesh->body.vertices);
            all = id == session.document().elements.begin()->first ? box : Bounds{all.low.cwiseMin(box.low), all.high.cwiseMax(box.high)};
        }
        return all.diagonal();
    }
    Json write(Json arguments, const char* name) {
        arguments["do"] = "export";
        arguments["path"] = at(name).string();
        return good(arguments);
    }
    static std::filesystem::path at(const char* name) { return folder() / name; }
};

double checked(const Json& answer) { return answer["check"]["max_percent"].get<double>() / 100.0; }

/// Render vertices that a material has of a part, in the order of the file.
std::vector<std::int32_t> verticesOf(const RenderModel& model, std::int32_t part, std::int32_t material) {
    std::vector<char> has(model.mesh.renderMesh.bodyVertex.size(), 0);
    for (Eigen::Index t = 0; t < model.mesh.renderMesh.triangles.rows(); ++t)
        for (int c = 0; model.part[static_cast<std::size_t>(t)] == part && model.mesh.renderMesh.material[static_cast<std::size_t>(t)] == material && c < 3; ++c)
            has[static_cast<std::size_t>(model.mesh.renderMesh.triangles(t, c))] = 1;
    std::vector<std::int32_t> out;
    for (std::size_t r = 0; r < has.size(); ++r)
        if (has[r]) out.push_back(static_cast<std::int32_t>(r));
    return out;
}

/// The parts and materials of the worm as primitives of its file: node, primitive, and vertices.
struct WormPrimitive {
    std::int32_t part, material;
    std::size_t primitive;
};
constexpr std::array<WormPrimitive, 3> kWorm = {{{0, 0, 0}, {0, 1, 1}, {1, 2, 0}}};

/// The farthest that the vertices of a primitive are from the live character, over some keys of the clip, in diagonals.
double farthest(Worm& w, const ReadGlb& file, const WormPrimitive& of) {
    const auto vertices = verticesOf(*w.source().model, of.part, of.material);
    const int node = file.nodeNamed(w.source().model->parts[static_cast<std::size_t>(of.part)]);
    const auto times = file.times(node, 0);
    REQUIRE(times.size() > 5);
    double most = 0.0;
    for (std::size_t k = 0; k < times.size(); k += times.size() / 4) {
        const Points live = w.live(times[k]), there = file.positions(node, 0, times[k], of.primitive);
        REQUIRE(there.rows() == static_cast<Eigen::Index>(vertices.size()));
        for (Eigen::Index i = 0; i < there.rows(); ++i)
            most = std::max(most, (there.row(i) - live.row(w.source().model->mesh.renderMesh.bodyVertex[static_cast<std::size_t>(vertices[static_cast<std::size_t>(i)])])).norm());
    }
    return most / w.diagonal();
}

CharacterFile readCharacter(const std::filesystem::path& path) {
    const std::string bytes = readFile(path);
    auto scene = readScene({path, bytes}, SceneUse::Character);
    REQUIRE_MESSAGE(scene.has_value(), scene.error().message);
    auto file = buildCharacter(std::move(*scene), {.path = path}, {});
    REQUIRE_MESSAGE(file.has_value(), file.error().message);
    return std::move(*file);
}

RenderModel readModel(const std::filesystem::path& path) { return std::move(readCharacter(path).renderModel); }

}  // namespace

TEST_CASE("characters: glTF has the file's own parts, materials, texture coordinates, triangles and vertices in order") {
    Worm w;
    w.perform();
    for (const char* layout : {"baked", "rigged", "skinned"}) {
        CAPTURE(layout);
        const Json answer = w.write({{"layout", layout}}, "worm.glb");
        const RenderModel& model = *w.source().model;
        const RenderMesh& render = model.mesh.renderMesh;
        // The texture coordinates of the worm jump where its material changes: no vertex has two.
        CHECK(answer["written"] == Json::array({{{"character", "芋虫"}, {"parts", 2}, {"vertices", render.bodyVertex.size()}, {"triangles", render.triangles.rows()}}}));
        const ReadGlb file(Worm::at("worm.glb"));
        CHECK(file.root["meshes"].size() == 2);
        CHECK(file.root["skins"].size() == 1);
        CHECK(file.nodeNamed("middle frame") >= 0);
        CHECK(file.nodeNamed("middle") < 0);
        for (const WormPrimitive& of : kWorm) {
            const std::string& part = model.parts[static_cast<std::size_t>(of.part)];
            const int node = file.nodeNamed(part);
            REQUIRE(node >= 0);
            CHECK(file.meshOf(node)["name"] == part);
            CHECK(file.meshOf(node)["primitives"].size() == (of.part == 0 ? 2 : 1));
            const auto vertices = verticesOf(model, of.part, of.material);
            const auto uv = file.attribute(node, "TEXCOORD_0", of.primitive);
            REQUIRE(uv.size() == 2 * vertices.size());
            bool same = true;
            for (std::size_t i = 0; i < uv.size(); ++i) same = same && uv[i] == static_cast<double>(render.texCoords(vertices[i / 2], static_cast<Eigen::Index>(i % 2)));
            CHECK(same);
            const auto& primitive = file.meshOf(node)["primitives"][of.primitive];
            const auto& material = file.root["materials"][primitive["material"].get<std::size_t>()];
            CHECK(material["name"] == render.materials[static_cast<std::size_t>(of.material)].name);
            CHECK(material["pbrMetallicRoughness"].contains("baseColorTexture") == (of.material == 1));
            std::vector<double> corners;
            for (Eigen::Index t = 0; t < render.triangles.rows(); ++t)
                for (int c = 0; model.part[static_cast<std::size_t>(t)] == of.part && render.material[static_cast<std::size_t>(t)] == of.material && c < 3; ++c)
                    corners.push_back(static_cast<double>(std::lower_bound(vertices.begin(), vertices.end(), render.triangles(t, c)) - vertices.begin()));
            CHECK(file.numbers(primitive["indices"]) == corners);
            const double off = farthest(w, file, of);
            if (std::string(layout) == "skinned")
                CHECK(off <= answer["skin"]["max_percent"].get<double>() / 100.0 + kSingle);
            else
                CHECK(off < kSingle);
        }
        CHECK(checked(answer) <= (answer.contains("skin") ? answer["skin"]["max_percent"].get<double>() / 100.0 : 0.0) + kSingle);
        if (std::string(layout) == "skinned") CHECK(checked(answer) < 0.03);
        // And again as a character, as it lies in the file.
        const RenderModel back = readModel(Worm::at("worm.glb"));
        CHECK(back.parts == model.parts);
        REQUIRE(back.mesh.body.vertices.rows() == static_cast<Eigen::Index>(render.bodyVertex.size()));
        Eigen::Index row = 0;
        double most = 0.0;
        for (const WormPrimitive& of : kWorm)
            for (const auto r : verticesOf(model, of.part, of.material))
                most = std::max(most, (back.mesh.body.vertices.row(row++) - model.mesh.body.vertices.row(render.bodyVertex[static_cast<std::size_t>(r)])).norm());
        CHECK(most < kSingle * w.diagonal());
    }
}

TEST_CASE("characters: caches have the vertices of the file in its order, and the object beside them is the file's own mesh") {
    Worm w;
    w.perform();
    const RenderModel& model = *w.source().model;
    const auto count = static_cast<std::size_t>(model.mesh.body.vertices.rows());
    for (const char* name : {"worm.pc2", "worm.mdd"}) {
        const Json answer = w.write({{"layout", "cache"}}, name);
        CHECK(answer["vertices"] == count);
        CHECK(checked(answer) < kSingle);
        CHECK(answer["written"][0]["character"] == "芋虫");
    }
    const std::string cache = readFile(Worm::at("worm.pc2"));
    const auto& times = w.session.document().takeNamed(kTake)->times;
    REQUIRE(cache.size() == 32 + 12 * count * times.size());
    for (std::size_t k = 0; k < times.size(); k += 5) {
        std::vector<float> numbers(3 * count);
        std::memcpy(numbers.data(), cache.data() + 32 + 12 * count * k, 12 * count);
        const Points there = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(numbers.data(), static_cast<Eigen::Index>(count), 3).cast<double>();
        CHECK((there - w.live(times[k])).rowwise().norm().maxCoeff() < kSingle * w.diagonal());
    }
    const RenderModel back = readModel(Worm::at("worm.obj"));
    CHECK(back.mesh.body.vertices == model.mesh.body.vertices);
    CHECK(back.mesh.body.triangles == model.mesh.body.triangles);
    CHECK(back.mesh.renderMesh.bodyVertex == model.mesh.renderMesh.bodyVertex);
    CHECK(back.mesh.renderMesh.triangles == model.mesh.renderMesh.triangles);
    CHECK(back.mesh.renderMesh.texCoords.isApprox(model.mesh.renderMesh.texCoords, 1e-6f));
    CHECK(back.mesh.renderMesh.material == model.mesh.renderMesh.material);
    CHECK(back.mesh.renderMesh.textures.size() == 1);
    CHECK(back.mesh.renderMesh.materials[0].baseColor == model.mesh.renderMesh.materials[0].baseColor);
    CHECK(back.parts == model.parts);

    w.write({{"layout", "cache"}}, "walk.obj");
    const RenderModel last = readModel(Worm::at("walk_0011.obj"));
    CHECK((last.mesh.body.vertices - w.live(times[10])).cwiseAbs().maxCoeff() < 1e-12);
    CHECK(last.mesh.renderMesh.normals.rows() == last.mesh.renderMesh.texCoords.rows());
    CHECK(std::filesystem::exists(Worm::at("walk.mtl")));
    CHECK(std::filesystem::exists(Worm::at("walk_1.png")));
    w.write({{"layout", "cache"}}, "walk.ply");
    CHECK(std::filesystem::exists(Worm::at("walk_0021.ply")));
}

TEST_CASE("characters: what cannot be said by columns is fitted, and the error that is told is that of the file") {
    struct Case {
        const char* basis;
        std::initializer_list<const char*> effects;
    };
    for (const Case& of : {Case{"paper", {}}, Case{"modes:6", {"smooth-joints", "gravity", "inflate"}}, Case{"affine", {"bend-warp"}}}) {
        CAPTURE(of.basis);
        Worm w(of.basis, of.effects);
        w.perform();
        const Json answer = w.write({{"layout", "baked"}}, "worm.glb");
        double told = 0.0;
        for (const Json& effect : answer["effects"])
            if (effect.contains("error")) told = std::max(told, effect["error"]["max_percent"].get<double>() / 100.0);
        if (answer.contains("render_mesh")) told = std::max(told, answer["render_mesh"]["max_percent"].get<double>() / 100.0);
        CHECK(checked(answer) <= told + kSingle);
        CHECK(told < 1e-3);
        const ReadGlb file(Worm::at("worm.glb"));
        for (const WormPrimitive& of : kWorm) CHECK(farthest(w, file, of) <= told + kSingle);
    }
}

TEST_CASE("characters: few targets are those of the whole character, and lose what is told") {
    Worm w;
    w.perform();
    double last = 1.0;
    for (const int targets : {2, 4, 8}) {
        const Json answer = w.write({{"layout", "rigged"}, {"targets", targets}}, "worm.glb");
        CHECK(answer["targets"] == targets);
        CHECK(checked(answer) <= answer["dropped_targets"]["max_percent"].get<double>() / 100.0 + kSingle);
        CHECK(checked(answer) < last);
        last = checked(answer);
        const ReadGlb file(Worm::at("worm.glb"));
        CHECK(file.meshOf(file.nodeNamed("からだ"))["extras"]["targetNames"][0] == "shape 1");
    }
}

TEST_CASE("characters: sixteen bits, split targets and normals that move") {
    Worm w;
    w.perform();
    for (const char* layout : {"baked", "rigged", "skinned"}) {
        CAPTURE(layout);
        const double skin = std::string(layout) == "skinned" ? w.write({{"layout", layout}}, "worm.glb")["skin"]["max_percent"].get<double>() / 100.0 : 0.0;
        const Json answer = w.write({{"layout", layout}, {"quantise", true}}, "worm.glb");
        const double told = answer["quantised"]["max_percent"].get<double>() / 100.0;
        CHECK(checked(answer) <= skin + told + kSingle);
        CHECK(told < 1e-3);
        const ReadGlb file(Worm::at("worm.glb"));
        for (const WormPrimitive& of : kWorm) CHECK(farthest(w, file, of) <= skin + told + kSingle);
    }
    CHECK(checked(w.write({{"layout", "baked"}, {"split", true}}, "worm.glb")) < kSingle);
    CHECK(checked(w.write({{"layout", "baked"}, {"normals", true}}, "worm.glb")) < kSingle);
    // What a small part of each target does to the top of the bar, by the triangles of the file.
    const ReadGlb file(Worm::at("worm.glb"));
    const int node = file.nodeNamed("からだ");
    const auto& primitive = file.meshOf(node)["primitives"][1];
    const auto corners = file.numbers(primitive["indices"]);
    const std::vector<double> rest = file.attribute(node, "POSITION", 1);
    const auto normalsOf = [&](const std::vector<double>& at) {
        Points sum = Points::Zero(static_cast<Eigen::Index>(at.size() / 3), 3);
        for (std::size_t t = 0; t < corners.size(); t += 3) {
            const auto p = [&](std::size_t c) -> Vec3 { return Eigen::Map<const Vec3>(at.data() + 3 * static_cast<std::size_t>(corners[t + c])); };
            const Vec3 area = (p(1) - p(0)).cross(p(2) - p(0));
            for (std::size_t c = 0; c < 3; ++c) sum.row(static_cast<Eigen::Index>(corners[t + c])) += area.transpose();
        }
        sum.rowwise().normalize();
        return sum;
    };
    constexpr double kSmall = 1e-4;
    double most = 0.0, off = 0.0;
    for (const auto& target : primitive["targets"]) {
        const auto moved = file.numbers(target["POSITION"]), turned = file.numbers(target["NORMAL"]);
        REQUIRE(turned.size() == rest.size());
        std::vector<double> up = rest, down = rest;
        for (std::size_t i = 0; i < rest.size(); ++i) up[i] += kSmall * moved[i], down[i] -= kSmall * moved[i];
        const Points change = (normalsOf(up) - normalsOf(down)) / (2.0 * kSmall);
        for (std::size_t v = 0; 3 * v < rest.size(); ++v) {
            // Inside the top, where no edge is near nor the other material.
            const Vec3 p(rest[3 * v], rest[3 * v + 1], rest[3 * v + 2]);
            if (p.y() != 0.5 || std::abs(p.x()) > 0.4 || p.z() < 0.1 || p.z() > 11.9) continue;
            const Vec3 told(turned[3 * v], turned[3 * v + 1], turned[3 * v + 2]);
            most = std::max(most, told.norm());
            off = std::max(off, (told - change.row(static_cast<Eigen::Index>(v)).transpose()).norm());
        }
    }
    CHECK(most > 0.05);
    CHECK(off < 1e-3 * (1.0 + most));  // single precision over a small step
}

TEST_CASE("characters: a compressed file is shorter, and all that it holds is bit for bit what the plain one holds") {
    Worm w;
    w.perform();
    const auto read = [](const char* name) {
        ImportRequest request;
        request.path = Worm::at(name);
        auto file = importCharacter(request, {});
        REQUIRE_MESSAGE(file, file.error().message);
        return std::move(*file);
    };
    for (const char* layout : {"baked", "rigged", "skinned"})
        for (const bool quantise : {false, true}) {
            CAPTURE(std::string(layout));
            CAPTURE(quantise);
            const Json plain = w.write({{"layout", layout}, {"quantise", quantise}}, "worm.glb"), packed = w.write({{"layout", layout}, {"quantise", quantise}, {"compress", true}}, "pack.glb");
            CHECK(packed["uncompressed_bytes"] == plain["bytes"]);
            CHECK(packed["bytes"].get<double>() < 0.9 * plain["bytes"].get<double>());
            const CharacterFile a = read("worm.glb"), b = read("pack.glb");
            const ElementMesh &x = a.renderModel.mesh, &y = b.renderModel.mesh;
            CHECK(a.renderModel.sameVertices(b.renderModel));
            CHECK(x.body.triangles == y.body.triangles);
            CHECK(x.renderMesh.triangles == y.renderMesh.triangles);
            CHECK(x.renderMesh.texCoords == y.renderMesh.texCoords);
            CHECK(x.renderMesh.normals == y.renderMesh.normals);
            CHECK(x.renderMesh.textures.size() == y.renderMesh.textures.size());
            REQUIRE(a.renderModel.morphs.size() == b.renderModel.morphs.size());
            for (std::size_t m = 0; m < a.renderModel.morphs.size(); ++m) {
                CHECK(a.renderModel.morphs[m].vertices == b.renderModel.morphs[m].vertices);
                CHECK(a.renderModel.morphs[m].deltas == b.renderModel.morphs[m].deltas);
            }
            REQUIRE(a.rig.has_value() == b.rig.has_value());
            if (!a.rig) continue;
            CHECK(a.rig->weights.bone == b.rig->weights.bone);
            CHECK(a.rig->weights.weight == b.rig->weights.weight);
            REQUIRE(a.rig->clips.size() == b.rig->clips.size());
            for (std::size_t c = 0; c < a.rig->clips.size(); ++c) {
                REQUIRE(a.rig->clips[c].tracks.size() == b.rig->clips[c].tracks.size());
                for (std::size_t t = 0; t < a.rig->clips[c].tracks.size(); ++t) CHECK(a.rig->clips[c].tracks[t].values == b.rig->clips[c].tracks[t].values);
                for (std::size_t t = 0; t < a.rig->clips[c].morphs.size(); ++t) CHECK(a.rig->clips[c].morphs[t].weights == b.rig->clips[c].morphs[t].weights);
            }
        }
    // Caches are no glTF, and stay as they are.
    CHECK(!w.write({{"layout", "cache"}, {"compress", true}}, "worm.pc2").contains("uncompressed_bytes"));
}

TEST_CASE("characters: morph targets of a file are weights of the character, of its takes and of its exports") {
    Worm w("affine", {}, "smiling worm");
    const auto model = w.source().model;
    const auto set = [&](const char* target, double weight) { return w.good({{"do", "morph"}, {"character", "芋虫"}, {"target", target}, {"weight", weight}}); };
    const Json told = w.good({{"do", "list"}})["characters"][0]["morphs"];
    REQUIRE(told.size() == 2);
    CHECK(told[0]["name"] == "笑顔");
    CHECK(told[1]["weight"] == 0.25);
    CHECK(w.code({{"do", "morph"}, {"character", "芋虫"}, {"target", "frown"}, {"weight", 1}}) == "no-such-target");
    CHECK(w.code({{"do", "morph"}, {"character", "芋虫"}, {"target", "blink"}, {"weight", 1e9}}) == "bad-value");
    // At rest deltas are added; undo takes them back bit for bit.
    const Points rest = w.session.renderPositionsOf(w.source().id);
    set("笑顔", 0.5);
    set("blink", 1.0);
    Points goal = rest;
    for (std::size_t t = 0; t < 2; ++t)
        for (std::size_t i = 0; i < model->morphs[t].vertices.size(); ++i)
            goal.row(model->morphs[t].vertices[i]) += (t == 0 ? 0.5 : 0.75) * model->morphs[t].deltas.row(static_cast<Eigen::Index>(i)).cast<double>();
    CHECK((w.session.renderPositionsOf(w.source().id) - goal).cwiseAbs().maxCoeff() < 1e-6);
    w.good({{"do", "undo"}, {"count", 2}});
    CHECK(w.session.renderPositionsOf(w.source().id) == rest);
    CHECK(w.session.document().morphs.empty());
    w.good({{"do", "redo"}, {"count", 2}});
    CHECK(w.session.document().morphs.size() == 2);
    // A project keeps targets, weights and takes of them; older programs are told that they are too old.
    w.good({{"do", "precompute"}});
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    w.good({{"do", "record"}, {"take", kTake}, {"action", "start"}});
    w.good({{"do", "drag"}, {"endpoint", "c/end"}, {"to", {2.0, 0.5, 11.0}}, {"seconds", 0.2}});
    w.good({{"do", "step"}, {"frames", 8}});
    set("笑顔", 1.0);
    w.good({{"do", "step"}, {"frames", 8}});
    w.good({{"do", "record"}, {"take", kTake}, {"action", "stop"}});
    const Points early = w.live(0.05), late = w.live(0.25);
    const auto project = Worm::at("smiling.imomushi");
    w.good({{"do", "save"}, {"path", project.string()}});
    Worm other;
    const Json opened = other.good({{"do", "open"}, {"path", project.string()}});
    CHECK(opened["characters"][0]["morphs"][0]["weight"] == 1.0);
    CHECK(other.live(0.05) == early);
    CHECK(other.live(0.25) == late);
    // glTF: the targets of the file come last, under their names, with weights that mean what they meant there.
    for (const char* layout : {"baked", "skinned"}) {
        CAPTURE(layout);
        const Json answer = w.write({{"layout", layout}}, "smiling.glb");
        const ReadGlb file(Worm::at("smiling.glb"));
        const int trunk = file.nodeNamed("からだ"), eye = file.nodeNamed("目");
        CHECK(file.meshOf(trunk)["extras"]["targetNames"].back() == "笑顔");
        CHECK(file.meshOf(eye)["extras"]["targetNames"].back() == "blink");
        CHECK(file.meshOf(eye)["weights"].back() == 0.25);
        // Beside what is told the body turns and stretches targets a little otherwise than its element does.
        const double skin = std::string(layout) == "skinned" ? answer["skin"]["max_percent"].get<double>() / 100.0 : answer.contains("render_mesh") ? answer["render_mesh"]["max_percent"].get<double>() / 100.0 : 0.0;
        for (const WormPrimitive& of : kWorm) CHECK(farthest(w, file, of) < 1.1 * skin + (std::string(layout) == "skinned" ? 0.002 : 1e-5));
        // They come in again.
        const RenderModel again = readModel(Worm::at("smiling.glb"));
        const int smile = again.morphIndex("笑顔"), blink = again.morphIndex("blink");
        REQUIRE(smile >= 0);
        REQUIRE(blink >= 0);
        CHECK(again.morphs[static_cast<std::size_t>(blink)].atRest == doctest::Approx(0.25));
        CHECK(again.morphs[static_cast<std::size_t>(blink)].deltas.colwise().norm().isApprox(model->morphs[1].deltas.colwise().norm(), 0.5f));
        CHECK(again.morphs[static_cast<std::size_t>(smile)].deltas.col(1).maxCoeff() == doctest::Approx(model->morphs[0].deltas.col(1).maxCoeff()).epsilon(1e-5));
    }
}

TEST_CASE("characters: clips that weigh morph targets become takes, stay in projects and go out with the weights of the file") {
    Worm w("affine", {}, "talking worm");
    const Rig& rig = *w.source().rig;
    CHECK(w.good({{"do", "list"}})["characters"][0]["clips"] == Json::parse(R"([{"name": "word", "seconds": 1.0}])"));
    CHECK(w.code({{"do", "propose"}, {"character", "芋虫"}, {"from", "skeleton"}}) == "no-skeleton");
    const std::string before = w.content();
    w.good({{"do", "morph"}, {"character", "芋虫"}, {"target", "笑顔"}, {"weight", 0.125}});
    const Json answer = w.good({{"do", "take-clip"}, {"character", "芋虫"}, {"clip", "word"}, {"take", kTake}});
    CHECK(answer["morphs"] == 2);
    CHECK(answer["bones"] == 0);
    CHECK(answer["frames"] == 61);
    CHECK(w.session.character()->morphWeights(0)[0] == 0.125);  // the document is shown again
    for (const double time : {0.0, 0.25, 0.5, 0.7, 1.0}) {
        CHECK(w.good({{"do", "play"}, {"take", kTake}, {"time", time}})["exact"] == true);
        for (std::size_t t = 0; t < 2; ++t) CHECK(w.session.character()->morphWeights(0)[t] == doctest::Approx(weightAt(rig.clips[0].morphs[t], time)).epsilon(1e-12));
    }
    // Vertices with it.
    const RenderModel& model = *w.source().model;
    const Points half = w.live(0.5);
    Points goal = model.mesh.body.vertices;
    for (std::size_t t = 0; t < 2; ++t)
        for (std::size_t i = 0; i < model.morphs[t].vertices.size(); ++i)
            goal.row(model.morphs[t].vertices[i]) += (weightAt(rig.clips[0].morphs[t], 0.5) - model.morphs[t].atRest) * model.morphs[t].deltas.row(static_cast<Eigen::Index>(i)).cast<double>();
    CHECK((half - goal).cwiseAbs().maxCoeff() < 1e-6);

    for (const char* layout : {"skinned", "baked"}) {
        CAPTURE(layout);
        w.write({{"layout", layout}}, "talking.glb");
        const CharacterFile again = readCharacter(Worm::at("talking.glb"));
        REQUIRE(again.rig);
        REQUIRE(again.rig->clips.size() == 1);
        for (const MorphTrack& track : {rig.clips[0].morphs[0], rig.clips[0].morphs[1]}) {
            const auto& tracks = again.rig->clips[0].morphs;
            const auto written = std::find_if(tracks.begin(), tracks.end(), [&](const MorphTrack& t) { return t.target == track.target; });
            REQUIRE(written != tracks.end());
            for (const double time : track.times) CHECK(weightAt(*written, time) == doctest::Approx(weightAt(track, time)).epsilon(1e-6));
        }
    }

    const auto project = Worm::at("talking.imomushi");
    w.good({{"do", "save"}, {"path", project.string()}});
    Workbench other;
    other.good({{"do", "open"}, {"path", project.string()}});
    CHECK(other.content() == w.content());
    CHECK(other.session.document().characters.begin()->second->rig->clips[0].morphs[1].weights == rig.clips[0].morphs[1].weights);
    for (const char* change : {"UPDATE rig_morph_tracks SET target='' WHERE position=1", "UPDATE rig_morph_tracks SET times=zeroblob(16) WHERE position=1", "UPDATE rig_morph_tracks SET interpolation=9",
                               "UPDATE rig_morph_tracks SET clip=4", "UPDATE rig_morph_tracks SET position=7 WHERE position=0", "UPDATE rig_morph_tracks SET character=77"}) {
        CAPTURE(change);
        w.good({{"do", "save"}, {"path", project.string()}});
        sql(project, change);
        sign(project);
        CHECK(Workbench().code({{"do", "open"}, {"path", project.string()}}) == "damaged");
    }
    w.good({{"do", "undo"}, {"count", 2}});
    CHECK(w.content() == before);
}

TEST_CASE("characters: elements without one are written as before beside them, and each character has a cache of its own") {
    Worm w;
    w.good({{"do", "import-element"}, {"path", "bar9"}, {"name", "block"}});
    w.good({{"do", "import-character"}, {"path", "ball"}, {"name", "ball: 1?"}});
    w.perform();
    const Json answer = w.write({{"layout", "baked"}}, "all.glb");
    REQUIRE(answer["written"].size() == 3);
    CHECK(answer["written"][0] == Json{{"element", "block"}, {"vertices", w.session.document().elementNamed("block")->mesh->body.vertices.rows()},
                                       {"triangles", w.session.document().elementNamed("block")->mesh->body.triangles.rows()}});
    CHECK(checked(answer) < kSingle);
    const ReadGlb file(Worm::at("all.glb"));
    CHECK(!file.root["nodes"][static_cast<std::size_t>(file.nodeNamed("block"))].contains("skin"));
    CHECK(file.nodeNamed("ball") >= 0);
    for (const char* layout : {"rigged", "skinned"}) {
        const Json other = w.write({{"layout", layout}}, "all.glb");
        CHECK(checked(other) <= (other.contains("skin") ? other["skin"]["max_percent"].get<double>() / 100.0 : 0.0) + kSingle);
    }
    const Json caches = w.write({{"layout", "cache"}}, "all.pc2");
    CHECK(checked(caches) < kSingle);
    CHECK(caches["files"] == 8);  // three caches, their objects, materials and a texture
    for (const char* name : {"all.pc2", "all.obj", "all_芋虫.pc2", "all_芋虫.obj", "all_ball_ 1_.pc2", "all_ball_ 1_.obj"}) CHECK(std::filesystem::exists(Worm::at(name)));
    const auto frames = w.session.document().takeNamed(kTake)->times.size();
    CHECK(std::filesystem::file_size(Worm::at("all_芋虫.pc2")) == 32 + 12 * frames * static_cast<std::size_t>(w.source().model->mesh.body.vertices.rows()));
    CHECK(readObj(Worm::at("all.obj").string()).vertices == w.session.document().elementNamed("block")->mesh->body.vertices);
}

TEST_CASE("characters: two exports of one take are the same bytes") {
    Worm w;
    w.perform();
    for (const char* layout : {"baked", "rigged", "skinned"}) {
        w.write({{"layout", layout}, {"normals", true}}, "worm.glb");
        const std::string once = readFile(Worm::at("worm.glb"));
        w.write({{"layout", layout}, {"normals", true}}, "worm.glb");
        CHECK(readFile(Worm::at("worm.glb")) == once);
    }
}

TEST_CASE("characters: another program opens them") {
    if (printed("assimp version 2>/dev/null").empty()) return leaveOut("the command assimp is not installed");
    Worm w;
    w.perform();
    for (const char* layout : {"baked", "rigged", "skinned"}) {
        w.write({{"layout", layout}}, "worm.glb");
        const std::string told = printed("assimp info '" + Worm::at("worm.glb").string() + "' 2>&1");
        CAPTURE(told);
        CHECK(told.find("ERROR") == std::string::npos);
        CHECK(told.find("Meshes:             3") != std::string::npos);  // a mesh per primitive
        CHECK(told.find("Materials:          3") != std::string::npos);
        CHECK(told.find("Animations:         1") != std::string::npos);
    }
}

TEST_CASE("characters: a penguin with handles, and one that is cut, go out vertex by vertex") {
    const std::filesystem::path path = std::filesystem::path(IMOMUSHI_SHARED_MESHES) / "penguin.obj";
    if (!std::filesystem::exists(path)) return leaveOut("no " + path.string());
    for (const bool cut : {false, true}) {
        CAPTURE(cut);
        Workbench w;
        w.session.services().importCharacter = [&](const ImportRequest&, const Progress&) -> Result<CharacterFile> {
            CharacterFile file;
            file.renderModel = readModel(path);
            return file;
        };
        w.good({{"do", "import-character"}, {"path", path.string()}, {"name", "penguin"}});
        if (cut) {
            const auto plane = [](Json origin, Json normal) { return Json{{"origin", std::move(origin)}, {"normal", std::move(normal)}}; };
            w.good({{"do", "cut"}, {"element", "penguin"}, {"plane", plane({-0.6, 0.2, -0.05}, {-1, -0.6, 0})}, {"names", {"trunk", "wing"}}, {"name", "shoulder"}});
            w.good({{"do", "cut"}, {"element", "trunk"}, {"plane", plane({0, 0.68, 0}, {0, 1, 0})}, {"names", {"trunk", "head"}}, {"name", "neck"}});
            w.good({{"do", "add-bone"}, {"name", "spine"}, {"from", {0, -0.6, 0}}, {"to", "trunk/neck"}});
            w.good({{"do", "add-bone"}, {"name", "nod"}, {"from", "spine/end"}, {"to", {0, 1.0, 0}}, {"element", "head"}});
            w.good({{"do", "add-bone"}, {"name", "flap"}, {"from", "trunk/shoulder"}, {"to", {-0.9, -0.2, -0.1}}, {"element", "wing"}});
        } else {
            const auto& v = w.session.document().characters.begin()->second->model->mesh.body.vertices;
            Eigen::Index top = 0, wing = 0, foot = 0;
            v.col(1).maxCoeff(&top);
            v.col(0).minCoeff(&wing);
            v.col(1).minCoeff(&foot);
            for (const auto& [name, i] : {std::pair("head", top), std::pair("wing", wing), std::pair("foot", foot)})
                w.good({{"do", "handle"}, {"element", "penguin body"}, {"name", name}, {"point", {v(i, 0), v(i, 1), v(i, 2)}}, {"radius", 0.2}});
        }
        for (const auto& [id, element] : w.session.document().elements) w.good({{"do", "set"}, {"target", element->name}, {"property", "solver-mesh"}, {"value", "decimated:150"}});
        w.good({{"do", "precompute"}});
        w.good({{"do", "record"}, {"take", kTake}, {"action", "start"}});
        const std::string end = cut ? "flap/end" : "wing";
        const Json from = w.good({{"do", "measure"}, {"what", "position"}, {"endpoint", end}})["value"];
        w.good({{"do", "drag"}, {"endpoint", end}, {"to", {from[0].get<double>() - 0.1, from[1].get<double>() + 0.3, from[2].get<double>()}}, {"seconds", 0.2}});
        w.good({{"do", "step"}, {"frames", 14}});
        w.good({{"do", "record"}, {"take", kTake}, {"action", "stop"}});
        const auto source = w.session.document().characters.begin()->second;
        const Points& rest = source->model->mesh.body.vertices;
        const double diagonal = (rest.colwise().maxCoeff() - rest.colwise().minCoeff()).norm();
        for (const char* layout : {"baked", "rigged", "skinned"}) {
            CAPTURE(layout);
            const auto out = Workbench::folder() / "penguin.glb";
            const Json answer = w.good({{"do", "export"}, {"layout", layout}, {"path", out.string()}});
            double told = answer.contains("skin") ? answer["skin"]["max_percent"].get<double>() / 100.0 : 0.0;
            if (answer.contains("render_mesh")) told = answer["render_mesh"]["max_percent"].get<double>() / 100.0;
            MESSAGE(std::string(cut ? "cut penguin, " : "penguin with handles, ") << std::string(layout) << ": " << answer["vertices"] << " vertices, " << answer["targets"] << " targets, " << answer["bytes"]
                                                                       << " bytes, told " << told << ", read back " << checked(answer));
            CHECK(answer["vertices"] == rest.rows());
            CHECK(checked(answer) <= told + kSingle);
            const ReadGlb file(out);
            const int node = file.nodeNamed(source->model->parts[0], true);  // the file is called so, too
            const auto times = file.times(node, 0);
            for (std::size_t k = 0; k < times.size(); k += 6) {
                const auto& recorded = w.session.document().takeNamed(kTake)->times;
                const double time = *std::min_element(recorded.begin(), recorded.end(), [&](double a, double b) { return std::abs(a - times[k]) < std::abs(b - times[k]); });
                w.good({{"do", "play"}, {"take", kTake}, {"time", time}});
                const Points live = w.session.renderPositionsOf(source->id);
                if (k > 0) CHECK((live - rest).rowwise().norm().maxCoeff() > 0.05);
                CHECK((file.positions(node, 0, times[k]) - live).rowwise().norm().maxCoeff() <= (told + kSingle) * diagonal);
            }
        }
    }
}
