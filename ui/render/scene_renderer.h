// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "core/mesh/mesh.h"

namespace imomushi {
struct SurfaceRecipe;
}

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
    int recipeElement = -1;                     ///< of Scene::recipe, which it is drawn from: positions and normals are not read. -1: from these
    std::uint64_t revision = 0;
    Eigen::Vector3f color = Eigen::Vector3f::Constant(0.7f);  ///< linear; where the look has none
    bool selected = false, hovered = false;
    bool dimmed = false;                        ///< out of date: drawn with a calm hatch
    float opacity = 1.0f;                       ///< < 1: x-ray while bones are placed
    const std::vector<std::int32_t>* markedTriangles = nullptr;  ///< face under construction, issue places
    /// Triangles that touch a neighbour (joined faces): neither drawn nor part of the normals at their rim. Null: none.
    std::shared_ptr<const std::vector<std::int32_t>> coveredTriangles;
    bool pickable = true;                       ///< false: pick() looks through it (a locked element)
};

/// Two bodies that must look like one surface: their normals are averaged over the welded body vertices.
struct Seam {
    int a = -1, b = -1;  ///< into Scene::bodies
    std::shared_ptr<const std::vector<std::pair<std::int32_t, std::int32_t>>> welded;  ///< (vertex of a, vertex of b)
};

/// Overlay primitives, drawn over the bodies, dimmer where a body hides them. Lines and points keep their size in pixels.
///   Bone         tapered octahedron from `from` to `to`
///   JointPoint   ring at `from`; HeldPoint: disc in a ring; PinnedPoint: diamond
///   FaceOutline  glowing closed polyline `outline` (the last point joins the first)
///   PlaneGizmo   translucent square around `from`, half as wide as `to` is away, with an arrow along its normal to `to`
///   Axis         arrow from `from` to `to`, in the colour of the world axis nearest to its direction
struct Marker {
    enum class Shape { Bone, JointPoint, HeldPoint, PinnedPoint, FaceOutline, PlaneGizmo, Axis } shape = Shape::JointPoint;
    std::uint64_t id = 0;            ///< what pick() answers; 0: not picked
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();   ///< m, world, finite
    std::vector<Vec3> outline;       ///< FaceOutline only; m, world, finite
    bool selected = false, hovered = false;
};

struct Scene {
    Camera camera;
    std::vector<Body> bodies;
    std::vector<Seam> seams;
    std::vector<Marker> markers;
    /// What bodies with a recipeElement are made from (core/character/surface_recipe.h): all of one character, that SceneRenderer::take() took.
    const SurfaceRecipe* recipe = nullptr;
    bool grid = true;
    bool groundShadow = true;         ///< soft shadow on the ground, also without the grid
    double ground = 0.0;              ///< m, world height of grid and shadow
    bool solidGround = false;         ///< bodies rest on it: a calm plane under its grid, also where the grid is off
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

    /// Draws into framebuffer object `target` (0: the window's), size in device pixels. Values written are sRGB-encoded; with a transparent
    /// background colour is multiplied by alpha. Leaves the context's state at OpenGL's defaults, except the framebuffer binding (`target`)
    /// and the viewport.
    virtual void draw(const Scene& scene, unsigned target, int width, int height) = 0;

    /// Id of the marker (first) or body at a device pixel (origin top left) of the last drawn scene; 0: nothing. `triangle`: of the body, or -1.
    /// `point`: world position there. Draws nothing visible and needs no draw() before.
    struct Pick {
        std::uint64_t id = 0;
        int triangle = -1;
        Vec3 point = Vec3::Zero();
        bool marker = false;
    };
    virtual Pick pick(const Scene& scene, int width, int height, int x, int y) = 0;

    /// Takes what never changes of a character into the memory of the graphics card, unless it is there. False: the driver has no room for it.
    virtual bool take(const SurfaceRecipe& recipe) = 0;
    /// Whether the card can make this element of the character that it took.
    [[nodiscard]] virtual bool deforms(int element) const = 0;
    /// OpenGL without a graphics card: deforming with it would cost more than without.
    [[nodiscard]] virtual bool software() const = 0;

    /// Of the last draw(): milliseconds that the processor spent to bring what changed onto the card, or to have the card make it.
    [[nodiscard]] virtual double uploadMs() const = 0;

    /// Gives back all memory of bodies and pictures; the next draw() makes it anew.
    virtual void forget() = 0;
};

/// An OpenGL context without window or display (EGL surfaceless), current from creation to destruction on its thread. While it lives
/// floating-point traps are off on that thread: drivers compute with infinities on purpose.
class OffscreenContext {
public:
    /// Errors: "no-opengl" with what EGL said.
    static Result<std::unique_ptr<OffscreenContext>> create();
    virtual ~OffscreenContext() = default;
};

/// Largest pictures that are drawn: side and number of pixels (8192 x 4320 and the like).
inline constexpr int kLargestSide = 8192;
inline constexpr long kMostPixels = 36'000'000;

/// Draws a scene without a display and returns RGBA rows from the top, 4 bytes a pixel, sRGB with straight alpha. Works beside any
/// other context of the caller: it draws on a thread of its own, which keeps its context for the next picture. Errors: "no-opengl", "bad-shader", "bad-size", "out-of-memory".
Result<std::vector<std::uint8_t>> drawOffscreen(const Scene& scene, int width, int height);

/// Writes RGBA rows as a PNG file. `path` is UTF-8. Errors: "not-writable".
Result<void> writePng(const std::string& path, const std::vector<std::uint8_t>& rgba, int width, int height);

}  // namespace imomushi::render
