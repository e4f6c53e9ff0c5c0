// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <set>

#include "ui/picking/picking.h"
#include "ui/tools/bone_drag.h"
#include "ui/tools/tool.h"

namespace imomushi {

/// Places bones: a click sets the start, the next click the end, and the chain goes on from there until Esc. Ends go to the centres of joint faces, to
/// ends of bones, or to the centre of the volume under the pointer. Shift+click starts a new chain at an end that exists.
/// Ends that are there are dragged, at rest; G, R and S move, turn and scale the selected bones.
class BoneTool : public Tool {
public:
    explicit BoneTool(StudioDocument& document) : Tool(document), drag_(document) {}
    void setOptions(const ToolOptions& options) override {
        drag_.setOptions(options);
        gizmo_ = options.gizmo;
        symmetry_ = options.symmetry;
        space_ = options.space;
        turnKey_ = options.turnKey;
    }
    void press(const PointerEvent& e) override;
    void move(const PointerEvent& e) override;
    void release(const PointerEvent& e) override;
    void leave() override {
        hovered_.reset();
        part_ = render::GizmoPart::None;
    }
    bool key(int key, Qt::KeyboardModifiers modifiers, const QString& text = {}) override;
    [[nodiscard]] bool wants(int key) const override;
    void cancel() override;
    [[nodiscard]] bool busy() const override { return drag_.busy(); }
    [[nodiscard]] bool modal() const override { return drag_.modal(); }
    [[nodiscard]] bool pending() const override { return start_ || busy(); }
    [[nodiscard]] QString banner() const override { return drag_.banner(); }
    [[nodiscard]] QString hint() const override;
    void decorate(render::Scene& scene) const override;

private:
    /// Where an end of a bone could go.
    struct Spot {
        Bone::Place place = Vec3(0, 0, 0);
        Vec3 shown = Vec3::Zero();    ///< posed, for the preview
        Vec3 rest = Vec3::Zero();
        std::set<PartId> elements;    ///< that have this point: through joined faces two or more
        bool operator==(const Spot& other) const { return place == other.place; }
    };

    [[nodiscard]] std::optional<Spot> spotUnder(const PointerEvent& e) const;
    [[nodiscard]] std::optional<Spot> spotAt(const EndpointRef& end) const;
    [[nodiscard]] std::optional<Spot> spotAt(const FaceRef& face) const;
    [[nodiscard]] bool stillThere(const Spot& spot) const;
    void addBone(const Spot& from, const Spot& to);
    /// Makes the mirror image of a bone, where it has none; says why not.
    void mirror(const Symmetry& symmetry, const std::string& name);
    void click(const PointerEvent& e);
    /// Where the end that is dragged would go.
    [[nodiscard]] std::optional<BoneDrag::Place> placeUnder(const PointerEvent& e) const;
    [[nodiscard]] std::optional<FaceRef> faceUnder(const PointerEvent& e) const;
    [[nodiscard]] bool bonesSelected() const;

    /// The gizmo, where it is shown: not while a chain is being placed.
    [[nodiscard]] std::optional<GizmoPlace> gizmo() const { return gizmo_ && !start_ && !drag_.busy() ? drag_.gizmo() : std::nullopt; }
    /// What of it is under the pointer; an end of a bone there comes before its middle.
    [[nodiscard]] render::GizmoPart gizmoPart(const PointerEvent& e) const;

    BoneDrag drag_;
    bool gizmo_ = true, symmetry_ = false, turnKey_ = true;
    GizmoSpace space_ = GizmoSpace::World;
    render::GizmoPart part_ = render::GizmoPart::None;  ///< under the pointer
    std::optional<EndpointRef> dragged_;
    std::optional<Spot> start_, hovered_;
    std::optional<PointerEvent> last_;  ///< where keys begin
};

/// The elements that have this place: the face's own and those joined to it, or the one that the bone of a free end runs through.
std::set<PartId> elementsAt(const Document& document, const Bone::Place& place);

}  // namespace imomushi
