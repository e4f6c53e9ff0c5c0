// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/face_tool.h"

#include <Eigen/Geometry>
#include <QScopedValueRollback>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/mesh/connectivity.h"
#include "core/mesh/topology.h"
#include "ui/models/commands.h"
#include "ui/models/gesture.h"
#include "ui/models/paths.h"
#include "ui/models/texts.h"
#include "ui/scene/posed_body.h"
#include "ui/tools/select_tool.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {
namespace {

/// Normals of a flat region: the 10 degrees of the contract of add-joint-face.
constexpr double kAngle = 10.0 * std::numbers::pi / 180.0;
/// The contract's tolerance, in parts of the element's diagonal; the wheel doubles and halves it.
constexpr double kTolerance = 1e-4;
constexpr int kMaxWidened = 11;  ///< 2^11 * 1e-4: a fifth of the diagonal
/// Centres of faces that meet lie within this part of their size: the contract's limit of join.
constexpr double kMeetDistance = 0.01;
/// Sizes and areas of faces that meet agree to this part; tessellations of one rim may differ.
constexpr double kMeetShape = 0.05;
/// Normals of faces that meet are opposite to within about 8 degrees.
constexpr double kMeetCosine = 0.99;

Vec3 corner(const TriangleMesh& mesh, std::int32_t triangle, int c) { return mesh.vertices.row(mesh.triangles(triangle, c)); }

Vec3 normalOf(const TriangleMesh& mesh, std::int32_t triangle) {
    return areaVector(mesh, triangle).stableNormalized();
}

/// The flat region of `mesh` that meets `face`, if there is one.
std::optional<JointFace> meetingRegion(const ElementMesh& whole, const JointFace& face) {
    const TriangleMesh& mesh = whole.body;
    std::int32_t seed = -1;
    double nearest = face.size;
    for (std::int32_t t = 0; t < mesh.triangles.rows(); ++t) {
        const Vec3 centre = (corner(mesh, t, 0) + corner(mesh, t, 1) + corner(mesh, t, 2)) / 3.0;
        const Vec3 d = centre - face.frame.origin;
        if (std::abs(face.frame.axes.col(2).dot(d)) > kMeetDistance * face.size || d.norm() >= nearest) continue;
        if (normalOf(mesh, t).dot(face.frame.axes.col(2)) > -kMeetCosine) continue;
        nearest = d.norm();
        seed = t;
    }
    if (seed < 0) return std::nullopt;
    const auto region = jointFaceBySeed(mesh, whole.connectivity().edges(), seed, kAngle, std::max(kMeetDistance * face.size, face.planarityError));
    if (!region || !facesMeet(face, *region)) return std::nullopt;
    return *region;
}

const JointFace* faceInTheWay(const Element& element, const JointFace& face) {
    for (const JointFace& other : element.faces) {
        std::vector<std::int32_t> shared;
        std::set_intersection(face.vertices.begin(), face.vertices.end(), other.vertices.begin(), other.vertices.end(),
                              std::back_inserter(shared));
        if (!shared.empty()) return &other;
    }
    return nullptr;
}

}  // namespace

bool facesMeet(const JointFace& a, const JointFace& b) {
    const double size = std::min(a.size, b.size);
    return (a.frame.origin - b.frame.origin).norm() <= kMeetDistance * size &&
           a.frame.axes.col(2).dot(b.frame.axes.col(2)) <= -kMeetCosine && std::abs(a.size - b.size) <= kMeetShape * size &&
           std::abs(a.area - b.area) <= kMeetShape * std::min(a.area, b.area);
}

std::string freeFaceName(const Element& element) {
    for (int n = 1;; ++n) {
        std::string name = "face " + std::to_string(n);
        if (element.faceIndex(name) < 0) return name;
    }
}

