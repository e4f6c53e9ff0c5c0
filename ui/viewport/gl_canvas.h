// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QOpenGLWidget>
#include <memory>

#include "ui/render/scene_renderer.h"

namespace imomushi {

/// An OpenGL 3.3 surface with a renderer, for a widget around it: pointer and keys go through to that.
class GlCanvas : public QOpenGLWidget {
    Q_OBJECT
public:
    explicit GlCanvas(QWidget* parent);
    ~GlCanvas() override;

    /// Ask before one is made: in a window that cannot have OpenGL, Qt 6.4 crashes at the first repaint.
    static bool available();
    /// Null: there is none, or not yet. Use it in painting() only.
    [[nodiscard]] render::SceneRenderer* renderer() const { return renderer_.get(); }

Q_SIGNALS:
    /// The context was made, and with it a renderer; a widget that moves to another window gets others.
    void ready();
    /// No renderer: what the driver said.
    void failed(const QString& why);
    /// The context is current and defaultFramebufferObject() bound.
    void painting();

protected:
    void initializeGL() override;
    void paintGL() override;

private:
    void releaseRenderer();
    std::unique_ptr<render::SceneRenderer> renderer_;
};

}  // namespace imomushi
