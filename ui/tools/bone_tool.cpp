// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/bone_tool.h"

#include <algorithm>

#include "ui/models/commands.h"
#include "ui/models/gesture.h"
#include "ui/models/paths.h"
#include "ui/models/texts.h"
#include "ui/scene/document_scene.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {
namespace {

/// Bodies are seen through while bones are placed in them.
constexpr float kXray = 0.45f;

/// Where the reference of an end finally leads: a face or a point.
Bone::Place resolved(const Document& document, Bone::Place place) {
    for (std::size_t i = 0; i <= document.bones.size(); ++i) {
        const auto* end = std::get_if<EndpointRef>(&place);
        if (!end) break;
        const auto bone = document.bones.find(end->bone);
        if (bone == document.bones.end()) break;
        place = end->atEnd ? bone->second->end : bone->second->start;
    }
    return place;
}

/// The end of a bone that is at this face or at one joined to it.
std::optional<EndpointRef> endAt(const Document& document, const FaceRef& face) {
    const Joint* joint = document.jointOf(face);
    const auto same = [&](const Bone::Place& place) {
        const Bone::Place at = resolved(document, place);
        const auto* other = std::get_if<FaceRef>(&at);
        if (!other) return false;
        return *other == face || (joint && std::find(joint->faces.begin(), joint->faces.end(), *other) != joint->faces.end());
    };
    for (const bool atEnd : {true, false})
        for (const auto& [id, bone] : document.bones)
            if (same(atEnd ? bone->end : bone->start)) return EndpointRef{id, atEnd};
    return std::nullopt;
}

std::string freeBoneName(const Document& document) {
    for (int n = 1;; ++n) {
        std::string name = "bone " + std::to_string(n);
        if (!document.boneNamed(name) && !document.elementNamed(name)) return name;
    }
}

/// On the left, where x is large of who looks along z, or on the right: free on both sides.
std::string freeSideName(const Document& document, bool left) {
    const auto taken = [&](const std::string& name) { return document.boneNamed(name) || document.elementNamed(name); };
    for (int n = 1;; ++n) {
        const std::string name = "bone " + std::to_string(n);
        if (!taken(name + ".L") && !taken(name + ".R")) return name + (left ? ".L" : ".R");
    }
}

}  // namespace

std::set<PartId> elementsAt(const Document& document, const Bone::Place& place) {
    std::set<PartId> elements;
    const Bone::Place at = resolved(document, place);
    if (const auto* face = std::get_if<FaceRef>(&at)) {
        elements.insert(face->element);
        if (const Joint* joint = document.jointOf(*face))
            for (const FaceRef& other : joint->faces) elements.insert(other.element);
    } else if (const auto* end = std::get_if<EndpointRef>(&place)) {
        // A point in the volume: the element that the bone runs through has it.
        const auto bone = document.bones.find(end->bone);
        if (bone != document.bones.end() && bone->second->element) elements.insert(bone->second->element);
    }
    return elements;
}

std::optional<BoneTool::Spot> BoneTool::spotAt(const EndpointRef& end) const {
    const auto shown = endpointPosition(document_.session(), end);
    const auto rest = endpointRestPosition(document_.document(), end);
    if (!shown || !rest) return std::nullopt;
    return Spot{end, *shown, *rest, elementsAt(document_.document(), end)};
}

std::optional<BoneTool::Spot> BoneTool::spotAt(const FaceRef& face) const {
    // A joint that has the end of a bone shares it, and so bones become chains.
    if (const auto end = endAt(document_.document(), face)) {
        auto spot = spotAt(*end);
        if (spot) spot->elements.merge(elementsAt(document_.document(), face));
        return spot;
    }
    const auto shown = facePosition(document_.session(), face);
    if (!shown) return std::nullopt;
    const Element& element = *document_.document().elements.at(face.element);
    return Spot{face, *shown, element.faces[std::size_t(element.faceIndex(face.face))].frame.origin,
                elementsAt(document_.document(), face)};
}

bool BoneTool::stillThere(const Spot& spot) const {
    if (const auto* face = std::get_if<FaceRef>(&spot.place)) {
        const auto element = document_.document().elements.find(face->element);
        return element != document_.document().elements.end() && element->second->faceIndex(face->face) >= 0;
    }
    if (const auto* end = std::get_if<EndpointRef>(&spot.place)) return document_.document().bones.contains(end->bone);
    return true;
}

