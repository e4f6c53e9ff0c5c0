// SPDX-License-Identifier: GPL-3.0-or-later
// A file as a whole character: the file's own vertices and triangles, whatever they are.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "core/base/finite.h"
#include "core/base/floating_point_guard.h"
#include "core/io/limited_import.h"
#include "core/mesh/write_mesh.h"
#include "tests/io/glb.h"
#include "tests/io/raw_scene.h"
#include "tests/support/shapes.h"

using namespace imomushi;
using namespace io_test;
namespace fs = std::filesystem;

namespace {

Result<CharacterFile> character(ImportRequest request) {
    return importCharacter(request, {});
}

Result<CharacterFile> character(const fs::path& path) {
    ImportRequest request;
    request.path = path;
    return character(request);
}

/// In this process, without a worker.
Result<CharacterFile> characterOf(const std::string& name, const std::string& bytes) {
    const FloatingPointGuard guard;  // damaged files hold infinities
    ImportRequest request;
    request.path = fs::path("/nonexistent") / name;
    auto scene = readScene({request.path, bytes}, SceneUse::Character);
    if (!scene) return tl::unexpected(scene.error());
    return buildCharacter(std::move(*scene), request, {});
}

std::string said(const Result<CharacterFile>& r) { return r ? "" : r.error().code + ": " + r.error().message; }

const MeshIssue* find(const CharacterFile& file, const std::string& code) {
    for (const MeshIssue& i : file.issues)
        if (i.code == code) return &i;
    return nullptr;
}

Points points(std::initializer_list<std::initializer_list<double>> rows) {
    Points p(static_cast<Eigen::Index>(rows.size()), 3);
    Eigen::Index r = 0;
    for (const auto& row : rows) {
        Eigen::Index k = 0;
        for (const double x : row) p(r, k++) = x;
        ++r;
    }
    return p;
}

Triangles triangles(std::initializer_list<std::initializer_list<std::int32_t>> rows) {
    Triangles t(static_cast<Eigen::Index>(rows.size()), 3);
    Eigen::Index r = 0;
    for (const auto& row : rows) {
        Eigen::Index k = 0;
        for (const std::int32_t v : row) t(r, k++) = v;
        ++r;
    }
    return t;
}

/// What every render model promises.
void checkSound(const CharacterFile& file) {
    const RenderModel& model = file.renderModel;
    const TriangleMesh& body = model.mesh.body;
    const RenderMesh& render = model.mesh.renderMesh;
    REQUIRE(body.triangles.rows() > 0);
    REQUIRE(allFinite(body.vertices));
    REQUIRE(body.triangles.minCoeff() >= 0);
    REQUIRE(body.triangles.maxCoeff() < body.vertices.rows());
    REQUIRE(render.triangles.rows() == body.triangles.rows());
    for (Eigen::Index i = 0; i < body.triangles.size(); ++i) {
        const std::int32_t r = render.triangles.data()[i];
        REQUIRE(r >= 0);
        REQUIRE(r < static_cast<std::int32_t>(render.bodyVertex.size()));
        REQUIRE(render.bodyVertex[static_cast<std::size_t>(r)] == body.triangles.data()[i]);
    }
    REQUIRE(allFinite(render.normals));
    REQUIRE(allFinite(render.texCoords));
    REQUIRE(allFinite(render.colors));
    REQUIRE(static_cast<Eigen::Index>(model.part.size()) == body.triangles.rows());
    std::vector<char> worn(model.parts.size(), 0);
    for (const std::int32_t p : model.part) {
        REQUIRE(p >= 0);
        REQUIRE(p < static_cast<std::int32_t>(model.parts.size()));
        worn[static_cast<std::size_t>(p)] = 1;
    }
    for (std::size_t p = 0; p < worn.size(); ++p) {
        REQUIRE(worn[p] == 1);
        REQUIRE(!model.parts[p].empty());
    }
}

}  // namespace

