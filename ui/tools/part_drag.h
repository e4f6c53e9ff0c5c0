// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "ui/models/gesture.h"
#include "ui/tools/tool.h"
#include "ui/tools/typed_number.h"

namespace imomushi {

/// Turns an attached part about its pivot, like an eye that looks around: the place of it that was taken follows the pointer, the wheel turns it about the line of sight.
/// One undo step.
class PartDrag {
public:
    explicit PartDrag(StudioDocument& document) : document_(document) {}
    /// True: it took hold of a part that can be turned.
    bool press(const PointerEvent& e);
    void move(const PointerEvent& e);
    void release(const PointerEvent& e);
    /// True: used.
    bool wheel(double notches, const PointerEvent& e);
    /// Typed angles turn it about the line of sight, Enter keeps it. True: used.
    bool key(int key, const QString& text);
    [[nodiscard]] QString banner() const { return drag_ ? drag_->typed.shown({drag_->seen, 0.0, 0.0}) : QString(); }
    void cancel() { drag_.reset(); }
    [[nodiscard]] bool busy() const { return drag_.has_value(); }
    [[nodiscard]] bool moved() const { return drag_ && drag_->gesture; }
    /// The pointer is over a part that can be turned. Remembers it for hint() and decorate().
    bool hover(const PointerEvent& e);
    void leave() { over_.reset(); }
    [[nodiscard]] QString hint() const;
    /// Shows the pivot, and the line from there to where the part is held.
    void decorate(render::Scene& scene) const;

private:
    struct Grip {
        PartRef part;
        Vec3 pivot = Vec3::Zero(), at = Vec3::Zero();  ///< m, world: of the turn, and what the pointer is on
        Eigen::Quaterniond carrier = Eigen::Quaterniond::Identity();  ///< how the body turns the part, besides its own turn
        Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();     ///< from rest, in the axes of the rest pose
    };
    struct Drag {
        Grip grip;
        std::unique_ptr<Gesture> gesture;  ///< opened by the first real movement
        Vec3 held = Vec3::Zero();          ///< where the pointer was at the last move, m, world
        double pressX = 0, pressY = 0;     ///< logical pixels
        Vec3 sight = -Vec3::UnitZ();       ///< unit
        double seen = 0.0, typedNow = 0.0; ///< radians about the line of sight: by the wheel, and by the typed number
        TypedNumber typed = {};
    };
    [[nodiscard]] std::optional<Grip> grip(const PointerEvent& e) const;
    /// `by`: in the world.
    void turn(const Eigen::Quaterniond& by);

    StudioDocument& document_;
    std::optional<Grip> over_;
    std::optional<Drag> drag_;
};

}  // namespace imomushi
