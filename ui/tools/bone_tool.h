// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <set>

#include "ui/tools/picking.h"
#include "ui/tools/tool.h"

namespace imomushi {

/// Places bones: a click sets the start, the next click the end, and the chain goes on from there until Esc. Ends go to the centres of joint faces, to
/// ends of bones, or to the centre of the volume under the pointer. Shift+click starts a new chain at an end that exists.
class BoneTool : public Tool {
public:
    using Tool::Tool;
    void press(const PointerEvent& e) override;
    void move(const PointerEvent& e) override;
    void leave() override { hovered_.reset(); }
    bool key(int key, Qt::KeyboardModifiers modifiers) override;
    [[nodiscard]] bool wants(int key) const override { return start_ && (key == Qt::Key_Return || key == Qt::Key_Enter); }
    void cancel() override;
    [[nodiscard]] bool pending() const override { return start_.has_value(); }
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

    std::optional<Spot> start_, hovered_;
};

/// The elements that have this place: the face's own and those joined to it, or the one that the bone of a free end runs through.
std::set<PartId> elementsAt(const Document& document, const Bone::Place& place);

}  // namespace imomushi