int joinNeighbours(StudioDocument& document, const FaceRef& ref) {
    const Document& d = document.document();
    const auto own = d.elements.find(ref.element);
    if (own == d.elements.end()) return 0;
    const int index = own->second->faceIndex(ref.face);
    if (index < 0) return 0;
    const JointFace face = own->second->faces[std::size_t(index)];
    std::vector<PartId> others;
    for (const auto& [id, element] : d.elements)
        if (id != ref.element && !element->locked) others.push_back(id);
    int count = 0;
    for (const PartId id : others) {
        const std::shared_ptr<const Element> element = d.elements.at(id);
        FaceRef partner;
        for (const JointFace& other : element->faces)
            if (facesMeet(face, other) && !d.jointOf(FaceRef{id, other.name})) partner = FaceRef{id, other.name};
        if (!partner.element) {
            const auto region = meetingRegion(*element->mesh, face);
            if (!region || faceInTheWay(*element, *region)) continue;
            const std::string name = freeFaceName(*element);
            if (!document.execute(commands::addJointFace(element->name, name, region->vertices))) continue;
            partner = FaceRef{id, name};
        }
        const auto answer = document.execute(commands::join(pathOf(d, ref), pathOf(d, partner)), true);
        if (answer)
            ++count;
        else
            Q_EMIT document.failed(ToolTexts::tr("The faces were not joined. %1").arg(errorText(answer.error())));
    }
    return count;
}

const Element* FaceTool::element() const {
    const auto found = document_.document().elements.find(element_);
    return found == document_.document().elements.end() || found->second != seen_ ? nullptr : found->second.get();
}

void FaceTool::look(PartId id) {
    clearPreview();
    const auto found = document_.document().elements.find(id);
    if (found == document_.document().elements.end()) return;
    element_ = id;
    seen_ = found->second;
}

double FaceTool::tolerance(const Element& element) const {
    return kTolerance * std::ldexp(1.0, widened_) * element.mesh->connectivity().diagonal();
}

Result<JointFace> FaceTool::flatRegion(const Element& element, std::int32_t triangle, const SectionFinder* finder) const {
    return jointFaceBySeed(element.mesh->body, finder ? finder->edges() : element.mesh->connectivity().edges(), triangle, kAngle, tolerance(element));
}

void FaceTool::clearPreview() {
    element_ = 0;
    seen_.reset();
    seed_ = -1;
    face_.reset();
    existing_.clear();
    refusal_.clear();
    cut_.reset();
    section_.reset();
    sectioned_.reset();
}

std::shared_ptr<const SectionFinder> FaceTool::sections(const std::shared_ptr<const Element>& element) { return sections_.of(element->mesh, element->mesh->body, waits_); }

void FaceTool::preview(const RayHit& hit) {
    look(hit.element);
    const Element* of = element();
    if (!of) return;
    seed_ = hit.triangle;
    seedRest_ = hit.rest;
    if (const JointFace* face = faceOfTriangle(*of, hit.triangle)) {
        if (shown(*face).picked()) existing_ = face->name;
        return;
    }
    // A tolerance that was asked for means a patch, wherever it is.
    const auto finder = widened_ == 0 ? sections(seen_) : nullptr;
    if (widened_ == 0 && !finder) return clearPreview();
    auto face = flatRegion(*of, hit.triangle, finder.get());
    if (finder && !(face && finder->isFacet(*face)))
        if (auto found = finder->across(hit.rest, normalOf(of->mesh->body, hit.triangle), hit.triangle)) return previewCut(finder, std::move(*found));
    setPreview(*of, std::move(face));
}

void FaceTool::previewPlane() {
    look(plane_->element);
    const Element* of = element();
    if (!of) {
        plane_.reset();
        return;
    }
    auto face = jointFaceByPlane(of->mesh->body, plane_->origin, plane_->normal, tolerance(*of));
    if (!face && face.error().code == "no-patch")
        if (const auto finder = sections(seen_)) {
            const CutPlane plane{plane_->origin, plane_->normal};
            if (auto outline = finder->at(plane)) return previewCut(finder, {plane, std::move(*outline)});
        }
    setPreview(*of, std::move(face));
}

void FaceTool::previewCut(std::shared_ptr<const SectionFinder> finder, SectionFinder::Across found) {
    cut_ = found.plane;
    section_ = std::move(found.outline);
    sectioned_ = std::move(finder);
}

void FaceTool::setPreview(const Element& of, Result<JointFace> face) {
    if (!face) {
        refusal_ = errorText(face.error());
        return;
    }
    face_ = std::move(*face);
    if (const JointFace* other = faceInTheWay(of, *face_))
        refusal_ = ToolTexts::tr("Touches the joint face \"%1\"").arg(QString::fromStdString(other->name));
}

