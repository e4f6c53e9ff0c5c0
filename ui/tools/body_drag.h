// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/document/hanging.h"
#include "ui/tools/snap.h"
#include "ui/tools/tool.h"
#include "ui/tools/transform_drag.h"

namespace imomushi {

/// Moves, turns and scales the selected elements and characters at rest, with what hangs together with them. What is seen goes along while the pointer or a typed number leads;
/// the document changes at the end, in one undo step.
class BodyDrag {
public:
    using Does = TransformDrag::Does;

    explicit BodyDrag(StudioDocument& document) : document_(document), snap_(document) {}
    void setOptions(const ToolOptions& options) {
        snap_.set(options.snap);
        shown_ = options.gizmo;
        space_ = options.space;
        gizmoParts_ = options.parts;
    }
    /// What is selected can be taken: elements and characters alone, none of which is locked.
    [[nodiscard]] bool chosen() const { return !parts().names.empty(); }
    /// What of the gizmo is under the pointer. Ends of bones and handles there come first.
    [[nodiscard]] render::GizmoPart gizmoPart(const PointerEvent& e) const;
    void hover(render::GizmoPart part) { hovered_ = part; }
    bool press(render::GizmoPart part, const PointerEvent& e);
    /// The pointer leads without a button.
    bool begin(Does does, const PointerEvent& e);
    void move(const PointerEvent& e) { (void)drag_->move(e, snap_); }
    /// False: it did not move.
    bool keep();
    void cancel() { drag_.reset(); }
    [[nodiscard]] bool busy() const { return drag_.has_value(); }
    [[nodiscard]] bool modal() const { return drag_ && drag_->modal(); }
    /// True: used.
    bool key(int key, Qt::KeyboardModifiers modifiers, const QString& text);
    [[nodiscard]] QString banner() const;
    [[nodiscard]] QString hint() const;
    void decorate(render::Scene& scene) const;

private:
    /// What is selected, as long as it stays that.
    struct Parts {
        std::vector<SelectionItem> selection;
        decltype(Document::elements) elements;
        decltype(Document::bones) bones;
        decltype(Document::joints) joints;
        std::vector<std::string> names;  ///< that a command is given; empty: it cannot be taken
        HangingParts hanging;
        Vec3 middle = Vec3::Zero();      ///< m, at rest
    };
    /// A body on its way.
    struct Moved {
        std::vector<float> positions, normals;
    };
    [[nodiscard]] const Parts& parts() const;
    [[nodiscard]] std::optional<GizmoPlace> gizmo() const;
    bool take(Does does, const PointerEvent& e, bool modal);
    void place(const TransformDrag& by, const HangingParts& hanging, render::Scene& scene) const;
    void carry(render::Body& body, Moved& moved, const Eigen::Affine3f& by) const;
    /// How many of the elements have a result, which a scale makes out of date.
    [[nodiscard]] int results() const;
    [[nodiscard]] bool recorded() const;  ///< a take shows the flesh of what moves

    StudioDocument& document_;
    Snap snap_;
    bool shown_ = true;
    GizmoSpace space_ = GizmoSpace::World;
    GizmoParts gizmoParts_ = GizmoParts::All;
    render::GizmoPart hovered_ = render::GizmoPart::None;
    std::optional<TransformDrag> drag_;
    /// What is seen until the parts are where they were put.
    struct Kept {
        TransformDrag by;
        HangingParts hanging;
    };
    std::weak_ptr<const Kept> keeps_;
    mutable Parts parts_;
    mutable std::map<std::uint64_t, Moved> moved_;  // what the scene points to until it is drawn
};

}  // namespace imomushi
