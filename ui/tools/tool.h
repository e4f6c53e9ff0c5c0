// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <Qt>
#include <functional>
#include <vector>

#include "ui/models/studio_document.h"
#include "ui/render/scene_renderer.h"

namespace imomushi {

/// A pointer event in the viewport, in logical pixels, with the ray under it.
struct PointerEvent {
    double x = 0, y = 0;
    Qt::MouseButton button = Qt::NoButton;
    Qt::MouseButtons buttons;
    Qt::KeyboardModifiers modifiers;
    Vec3 rayOrigin = Vec3::Zero();     ///< world
    Vec3 rayDirection = Vec3::UnitZ(); ///< unit
    Vec3 viewForward = -Vec3::UnitZ(); ///< unit, for dragging in the plane of the screen
    render::SceneRenderer::Pick pick;  ///< what lies under the pointer
};

/// What the user does with the pointer in the viewport: select, place a joint face, place bones, pose. No widgets, no OpenGL: tools can be tested
/// without a display. A tool changes the document through commands only; a drag is one gesture (one undo step), cancelled by Esc or the right button.
class Tool {
public:
    explicit Tool(StudioDocument& document) : document_(document) {}
    virtual ~Tool() = default;

    virtual void press(const PointerEvent&) {}
    virtual void move(const PointerEvent&) {}     ///< also without a button: hover
    virtual void release(const PointerEvent&) {}
    virtual bool key(int /*key*/, Qt::KeyboardModifiers) { return false; }  ///< true: used
    virtual void cancel() {}                      ///< takes back an unfinished gesture (Esc, right button, focus lost)
    /// What the mouse buttons do now, translated, for the status bar.
    [[nodiscard]] virtual QString hint() const = 0;
    /// Adds what the tool shows to the scene (previews, handles).
    virtual void decorate(render::Scene&) const {}

protected:
    StudioDocument& document_;
};

}  // namespace imomushi
