// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/picture_warm_up.h"

#include <QCoreApplication>
#include <memory>

#include "ui/render/offscreen.h"
#include "ui/scene/framing.h"

namespace imomushi {
namespace {

constexpr int kSamplePixels = 64;  // a side

/// Some of each that previews show.
void drawSample() {
    ElementMesh mesh;
    mesh.body.vertices.resize(4, 3);
    mesh.body.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
    mesh.body.triangles.resize(4, 3);
    mesh.body.triangles << 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3;
    const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> positions = mesh.body.vertices.cast<float>();
    render::Scene scene;
    scene.transparentBackground = true;
    for (const bool twoSided : {false, true}) {
        render::Body& body = scene.bodies.emplace_back();
        body.id = scene.bodies.size();
        body.mesh = std::make_shared<const ElementMesh>(mesh);
        body.positions = positions.data();
        body.twoSided = twoSided;
    }
    using Shape = render::Marker::Shape;
    for (const Shape shape : {Shape::Bone, Shape::JointPoint, Shape::HeldPoint, Shape::PinnedPoint, Shape::FaceOutline}) {
        render::Marker& marker = scene.markers.emplace_back();
        marker.shape = shape;
        marker.to = Vec3::UnitY();
        if (shape == Shape::FaceOutline) marker.outline = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()};
    }
    scene.camera = framed(scene, -Vec3::Ones(), 1.0);
    (void)render::drawOffscreen(scene, kSamplePixels, kSamplePixels);  // what goes wrong is told where a picture is wanted
}

}  // namespace

PictureWarmUp& PictureWarmUp::instance() {
    static auto* const job = new PictureWarmUp(QCoreApplication::instance());
    return *job;
}

void PictureWarmUp::begin() {
    if (!done_ && !running()) launch([](const Progress&) { drawSample(); }, [this] { done_ = true; });
}

}  // namespace imomushi
