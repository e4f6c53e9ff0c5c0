// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/pose_tool.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/finite.h"
#include "core/commands/handle_commands.h"
#include "core/mesh/connectivity.h"
#include "ui/models/commands.h"
#include "ui/models/paths.h"
#include "ui/picking/picking.h"
#include "ui/tools/pose_fingers.h"
#include "ui/tools/select_tool.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {
namespace {

constexpr double kRadiansPerPixel = 0.5 * std::numbers::pi / 180.0;
constexpr double kRadiansPerNotch = 5.0 * std::numbers::pi / 180.0;
/// A passing handle is as large as others are at first, or this many times halved where something is in its way.
constexpr int kHalvings = 3;

/// Where the pointer is in the plane of a drag. Rays that nearly run along that plane lead far away at once: what was there before stays.
Vec3 pointerOn(const PointerEvent& e, const Vec3& point, const Vec3& normal) {
    constexpr double kGrazing = 0.035;  // sine of two degrees
    return std::abs(normal.dot(e.rayDirection)) > kGrazing ? e.onPlane(point, normal, point) : point;
}

}  // namespace

std::optional<PoseGrip> PoseTool::gripUnder(const PointerEvent& e) const {
    const Session& session = document_.session();
    if (const auto grip = pickGrip(session, e)) return grip;
    const auto hits = rayHits(session, e.rayOrigin, e.rayDirection);
    return hits.empty() ? std::nullopt : nearestGrip(session, hits.front().element, hits.front().point);
}

std::optional<RayHit> PoseTool::fleshUnder(const PointerEvent& e) const {
    const Session& session = document_.session();
    // Another handle is another character, which would end a recording.
    if (!options_.passingHandles || session.recording() || pickGrip(session, e)) return std::nullopt;
    const auto hits = rayHits(session, e.rayOrigin, e.rayDirection);
    if (hits.empty()) return std::nullopt;
    const Element& element = *session.document().elements.at(hits.front().element);
    if (faceOfTriangle(element, hits.front().triangle) || !options_.passingHandles(element)) return std::nullopt;
    return hits.front();
}

void PoseTool::press(const PointerEvent& e) {
    if (modal() && e.button == Qt::LeftButton) return keep();
    if (busy() || e.button != Qt::LeftButton) return;
    if (!takeHold(e)) selectByClick(document_, pickItem(document_.session(), e), e.modifiers);
}

bool PoseTool::takeHold(const PointerEvent& e) {
    letGo_.reset();
    if (const auto part = gizmoPart(e); part != render::GizmoPart::None) {
        pull(part, e);
        return true;
    }
    if (!pickGrip(document_.session(), e) && part_.press(e)) return true;
    if (const auto flesh = fleshUnder(e)) {
        flesh_ = Flesh{*flesh, e};
        return true;
    }
    const auto grip = gripUnder(e);
    if (!grip || !gripPosition(document_.session(), *grip)) return false;
    grab(*grip, e);
    return true;
}

void PoseTool::grab(const PoseGrip& grip, const PointerEvent& e) {
    const auto at = gripPosition(document_.session(), grip);
    if (!at) return;
    const SelectionItem item = grip.item();
    if (!(e.modifiers & Qt::ShiftModifier) || !document_.isSelected(item)) selectByClick(document_, item, e.modifiers);
    take(grip, *at, e);
}

std::optional<PoseGrip> PoseTool::selectedGrip() const {
    if (document_.selection().size() != 1) return std::nullopt;
    const SelectionItem& item = document_.selection().front();
    if (!shownOf(document_.document(), item).picked()) return std::nullopt;
    if (item.kind == SelectionItem::Kind::Endpoint) return PoseGrip{holdingEndpoint(document_.session(), {item.part, item.atEnd}), {}};
    if (handleOf(document_.document(), item)) return PoseGrip{{}, {item.part, item.face}};
    return std::nullopt;
}

