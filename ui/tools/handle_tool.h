// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "ui/picking/picking.h"
#include "ui/tools/handle_edit.h"
#include "ui/tools/pose_tool.h"
#include "ui/tools/tool.h"

namespace imomushi {

/// Makes handles: a press on a body makes one of the disc under the pointer, and drags it with the same press as the pose tool does. Handles that are there, and
/// ends of bones, are dragged. [ and ], or Ctrl and the wheel, set how large discs are; P pins, Delete removes. G moves the selected handle over the surface, S sets its radius.
class HandleTool : public Tool {
public:
    explicit HandleTool(StudioDocument& document) : Tool(document), pose_(document), edit_(document) {}
    void setOptions(const ToolOptions& options) override {
        ToolOptions posing = options;
        posing.passingHandles = {};
        pose_.setOptions(posing);
        edit_.setSnap(options.snap);
    }
    void press(const PointerEvent& e) override;
    void move(const PointerEvent& e) override;
    void release(const PointerEvent& e) override { pose_.release(e); }
    void leave() override;
    void doubleClick(const PointerEvent& e) override;
    bool wheel(double notches, const PointerEvent& e) override;
    bool key(int key, Qt::KeyboardModifiers modifiers, const QString& text = {}) override;
    [[nodiscard]] bool wants(int key) const override;
    void keyReleased(int key) override { pose_.keyReleased(key); }
    void cancel() override;
    [[nodiscard]] bool busy() const override { return edit_.busy() || pose_.busy(); }
    [[nodiscard]] bool modal() const override { return edit_.busy() || pose_.modal(); }
    [[nodiscard]] QString hint() const override;
    [[nodiscard]] QString banner() const override { return edit_.busy() ? edit_.banner() : pose_.banner(); }
    void decorate(render::Scene& scene) const override;

private:
    /// Shows what a press would make at a place; none: nothing.
    void preview(const std::optional<RayHit>& hit);
    void grow(int steps);
    /// The handle under the pointer. The first one on a body that nothing holds has it held where it stands. Its name.
    std::optional<std::string> make(const Element& of);
    [[nodiscard]] double radius(const Element& element) const;  ///< m
    [[nodiscard]] const Element* element() const;

    PoseTool pose_;
    HandleEdit edit_;
    std::optional<PointerEvent> last_;     ///< where keys begin
    std::optional<PoseGrip> grip_;         ///< under the pointer
    std::optional<RayHit> hit_;            ///< of the preview
    std::shared_ptr<const Element> seen_;  ///< that element when the preview was made: a changed one needs a new preview
    std::optional<JointFace> face_;        ///< what a press would make
    QString refusal_;                      ///< why a press makes nothing here
    int grown_ = 0;                        ///< the radius is that of a handle by default times kStep^grown
};

}  // namespace imomushi
