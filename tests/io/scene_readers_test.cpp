// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "tests/io/raw_scene.h"
#include "tests/support/shapes.h"
#include "tests/support/without_steps.h"

using namespace imomushi;
using namespace io_test;

namespace {

/// A glTF scene of one mesh in one buffer, with what `change` does to its JSON.
std::string gltf(const TriangleMesh& mesh, const std::function<void(nlohmann::json&)>& change = {}) {
    std::string buffer;
    for (Eigen::Index i = 0; i < mesh.vertices.size(); ++i) put(buffer, static_cast<float>(mesh.vertices.data()[i]));
    const std::size_t positions = buffer.size();
    for (Eigen::Index i = 0; i < mesh.triangles.size(); ++i) put(buffer, static_cast<std::uint16_t>(mesh.triangles.data()[i]));
    const std::size_t indices = buffer.size() - positions;
    while (buffer.size() % 4) buffer += '\0';
    nlohmann::json json = {
        {"asset", {{"version", "2.0"}}},
        {"scene", 0},
        {"scenes", {{{"nodes", {0}}}}},
        {"nodes", {{{"mesh", 0}, {"name", "Kürbis"}}}},
        {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}}},
        {"buffers", {{{"byteLength", buffer.size()}}}},
        {"bufferViews", {{{"buffer", 0}, {"byteLength", positions}}, {{"buffer", 0}, {"byteOffset", positions}, {"byteLength", indices}}}},
        {"accessors",
         {{{"bufferView", 0}, {"componentType", 5126}, {"count", mesh.vertices.rows()}, {"type", "VEC3"}},
          {{"bufferView", 1}, {"componentType", 5123}, {"count", mesh.triangles.size()}, {"type", "SCALAR"}}}}};
    if (change) change(json);
    std::string text = json.dump();
    while (text.size() % 4) text += ' ';
    std::string glb = "glTF";
    put(glb, std::uint32_t{2});
    put(glb, static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + buffer.size()));
    put(glb, static_cast<std::uint32_t>(text.size()));
    put(glb, std::uint32_t{0x4E4F534A});
    glb += text;
    put(glb, static_cast<std::uint32_t>(buffer.size()));
    put(glb, std::uint32_t{0x004E4942});
    return glb + buffer;
}

}  // namespace

TEST_CASE("GLB: a mesh comes exactly, a node's transform is applied, a mirrored one stays outward") {
    const TriangleMesh ball = shapes::sphere(1.0, 2).mesh;
    const TestFolder folder;
    auto answer = io_test::import(folder.write("a.glb", gltf(ball)));
    REQUIRE(answer);
    CHECK(answer->format == "glb");
    CHECK(answer->bodies[0].name == "Kürbis");
    CHECK(answer->bodies[0].closed);
    CHECK(answer->bodies[0].mesh.body.vertices == ball.vertices.cast<float>().cast<double>());
    answer = io_test::import(folder.write("a.glb", gltf(ball, [](auto& j) { j["nodes"][0]["scale"] = {-2, 2, 2}, j["nodes"][0]["translation"] = {10, 0, 0}; })));
    REQUIRE(answer);
    CHECK(answer->bodies[0].closed);
    CHECK(!io_test::find(*answer, "inverted"));
    CHECK(meshFacts(answer->bodies[0].mesh.body).volume == doctest::Approx(8 * meshFacts(ball).volume).epsilon(1e-6));
    CHECK(answer->bodies[0].mesh.body.vertices.col(0).mean() == doctest::Approx(10.0).epsilon(1e-3));
}

