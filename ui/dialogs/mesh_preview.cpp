// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/mesh_preview.h"

#include <QPainter>
#include <QPainterPath>
#include <cmath>

#include "core/body/section.h"
#include "core/mesh/bounds.h"
#include "ui/viewport/picture_warm_up.h"
#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

constexpr double kFill = 0.84;  // room for the shadow

}  // namespace

MeshPreview::MeshPreview(QWidget* parent) : TurntableView(parent) {
    setMinimumSize(px(280), px(200));
    setAccessibleName(tr("Preview of the mesh"));
    PictureWarmUp::instance().begin();  // while the file is read
}

double MeshPreview::place(const Eigen::AlignedBox3d& box) {
    scene_.bodies.clear();
    scene_.markers.clear();
    positions_.clear();
    invalidate();
    const double radius = box.isEmpty() ? 0.0 : 0.5 * box.diagonal().norm();
    if (!(radius > 0.0) || !std::isfinite(radius)) return 0.0;
    // Files may hold any size anywhere, single precision not: by a power of ten, so that the lines of the grid stay powers of ten of a metre.
    const double scale = std::pow(10.0, -std::floor(std::log10(radius)));
    scene_.ground = scale * (box.min().y() - box.center().y());
    return scale;
}

const float* MeshPreview::placed(const Points& v, double scale, const Vec3& centre) {
    std::vector<float>& positions = positions_.emplace_back(std::size_t(v.size()));
    Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(positions.data(), v.rows(), 3) = (scale * (v.rowwise() - centre.transpose())).cast<float>();
    return positions.data();
}

void MeshPreview::show(const Result<ImportResult>& result) {
    Eigen::AlignedBox3d box;
    if (result)
        for (const ImportedBody& body : result->bodies)
            if (body.mesh.body.vertices.rows() > 0) {
                const Bounds bounds = boundsOf(body.mesh.body.vertices);
                box.extend(Eigen::AlignedBox3d(bounds.low, bounds.high));
            }
    const double scale = place(box);
    if (scale == 0.0) return;
    for (const ImportedBody& body : result->bodies) {
        render::Body& drawn = scene_.bodies.emplace_back();
        drawn.id = scene_.bodies.size();
        drawn.mesh = std::make_shared<const ElementMesh>(ElementMesh{body.mesh.body, {}});  // its render mesh would hide what the colour says
        drawn.positions = placed(body.mesh.body.vertices, scale, box.center());
        drawn.color = linearColor(themeColor(body.closed ? Appearance::Role::Accent : Appearance::Role::Warning));
        drawn.twoSided = !body.closed;
    }
}

void MeshPreview::show(const CharacterFile& file, const Body* body, const Proposal* proposal) {
    const ElementMesh& mesh = file.renderModel.mesh;
    Eigen::AlignedBox3d box;
    for (Eigen::Index i = 0; i < mesh.body.triangles.size(); ++i) box.extend(Vec3(mesh.body.vertices.row(mesh.body.triangles.data()[i])));  // other vertices may be anywhere
    const double scale = place(box);
    if (scale == 0.0) return;
    render::Body& drawn = scene_.bodies.emplace_back();
    drawn.id = 1;
    drawn.mesh = std::make_shared<const ElementMesh>(mesh);
    drawn.positions = placed(mesh.body.vertices, scale, box.center());
    drawn.color = linearColor(themeColor(Appearance::Role::Accent));
    drawn.twoSided = true;
    if (!body) return;
    if (proposal) addProposal(body->mesh, *proposal, scale, box.center());
    const auto mark = [&](const Vec3& place) {
        render::Marker& marker = scene_.markers.emplace_back();
        marker.shape = render::Marker::Shape::HeldPoint;
        marker.from = marker.to = scale * (place - box.center());
    };
    for (const FleshLink& link : body->report.links) mark(0.5 * (link.from + link.to));
    for (const Vec3& gap : body->report.gaps.places) mark(gap);
}

void MeshPreview::addProposal(const TriangleMesh& body, const Proposal& proposal, double scale, const Vec3& centre) {
    using Shape = render::Marker::Shape;
    const auto add = [&](Shape shape, const Vec3& from, const Vec3& to) -> render::Marker& {
        render::Marker& marker = scene_.markers.emplace_back();
        marker.shape = shape;
        marker.from = scale * (from - centre);
        marker.to = scale * (to - centre);
        return marker;
    };
    const CutSurface surface(body);
    for (const ProposedCut& cut : proposal.cuts) {
        const auto section = findSection(surface, cut.plane);
        if (!section) continue;
        for (const auto& loop : section->loops) {
            render::Marker& rim = add(Shape::FaceOutline, cut.plane.origin, cut.plane.origin);
            for (const SectionPoint& point : loop) rim.outline.push_back(scale * (point.place - centre));
        }
    }
    for (const ProposedBone& bone : proposal.bones) add(Shape::Bone, bone.start, bone.end);
    for (const ProposedPin& pin : proposal.pins) {
        const ProposedBone& bone = proposal.bones[std::size_t(pin.bone)];
        const Vec3& at = pin.atEnd ? bone.end : bone.start;
        add(Shape::PinnedPoint, at, at);
    }
    for (const ProposedHandle& handle : proposal.handles) add(handle.pinned ? Shape::PinnedPoint : Shape::JointPoint, handle.point, handle.point);
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
