// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/mesh/mesh.h"
#include "ui/render/camera.h"
#include "ui/render/gizmo.h"

namespace imomushi {
struct DeformInput;
}

namespace imomushi::render {

/// One body to draw. Pointers are read during draw() only; positions are uploaded again when `revision` changes, topology and look when `mesh` does.
struct Body {
    std::uint64_t id = 0;                       ///< what pick() answers; 0 is "nothing"
    std::shared_ptr<const ElementMesh> mesh;    ///< topology and look
    std::shared_ptr<const ElementMesh> textures;  ///< whose textures its materials mean; bodies that have one share them on the graphics card. Null: those of `mesh`
    const std::vector<std::int32_t>* modelVertices = nullptr;  ///< per body vertex that of the whole model whose textures it has; null: it is no part of one
    const float* positions = nullptr;           ///< #body vertices x 3, world
    const float* normals = nullptr;             ///< #body vertices x 3, world, unit; null: computed from the triangles
    int deformSurface = -1;                     ///< of Scene::deformInput (GpuDeformer), which it is drawn from: positions and normals are not read. -1: from these
    std::uint64_t revision = 0;
    Eigen::Vector3f color = Eigen::Vector3f::Constant(0.7f);  ///< linear; where the look has none
    bool visible = true;                        ///< false: not drawn, but its buffers stay on the graphics card
    bool selected = false, hovered = false;
    bool outdated = false;                      ///< its result is out of date: drawn with a calm hatch
    bool twoSided = false;                      ///< the mesh may be open or inside out: back faces are drawn too
    bool dataColors = false;                    ///< vertex colours are data beside a legend: lighting changes them by a fifth at most
    float opacity = 1.0f;                       ///< < 1: x-ray while bones are placed
    const std::vector<std::int32_t>* highlightedTriangles = nullptr;  ///< body triangles: a face under construction, places of an issue
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
///   SnapMark     square ring at `from`: what is dragged goes there
///   Gizmo        `gizmo` around `from`, of constant size
///   FaceOutline  glowing closed polyline `outline` (the last point joins the first), with a translucent disc in it if it is `filled`
///   PlaneGizmo   translucent square around `from`, half as wide as `to` is away, with an arrow along its normal to `to`
///   Axis         arrow from `from` to `to`, in the colour of the world axis nearest to its direction
struct Marker {
    enum class Shape { Bone, JointPoint, HeldPoint, PinnedPoint, SnapMark, FaceOutline, PlaneGizmo, Axis, Gizmo } shape = Shape::JointPoint;
    std::uint64_t id = 0;            ///< what pick() answers; 0: not picked
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();   ///< m, world, finite
    std::vector<Vec3> outline;       ///< FaceOutline only; m, world, finite
    bool selected = false, hovered = false;
    bool filled = false;             ///< FaceOutline only
    int axis = -1;                   ///< Axis only: in whose colour, 0...2; -1: as it lies
    std::shared_ptr<const GizmoLook> gizmo;  ///< Gizmo only
    bool refused = false;            ///< it cannot be done as it lies: in the colour of a warning
};

struct Scene {
    Camera camera;
    std::vector<Body> bodies;
    std::vector<Seam> seams;
    std::vector<Marker> markers;
    /// What bodies with a deformSurface are made from (core/character/deform_input.h): all of one character, uploaded by SceneRenderer::uploadCharacter().
    const DeformInput* deformInput = nullptr;
    bool grid = true;
    bool groundShadow = true;         ///< soft shadow on the ground, also without the grid
    double ground = 0.0;              ///< m, world height of grid and shadow
    bool solidGround = false;         ///< bodies rest on it: a calm plane under its grid, also where the grid is off
    bool darkTheme = true;
    bool transparentBackground = false;
    bool smooth = true;       ///< smooth edges also where the processor draws, which take it several times as long
    float pixelRatio = 1.0f;  ///< device pixels per pixel of the design: of lines, points and handles
    bool halved = false;      ///< drawn with half as many pixels each way, and enlarged: three times as fast where the processor draws

    [[nodiscard]] float unit() const { return halved ? 0.5f * pixelRatio : pixelRatio; }  ///< drawn pixels per pixel of the design
};

}  // namespace imomushi::render