TEST_CASE("character from OBJ: all vertices in their order, used or not, bit for bit; polygons, negative indices, degenerate and duplicate triangles") {
    const TestFolder folder;
    const auto file = character(folder.write("a.obj",
                                             "v 7 7 7\n"  // unused
                                             "v 0 0 -0.0\nv 0.1 0 0\nv 0.1 0.30000000000000004 0\nv 0 0.3 1e-300\n"
                                             "o quad\nf 2 3 4 5\n"
                                             "v 123456789.12345679 -1 2\n"  // unused
                                             "v 5 0 0\nv 6 0 0\nv 6.5 1 0\nv 5.5 2 0\nv 4.5 1 0\n"
                                             "o 五\nf -5 -4 -3 -2 -1\nf 7 8 9\nf 7 8 9\nf 7 7 8\nf 2 3 7\n"));
    CAPTURE(said(file));
    REQUIRE(file);
    checkSound(*file);
    const TriangleMesh& body = file->renderModel.mesh.body;
    CHECK(sameBits(body.vertices, points({{7, 7, 7}, {0, 0, -0.0}, {0.1, 0, 0}, {0.1, 0.30000000000000004, 0}, {0, 0.3, 1e-300}, {123456789.12345679, -1, 2}, {5, 0, 0}, {6, 0, 0},
                                          {6.5, 1, 0}, {5.5, 2, 0}, {4.5, 1, 0}})));
    REQUIRE(body.triangles.rows() == 2 + 3 + 4);
    CHECK(body.triangles.bottomRows(4) == triangles({{6, 7, 8}, {6, 7, 8}, {6, 6, 7}, {1, 2, 6}}));
    CHECK(file->renderModel.parts == std::vector<std::string>{"quad", "五"});
    CHECK(file->renderModel.part == std::vector<std::int32_t>{0, 0, 1, 1, 1, 1, 1, 1, 1});
    CHECK(file->format == "obj");
    CHECK(file->metresPerUnit == 1.0);
    CHECK(!file->zUpConverted);
    CHECK(find(*file, "not-triangles")->count == 2);
}

TEST_CASE("character from OBJ: seams split render vertices, never vertices; materials and textures come along") {
    const TestFolder folder;
    folder.write("t.png", std::string("\x89PNG\r\n\x1a\n") + "x");
    folder.write("a.mtl", "newmtl skin\nmap_Kd t.png\nnewmtl eye\nKd 1 0 0\n");
    const auto file = character(folder.write("a.obj",
                                             "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 0 0 9 1 1 1\nv 1 1 0 1 1 1\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nvn 0 0 0\n"
                                             "usemtl skin\nf 1/1/1 2/2/1 3/3/1\nusemtl eye\nf 2/1/2 5/2/2 3/3/1\n"));
    CAPTURE(said(file));
    REQUIRE(file);
    checkSound(*file);
    const RenderMesh& render = file->renderModel.mesh.renderMesh;
    CHECK(file->renderModel.mesh.body.vertices.rows() == 5);
    CHECK(render.bodyVertex == std::vector<std::int32_t>{0, 1, 2, 1, 4});
    CHECK(render.texCoords.row(2) == Eigen::RowVector2f(0.0f, 0.0f));  // origin top left
    CHECK(render.colors.row(1) == Eigen::RowVector4f(0.0f, 1.0f, 0.0f, 1.0f));
    CHECK(render.normals.row(4) == Eigen::RowVector3f(0.0f, 0.0f, 1.0f));  // of length 0 in the file
    CHECK(render.material == std::vector<std::int32_t>{0, 1});
    REQUIRE(render.textures.size() == 1);
    CHECK(render.materials[0].baseColorTexture == 0);
}

