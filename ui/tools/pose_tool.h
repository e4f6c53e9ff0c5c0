// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "ui/models/gesture.h"
#include "ui/picking/picking.h"
#include "ui/tools/axis_lock.h"
#include "ui/tools/gizmo.h"
#include "ui/tools/part_drag.h"
#include "ui/tools/snap.h"
#include "ui/tools/symmetry.h"
#include "ui/tools/tool.h"
#include "ui/tools/typed_number.h"

namespace imomushi {

class PoseFingers;

/// Drags the ends of bones, and handles: in the plane of the screen, or along X, Y or Z, or across them; typed numbers lead in its place; Shift fine, Ctrl snaps or not; R or Alt (or the wheel) turns
/// the end about its bone, a handle as a ball under the pointer, or about the locked axis. One drag is one undo step. P pins, a double click lets go; B has the trunk follow from the first, or not. Flesh
/// that is taken where there is neither moves the nearest of both, or, as the options say, a handle that is made there and goes when it is let go. K keeps it.
/// Attached parts are turned about their pivots. On a touch screen several fingers do all that at once (PoseFingers).
class PoseTool : public Tool {
public:
    explicit PoseTool(StudioDocument& document);
    ~PoseTool() override;
    void setOptions(const ToolOptions& options) override {
        options_ = options;
        snap_.set(options.snap);
    }
    /// Whether it shows the gizmo at the selected end or handle, where the options want it.
    void showGizmo(bool on) { gizmo_ = on; }
    /// What of that is under the pointer.
    [[nodiscard]] render::GizmoPart gizmoPart(const PointerEvent& e) const;
    void leaveGizmo() { hoveredPart_ = render::GizmoPart::None; }
    void press(const PointerEvent& e) override;
    /// Takes hold of what a press there drags. False: there is nothing of that kind.
    bool takeHold(const PointerEvent& e);
    /// Holds what was taken where it is, as if it had been dragged, and says again where it goes where it is dragged already.
    void holdStill();
    /// A drag moves this, itself or on the other side.
    [[nodiscard]] bool moves(const PoseGrip& grip) const { return drag_ && (drag_->end == grip || drag_->image == grip); }
    /// What is dragged itself; none: nothing, or an attached part.
    [[nodiscard]] std::optional<PoseGrip> dragged() const { return drag_ ? std::optional(drag_->end) : std::nullopt; }
    /// What is on the other side does not go along.
    void leaveImage() {
        if (drag_) drag_->image.reset();
    }
    /// What its step is called; of no name: after its last command.
    [[nodiscard]] Session::Step stepName() const;
    Landing fingerLanded(int id, const PointerEvent& e) override;
    void fingerMoved(int id, const PointerEvent& e) override;
    void fingerLifted(int id, const PointerEvent& e) override;
    /// As if it had been pressed.
    void grab(const PoseGrip& grip, const PointerEvent& e);
    /// Takes the selected end of a bone or handle, and the pointer leads or turns it without a button, until a press or Enter. False: none is selected.
    bool grabSelected(const PointerEvent& e, bool turns = false);
    [[nodiscard]] bool gripSelected() const { return selectedGrip().has_value(); }
    [[nodiscard]] bool modal() const override { return drag_ && drag_->modal; }
    void move(const PointerEvent& e) override;
    void release(const PointerEvent& e) override;
    void leave() override {
        hovered_.reset();
        overFlesh_ = false;
        hoveredPart_ = render::GizmoPart::None;
        part_.leave();
    }
    void doubleClick(const PointerEvent& e) override;
    bool wheel(double notches, const PointerEvent& e) override;
    bool key(int key, Qt::KeyboardModifiers modifiers, const QString& text = {}) override;
    [[nodiscard]] bool wants(int key) const override;
    void keyReleased(int key) override;
    void cancel() override;
    [[nodiscard]] bool busy() const override { return drag_ || flesh_ || part_.busy() || fingersHold(); }
    [[nodiscard]] QString hint() const override;
    [[nodiscard]] QString banner() const override;
    void decorate(render::Scene& scene) const override;

private:
    /// Flesh that was pressed, before the pointer moves.
    struct Flesh {
        RayHit hit;
        PointerEvent press;
    };
    /// A handle that passes with its drag.
    struct Passing {
        std::string element;
        Vec3 point = Vec3::Zero();  ///< of the rest shape, m
        double radius = 0.0;        ///< m
        bool kept = false;
    };
    /// Where it is dragged to.
    struct Aim {
        Vec3 to = Vec3::Zero();  ///< m
        std::optional<double> roll;
        Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    };
    struct Drag {
        PoseGrip end;
        std::unique_ptr<Gesture> gesture;   ///< opened by the first real movement: a click makes no undo step
        Vec3 origin = Vec3::Zero();       ///< where the end was when the drag began
        Vec3 target = Vec3::Zero();       ///< that the pointer says, before snapping
        Vec3 grip = Vec3::Zero();         ///< point of the drag plane under the pointer at the last move
        Vec3 normal = Vec3::UnitZ();      ///< of the plane through `target` in which the pointer moves
        double pressX = 0, pressY = 0, lastX = 0, lastY = 0;
        AxisLock lock;
        TypedNumber typed;
        std::optional<double> roll;       ///< of a bone's end, radians; none: never turned. That the pointer says
        Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< of a handle, from rest. That the pointer says
        double fromRoll = 0.0;            ///< when the drag began
        Eigen::Quaterniond fromRotation = Eigen::Quaterniond::Identity();
        std::optional<Passing> passing;
        bool modal = false;               ///< without a button
        bool ring = false;                ///< the pointer turns it about its middle
        bool held = false;                ///< a command took hold of it
        std::optional<Symmetry> symmetry;
        std::optional<PoseGrip> image;    ///< on the other side, which goes along
        bool alone = false;               ///< there is nothing on the other side, and it is not in the middle
        std::optional<Aim> given;         ///< where the performance was told to take it since the last command
        double follows = 1.0;             ///< how much the trunk stays upright where B turns that on
    };
    /// A passing handle that went, and where it was let go.
    struct LetGo {
        Passing passing;
        Vec3 at = Vec3::Zero();
        Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    };