bool PoseTool::grabSelected(const PointerEvent& e, bool turns) {
    const auto grip = selectedGrip();
    const auto at = grip ? gripPosition(document_.session(), *grip) : std::nullopt;
    if (!at || busy()) return false;
    take(*grip, *at, e);
    drag_->modal = true;
    turning_ = turns;
    return true;
}

bool PoseTool::makePassing(const Flesh& flesh) {
    const Session& session = document_.session();
    const auto found = document_.document().elements.find(flesh.hit.element);
    if (found == document_.document().elements.end()) return false;
    const std::shared_ptr<const Element> element = found->second;
    Passing made{element->name, flesh.hit.rest, kDefaultHandleRadius * element->mesh->connectivity().diagonal(), false};
    auto patch = handleFace(*element, made.point, made.radius);
    for (int i = 0; i < kHalvings && !patch; ++i) patch = handleFace(*element, made.point, made.radius *= 0.5);
    if (!patch) return false;
    // It takes the flesh where it is, and as it is turned there.
    const HandlePose pose = poseOfFlesh(session, *element, *patch);
    auto gesture = std::make_unique<Gesture>(document_);
    const auto answer = document_.execute(commands::addHandle(made.element, made.point, made.radius));
    if (!answer) return false;
    const PoseGrip grip{{}, {element->id, answer->at("name").get<std::string>()}};
    if (!document_.execute(commands::dragHandle(grip.handle.face, pose.at, pose.rotation))) return false;
    take(grip, pose.at, flesh.press);
    drag_->grip = flesh.hit.point;
    drag_->gesture = std::move(gesture);
    drag_->passing = std::move(made);
    return true;
}

void PoseTool::bringBack() {
    const LetGo last = *std::exchange(letGo_, std::nullopt);
    Gesture gesture(document_);
    const auto answer = document_.execute(commands::addHandle(last.passing.element, last.passing.point, last.passing.radius));
    if (!answer) return;
    const std::string name = answer->at("name").get<std::string>();
    if (!document_.execute(commands::dragHandle(name, last.at, last.rotation))) return;
    gesture.commit();
    if (const auto handle = document_.document().handle(name)) document_.select({PoseGrip{{}, *handle}.item()});
}

void PoseTool::take(const PoseGrip& grip, const Vec3& at, const PointerEvent& e) {
    hovered_ = grip;
    document_.setHovered(grip.item());
    Drag drag;
    drag.end = grip;
    drag.origin = drag.target = at;
    drag.pressX = drag.lastX = e.x;
    drag.pressY = drag.lastY = e.y;
    drag.normal = e.viewForward;
    drag.grip = e.onPlane(at, drag.normal, at);
    drag.lock.setFrame(gizmoAxes(options_.space, axesOf(grip), e.viewForward, e.viewRight));
    if (grip.isHandle()) {
        if (const auto pose = document_.session().poseOf(grip.handle)) drag.rotation = drag.fromRotation = pose->rotation;
    } else if (const auto held = document_.document().goals.find(grip.end); held != document_.document().goals.end()) {
        drag.roll = held->second.roll;
        drag.fromRoll = drag.roll.value_or(0.0);
    }
    if (options_.symmetry) {
        const Document& d = document_.document();
        drag.symmetry = grip.isHandle() ? Symmetry::ofElement(d, grip.handle.element) : Symmetry::ofBone(d, grip.end.bone);
        drag.image = drag.symmetry->imageOf(document_.session(), grip);
        if (drag.image && gripPosition(document_.session(), *drag.image) == gripPosition(document_.session(), grip)) drag.image.reset();
        drag.alone = !drag.image && !drag.symmetry->central(d, grip);
    }
    drag_ = std::move(drag);
    last_ = e;
    snap_.begin(moving());
}

bool PoseTool::takeFlesh() {
    const Flesh flesh = *std::exchange(flesh_, std::nullopt);
    if (makePassing(flesh)) return true;
    const auto grip = nearestGrip(document_.session(), flesh.hit.element, flesh.hit.point);
    if (grip) grab(*grip, flesh.press);
    return grip.has_value();
}

