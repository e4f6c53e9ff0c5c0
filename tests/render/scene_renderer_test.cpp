// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/scene_renderer.h"

#include <epoxy/gl.h>
#include <fenv.h>

#include <cmath>
#include <numbers>

#include "tests/render/picture.h"
#include "tests/render/test_bodies.h"
#include "ui/render/offscreen.h"

using namespace imomushi;
using namespace imomushi::render;

namespace {

const Eigen::Vector3f kRed(0.75f, 0.03f, 0.03f);

/// A unit sphere at the origin, seen from +z; the ground well below it.
struct SphereScene {
    TestBody sphere = blob(Vec3::Zero(), Vec3::Ones());
    Scene scene;
    SphereScene() {
        scene.camera.eye = Vec3(0, 0, 5);
        scene.camera.target = Vec3::Zero();
        scene.ground = -1.0;
        scene.bodies.push_back(sphere.body(7, kRed));
    }
};

/// A renderer on a context that is current here.
struct Live {
    Result<std::unique_ptr<OffscreenContext>> context = OffscreenContext::create();
    std::unique_ptr<SceneRenderer> renderer;
    Live() {
        REQUIRE(context.has_value());
        auto made = SceneRenderer::create();
        REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
        renderer = std::move(*made);
    }
    ~Live() { renderer.reset(); }
};

/// The same with a picture of 128 x 128 pixels to draw into.
struct LiveTarget : Live {
    GLuint texture = 0, target = 0;
    LiveTarget() {
        glGenTextures(1, &texture);
        glBindTexture(GL_TEXTURE_2D, texture);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 128, 128, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
        glGenFramebuffers(1, &target);
        glBindFramebuffer(GL_FRAMEBUFFER, target);
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    }
    ~LiveTarget() {
        glDeleteFramebuffers(1, &target);
        glDeleteTextures(1, &texture);
    }
    Picture draw(const Scene& scene) {
        renderer->draw(scene, target, 128, 128);
        Picture p{128, 128, std::vector<std::uint8_t>(128 * 128 * 4)};
        glReadPixels(0, 0, 128, 128, GL_RGBA, GL_UNSIGNED_BYTE, p.rgba.data());
        CHECK(glGetError() == GL_NO_ERROR);
        return p;
    }
};

}  // namespace

TEST_CASE("an empty scene is a background that is neither black nor of one colour, and light in the light theme") {
    Scene scene;
    for (const bool grid : {true, false}) {
        scene.grid = grid;
        scene.darkTheme = true;
        const Picture dark = drawn(scene, 120, 80);
        scene.darkTheme = false;
        const Picture light = drawn(scene, 120, 80);
        int lowest = 255, highest = 0;
        for (int y = 0; y < 80; ++y)
            for (int x = 0; x < 120; ++x) {
                lowest = std::min(lowest, dark.grey(x, y));
                highest = std::max(highest, dark.grey(x, y));
                CHECK(dark.at(x, y)[3] == 255);
                CHECK(light.grey(x, y) > dark.grey(x, y));
            }
        CHECK(lowest > 10);
        CHECK(highest > lowest + 5);
        CHECK(light.grey(60, 20) > 180);
    }
}

TEST_CASE("a red sphere is red in the middle, brighter towards the light, and leaves the corners alone") {
    SphereScene s;
    const Picture picture = drawn(s.scene, 200, 200);
    const auto middle = picture.at(100, 100);
    CHECK(middle[0] > 120);
    CHECK(middle[0] > 3 * middle[1]);
    CHECK(middle[0] > 3 * middle[2]);
    CHECK(picture.grey(80, 70) > picture.grey(120, 135));
    const auto corner = picture.at(3, 3);
    CHECK(std::abs(corner[0] - corner[1]) < 20);
}

TEST_CASE("two draws of one scene are the same bytes") {
    SphereScene s;
    s.scene.bodies[0].selected = true;
    Marker bone;
    bone.shape = Marker::Shape::Bone;
    bone.from = Vec3(-1, 0, 0);
    bone.to = Vec3(1, 0.5, 0);
    s.scene.markers.push_back(bone);
    CHECK(drawn(s.scene, 320, 200).rgba == drawn(s.scene, 320, 200).rgba);
}

