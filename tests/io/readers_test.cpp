// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/io/build_result.h"
#include "core/io/message.h"
#include "core/mesh/write_mesh.h"
#include "tests/io/files.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

/// What a reader says of `bytes` under this name, beside no other file.
Result<RawScene> scene(const std::string& name, const std::string& bytes) {
    const TestFolder folder;
    return readScene({folder.path() / name, bytes});
}

std::string code(const Result<RawScene>& r) { return r ? "read" : r.error().code; }
std::string said(const Result<RawScene>& r) { return r ? "" : r.error().message; }

template <class T>
void put(std::string& bytes, T value, bool swap = false) {
    char b[sizeof(T)];
    std::memcpy(b, &value, sizeof b);
    if (swap) std::reverse(b, b + sizeof b);
    bytes.append(b, sizeof b);
}

std::string binaryStl(const TriangleMesh& mesh) {
    std::string s(80, ' ');
    put(s, static_cast<std::uint32_t>(mesh.triangles.rows()));
    for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
        for (int k = 0; k < 3; ++k) put(s, 0.0f);
        for (int k = 0; k < 9; ++k) put(s, static_cast<float>(mesh.vertices(mesh.triangles(f, k / 3), k % 3)));
        put(s, std::uint16_t{0});
    }
    return s;
}

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

const char* const kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

const MeshIssue* find(const RawScene& s, const std::string& issue) {
    for (const MeshIssue& i : s.issues)
        if (i.code == issue) return &i;
    return nullptr;
}

}  // namespace

TEST_CASE("numbers: decimal in any shape, in every locale") {
    double x = 0.0;
    for (const auto& known : std::initializer_list<std::pair<const char*, double>>{
             {"1", 1.0}, {"+1.5", 1.5}, {"-0.25", -0.25}, {".5", 0.5}, {"5.", 5.0}, {"1e3", 1000.0}, {"1E-3", 0.001}, {"1e-400", 0.0}, {"0.1", 0.1}, {"123456789.123456789", 123456789.123456789}}) {
        CAPTURE(known.first);
        CHECK(parseNumber(known.first, x));
        CHECK(x == known.second);
    }
    for (const char* text : {"nan", "inf", "-inf", "1e400"}) {
        CAPTURE(text);
        CHECK(parseNumber(text, x));
        CHECK(!std::isfinite(x));
    }
    for (const char* text : {"", "0,5", "1.2.3", "x", "+-1", "1e", "--1", "0x10"}) {
        CAPTURE(text);
        CHECK(!parseNumber(text, x));
    }
}

TEST_CASE("names: always valid UTF-8, without control characters, never empty") {
    CHECK(cleanName("  いもむし ", "x") == "いもむし");
    CHECK(cleanName("caf\xe9", "x") == "café");  // Latin-1
    CHECK(cleanName("a\nb\tc", "x") == "abc");
    CHECK(cleanName("", "x") == "x");
    CHECK(cleanName("\xff\xfe", "x") == "ÿþ");
}

TEST_CASE("polygons: a concave quad is cut inside, whichever corner it begins with") {
    const std::vector<double> points = {0, 0, 0, 2, 0, 0, 0.5, 0.5, 0, 0, 2, 0};  // corner 2 is reflex
    for (int first = 0; first < 4; ++first) {
        const std::vector<std::int32_t> quad = {first, (first + 1) % 4, (first + 2) % 4, (first + 3) % 4};
        std::vector<std::array<std::int32_t, 3>> cut;
        triangulatePolygon(points, quad, cut);
        REQUIRE(cut.size() == 2);
        double area = 0.0;
        for (const auto& t : cut) {
            const auto at = [&](int k) { return points.data() + 3 * quad[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])]; };
            const double part = ((at(1)[0] - at(0)[0]) * (at(2)[1] - at(0)[1]) - (at(1)[1] - at(0)[1]) * (at(2)[0] - at(0)[0])) / 2;
            CHECK(part > 0.0);
            area += part;
        }
        CHECK(area == doctest::Approx(1.0).epsilon(1e-14));
    }
}

