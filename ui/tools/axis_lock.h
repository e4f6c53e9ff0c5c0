// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <array>
#include <string>

#include "ui/tools/tool.h"

namespace imomushi {

/// Confines what is dragged to an axis of the world (or of setFrame()), or to the plane across it. X, Y, Z: along; with Shift: across; the same once more: free. An axis that is seen end on, or a
/// plane that is seen from its edge, does not follow the pointer; typed numbers move along it still.
class AxisLock {
public:
    /// True: used.
    bool key(int key, Qt::KeyboardModifiers modifiers);
    void clear() { axis_ = -1; }
    /// The axes that are meant: columns, unit.
    void setFrame(const Eigen::Matrix3d& axes) { axes_ = axes; }
    void lockTo(int axis, bool across) {
        axis_ = axis;
        across_ = across;
    }
    /// Unit; of an axis that it is locked to.
    [[nodiscard]] Vec3 direction() const { return axes_.col(axis_); }
    [[nodiscard]] bool free() const { return axis_ < 0; }
    [[nodiscard]] bool alongAxis() const { return axis_ >= 0 && !across_; }
    /// 0, 1, 2; -1: free.
    [[nodiscard]] int axis() const { return axis_; }
    /// Whether a component of a step, in its axes, is kept.
    [[nodiscard]] bool moves(int component) const { return axis_ < 0 || (component == axis_) != across_; }
    [[nodiscard]] Vec3 confined(const Vec3& step) const;
    /// Normal of the plane through what is dragged in which the pointer is read; zero: the pointer says nothing of it.
    [[nodiscard]] Vec3 plane(const PointerEvent& e) const;
    /// What may be moved, for TypedNumber: "XYZ", "Y", "XZ".
    [[nodiscard]] std::string axes() const;
    /// The components of a step along these, and back.
    [[nodiscard]] std::array<double, 3> toAxes(const Vec3& step) const;
    [[nodiscard]] Vec3 fromAxes(const std::array<double, 3>& values) const;
    /// What it confines to now, translated; empty: free.
    [[nodiscard]] QString text(const PointerEvent& e) const;
    /// Lines through `origin`, long enough to leave the screen.
    void decorate(render::Scene& scene, const Vec3& origin) const;

private:
    Eigen::Matrix3d axes_ = Eigen::Matrix3d::Identity();
    int axis_ = -1;
    bool across_ = false;
};

}  // namespace imomushi
