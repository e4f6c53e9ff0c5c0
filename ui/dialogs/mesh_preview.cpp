// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/mesh_preview.h"

#include <QPainter>
#include <QPainterPath>
#include <cmath>

#include "core/mesh/bounds.h"
#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

constexpr double kFill = 0.84;  // room for the shadow

}  // namespace

MeshPreview::MeshPreview(QWidget* parent) : TurntableView(parent) {
    setMinimumSize(px(280), px(260));
    setAccessibleName(tr("Preview of the mesh"));
}

void MeshPreview::show(const Result<ImportResult>& result) {
    scene_.bodies.clear();
    positions_.clear();
    invalidate();
    if (!result) return;
    Eigen::AlignedBox3d box;
    for (const ImportedBody& body : result->bodies) {
        const Bounds bounds = boundsOf(body.mesh.body.vertices);
        if (body.mesh.body.vertices.rows() > 0) box.extend(Eigen::AlignedBox3d(bounds.low, bounds.high));
    }
    const double radius = box.isEmpty() ? 0.0 : 0.5 * box.diagonal().norm();
    if (!(radius > 0.0) || !std::isfinite(radius)) return;
    // Files may hold any size anywhere, single precision not: by a power of ten, so that the lines of the grid stay powers of ten of a metre.
    const double scale = std::pow(10.0, -std::floor(std::log10(radius)));
    const Vec3 centre = box.center();
    scene_.ground = scale * (box.min().y() - centre.y());
    for (const ImportedBody& body : result->bodies) {
        const Points& v = body.mesh.body.vertices;
        std::vector<float>& positions = positions_.emplace_back(std::size_t(v.size()));
        Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(positions.data(), v.rows(), 3) =
            (scale * (v.rowwise() - centre.transpose())).cast<float>();
        render::Body& drawn = scene_.bodies.emplace_back();
        drawn.id = scene_.bodies.size();
        drawn.mesh = std::make_shared<const ElementMesh>(ElementMesh{body.mesh.body, {}});  // its render mesh would hide what the colour says
        drawn.positions = positions.data();
        drawn.color = linearColor(themeColor(body.closed ? Appearance::Role::Accent : Appearance::Role::Warning));
        drawn.twoSided = !body.closed;
    }
}

void MeshPreview::drawPictures() { picture_ = drawn(size(), kFill); }

void MeshPreview::paint(QPainter& painter) {
    QPainterPath shape;
    shape.addRoundedRect(QRectF(rect()).adjusted(0.5, 0.5, -0.5, -0.5), px(8), px(8));
    painter.fillPath(shape, themeColor(Appearance::Role::Panel));
    painter.setClipPath(shape);
    if (!picture_.isNull()) painter.drawImage(0, 0, picture_);
    painter.setClipping(false);
    painter.setPen(themeColor(Appearance::Role::Muted));
    painter.drawText(rect().adjusted(px(16), px(16), -px(16), -px(16)), Qt::AlignCenter | Qt::TextWordWrap, failure());
    painter.setPen(themeColor(Appearance::Role::Line));
    painter.drawPath(shape);
}

}  // namespace imomushi
