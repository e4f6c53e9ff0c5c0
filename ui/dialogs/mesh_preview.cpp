// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/mesh_preview.h"

#include <Eigen/Geometry>
#include <QMouseEvent>
#include <QPainter>
#include <QPainterPath>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

constexpr double kFill = 0.80;  // of the smaller side that the bodies may take

/// A picture with a depth per pixel; larger is nearer.
struct Raster {
    QImage image;
    std::vector<float> depth;

    Raster(int width, int height) : image(width, height, QImage::Format_ARGB32_Premultiplied), depth(std::size_t(width) * std::size_t(height), std::numeric_limits<float>::lowest()) {
        image.fill(Qt::transparent);
    }
    // Corners in pixels, z towards the eye.
    void triangle(const std::array<Vec3, 3>& p, QRgb color) {
        const double area = (p[1].x() - p[0].x()) * (p[2].y() - p[0].y()) - (p[1].y() - p[0].y()) * (p[2].x() - p[0].x());
        if (std::abs(area) < 1e-12) return;
        const int left = std::max(0, int(std::floor(std::min({p[0].x(), p[1].x(), p[2].x()}))));
        const int right = std::min(image.width() - 1, int(std::ceil(std::max({p[0].x(), p[1].x(), p[2].x()}))));
        const int top = std::max(0, int(std::floor(std::min({p[0].y(), p[1].y(), p[2].y()}))));
        const int bottom = std::min(image.height() - 1, int(std::ceil(std::max({p[0].y(), p[1].y(), p[2].y()}))));
        for (int y = top; y <= bottom; ++y) {
            auto* line = reinterpret_cast<QRgb*>(image.scanLine(y));
            for (int x = left; x <= right; ++x) {
                const double px = x + 0.5, py = y + 0.5;
                const double a = ((p[1].x() - px) * (p[2].y() - py) - (p[1].y() - py) * (p[2].x() - px)) / area;
                const double b = ((p[2].x() - px) * (p[0].y() - py) - (p[2].y() - py) * (p[0].x() - px)) / area;
                const double c = 1.0 - a - b;
                if (a < 0.0 || b < 0.0 || c < 0.0) continue;
                const auto z = float(a * p[0].z() + b * p[1].z() + c * p[2].z());
                float& seen = depth[std::size_t(y) * std::size_t(image.width()) + std::size_t(x)];
                if (z <= seen) continue;
                seen = z;
                line[x] = color;
            }
        }
    }
};

}  // namespace

MeshPreview::MeshPreview(QWidget* parent) : QWidget(parent) {
    setMinimumSize(px(280), px(260));
    setCursor(Qt::OpenHandCursor);
    setAccessibleName(tr("Preview of the mesh"));
}

void MeshPreview::show(std::shared_ptr<const Result<ImportResult>> result) {
    result_ = std::move(result);
    draw();
}

