// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "ui/picking/lazy_sections.h"
#include "ui/scene/cut_frame.h"
#include "ui/tools/snap.h"
#include "ui/tools/tool.h"
#include "ui/tools/typed_number.h"

namespace imomushi {

/// Moves and turns the selected cut: its plane slides along its normal, the tip of its arrow turns it. The section under way is shown; the cut itself moves when the
/// button is let go, in one undo step.
class CutDrag {
public:
    explicit CutDrag(StudioDocument& document) : document_(document), snap_(document) {}
    void setSnap(const SnapSettings& settings) { snap_.set(settings); }
    /// True: it took hold of the plane of the selected cut.
    bool press(const PointerEvent& e);
    /// Takes the selected cut, and the pointer leads it without a button, until a press or Enter. False: none is selected.
    bool begin(bool turns, const PointerEvent& e);
    [[nodiscard]] bool modal() const { return drag_ && drag_->modal; }
    void keep();
    void move(const PointerEvent& e);
    void release(const PointerEvent& e);
    void cancel() { drag_.reset(); }
    [[nodiscard]] bool busy() const { return drag_.has_value(); }
    [[nodiscard]] bool moved() const { return drag_ && drag_->moved; }
    /// X, Y, Z turn the plane that is dragged to an axis; typed numbers slide or turn it, Enter keeps it. True: used.
    bool key(int key, const QString& text = {});
    /// The number that is typed.
    [[nodiscard]] QString banner() const;
    /// The pointer is over what can be dragged.
    [[nodiscard]] bool over(const PointerEvent& e) const { return grip(e).has_value(); }
    [[nodiscard]] QString hint() const;
    void decorate(render::Scene& scene) const;

private:
    struct Grip {
        PartId cut = 0;
        bool turns = false;
        CutFrame frame;
    };
    struct Drag {
        Grip grip;
        std::shared_ptr<const Body> body;
        Vec3 centre = Vec3::Zero(), normal = Vec3::UnitX();  ///< of the plane under way, world
        Vec3 held = Vec3::Zero();                            ///< where the pointer was at the last move, m, world
        double lastY = 0.0;                                  ///< of the pointer, pixels of the design
        double along = 0.0;                                  ///< that the plane was moved, m
        double slid = 0.0;                                   ///< the same, snapped
        Vec3 turned = Vec3::UnitX();                         ///< the normal that the pointer says
        Vec3 faced = Vec3::UnitX();                          ///< the same, snapped
        Vec3 sight = -Vec3::UnitZ();                         ///< unit, about which a typed angle turns
        TypedNumber typed = {};
        bool moved = false, modal = false;
        PointerEvent last;
        Eigen::Vector2d pressed = Eigen::Vector2d::Zero();   ///< logical pixels
        std::vector<std::vector<Vec3>> outline;              ///< of the section, world
        QString refusal;
    };
    [[nodiscard]] std::optional<Grip> grip(const PointerEvent& e) const;
    [[nodiscard]] CutPlane plane() const;  ///< under way, at rest
    /// Puts the plane where the pointer or the typed number says.
    void place();
    void preview();
    void settle();
    static void decorate(const Drag& drag, render::Scene& scene);
    [[nodiscard]] double pointed() const;
    [[nodiscard]] std::optional<Grip> chosen() const;  ///< the selected cut
    bool take(Grip grip, const PointerEvent& e, bool modal);

    StudioDocument& document_;
    Snap snap_;
    LazySections sections_{[this] {
        if (drag_) preview();
        Q_EMIT document_.hoverChanged();
    }};
    std::optional<Drag> drag_;
    std::weak_ptr<const Drag> keeps_;  ///< the one that the cut follows in a while
};

/// How far along a line (unit direction) the pointer's ray comes nearest to it, m; none: it looks along the line, nearly.
std::optional<double> alongLine(const PointerEvent& e, const Vec3& point, const Vec3& direction);

}  // namespace imomushi
