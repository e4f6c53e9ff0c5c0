// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "ui/models/gesture.h"
#include "ui/tools/picking.h"
#include "ui/tools/tool.h"

namespace imomushi {

/// Drags the ends of bones, and handles: in the plane of the screen, or along X, Y or Z; Shift fine, Ctrl on the grid; R or Alt (or the wheel) turns
/// the end about its bone, a handle as a ball under the pointer, or about the locked axis. One drag is one undo step. P pins, a double click lets go. Flesh
/// that is taken where there is neither moves the nearest of both.
class PoseTool : public Tool {
public:
    using Tool::Tool;
    void press(const PointerEvent& e) override;
    /// As if it had been pressed.
    void grab(const PoseGrip& grip, const PointerEvent& e);
    void move(const PointerEvent& e) override;
    void release(const PointerEvent& e) override;
    void leave() override { hovered_.reset(); }
    void doubleClick(const PointerEvent& e) override;
    bool wheel(double notches, const PointerEvent& e) override;
    bool key(int key, Qt::KeyboardModifiers modifiers) override;
    [[nodiscard]] bool wants(int key) const override;
    void keyReleased(int key) override;
    void cancel() override;
    [[nodiscard]] bool busy() const override { return drag_.has_value(); }
    [[nodiscard]] QString hint() const override;
    void decorate(render::Scene& scene) const override;

private:
    struct Drag {
        PoseGrip end;
        std::unique_ptr<Gesture> gesture;   ///< opened by the first real movement: a click makes no undo step
        Vec3 origin = Vec3::Zero();       ///< where the end was when the drag began
        Vec3 target = Vec3::Zero();       ///< before snapping
        Vec3 grip = Vec3::Zero();         ///< point of the drag plane under the pointer at the last move
        Vec3 normal = Vec3::UnitZ();      ///< of the plane through `target` in which the pointer moves
        double pressX = 0, pressY = 0, lastX = 0, lastY = 0;
        int axis = -1;                    ///< 0, 1, 2: locked to x, y, z
        std::optional<double> roll;       ///< of a bone's end, radians; none: never turned
        Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< of a handle, from rest
    };

    [[nodiscard]] std::optional<PoseGrip> gripUnder(const PointerEvent& e) const;
    void follow(const PointerEvent& e);
    void turn(const PointerEvent& e);
    void issue(const PointerEvent& e);
    void toggle(const PoseGrip& grip);

    std::optional<PoseGrip> hovered_;
    std::optional<Drag> drag_;
    std::optional<PointerEvent> last_;  ///< of the drag, for keys that act on it
    bool turning_ = false;              ///< R is held
};

}  // namespace imomushi