TEST_CASE("polygons: any star is covered exactly once, small ones by ears and large ones by Delaunay") {
    for (const int n : {5, 12, 60, 254, 600}) {
        CAPTURE(n);
        std::vector<double> points;
        std::vector<std::int32_t> corners;
        double exact = 0.0;
        for (int i = 0; i < n; ++i) {
            const double t = 2 * std::numbers::pi * i / n, r = i % 2 ? 0.6 : 1.0, next = i % 2 || i == n - 1 ? 1.0 : 0.6;
            points.insert(points.end(), {5 + r * std::cos(t), 7.0, 3 - r * std::sin(t)});  // in the x-z plane, normal +y
            corners.push_back(i);
            exact += r * next * std::sin(2 * std::numbers::pi / n) / 2;
        }
        std::vector<std::array<std::int32_t, 3>> cut;
        triangulatePolygon(points, corners, cut);
        REQUIRE(cut.size() == corners.size() - 2);
        double area = 0.0;
        for (const auto& t : cut) {
            const auto at = [&](int k) { return points.data() + 3 * t[static_cast<std::size_t>(k)]; };
            const double part = -((at(1)[0] - at(0)[0]) * (at(2)[2] - at(0)[2]) - (at(1)[2] - at(0)[2]) * (at(2)[0] - at(0)[0])) / 2;
            CHECK(part > -1e-12);
            area += part;
        }
        CHECK(area == doctest::Approx(exact).epsilon(1e-10));
    }
}

TEST_CASE("OBJ: the same mesh however it is written") {
    const TriangleMesh box = shapes::box({0, 0, 0}, {1, 2, 3}, 1, 1, 1).mesh;
    const std::string plain = io_test::objOf(box);
    std::string crlf = "\xef\xbb\xbf# with a mark and other line ends\r\n", cr, negative, continued;
    for (const char c : plain) crlf += c == '\n' ? "\r\n" : std::string(1, c), cr += c == '\n' ? '\r' : c;
    for (Eigen::Index v = 0; v < 8; ++v)
        for (int k = 0; k < 3; ++k) negative += (k ? " " : v ? "\nv " : "v ") + std::to_string(box.vertices(v, k));
    negative += '\n';
    for (Eigen::Index f = 0; f < box.triangles.rows(); ++f)
        for (int k = 0; k < 3; ++k) negative += (k ? " " : "f ") + std::to_string(box.triangles(f, k) - 8) + (k == 2 ? "\n" : "");
    for (const char c : plain) continued += c == ' ' ? " \\\n " : std::string(1, c);
    for (const std::string& text : {plain, crlf, cr, negative, continued, plain.substr(0, plain.size() - 1), "\n\n  \t\n" + plain}) {
        const auto r = scene("a.obj", text);
        REQUIRE(r);
        CHECK(r->surface.mesh.body.vertices == box.vertices);
        CHECK(r->surface.mesh.body.triangles == box.triangles);
        CHECK(r->issues.empty());
    }
}

TEST_CASE("OBJ: what is wrong is said with its line") {
    const std::string three = kTriangle;
    const auto bad = [&](const std::string& more, const std::string& part) {
        const auto r = scene("猫.obj", three + more);
        CAPTURE(more);
        CHECK(code(r) == "bad-file");
        CHECK(said(r).find("'猫.obj', line 4") != std::string::npos);
        CHECK(said(r).find(part) != std::string::npos);
    };
    bad("f 1 2 4\n", "vertex 4");
    bad("f 0 1 2\n", "vertex 0");
    bad("f 1 2 -4\n", "vertex -4");
    bad("f 1 2 99999999999999999999\n", "vertex 99999999999999999999");
    bad("f 1 2 x\n", "corner");
    bad("f 1 2 3/x\n", "corner");
    bad("v 0,5 1 2\n", "comma");
    bad("v 1 2\n", "three coordinates");
    bad("v 1 2 3 4 5 6 7 8 9 10\n", "three coordinates");
    bad("vn 1 2\n", "three numbers");
    CHECK(code(scene("a.obj", "# nothing\n")) == "empty-mesh");
    CHECK(code(scene("a.obj", three)) == "empty-mesh");
    CHECK(code(scene("a.obj", "")) == "empty-mesh");
}

