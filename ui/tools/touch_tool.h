// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "ui/models/gesture.h"
#include "ui/picking/picking.h"
#include "ui/tools/tool.h"
#include "ui/tools/typed_number.h"

namespace imomushi {

/// Pokes fingers into the surface: a press dents it, moving pushes the dent along the screen, the wheel or Ctrl presses deeper, releasing lifts. A pen pushes as hard as it presses. G pokes without a button, until a press or Enter. One poke is
/// one undo step. Where the effect is off, or not precomputed, it offers what is missing.
class TouchTool : public Tool {
public:
    using Tool::Tool;
    void begin() override;
    void press(const PointerEvent& e) override;
    void move(const PointerEvent& e) override;
    void release(const PointerEvent& e) override;
    void leave() override { hovered_.reset(); }
    bool wheel(double notches, const PointerEvent& e) override;
    bool key(int key, Qt::KeyboardModifiers modifiers, const QString& text = {}) override;
    void cancel() override;
    [[nodiscard]] bool wants(int key) const override { return key == Qt::Key_G && (finger_ || hovered_); }
    [[nodiscard]] bool busy() const override { return finger_.has_value(); }
    [[nodiscard]] bool modal() const override { return finger_ && finger_->modal; }
    [[nodiscard]] QString hint() const override;
    [[nodiscard]] QString banner() const override { return finger_ ? finger_->typed.shown({finger_->depth, 0.0, 0.0}) : QString(); }
    void decorate(render::Scene& scene) const override;

private:
    struct Finger {
        std::unique_ptr<Gesture> gesture;
        PartId element = 0;
        Vec3 rest = Vec3::Zero();     ///< the point of the flesh, at rest
        Vec3 pressed = Vec3::Zero();  ///< where it was when it was pressed
        Vec3 surface = Vec3::Zero();  ///< the same, moved along with the pointer
        Vec3 inward = Vec3::UnitZ();  ///< unit
        Vec3 across = Vec3::UnitZ();  ///< normal of the plane in which the pointer moves
        Vec3 grip = Vec3::Zero();     ///< point of that plane under the pointer at the last move
        double depth = 0.0;           ///< m
        double pixel = 0.0;           ///< m that a logical pixel covers at the surface
        double lastY = 0.0;
        double strength = 1.0;        ///< of how far the flesh is pushed; a depth that is typed is as deep
        TypedNumber typed = {};
        bool modal = false;           ///< without a button
        [[nodiscard]] Vec3 tip() const { return pressed + strength * (surface - pressed) + (typed.leads() ? typed.value(depth) : strength * depth) * inward; }
    };

    /// Offers what fingers on an element (0: any) still need. False: nothing, they work.
    bool offer(PartId element);
    bool issue();
    void poke(const PointerEvent& e);
    void lift();

    std::optional<RayHit> hovered_;
    std::optional<PointerEvent> last_;  ///< where keys begin
    std::optional<Finger> finger_;
};

}  // namespace imomushi
