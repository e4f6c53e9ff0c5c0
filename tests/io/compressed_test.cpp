// SPDX-License-Identifier: GPL-3.0-or-later
// glTF files compressed by Draco or meshoptimizer, and quantised ones: what the plain file gives, to the quantisation.
#include <doctest/doctest.h>
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>

#include "tests/io/glb.h"
#include "tests/io/raw_scene.h"
#include "tests/support/farthest.h"
#include "tests/support/shapes.h"
#include "tests/support/thorough.h"

using namespace imomushi;
using namespace io_test;
namespace fs = std::filesystem;

namespace {

std::string dracoOf(const TriangleMesh& mesh) {
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(static_cast<int>(mesh.triangles.rows()));
    const int positions = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
        std::array<std::array<float, 3>, 3> x{};
        for (int k = 0; k < 3; ++k)
            for (int c = 0; c < 3; ++c) x[k][c] = static_cast<float>(mesh.vertices(mesh.triangles(f, k), c));
        builder.SetAttributeValuesForFace(positions, draco::FaceIndex(static_cast<std::uint32_t>(f)), x[0].data(), x[1].data(), x[2].data());
    }
    const auto made = builder.Finalize();
    draco::Encoder encoder;
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 11);
    draco::EncoderBuffer buffer;
    REQUIRE(encoder.EncodeMeshToBuffer(*made, &buffer).ok());
    return {buffer.data(), buffer.size()};
}

/// A ball of which only Draco's data are there, or plain data too.
Glb dracoBall(const TriangleMesh& ball, bool plainToo) {
    Glb glb;
    const std::string packed = dracoOf(ball);
    std::vector<float> positions(ball.vertices.data(), ball.vertices.data() + ball.vertices.size());
    std::vector<std::uint16_t> corners(ball.triangles.data(), ball.triangles.data() + ball.triangles.size());
    const int p = glb.floats(positions, "VEC3", 3), i = glb.indices(corners), d = glb.bytes({packed.begin(), packed.end()}, "SCALAR", 1);
    if (!plainToo)
        for (const int a : {p, i}) glb.json["accessors"][static_cast<std::size_t>(a)].erase("bufferView");
    const auto view = glb.json["accessors"][static_cast<std::size_t>(d)]["bufferView"];
    glb.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", p}}}, {"indices", i}, {"extensions", {{"KHR_draco_mesh_compression", {{"bufferView", view}, {"attributes", {{"POSITION", 0}}}}}}}}}}}};
    glb.json["nodes"] = {{{"mesh", 0}}};
    glb.json["scenes"] = {{{"nodes", {0}}}};
    glb.json["extensionsUsed"] = {"KHR_draco_mesh_compression"};
    if (!plainToo) glb.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    return glb;
}

/// A ball whose buffer views are compressed by meshoptimizer. `change`: to its JSON.
std::string meshoptBall(const TriangleMesh& ball, const std::string& extension, const std::function<void(nlohmann::json&, std::vector<std::uint8_t>&)>& change = {}) {
    Glb glb;
    const std::vector<float> positions(ball.vertices.data(), ball.vertices.data() + ball.vertices.size());
    const std::vector<std::uint32_t> corners(ball.triangles.data(), ball.triangles.data() + ball.triangles.size());
    const auto vertices = static_cast<std::size_t>(ball.vertices.rows());
    std::vector<std::uint8_t> packed(meshopt_encodeVertexBufferBound(vertices, 12)), faces(meshopt_encodeIndexBufferBound(corners.size(), vertices));
    packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), positions.data(), vertices, 12));
    faces.resize(meshopt_encodeIndexBuffer(faces.data(), faces.size(), corners.data(), corners.size()));
    const auto compressed = [&](std::size_t length, std::size_t count, std::size_t stride, const char* mode) {
        return nlohmann::json{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", length}, {"byteStride", stride}, {"count", count}, {"mode", mode}};
    };
    nlohmann::json how = {compressed(packed.size(), vertices, 12, "ATTRIBUTES"), compressed(faces.size(), corners.size(), 2, "TRIANGLES")};
    if (change) change(how[0], packed);
    const int p = glb.bytes(packed, "SCALAR", 1), i = glb.bytes(faces, "SCALAR", 1);
    auto& views = glb.json["bufferViews"];
    for (const int k : {p, i}) {
        auto& view = views[static_cast<std::size_t>(k)];
        how[static_cast<std::size_t>(k)]["byteOffset"] = view["byteOffset"];
        view = {{"buffer", 0}, {"byteLength", k == p ? 12 * vertices : 2 * corners.size()}, {"extensions", {{extension, how[static_cast<std::size_t>(k)]}}}};
    }
    glb.json["accessors"] = {{{"bufferView", p}, {"componentType", 5126}, {"count", vertices}, {"type", "VEC3"}}, {{"bufferView", i}, {"componentType", 5123}, {"count", corners.size()}, {"type", "SCALAR"}}};
    glb.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}};
    glb.json["nodes"] = {{{"mesh", 0}}};
    glb.json["scenes"] = {{{"nodes", {0}}}};
    glb.json["extensionsRequired"] = {extension};
    return glb.file();
}

}  // namespace

