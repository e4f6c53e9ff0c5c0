// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ui/render/scene.h"

namespace imomushi::render {

struct SolidVertex {
    Eigen::Vector3f position, normal;
    Eigen::Vector4f color;  ///< linear, straight alpha
    float behind;           ///< how visible it stays behind bodies, 0...1
};

/// One segment of a polyline with its neighbours.
struct LineSegment {
    Eigen::Vector3f before, from, to, after;
    Eigen::Vector4f color;
    Eigen::Vector3f widths;  ///< half width and reach of the glow, device pixels; how visible it stays behind bodies, 0...1
};

struct PointSprite {
    Eigen::Vector3f centre;
    Eigen::Vector3f shape;  ///< radius in device pixels; 0 ring, 1 disc in a ring, 2 diamond, 3 square ring; how visible it stays behind bodies
    Eigen::Vector4f color;
};

/// What the markers of a scene are drawn from. Vectors keep their memory from frame to frame.
struct MarkerGeometry {
    std::vector<SolidVertex> bones;   ///< triangles, opaque
    std::vector<SolidVertex> sheets;  ///< triangles, translucent
    std::vector<SolidVertex> gizmo;   ///< triangles, over all of these
    std::vector<LineSegment> lines;
    std::vector<PointSprite> points;
    void build(const Scene& scene, int height);
};

/// Marker under a pixel (centre of it; origin top left, device pixels): the one whose drawn shape, widened by a few pixels, holds it. Points win
/// over axes, these over outlines, bones and planes; among equals the nearer on the screen.
/// `bodyDepth`: distance of the body there along the view, infinity: none; outlines well behind it are not picked.
/// Returns the index into scene.markers or -1, and the marker's point nearest to the pixel.
int pickMarker(const Scene& scene, int width, int height, double x, double y, double bodyDepth, Vec3& point);

/// Colours of the studio, linear RGB: chosen from Okabe and Ito's set, which the colour-blind tell apart.
Eigen::Vector3f selectionColor();
Eigen::Vector3f hoverColor();

}  // namespace imomushi::render