TEST_CASE("a transparent picture has no background, and opaque straight colours where a body is") {
    SphereScene s;
    s.scene.transparentBackground = true;
    s.scene.grid = false;
    s.scene.groundShadow = false;
    const Picture clear = drawn(s.scene, 200, 200);
    CHECK(clear.at(2, 2) == std::array<int, 4>{0, 0, 0, 0});
    CHECK(clear.at(100, 100)[3] == 255);
    s.scene.transparentBackground = false;
    const Picture opaque = drawn(s.scene, 200, 200);
    for (int c = 0; c < 3; ++c) CHECK(std::abs(clear.at(100, 100)[c] - opaque.at(100, 100)[c]) <= 1);
    // Edges are smooth: some pixels are partly covered, and none of them is darker than the sphere's shade would be.
    int partly = 0;
    for (int y = 0; y < 200; ++y)
        for (int x = 0; x < 200; ++x) {
            const auto p = clear.at(x, y);
            if (p[3] < 20 || p[3] > 235) continue;
            ++partly;
            CHECK(p[0] > p[1]);
        }
    CHECK(partly > 100);
}

TEST_CASE("a pixel that a body covers in part shows the mean of the display values, by how much is covered: edges without stairs") {
    SphereScene s;
    s.scene.grid = false;
    s.scene.groundShadow = false;
    const Picture whole = drawn(s.scene, 200, 200);
    s.scene.transparentBackground = true;
    const Picture alone = drawn(s.scene, 200, 200);
    s.scene.transparentBackground = false;
    s.scene.bodies.clear();
    const Picture background = drawn(s.scene, 200, 200);
    int partly = 0;
    for (int y = 0; y < 200; ++y)
        for (int x = 0; x < 200; ++x) {
            const double covered = alone.at(x, y)[3] / 255.0;
            if (covered < 0.1 || covered > 0.9) continue;
            ++partly;
            // Noise of half a step, and rounding of four values.
            for (int c = 0; c < 3; ++c) CHECK(std::abs(whole.at(x, y)[c] - (covered * alone.at(x, y)[c] + (1.0 - covered) * background.at(x, y)[c])) <= 3.0);
        }
    CHECK(partly > 100);
}

TEST_CASE("selecting a body draws a line around it and nothing inside or far away") {
    SphereScene s;
    const Picture plain = drawn(s.scene, 240, 240);
    s.scene.bodies[0].selected = true;
    const Picture selected = drawn(s.scene, 240, 240);
    // The silhouette of a unit sphere 5 m away, in pixels.
    const double radius = 120.0 * std::tan(std::asin(1.0 / 5.0)) / std::tan(0.3);
    int around = 0, elsewhere = 0;
    for (int y = 0; y < 240; ++y)
        for (int x = 0; x < 240; ++x) {
            const bool differs = std::abs(plain.at(x, y)[0] - selected.at(x, y)[0]) > 8 || std::abs(plain.at(x, y)[1] - selected.at(x, y)[1]) > 8;
            const double r = std::hypot(x + 0.5 - 120.0, y + 0.5 - 120.0);
            if (differs) ++(r > radius - 2.5 && r < radius + 4.0 ? around : elsewhere);
        }
    CHECK(around > radius * 2.0 * std::numbers::pi);
    CHECK(elsewhere == 0);
}

TEST_CASE("hovered, out of date, highlighted and x-ray bodies all look different from plain ones") {
    SphereScene s;
    const Picture plain = drawn(s.scene, 160, 160);
    s.scene.bodies[0].hovered = true;
    CHECK(differing(plain, drawn(s.scene, 160, 160)) > 100);
    s.scene.bodies[0].hovered = false;
    s.scene.bodies[0].outdated = true;
    CHECK(differing(plain, drawn(s.scene, 160, 160)) > 1000);
    s.scene.bodies[0].outdated = false;
    std::vector<std::int32_t> highlighted;
    for (int f = 0; f < 800; ++f) highlighted.push_back(f);
    s.scene.bodies[0].highlightedTriangles = &highlighted;
    CHECK(differing(plain, drawn(s.scene, 160, 160)) > 300);
    s.scene.bodies[0].highlightedTriangles = nullptr;
    s.scene.bodies[0].opacity = 0.3f;
    s.scene.darkTheme = true;
    CHECK(drawn(s.scene, 160, 160).at(80, 80)[0] < plain.at(80, 80)[0]);
}