TEST_CASE("GLB: what is wrong is refused with its reason") {
    const TriangleMesh ball = shapes::sphere(1.0, 1).mesh;
    const std::string good = gltf(ball);
    REQUIRE(scene("a.glb", good));
    for (std::size_t n = 0; n < good.size(); n += 37) CHECK(code(scene("a.glb", good.substr(0, n))) == "bad-file");
    const auto refused = [&](const std::function<void(nlohmann::json&)>& change, const std::string& part) {
        const auto r = scene("a.glb", gltf(ball, change));
        CAPTURE(part);
        CAPTURE(said(r));
        CHECK(code(r) == "bad-file");
        CHECK(said(r).find(part) != std::string::npos);
    };
    refused([](auto& j) { j["accessors"][0]["count"] = 4000; }, "beyond");
    refused([](auto& j) { j["accessors"][0]["count"] = -1; }, "count");
    refused([](auto& j) { j["accessors"][1]["componentType"] = 7; }, "type");
    refused([](auto& j) { j["bufferViews"][0]["byteOffset"] = 1e15; }, "beyond");
    refused([](auto& j) { j["meshes"][0]["primitives"][0]["indices"] = 9; }, "accessor 9");
    refused([](auto& j) { j["nodes"][0]["children"] = {0}; }, "contain themselves");
    refused([](auto& j) { j["nodes"][0]["mesh"] = 5; }, "mesh 5");
    refused([](auto& j) { j["nodes"] = 3; }, "list");
    refused([](auto& j) { j["nodes"][0]["matrix"] = {1, 2, 3}; }, "matrix");
    refused([](auto& j) { j["asset"]["version"] = "3.0"; }, "version");
    refused([](auto& j) { j["buffers"][0]["uri"] = "../other.bin", j["buffers"][0]["byteLength"] = 4; }, "outside");
    refused([](auto& j) { j["extensionsRequired"] = {"KHR_audio"}; }, "export it without");
    refused([](auto& j) { j["extensionsRequired"] = {"FOO_bar"}; }, "FOO_bar");
    CHECK(code(scene("a.glb", gltf(ball, [](auto& j) { j.erase("meshes"), j["nodes"][0].erase("mesh"); }))) == "empty-mesh");
    TriangleMesh reaching = ball;
    reaching.triangles(5, 1) = 1000;
    const auto r = scene("a.glb", gltf(reaching));
    CHECK(said(r).find("vertex 1000") != std::string::npos);
    TriangleMesh bad = ball;
    bad.vertices(7, 1) = std::numeric_limits<double>::infinity();
    const TestFolder folder;
    const auto answer = io_test::import(folder.write("a.glb", gltf(bad)));
    REQUIRE(!answer);
    CHECK(answer.error().code == "non-finite");
    CHECK(answer.error().message.find("vertex 7 of 'Kürbis'") != std::string::npos);
}

TEST_CASE("glTF: sparse accessors, strips, normalised integers and data in the text") {
    const nlohmann::json json = {
        {"asset", {{"version", "2.0"}}},
        {"nodes", {{{"mesh", 0}}}},
        {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"mode", 5}}}}}}},
        {"buffers", {{{"byteLength", 8}, {"uri", "data:application/octet-stream;base64,AQAAf38A//8="}}}},  // 01 | 00 | 00 7f 7f | 00 ff ff
        {"bufferViews", {{{"buffer", 0}, {"byteLength", 1}}, {{"buffer", 0}, {"byteOffset", 2}, {"byteLength", 3}}}},
        {"accessors",
         {{{"componentType", 5120}, {"normalized", true}, {"count", 4}, {"type", "VEC3"},
           {"sparse", {{"count", 1}, {"indices", {{"bufferView", 0}, {"componentType", 5121}}}, {"values", {{"bufferView", 1}}}}}}}}};
    const auto r = scene("a.gltf", json.dump());
    CAPTURE(said(r));
    REQUIRE(r);
    REQUIRE(r->surface.mesh.body.vertices.rows() == 4);
    CHECK(r->surface.mesh.body.vertices.row(1) == Eigen::RowVector3d(0, 1, 1));
    CHECK(r->surface.mesh.body.vertices.row(2).isZero(0));
    Triangles strip(2, 3);
    strip << 0, 1, 2, 1, 3, 2;
    CHECK(r->surface.mesh.body.triangles == strip);
    CHECK(said(scene("a.gltf", "{\n\n\"asset\": }")).find("line 3") != std::string::npos);
}

TEST_CASE("unit and up axis: asked for they convert, else nothing changes") {
    const TestFolder folder;
    ImportRequest request;
    request.path = folder.write("a.obj", io_test::objOf(shapes::box({0, 0, 0}, {1, 2, 3}, 1, 1, 1).mesh));
    auto answer = io_test::import(request);
    REQUIRE(answer);
    CHECK(meshFacts(answer->bodies[0].mesh.body).high == Vec3(1, 2, 3));
    request.unit = Unit::Millimetre;
    request.up = UpAxis::Z;
    answer = io_test::import(request);
    REQUIRE(answer);
    CHECK(answer->metresPerUnit == 1e-3);
    CHECK(answer->zUpConverted);
    CHECK(answer->bodies[0].closed);
    CHECK(meshFacts(answer->bodies[0].mesh.body).low == Vec3(0, 0, -2e-3));
    CHECK(meshFacts(answer->bodies[0].mesh.body).high == Vec3(1e-3, 3e-3, 0));
}

