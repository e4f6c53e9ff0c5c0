// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/mesh/mesh.h"

namespace imomushi::render {

/// Where the scene is seen from. Right-handed, looks from eye to target.
struct Camera {
    Vec3 eye = Vec3(0, 1, 4), target = Vec3::Zero(), up = Vec3::UnitY();
    double fov = 0.6;            ///< vertical angle in radians (perspective)
    bool orthographic = false;
    double orthoHeight = 4.0;    ///< m, visible height (orthographic)
    [[nodiscard]] Eigen::Matrix4d view() const;
    /// near and far planes are chosen around the sphere (centre, radius) that holds the scene.
    [[nodiscard]] Eigen::Matrix4d projection(double aspect, const Vec3& sceneCentre, double sceneRadius) const;
};

/// One body to draw. Pointers are read during draw() only; geometry is uploaded again when `revision` changes, the look when `look` does.
struct Body {
    std::uint64_t id = 0;                       ///< what pick() answers; 0 is "nothing"
    std::shared_ptr<const ElementMesh> mesh;    ///< topology and look
    const float* positions = nullptr;           ///< #body vertices x 3, world
    const float* normals = nullptr;
    std::uint64_t revision = 0;
    Eigen::Vector3f color = Eigen::Vector3f::Constant(0.7f);  ///< linear; where the look has none
    bool selected = false, hovered = false;
    bool dimmed = false;                        ///< out of date: drawn with a calm hatch
    float opacity = 1.0f;                       ///< < 1: x-ray while bones are placed
    const std::vector<std::int32_t>* markedTriangles = nullptr;  ///< face under construction, issue places
};

/// Overlay primitives, drawn over the bodies with constant size in pixels where said so.
struct Marker {
    enum class Shape { Bone, JointPoint, HeldPoint, PinnedPoint, FaceOutline, PlaneGizmo, Axis } shape = Shape::JointPoint;
    std::uint64_t id = 0;            ///< what pick() answers
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();   ///< bone: its ends; points: `from`
    std::vector<Vec3> outline;       ///< FaceOutline: closed polyline(s); NaN-free
    bool selected = false, hovered = false;
};

struct Scene {
    Camera camera;
    std::vector<Body> bodies;
    std::vector<Marker> markers;
    bool grid = true;
    bool darkTheme = true;
    bool transparentBackground = false;
    float pixelRatio = 1.0f;  ///< device pixels per logical pixel
};

/// Draws scenes with the OpenGL 3.3 core context that is current on this thread. No Qt.
class SceneRenderer {
public:
    /// Errors: "no-opengl" (no 3.3 core context), "bad-shader" with the compiler's log.
    static Result<std::unique_ptr<SceneRenderer>> create();
    virtual ~SceneRenderer() = default;

    /// Draws into framebuffer object `target` (0: the window's), size in device pixels.
    virtual void draw(const Scene& scene, unsigned target, int width, int height) = 0;

    /// Id of the marker (first) or body at a device pixel (origin top left) of the last drawn scene; 0: nothing. `triangle`: of the body, or -1.
    /// `point`: world position there.
    struct Pick {
        std::uint64_t id = 0;
        int triangle = -1;
        Vec3 point = Vec3::Zero();
        bool marker = false;
    };
    virtual Pick pick(const Scene& scene, int width, int height, int x, int y) = 0;
};

/// An OpenGL context without window or display (EGL surfaceless), current from creation to destruction on its thread.
class OffscreenContext {
public:
    /// Errors: "no-opengl" with what EGL said.
    static Result<std::unique_ptr<OffscreenContext>> create();
    virtual ~OffscreenContext() = default;
};

/// Draws a scene without a display and returns RGBA rows from the top, 4 bytes a pixel.
Result<std::vector<std::uint8_t>> drawOffscreen(const Scene& scene, int width, int height);

/// Writes RGBA rows as a PNG file. Errors: "not-writable".
Result<void> writePng(const std::string& path, const std::vector<std::uint8_t>& rgba, int width, int height);

}  // namespace imomushi::render