    [[nodiscard]] bool fingersHold() const;
    [[nodiscard]] std::optional<PoseGrip> selectedGrip() const;
    [[nodiscard]] std::optional<PoseGrip> gripUnder(const PointerEvent& e) const;
    /// Where a passing handle would be made; none: what is under the pointer is moved otherwise.
    [[nodiscard]] std::optional<RayHit> fleshUnder(const PointerEvent& e) const;
    /// Begins a drag as if the grip had been pressed.
    void take(const PoseGrip& grip, const Vec3& at, const PointerEvent& e);
    /// As the pointer and what is typed say; `last`: of the pointer.
    [[nodiscard]] Aim aim(const PointerEvent& last);
    /// How far the pointer turned it, radians, about the axis that a typed angle is of.
    [[nodiscard]] double turned() const;
    [[nodiscard]] Vec3 turningAxis() const;
    /// Drags it there by a command; where that is refused, the drag is cancelled.
    void command(const Aim& to);
    [[nodiscard]] Aim mirrored(const Aim& to) const;
    /// Where it is now, as it is held.
    [[nodiscard]] Aim where(const PoseGrip& grip) const;
    bool dragTo(const PoseGrip& grip, const Aim& to);
    /// Takes hold of it where it is.
    void hold();
    /// To the performance. False: a command must do it.
    bool give(const PoseGrip& grip, const Aim& to);
    /// Makes a handle of the flesh, as small as it must be, and drags it. False: there is no place for one.
    bool makePassing(const Flesh& flesh);
    /// Drags the flesh that was pressed: by a passing handle, or what is nearest. False: there is neither.
    bool takeFlesh();
    /// Brings the passing handle back that was let go last.
    void bringBack();
    void follow(const PointerEvent& e);
    void turn(const PointerEvent& e);
    void turnAround(const PointerEvent& e);
    void pull(render::GizmoPart part, const PointerEvent& e);
    void issue(const PointerEvent& e);
    /// Typed numbers, and Enter, of a drag. True: used.
    bool type(int key, const QString& text);
    /// Ends the drag as it is.
    void keep();
    void toggle(const PoseGrip& grip);
    /// The trunk stays upright until the limb needs it, or leans with the limb from the first.
    void toggleFollowing();

    /// What moves with the end or handle that is dragged, or may: the bodies and bones that hang together with it.
    [[nodiscard]] Snap::Moving moving() const;

    [[nodiscard]] std::optional<GizmoPlace> gizmo() const;
    [[nodiscard]] Eigen::Matrix3d axesOf(const PoseGrip& grip) const;

    PartDrag part_;
    bool gizmo_ = false;
    render::GizmoPart hoveredPart_ = render::GizmoPart::None;
    Snap snap_;
    ToolOptions options_;
    std::optional<PoseGrip> hovered_;
    bool overFlesh_ = false;            ///< a press here makes a passing handle
    std::optional<Flesh> flesh_;
    std::optional<Drag> drag_;
    std::optional<LetGo> letGo_;
    std::optional<PointerEvent> last_;  ///< of the drag, for keys that act on it
    std::optional<PointerEvent> over_;  ///< where the pointer was last without one
    bool turning_ = false;              ///< R is held
    std::unique_ptr<PoseFingers> fingers_;  ///< made by the first that lands
};

}  // namespace imomushi
