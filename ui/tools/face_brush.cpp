// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/face_brush.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/document/face_references.h"
#include "core/joints/grown_vertices.h"
#include "core/mesh/connectivity.h"
#include "ui/models/commands.h"
#include "ui/models/paths.h"
#include "ui/models/texts.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {
namespace {

/// Radius of the brush, in parts of the element's diagonal; each notch of the wheel makes it a quarter of an octave larger or smaller.
constexpr double kBrush = 0.04;
constexpr double kNotchesToDouble = 4.0;
constexpr int kLeastWidened = -16, kMostWidened = 12;
/// Between two places of the pointer the brush touches the surface this often at most.
constexpr int kMostDabs = 64;

}  // namespace

std::optional<FaceRef> freeFace(const StudioDocument& document) {
    const auto& selection = document.selection();
    const Document& d = document.document();
    if (selection.size() != 1 || selection.front().kind != SelectionItem::Kind::Face) return std::nullopt;
    const FaceRef face{selection.front().part, selection.front().face};
    const auto element = d.elements.find(face.element);
    if (element == d.elements.end() || !shown(*element->second).picked() || !shownOf(d, selection.front()).picked() || !checkFree(d, face)) return std::nullopt;
    return face;
}

QString staleClause(const StudioDocument& document, PartId element) {
    const auto found = document.document().elements.find(element);
    if (found == document.document().elements.end() || document.session().responseState(element) != Session::ResponseState::Fresh) return {};
    return QStringLiteral(" · ") + ToolTexts::tr("“%1” must be precomputed again then").arg(QString::fromStdString(found->second->name));
}

bool FaceBrush::begin(const PointerEvent& e) {
    end();
    face_ = freeFace(document_);
    if (face_) look(e);
    return face_.has_value();
}

bool FaceBrush::on() const { return face_ && freeFace(document_) == face_; }

const Element* FaceBrush::element() const { return on() ? document_.document().elements.at(face_->element).get() : nullptr; }

double FaceBrush::radius(const Element& of) const { return kBrush * std::exp2(widened_ / kNotchesToDouble) * of.mesh->connectivity().diagonal(); }

void FaceBrush::look(const PointerEvent& e) {
    removing_ = stroke_ ? stroke_->removes : (e.modifiers & Qt::ControlModifier) != 0;
    hit_ = surfaceUnder(document_.session(), e);
    if (hit_ && hit_->element != face_->element) hit_.reset();
    if (hit_) pixel_ = e.pixelAt(hit_->point);
}

void FaceBrush::press(const PointerEvent& e) {
    const Element* of = element();
    if (!of || stroke_) return;
    look(e);
    Stroke stroke;
    stroke.mesh = of->mesh;
    stroke.surface = std::make_unique<SurfaceDistance>(of->mesh->body);
    stroke.in.resize(std::size_t(of->mesh->body.vertices.rows()), 0);
    stroke.others = stroke.in;
    for (const JointFace& face : of->faces)
        for (const std::int32_t v : face.vertices) (face.name == face_->face ? stroke.in : stroke.others)[std::size_t(v)] = 1;
    stroke.removes = (e.modifiers & Qt::ControlModifier) != 0;
    stroke.last = e;
    stroke_ = std::move(stroke);
    paint(e);
}

void FaceBrush::move(const PointerEvent& e) {
    if (!on()) return end();
    look(e);
    if (stroke_) paint(e);
}

// What lies between two events of a fast hand is painted, too.
void FaceBrush::paint(const PointerEvent& to) {
    const Element* of = element();
    if (!of || of->mesh != stroke_->mesh) return end();
    const PointerEvent from = std::exchange(stroke_->last, to);
    const double way = std::hypot(to.x - from.x, to.y - from.y), wide = pixel_ > 0.0 ? 0.5 * radius(*of) / pixel_ : way;
    const int dabs = std::clamp(int(std::ceil(way / std::max(1.0, wide))), 1, kMostDabs);
    for (int i = 1; i <= dabs; ++i) {
        PointerEvent e = to;
        const double share = double(i) / dabs;
        e.rayOrigin = from.rayOrigin + share * (to.rayOrigin - from.rayOrigin);
        e.rayDirection = (from.rayDirection + share * (to.rayDirection - from.rayDirection)).normalized();
        if (const auto hit = surfaceUnder(document_.session(), e); hit && hit->element == face_->element) dab(*hit);
    }
    judge();
}

