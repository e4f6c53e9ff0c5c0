// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "shape.h"

namespace imomushi::samples {

/// A triangle surface, possibly with open rims.
struct Mesh {
    std::vector<Vec3> points;
    std::vector<std::array<int, 3>> triangles;
};

/// Turns a surface into one of nearly equilateral triangles on `shape`, with edges of about size(p) metres (splits, collapses, Delaunay flips and tangential
/// smoothing, after Botsch and Kobbelt 2004). The first `fixed` points, among them all rim points, stay; no inner edge joins two of them.
/// vertices > 0: with exactly so many points, edges scaled accordingly.
Mesh remesh(const Mesh& start, int fixed, const Shape& shape, const std::function<double(const Vec3&)>& size, int vertices);

/// Smallest angle of a triangle (radians).
double smallestAngle(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace imomushi::samples
