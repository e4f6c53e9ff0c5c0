// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ui/tools/body_drag.h"
#include "ui/tools/cut_drag.h"
#include "ui/tools/part_drag.h"
#include "ui/tools/pose_tool.h"

namespace imomushi {

/// Click selects, Shift+click adds or takes away, a click on nothing clears; Delete removes what is selected. A drag that begins on nothing selects all that its box
/// touches, or with Ctrl what its loop touches, with Shift beside what was selected. Ends of bones can be dragged as with the pose tool, and the plane of the selected cut;
/// attached parts are turned; selected elements and characters are moved, turned and scaled by their gizmo, or by G, R and S.
class SelectTool : public Tool {
public:
    explicit SelectTool(StudioDocument& document) : Tool(document), pose_(document), cut_(document), part_(document), body_(document) { pose_.showGizmo(true); }
    void setOptions(const ToolOptions& options) override {
        ToolOptions posing = options;
        posing.passingHandles = {};
        pose_.setOptions(posing);
        turnKey_ = options.turnKey;
        cut_.setSnap(options.snap);
        body_.setOptions(options);
    }
    void press(const PointerEvent& e) override;
    void move(const PointerEvent& e) override;
    void release(const PointerEvent& e) override;
    bool wheel(double notches, const PointerEvent& e) override { return part_.busy() ? part_.wheel(notches, e) : pose_.wheel(notches, e); }
    bool key(int key, Qt::KeyboardModifiers modifiers, const QString& text = {}) override;
    [[nodiscard]] bool wants(int key) const override;
    [[nodiscard]] bool modal() const override { return cut_.modal() || pose_.modal() || body_.modal(); }
    void keyReleased(int key) override { pose_.keyReleased(key); }
    void cancel() override;
    void leave() override {
        part_.leave();
        pose_.leaveGizmo();
        body_.hover(render::GizmoPart::None);
        overGizmo_ = false;
    }
    [[nodiscard]] bool busy() const override { return drag_ || cut_.busy() || part_.busy() || body_.busy() || pose_.busy(); }
    [[nodiscard]] QString hint() const override;
    [[nodiscard]] QString banner() const override { return body_.busy() ? body_.banner() : cut_.busy() ? cut_.banner() : part_.busy() ? part_.banner() : pose_.banner(); }
    void decorate(render::Scene& scene) const override {
        pose_.decorate(scene);
        cut_.decorate(scene);
        part_.decorate(scene);
        body_.decorate(scene);
    }
    [[nodiscard]] std::optional<QRectF> box() const override;
    [[nodiscard]] QPolygonF lasso() const override;

private:
    /// A box or a loop that is being dragged.
    struct Drag {
        QPointF from, to;
        bool free = false;  // a loop
        QPolygonF loop;
        std::vector<SelectionItem> before, kept;  // selected before it, and whatever it touches
    };
    PoseTool pose_;
    CutDrag cut_;
    PartDrag part_;
    BodyDrag body_;
    bool overGizmo_ = false, turnKey_ = true;
    bool overCut_ = false;  // the pointer is over the plane of the selected cut
    std::optional<Drag> drag_;
    std::optional<PointerEvent> last_;  // where keys begin
};

/// Selects `item` as a click with these modifiers does.
void selectByClick(StudioDocument& document, const std::optional<SelectionItem>& item, Qt::KeyboardModifiers modifiers);

/// Removes everything that is selected, in one undo step; all or nothing. False: nothing was selected or something refused (failed() said why).
bool removeSelection(StudioDocument& document);

}  // namespace imomushi