TEST_CASE("character: a file that repeats a normal for each corner has one render vertex per vertex") {
    std::string obj;
    const TriangleMesh ball = shapes::sphere(1.0, 2).mesh;
    for (Eigen::Index v = 0; v < ball.vertices.rows(); ++v) obj += "v " + std::to_string(ball.vertices(v, 0)) + " " + std::to_string(ball.vertices(v, 1)) + " " + std::to_string(ball.vertices(v, 2)) + "\n";
    for (Eigen::Index i = 0; i < ball.triangles.size(); ++i) {
        const auto n = ball.vertices.row(ball.triangles.data()[i]);
        obj += "vn " + std::to_string(n[0]) + " " + std::to_string(n[1]) + " " + std::to_string(n[2]) + "\n";
    }
    for (Eigen::Index i = 0; i < ball.triangles.size(); ++i) obj += (i % 3 ? " " : "\nf ") + std::to_string(ball.triangles.data()[i] + 1) + "//" + std::to_string(i + 1);
    const auto file = characterOf("a.obj", obj + "\n");
    CAPTURE(said(file));
    REQUIRE(file);
    checkSound(*file);
    const RenderMesh& render = file->renderModel.mesh.renderMesh;
    REQUIRE(static_cast<Eigen::Index>(render.bodyVertex.size()) == ball.vertices.rows());
    for (Eigen::Index r = 0; r < render.normals.rows(); ++r)
        CHECK((render.normals.row(r).cast<double>() - ball.vertices.row(render.bodyVertex[static_cast<std::size_t>(r)])).norm() < 1e-5);
}

TEST_CASE("character, write-mesh, character: vertices and triangles come back bit for bit, unused, degenerate and duplicate ones too") {
    const TestFolder folder;
    std::string obj = "v 9 9 9\n" + objOf(shapes::sphere(0.1, 2).mesh) + "v -1e-17 300000000.00000006 0.1\nf 1 2 2\nf 3 4 5\nf 3 4 5\nf 4 3 5\n";
    const auto first = character(folder.write("a.obj", obj));
    REQUIRE(first);
    const TriangleMesh& body = first->renderModel.mesh.body;
    for (const char* suffix : {".obj", ".ply"}) {
        const fs::path copy = folder.path() / ("copy" + std::string(suffix));
        REQUIRE(writeMesh(copy, body.vertices, body.triangles));
        const auto second = character(copy);
        CAPTURE(said(second));
        REQUIRE(second);
        checkSound(*second);
        CHECK(sameBits(second->renderModel.mesh.body.vertices, body.vertices));
        CHECK(second->renderModel.mesh.body.triangles == body.triangles);
    }
}

TEST_CASE("a mesh that no project could hold, as it reaches beyond 1e9 m, is refused in any unit; in a smaller unit it comes in") {
    const TestFolder folder;
    const fs::path path = folder.write("far.obj", "v 0 0 0\nv 2e9 0 0\nv 0 2e9 0\nv 0 0 2e9\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
    const auto code = [&](Unit unit) {
        const auto body = importFile({path, unit}, {});
        const auto whole = importCharacter({path, unit}, {});
        CHECK(body.has_value() == whole.has_value());
        return body ? std::string("in") : body.error().code;
    };
    CHECK(code(Unit::AsInFile) == "too-far");
    CHECK(code(Unit::Metre) == "too-far");
    CHECK(code(Unit::Centimetre) == "in");
}

TEST_CASE("character from PLY: vertices in order; texture coordinates per corner share render vertices where they agree") {
    const TestFolder folder;
    const auto file = character(folder.write("鳥.ply",
                                             "ply\nformat ascii 1.0\nelement vertex 6\nproperty double x\nproperty double y\nproperty double z\nelement face 3\n"
                                             "property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n"
                                             "5 5 5\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0.1 0.2 0.3\n"
                                             "3 1 2 3 6 0 0 1 0 1 1\n3 1 3 4 6 0 0 1 1 0 1\n3 1 2 3 6 0.5 0 1 0 1 1\n"));
    CAPTURE(said(file));
    REQUIRE(file);
    checkSound(*file);
    CHECK(sameBits(file->renderModel.mesh.body.vertices, points({{5, 5, 5}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.1, 0.2, 0.3}})));
    CHECK(file->renderModel.mesh.body.triangles == triangles({{1, 2, 3}, {1, 3, 4}, {1, 2, 3}}));
    CHECK(file->renderModel.mesh.renderMesh.bodyVertex == std::vector<std::int32_t>{1, 2, 3, 4, 1});
    CHECK(file->renderModel.mesh.renderMesh.texCoords(4, 0) == 0.5f);
    CHECK(file->renderModel.parts == std::vector<std::string>{"鳥"});
}

