// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/transform_drag.h"

#include <cmath>

#include "ui/picking/picking.h"

namespace imomushi {
namespace {

/// Nearer to the pivot than this, logical pixels, the pointer neither turns nor scales.
constexpr double kLeastTurningArm = 4.0;

}  // namespace

TransformDrag::TransformDrag(Does does, const Of& of, const PointerEvent& e) : does_(does), of_(of), first_(e), last_(e) { lock_.setFrame(of.axes); }

TransformDrag::Does TransformDrag::doneBy(render::GizmoPart part) {
    return turnsBy(part) ? Does::Turns : render::isOneOf(part, render::GizmoPart::ScaleX) ? Does::Scales : Does::Moves;
}

void TransformDrag::lockTo(render::GizmoPart part, Snap& snap) {
    if (!(of_.uniform && does_ == Does::Scales)) imomushi::lockTo(lock_, part);
    choose(does_, snap);
}

void TransformDrag::choose(Does does, Snap& snap) {
    does_ = does;
    typed_.clear();
    step_ = Vec3::Zero();
    angle_ = 0.0;
    factor_ = 1.0;
    first_ = last_;
    grip_ = last_.onPlane(of_.pivot, lock_.plane(last_), of_.pivot);
    settle(snap);
}

bool TransformDrag::move(const PointerEvent& e, Snap& snap) {
    const PointerEvent before = std::exchange(last_, e);
    if (!moved_ && !of_.modal && std::hypot(e.x - first_.x, e.y - first_.y) < kDragPixels) return false;
    moved_ = true;
    follow(before, e);
    settle(snap);
    return true;
}

void TransformDrag::follow(const PointerEvent& before, const PointerEvent& e) {
    if (does_ == Does::Moves) {
        const Vec3 plane = lock_.plane(e);
        if (plane.norm() < 0.5) return;
        const Vec3 under = e.onPlane(grip_, plane, grip_);
        step_ += lock_.confined(e.pace() * (under - grip_));
        grip_ = under;
        return;
    }
    const auto middle = e.onScreen(of_.pivot);
    if (!middle) return;
    const Eigen::Vector2d from = Eigen::Vector2d(before.x, before.y) - *middle, to = Eigen::Vector2d(e.x, e.y) - *middle;
    if (from.norm() < kLeastTurningArm || to.norm() < kLeastTurningArm) return;
    if (does_ == Does::Scales) {
        factor_ *= std::pow(to.norm() / from.norm(), e.pace());
        return;
    }
    // Counted as it is seen: the screen's y goes down.
    const double by = std::atan2(from.y() * to.x() - from.x() * to.y(), from.dot(to));
    const double side = lock_.alongAxis() && turningAxis().dot(e.viewForward) > 0.0 ? -1.0 : 1.0;
    angle_ += e.pace() * side * by;
}

void TransformDrag::settle(Snap& snap) {
    PointerEvent e = last_;
    e.bonesVisible = true;
    const bool snaps = does_ == Does::Moves && moved_ && !typed_.leads();
    if (!snaps) snap.clear();
    switch (does_) {
        case Does::Turns: goes_ = {snap.angle(e, angle_), 0.0, 0.0}; break;
        case Does::Scales: goes_ = {snap.factor(e, factor_), 0.0, 0.0}; break;
        case Does::Moves: {
            const Vec3 to = snaps ? Vec3(snap.point(e, of_.pivot + step_, !lock_.free())) : Vec3(of_.pivot + step_);
            goes_ = lock_.toAxes(to - of_.pivot);
            break;
        }
    }
}

TypedNumber::Of TransformDrag::number() const {
    return does_ == Does::Turns ? TypedNumber::Of::Angle : does_ == Does::Scales ? TypedNumber::Of::Factor : TypedNumber::Of::Length;
}

Vec3 TransformDrag::shift() const { return does_ == Does::Moves ? lock_.fromAxes(typed_.values(goes_)) : Vec3(Vec3::Zero()); }

Eigen::Quaterniond TransformDrag::rotation() const {
    return does_ == Does::Turns ? Eigen::Quaterniond(Eigen::AngleAxisd(typed_.value(goes_[0]), turningAxis())) : Eigen::Quaterniond::Identity();
}

double TransformDrag::factor() const { return does_ == Does::Scales ? typed_.value(goes_[0]) : 1.0; }

Vec3 TransformDrag::placed(const Vec3& point) const {
    const Vec3 arm = point - of_.pivot;
    switch (does_) {
        case Does::Moves: return point + shift();
        case Does::Turns: return of_.pivot + rotation() * arm;
        case Does::Scales: break;
    }
    return of_.pivot + arm + (factor() - 1.0) * (of_.uniform ? arm : lock_.confined(arm));
}

bool TransformDrag::key(int key, Qt::KeyboardModifiers modifiers, const QString& text, Snap& snap) {
    if (typed_.key(key, text, number(), axes())) {
        moved_ = true;
        settle(snap);
        return true;
    }
    if (lock_.key(key, modifiers)) {
        step_ = lock_.confined(step_);
        grip_ = last_.onPlane(of_.pivot + step_, lock_.plane(last_), of_.pivot + step_);
        if (does_ == Does::Moves) typed_.setAxes(axes());
        settle(snap);
        return true;
    }
    if (key != Qt::Key_G && key != Qt::Key_R && key != Qt::Key_S) return false;
    if (key == Qt::Key_G || of_.turns) choose(key == Qt::Key_G ? Does::Moves : key == Qt::Key_R ? Does::Turns : Does::Scales, snap);
    return true;
}

QString TransformDrag::banner() const {
    const QString typed = typed_.shown(goes_);
    return typed.isEmpty() ? lock_.text(last_) : typed;
}

}  // namespace imomushi
