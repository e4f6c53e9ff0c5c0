// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/mesh/surface_distance.h"
#include "ui/picking/picking.h"
#include "ui/tools/tool.h"

namespace imomushi {

/// The joint face that is selected alone, where it may become another patch: not of a handle, of a cut, joined, locked or hidden.
std::optional<FaceRef> freeFace(const StudioDocument& document);

/// A clause for a hint: the element must be precomputed again after an edit. Empty: it has no fresh result.
QString staleClause(const StudioDocument& document, PartId element);

/// Paints the selected joint face larger, with Ctrl smaller: a drag over the surface takes what lies within the brush, along the surface. What it would be is shown; the face
/// itself changes when the button is let go, in one undo step. Vertices of other faces are passed by.
class FaceBrush {
public:
    explicit FaceBrush(StudioDocument& document) : document_(document) {}
    /// False: no face is selected that may change.
    bool begin(const PointerEvent& e);
    /// It was begun, and its face is selected still.
    [[nodiscard]] bool on() const;
    [[nodiscard]] bool painting() const { return stroke_.has_value(); }
    void press(const PointerEvent& e);
    void move(const PointerEvent& e);
    void release();
    void leave() { hit_.reset(); }
    /// The radius: `steps` times a bit larger.
    void widen(int steps);
    /// Takes back what is being painted; where nothing is, the brush is put away.
    void cancel();
    void end() { face_.reset(), stroke_.reset(), hit_.reset(); }
    [[nodiscard]] QString hint() const;
    void decorate(render::Scene& scene) const;

private:
    struct Stroke {
        std::shared_ptr<const ElementMesh> mesh;
        std::unique_ptr<SurfaceDistance> surface;  ///< of mesh
        std::vector<char> in, others;              ///< by vertex: of the face as it would be; of another face
        bool removes = false;
        PointerEvent last;
        std::vector<std::int32_t> vertices, triangles;  ///< as it would be
        QString refusal;                                ///< why it cannot be
    };
    [[nodiscard]] const Element* element() const;
    [[nodiscard]] double radius(const Element& of) const;
    void dab(const RayHit& hit);
    void paint(const PointerEvent& to);
    void judge();
    void look(const PointerEvent& e);

    StudioDocument& document_;
    std::optional<FaceRef> face_;
    std::optional<Stroke> stroke_;
    std::optional<RayHit> hit_;  ///< of the element, under the pointer
    double pixel_ = 0.0;         ///< m that one covers there
    bool removing_ = false;      ///< Ctrl is down
    int widened_ = 0;
};

}  // namespace imomushi
