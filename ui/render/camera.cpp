// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/camera.h"

#include <algorithm>
#include <cmath>

namespace imomushi::render {

Eigen::Matrix4d Camera::view() const {
    Vec3 back = eye - target;
    back = back.norm() > 1e-12 ? Vec3(back.normalized()) : Vec3(Vec3::UnitZ());
    Vec3 right = up.cross(back);
    // Looking along `up`: any other direction will do.
    if (right.norm() < 1e-9 * std::max(up.norm(), 1e-300)) right = (std::abs(back.z()) < 0.9 ? Vec3(Vec3::UnitZ()) : Vec3(Vec3::UnitX())).cross(back);
    right.normalize();
    const Vec3 above = back.cross(right);
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m.block<1, 3>(0, 0) = right.transpose();
    m.block<1, 3>(1, 0) = above.transpose();
    m.block<1, 3>(2, 0) = back.transpose();
    m.block<3, 1>(0, 3) = -m.block<3, 3>(0, 0) * eye;
    return m;
}

Eigen::Matrix4d Camera::projection(double aspect, const Vec3& sceneCentre, double sceneRadius) const {
    const Vec3 look = target - eye;
    const Vec3 forward = look.norm() > 1e-12 ? Vec3(look.normalized()) : Vec3(-Vec3::UnitZ());
    const double middle = (sceneCentre - eye).dot(forward);
    const double radius = std::max(sceneRadius, 1e-9) * 1.05;
    Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
    if (orthographic) {
        const double h = 0.5 * orthoHeight;
        m(0, 0) = 1.0 / (h * aspect);
        m(1, 1) = 1.0 / h;
        m(2, 2) = -1.0 / radius;
        m(2, 3) = -middle / radius;
        m(3, 3) = 1.0;
        return m;
    }
    // Inside the sphere the near plane stays at a five-hundredth of it: 24 bits of depth then tell a hundred-thousandth of the scene apart.
    const double near = std::max(middle - radius, radius * 0.002);
    const double far = std::max(middle + radius, near * 2.0);
    const double t = std::tan(0.5 * fov);
    m(0, 0) = 1.0 / (t * aspect);
    m(1, 1) = 1.0 / t;
    m(2, 2) = -(far + near) / (far - near);
    m(2, 3) = -2.0 * far * near / (far - near);
    m(3, 2) = -1.0;
    return m;
}

}  // namespace imomushi::render