void PoseTool::move(const PointerEvent& e) {
    if (fingersHold()) return;
    if (part_.busy()) return part_.move(e);
    if (flesh_) {
        if (std::hypot(e.x - flesh_->press.x, e.y - flesh_->press.y) < kDragPixels) return;
        if (!takeFlesh()) return;
    }
    if (!drag_) {
        over_ = e;
        hoveredPart_ = gizmoPart(e);
        if (hoveredPart_ != render::GizmoPart::None) {
            hovered_.reset();
            overFlesh_ = false;
            return document_.setHovered(std::nullopt);
        }
        if (!pickGrip(document_.session(), e) && part_.hover(e)) {
            hovered_.reset();
            overFlesh_ = false;
            return document_.setHovered(std::nullopt);
        }
        part_.leave();
        overFlesh_ = fleshUnder(e).has_value();
        hovered_ = overFlesh_ ? std::nullopt : gripUnder(e);
        if (hovered_)
            document_.setHovered(hovered_->item());
        else
            document_.setHovered(pickItem(document_.session(), e));
        return;
    }
    if (!drag_->gesture) {
        if (std::hypot(e.x - drag_->pressX, e.y - drag_->pressY) < kDragPixels) return;
        drag_->gesture = std::make_unique<Gesture>(document_);
    }
    follow(e);
    issue(e);
}

void PoseTool::follow(const PointerEvent& e) {
    Drag& drag = *drag_;
    const double pace = e.pace();
    if (drag.ring) {
        turnAround(e);
    } else if (turning_ || (e.modifiers & Qt::AltModifier)) {
        turn(e);
        if (drag.normal.norm() > 0.5) drag.grip = pointerOn(e, drag.grip, drag.normal);
    } else if (drag.normal.norm() > 0.5) {
        const Vec3 under = pointerOn(e, drag.grip, drag.normal);
        drag.target += drag.lock.confined(pace * (under - drag.grip));
        drag.grip = under;
    }
    drag.lastX = e.x;
    drag.lastY = e.y;
    last_ = e;
}

void PoseTool::turn(const PointerEvent& e) {
    Drag& drag = *drag_;
    const double right = e.pace() * kRadiansPerPixel * (e.x - drag.lastX), down = e.pace() * kRadiansPerPixel * (e.y - drag.lastY);
    if (!drag.end.isHandle())
        drag.roll = drag.roll.value_or(0.0) + right;
    else if (drag.lock.alongAxis())
        drag.rotation = (Eigen::AngleAxisd(right, drag.lock.direction()) * drag.rotation).normalized();
    else
        drag.rotation = (Eigen::AngleAxisd(right, e.viewRight.cross(e.viewForward)) * Eigen::AngleAxisd(down, e.viewRight) * drag.rotation).normalized();
}

Vec3 PoseTool::turningAxis() const { return drag_->lock.alongAxis() ? drag_->lock.direction() : Vec3(-last_->viewForward); }

double PoseTool::turned() const {
    const Drag& drag = *drag_;
    if (!drag.end.isHandle()) return drag.roll.value_or(0.0) - drag.fromRoll;
    const Eigen::Quaterniond by = drag.rotation * drag.fromRotation.conjugate();
    return 2.0 * std::atan2(by.vec().dot(turningAxis()), by.w());
}