TEST_CASE("character from STL: a vertex per place, in the order in which they first appear; solids are parts and stay apart") {
    const auto facet = [](const std::string& a, const std::string& b, const std::string& c) {
        return "facet normal 0 0 0\nouter loop\nvertex " + a + "\nvertex " + b + "\nvertex " + c + "\nendloop\nendfacet\n";
    };
    const std::string bytes = "solid 一\n" + facet("1 0 0", "0 1 0", "0 0 0") + facet("0 1 0", "1 0 0", "1 1 0.1") + facet("1 0 0", "1 0 0", "0 -0 0") + "endsolid\nsolid empty\nendsolid\nsolid 二\n" +
                              facet("1 0 0", "2 0 0", "0 1 0") + "endsolid\n";
    const TestFolder folder;
    const auto file = character(folder.write("a.stl", bytes));
    CAPTURE(said(file));
    REQUIRE(file);
    checkSound(*file);
    CHECK(sameBits(file->renderModel.mesh.body.vertices, points({{1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 1, 0.1}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}})));
    CHECK(file->renderModel.mesh.body.triangles == triangles({{0, 1, 2}, {1, 0, 3}, {0, 0, 2}, {4, 5, 6}}));
    CHECK(file->renderModel.parts == std::vector<std::string>{"一", "二"});
    CHECK(file->renderModel.part == std::vector<std::int32_t>{0, 0, 0, 1});
}

TEST_CASE("character from STL: a closed one has the vertices of the element that importFile() makes of it") {
    const TriangleMesh ball = shapes::sphere(1.0, 3).mesh;
    std::string bytes(80, ' ');
    put(bytes, static_cast<std::uint32_t>(ball.triangles.rows()));
    for (Eigen::Index f = 0; f < ball.triangles.rows(); ++f) {
        for (int k = 0; k < 3; ++k) put(bytes, 0.0f);
        for (int k = 0; k < 9; ++k) put(bytes, static_cast<float>(ball.vertices(ball.triangles(f, k / 3), k % 3)));
        put(bytes, std::uint16_t{0});
    }
    const TestFolder folder;
    const fs::path path = folder.write("a.stl", bytes);
    const auto whole = character(path);
    const auto element = io_test::import(path);
    REQUIRE(whole);
    REQUIRE(element);
    CHECK(sameBits(whole->renderModel.mesh.body.vertices, element->bodies[0].mesh.body.vertices));
    CHECK(whole->renderModel.mesh.body.triangles == element->bodies[0].mesh.body.triangles);
}