TEST_CASE("DAE and FBX carry their unit and up axis") {
    const TestFolder folder;
    // A box of 200 x 100 x 50 cm, Z up.
    const std::string dae = R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g" name="箱"><mesh><source id="p"><float_array id="pa" count="24">0 0 0 200 0 0 200 100 0 0 100 0 0 0 50 200 0 50 200 100 50 0 100 50</float_array>
<technique_common><accessor source="#pa" count="8" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="6"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4 4 4 4 4 4</vcount><p>3 2 1 0 4 5 6 7 0 1 5 4 1 2 6 5 2 3 7 6 3 0 4 7</p></polylist></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n" name="箱"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
    auto answer = io_test::import(folder.write("a.dae", dae));
    CAPTURE((answer ? std::string() : answer.error().message));
    REQUIRE(answer);
    CHECK(answer->metresPerUnit == 0.01);
    CHECK(answer->zUpConverted);
    CHECK(answer->bodies[0].closed);
    CHECK(answer->bodies[0].name == "箱");
    const MeshFacts box = meshFacts(answer->bodies[0].mesh.body);
    CHECK((box.high - box.low).isApprox(Vec3(2.0, 0.5, 1.0), 1e-6));
    CHECK(box.high.y() == doctest::Approx(0.5));

    const std::string fbx = R"(; FBX 7.3.0 project file
FBXHeaderExtension:  { FBXHeaderVersion: 1003
 FBXVersion: 7300 }
GlobalSettings:  { Version: 1000
 Properties70:  {
  P: "UpAxis", "int", "Integer", "",2
  P: "UpAxisSign", "int", "Integer", "",1
  P: "FrontAxis", "int", "Integer", "",1
  P: "FrontAxisSign", "int", "Integer", "",-1
  P: "CoordAxis", "int", "Integer", "",0
  P: "CoordAxisSign", "int", "Integer", "",1
  P: "UnitScaleFactor", "double", "Number", "",2.54
 } }
Objects:  {
 Geometry: 10, "Geometry::", "Mesh" {
  Vertices: *24 { a: 0,0,0,200,0,0,200,100,0,0,100,0,0,0,50,200,0,50,200,100,50,0,100,50 }
  PolygonVertexIndex: *24 { a: 3,2,1,-1,4,5,6,-8,0,1,5,-5,1,2,6,-6,2,3,7,-7,3,0,4,-8 }
  GeometryVersion: 124 }
 Model: 20, "Model::box", "Mesh" { Version: 232
 }
}
Connections:  {
 C: "OO",10,20
 C: "OO",20,0
}
)";
    answer = io_test::import(folder.write("a.fbx", fbx));
    CAPTURE((answer ? std::string() : answer.error().message));
    REQUIRE(answer);
    CHECK(answer->metresPerUnit == doctest::Approx(0.0254).epsilon(1e-6));
    CHECK(answer->zUpConverted);
    CHECK(answer->bodies[0].closed);
    const MeshFacts inches = meshFacts(answer->bodies[0].mesh.body);
    CHECK((inches.high - inches.low).isApprox(Vec3(5.08, 1.27, 2.54), 1e-6));
    CHECK(inches.high.y() == doctest::Approx(1.27));
    CHECK(inches.low.z() == doctest::Approx(-2.54));

    // Where reading its animations broke down before, they are left out.
    for (const bool animated : {true, false}) {
        const std::vector<std::string> leftOut(animated ? 0 : 1, "the animations of the file (1)");
        const auto whole = withoutSteps<CharacterFile>(leftOut, "import-character", ImportRequest{folder.path() / "a.fbx"});
        REQUIRE(whole);
        const auto& issues = whole->issues;
        CHECK(std::any_of(issues.begin(), issues.end(), [](const MeshIssue& i) { return i.code == "left-out"; }) == !animated);
    }

    CHECK(io_test::import(folder.write("b.fbx", "no fbx")).error().code == "bad-file");
    CHECK(!io_test::import(folder.write("c.dae", dae.substr(0, 900))));
}
