// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/image.h"

#include <turbojpeg.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/render/picture.h"
#include "tests/render/test_bodies.h"
#include "ui/render/decoded_textures.h"

using namespace imomushi;
using namespace imomushi::render;

namespace {

std::vector<std::uint8_t> pngBytes(const std::vector<std::uint8_t>& rgba, int width, int height) {
    const auto path = std::filesystem::temp_directory_path() / "imomushi-test-絵.png";
    const std::u8string name = path.u8string();
    REQUIRE(writePng(std::string(name.begin(), name.end()), rgba, width, height));
    std::ifstream in(path, std::ios::binary);
    std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(in), {}};
    in.close();
    std::filesystem::remove(path);
    return bytes;
}

std::vector<std::uint8_t> jpegBytes(const std::vector<std::uint8_t>& rgba, int width, int height) {
    const tjhandle encoder = tjInitCompress();
    unsigned char* out = nullptr;
    unsigned long size = 0;
    REQUIRE(tjCompress2(encoder, rgba.data(), width, 0, height, TJPF_RGBA, &out, &size, TJSAMP_444, 95, 0) == 0);
    std::vector<std::uint8_t> bytes(out, out + size);
    tjFree(out);
    tjDestroy(encoder);
    return bytes;
}

std::vector<std::uint8_t> oneColor(int width, int height, int r, int g, int b) {
    std::vector<std::uint8_t> rgba;
    for (int i = 0; i < width * height; ++i)
        for (const int v : {r, g, b, 255}) rgba.push_back(static_cast<std::uint8_t>(v));
    return rgba;
}

}  // namespace

TEST_CASE("a PNG that was written is read back byte for byte, a JPEG nearly") {
    std::vector<std::uint8_t> rgba;
    for (int i = 0; i < 7 * 5 * 4; ++i) rgba.push_back(static_cast<std::uint8_t>(i * 37));
    const auto png = decodeImage(pngBytes(rgba, 7, 5));
    REQUIRE(png.has_value());
    CHECK(png->width == 7);
    CHECK(png->height == 5);
    CHECK(png->rgba == rgba);
    const auto jpeg = decodeImage(jpegBytes(oneColor(16, 8, 200, 40, 90), 16, 8));
    REQUIRE(jpeg.has_value());
    CHECK(jpeg->width == 16);
    CHECK(std::abs(jpeg->rgba[0] - 200) < 5);
    CHECK(std::abs(jpeg->rgba[1] - 40) < 5);
    CHECK(jpeg->rgba[3] == 255);
}

TEST_CASE("pictures that are cut short, of another kind or empty are refused") {
    auto png = pngBytes(oneColor(20, 20, 1, 2, 3), 20, 20);
    auto jpeg = jpegBytes(oneColor(20, 20, 1, 2, 3), 20, 20);
    for (auto* bytes : {&png, &jpeg})
        for (const std::size_t keep : {std::size_t(12), bytes->size() / 3}) {
            auto part = *bytes;
            part.resize(keep);
            const auto image = decodeImage(part);
            // A JPEG whose end is missing may still be shown in part; what is read has its full size.
            if (image) CHECK(image->rgba.size() == 20 * 20 * 4);
            else CHECK(image.error().code == "bad-image");
        }
    CHECK(decodeImage({}).error().code == "bad-image");
    CHECK(decodeImage({'G', 'I', 'F', '8', '9', 'a', 0, 0, 0, 0}).error().code == "bad-image");
}

TEST_CASE("a picture cannot be written where there is no folder") {
    const auto written = writePng("/no/such/folder/a.png", oneColor(1, 1, 0, 0, 0), 1, 1);
    REQUIRE(!written);
    CHECK(written.error().code == "not-writable");
}

TEST_CASE("textures are decoded once beforehand, for whoever draws them first; later ones decode them again, and one that is damaged is none") {
    auto mesh = std::make_shared<ElementMesh>();
    mesh->renderMesh.textures.push_back({"purple", "image/png", pngBytes(oneColor(4, 2, 180, 20, 180), 4, 2)});
    mesh->renderMesh.textures.push_back({"damaged", "image/png", {1, 2, 3}});
    decodeTextures(mesh);
    decodeTextures(mesh);
    for (int time = 0; time < 2; ++time) {
        const DecodedTextures taken = takeTextures(mesh);
        REQUIRE(taken.size() == 2);
        REQUIRE(taken[0]);
        CHECK(taken[0]->width == 4);
        CHECK(taken[0]->height == 2);
        CHECK(taken[0]->rgba[0] == 180);
        CHECK(!taken[1]);
    }
    // Another mesh may lie where one was.
    for (int k = 0; k < 50; ++k) {
        auto other = std::make_shared<ElementMesh>();
        for (int n = 0; n < 1 + k % 2; ++n) other->renderMesh.textures.push_back({"t", "image/png", pngBytes(oneColor(2, 2, 9, 9, k), 2, 2)});
        decodeTextures(other);
        if (k % 3 == 0) continue;
        const DecodedTextures taken = takeTextures(other);
        REQUIRE(taken.size() == other->renderMesh.textures.size());
        CHECK(taken.back()->rgba[2] == k);
    }
}

TEST_CASE("textures, vertex colours and materials colour a body") {
    TestBody body = blob(Vec3::Zero(), Vec3::Ones());
    Scene scene;
    scene.camera.eye = Vec3(0, 0, 5);
    scene.bodies.push_back(body.body(1, Eigen::Vector3f(0.6f, 0.6f, 0.6f)));
    const auto middle = [&] { return drawn(scene, 100, 100).at(50, 50); };

    RenderMesh& surface = body.mesh->renderMesh;
    surface.triangles = body.mesh->body.triangles;
    const int vertices = static_cast<int>(body.mesh->body.vertices.rows());
    for (int v = 0; v < vertices; ++v) surface.bodyVertex.push_back(v);
    surface.colors.resize(vertices, 4);
    surface.colors.rowwise() = Eigen::RowVector4f(0.02f, 0.02f, 0.7f, 1.0f);
    auto p = middle();
    CHECK(p[2] > 2 * p[0]);

    surface.colors.resize(0, 4);
    surface.materials.resize(1);
    surface.materials[0].baseColor = Eigen::Vector4f(0.02f, 0.6f, 0.02f, 1.0f);
    surface.material.assign(static_cast<std::size_t>(surface.triangles.rows()), 0);
    p = middle();
    CHECK(p[1] > 2 * p[0]);

    surface.materials[0].baseColor = Eigen::Vector4f::Ones();
    surface.materials[0].baseColorTexture = 0;
    surface.textures.push_back({"purple", "image/png", pngBytes(oneColor(4, 4, 180, 20, 180), 4, 4)});
    surface.texCoords.resize(vertices, 2);
    surface.texCoords.setConstant(0.5f);
    p = middle();
    CHECK(p[0] > 2 * p[1]);
    CHECK(p[2] > 2 * p[1]);

    // A damaged texture leaves the colour of the material.
    surface.textures[0].bytes.resize(20);
    surface.materials[0].baseColor = Eigen::Vector4f(0.02f, 0.6f, 0.02f, 1.0f);
    p = middle();
    CHECK(p[1] > 2 * p[0]);
}