TEST_CASE("character from GLB: nodes depth first, primitives in order, vertices in the order of their accessor, transformations applied") {
    Glb glb;
    const int positions = glb.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 8, 8, 8}, "VEC3", 3);  // the last is unused
    const int one = glb.indices({0, 1, 2, 0, 0, 1}), two = glb.indices({3, 1, 2, 3, 1, 2}), other = glb.floats({0.1f, 0.2f, 0.3f, 2, 0, 0, 0, 2, 0}, "VEC3", 3);
    glb.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", one}}, {{"attributes", {{"POSITION", positions}}}, {"mode", 1}}, {{"attributes", {{"POSITION", positions}}}, {"indices", two}}}}},
                          {{"primitives", {{{"attributes", {{"POSITION", other}}}}}}}};
    // 3 -> (2 -> 1 (mirrored), 4), then 0.
    glb.json["nodes"] = {{{"name", "last"}, {"mesh", 1}},
                         {{"name", "deep"}, {"mesh", 1}, {"scale", {-1, 1, 1}}},
                         {{"name", "first"}, {"mesh", 0}, {"children", {1}}, {"translation", {10, 0, 0}}},
                         {{"name", "root"}, {"children", {2, 4}}, {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}, {"scale", {2, 2, 2}}},
                         {{"name", "points"}, {"mesh", 1}}};
    glb.json["scenes"] = {{{"nodes", {3, 0}}}};
    const TestFolder folder;
    const auto file = character(folder.write("a.glb", glb.file()));
    CAPTURE(said(file));
    REQUIRE(file);
    checkSound(*file);
    const RenderModel& model = file->renderModel;
    CHECK(model.parts == std::vector<std::string>{"first", "deep", "points", "last"});
    const TriangleMesh& body = model.mesh.body;
    REQUIRE(body.vertices.rows() == 5 + 5 + 3 + 3 + 3);
    // root: twice the size, a quarter turn about z; first: 10 along x before that; deep: mirrored before that.
    const auto placed = [](double x, double y, double z) { return Eigen::RowVector3d(-2 * y, 2 * x, 2 * z); };
    const Points p = points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {8, 8, 8}});
    const Points q = points({{double{0.1f}, double{0.2f}, double{0.3f}}, {2, 0, 0}, {0, 2, 0}});
    for (Eigen::Index v = 0; v < 5; ++v) {
        CHECK((body.vertices.row(v) - placed(10 + p(v, 0), p(v, 1), p(v, 2))).norm() < 1e-13);
        CHECK(body.vertices.row(5 + v) == body.vertices.row(v));  // the shared accessor, once more
    }
    for (Eigen::Index v = 0; v < 3; ++v) {
        CHECK((body.vertices.row(10 + v) - placed(10 - q(v, 0), q(v, 1), q(v, 2))).norm() < 1e-13);
        CHECK((body.vertices.row(13 + v) - placed(q(v, 0), q(v, 1), q(v, 2))).norm() < 1e-13);
    }
    CHECK(sameBits(body.vertices.bottomRows(3), q));
    CHECK(body.triangles == triangles({{0, 1, 2}, {0, 0, 1}, {8, 6, 7}, {8, 6, 7}, {10, 12, 11}, {13, 14, 15}, {16, 17, 18}}));
    CHECK(model.part == std::vector<std::int32_t>{0, 0, 0, 0, 1, 2, 3});
    CHECK(find(*file, "not-a-surface")->count == 1);
    // Elements have always come by the index of their nodes.
    const auto scene = readScene({"a.glb", glb.file()});
    REQUIRE(scene);
    CHECK(scene->partNames == std::vector<std::string>{"last", "deep", "first", "points"});
}

