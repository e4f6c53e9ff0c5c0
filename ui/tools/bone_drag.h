// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "ui/picking/picking.h"
#include "ui/tools/gizmo.h"
#include "ui/tools/snap.h"
#include "ui/tools/symmetry.h"
#include "ui/tools/transform_drag.h"

namespace imomushi {

/// Moves, turns and scales ends of bones at rest: one that is dragged, or what is selected, without a button. Where the pointer or a typed number leads is shown; the bones
/// themselves change at the end, in one undo step. An end that is moved alone and snaps to nothing is hung on joint faces and other ends near to the pointer.
class BoneDrag {
public:
    using Does = TransformDrag::Does;

    explicit BoneDrag(StudioDocument& document) : document_(document), snap_(document) {}
    void setOptions(const ToolOptions& options) {
        snap_.set(options.snap);
        space_ = options.space;
        gizmoParts_ = options.parts;
        symmetry_ = options.symmetry;
    }
    /// Where the gizmo of what is selected stands; none: no bones are selected.
    [[nodiscard]] std::optional<GizmoPlace> gizmo() const;
    /// A part of it was pressed.
    bool press(render::GizmoPart part, const PointerEvent& e);
    /// The end was pressed.
    bool press(const EndpointRef& end, const PointerEvent& e);
    /// Takes what is selected; the pointer leads without a button. False: no bones are selected.
    bool begin(Does does, const PointerEvent& e);
    /// `near`: another place that the end would go to, with where it is shown; none: it goes where the pointer is.
    struct Place {
        Bone::Place place = Vec3(0, 0, 0);
        Vec3 shown = Vec3::Zero();
    };
    void move(const PointerEvent& e, const std::optional<Place>& near);
    /// Changes the bones. False: it did not move.
    bool keep();
    void cancel() { drag_.reset(); }
    [[nodiscard]] bool busy() const { return drag_.has_value(); }
    [[nodiscard]] bool modal() const { return drag_ && drag_->by.modal(); }
    /// It moves one end alone, which a place near to the pointer may take.
    [[nodiscard]] bool seeksPlace() const;
    /// True: used.
    bool key(int key, Qt::KeyboardModifiers modifiers, const QString& text);
    [[nodiscard]] QString banner() const;
    [[nodiscard]] QString hint() const;
    void decorate(render::Scene& scene) const;

private:
    /// A joint point.
    struct Point {
        int index = -1;                 ///< in the skeleton
        std::vector<EndpointRef> ends;  ///< of bones that have a place of their own there: the first leads, the others go to it
        Vec3 shown = Vec3::Zero(), rest = Vec3::Zero();                     ///< m
        Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();          ///< from rest to what is shown
    };
    /// A joint point that goes along on the other side.
    struct Image {
        Point point;
        std::size_t of = 0;  ///< of Drag::points
    };
    struct Drag {
        TransformDrag by;
        std::vector<Point> points;
        std::vector<Image> images = {};
        std::optional<Symmetry> symmetry = {};
        std::vector<EndpointRef> alone = {};  ///< ends that have nothing on the other side
        std::optional<Place> near = {};
    };
    [[nodiscard]] std::optional<Point> pointOf(const EndpointRef& end) const;
    /// Of what is selected.
    [[nodiscard]] std::vector<Point> chosen() const;
    void findImages(Drag& drag) const;
    /// Where ends go.
    struct Goal {
        std::vector<EndpointRef> ends;
        std::variant<std::string, Vec3> place;
    };
    /// False: refused.
    bool place(const Goal& goal);
    bool start(Does does, std::vector<Point> points, const PointerEvent& e, bool modal);
    [[nodiscard]] Vec3 placed(const Point& point) const;  ///< as shown

    StudioDocument& document_;
    Snap snap_;
    GizmoSpace space_ = GizmoSpace::World;
    GizmoParts gizmoParts_ = GizmoParts::All;
    bool symmetry_ = false;
    std::optional<Drag> drag_;
};

}  // namespace imomushi