void FaceTool::placePlane(const RayHit& hit) {
    const auto found = document_.document().elements.find(hit.element);
    if (found == document_.document().elements.end()) return;
    const TriangleMesh& body = found->second->mesh->body;
    Plane plane;
    plane.element = hit.element;
    plane.origin = hit.rest;
    plane.normal = normalOf(body, hit.triangle);
    // On a flat region the plane lies in it, anywhere else it crosses the flesh.
    const auto finder = sections(found->second);
    const auto patch = flatRegion(*found->second, hit.triangle, finder.get());
    if (finder && (!patch || !finder->isFacet(*patch)))
        if (const auto across = finder->across(hit.rest, plane.normal, hit.triangle)) {
            plane.origin = across->plane.origin;
            plane.normal = across->plane.normal;
        }
    const Session& session = document_.session();
    const int index = session.elementIndex(hit.element);
    Character* character = session.character();
    const Eigen::Quaterniond turn = character && index >= 0 ? Eigen::Quaterniond(character->frame(index).linear()) : Eigen::Quaterniond::Identity();
    plane.shownOrigin = hit.point + turn * (plane.origin - hit.rest);
    plane.shownNormal = turn * plane.normal;
    plane.turn = turn;
    plane_ = plane;
}

void FaceTool::press(const PointerEvent& e) {
    if (e.button != Qt::LeftButton) return;
    const QScopedValueRollback waits(waits_, true);
    if (edit_) return edit_.reset();
    if (drag_.modal()) return drag_.keep();
    if (drag_.busy()) return;
    if (brush_.on()) return brush_.press(e);
    if (!plane_ && !(e.modifiers & Qt::ShiftModifier)) {
        if (drag_.press(e)) return clearPreview();
        if (const auto item = pickCut(document_.session(), e)) {
            document_.select({*item});
            drag_.press(e);
            return;
        }
    }
    if (e.modifiers & Qt::ShiftModifier) {
        const auto hits = rayHits(document_.session(), e.rayOrigin, e.rayDirection);
        if (hits.empty()) return;
        placePlane(hits.front());
        plane_->dragging = true;
        previewPlane();
        return;
    }
    if (plane_) {
        create();
        return;
    }
    move(e);
    if (!existing_.empty()) {
        document_.select({SelectionItem{SelectionItem::Kind::Face, element_, existing_, false}});
        return;
    }
    if (!element_) {
        document_.select({});
        return;
    }
    create();
}

void FaceTool::move(const PointerEvent& e) {
    last_ = e;
    if (drag_.busy()) return drag_.move(e);
    if (edit_) return followPlane(e);
    if (brush_.on()) return brush_.move(e);
    brush_.end();
    if (plane_ && !plane_->dragging) return;
    overCut_ = !plane_ && drag_.over(e);
    if (!plane_)
        if (const auto item = pickCut(document_.session(), e); item || overCut_) {
            clearPreview();
            document_.setHovered(overCut_ ? document_.selection().front() : *item);
            return;
        }
    auto hits = rayHits(document_.session(), e.rayOrigin, e.rayDirection);
    if (plane_) {
        if (hits.empty()) return;
        placePlane(hits.front());
        plane_->dragging = true;
        previewPlane();
        return;
    }
    // Ctrl looks behind the front surface, where the faces lie with which elements touch each other.
    if ((e.modifiers & Qt::ControlModifier) && hits.size() > 1) hits.erase(hits.begin());
    if (hits.empty()) {
        clearPreview();
        document_.setHovered(std::nullopt);
        return;
    }
    const RayHit& hit = hits.front();
    // A cut follows the pointer within a triangle, too.
    if (!element() || hit.element != element_ || hit.triangle != seed_ || (cut_ && hit.rest != seedRest_)) preview(hit);
    if (!existing_.empty())
        document_.setHovered(SelectionItem{SelectionItem::Kind::Face, element_, existing_, false});
    else
        document_.setHovered(std::nullopt);
}

void FaceTool::release(const PointerEvent& e) {
    if (drag_.busy()) return drag_.release(e);
    if (e.button == Qt::LeftButton) brush_.release();
    if (plane_) plane_->dragging = false;
}

bool FaceTool::widen(int steps) {
    const int before = widened_;
    widened_ = std::clamp(widened_ + steps, 0, kMaxWidened);
    if (plane_)
        previewPlane();
    else if (widened_ != before && seed_ >= 0)
        preview({.element = PartId(element_), .triangle = std::int32_t(seed_), .rest = Vec3(seedRest_)});
    return true;
}

bool FaceTool::wheel(double notches, const PointerEvent& e) {
    if (brush_.on()) {
        brush_.widen(notches > 0.0 ? 1 : -1);
        return true;
    }
    // Without a placed plane the wheel zooms, as everywhere; Ctrl keeps it for the tolerance.
    if (!plane_ && !(e.modifiers & Qt::ControlModifier)) return false;
    const int steps = notches > 0.0 ? 1 : -1;
    if (!edited()) return widen(steps);
    grow(steps);
    return true;
}

