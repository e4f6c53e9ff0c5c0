// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "core/io/reader_support.h"
#include "core/mesh/write_mesh.h"
#include "tests/io/raw_scene.h"
#include "tests/support/shapes.h"

using namespace imomushi;
using namespace io_test;

namespace {

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

const char* const kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

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
    const RenderMesh& render = body.mesh.renderMesh;
    CHECK(render.bodyVertex.size() > 8);
    CHECK(render.texCoords.rows() == static_cast<Eigen::Index>(render.bodyVertex.size()));
    const int corner = render.triangles(0, 2);
    CHECK(render.texCoords(corner, 0) == 0.25f);
    CHECK(render.texCoords(corner, 1) == 0.25f);  // origin top left
    CHECK(render.normals(corner, 2) == 1.0f);
    CHECK(render.colors(corner, 0) == 1.0f);
    CHECK(render.colors(corner, 1) == doctest::Approx(0.2140f).epsilon(1e-3));  // sRGB 0.5
    REQUIRE(render.materials.size() == 3);
    CHECK(render.materials[0].name == "skin");
    REQUIRE(render.materials[0].baseColorTexture == 0);
    CHECK(render.textures[0].mimeType == "image/png");
    CHECK(render.textures[0].bytes.size() == 15);
    CHECK(render.materials[1].baseColor == Eigen::Vector4f(1, 0, 0, 0.5f));
    CHECK(render.material[0] == 0);
    CHECK(render.material[6] == 1);
    CHECK(render.materials[2].baseColorTexture == -1);
    CHECK(render.textures.size() == 1);  // nothing from outside of the folder
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
        if (r->surface.mesh.renderMesh.colors.rows() > 0) {
            CHECK(r->surface.mesh.renderMesh.colors(0, 0) == 1.0f);
            CHECK(r->surface.mesh.renderMesh.colors(0, 1) == doctest::Approx(0.2159f).epsilon(1e-3));
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

TEST_CASE("messages: an answer comes over as it was, and cut or changed anywhere it is refused or sound") {
    const TestFolder folder;
    folder.write("t.png", std::string("\x89PNG\r\n\x1a\n") + "x");
    folder.write("a.mtl", "newmtl m\nmap_Kd t.png\n");
    std::string obj = "mtllib a.mtl\nusemtl m\n" + io_test::objOf(shapes::box({0, 0, 0}, {1, 1, 1}, 1, 1, 1).mesh);
    obj += "v 5 5 5\n";
    const auto answer = io_test::import(folder.write("a.obj", obj));
    REQUIRE(answer);
    const std::string bytes = messageOf(answer);
    const auto again = inMessage<ImportResult>(bytes);
    REQUIRE(again);
    CHECK(messageOf(again) == bytes);
    for (std::size_t n = 0; n < bytes.size(); ++n) REQUIRE(!inMessage<ImportResult>(std::string_view(bytes).substr(0, n)));
    for (std::size_t n = 0; n < bytes.size(); ++n)
        for (const char c : {'\x00', '\x7f', '\xff'}) {
            std::string changed = bytes;
            changed[n] = c;
            const auto r = inMessage<ImportResult>(changed);
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