TEST_CASE("a ball over the ground darkens it, with and without the grid") {
    SphereScene s;
    s.scene.camera.eye = Vec3(0, 4, 5);
    for (const bool grid : {true, false}) {
        s.scene.grid = grid;
        s.scene.groundShadow = false;
        const Picture without = drawn(s.scene, 200, 200);
        s.scene.groundShadow = true;
        const Picture with = drawn(s.scene, 200, 200);
        int darker = 0, brighter = 0;
        for (int y = 0; y < 200; ++y)
            for (int x = 0; x < 200; ++x) {
                // The body itself is a little darker near the ground; it is red.
                if (without.at(x, y)[0] > 2 * without.at(x, y)[1]) continue;
                darker += with.grey(x, y) < without.grey(x, y) - 6;
                brighter += with.grey(x, y) > without.grey(x, y) + 6;
            }
        CHECK(darker > 300);
        CHECK(brighter == 0);
    }
}

TEST_CASE("joint, held and pinned points differ by shape: also in a picture without colour") {
    Scene scene;
    scene.grid = scene.groundShadow = false;
    scene.camera.eye = Vec3(0, 0, 5);
    Marker point;
    point.from = point.to = Vec3::Zero();
    std::vector<Picture> pictures;
    for (const auto shape : {Marker::Shape::JointPoint, Marker::Shape::HeldPoint, Marker::Shape::PinnedPoint}) {
        point.shape = shape;
        scene.markers = {point};
        pictures.push_back(drawn(scene, 64, 64));
    }
    // Bright and dark, as shapes only.
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < i; ++j) {
            int differ = 0;
            for (int y = 0; y < 64; ++y)
                for (int x = 0; x < 64; ++x) differ += (pictures[i].grey(x, y) > 90) != (pictures[j].grey(x, y) > 90);
            CHECK(differ > 20);
        }
}

TEST_CASE("a point keeps its size in logical pixels: twice as large on a display of twice the density, and at any distance") {
    Scene scene;
    scene.grid = scene.groundShadow = false;
    scene.transparentBackground = true;
    Marker point;
    point.shape = Marker::Shape::PinnedPoint;
    scene.markers = {point};
    const auto covered = [&](int size) {
        const Picture p = drawn(scene, size, size);
        int n = 0;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) n += p.at(x, y)[3] > 127;
        return n;
    };
    scene.camera.eye = Vec3(0, 0, 5);
    const int once = covered(64);
    scene.camera.eye = Vec3(0, 0, 50);
    CHECK(covered(64) == doctest::Approx(once).epsilon(0.02));
    scene.pixelRatio = 2.0f;
    CHECK(covered(128) == doctest::Approx(4 * once).epsilon(0.15));
}

TEST_CASE("bones inside a body show through it, dimmer than in front of it") {
    SphereScene s;
    const Picture plain = drawn(s.scene, 200, 200);
    Marker bone;
    bone.shape = Marker::Shape::Bone;
    bone.from = Vec3(-0.8, 0, 0);
    bone.to = Vec3(0.8, 0, 0);
    s.scene.markers = {bone};
    const Picture inside = drawn(s.scene, 200, 200);
    s.scene.markers[0].from.z() = s.scene.markers[0].to.z() = 1.5;
    const Picture before = drawn(s.scene, 200, 200);
    const auto change = [&](const Picture& p) { return std::abs(p.at(80, 100)[1] - plain.at(80, 100)[1]); };
    CHECK(change(inside) > 30);
    CHECK(change(before) > change(inside) + 10);
}