bool FaceTool::key(int key, Qt::KeyboardModifiers modifiers, const QString& text) {
    const QScopedValueRollback waits(waits_, true);
    if (drag_.busy()) return drag_.key(key, text);
    if (edit_) {
        if (key == Qt::Key_Return || key == Qt::Key_Enter)
            edit_.reset();
        else if (key == Qt::Key_G || key == Qt::Key_R)
            editPlane(key == Qt::Key_R, PointerEvent(edit_->last));
        else if (edit_->typed.key(key, text, edit_->turns ? TypedNumber::Of::Angle : TypedNumber::Of::Length, {}))
            placeEdited();
        return true;
    }
    if ((key == Qt::Key_G || key == Qt::Key_R) && modifiers == Qt::NoModifier && plane_ && last_) return editPlane(key == Qt::Key_R, *last_);
    if ((key == Qt::Key_G || key == Qt::Key_R) && modifiers == Qt::NoModifier && !plane_ && last_) {
        if (!drag_.begin(key == Qt::Key_R, *last_)) return false;
        clearPreview();
        return true;
    }
    if (brush_.on()) return brushKey(key);
    if (edited() && editKey(key, modifiers)) return true;
    if ((key == Qt::Key_Delete || key == Qt::Key_Backspace) && !plane_) return removeSelection(document_);
    if (key == Qt::Key_Up || key == Qt::Key_Plus) return seed_ >= 0 || plane_ ? widen(1) : false;
    if (key == Qt::Key_Down || key == Qt::Key_Minus) return seed_ >= 0 || plane_ ? widen(-1) : false;
    if (cut_ && !plane_ && (key == Qt::Key_Return || key == Qt::Key_Enter)) {
        create();
        return true;
    }
    if (!plane_) return false;
    const double pace = (modifiers & Qt::ShiftModifier) ? 0.1 : 1.0;
    switch (key) {
        case Qt::Key_Return:
        case Qt::Key_Enter: create(); return true;
        case Qt::Key_Right:
        case Qt::Key_PageUp: movePlane(pace); return true;
        case Qt::Key_Left:
        case Qt::Key_PageDown: movePlane(-pace); return true;
        case Qt::Key_X:
        case Qt::Key_Y:
        case Qt::Key_Z: {
            // The axis nearest to the side that the plane faces already; once more turns it round.
            const Vec3 axis = Vec3::Unit(key - Qt::Key_X);
            const double along = axis.dot(plane_->normal);
            plane_->normal = std::abs(along) > 1.0 - 1e-9 ? Vec3(-plane_->normal) : Vec3(along < 0.0 ? -axis : axis);
            plane_->shownNormal = plane_->normal;
            previewPlane();
            return true;
        }
        default: return false;
    }
}

bool FaceTool::wants(int key) const {
    if (drag_.busy()) return key == Qt::Key_X || key == Qt::Key_Y || key == Qt::Key_Z;
    if (edit_) return key == Qt::Key_X || key == Qt::Key_Y || key == Qt::Key_Z;
    if ((key == Qt::Key_G || key == Qt::Key_R) && plane_) return last_.has_value();
    if (key == Qt::Key_G || key == Qt::Key_R) return !plane_ && last_ && document_.selection().size() == 1 && cutOf(document_.document(), document_.selection().front());
    if (brush_.on()) return key == Qt::Key_C || key == Qt::Key_Return || key == Qt::Key_Enter || key == Qt::Key_BracketLeft || key == Qt::Key_BracketRight;
    switch (key) {
        case Qt::Key_C:
        case Qt::Key_L: return edited().has_value();
        case Qt::Key_Up:
        case Qt::Key_Down:
        case Qt::Key_Plus:
        case Qt::Key_Minus: return plane_ || seed_ >= 0;
        case Qt::Key_Return:
        case Qt::Key_Enter: return plane_ || cut_;
        case Qt::Key_Left:
        case Qt::Key_Right:
        case Qt::Key_PageUp:
        case Qt::Key_PageDown:
        case Qt::Key_X:
        case Qt::Key_Y:
        case Qt::Key_Z: return plane_.has_value();
        default: return false;
    }
}