PoseTool::Aim PoseTool::aim(const PointerEvent& e) {
    const Drag& drag = *drag_;
    Aim aim{drag.target, drag.roll, drag.rotation};
    const bool turns = drag.typed.leads() && drag.typed.of() == TypedNumber::Of::Angle;
    if (!turns && snap_.acts(e) && snap_.settings().angle) {
        const Eigen::AngleAxisd by(drag.rotation * drag.fromRotation.conjugate());
        if (drag.end.isHandle() && by.angle() > 1e-9)
            aim.rotation = (Eigen::AngleAxisd(snap_.angle(e, by.angle()), by.axis()) * drag.fromRotation).normalized();
        else if (drag.roll && *drag.roll != drag.fromRoll)
            aim.roll = drag.fromRoll + snap_.angle(e, *drag.roll - drag.fromRoll);
    }
    if (drag.typed.leads()) {
        if (drag.typed.of() == TypedNumber::Of::Length) {
            snap_.clear();
            aim.to = drag.origin + drag.lock.fromAxes(drag.typed.values(drag.lock.toAxes(drag.target - drag.origin)));
            return aim;
        }
        const double by = drag.typed.value(turned());
        if (drag.end.isHandle())
            aim.rotation = (Eigen::AngleAxisd(by, turningAxis()) * drag.fromRotation).normalized();
        else
            aim.roll = drag.fromRoll + by;
    }
    aim.to = drag.origin + drag.lock.confined(snap_.point(e, drag.target, !drag.lock.free()) - drag.origin);
    return aim;
}

void PoseTool::issue(const PointerEvent& e) {
    Drag& drag = *drag_;
    const Aim to = aim(e);
    if (!allFinite(to.to)) return;
    // The first command takes hold and the last one leaves the answer in the document; in between the performance goes on, and is given where to.
    // To take hold where it is solves nothing; whole chains that are solved at once make the first move stumble.
    if (!drag.held && document_.session().performed()) hold();
    if (!drag_) return;
    if (drag.held && give(drag.end, to) && (!drag.image || give(*drag.image, mirrored(to)))) {
        drag.given = to;
        return;
    }
    command(to);
}

void PoseTool::command(const Aim& to) {
    Drag& drag = *drag_;
    drag.given.reset();
    drag.held = dragTo(drag.end, to) && (!drag.image || dragTo(*drag.image, mirrored(to)));
    if (!drag.held) cancel();
}

void PoseTool::release(const PointerEvent& e) {
    if (!busy() || modal() || fingersHold() || e.button != Qt::LeftButton) return;
    if (part_.busy()) {
        if (!part_.moved()) selectByClick(document_, pickItem(document_.session(), e), e.modifiers);
        return part_.release(e);
    }
    if (flesh_) {
        flesh_.reset();
        return selectByClick(document_, pickItem(document_.session(), e), e.modifiers);
    }
    keep();
}

void PoseTool::keep() {
    if (drag_->given) command(Aim(*drag_->given));
    if (!drag_) return;
    const Session::Step named = stepName();
    if (drag_->passing) {
        const auto pose = document_.session().poseOf(drag_->end.handle);
        if (drag_->passing->kept) {
            document_.select({drag_->end.item()});
        } else if (document_.execute(commands::removeHandle(drag_->end.handle.face))) {
            if (pose) letGo_ = LetGo{*drag_->passing, pose->at, pose->rotation};
            hovered_.reset();
        }
    }
    const QString alone = drag_->alone && drag_->gesture && !drag_->passing ? QString::fromStdString(pathOf(document_.document(), drag_->end)) : QString();
    if (drag_->gesture) drag_->gesture->commit(named);
    if (!alone.isEmpty()) Q_EMIT document_.failed(ToolTexts::tr("“%1” has nothing on the other side: it moved alone.").arg(alone));
    drag_.reset();
    last_.reset();
    turning_ = false;
}

Session::Step PoseTool::stepName() const {
    if (!drag_) return {};
    if (drag_->passing) return drag_->passing->kept ? Session::Step{"handle", drag_->end.handle.face} : Session::Step{"drag", drag_->passing->element};
    return drag_->image ? Session::Step{"drag", pathOf(document_.document(), drag_->end)} : Session::Step{};
}

void PoseTool::doubleClick(const PointerEvent& e) {
    const auto grip = fingersHold() ? std::nullopt : gripUnder(e);
    if (!grip || !isHeld(document_.document(), *grip)) return;
    document_.execute(commands::release(pathOf(document_.document(), *grip)));
}

