// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/handle_tool.h"

#include <algorithm>
#include <cmath>

#include "core/commands/handle_commands.h"
#include "core/mesh/connectivity.h"
#include "ui/models/commands.h"
#include "ui/models/texts.h"
#include "ui/tools/select_tool.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {
namespace {

/// Each step of the brush makes a disc this much larger: eight of them about four times.
constexpr double kStep = 1.2;
/// From about a twentieth of the size by default to the largest that there is.
constexpr int kLeast = -16, kMost = 12;

}  // namespace

const Element* HandleTool::element() const {
    if (!hit_) return nullptr;
    const auto found = document_.document().elements.find(hit_->element);
    return found == document_.document().elements.end() || found->second != seen_ ? nullptr : found->second.get();
}

double HandleTool::radius(const Element& of) const {
    return std::min(kDefaultHandleRadius * std::pow(kStep, grown_), kLargestHandleRadius) * of.mesh->connectivity().diagonal();
}

void HandleTool::preview(const std::optional<RayHit>& hit) {
    hit_ = hit;
    seen_.reset();
    face_.reset();
    refusal_.clear();
    const auto found = hit ? document_.document().elements.find(hit->element) : document_.document().elements.end();
    if (found == document_.document().elements.end()) return;
    seen_ = found->second;
    auto face = handleFace(*seen_, hit->rest, radius(*seen_));
    if (face)
        face_ = std::move(*face);
    else
        refusal_ = errorText(face.error());
}

void HandleTool::press(const PointerEvent& e) {
    if (edit_.busy() && e.button == Qt::LeftButton) return edit_.keep();
    if (busy() || e.button != Qt::LeftButton) return;
    move(e);
    if (grip_) return pose_.grab(*grip_, e);
    const Element* of = element();
    if (!of) return document_.select({});
    if (!face_) {
        if (!refusal_.isEmpty()) Q_EMIT document_.failed(refusal_);
        return;
    }
    const PartId id = of->id;
    const auto made = make(*of);
    preview(std::nullopt);
    if (!made) return;
    grip_ = PoseGrip{{}, {id, *made}};
    pose_.grab(*grip_, e);
}

std::optional<std::string> HandleTool::make(const Element& of) {
    const std::string element = of.name;
    Gesture gesture(document_);
    Json command = commands::addHandle(element, hit_->rest, radius(of));
    if (of.faces.empty()) command["hold"] = true;
    const auto made = document_.execute(command);
    if (!made) return std::nullopt;
    const std::string name = made->at("name").get<std::string>();
    const Json held = made->value("held", Json::array());
    // What is pulled far keeps its volume.
    if (!held.empty() && !document_.document().effects.has(EffectKind::BendWarp)) document_.execute(commands::enable(EffectKind::BendWarp, {}, true));
    gesture.commit({"handle", name});
    if (held.empty()) return name;
    Json letGo = Json::array();
    for (const Json& one : held) letGo.push_back(commands::removeHandle(one.get<std::string>()));
    Q_EMIT document_.offered(ToolTexts::tr("“%1” is held where it stands, so that handles bend it.").arg(QString::fromStdString(element)), ToolTexts::tr("Let it go"), letGo);
    return name;
}

void HandleTool::move(const PointerEvent& e) {
    last_ = e;
    if (edit_.busy()) return edit_.move(e);
    if (busy()) return pose_.move(e);
    const Session& session = document_.session();
    grip_ = pickGrip(session, e);
    document_.setHovered(grip_ ? std::optional(grip_->item()) : std::nullopt);
    preview(grip_ ? std::nullopt : surfaceUnder(session, e));
}

void HandleTool::leave() {
    grip_.reset();
    preview(std::nullopt);
}

void HandleTool::doubleClick(const PointerEvent& e) {
    if (pickGrip(document_.session(), e))
        pose_.doubleClick(e);
    else
        press(e);
}

void HandleTool::grow(int steps) {
    grown_ = std::clamp(grown_ + steps, kLeast, kMost);
    preview(std::optional(hit_));
}

bool HandleTool::wheel(double notches, const PointerEvent& e) {
    if (edit_.busy()) return false;
    if (busy()) return pose_.wheel(notches, e);
    // Without Ctrl the wheel zooms, as everywhere.
    if (!(e.modifiers & Qt::ControlModifier)) return false;
    grow(notches > 0.0 ? 1 : -1);
    return true;
}

bool HandleTool::key(int key, Qt::KeyboardModifiers modifiers, const QString& text) {
    if (edit_.busy()) return edit_.key(key, text);
    if (busy()) return pose_.key(key, modifiers, text);
    if ((key == Qt::Key_G || key == Qt::Key_S) && modifiers == Qt::NoModifier && last_) {
        if (!edit_.begin(key == Qt::Key_G ? HandleEdit::Does::Moves : HandleEdit::Does::Scales, *last_)) return false;
        leave();
        return true;
    }
    if (key == Qt::Key_BracketLeft || key == Qt::Key_BracketRight) {
        grow(key == Qt::Key_BracketRight ? 1 : -1);
        return true;
    }
    if (key == Qt::Key_P && grip_) {
        document_.execute(commands::setPinned(pathOf(document_.document(), *grip_), !isPinned(document_.document(), *grip_)));
        return true;
    }
    if (key == Qt::Key_Delete || key == Qt::Key_Backspace) {
        if (!removeSelection(document_)) return false;
        leave();
        return true;
    }
    return false;
}

bool HandleTool::wants(int key) const {
    if (edit_.busy()) return true;
    if (busy()) return pose_.wants(key);
    if (key == Qt::Key_G || key == Qt::Key_S) return last_ && document_.selection().size() == 1 && handleOf(document_.document(), document_.selection().front());
    return key == Qt::Key_BracketLeft || key == Qt::Key_BracketRight || (key == Qt::Key_P && grip_);
}

void HandleTool::cancel() {
    edit_.cancel();
    pose_.cancel();
    leave();
}

QString HandleTool::hint() const {
    if (edit_.busy()) return edit_.hint();
    if (busy()) return pose_.hint();
    if (grip_) return ToolTexts::tr("Drag: pose · P: pin · Delete: remove the selected");
    if (!refusal_.isEmpty()) return refusal_;
    const Element* of = element();
    if (!of) return document_.document().elements.empty() ? QString() : ToolTexts::tr("Press on a body: a handle, dragged at once");
    return ToolTexts::tr("Press: handle · Drag on: pose · [ ] or Ctrl+wheel: radius (%1)").arg(lengthText(radius(*of)));
}

void HandleTool::decorate(render::Scene& scene) const {
    if (edit_.busy()) return edit_.decorate(scene);
    if (busy()) return pose_.decorate(scene);
    const Element* of = element();
    if (!face_ || !of) return;
    if (render::Body* body = bodyOf(scene, *of)) body->highlightedTriangles = &face_->triangles;
    addRim(scene, document_.session(), of->id, face_->triangles);
}

}  // namespace imomushi
