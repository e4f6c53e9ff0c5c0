// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Qt>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/vec3.h"

namespace imomushi {

/// A pointer event in the viewport, with the ray under it. Pixels are those of the design: logical pixels over the scale of the interface, so that what can be taken hold of grows with it.
struct PointerEvent {
    double x = 0, y = 0;
    Qt::MouseButton button = Qt::NoButton;
    Qt::MouseButtons buttons;
    Qt::KeyboardModifiers modifiers;
    Vec3 rayOrigin = Vec3::Zero();     ///< world
    Vec3 rayDirection = Vec3::UnitZ(); ///< unit
    Vec3 viewForward = -Vec3::UnitZ(); ///< unit, for dragging in the plane of the screen
    Vec3 viewRight = Vec3::UnitX();    ///< unit
    double pixelAngle = 0.001;         ///< metres that a pixel covers per metre of depth (perspective; 0 otherwise)
    double pixelSize = 0.0;            ///< metres that a pixel covers at any depth (orthographic; 0 otherwise)
    bool bonesVisible = true;          ///< false: bones are hidden and not picked
    int behind = 0;                    ///< of several ends of bones there, so many are passed over
    double pressure = 0.5;             ///< of a pen, 0 to 1; what has no pressure presses by the half

    /// Metres that a pixel covers at `p`.
    [[nodiscard]] double pixelAt(const Vec3& p) const {
        return pixelSize + pixelAngle * std::max(1e-9, viewForward.dot(p - rayOrigin));
    }
    /// Where the ray meets a plane; `otherwise` where it runs along it or meets it behind the eye.
    [[nodiscard]] Vec3 onPlane(const Vec3& point, const Vec3& normal, const Vec3& otherwise) const {
        const double slope = normal.dot(rayDirection);
        if (std::abs(slope) < 1e-6) return otherwise;
        const double t = normal.dot(point - rayOrigin) / slope;
        return t > 0.0 ? Vec3(rayOrigin + t * rayDirection) : otherwise;
    }
    /// How fast a drag follows the pointer: Shift slows it to a tenth.
    [[nodiscard]] double pace() const { return (modifiers & Qt::ShiftModifier) ? 0.1 : 1.0; }
    /// Where `p` is seen, pixels of the design; none: behind the eye.
    [[nodiscard]] std::optional<Eigen::Vector2d> onScreen(const Vec3& p) const {
        const double depth = viewForward.dot(p - rayOrigin);
        if (!(depth > 0.0)) return std::nullopt;
        const Vec3 off = (p - rayOrigin - depth / viewForward.dot(rayDirection) * rayDirection) / pixelAt(p);
        return Eigen::Vector2d(x + off.dot(viewRight), y - off.dot(viewRight.cross(viewForward)));
    }
};

}  // namespace imomushi
