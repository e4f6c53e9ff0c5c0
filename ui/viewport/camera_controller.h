// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "ui/render/camera.h"
#include "ui/tools/tool.h"

namespace imomushi {

/// Whose habits the mouse follows. Blender: middle orbits, Shift+middle pans, Ctrl+middle zooms. Industry adds Alt+left, Alt+middle, Alt+right.
enum class NavigationPreset { Blender, Industry };
enum class Navigation { None, Orbit, Pan, Zoom };
Navigation navigationOf(NavigationPreset preset, Qt::MouseButton button, Qt::KeyboardModifiers modifiers);

/// The six views along the axes: Front looks along -z, Right along -x, Top along -y.
enum class ViewAxis { Front, Back, Right, Left, Top, Bottom };

/// Where the viewport looks from: a turntable around a target (y up). No widgets. Screen coordinates are logical pixels, origin top left.
class CameraController {
public:
    CameraController();

    void setViewport(double width, double height);  ///< logical pixels
    [[nodiscard]] double width() const { return width_; }
    [[nodiscard]] double height() const { return height_; }

    void orbit(double dx, double dy);                 ///< by a movement of the pointer
    void turn(double yaw, double pitch);              ///< radians; the eye moves right and up
    void pan(double dx, double dy);                   ///< what is at the target's depth stays under the pointer
    void zoom(double notches, double x, double y);    ///< what is under (x, y) at the target's depth stays there; > 0: nearer
    void setAxis(ViewAxis axis, bool animate);
    /// Looks along `direction` (from eye to target, any length but zero).
    void setDirection(const Vec3& direction, bool animate);
    /// Shows all `points` with a margin, direction unchanged. Without points: the unit cube on the ground.
    void frame(std::span<const Vec3> points, bool animate);
    void setOrthographic(bool on) { orthographic_ = on; }
    [[nodiscard]] bool orthographic() const { return orthographic_; }

    /// Goes on with the animation; true while the camera still moves.
    bool advance(double seconds);
    [[nodiscard]] bool moving() const { return goal_.has_value(); }

    [[nodiscard]] render::Camera camera() const;
    [[nodiscard]] Eigen::Matrix3d axes() const;  ///< columns: right, up, back (to the viewer), world
    /// Sets ray, view direction and pixel sizes of `e` from its x and y.
    void aim(PointerEvent& e) const;
    /// Where a world point is on the screen; none: behind the eye.
    [[nodiscard]] std::optional<Eigen::Vector2d> onScreen(const Vec3& p) const;

private:
    struct View {
        Vec3 target = Vec3::Zero();
        double distance = 4.0;  ///< m from the eye to the target
        double yaw = 0.0;       ///< radians about y, 0: from +z
        double pitch = 0.0;     ///< radians, > 0: from above
    };
    static Eigen::Matrix3d axesOf(const View& view);
    void go(const View& view, bool animate);
    [[nodiscard]] double halfHeight() const;  ///< m, at the target's depth

    View view_, start_;
    std::optional<View> goal_;
    double progress_ = 0.0;  ///< of the animation, 0...1
    bool orthographic_ = false;
    double width_ = 1.0, height_ = 1.0;
    double reach_ = 10.0;    ///< m, size of what was framed last: limits of zoom
};

}  // namespace imomushi
