// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/scene/framing.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace imomushi {

Vec3 threeQuarterDirection() { return Vec3(-0.62, -0.40, -1.0).normalized(); }

render::Camera framed(const render::Scene& scene, const Vec3& direction, double aspect, double fill) {
    render::Camera camera = scene.camera;
    camera.up = Vec3::UnitY();
    camera.target = Vec3::Zero();
    camera.eye = -direction.normalized();
    const Eigen::Matrix3d axes = camera.view().block<3, 3>(0, 0);  // rows: right, above, back
    if (axes.row(1).dot(camera.up) < 1e-6) camera.up = axes.row(1).transpose();  // straight from above or below
    const double ty = std::tan(0.5 * camera.fov) * fill, tx = ty * aspect;

    const double far = -std::numeric_limits<double>::infinity();
    double right = far, left = far, above = far, below = far, front = far, back = far;
    double wide = far, narrow = far, high = far, low = far;
    const auto include = [&](const Vec3& p) {
        const Vec3 q = axes * p;
        right = std::max(right, q.x() + tx * q.z());
        left = std::max(left, -q.x() + tx * q.z());
        above = std::max(above, q.y() + ty * q.z());
        below = std::max(below, -q.y() + ty * q.z());
        front = std::max(front, q.z());
        back = std::max(back, -q.z());
        wide = std::max(wide, q.x()), narrow = std::max(narrow, -q.x());
        high = std::max(high, q.y()), low = std::max(low, -q.y());
    };
    for (const render::Body& body : scene.bodies)
        if (body.mesh && body.positions)
            for (Eigen::Index v = 0; v < body.mesh->body.vertices.rows(); ++v) include(Eigen::Map<const Eigen::Vector3f>(body.positions + 3 * v).cast<double>());
    if (scene.bodies.empty())
        for (const render::Marker& m : scene.markers) include(m.from), include(m.to);
    if (!std::isfinite(right))
        for (int k = 0; k < 8; ++k) include(Vec3(k & 1 ? 0.5 : -0.5, scene.ground + (k & 2 ? 1.0 : 0.0), k & 4 ? 0.5 : -0.5));

    const double middle = 0.5 * (front - back);
    if (camera.orthographic) {
        camera.orthoHeight = std::max({high + low, (wide + narrow) / aspect, 1e-6}) / fill;
        const Vec3 centre(0.5 * (wide - narrow), 0.5 * (high - low), middle);
        camera.target = axes.transpose() * centre;
        camera.eye = camera.target + axes.row(2).transpose() * std::max(camera.orthoHeight * 2.0, (front + back));
        return camera;
    }
    const double ez = std::max({(right + left) / (2.0 * tx), (above + below) / (2.0 * ty), middle + 1e-6});
    const Vec3 eye(0.5 * (right - left), 0.5 * (above - below), ez);
    camera.eye = axes.transpose() * eye;
    camera.target = axes.transpose() * Vec3(eye.x(), eye.y(), middle);
    return camera;
}

}  // namespace imomushi
