// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/camera_controller.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

using namespace imomushi;

namespace {

PointerEvent aimed(const CameraController& camera, double x, double y) {
    PointerEvent e;
    e.x = x;
    e.y = y;
    camera.aim(e);
    return e;
}

CameraController camera800() {
    CameraController camera;
    camera.setViewport(800, 600);
    camera.frame({}, false);
    return camera;
}

}  // namespace

TEST_CASE("camera: a point is drawn where the pointer's ray meets it, in both projections") {
    CameraController camera = camera800();
    const Vec3 p(0.3, 0.4, -0.2);
    for (const bool orthographic : {false, true}) {
        camera.setOrthographic(orthographic);
        const auto at = camera.onScreen(p);
        REQUIRE(at);
        const PointerEvent e = aimed(camera, at->x(), at->y());
        const Vec3 d = p - e.rayOrigin;
        CHECK((d - d.dot(e.rayDirection) * e.rayDirection).norm() < 1e-9 * d.norm());
        CHECK(d.dot(e.rayDirection) > 0.0);
        CHECK(e.rayDirection.norm() == doctest::Approx(1.0));
    }
}

TEST_CASE("camera: a pixel is as large as it says") {
    CameraController camera = camera800();
    for (const bool orthographic : {false, true}) {
        camera.setOrthographic(orthographic);
        const Vec3 p = camera.camera().target;
        const PointerEvent e = aimed(camera, 400, 300);
        const auto a = camera.onScreen(p), b = camera.onScreen(p + 10.0 * e.pixelAt(p) * camera.axes().col(0));
        REQUIRE(a);
        REQUIRE(b);
        CHECK(b->x() - a->x() == doctest::Approx(10.0));
        CHECK(b->y() == doctest::Approx(a->y()));
    }
}

TEST_CASE("camera: the six axis views look where they say, with a level horizon") {
    CameraController camera = camera800();
    const std::vector<std::pair<ViewAxis, Vec3>> views = {{ViewAxis::Front, -Vec3::UnitZ()}, {ViewAxis::Back, Vec3::UnitZ()},
                                                          {ViewAxis::Right, -Vec3::UnitX()}, {ViewAxis::Left, Vec3::UnitX()},
                                                          {ViewAxis::Top, -Vec3::UnitY()},   {ViewAxis::Bottom, Vec3::UnitY()}};
    for (const auto& [axis, forward] : views) {
        camera.setAxis(axis, false);
        CHECK((-camera.axes().col(2) - forward).norm() < 1e-12);
        CHECK(std::abs(camera.axes().col(0).y()) < 1e-12);
        const render::Camera c = camera.camera();
        CHECK(((c.target - c.eye).normalized() - forward).norm() < 1e-9);
    }
}

TEST_CASE("camera: zooming keeps what is under the pointer, and zooming back undoes it") {
    CameraController camera = camera800();
    const Vec3 target = camera.camera().target;
    const Vec3 p = target + 0.2 * camera.axes().col(0) + 0.1 * camera.axes().col(1);
    const auto at = camera.onScreen(p);
    REQUIRE(at);
    camera.zoom(3.0, at->x(), at->y());
    const auto after = camera.onScreen(p);
    REQUIRE(after);
    CHECK((*after - *at).norm() < 1e-9);
    camera.zoom(-3.0, at->x(), at->y());
    CHECK((camera.camera().target - target).norm() < 1e-12);
}

TEST_CASE("camera: zooming for ever stays finite and can be zoomed back") {
    CameraController camera = camera800();
    for (int i = 0; i < 2000; ++i) camera.zoom(5.0, 10, 10);
    CHECK(camera.camera().eye.allFinite());
    CHECK((camera.camera().eye - camera.camera().target).norm() > 0.0);
    for (int i = 0; i < 4000; ++i) camera.zoom(-5.0, 790, 590);
    CHECK(camera.camera().eye.allFinite());
}