TEST_CASE("pick answers the body, its triangle and the point under the pointer, and nothing beside it") {
    SphereScene s;
    const TestBody second = blob(Vec3(2.5, 0, 0), Vec3(0.5, 0.5, 0.5));
    s.scene.bodies.push_back(second.body(9, kRed));
    Live live;
    int found = 0;
    for (const int x : {130, 150, 170, 199, 230})
        for (const int y : {80, 150, 200}) {
            const auto pick = live.renderer->pick(s.scene, 400, 300, x, y);
            if (pick.id == 0) continue;
            ++found;
            CHECK(pick.id == 7);
            CHECK(!pick.marker);
            REQUIRE(pick.triangle >= 0);
            // The point lies in the plane of that triangle, between its corners, and projects to the pixel.
            const auto& body = s.sphere.mesh->body;
            const Vec3 a = body.vertices.row(body.triangles(pick.triangle, 0)), b = body.vertices.row(body.triangles(pick.triangle, 1)),
                       c = body.vertices.row(body.triangles(pick.triangle, 2));
            const double whole = (b - a).cross(c - a).norm();
            const double parts = (a - pick.point).cross(b - pick.point).norm() + (b - pick.point).cross(c - pick.point).norm() +
                                 (c - pick.point).cross(a - pick.point).norm();
            CHECK(parts == doctest::Approx(whole).epsilon(0.02));
            CHECK(pick.point.z() > 0.0);
            const double pixels = 150.0 / std::tan(0.3);
            CHECK(pick.point.x() / (5.0 - pick.point.z()) * pixels + 200.0 == doctest::Approx(x + 0.5).epsilon(1e-4));
            CHECK(150.0 - pick.point.y() / (5.0 - pick.point.z()) * pixels == doctest::Approx(y + 0.5).epsilon(1e-4));
        }
    CHECK(found > 8);
    CHECK(live.renderer->pick(s.scene, 400, 300, 5, 5).id == 0);
    CHECK(live.renderer->pick(s.scene, 400, 300, -1, 5).id == 0);
    CHECK(live.renderer->pick(s.scene, 400, 300, 400, 299).id == 0);
    // 2.5 m to the right.
    CHECK(live.renderer->pick(s.scene, 800, 300, 400 + int(2.5 / 5.0 * 150.0 / std::tan(0.3)), 150).id == 9);
    s.scene.bodies[0].pickable = false;
    CHECK(live.renderer->pick(s.scene, 400, 300, 200, 150).id == 0);
    s.scene.camera.orthographic = true;
    s.scene.bodies[0].pickable = true;
    const auto flat = live.renderer->pick(s.scene, 400, 400, 250, 200);
    CHECK(flat.id == 7);
    CHECK(flat.point.x() == doctest::Approx(50.5 / 100.0).epsilon(1e-3));
}

TEST_CASE("markers win over bodies within a few pixels, points over bones, and hidden outlines do not") {
    SphereScene s;
    Marker bone, point, outline;
    bone.shape = Marker::Shape::Bone;
    bone.id = 100;
    bone.from = Vec3(-0.8, 0, 0);
    bone.to = Vec3(0.8, 0, 0);
    point.shape = Marker::Shape::JointPoint;
    point.id = 101;
    point.from = bone.to;
    outline.shape = Marker::Shape::FaceOutline;
    outline.id = 102;
    for (const double sign : {-1.0, 1.0}) outline.outline.push_back(Vec3(sign * 0.3, 0.6, -0.85));
    outline.outline.push_back(Vec3(0, 0.5, -0.9));
    s.scene.markers = {bone, point, outline};
    Live live;
    const auto at = [&](double x, double y, double z) {
        const double pixels = 200.0 / std::tan(0.3) / (5.0 - z);
        return live.renderer->pick(s.scene, 400, 400, int(200.0 + x * pixels), int(200.0 - y * pixels));
    };
    CHECK(at(0.0, 0.0, 0.0).id == 100);
    CHECK(at(0.0, 0.0, 0.0).marker);
    CHECK(at(0.0, 0.0, 0.0).point.norm() < 0.02);
    CHECK(at(0.8, 0.0, 0.0).id == 101);
    CHECK(at(0.82, 0.02, 0.0).id == 101);
    CHECK(at(0.0, 0.6, 0.0).id == 7);   // the outline is on the far side
    CHECK(at(0.0, -0.5, 0.0).id == 7);
    s.scene.bodies.clear();
    CHECK(at(0.0, 0.6, -0.85).id == 102);
}