TEST_CASE("OBJ: a number that is not finite is refused with its line where a triangle uses it, dropped where none does") {
    const TestFolder folder;
    const std::string box = io_test::objOf(shapes::box({0, 0, 0}, {1, 1, 1}, 1, 1, 1).mesh);
    for (const char* bad : {"nan", "inf", "-inf", "1e999"}) {
        CAPTURE(bad);
        auto answer = io_test::import(folder.write("a.obj", std::string("v 0 ") + bad + " 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
        REQUIRE(!answer);
        CHECK(answer.error().code == "non-finite");
        CHECK(answer.error().message.find("line 1") != std::string::npos);
        answer = io_test::import(folder.write("b.obj", box + "v 0 " + bad + " 0\n"));
        REQUIRE(answer);
        CHECK(answer->bodies[0].closed);
        CHECK(answer->bodies[0].mesh.body.vertices.rows() == 8);
        CHECK(io_test::find(*answer, "unused-vertex")->fixed);
    }
}

TEST_CASE("OBJ: look: texture coordinates, normals, colours, materials and textures come along") {
    const TestFolder folder;
    folder.write("skin.png", std::string("\x89PNG\r\n\x1a\n") + "picture");
    std::ofstream(folder.path().parent_path() / "secret.png") << "\x89PNG\r\n\x1a\nsecret";
    folder.write("a.mtl", "newmtl skin\nKd 0.1 0.2 0.3\nmap_Kd -s 1 1 1 -clamp on skin.png\nnewmtl red # a comment\nKd 1 0 0\nd 0.5\nnewmtl outside\nmap_Kd ../secret.png\n");
    std::string obj = "mtllib a.mtl\no 木\n";
    const TriangleMesh box = shapes::box({0, 0, 0}, {1, 1, 1}, 1, 1, 1).mesh;
    for (Eigen::Index v = 0; v < 8; ++v) obj += "v " + std::to_string(box.vertices(v, 0)) + " " + std::to_string(box.vertices(v, 1)) + " " + std::to_string(box.vertices(v, 2)) + " 1 0.5 0\n";
    obj += "vt 0 0\nvt 1 0\nvt 0.25 0.75\nvn 0 0 2\n";
    for (Eigen::Index f = 0; f < 12; ++f) {
        if (f == 0) obj += "usemtl skin\n";
        if (f == 6) obj += "usemtl red\n";
        if (f == 11) obj += "usemtl outside\n";
        obj += "f";
        for (int k = 0; k < 3; ++k) obj += " " + std::to_string(box.triangles(f, k) + 1) + "/" + std::to_string(k + 1) + "/1";
        obj += "\n";
    }
    const auto answer = io_test::import(folder.write("a.obj", obj));
    std::filesystem::remove(folder.path().parent_path() / "secret.png");
    REQUIRE(answer);
    REQUIRE(answer->bodies.size() == 1);
    const ImportedBody& body = answer->bodies[0];
    CHECK(body.name == "木");
    CHECK(body.closed);
    CHECK(body.mesh.body.vertices == box.vertices);  // the look splits no body vertex
    const Look& look = body.mesh.look;
    CHECK(look.bodyVertex.size() > 8);
    CHECK(look.texCoords.rows() == static_cast<Eigen::Index>(look.bodyVertex.size()));
    const int corner = look.triangles(0, 2);
    CHECK(look.texCoords(corner, 0) == 0.25f);
    CHECK(look.texCoords(corner, 1) == 0.25f);  // origin top left
    CHECK(look.normals(corner, 2) == 1.0f);
    CHECK(look.colors(corner, 0) == 1.0f);
    CHECK(look.colors(corner, 1) == doctest::Approx(0.2140f).epsilon(1e-3));  // sRGB 0.5
    REQUIRE(look.materials.size() == 3);
    CHECK(look.materials[0].name == "skin");
    REQUIRE(look.materials[0].baseColorTexture == 0);
    CHECK(look.textures[0].mimeType == "image/png");
    CHECK(look.textures[0].bytes.size() == 15);
    CHECK(look.materials[1].baseColor == Eigen::Vector4f(1, 0, 0, 0.5f));
    CHECK(look.material[0] == 0);
    CHECK(look.material[6] == 1);
    CHECK(look.materials[2].baseColorTexture == -1);
    CHECK(look.textures.size() == 1);  // nothing from outside of the folder
    REQUIRE(io_test::find(*answer, "texture"));
    CHECK(io_test::find(*answer, "texture")->text.find("secret") != std::string::npos);
}

TEST_CASE("PLY: ascii and binary of both byte orders say the same") {
    const TriangleMesh ball = shapes::sphere(1.0, 2).mesh;
    const auto header = [&](const std::string& format, const std::string& extra) {
        return "ply\r\nformat " + format + " 1.0\r\ncomment いもむし\r\nelement vertex " + std::to_string(ball.vertices.rows()) +
               "\r\nproperty double x\r\nproperty double y\r\nproperty double z\r\n" + extra + "element face " + std::to_string(ball.triangles.rows()) +
               "\r\nproperty list uchar uint vertex_indices\r\nend_header\r\n";
    };
    std::string ascii = header("ascii", "");
    char number[40];
    for (Eigen::Index v = 0; v < ball.vertices.rows(); ++v) {
        for (int k = 0; k < 3; ++k) std::snprintf(number, sizeof number, "%.17g ", ball.vertices(v, k)), ascii += number;
        ascii += '\n';
    }
    for (Eigen::Index f = 0; f < ball.triangles.rows(); ++f) {
        ascii += '3';
        for (int k = 0; k < 3; ++k) ascii += ' ' + std::to_string(ball.triangles(f, k));
        ascii += '\n';
    }
    std::vector<std::string> files = {ascii};
    for (const bool swap : {false, true}) {
        std::string s = header(swap ? "binary_big_endian" : "binary_little_endian", "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty list uchar int junk\n");
        for (Eigen::Index v = 0; v < ball.vertices.rows(); ++v) {
            for (int k = 0; k < 3; ++k) put(s, ball.vertices(v, k), swap);
            s += std::string("\xff\x80\0", 3);
            s += '\2';
            put(s, 1, swap), put(s, 2, swap);
        }
        for (Eigen::Index f = 0; f < ball.triangles.rows(); ++f) {
            s += '\3';
            for (int k = 0; k < 3; ++k) put(s, ball.triangles(f, k), swap);
        }
        files.push_back(s);
    }
    for (const std::string& bytes : files) {
        const auto r = scene("a.ply", bytes);
        CAPTURE(said(r));
        REQUIRE(r);
        CHECK(io_test::sameBits(r->surface.mesh.body.vertices, ball.vertices));
        CHECK(r->surface.mesh.body.triangles == ball.triangles);
        if (r->surface.mesh.look.colors.rows() > 0) {
            CHECK(r->surface.mesh.look.colors(0, 0) == 1.0f);
            CHECK(r->surface.mesh.look.colors(0, 1) == doctest::Approx(0.2159f).epsilon(1e-3));
        }
        // Cut off anywhere it is refused, never read halfway.
        for (std::size_t n = 0; n < bytes.size(); n += bytes.size() / 40) CHECK(!scene("a.ply", bytes.substr(0, n)));
    }
}

TEST_CASE("PLY: lies are refused") {
    const std::string vertex = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    const std::string face = "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
    CHECK(scene("a.ply", vertex + face + "3 0 1 2\n"));
    CHECK(said(scene("a.ply", vertex + face + "3 0 1 3\n")).find("vertex 3") != std::string::npos);
    CHECK(said(scene("a.ply", vertex + face + "3 0 1 -1\n")).find("line 13") != std::string::npos);
    CHECK(code(scene("a.ply", vertex + face + "1000000000 0 1 2\n")) == "bad-file");
    CHECK(code(scene("a.ply", vertex + face + "3 0 1 x\n")) == "bad-file");
    CHECK(code(scene("a.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n")) == "bad-file");
    CHECK(code(scene("a.ply", "ply\nformat ascii 1.0\nelement vertex 18446744073709551615\nproperty float x\nend_header\n")) == "bad-file");
    CHECK(code(scene("a.ply", "ply\nformat ascii 1.0\nelement face 1\nproperty list float int vertex_indices\nend_header\n")) == "bad-file");
    CHECK(code(scene("a.ply", "not a ply")) == "bad-file");
    CHECK(code(scene("a.ply", vertex + "end_header\n0 0 0\n1 0 0\n0 1 0\n")) == "empty-mesh");
}

TEST_CASE("STL: ascii and binary, even one whose header begins with 'solid'") {
    const TriangleMesh ball = shapes::sphere(1.0, 2).mesh;
    std::string binary = binaryStl(ball), solid = binary;
    solid.replace(0, 6, "solid ");
    std::string ascii = "solid 球\n";
    for (Eigen::Index f = 0; f < ball.triangles.rows(); ++f) {
        ascii += " facet normal 0 0 0\n  outer loop\n";
        for (int k = 0; k < 3; ++k) {
            char line[100];
            std::snprintf(line, sizeof line, "   vertex %.9g %.9g %.9g\n", ball.vertices(ball.triangles(f, k), 0), ball.vertices(ball.triangles(f, k), 1), ball.vertices(ball.triangles(f, k), 2));
            ascii += line;
        }
        ascii += "  endloop\n endfacet\n";
    }
    ascii += "endsolid 球\n";
    const TestFolder folder;
    for (const std::string& bytes : {binary, solid, ascii}) {
        const auto answer = io_test::import(folder.write("a.stl", bytes));
        REQUIRE(answer);
        CHECK(answer->bodies[0].closed);
        CHECK(answer->bodies[0].mesh.body.vertices.rows() == ball.vertices.rows());
        CHECK(answer->bodies[0].mesh.body.triangles.rows() == ball.triangles.rows());
    }
    CHECK(io_test::import(folder.write("a.stl", ascii))->bodies[0].name == "球");
    std::string lying = binary;
    std::memset(lying.data() + 80, 0xff, 4);
    CHECK(said(scene("a.stl", lying)).find("4294967295") != std::string::npos);
    CHECK(code(scene("a.stl", binary.substr(0, binary.size() - 7))) == "bad-file");
    CHECK(code(scene("a.stl", ascii.substr(0, ascii.size() / 2))) == "bad-file");
    CHECK(code(scene("a.stl", "")) == "bad-file");
    CHECK(code(scene("a.stl", "solid a\nendsolid a\n")) == "empty-mesh");
    CHECK(said(scene("a.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 zero\n")).find("line 4") != std::string::npos);
}

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
    refused([](auto& j) { j["asset"]["version"] = "1.0"; }, "version");
    refused([](auto& j) { j["buffers"][0]["uri"] = "../other.bin", j["buffers"][0]["byteLength"] = 4; }, "outside");
    refused([](auto& j) { j["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }, "without compression");
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

    CHECK(io_test::import(folder.write("b.fbx", "no fbx")).error().code == "bad-file");
    CHECK(!io_test::import(folder.write("c.dae", dae.substr(0, 900))));
}

TEST_CASE("messages: an answer comes over as it was, and cut or changed anywhere it is refused or sound") {
    const TestFolder folder;
    folder.write("t.png", std::string("\x89PNG\r\n\x1a\n") + "x");
    folder.write("a.mtl", "newmtl m\nmap_Kd t.png\n");
    std::string obj = "mtllib a.mtl\nusemtl m\n" + io_test::objOf(shapes::box({0, 0, 0}, {1, 1, 1}, 1, 1, 1).mesh);
    obj += "v 5 5 5\n";
    const auto answer = io_test::import(folder.write("a.obj", obj));
    REQUIRE(answer);
    const std::string bytes = encodeAnswer(answer);
    const auto again = decodeAnswer(bytes);
    REQUIRE(again);
    CHECK(encodeAnswer(again) == bytes);
    for (std::size_t n = 0; n < bytes.size(); ++n) REQUIRE(!decodeAnswer(std::string_view(bytes).substr(0, n)));
    for (std::size_t n = 0; n < bytes.size(); ++n)
        for (const char c : {'\x00', '\x7f', '\xff'}) {
            std::string changed = bytes;
            changed[n] = c;
            const auto r = decodeAnswer(changed);
            if (!r) continue;
            for (const ImportedBody& body : r->bodies) {
                REQUIRE(body.mesh.body.vertices.allFinite());
                REQUIRE(body.mesh.body.triangles.minCoeff() >= 0);
                REQUIRE(body.mesh.body.triangles.maxCoeff() < body.mesh.body.vertices.rows());
            }
        }
}

TEST_CASE("write-mesh: bad values and places are refused, and what was there stays") {
    const TestFolder folder;
    const TriangleMesh ball = shapes::sphere(1.0, 1).mesh;
    const auto path = folder.write("a.obj", "old");
    Points bad = ball.vertices;
    bad(3, 1) = std::numeric_limits<double>::quiet_NaN();
    CHECK(writeMesh(path, bad, ball.triangles).error().code == "bad-value");
    Triangles wrong = ball.triangles;
    wrong(0, 0) = 100000;
    CHECK(writeMesh(path, ball.vertices, wrong).error().code == "bad-index");
    CHECK(writeMesh(folder.path() / "a.xyz", ball.vertices, ball.triangles).error().code == "unknown-format");
    CHECK(writeMesh(folder.path() / "none" / "a.obj", ball.vertices, ball.triangles).error().code == "not-writable");
    CHECK(std::filesystem::file_size(path) == 3);
    CHECK(writeMesh(path, ball.vertices, ball.triangles));
    CHECK(std::filesystem::file_size(path) > 100);
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) files += entry.is_regular_file();
    CHECK(files == 1);  // nothing is left beside it
}