TEST_CASE("Draco: data that come alone are decompressed; where plain data are there too, these count") {
    const TriangleMesh ball = shapes::sphere(1.0, 2).mesh;
    const Points exact = ball.vertices.cast<float>().cast<double>();
    const auto alone = scene("a.glb", dracoBall(ball, false).file()), both = scene("a.glb", dracoBall(ball, true).file());
    REQUIRE(alone);
    REQUIRE(both);
    CHECK(both->surface.mesh.body.vertices == exact);
    CHECK(both->surface.mesh.body.triangles == ball.triangles);
    CHECK(alone->surface.mesh.body.vertices.rows() == exact.rows());
    CHECK(alone->surface.mesh.body.triangles.rows() == ball.triangles.rows());
    const double within = 0.5 * std::sqrt(3.0) * 2.0 / 2047.0 + 1e-6;
    CHECK(farthest(alone->surface.mesh.body.vertices, exact) <= within);
    CHECK(farthest(alone->surface.mesh.body.vertices, exact) > 1e-5);  // it was quantised
    // Whoever reads plain data does not need the others to be sound.
    Glb broken = dracoBall(ball, true);
    broken.json["bufferViews"].back()["byteLength"] = 5;
    const auto plain = scene("a.glb", broken.file());
    REQUIRE(plain);
    CHECK(plain->surface.mesh.body.vertices == exact);
    // The lists of attributes may name what the data do not have.
    Glb wrong = dracoBall(ball, false);
    wrong.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] = 7;
    CHECK(code(scene("a.glb", wrong.file())) == "bad-file");
}

TEST_CASE("meshopt: views are decompressed by both names of the extension; a later codec and unknown filters are told by name") {
    const TriangleMesh ball = shapes::sphere(1.0, 2).mesh;
    for (const char* extension : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
        CAPTURE(extension);
        const auto read = scene("a.glb", meshoptBall(ball, extension));
        CAPTURE(said(read));
        REQUIRE(read);
        CHECK(read->surface.mesh.body.vertices == ball.vertices.cast<float>().cast<double>());
        CHECK(read->surface.mesh.body.triangles.rows() == ball.triangles.rows());
        const auto refused = [&](const std::function<void(nlohmann::json&, std::vector<std::uint8_t>&)>& change, const std::string& part) {
            const auto r = scene("a.glb", meshoptBall(ball, extension, change));
            CAPTURE(part);
            CAPTURE(said(r));
            CHECK(code(r) == "bad-file");
            CHECK(said(r).find(part) != std::string::npos);
        };
        refused([](auto&, auto& bytes) { bytes[0] = 0xA1; }, "version 1 of the codec");
        refused([](auto& j, auto&) { j["filter"] = "COLOR"; }, "filter 'COLOR'");
        refused([](auto& j, auto&) { j["mode"] = "MESHLETS"; }, "mode 'MESHLETS'");
        refused([](auto& j, auto&) { j["byteStride"] = 13; }, "impossible stride");
        refused([](auto& j, auto&) { j["count"] = 1 << 20; }, "damaged");
        refused([](auto&, auto& bytes) { bytes.resize(bytes.size() / 2); }, "");
        refused([](auto& j, auto&) { j["filter"] = "QUATERNION"; }, "does not fit");
    }
}

TEST_CASE("compressed files with flipped bytes give a reason or a character") {
    for (const char* name : {"mannequin_draco.glb", "mannequin_meshopt.glb"}) {
        CAPTURE(name);
        const std::string good = readFile(kCharacters / name);
        const TestFolder folder;
        std::mt19937 random(7);
        int refused = 0;
        for (int i = 0; i < repeats(30, 1000); ++i) {
            std::string bad = good;
            for (unsigned flips = 1 + random() % 4; flips-- > 0;) bad[20 + random() % (bad.size() - 20)] ^= static_cast<char>(1 + random() % 255);
            const auto file = characterAt(folder.write("bad.glb", bad));
            CAPTURE(i);
            if (file) continue;
            ++refused;
            
            CHECK_MESSAGE(isReason(file.error()), (file.error().code + ": " + file.error().message));
        }
        CHECK(refused > 0);
    }
}
