// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "character.h"

namespace imomushi::samples {

double cover(double d, double soft) {
    const double t = std::clamp(0.5 - d / soft, 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

Eigen::Vector2d onPicture(const Vec3& p, const Vec3& centre, const Vec3& out, const Vec3& up) {
    const Vec3 right = up.cross(out).normalized(), top = out.cross(right).normalized();
    return {(p - centre).dot(right), (p - centre).dot(top)};
}

double ovalDistance(const Eigen::Vector2d& q, const Eigen::Vector2d& centre, const Eigen::Vector2d& radii) {
    const Eigen::Vector2d s = (q - centre).cwiseQuotient(radii);
    const double k = s.norm();
    return k > 0 ? k * (k - 1) / s.cwiseQuotient(radii).norm() : -radii.minCoeff();
}

Vec3 paintEye(Vec3 colour, const Eigen::Vector2d& q, const Eigen::Vector2d& radii, double texel) {
    const double soft = 1.5 * texel, r = radii.y();
    const double inside = ovalDistance(q, {0, 0}, radii);
    colour = mix(colour, rgb(0x241a1e), cover(inside, soft));
    // A warm glow in the lower half, and two lights.
    const double glow = std::clamp(-q.y() / r, 0.0, 1.0);
    colour = mix(colour, rgb(0x7a4a32), 0.75 * glow * cover(ovalDistance(q, {0, -0.12 * r}, 0.78 * radii), 0.25 * r));
    colour = mix(colour, Vec3::Ones(), cover(ovalDistance(q, {-0.28 * radii.x(), 0.42 * r}, Eigen::Vector2d(0.34, 0.28).cwiseProduct(radii)), soft));
    colour = mix(colour, Vec3::Ones(), 0.9 * cover(ovalDistance(q, {0.34 * radii.x(), -0.42 * r}, Eigen::Vector2d(0.16, 0.13).cwiseProduct(radii)), soft));
    return colour;
}

double smile(const Eigen::Vector2d& q, const Eigen::Vector2d& centre, double radius, double halfAngle, double width, double texel) {
    const Eigen::Vector2d d = q - centre;
    const double angle = std::clamp(std::atan2(d.x(), -d.y()), -halfAngle, halfAngle);
    const Eigen::Vector2d on = radius * Eigen::Vector2d(std::sin(angle), -std::cos(angle));
    return cover((d - on).norm() - width / 2, 1.5 * texel);
}

}  // namespace imomushi::samples
