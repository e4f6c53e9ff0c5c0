// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/touch_tool.h"

#include <algorithm>
#include <limits>
#include <span>

#include "core/base/finite.h"
#include "ui/models/commands.h"
#include "ui/models/texts.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {
namespace {

// Logical pixels: how deep a press goes at once, and how much deeper each notch of the wheel. The flesh gives way as far as it can, whatever is asked.
constexpr double kPokePixels = 12.0, kNotchPixels = 6.0;
/// Fingers are not pulled farther out of the surface than this: pushing in again should not take long.
constexpr double kOutsidePixels = 6.0;
/// Radius of finger tips, of the longest side of the character's box: what an effect that is turned on here begins with.
constexpr double kTip = 0.025;

/// A pen that presses by half of what it can does as much as a mouse.
double strengthOf(const PointerEvent& e) { return 2.0 * e.pressure; }

/// On where it is off, with tips that fit the character where it is off everywhere.
Json turnOn(const Document& document, const std::optional<std::string>& element) {
    const Json on = commands::enable(EffectKind::Touch, element);
    if (element) return on;
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const auto& [id, part] : document.elements) {
        low = low.cwiseMin(part->mesh->body.vertices.colwise().minCoeff().transpose());
        high = high.cwiseMax(part->mesh->body.vertices.colwise().maxCoeff().transpose());
    }
    const auto properties = effectDescriptor(EffectKind::Touch).properties;
    const auto tip = std::find_if(properties.begin(), properties.end(), [](const EffectProperty& p) { return p.name == "tip"; });
    const double radius = std::clamp(kTip * (high - low).maxCoeff(), tip->low, tip->high);
    return Json::array({on, commands::set(EffectKind::Touch, *tip, std::span(&radius, 1))});
}

}  // namespace

void TouchTool::begin() {
    if (!document_.document().elements.empty()) offer(0);
}

bool TouchTool::offer(PartId element) {
    const Document& d = document_.document();
    const bool on = element ? d.effects.has(EffectKind::Touch, element) : d.effects.has(EffectKind::Touch);
    if (!on) {
        std::optional<std::string> target;
        QString text = ToolTexts::tr("Fingers need the effect “Touch”.");
        if (d.effects.has(EffectKind::Touch)) {
            target = d.elements.at(element)->name;
            text = ToolTexts::tr("The effect “Touch” is off on “%1”.").arg(QString::fromStdString(*target));
        }
        Q_EMIT document_.offered(text, ToolTexts::tr("Turn on"), turnOn(d, target));
        return true;
    }
    const auto waits = [&](PartId id) {
        return d.effects.has(EffectKind::Touch, id) && !d.elements.at(id)->faces.empty() &&
               document_.session().responseState(id) != Session::ResponseState::Fresh;
    };
    const bool waiting = element ? waits(element) : std::any_of(d.elements.begin(), d.elements.end(), [&](const auto& e) { return waits(e.first); });
    if (waiting) Q_EMIT document_.offered(ToolTexts::tr("Fingers need a precompute first, about %1.").arg(durationText(document_.session().effectCost(EffectKind::Touch).seconds)), ToolTexts::tr("Precompute"), commands::precompute());
    return waiting;
}

void TouchTool::press(const PointerEvent& e) {
    if (modal() && e.button == Qt::LeftButton) return lift();
    if (!finger_ && e.button == Qt::LeftButton) poke(e);
}

void TouchTool::poke(const PointerEvent& e) {
    const auto hit = surfaceUnder(document_.session(), e);
    if (!hit || offer(hit->element)) return;
    Finger finger;
    finger.gesture = std::make_unique<Gesture>(document_);
    finger.element = hit->element;
    finger.rest = hit->rest;
    finger.pressed = finger.surface = finger.grip = hit->point;
    finger.strength = strengthOf(e);
    finger.inward = -hit->normal;
    finger.across = e.viewForward;
    finger.pixel = e.pixelAt(hit->point);
    finger.depth = kPokePixels * finger.pixel;
    finger.lastY = e.y;
    finger_ = std::move(finger);
    hovered_.reset();
    issue();
}

bool TouchTool::issue() {
    const auto element = document_.document().elements.find(finger_->element);
    if (element != document_.document().elements.end() && allFinite(finger_->tip()) &&
        document_.execute(commands::touch(element->second->name, finger_->rest, finger_->tip())))
        return true;
    cancel();
    return false;
}

void TouchTool::move(const PointerEvent& e) {
    last_ = e;
    if (!finger_) {
        document_.setHovered(std::nullopt);
        hovered_ = surfaceUnder(document_.session(), e);
        return;
    }
    Finger& finger = *finger_;
    const double pace = e.pace();
    const Vec3 under = e.onPlane(finger.grip, finger.across, finger.grip);
    if (e.modifiers & Qt::ControlModifier)
        finger.depth = std::max(-kOutsidePixels * finger.pixel, finger.depth + pace * (e.y - finger.lastY) * finger.pixel);
    else
        finger.surface += pace * (under - finger.grip);
    finger.grip = under;
    finger.lastY = e.y;
    finger.strength = strengthOf(e);
    issue();
}

bool TouchTool::wheel(double notches, const PointerEvent& e) {
    if (!finger_) return false;
    const double pace = e.pace();
    finger_->depth = std::max(-kOutsidePixels * finger_->pixel, finger_->depth + pace * notches * kNotchPixels * finger_->pixel);
    issue();
    return true;
}

bool TouchTool::key(int key, Qt::KeyboardModifiers modifiers, const QString& text) {
    if (!finger_) {
        if (key != Qt::Key_G || modifiers != Qt::NoModifier || !hovered_ || !last_) return false;
        poke(PointerEvent(*last_));
        if (finger_) finger_->modal = true;
        return true;
    }
    if (finger_->modal && (key == Qt::Key_Return || key == Qt::Key_Enter)) {
        lift();
        return true;
    }
    if (finger_->typed.key(key, text, TypedNumber::Of::Length, {})) issue();
    return true;
}

void TouchTool::release(const PointerEvent& e) {
    if (finger_ && !finger_->modal && e.button == Qt::LeftButton) lift();
}

void TouchTool::lift() {
    const auto element = document_.document().elements.find(finger_->element);
    if (element != document_.document().elements.end())
        document_.execute(commands::touch(element->second->name, finger_->rest, std::nullopt));
    finger_->gesture->commit();
    finger_.reset();
}

void TouchTool::cancel() { finger_.reset(); }  // its gesture takes the commands back

QString TouchTool::hint() const {
    if (modal()) return ToolTexts::tr("Move: push along · Wheel, Ctrl or a typed number: depth · Shift: fine · Click or Enter: lift · Esc: take back");
    if (finger_) return ToolTexts::tr("Move: push along · Wheel, Ctrl+drag or a typed number: depth · Shift: fine · Esc: take back");
    const Document& d = document_.document();
    if (d.elements.empty()) return {};
    if (!d.effects.has(EffectKind::Touch)) return ToolTexts::tr("The effect “Touch” is off. Click the surface to be asked about it");
    return ToolTexts::tr("Press and hold, or G: poke a finger into the surface");
}

void TouchTool::decorate(render::Scene& scene) const {
    if (!finger_ && !hovered_) return;
    render::Marker marker;
    marker.shape = finger_ ? render::Marker::Shape::HeldPoint : render::Marker::Shape::JointPoint;
    marker.from = marker.to = finger_ ? finger_->tip() : hovered_->point;
    marker.hovered = !finger_;
    scene.markers.push_back(std::move(marker));
}

}  // namespace imomushi
