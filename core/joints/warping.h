// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/joints/joint_face.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// The scalar shapes that warp a joint face: all polynomials in its plane of degrees 2, 3 and 4,
///   r^2, x^2 - y^2, x y, r^2 x, r^2 y, r^4, r^2 (x^2 - y^2), r^2 x y, x^3 - 3 x y^2, 3 x^2 y - y^3, x^4 - 6 x^2 y^2 + y^4, x y (x^2 - y^2),
/// each made orthogonal to 1, x, y and those before it, in the area integral of what is linear on the triangles of the face, so that a warped face keeps
/// its mean place and rotation exactly. With 1, x and y the first ones span the same shapes whatever the triangles, so that two faces of a joint
/// can say the same. Their root mean square over the face is that of x and y together over sqrt(2): metres, as large as what a unit of stretch
/// does, so that coefficients are of the order of strains. Shapes that the vertices of a face cannot tell from those before them are zero.
class Warping {
public:
    static constexpr int kMax = 12;  ///< all of degrees 2, 3 and 4

    Warping() = default;  ///< none
    /// The first `count` shapes, 0...kMax, on a face of `body`. Zero on a face without area.
    Warping(const TriangleMesh& body, const JointFace& face, int count);

    [[nodiscard]] int count() const { return count_; }
    /// Values (m) at a point (x, y) of the plane in the frame of the face, count() of them.
    void at(double x, double y, double* values) const;
    bool operator==(const Warping&) const = default;

private:
    int count_ = 0;
    double unit_ = 0.0;                 // m
    std::vector<double> coefficients_;  // per shape: of 1, x, y and all shapes of the list above up to itself, in units
};

/// One term of a warping column: `share` times a shape along an axis of the face.
struct WarpTerm {
    int shape, axis;
    double share;
};
/// The i-th warping column of a face, 0...3 Warping::kMax - 1: one shape along z, or two in the plane that together turn with it. They are ordered by how much
/// of the error against free faces each takes away beside those before it, per column, over stretch, bends, twist and random poses of chains of round, oval,
/// short and long cylinders and of the sample "caterpillar". Columns that turn into each other about z stay together, so that what the axes of a face happen to
/// be matters little: after 2, 3, 5, 7, 9, 11, 12, 13, 15, 16, 18 ... columns. The first eleven are all quadratic shapes in the plane (x^2, y^2 and x y along x
/// and y) and along z, and r^2 x and r^2 y along z: bends and shear; the next two stretch and twist, r^2 (x, y) and r^2 (-y, x). All 36 are every shape along
/// every axis.
std::span<const WarpTerm> warpColumn(int i);
/// Shapes that the first `columns` columns are made of.
int warpShapes(int columns);

/// A point of a face with its share of the area, for integrals that are exact up to degree 8 on flat faces.
struct AreaPoint {
    Vec3 local;     ///< in the frame of the face, m
    double weight;  ///< m^2
};
std::vector<AreaPoint> areaPoints(const TriangleMesh& body, const JointFace& face);

}  // namespace imomushi