// Centres of joint faces, also where a body hides them: it is seen through.
std::optional<FaceRef> BoneTool::faceUnder(const PointerEvent& e) const {
    const Session& session = document_.session();
    const Document& d = document_.document();
    double nearest = kFaceCentrePixels;
    std::optional<FaceRef> best;
    for (const auto& [id, element] : d.elements) {
        if (!element->visible || element->locked) continue;
        for (const JointFace& face : element->faces) {
            const auto at = shown(face).picked() ? facePosition(session, {id, face.name}) : std::nullopt;
            if (!at) continue;
            const Vec3 to = *at - e.rayOrigin;
            const double along = to.dot(e.rayDirection);
            if (along <= 0.0) continue;
            const double pixels = (to - along * e.rayDirection).norm() / e.pixelAt(*at);
            if (pixels >= nearest) continue;
            nearest = pixels;
            best = FaceRef{id, face.name};
        }
    }
    return best;
}

std::optional<BoneTool::Spot> BoneTool::spotUnder(const PointerEvent& e) const {
    const Session& session = document_.session();
    const Document& d = document_.document();
    PointerEvent seen = e;
    seen.bonesVisible = true;  // this tool shows them
    if (const auto end = pickEndpoint(session, seen)) return spotAt(*end);
    if (e.modifiers & Qt::ShiftModifier) return std::nullopt;

    if (const auto face = faceUnder(e)) return spotAt(*face);

    const auto hits = rayHits(session, e.rayOrigin, e.rayDirection);
    const auto entry = std::find_if(hits.begin(), hits.end(), [](const RayHit& hit) { return hit.entering; });
    if (entry == hits.end()) return std::nullopt;
    const Element& element = *d.elements.at(entry->element);
    if (const JointFace* face = faceOfTriangle(element, entry->triangle); face && shown(*face).picked()) return spotAt(FaceRef{entry->element, face->name});
    const auto exit = std::find_if(entry + 1, hits.end(),
                                   [&](const RayHit& hit) { return !hit.entering && hit.element == entry->element; });
    if (exit == hits.end()) return std::nullopt;
    const Vec3 rest = 0.5 * (entry->rest + exit->rest);
    return Spot{rest, 0.5 * (entry->point + exit->point), rest, {entry->element}};
}

std::optional<BoneDrag::Place> BoneTool::placeUnder(const PointerEvent& e) const {
    if (!dragged_) return std::nullopt;
    const Session& session = document_.session();
    const int own = session.pointIndex(*dragged_);
    PointerEvent seen = e;
    seen.bonesVisible = true;
    for (const EndpointRef& end : endpointsUnder(session, seen)) {
        // The other end of a bone is no place for this one.
        const bool same = session.pointIndex(end) == own || session.pointIndex({end.bone, !end.atEnd}) == own;
        if (const auto spot = same ? std::nullopt : spotAt(end)) return BoneDrag::Place{spot->place, spot->shown};
    }
    const auto face = faceUnder(e);
    const auto at = face ? facePosition(session, *face) : std::nullopt;
    return at ? std::optional(BoneDrag::Place{*face, *at}) : std::nullopt;
}

bool BoneTool::bonesSelected() const {
    return std::any_of(document_.selection().begin(), document_.selection().end(), [](const SelectionItem& item) { return item.kind == SelectionItem::Kind::Bone || item.kind == SelectionItem::Kind::Endpoint; });
}

void BoneTool::move(const PointerEvent& e) {
    last_ = e;
    if (drag_.busy()) return drag_.move(e, drag_.seeksPlace() ? placeUnder(e) : std::nullopt);
    part_ = gizmoPart(e);
    if (part_ != render::GizmoPart::None) {
        hovered_.reset();
        return document_.setHovered(std::nullopt);
    }
    hovered_ = spotUnder(e);
    if (start_ && !stillThere(*start_)) start_.reset();
    std::optional<SelectionItem> item;
    if (hovered_) {
        if (const auto* face = std::get_if<FaceRef>(&hovered_->place))
            item = SelectionItem{SelectionItem::Kind::Face, face->element, face->face, false};
        if (const auto* end = std::get_if<EndpointRef>(&hovered_->place))
            item = SelectionItem{SelectionItem::Kind::Endpoint, end->bone, {}, end->atEnd};
    }
    document_.setHovered(std::move(item));
}

