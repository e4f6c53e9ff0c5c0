// SPDX-License-Identifier: GPL-3.0-or-later
#include "shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace imomushi::samples {

double sphere(const Vec3& p, const Vec3& centre, double radius) { return (p - centre).norm() - radius; }

double ellipsoid(const Vec3& p, const Vec3& centre, const Vec3& radii) {
    const Vec3 q = (p - centre).cwiseQuotient(radii);
    const double k0 = q.norm(), k1 = q.cwiseQuotient(radii).norm();
    return k1 > 0 ? k0 * (k0 - 1) / k1 : -radii.minCoeff();
}

double taperedCapsule(const Vec3& p, const Vec3& a, const Vec3& b, double ra, double rb) {
    const Vec3 ab = b - a;
    const double t = std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
    return (p - a - t * ab).norm() - (ra + t * (rb - ra));
}

double blend(double a, double b, double k) {
    const double h = std::max(k - std::abs(a - b), 0.0) / k;
    return std::min(a, b) - h * h * k / 4;
}

Tube::Tube(const std::vector<Vec3>& points, const std::vector<double>& radii, int segments) {
    const int n = int(points.size()) - 1;
    const auto spline = [&](const auto& v, double t) {
        const int i = std::min(int(t), n - 1);
        const double u = t - i;
        const auto p0 = v[std::max(i - 1, 0)], p1 = v[i], p2 = v[i + 1], p3 = v[std::min(i + 2, n)];
        return std::decay_t<decltype(v[0])>(0.5 * (2 * p1 + (p2 - p0) * u + (2 * p0 - 5 * p1 + 4 * p2 - p3) * u * u +
                                                   (3 * p1 - p0 - 3 * p2 + p3) * u * u * u));
    };
    for (int i = 0; i <= segments; ++i) {
        const double t = double(n) * i / segments;
        points_.push_back(spline(points, t));
        radii_.push_back(spline(radii, t));
    }
}

Tube::Nearest Tube::nearest(const Vec3& p) const {
    // The pieces beside the nearest sample: the radius changes slowly along the curve.
    std::size_t sample = 0;
    double least = 1e300;
    for (std::size_t i = 0; i < points_.size(); ++i) {
        const double d = (p - points_[i]).squaredNorm();
        if (d < least) least = d, sample = i;
    }
    Nearest best{1e9, 0};
    for (std::size_t i = sample > 0 ? sample - 1 : 0; i <= sample && i + 1 < points_.size(); ++i) {
        const Vec3 ab = points_[i + 1] - points_[i];
        const double t = std::clamp((p - points_[i]).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
        const double d = (p - points_[i] - t * ab).norm() - (radii_[i] + t * (radii_[i + 1] - radii_[i]));
        if (d < best.distance) best = {d, (double(i) + t) / double(points_.size() - 1)};
    }
    return best;
}

Vec3 Tube::at(double along) const {
    const double t = along * double(points_.size() - 1);
    const auto i = std::min(std::size_t(t), points_.size() - 2);
    return points_[i] + (t - double(i)) * (points_[i + 1] - points_[i]);
}

Vec3 Tube::tangent(double along) const {
    return (at(std::min(along + 0.01, 1.0)) - at(std::max(along - 0.01, 0.0))).normalized();
}

double Tube::radius(double along) const {
    const double t = along * double(radii_.size() - 1);
    const auto i = std::min(std::size_t(t), radii_.size() - 2);
    return radii_[i] + (t - double(i)) * (radii_[i + 1] - radii_[i]);
}

double Tube::length() const {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < points_.size(); ++i) sum += (points_[i + 1] - points_[i]).norm();
    return sum;
}

namespace {
constexpr double kStep = 1e-4;  // m: central differences of shapes of about a metre

Vec3 gradient(const Shape& shape, const Vec3& p) {
    Vec3 g;
    for (int i = 0; i < 3; ++i) {
        Vec3 e = Vec3::Zero();
        e[i] = kStep;
        g[i] = (shape(p + e) - shape(p - e)) / (2 * kStep);
    }
    return g;
}
}  // namespace

Vec3 normal(const Shape& shape, const Vec3& p) {
    const Vec3 g = gradient(shape, p);
    return g.norm() > 1e-9 ? Vec3(g.normalized()) : Vec3::UnitY();
}

Vec3 project(const Shape& shape, Vec3 p) {
    for (int i = 0; i < 8; ++i) {
        const double f = shape(p);
        if (std::abs(f) < 1e-8) break;
        const Vec3 g = gradient(shape, p);
        p -= g * (std::clamp(f, -0.05, 0.05) / std::max(g.squaredNorm(), 0.05));
    }
    return p;
}

double hit(const Shape& shape, const Vec3& origin, const Vec3& direction, double reach) {
    double t = 0, step = 0;
    while (t < reach) {
        const double f = shape(origin + t * direction);
        if (f >= 0) break;
        step = std::max(-0.6 * f, 1e-3);
        t += step;
    }
    if (t >= reach) return reach;
    double low = t - step, high = t;
    for (int i = 0; i < 40; ++i) {
        const double mid = (low + high) / 2;
        (shape(origin + mid * direction) < 0 ? low : high) = mid;
    }
    return (low + high) / 2;
}

}  // namespace imomushi::samples