void MeshPreview::draw() {
    picture_ = {};
    update();
    if (!result_ || !*result_ || (*result_)->bodies.empty() || width() < 2 || height() < 2) return;
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
    for (const ImportedBody& body : (*result_)->bodies) {
        if (body.mesh.body.vertices.rows() == 0) continue;
        low = low.cwiseMin(body.mesh.body.vertices.colwise().minCoeff().transpose());
        high = high.cwiseMax(body.mesh.body.vertices.colwise().maxCoeff().transpose());
    }
    const Vec3 centre = 0.5 * (low + high);
    const double radius = 0.5 * (high - low).norm();
    if (!(radius > 0.0) || !std::isfinite(radius)) return;

    // Twice the size of the screen's pixels, drawn smaller: smooth edges.
    const double ratio = 2.0 * devicePixelRatioF();
    Raster raster(int(width() * ratio), int(height() * ratio));
    const double cy = std::cos(yaw_), sy = std::sin(yaw_), cp = std::cos(pitch_), sp = std::sin(pitch_);
    Eigen::Matrix3d turn;  // world -> right, up, towards the eye
    turn << cy, 0.0, -sy, -sp * sy, cp, -sp * cy, cp * sy, sp, cp * cy;
    const double scale = kFill * 0.5 * std::min(raster.image.width(), raster.image.height()) / radius;
    const Vec3 middle(0.5 * raster.image.width(), 0.5 * raster.image.height(), 0.0);
    const auto project = [&](const Vec3& p) -> Vec3 {
        const Vec3 q = scale * (turn * (p - centre));
        return middle + Vec3(q.x(), -q.y(), q.z());
    };

    QPainter ground(&raster.image);
    ground.setRenderHint(QPainter::Antialiasing);
    QColor line = themeColor(Appearance::Role::Muted);
    line.setAlphaF(0.28f);
    ground.setPen(QPen(line, ratio * 0.6));
    const double step = std::pow(10.0, std::floor(std::log10(radius)));
    const int count = int(std::ceil(1.3 * radius / step));
    const Vec3 floor(std::round(centre.x() / step) * step, low.y(), std::round(centre.z() / step) * step);
    for (int i = -count; i <= count; ++i) {
        const auto edge = [&](const Vec3& a, const Vec3& b) {
            const Vec3 p = project(floor + step * a), q = project(floor + step * b);
            ground.drawLine(QPointF(p.x(), p.y()), QPointF(q.x(), q.y()));
        };
        edge(Vec3(i, 0, -count), Vec3(i, 0, count));
        edge(Vec3(-count, 0, i), Vec3(count, 0, i));
    }
    ground.end();

    const QColor usable = themeColor(Appearance::Role::Accent), refused = themeColor(Appearance::Role::Warning);
    const Vec3 light = Vec3(-0.35, 0.55, 0.75).normalized();
    for (const ImportedBody& body : (*result_)->bodies) {
        const QColor color = body.closed ? usable : refused;
        const auto& v = body.mesh.body.vertices;
        const auto& f = body.mesh.body.triangles;
        for (Eigen::Index t = 0; t < f.rows(); ++t) {
            const Vec3 a = v.row(f(t, 0)), b = v.row(f(t, 1)), c = v.row(f(t, 2));
            const Vec3 normal = turn * (b - a).cross(c - a);
            const double length = normal.norm();
            if (!(length > 0.0)) continue;
            const double shade = 0.32 + 0.68 * std::max(0.0, (normal.z() < 0.0 ? -1.0 : 1.0) * normal.dot(light) / length);
            raster.triangle({project(a), project(b), project(c)}, qRgb(int(color.red() * shade), int(color.green() * shade), int(color.blue() * shade)));
        }
    }
    picture_ = raster.image.scaled(raster.image.size() / 2, Qt::IgnoreAspectRatio, Qt::SmoothTransformation);
    picture_.setDevicePixelRatio(devicePixelRatioF());
}

void MeshPreview::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    QPainterPath shape;
    shape.addRoundedRect(QRectF(rect()).adjusted(0.5, 0.5, -0.5, -0.5), px(8), px(8));
    painter.fillPath(shape, themeColor(Appearance::Role::Panel));
    painter.setClipPath(shape);
    if (!picture_.isNull()) painter.drawImage(0, 0, picture_);
    painter.setClipping(false);
    painter.setPen(themeColor(Appearance::Role::Line));
    painter.drawPath(shape);
}

void MeshPreview::mousePressEvent(QMouseEvent* event) { last_ = event->position(); }

void MeshPreview::mouseMoveEvent(QMouseEvent* event) {
    const QPointF by = event->position() - last_;
    last_ = event->position();
    yaw_ -= 0.01 * by.x();
    pitch_ = std::clamp(pitch_ + 0.01 * by.y(), -1.5, 1.5);
    draw();
}

void MeshPreview::resizeEvent(QResizeEvent* event) {
    QWidget::resizeEvent(event);
    draw();
}

}  // namespace imomushi