TEST_CASE("character from GLB: a skin in its bind pose keeps the file's bits though joints round, a posed one follows its joints; its node moves neither") {
    const std::vector<float> at = {88.1f, 3.3f, -7.7f, 90.2f, 3.3f, -7.7f, 88.1f, 5.5f, -7.7f, 91.0f, 9.9f, 1.1f};
    const auto skinned = [&](const nlohmann::json& turn) {
        Glb glb;
        const int positions = glb.floats(at, "VEC3", 3), indices = glb.indices({0, 1, 2, 1, 3, 2});
        const int joints = glb.bytes({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}, "VEC4", 4), weights = glb.floats({1, 0, 0, 0, 1, 0, 0, 0, .75f, .25f, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
        // Bind matrices by column; joint 1 lies at (90, 1, 0), and its translation is rounded.
        const float x = std::nextafter(90.0f, 100.0f);
        const int bind = glb.floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -x, -1, 0, 1}, "MAT4", 16);
        glb.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", positions}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}}, {"indices", indices}}}}}};
        glb.json["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {5, 5, 5}}}, {{"name", "hip"}, {"children", {2}}}, {{"name", "knee"}, {"translation", {90, 1, 0}}, {"rotation", turn}}};
        glb.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", bind}}};
        glb.json["scenes"] = {{{"nodes", {0, 1}}}};
        return characterOf("a.glb", glb.file());
    };
    Points own(4, 3);
    for (int i = 0; i < 12; ++i) own.data()[i] = static_cast<double>(at[static_cast<std::size_t>(i)]);
    const auto bound = skinned({0, 0, 0, 1});
    CAPTURE(said(bound));
    REQUIRE(bound);
    checkSound(*bound);
    CHECK(sameBits(bound->renderModel.mesh.body.vertices, own));

    const auto posed = skinned({0, 0, std::sqrt(0.5), std::sqrt(0.5)});  // the knee by a quarter turn about z
    REQUIRE(posed);
    const auto turned = [&](Eigen::Index v) { return Eigen::RowVector3d(90 - (own(v, 1) - 1), 1 + (own(v, 0) - 90), own(v, 2)); };
    const Points& result = posed->renderModel.mesh.body.vertices;
    CHECK(sameBits(result.topRows(1), own.topRows(1)));
    CHECK((result.row(1) - turned(1)).norm() < 2e-5);  // single precision of 90
    CHECK((result.row(2) - (0.75 * own.row(2) + 0.25 * turned(2))).norm() < 2e-5);
    CHECK((result.row(3) - turned(3)).norm() < 2e-5);
}

TEST_CASE("character from DAE: nodes depth first, a vertex per corner of a polygon, transformations, unit and axis applied") {
    const auto geometry = [](const std::string& id, const std::string& numbers, const std::string& polygons) {
        return "<geometry id=\"" + id + "\" name=\"" + id + "\"><mesh><source id=\"" + id + "p\"><float_array id=\"" + id + "a\" count=\"12\">" + numbers +
               "</float_array><technique_common><accessor source=\"#" + id + "a\" count=\"4\" stride=\"3\"><param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/>"
               "</accessor></technique_common></source><vertices id=\"" + id + "v\"><input semantic=\"POSITION\" source=\"#" + id + "p\"/></vertices><polylist count=\"2\"><input semantic=\"VERTEX\" source=\"#" +
               id + "v\" offset=\"0\"/>" + polygons + "</polylist></mesh></geometry>";
    };
    const std::string dae = R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_geometries>)" + geometry("g", "0 0 0 1 0 0 1 1 0 0 1 0", "<vcount>4 3</vcount><p>0 1 2 3 0 2 1</p>") + geometry("h", "0 0 0 0 0 1 0 1 0 9 9 9", "<vcount>3 3</vcount><p>0 1 2 0 1 2</p>") +
                            R"(</library_geometries><library_visual_scenes><visual_scene id="s"><node id="a" name="腕"><translate>100 0 0</translate><instance_geometry url="#g"/>
<node id="b" name="手"><translate>0 0 50</translate><instance_geometry url="#h"/></node></node><node id="c" name="足"><instance_geometry url="#h"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
    const TestFolder folder;
    const auto file = character(folder.write("a.dae", dae));
    CAPTURE(said(file));
    REQUIRE(file);
    checkSound(*file);
    CHECK(file->metresPerUnit == 0.01);
    CHECK(file->zUpConverted);
    CHECK(file->renderModel.parts == std::vector<std::string>{"腕", "手", "足"});
    const Points expected = points({{1, 0, 0}, {1.01, 0, 0}, {1.01, 0, -0.01}, {1, 0, -0.01}, {1, 0, 0}, {1.01, 0, -0.01}, {1.01, 0, 0},  // a quad and a triangle
                                    {1, 0.5, 0}, {1, 0.51, 0}, {1, 0.5, -0.01}, {1, 0.5, 0}, {1, 0.51, 0}, {1, 0.5, -0.01},
                                    {0, 0, 0}, {0, 0.01, 0}, {0, 0, -0.01}, {0, 0, 0}, {0, 0.01, 0}, {0, 0, -0.01}});
    REQUIRE(file->renderModel.mesh.body.vertices.rows() == expected.rows());
    CHECK((file->renderModel.mesh.body.vertices - expected).cwiseAbs().maxCoeff() < 1e-6);  // single precision of the matrices
    CHECK(file->renderModel.part == std::vector<std::int32_t>{0, 0, 0, 1, 1, 2, 2});
}

TEST_CASE("character: unit and up axis change each coordinate by itself") {
    const TestFolder folder;
    ImportRequest request;
    request.path = folder.write("a.obj", "v 0.1 0.2 0.3\nv 1.7 2 3\nv 4 5 6\nv 0.7 0.7 1e3\nf 1 2 4\n");
    request.unit = Unit::Millimetre;
    request.up = UpAxis::Z;
    const auto file = character(request);
    CAPTURE(said(file));
    REQUIRE(file);
    CHECK(file->metresPerUnit == 1e-3);
    CHECK(file->zUpConverted);
    CHECK(sameBits(file->renderModel.mesh.body.vertices,
                   points({{0.1 * 1e-3, 0.3 * 1e-3, -(0.2 * 1e-3)}, {1.7 * 1e-3, 3 * 1e-3, -(2 * 1e-3)}, {4 * 1e-3, 6 * 1e-3, -(5 * 1e-3)}, {0.7 * 1e-3, 1e3 * 1e-3, -(0.7 * 1e-3)}})));
}

