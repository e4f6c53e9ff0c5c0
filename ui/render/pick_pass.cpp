// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/pick_pass.h"

#include <cmath>

namespace imomushi::render {

using Eigen::Vector3f;

Result<void> PickPass::prepare() { return linkAll({{&identity_, "body.vert", "identity.frag"}}); }

PickPass::Hit PickPass::bodyAt(const PassInput& in, const GpuDeformer& deformer, int x, int y) const {
    pixel_.bind();
    const GLuint nothing[4] = {0, 0, 0, 0};
    glClearBufferuiv(GL_COLOR, 0, nothing);
    glClear(GL_DEPTH_BUFFER_BIT);
    glEnable(GL_DEPTH_TEST);
    const double cx = 2.0 * (x + 0.5) / in.width - 1.0, cy = 1.0 - 2.0 * (y + 0.5) / in.height;
    Eigen::Matrix4d zoom = Eigen::Matrix4d::Identity();
    zoom(0, 0) = in.width, zoom(0, 3) = -cx * in.width;
    zoom(1, 1) = in.height, zoom(1, 3) = -cy * in.height;
    const Eigen::Matrix4f transform = (zoom * in.frame.block.viewProjection.cast<double>()).cast<float>();
    identity_.use();
    identity_.set("transform", transform);
    for (std::size_t i = 0; i < in.bodies.size(); ++i) {
        if (!in.bodies[i] || !in.scene.bodies[i].pickable) continue;
        identity_.set("body", static_cast<unsigned>(i + 1));
        drawTriangles(*in.bodies[i]);
    }
    GLuint found[2] = {0, 0};
    glReadPixels(0, 0, 1, 1, GL_RG_INTEGER, GL_UNSIGNED_INT, found);
    if (found[0] == 0 || found[0] > in.bodies.size()) return {};

    Hit hit;
    hit.body = static_cast<int>(found[0]) - 1;
    const Body& body = in.scene.bodies[found[0] - 1];
    const GpuBody& gpu = *in.bodies[found[0] - 1];
    hit.triangle = gpu.geometry->bodyTriangle(static_cast<int>(found[1]));
    // The point: where the ray meets the plane of the triangle.
    const Camera& camera = in.scene.camera;
    const Eigen::Matrix4d view = camera.view();
    const Eigen::Matrix3d axes = view.block<3, 3>(0, 0).transpose();
    const double h = camera.orthographic ? 0.5 * camera.orthoHeight : std::tan(0.5 * camera.fov);
    const double px = cx * h * in.width / in.height, py = cy * h;
    const Vec3 origin = camera.orthographic ? Vec3(camera.eye + axes * Vec3(px, py, 0.0)) : camera.eye;
    const Vec3 ray = camera.orthographic ? Vec3(-axes.col(2)) : Vec3(axes * Vec3(px, py, -1.0));
    Vec3 corner[3];
    for (int c = 0; c < 3; ++c) {
        const std::int32_t v = body.mesh->body.triangles(hit.triangle, c);
        Vector3f p;
        if (gpu.surface >= 0)
            deformer.readVertex(deformer.shownBy(gpu.surface, body.modelVertices), v, p.data());
        else
            p = Eigen::Map<const Vector3f>(body.positions + 3 * v);
        corner[c] = p.cast<double>();
    }
    const Vec3 n = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    const double slope = n.dot(ray);
    hit.point = std::abs(slope) > 1e-12 * n.norm() * ray.norm() ? Vec3(origin + n.dot(corner[0] - origin) / slope * ray)
                                                                : Vec3((corner[0] + corner[1] + corner[2]) / 3.0);
    hit.depth = -(view.row(2).dot(hit.point.homogeneous()));
    return hit;
}

}  // namespace imomushi::render
