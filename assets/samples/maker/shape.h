// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace imomushi::samples {

using Vec3 = Eigen::Vector3d;

/// A solid as a function of space: negative inside, about the distance to the surface (m) near it.
using Shape = std::function<double(const Vec3&)>;

/// Distances of simple solids (after Inigo Quilez, "Distance functions").
double sphere(const Vec3& p, const Vec3& centre, double radius);
double ellipsoid(const Vec3& p, const Vec3& centre, const Vec3& radii);
/// A segment whose radius runs linearly from ra to rb.
double taperedCapsule(const Vec3& p, const Vec3& a, const Vec3& b, double ra, double rb);

/// Union with a fillet of about `k` metres.
double blend(double a, double b, double k);

/// A smooth curve through points, with a radius that runs along: arms.
class Tube {
public:
    /// Catmull-Rom through `points` with `radii`, cut into `segments` pieces.
    Tube(const std::vector<Vec3>& points, const std::vector<double>& radii, int segments);
    struct Nearest {
        double distance;  ///< to the surface
        double along;     ///< 0...1
    };
    [[nodiscard]] Nearest nearest(const Vec3& p) const;
    [[nodiscard]] Vec3 at(double along) const;
    [[nodiscard]] Vec3 tangent(double along) const;
    [[nodiscard]] double radius(double along) const;
    [[nodiscard]] double length() const;

private:
    std::vector<Vec3> points_;
    std::vector<double> radii_;
};

/// Unit outward normal of the surface through p, by central differences.
Vec3 normal(const Shape& shape, const Vec3& p);
/// The point of the surface near p, along the gradient.
Vec3 project(const Shape& shape, Vec3 p);
/// The first point of the surface on the ray from a point inside; `reach` metres when there is none.
double hit(const Shape& shape, const Vec3& origin, const Vec3& direction, double reach);

}  // namespace imomushi::samples