TEST_CASE("edges are smooth whatever another painter left of the driver's state") {
    SphereScene s;
    LiveTarget live;
    const Picture first = live.draw(s.scene);
    // As Qt's painter leaves it where it draws without smooth edges.
    glDisable(GL_MULTISAMPLE);
    glEnable(GL_STENCIL_TEST);
    glEnable(GL_SCISSOR_TEST);
    CHECK(live.draw(s.scene).rgba == first.rgba);
}

TEST_CASE("a new revision is drawn, an unchanged one is not read again") {
    SphereScene s;
    LiveTarget live;
    const auto draw = [&] { return live.draw(s.scene); };
    const Picture first = draw();
    for (std::size_t i = 0; i < s.sphere.positions.size(); i += 3) s.sphere.positions[i] *= 0.5f;
    CHECK(draw().rgba == first.rgba);
    ++s.scene.bodies[0].revision;
    const Picture thin = draw();
    CHECK(differing(first, thin) > 300);
    // Back again: nothing is left over from what was drawn in between.
    for (std::size_t i = 0; i < s.sphere.positions.size(); i += 3) s.sphere.positions[i] *= 2.0f;
    ++s.scene.bodies[0].revision;
    CHECK(draw().rgba == first.rgba);
}

TEST_CASE("sizes from one pixel to beyond a screen are drawn, larger ones than promised are refused") {
    SphereScene s;
    for (const auto& [w, h] : {std::pair{1, 1}, std::pair{3, 700}, std::pair{2600, 1400}}) CHECK(drawn(s.scene, w, h).rgba.size() == std::size_t(w) * h * 4);
    for (const auto& [w, h] : {std::pair{0, 5}, std::pair{5, -1}, std::pair{kLargestSide + 1, 1}, std::pair{kLargestSide, kLargestSide}}) {
        const auto refused = drawOffscreen(s.scene, w, h);
        REQUIRE(!refused);
        CHECK(refused.error().code == "bad-size");
    }
}

TEST_CASE("scenes of the size of a grain and of a mountain are drawn alike") {
    const auto picture = [](double scale) {
        const TestBody ball = blob(Vec3::Zero(), Vec3::Constant(scale));
        Scene scene;
        scene.grid = false;
        scene.ground = -scale;
        scene.camera.eye = Vec3(0, 2, 5) * scale;
        scene.bodies.push_back(ball.body(1, kRed));
        return drawn(scene, 160, 160);
    };
    const Picture one = picture(1.0);
    // Only rounding in the shadow map may differ.
    CHECK(differing(one, picture(1e-4), 12) < 200);
    CHECK(differing(one, picture(1e4), 12) < 200);
}

TEST_CASE("while an offscreen context lives its thread has no floating-point traps, afterwards they are as before") {
    const int before = fegetexcept();
    {
        Live live;
        CHECK(fegetexcept() == 0);
    }
    CHECK(fegetexcept() == before);
    CHECK(before != 0);
}

TEST_CASE("the camera: the target is in the middle of the picture, right is right and up is up") {
    Camera camera;
    camera.eye = Vec3(3, 2, 1);
    camera.target = Vec3(0.5, 0.25, -1);
    for (const bool flat : {false, true}) {
        camera.orthographic = flat;
        const Eigen::Matrix4d m = camera.projection(1.5, camera.target, 2.0) * camera.view();
        const auto project = [&](const Vec3& p) {
            const Eigen::Vector4d c = m * p.homogeneous();
            return Vec3(c.head<3>() / c.w());
        };
        CHECK(project(camera.target).head<2>().norm() < 1e-12);
        CHECK(project(camera.target + Vec3(0, 0.1, 0)).y() > 0.0);
        const Vec3 right = (camera.target - camera.eye).cross(Vec3::UnitY()).normalized();
        CHECK(project(camera.target + 0.1 * right).x() > 0.0);
        // All of the sphere lies between the near and the far plane.
        const Vec3 forward = (camera.target - camera.eye).normalized();
        CHECK(std::abs(project(camera.target + 1.9 * forward).z()) < 1.0);
        CHECK(std::abs(project(camera.target - 1.9 * forward).z()) < 1.0);
    }
    // Straight down is a view like others.
    camera.eye = camera.target + Vec3(0, 3, 0);
    CHECK(camera.view().allFinite());
    CHECK(camera.view().determinant() == doctest::Approx(1.0));
}