TEST_CASE("camera: panning carries the point at the target's depth along with the pointer") {
    CameraController camera = camera800();
    const Vec3 p = camera.camera().target;
    const auto before = camera.onScreen(p);
    camera.pan(37, -21);
    const auto after = camera.onScreen(p);
    REQUIRE(before);
    REQUIRE(after);
    CHECK((*after - *before - Eigen::Vector2d(37, -21)).norm() < 1e-9);
}

TEST_CASE("camera: framing shows every point with a margin, tightly, from any side and in any window") {
    std::vector<Vec3> points;
    for (int i = 0; i < 8; ++i) points.emplace_back(i & 1 ? 5.0 : -1.0, i & 2 ? 0.7 : 0.0, i & 4 ? 0.5 : -0.5);
    for (const auto& [w, h] : std::vector<std::pair<double, double>>{{800, 600}, {300, 900}, {1600, 200}})
        for (const Vec3& direction : {Vec3(-1, -1, -1), Vec3(0, -1, 0), Vec3(1, 0.2, 0), Vec3(0, 0, -1)})
            for (const bool orthographic : {false, true}) {
                CameraController camera;
                camera.setViewport(w, h);
                camera.setOrthographic(orthographic);
                camera.setDirection(direction, false);
                camera.frame(points, false);
                double widest = 0.0;
                for (const Vec3& p : points) {
                    const auto at = camera.onScreen(p);
                    REQUIRE(at);
                    const double x = std::abs(at->x() / w - 0.5), y = std::abs(at->y() / h - 0.5);
                    CHECK(x <= 0.5);
                    CHECK(y <= 0.5);
                    widest = std::max({widest, x, y});
                }
                CHECK(widest > 0.1);  // not lost in the distance: seen end on, the eye still stays outside of the box
            }
}

TEST_CASE("camera: an animated view ends exactly there, by the short way, and can be interrupted") {
    CameraController camera = camera800();
    camera.setAxis(ViewAxis::Back, false);
    camera.turn(0.3, 0.0);  // past the half turn
    camera.setAxis(ViewAxis::Left, true);
    CHECK(camera.moving());
    int frames = 0;
    double farthest = 0.0;
    while (camera.advance(1.0 / 60.0)) {
        ++frames;
        REQUIRE(frames < 1000);
        farthest = std::max(farthest, camera.axes().col(2).dot(Vec3::UnitX()));
    }
    CHECK(frames > 3);
    CHECK(farthest < 0.1);  // it never came round by the other side
    CHECK((camera.axes().col(2) + Vec3::UnitX()).norm() < 1e-12);
    camera.setAxis(ViewAxis::Top, true);
    camera.advance(0.05);
    camera.orbit(5, 5);
    CHECK(!camera.moving());
}

TEST_CASE("camera: switching the projection keeps the size of what is at the target") {
    CameraController camera = camera800();
    const render::Camera perspective = camera.camera();
    camera.setOrthographic(true);
    const double distance = (perspective.eye - perspective.target).norm();
    CHECK(camera.camera().orthoHeight == doctest::Approx(2.0 * distance * std::tan(perspective.fov / 2.0)));
}

TEST_CASE("navigation: Blender's mouse never needs Alt; the industry's takes it") {
    const auto blender = NavigationPreset::Blender, industry = NavigationPreset::Industry;
    CHECK(navigationOf(blender, Qt::MiddleButton, Qt::NoModifier) == Navigation::Orbit);
    CHECK(navigationOf(blender, Qt::MiddleButton, Qt::ShiftModifier) == Navigation::Pan);
    CHECK(navigationOf(blender, Qt::MiddleButton, Qt::ControlModifier) == Navigation::Zoom);
    CHECK(navigationOf(blender, Qt::LeftButton, Qt::AltModifier) == Navigation::None);
    CHECK(navigationOf(industry, Qt::LeftButton, Qt::AltModifier) == Navigation::Orbit);
    CHECK(navigationOf(industry, Qt::MiddleButton, Qt::AltModifier) == Navigation::Pan);
    CHECK(navigationOf(industry, Qt::RightButton, Qt::AltModifier) == Navigation::Zoom);
    CHECK(navigationOf(industry, Qt::LeftButton, Qt::NoModifier) == Navigation::None);
}