void FaceTool::create() {
    if (plane_) previewPlane();
    const Element* of = element();
    if (of && cut_) return cut();
    if (!of || !face_ || !refusal_.isEmpty()) {
        if (!refusal_.isEmpty()) Q_EMIT document_.failed(refusal_);
        return;
    }
    const std::string name = freeFaceName(*of);
    const Json command = plane_ ? commands::addJointFace(of->name, name, plane_->origin, plane_->normal, tolerance(*of)) : commands::addJointFace(of->name, name, face_->vertices);
    const PartId id = element_;
    Gesture gesture(document_);
    if (!document_.execute(command)) return;
    joinNeighbours(document_, FaceRef{id, name});
    gesture.commit();
    plane_.reset();
    document_.select({SelectionItem{SelectionItem::Kind::Face, id, name, false}});
    lookAgain();
}

void FaceTool::cut() {
    if (!cutting_.expired()) return;  // Enter twice
    const auto plane = std::make_shared<const CutPlane>(*cut_);
    const auto nearest = std::make_shared<std::optional<CutPlane>>();
    const PartId id = element_;
    const std::string name = element()->name;
    SlowStep step;
    step.command = commands::cut(name, plane->origin, plane->normal);
    step.done = [&document = document_, plane, tool = std::weak_ptr(itself_)](const Json& answer) {
        if (const auto alive = tool.lock()) {
            (*alive)->plane_.reset();
            (*alive)->clearPreview();
        }
        showCut(document, answer);
    };
    step.lookFurther = [nearest, id, at = *plane](const Document& document) { *nearest = nearestCut(document, id, 0, at); };
    step.refused = [&document = document_, nearest, plane, name](const Error& error) {
        const QString reason = errorText(error);
        if (!*nearest) return Q_EMIT document.failed(reason);
        Q_EMIT document.offered(reason + QLatin1Char(' ') + ToolTexts::tr("The nearest place that works is %1 away.").arg(lengthText(((*nearest)->origin - plane->origin).norm())),
                                ToolTexts::tr("Cut there"), commands::cut(name, (*nearest)->origin, (*nearest)->normal));
    };
    cutting_ = plane;
    document_.executeSlow(std::move(step));
}

void FaceTool::showCut(StudioDocument& document, const Json& answer) {
    const Json& elements = answer.at("elements");
    const std::string made = answer.at("cut").get<std::string>();
    if (const CharacterSource* character = document.document().characterOfCut(made))
        document.select({SelectionItem{SelectionItem::Kind::Cut, character->cuts[std::size_t(character->cutIndex(made))].id, {}, false}});
    Q_EMIT document.madeCut(ToolTexts::tr("Cut “%1” from “%2” and joined them.").arg(QString::fromStdString(elements[1].get<std::string>()), QString::fromStdString(elements[0].get<std::string>())));
}

void FaceTool::cancel() {
    // The plane stays, where it was.
    if (edit_) {
        plane_ = edit_->before;
        edit_.reset();
        return previewPlane();
    }
    if (brush_.on() || brush_.painting()) {
        brush_.cancel();
        if (!brush_.on()) lookAgain();
        return;
    }
    drag_.cancel();
    plane_.reset();
    clearPreview();
}

void FaceTool::decorate(render::Scene& scene) const {
    drag_.decorate(scene);
    brush_.decorate(scene);
    const Element* of = element();
    if (cut_ && section_ && of) {
        const PosedBody body(document_.session(), element_, *of);
        for (std::vector<Vec3>& loop : sectioned_->placed(*section_, [&](std::int32_t v) { return body.at(v); })) {
            render::Marker rim;
            rim.shape = render::Marker::Shape::FaceOutline;
            rim.from = rim.to = loop.front();
            rim.outline = std::move(loop);
            rim.hovered = true;
            scene.markers.push_back(std::move(rim));
        }
    }
    if (face_ && of) {
        if (render::Body* body = bodyOf(scene, *of)) body->highlightedTriangles = &face_->triangles;
        // The rim shows through bodies: regions are also chosen where elements touch.
        addRim(scene, document_.session(), element_, face_->triangles);
    }
    if (!plane_) return;
    render::Marker gizmo;
    gizmo.shape = render::Marker::Shape::PlaneGizmo;
    gizmo.from = plane_->shownOrigin;
    gizmo.to = plane_->shownOrigin + 0.25 * (of ? of->mesh->connectivity().diagonal() : 1.0) * plane_->shownNormal;
    scene.markers.push_back(std::move(gizmo));
}

}  // namespace imomushi