bool PoseTool::wheel(double notches, const PointerEvent& e) {
    if (part_.busy()) return part_.wheel(notches, e);
    if (!drag_) return false;
    if (!drag_->gesture) drag_->gesture = std::make_unique<Gesture>(document_);
    const double pace = e.pace();
    const double angle = pace * kRadiansPerNotch * notches;
    if (drag_->end.isHandle())
        drag_->rotation = (Eigen::AngleAxisd(angle, turningAxis()) * drag_->rotation).normalized();
    else
        drag_->roll = drag_->roll.value_or(0.0) + angle;
    issue(e);
    return true;
}

bool PoseTool::key(int key, Qt::KeyboardModifiers modifiers, const QString& text) {
    if (fingersHold()) return false;
    if (part_.busy()) return part_.key(key, text);
    if (drag_ && type(key, text)) return true;
    if (key == Qt::Key_P) {
        if (drag_) return true;
        if (hovered_) {
            toggle(*hovered_);
            return true;
        }
        for (const SelectionItem& item : document_.selection())
            if (item.kind == SelectionItem::Kind::Endpoint) {
                toggle({holdingEndpoint(document_.session(), {item.part, item.atEnd}), {}});
                return true;
            } else if (handleOf(document_.document(), item)) {
                toggle({{}, {item.part, item.face}});
                return true;
            }
        return false;
    }
    if (key == Qt::Key_K && letGo_) {
        bringBack();
        return true;
    }
    if (!drag_) return (key == Qt::Key_G || (key == Qt::Key_R && options_.turnKey)) && modifiers == Qt::NoModifier && over_ && grabSelected(*over_, key == Qt::Key_R);
    if (drag_->modal && key == Qt::Key_G) {
        turning_ = false;
        return true;
    }
    if (key == Qt::Key_K && drag_->passing) {
        drag_->passing->kept = !drag_->passing->kept;
        return true;
    }
    if (key == Qt::Key_R) {
        turning_ = !drag_->modal || !turning_;
        if (drag_->modal) drag_->typed.clear();
        return true;
    }
    if (key == Qt::Key_B && !drag_->end.isHandle()) {
        toggleFollowing();
        return true;
    }
    if (drag_->lock.key(key, modifiers)) {
        // The lock holds for the whole drag: what was moved across the axis is taken back.
        drag_->normal = drag_->lock.plane(*last_);
        drag_->target = drag_->origin + drag_->lock.confined(drag_->target - drag_->origin);
        if (drag_->normal.norm() > 0.5) drag_->grip = pointerOn(*last_, drag_->target, drag_->normal);
        if (drag_->typed.of() == TypedNumber::Of::Length) drag_->typed.setAxes(drag_->lock.axes());
        if (drag_->gesture) issue(*last_);
        return true;
    }
    return false;
}

bool PoseTool::type(int key, const QString& text) {
    if (key == Qt::Key_Return || key == Qt::Key_Enter) {
        keep();
        return true;
    }
    const bool turns = drag_->typed.leads() ? drag_->typed.of() == TypedNumber::Of::Angle : drag_->ring || turning_ || (last_->modifiers & Qt::AltModifier);
    if (!drag_->typed.key(key, text, turns ? TypedNumber::Of::Angle : TypedNumber::Of::Length, turns ? std::string() : drag_->lock.axes())) return false;
    if (!drag_->gesture) drag_->gesture = std::make_unique<Gesture>(document_);
    issue(*last_);
    return true;
}

bool PoseTool::wants(int key) const {
    if (fingersHold()) return false;
    if (key == Qt::Key_P) return drag_ || hovered_;
    if (key == Qt::Key_G || (key == Qt::Key_R && options_.turnKey)) return drag_ || (over_ && gripSelected());
    if (key == Qt::Key_K) return letGo_ || (drag_ && drag_->passing);
    if (key == Qt::Key_B) return drag_ && !drag_->end.isHandle();
    return drag_ && (key == Qt::Key_R || key == Qt::Key_X || key == Qt::Key_Y || key == Qt::Key_Z);
}

void PoseTool::keyReleased(int key) {
    if (key == Qt::Key_R && !modal()) turning_ = false;
}

