// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "ui/picking/picking.h"
#include "ui/tools/cut_drag.h"
#include "ui/tools/face_brush.h"
#include "ui/tools/tool.h"

namespace imomushi {

/// Makes joint faces: a click takes the flat region under the pointer; Shift places a plane and Enter takes what lies in it. Ctrl looks behind the
/// surface in front, to where two elements touch. A face that meets one of a neighbour (or a flat region of its own shape there) is joined
/// to it in the same undo step. Where the flesh has no flat region, a click cuts it across, and Enter where the plane lies; cuts that are there are selected by
/// their rims, and dragged. A selected face that nothing holds grows and shrinks by rings of vertices, takes the flat region under the pointer, and is painted with a brush.
class FaceTool : public Tool {
public:
    explicit FaceTool(StudioDocument& document) : Tool(document), snap_(document), drag_(document), brush_(document) {}
    void setOptions(const ToolOptions& options) override {
        snap_.set(options.snap);
        drag_.setSnap(options.snap);
    }
    void press(const PointerEvent& e) override;
    void move(const PointerEvent& e) override;
    void release(const PointerEvent& e) override;
    void leave() override {
        brush_.leave();
        if (!plane_) clearPreview();
    }
    bool wheel(double notches, const PointerEvent& e) override;
    bool key(int key, Qt::KeyboardModifiers modifiers, const QString& text = {}) override;
    [[nodiscard]] bool wants(int key) const override;
    void cancel() override;
    [[nodiscard]] bool busy() const override { return drag_.busy() || edit_ || brush_.painting(); }
    [[nodiscard]] bool modal() const override { return drag_.modal() || edit_; }
    [[nodiscard]] bool pending() const override { return plane_.has_value() || drag_.busy() || brush_.on(); }
    [[nodiscard]] QString hint() const override;
    [[nodiscard]] QString banner() const override;
    void decorate(render::Scene& scene) const override;

private:
    struct Plane {
        PartId element = 0;
        Vec3 origin = Vec3::Zero(), normal = Vec3::UnitZ();  ///< at rest, as the command takes it
        Vec3 shownOrigin = Vec3::Zero(), shownNormal = Vec3::UnitZ();  ///< posed, as it is drawn
        bool dragging = false;
        Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< from rest to what is shown
    };

    /// The placed plane is moved along its normal, or turned, without a button.
    struct PlaneEdit {
        Plane before;
        bool turns = false;
        PointerEvent last;
        double held = 0.0;   ///< along the normal, where the pointer was at the last move, m
        double by = 0.0;     ///< that the pointer says, m or radians
        double goes = 0.0;   ///< the same, snapped
        Vec3 sight = -Vec3::UnitZ();  ///< unit, about which it turns
        TypedNumber typed = {};
    };
    bool editPlane(bool turns, const PointerEvent& e);
    void followPlane(const PointerEvent& e);
    void placeEdited();

    void look(PartId element);
    void preview(const RayHit& hit);
    void previewPlane();
    /// Shows where the flesh would be cut, or why not.
    void previewCut(std::shared_ptr<const SectionFinder> finder, SectionFinder::Across found);
    void cut();
    /// Selects the cut that was made, and says so.
    static void showCut(StudioDocument& document, const Json& answer);
    /// Null: it is being made; then lookAgain() follows.
    [[nodiscard]] std::shared_ptr<const SectionFinder> sections(const std::shared_ptr<const Element>& element);
    /// Shows `face`, or why there is none.
    void setPreview(const Element& of, Result<JointFace> face);
    void clearPreview();
    void placePlane(const RayHit& hit);
    void movePlane(double steps);
    bool widen(int steps);
    void create();
    /// The selected face, where the pointer is over its element and it may change.
    [[nodiscard]] std::optional<FaceRef> edited() const;
    void grow(int rings);
    /// Adds the flat region under the pointer.
    void flood();
    /// What lies under the pointer has changed.
    void lookAgain();
    bool brushKey(int key);
    bool editKey(int key, Qt::KeyboardModifiers modifiers);
    /// What keys do with the selected face, and what an edit of a face costs; empty: nothing.
    [[nodiscard]] QString editHint() const;
    [[nodiscard]] const Element* element() const;
    [[nodiscard]] double tolerance(const Element& element) const;
    [[nodiscard]] Result<JointFace> flatRegion(const Element& element, std::int32_t triangle, const SectionFinder* finder) const;  ///< finder: of its body, null: none is there

    PartId element_ = 0;              ///< of the preview
    std::shared_ptr<const Element> seen_;  ///< that element when the preview was made: a changed one needs a new preview
    std::int32_t seed_ = -1;          ///< triangle under the pointer
    Vec3 seedRest_ = Vec3::Zero();    ///< the point there, at rest, m
    std::optional<JointFace> face_;   ///< what a click (Enter) would make
    std::string existing_;            ///< the joint face under the pointer, or the one that is in the way
    QString refusal_;                 ///< why a click makes nothing here
    std::optional<Plane> plane_;
    std::optional<PlaneEdit> edit_;   ///< of plane_
    Snap snap_;
    std::optional<CutPlane> cut_;     ///< at rest, what a click (Enter) would cut; none: it makes a face
    std::optional<SectionFinder::Outline> section_;  ///< of cut_
    std::shared_ptr<const SectionFinder> sectioned_;  ///< that found it
    LazySections sections_{[this] {
        lookAgain();
        Q_EMIT document_.hoverChanged();
    }};
    bool waits_ = false;              ///< for sections_: a click or a key wants them now
    std::shared_ptr<FaceTool*> itself_ = std::make_shared<FaceTool*>(this);  ///< gone with this, while a cut is being made
    std::weak_ptr<const CutPlane> cutting_;          ///< the cut that is being made
    bool overCut_ = false;            ///< the pointer is over the plane of the selected cut
    CutDrag drag_;
    FaceBrush brush_;
    std::optional<PointerEvent> last_;  ///< where keys begin
    int widened_ = 0;                 ///< tolerance = kTolerance * 2^widened of the diagonal
};

/// The same place, the same shape and opposite normals: two faces that can be joined (the manual's model, "A joint face").
bool facesMeet(const JointFace& a, const JointFace& b);

/// Joins `face` with what meets it: a face of a neighbour, or a flat region of the same shape, which becomes a face. Answers how many were joined;
/// a refused join is told by failed() and changes nothing. Inside a gesture of the caller.
int joinNeighbours(StudioDocument& document, const FaceRef& face);

/// "face 1", "face 2", ...: the first that the element does not have yet.
std::string freeFaceName(const Element& element);

}  // namespace imomushi