render::GizmoPart BoneTool::gizmoPart(const PointerEvent& e) const {
    const auto place = gizmo();
    if (!place || (e.modifiers & Qt::ShiftModifier)) return render::GizmoPart::None;
    PointerEvent seen = e;
    seen.bonesVisible = true;
    return pickEndpoint(document_.session(), seen) ? render::GizmoPart::None : gizmoUnder(e, *place, space_);
}

void BoneTool::press(const PointerEvent& e) {
    if (e.button != Qt::LeftButton) return;
    if (drag_.busy()) return (void)drag_.keep();
    move(e);
    if (part_ != render::GizmoPart::None && drag_.press(part_, e)) return dragged_.reset();
    const auto* end = hovered_ && !(e.modifiers & Qt::ShiftModifier) ? std::get_if<EndpointRef>(&hovered_->place) : nullptr;
    if (end && drag_.press(*end, e)) {
        dragged_ = *end;
        return;
    }
    click(e);
}

// An end that is there is dragged, or clicked: which of both is known when the button is let go.
void BoneTool::release(const PointerEvent& e) {
    if (!drag_.busy() || drag_.modal() || e.button != Qt::LeftButton) return;
    if (!dragged_) return (void)drag_.keep();
    const EndpointRef end = *dragged_;
    if (!drag_.keep()) return click(e);
    document_.select({SelectionItem{SelectionItem::Kind::Endpoint, end.bone, {}, end.atEnd}});
    move(e);
}

void BoneTool::click(const PointerEvent& e) {
    move(e);
    if (!hovered_) return;
    if (!start_ || (e.modifiers & Qt::ShiftModifier)) {
        start_ = hovered_;
        return;
    }
    addBone(*start_, *hovered_);
    move(e);
}

void BoneTool::addBone(const Spot& from, const Spot& to) {
    const Document& d = document_.document();
    if (from == to || (to.rest - from.rest).norm() <= 0.0) {
        Q_EMIT document_.failed(ToolTexts::tr("A bone needs two different ends. Click somewhere else."));
        return;
    }
    // Through which element: one that both ends have; of several the first without a bone.
    PartId element = 0;
    bool taken = true;
    for (const PartId id : to.elements) {
        if (!from.elements.contains(id)) continue;
        const bool has = std::any_of(d.bones.begin(), d.bones.end(), [&](const auto& bone) { return bone.second->element == id; });
        if (element && !(taken && !has)) continue;
        element = id;
        taken = has;
    }
    // Of joined faces the one of that element is named.
    const auto path = [&](const Spot& spot) -> std::variant<std::string, Vec3> {
        if (const auto* end = std::get_if<EndpointRef>(&spot.place)) return pathOf(d, *end);
        if (const auto* point = std::get_if<Vec3>(&spot.place)) return *point;
        FaceRef face = std::get<FaceRef>(spot.place);
        if (const Joint* joint = element ? d.jointOf(face) : nullptr)
            for (const FaceRef& other : joint->faces)
                if (other.element == element) face = other;
        return pathOf(d, face);
    };
    const auto symmetry = symmetry_ ? std::optional(Symmetry::ofElement(d, element)) : std::nullopt;
    const double size = (to.rest - from.rest).norm();
    const bool mirrored = symmetry && !(symmetry->holds(from.rest, size) && symmetry->holds(to.rest, size));
    commands::NewBone wanted{mirrored ? freeSideName(d, from.rest.x() + to.rest.x() > 2.0 * symmetry->middle()) : freeBoneName(d), {}, path(from), path(to), {}};
    if (element) wanted.element = d.elements.at(element)->name;
    if (const auto* end = std::get_if<EndpointRef>(&from.place)) {
        const auto bone = d.bones.find(end->bone);
        const auto parent = end->atEnd || bone == d.bones.end() ? bone : d.bones.find(bone->second->parent);
        if (parent != d.bones.end()) wanted.parent = parent->second->name;
    }
    Gesture gesture(document_);
    if (!document_.execute(commands::addBone(wanted))) return;
    if (mirrored) mirror(*symmetry, wanted.name);
    gesture.commit({"add-bone", wanted.name});
    const Bone* bone = d.boneNamed(wanted.name);
    if (!bone) return;
    document_.select({SelectionItem{SelectionItem::Kind::Bone, bone->id, {}, false}});
    start_ = spotAt(EndpointRef{bone->id, true});
}

