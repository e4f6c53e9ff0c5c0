// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "ui/picking/picking.h"
#include "ui/tools/snap.h"
#include "ui/tools/typed_number.h"

namespace imomushi {

/// Moves the selected handle over the surface of its element, or makes its disc larger or smaller, without a button. Where it would be is shown; the handle itself changes
/// at the end, in one undo step.
class HandleEdit {
public:
    enum class Does { Moves, Scales };

    explicit HandleEdit(StudioDocument& document) : document_(document), snap_(document) {}
    void setSnap(const SnapSettings& settings) { snap_.set(settings); }
    /// False: no handle is selected alone.
    bool begin(Does does, const PointerEvent& e);
    void move(const PointerEvent& e);
    void keep();
    void cancel() { edit_.reset(); }
    [[nodiscard]] bool busy() const { return edit_.has_value(); }
    /// True: used.
    bool key(int key, const QString& text);
    [[nodiscard]] QString banner() const;
    [[nodiscard]] QString hint() const;
    void decorate(render::Scene& scene) const;

private:
    struct Edit {
        Does does = Does::Moves;
        FaceRef handle;
        Vec3 point = Vec3::Zero();   ///< its middle from then on, of the surface at rest, m
        Vec3 seen = Vec3::Zero();    ///< the middle as it is shown, m
        double radius = 0.0;         ///< as it is, m
        double factor = 1.0;         ///< that the pointer says
        double goes = 1.0;           ///< the same, snapped
        PointerEvent last;
        TypedNumber typed;
        std::optional<JointFace> face;  ///< as it would be; none: `refusal` says why
        QString refusal;
        bool moved = false;
    };
    [[nodiscard]] std::shared_ptr<const Element> element() const;
    [[nodiscard]] double radius() const;
    void preview();

    StudioDocument& document_;
    Snap snap_;
    std::optional<Edit> edit_;
};

}  // namespace imomushi
