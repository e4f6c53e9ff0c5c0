// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <QPolygonF>
#include <QRectF>
#include <QString>
#include <Qt>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "ui/models/studio_document.h"
#include "ui/picking/pointer_event.h"
#include "ui/render/scene.h"
#include "ui/tools/tool_kind.h"

namespace imomushi {

/// What the user does with the pointer in the viewport: select, place a joint face, place bones, place handles, pose, touch. No widgets, no OpenGL: tools can be tested
/// without a display. A tool changes the document through commands only; a drag is one gesture (one undo step), cancelled by Esc or the right button.
class Tool {
public:
    explicit Tool(StudioDocument& document) : document_(document) {}
    virtual ~Tool() = default;
    Tool(const Tool&) = delete;
    Tool& operator=(const Tool&) = delete;

    virtual void setOptions(const ToolOptions&) {}
    virtual void begin() {}                       ///< the user chose it
    virtual void press(const PointerEvent&) {}
    virtual void move(const PointerEvent&) {}     ///< also without a button: hover
    virtual void release(const PointerEvent&) {}
    virtual void leave() {}                       ///< the pointer left the viewport: nothing is hovered
    /// What a finger that lands on a touch screen is for: it acts as the pointer does; the tool has nothing there; it took hold of something, and fingerMoved() and fingerLifted() follow.
    enum class Landing { IsPointer, FoundNothing, Holds };
    virtual Landing fingerLanded(int /*id*/, const PointerEvent&) { return Landing::IsPointer; }
    virtual void fingerMoved(int /*id*/, const PointerEvent&) {}
    virtual void fingerLifted(int /*id*/, const PointerEvent&) {}
    virtual void doubleClick(const PointerEvent& e) { press(e); }
    virtual bool wheel(double /*notches*/, const PointerEvent&) { return false; }  ///< true: used, the view does not zoom
    /// `text`: what it types, see typedBy(). True: used.
    virtual bool key(int /*key*/, Qt::KeyboardModifiers, const QString& /*text*/ = {}) { return false; }
    /// The tool takes this key now, before any shortcut of the window that has the same.
    [[nodiscard]] virtual bool wants(int /*key*/) const { return false; }
    virtual void keyReleased(int /*key*/) {}
    virtual void cancel() {}                      ///< takes back an unfinished gesture (Esc, right button, focus lost)
    /// A gesture is open: it must be released or cancelled before anything else happens to the document.
    [[nodiscard]] virtual bool busy() const { return false; }
    /// The gesture goes on without a button, and a press ends it.
    [[nodiscard]] virtual bool modal() const { return false; }
    /// Something is unfinished that cancel() would end (an open gesture, a chain of bones, a placed plane).
    [[nodiscard]] virtual bool pending() const { return busy(); }
    /// It keeps steps of its own, which undo and redo go along; the document's wait.
    [[nodiscard]] virtual bool hasSteps() const { return false; }
    virtual void undo() {}
    virtual void redo() {}
    /// Its work is done: another tool follows.
    [[nodiscard]] virtual bool over() const { return false; }
    /// What must be known to go on, translated, shown over the view; empty: nothing.
    [[nodiscard]] virtual QString banner() const { return {}; }
    /// What the mouse buttons do now, translated, for the status bar.
    [[nodiscard]] virtual QString hint() const = 0;
    /// Adds what the tool shows to the scene (previews, handles).
    virtual void decorate(render::Scene&) const {}
    /// A box that is being dragged over the viewport, pixels of the design.
    [[nodiscard]] virtual std::optional<QRectF> box() const { return std::nullopt; }
    /// A loop that is being drawn there; empty: none.
    [[nodiscard]] virtual QPolygonF lasso() const { return {}; }

protected:
    StudioDocument& document_;
};

std::unique_ptr<Tool> makeTool(ToolKind kind, StudioDocument& document);

}  // namespace imomushi
