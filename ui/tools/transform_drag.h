// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "ui/tools/axis_lock.h"
#include "ui/tools/gizmo.h"
#include "ui/tools/snap.h"
#include "ui/tools/typed_number.h"

namespace imomushi {

/// A move, a turn or a scale about a pivot, as the pointer, typed numbers, the axis lock and snapping say. One for all that is moved at rest; it changes nothing itself.
class TransformDrag {
public:
    enum class Does { Moves, Turns, Scales };
    /// What it is of.
    struct Of {
        Vec3 pivot = Vec3::Zero();  ///< m, as shown
        Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns, unit: X, Y and Z of the lock
        bool modal = false;     ///< the pointer leads without a button
        bool turns = true;      ///< false: it can only be moved
        bool uniform = false;   ///< it is scaled along all axes alike
    };
    TransformDrag(Does does, const Of& of, const PointerEvent& e);
    /// A part of a gizmo was pressed.
    static Does doneBy(render::GizmoPart part);
    void lockTo(render::GizmoPart part, Snap& snap);
    /// Something else from now on, from where the pointer is.
    void choose(Does does, Snap& snap);
    /// False: a press that did not move yet.
    bool move(const PointerEvent& e, Snap& snap);
    /// True: used; Enter is not. Typed numbers, X, Y, Z, and G, R, S.
    bool key(int key, Qt::KeyboardModifiers modifiers, const QString& text, Snap& snap);

    [[nodiscard]] Does does() const { return does_; }
    [[nodiscard]] bool moved() const { return moved_; }
    [[nodiscard]] bool modal() const { return of_.modal; }
    [[nodiscard]] bool locked() const { return !lock_.free(); }
    [[nodiscard]] bool typing() const { return typed_.leads(); }
    [[nodiscard]] const PointerEvent& last() const { return last_; }
    [[nodiscard]] const Vec3& pivot() const { return of_.pivot; }

    /// Where a point goes, as shown, m.
    [[nodiscard]] Vec3 placed(const Vec3& point) const;
    /// The three that placed() is made of: only one of them says something.
    [[nodiscard]] Vec3 shift() const;
    [[nodiscard]] Eigen::Quaterniond rotation() const;
    [[nodiscard]] double factor() const;

    /// What is typed, or what it is confined to, translated.
    [[nodiscard]] QString banner() const;
    void decorate(render::Scene& scene) const { lock_.decorate(scene, of_.pivot); }

private:
    void follow(const PointerEvent& before, const PointerEvent& e);
    void settle(Snap& snap);
    [[nodiscard]] TypedNumber::Of number() const;
    [[nodiscard]] std::string axes() const { return does_ == Does::Moves ? lock_.axes() : std::string(); }
    [[nodiscard]] Vec3 turningAxis() const { return lock_.alongAxis() ? lock_.direction() : Vec3(-last_.viewForward); }

    Does does_;
    Of of_;
    PointerEvent first_, last_;
    bool moved_ = false;
    AxisLock lock_;
    TypedNumber typed_;
    Vec3 step_ = Vec3::Zero();      ///< that the pointer says, m
    Vec3 grip_ = Vec3::Zero();      ///< under the pointer at the last move, m
    double angle_ = 0.0;            ///< radians
    double factor_ = 1.0;
    std::array<double, 3> goes_{};  ///< what the pointer says, snapped
};

}  // namespace imomushi