TEST_CASE("character: what is no surface at all is refused, what no triangle uses is not") {
    const TestFolder folder;
    const auto code = [&](const std::string& name, const std::string& bytes) {
        const auto r = character(folder.write(name, bytes));
        return r ? std::string("read") : r.error().code;
    };
    CHECK(code("a.obj", "v 0 0 0\n") == "empty-mesh");
    CHECK(code("a.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\nf 1 1 2\n") == "empty-mesh");  // on a line
    CHECK(code("a.obj", "v 0 0 0\nv 1 1 1\nv 2 2 3\nf 1 2 3\nf 1 1 2\n") == "read");
    CHECK(code("a.obj", "v 0 0 0\nv 1e-150 0 0\nv 0 1e-150 0\nf 1 2 3\n") == "read");
    CHECK(code("a.obj", "v 0 0 0\nv 1e60 0 0\nv 0 1 0\nf 1 2 3\n") == "too-far");
    CHECK(code("a.xyz", "1 2 3") == "unknown-format");
    CHECK(character(folder.path() / "none.obj").error().code == "file-not-found");

    const auto used = character(folder.write("a.obj", "v 0 nan 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
    REQUIRE(!used);
    CHECK(used.error().code == "non-finite");
    CHECK(used.error().message.find("line 1") != std::string::npos);

    const auto unused = character(folder.write("a.obj", "v 0 0 0\nv 4 nan -5\nv 1 0 0\nv inf -inf 1e999\nv 0 1 0\nf 1 3 5\n"));
    CAPTURE(said(unused));
    REQUIRE(unused);
    checkSound(*unused);
    CHECK(sameBits(unused->renderModel.mesh.body.vertices, points({{0, 0, 0}, {4, 0, -5}, {1, 0, 0}, {0, 0, 0}, {0, 1, 0}})));
    REQUIRE(find(*unused, "non-finite"));
    CHECK(find(*unused, "non-finite")->vertices == std::vector<std::int32_t>{1, 3});
    CHECK(find(*unused, "non-finite")->count == 2);
}

TEST_CASE("character: a worker that crashes, lies, hangs or answers another question harms nobody") {
    const TestFolder folder;
    const WithWorker bad(IMOMUSHI_TEST_BAD_IMPORT_WORKER);
    const auto answer = [&](const std::string& how, const WorkLimits& limits = {}) {
        ImportRequest request;
        request.path = folder.write(how + ".obj", "v 0 0 0\n");
        return importCharacter(request, {}, limits);
    };
    CHECK(answer("good"));
    for (const char* how : {"crash", "quit", "lie", "other"}) {
        CAPTURE(how);
        const auto r = answer(how);
        REQUIRE(!r);
        CHECK(r.error().code == "worker-failed");
    }
    WorkLimits limits;
    limits.wallSeconds = 0.3;
    CHECK(answer("hang", limits).error().code == "timeout");
}

TEST_CASE("character messages: an answer comes over as it was, and cut or changed anywhere it is refused or sound") {
    const auto file = characterOf("a.obj", "usemtl m\no 一\nv 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\no 二\nf 1/1/1 3/1/1 2/1/1\n");
    CAPTURE(said(file));
    REQUIRE(file);
    const std::string bytes = messageOf(file);
    const auto again = inMessage<CharacterFile>(bytes);
    REQUIRE(again);
    checkSound(*again);
    CHECK(messageOf(again) == bytes);
    CHECK(again->renderModel.parts == std::vector<std::string>{"一", "二"});
    for (std::size_t n = 0; n < bytes.size(); ++n) REQUIRE(!inMessage<CharacterFile>(std::string_view(bytes).substr(0, n)));
    REQUIRE(!inMessage<CharacterFile>(bytes + "x"));
    int sound = 0;
    for (std::size_t n = 0; n < bytes.size(); ++n)
        for (const char c : {'\x00', '\x7f', '\xff'}) {
            std::string changed = bytes;
            changed[n] = c;
            const auto r = inMessage<CharacterFile>(changed);
            if (!r) continue;
            ++sound;
            const RenderModel& model = r->renderModel;
            REQUIRE(allFinite(model.mesh.body.vertices));
            REQUIRE(model.mesh.body.triangles.minCoeff() >= 0);
            REQUIRE(model.mesh.body.triangles.maxCoeff() < model.mesh.body.vertices.rows());
            for (const std::int32_t p : model.part) REQUIRE(model.parts.size() > static_cast<std::size_t>(p));
            for (const MeshIssue& i : r->issues)
                for (const std::int32_t v : i.vertices) REQUIRE((v >= 0 && v < model.mesh.body.vertices.rows()));
        }
    CHECK(sound > 0);
}

TEST_CASE("character: 6000 damaged files are refused or give sound models") {
    const TriangleMesh box = shapes::box({0, 0, 0}, {1, 2, 3}, 1, 1, 1).mesh;
    std::string ply = "ply\nformat binary_little_endian 1.0\nelement vertex 8\nproperty double x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                      "element face 12\nproperty list uchar int vertex_indices\nend_header\n",
                stl(80, ' ');
    for (Eigen::Index v = 0; v < 8; ++v) {
        put(ply, box.vertices(v, 0));
        for (int k = 1; k < 3; ++k) put(ply, static_cast<float>(box.vertices(v, k)));
        ply += "abc";
    }
    put(stl, std::uint32_t{12});
    for (Eigen::Index f = 0; f < 12; ++f) {
        ply += '\3';
        for (int k = 0; k < 3; ++k) put(ply, box.triangles(f, k));
        for (int k = 0; k < 3; ++k) put(stl, 0.0f);
        for (int k = 0; k < 9; ++k) put(stl, static_cast<float>(box.vertices(box.triangles(f, k / 3), k % 3)));
        put(stl, std::uint16_t{0});
    }
    Glb glb;
    const int positions = glb.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3", 3), indices = glb.indices({0, 1, 2, 0, 2, 3}), joints = glb.bytes({0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}, "VEC4", 4),
              weights = glb.floats({1, 0, 0, 0, 1, 0, 0, 0, .75f, .25f, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
    glb.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", positions}, {"NORMAL", positions}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}}, {"indices", indices}}}}}};
    glb.json["nodes"] = {{{"mesh", 0}, {"skin", 0}}, {{"children", {2}}}, {{"translation", {9, 1, 0}}, {"mesh", 0}}};
    glb.json["skins"] = {{{"joints", {1, 2}}}};
    glb.json["scenes"] = {{{"nodes", {0, 1}}}};
    const std::pair<std::string, std::string> files[] = {
        {"a.obj", "o a\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\nvt 0 0.5\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1 4/1/1\ng b\nf -1 -2 -3\n"}, {"a.ply", ply}, {"a.stl", stl}, {"a.glb", glb.file()}};
    std::mt19937 random(15);
    int read = 0, refused = 0;
    for (const auto& [name, bytes] : files) {
        CAPTURE(name);
        REQUIRE(characterOf(name, bytes));
        for (int i = 0; i < 1500; ++i) {
            CAPTURE(i);
            std::string damaged = bytes;
            for (auto left = 1 + random() % 4; left > 0; --left) {
                const std::size_t n = random() % damaged.size();
                static const char kDigits[] = "0123456789-./e nai\n";
                damaged[n] = random() % 2 ? static_cast<char>(random() % 256) : kDigits[random() % (sizeof kDigits - 1)];
            }
            if (i % 10 == 0) damaged.resize(random() % damaged.size() + 1);
            const auto r = characterOf(name, damaged);
            if (!r) {
                ++refused;
                CHECK(!r.error().message.empty());
                continue;
            }
            ++read;
            checkSound(*r);
            REQUIRE(inMessage<CharacterFile>(messageOf(r)));
        }
    }
    CHECK(read > 100);
    CHECK(refused > 100);
}
