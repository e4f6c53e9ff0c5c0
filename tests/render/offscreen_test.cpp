// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/offscreen.h"

#include <algorithm>
#include <new>

#include "tests/render/picture.h"
#include "tests/render/test_bodies.h"
#include "tests/support/failing_new.h"

using namespace imomushi;
using namespace imomushi::render;

namespace {

/// A red and a green ball side by side, before no background.
struct TwoBalls {
    TestBody left = blob(Vec3(-1.2, 0, 0), Vec3::Ones()), right = blob(Vec3(1.2, 0, 0), Vec3::Ones());
    Scene scene;
    TwoBalls() {
        scene.camera.eye = Vec3(0, 0, 8);
        scene.camera.target = Vec3::Zero();
        scene.transparentBackground = true;
        scene.grid = scene.groundShadow = false;
        scene.bodies = {left.body(1, {0.75f, 0.03f, 0.03f}), right.body(2, {0.03f, 0.5f, 0.03f})};
    }
};

}  // namespace

TEST_CASE("offscreen view: pictures that follow each other are those of a view that draws the first time") {
    TwoBalls balls;
    TwoBalls other;
    other.scene.darkTheme = false;
    other.scene.bodies.pop_back();
    OffscreenView view, between;
    for (int frame = 0; frame < 4; ++frame) {
        CAPTURE(frame);
        balls.scene.camera.eye = Vec3(2.0 * frame, 1.0, 8.0);
        if (frame == 2) REQUIRE(between.draw(other.scene, 90, 50).has_value());
        const auto pixels = view.draw(balls.scene, 120, 80);
        REQUIRE(pixels.has_value());
        CHECK(*pixels == drawOffscreen(balls.scene, 120, 80).value());
    }
    CHECK(between.draw(other.scene, 90, 50).value() == drawOffscreen(other.scene, 90, 50).value());
}

TEST_CASE(
    "offscreen view: whichever request for memory fails while a picture is drawn, whoever asked for it is told, and the next picture is "
    "whole") {
    TwoBalls balls;
    OffscreenView view;
    const auto whole = view.draw(balls.scene, 120, 80).value();
    int told = 0;
    for (const auto fails : {FailingNew::Fails::Once, FailingNew::Fails::FromThenOn})
        for (long n = 1;; n += std::max(1L, n / 4)) {
            CAPTURE(n);
            bool failed = false, thrown = false;
            {
                const FailingNew failing(FailingNew::On::OtherThreads, n, fails);
                try {
                    (void)OffscreenView().draw(balls.scene, 120, 80);  // from nothing
                } catch (const std::bad_alloc&) {
                    thrown = true;
                }
                failed = FailingNew::failed();
            }
            CHECK(view.draw(balls.scene, 120, 80).value() == whole);
            told += thrown;
            if (!failed) break;
        }
    CHECK(told > 5);
}

TEST_CASE("an invisible body leaves no trace, and is the same when it is shown again") {
    TwoBalls balls;
    OffscreenView view;
    const auto both = view.draw(balls.scene, 120, 80).value();
    balls.scene.bodies[1].visible = false;
    const auto one = view.draw(balls.scene, 120, 80).value();
    balls.scene.bodies[1].visible = true;
    CHECK(view.draw(balls.scene, 120, 80).value() == both);
    balls.scene.bodies.pop_back();
    CHECK(drawOffscreen(balls.scene, 120, 80).value() == one);
}

TEST_CASE("a two-sided body that is inside out looks like the same body outside out") {
    TwoBalls balls;
    balls.scene.bodies.pop_back();
    const Picture closed = drawn(balls.scene, 120, 80);
    TestBody inverted = balls.left;
    inverted.mesh = std::make_shared<ElementMesh>(*balls.left.mesh);
    inverted.mesh->body.triangles.col(1).swap(inverted.mesh->body.triangles.col(2));
    inverted.settle();
    balls.scene.bodies[0] = inverted.body(1, {0.75f, 0.03f, 0.03f});
    CHECK(differing(closed, drawn(balls.scene, 120, 80)) > 200);
    balls.scene.bodies[0].twoSided = true;
    CHECK(differing(closed, drawn(balls.scene, 120, 80)) < 20);
}

TEST_CASE("data colours stay within a fifth of what a legend shows, wherever light and shadow fall") {
    TestBody ball = blob(Vec3::Zero(), Vec3::Ones());
    const auto n = ball.mesh->body.vertices.rows();
    RenderMesh& surface = ball.mesh->renderMesh;
    surface.triangles = ball.mesh->body.triangles;
    for (Eigen::Index v = 0; v < n; ++v) surface.bodyVertex.push_back(static_cast<std::int32_t>(v));
    // sRGB 145, 201, 98 as linear light.
    surface.colors.resize(n, 4);
    surface.colors.rowwise() = Eigen::RowVector4f(0.283f, 0.584f, 0.122f, 1.0f);
    Scene scene;
    scene.camera.eye = Vec3(0, 0, 5);
    scene.camera.target = Vec3::Zero();
    scene.transparentBackground = true;
    scene.grid = scene.groundShadow = false;
    scene.bodies = {ball.body(1, Eigen::Vector3f::Zero())};
    scene.bodies[0].dataColors = true;
    const Picture picture = drawn(scene, 100, 100);
    int seen = 0;
    for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 100; ++x) {
            const auto p = picture.at(x, y);
            if (p[3] < 255) continue;
            ++seen;
            const int expected[3] = {145, 201, 98};
            for (int c = 0; c < 3; ++c) {
                CHECK(p[c] <= expected[c] + 3);
                CHECK(p[c] >= 0.8 * expected[c] - 3);
            }
        }
    CHECK(seen > 1000);
}
