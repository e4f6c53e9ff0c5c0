// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/axis_lock.h"

#include "ui/tools/tool_texts.h"

namespace imomushi {
namespace {

/// Sine of five degrees: nearer to the line of sight an axis moves more than ten times as far as the pointer.
constexpr double kEndOn = 0.087;

}  // namespace

bool AxisLock::key(int key, Qt::KeyboardModifiers modifiers) {
    if (key != Qt::Key_X && key != Qt::Key_Y && key != Qt::Key_Z) return false;
    const int axis = key - Qt::Key_X;
    const bool across = (modifiers & Qt::ShiftModifier) != 0;
    axis_ = axis_ == axis && across_ == across ? -1 : axis;
    across_ = across;
    return true;
}

Vec3 AxisLock::confined(const Vec3& step) const {
    if (free()) return step;
    Vec3 kept = axes_.transpose() * step;
    for (int k = 0; k < 3; ++k)
        if (!moves(k)) kept[k] = 0.0;
    return axes_ * kept;
}

Vec3 AxisLock::plane(const PointerEvent& e) const {
    if (free()) return e.viewForward;
    const Vec3 a = direction();
    if (across_) return std::abs(a.dot(e.viewForward)) > kEndOn ? a : Vec3(Vec3::Zero());
    // It holds the axis, and faces the viewer as far as it can.
    const Vec3 n = e.viewForward - a.dot(e.viewForward) * a;
    return n.norm() > kEndOn ? Vec3(n.normalized()) : Vec3::Zero();
}

std::string AxisLock::axes() const {
    std::string names;
    for (int k = 0; k < 3; ++k)
        if (moves(k)) names += char('X' + k);
    return names;
}

std::array<double, 3> AxisLock::toAxes(const Vec3& step) const {
    std::array<double, 3> values{};
    const Vec3 along = axes_.transpose() * step;
    std::size_t i = 0;
    for (int k = 0; k < 3; ++k)
        if (moves(k)) values[i++] = along[k];
    return values;
}

Vec3 AxisLock::fromAxes(const std::array<double, 3>& values) const {
    Vec3 step = Vec3::Zero();
    std::size_t i = 0;
    for (int k = 0; k < 3; ++k)
        if (moves(k)) step[k] = values[i++];
    return axes_ * step;
}

QString AxisLock::text(const PointerEvent& e) const {
    if (free()) return {};
    const QString name = QString(QLatin1Char(char('X' + axis_)));
    if (plane(e).norm() < 0.5)
        return across_ ? ToolTexts::tr("The plane across %1 is seen from its edge: turn the view, or type numbers").arg(name)
                       : ToolTexts::tr("%1 is seen end on: turn the view, or type a number").arg(name);
    return across_ ? ToolTexts::tr("Across %1").arg(name) : ToolTexts::tr("Along %1").arg(name);
}

void AxisLock::decorate(render::Scene& scene, const Vec3& origin) const {
    if (free()) return;
    const double reach = 4.0 * (scene.camera.eye - origin).norm() + scene.camera.orthoHeight;
    for (int k = 0; k < 3; ++k) {
        if (!moves(k)) continue;
        render::Marker line;
        line.shape = render::Marker::Shape::Axis;
        line.from = origin - reach * axes_.col(k);
        line.to = origin + reach * axes_.col(k);
        line.axis = k;
        scene.markers.push_back(std::move(line));
    }
}

}  // namespace imomushi