void PoseTool::toggle(const PoseGrip& grip) {
    const Document& d = document_.document();
    document_.execute(commands::setPinned(pathOf(d, grip), !isPinned(d, grip)));
}

void PoseTool::toggleFollowing() {
    const double now = document_.document().settings.bodyFollows;
    if (now > 0.0) drag_->follows = now;
    if (!drag_->gesture) drag_->gesture = std::make_unique<Gesture>(document_);
    if (document_.execute(commands::set(commands::character::kTarget, commands::character::kBodyFollows, now > 0.0 ? 0.0 : drag_->follows))) issue(*last_);
}

void PoseTool::cancel() {
    if (fingers_) fingers_->cancel();
    part_.cancel();
    flesh_.reset();
    drag_.reset();  // its gesture takes the commands back
    last_.reset();
    turning_ = false;
}

QString PoseTool::banner() const {
    if (part_.busy()) return part_.banner();
    if (!drag_) return {};
    const bool lengths = drag_->typed.of() == TypedNumber::Of::Length;
    const QString typed = drag_->typed.shown(lengths ? drag_->lock.toAxes(drag_->target - drag_->origin) : std::array<double, 3>{turned(), 0.0, 0.0});
    return typed.isEmpty() ? drag_->lock.text(*last_) : typed;
}

QString PoseTool::hint() const {
    if (fingersHold()) return ToolTexts::tr("Each finger leads what it holds · Esc: take back");
    if (const QString part = part_.hint(); !part.isEmpty()) return part;
    if (drag_ && drag_->passing)
        return drag_->passing->kept ? ToolTexts::tr("This handle stays · K: make it temporary · R or wheel: turn · Esc: cancel")
                                    : ToolTexts::tr("Temporary handle · K: keep · X, Y, Z: lock axis · R or wheel: turn · Esc: cancel");
    if (modal()) return snap_.before(ToolTexts::tr("Click or Enter: keep · X, Y, Z: lock axis · Type a number · Shift: fine · Ctrl: snap · R: turn · Esc: cancel"));
    if (drag_ && drag_->end.isHandle()) return snap_.before(ToolTexts::tr("X, Y, Z: lock axis · Type a number · Shift: fine · Ctrl: snap · R or wheel: turn · Esc: cancel"));
    if (drag_)
        return snap_.before(document_.document().settings.bodyFollows > 0.0 ? ToolTexts::tr("X, Y, Z: lock axis · Type a number · Shift: fine · Ctrl: snap · R or wheel: turn · B: the trunk leans, too · Esc: cancel")
                                                               : ToolTexts::tr("X, Y, Z: lock axis · Type a number · Shift: fine · Ctrl: snap · R or wheel: turn · B: the trunk stays upright · Esc: cancel"));
    if (hoveredPart_ != render::GizmoPart::None) return gizmoHint(hoveredPart_);
    const Document& d = document_.document();
    if (letGo_) return ToolTexts::tr("K: bring the temporary handle back and keep it");
    if (overFlesh_) return ToolTexts::tr("Drag: pull the body here");
    const bool handles = std::any_of(d.elements.begin(), d.elements.end(), [](const auto& e) { return !e.second->handles.empty(); });
    if (d.bones.empty() && !handles) return ToolTexts::tr("There are no bones and no handles yet. Place them with their tools.");
    if (hovered_) return ToolTexts::tr("Drag: pose · P: pin · Double click: let go");
    if (gripSelected()) return ToolTexts::tr("Drag the end of a bone or a handle · G: move the selected one");
    return handles ? ToolTexts::tr("Drag a handle or the end of a bone") : ToolTexts::tr("Drag the end of a bone");
}

void PoseTool::decorate(render::Scene& scene) const {
    if (fingers_) fingers_->decorate(scene);
    part_.decorate(scene);
    if (const auto place = gizmo()) addGizmo(scene, *place, options_.space, hoveredPart_);
    if (!drag_) return;
    drag_->lock.decorate(scene, drag_->origin);
    snap_.decorate(scene);
}

}  // namespace imomushi