void BoneTool::mirror(const Symmetry& symmetry, const std::string& name) {
    const QString shown = QString::fromStdString(name);
    const auto answer = document_.execute(commands::mirrorAt({name}, symmetry.middle()), true);
    const auto tell = [&](const Error& error) { Q_EMIT document_.failed(ToolTexts::tr("“%1” was not mirrored as a whole: %2").arg(shown, errorText(error))); };
    if (!answer) return tell(answer.error());
    const Json& left = answer->at("not_mirrored");
    if (!left.empty()) tell({left[0].at("code").get<std::string>(), left[0].at("why").get<std::string>()});
}

bool BoneTool::key(int key, Qt::KeyboardModifiers modifiers, const QString& text) {
    if (drag_.busy()) return drag_.key(key, modifiers, text);
    if ((key == Qt::Key_G || (key == Qt::Key_R && turnKey_) || key == Qt::Key_S) && last_ && modifiers == Qt::NoModifier) {
        start_.reset();
        dragged_.reset();
        const auto does = key == Qt::Key_G ? BoneDrag::Does::Moves : key == Qt::Key_R ? BoneDrag::Does::Turns : BoneDrag::Does::Scales;
        if (document_.selection().size() == 1 && document_.selection().front().kind == SelectionItem::Kind::Endpoint) {
            dragged_ = EndpointRef{document_.selection().front().part, document_.selection().front().atEnd};
            return drag_.begin(BoneDrag::Does::Moves, *last_);
        }
        return drag_.begin(does, *last_);
    }
    if (!start_ || (key != Qt::Key_Return && key != Qt::Key_Enter)) return false;
    start_.reset();
    return true;
}

bool BoneTool::wants(int key) const {
    if (key == Qt::Key_Return || key == Qt::Key_Enter) return start_.has_value();
    if (drag_.busy()) return key == Qt::Key_G || key == Qt::Key_R || key == Qt::Key_S;
    return last_ && bonesSelected() && (key == Qt::Key_G || (key == Qt::Key_R && turnKey_) || key == Qt::Key_S);
}

void BoneTool::cancel() {
    if (drag_.busy()) return drag_.cancel();
    start_.reset();
    hovered_.reset();
}

QString BoneTool::hint() const {
    if (drag_.busy()) return drag_.hint();
    if (part_ != render::GizmoPart::None) return gizmoHint(part_);
    if (document_.document().elements.empty()) return ToolTexts::tr("Import a mesh first");
    if (start_) return ToolTexts::tr("Click: end of the bone · Esc: end the chain");
    if (hovered_ && std::holds_alternative<EndpointRef>(hovered_->place)) return ToolTexts::tr("Click: start of a bone · Drag: move this end");
    if (bonesSelected()) return ToolTexts::tr("Click: start of a bone · G, R, S: move, turn, scale the selected bones");
    return ToolTexts::tr("Click: start of a bone (joint face, end of a bone, or inside a body)");
}

void BoneTool::decorate(render::Scene& scene) const {
    for (render::Body& body : scene.bodies) body.opacity = std::min(body.opacity, kXray);
    if (drag_.busy()) return drag_.decorate(scene);
    if (const auto place = gizmo()) addGizmo(scene, *place, space_, part_);
    const auto point = [&](const Spot& spot) {
        render::Marker marker;
        marker.shape = render::Marker::Shape::JointPoint;
        marker.from = spot.shown;
        marker.hovered = true;
        scene.markers.push_back(std::move(marker));
    };
    if (start_ && hovered_ && !(*start_ == *hovered_)) {
        const auto show = [&](const Vec3& from, const Vec3& to) {
            render::Marker bone;
            bone.shape = render::Marker::Shape::Bone;
            bone.from = from;
            bone.to = to;
            bone.hovered = true;
            scene.markers.push_back(std::move(bone));
        };
        show(start_->shown, hovered_->shown);
        if (symmetry_) {
            const Symmetry symmetry = Symmetry::ofElement(document_.document(), start_->elements.empty() ? 0 : *start_->elements.begin());
            show(symmetry.point(start_->shown), symmetry.point(hovered_->shown));
        }
    }
    if (start_) point(*start_);
    if (hovered_) point(*hovered_);
}

}  // namespace imomushi