void FaceBrush::dab(const RayHit& hit) {
    const TriangleMesh& body = stroke_->mesh->body;
    std::vector<SurfaceSource> sources;
    for (int c = 0; c < 3; ++c) {
        const std::int32_t v = body.triangles(hit.triangle, c);
        sources.emplace_back(v, (body.vertices.row(v).transpose() - hit.rest).norm());
    }
    const auto take = [&](std::int32_t v) {
        if (!stroke_->others[std::size_t(v)]) stroke_->in[std::size_t(v)] = stroke_->removes ? 0 : 1;
    };
    // However small the brush is, it takes what is under it.
    if (stroke_->removes)
        take(std::min_element(sources.begin(), sources.end(), [](const auto& a, const auto& b) { return a.second < b.second; })->first);
    else
        for (const auto& [v, distance] : sources) take(v);
    stroke_->surface->spread(sources, radius(*element()), [](std::int32_t, double) { return true; }, [&](std::int32_t v, double) { take(v); });
}

void FaceBrush::judge() {
    const TriangleMesh& body = stroke_->mesh->body;
    std::vector<std::int32_t> named;
    for (std::size_t v = 0; v < stroke_->in.size(); ++v)
        if (stroke_->in[v]) named.push_back(std::int32_t(v));
    stroke_->vertices = grownVertices(body, named, 0);
    stroke_->triangles = trianglesWithin(body, stroke_->vertices);
    stroke_->refusal.clear();
    if (stroke_->vertices.empty())
        stroke_->refusal = errorText({"nothing-left", {}});
    else if (const auto face = jointFaceByVertices(body, stroke_->vertices); !face)
        stroke_->refusal = errorText(face.error());
}

void FaceBrush::release() {
    if (!stroke_) return;
    const Element* of = element();
    const Stroke stroke = std::move(*stroke_);
    stroke_.reset();
    if (!of || of->mesh != stroke.mesh) return;
    if (!stroke.refusal.isEmpty()) return (void)Q_EMIT document_.failed(stroke.refusal);
    if (stroke.vertices == of->faces[std::size_t(of->faceIndex(face_->face))].vertices) return;
    document_.execute(commands::editJointFace(pathOf(document_.document(), *face_), stroke.vertices));
}

void FaceBrush::widen(int steps) { widened_ = std::clamp(widened_ + steps, kLeastWidened, kMostWidened); }

void FaceBrush::cancel() {
    if (!stroke_) return end();
    stroke_.reset();
}

QString FaceBrush::hint() const {
    const Element* of = element();
    if (!of) return {};
    if (stroke_) {
        const QString keys = ToolTexts::tr("Release: keep · Esc: take back");
        return stroke_->refusal.isEmpty() ? keys + staleClause(document_, face_->element) : stroke_->refusal + QStringLiteral(" · ") + keys;
    }
    return ToolTexts::tr("Drag: add to “%1” · Ctrl+drag: take away · Wheel: radius (%2) · C or Esc: put the brush away").arg(QString::fromStdString(face_->face), lengthText(radius(*of))) +
           staleClause(document_, face_->element);
}

void FaceBrush::decorate(render::Scene& scene) const {
    const Element* of = element();
    if (!of) return;
    if (stroke_) {
        if (render::Body* body = bodyOf(scene, *of); body && stroke_->mesh == of->mesh) body->highlightedTriangles = &stroke_->triangles;
        const std::size_t first = scene.markers.size();
        addRim(scene, document_.session(), face_->element, stroke_->triangles);
        for (std::size_t i = first; i < scene.markers.size(); ++i) scene.markers[i].refused = !stroke_->refusal.isEmpty();
    }
    if (!hit_) return;
    render::Marker circle;
    circle.shape = render::Marker::Shape::FaceOutline;
    circle.hovered = !removing_;
    circle.from = circle.to = hit_->point;
    const Vec3 x = hit_->normal.unitOrthogonal(), y = hit_->normal.cross(x);
    constexpr int kCorners = 48;
    for (int i = 0; i < kCorners; ++i) {
        const double turn = 2.0 * std::numbers::pi * i / kCorners;
        circle.outline.push_back(hit_->point + radius(*of) * (std::cos(turn) * x + std::sin(turn) * y));
    }
    scene.markers.push_back(std::move(circle));
}

}  // namespace imomushi
