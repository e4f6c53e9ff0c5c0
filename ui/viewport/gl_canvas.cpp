// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/gl_canvas.h"

#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QSurfaceFormat>

#include "ui/models/failures.h"

namespace imomushi {
namespace {

QSurfaceFormat wantedFormat() {
    QSurfaceFormat format;
    format.setVersion(3, 3);
    format.setProfile(QSurfaceFormat::CoreProfile);
    format.setDepthBufferSize(24);
    format.setSamples(0);  // the renderer smooths edges itself
    return format;
}

}  // namespace

bool GlCanvas::available() {
    QOpenGLContext context;
    context.setFormat(wantedFormat());
    if (!context.create()) return false;
    QOffscreenSurface surface;
    surface.setFormat(context.format());
    surface.create();
    if (!context.makeCurrent(&surface)) return false;
    context.doneCurrent();
    return context.format().version() >= qMakePair(3, 3);
}

GlCanvas::GlCanvas(QWidget* parent) : QOpenGLWidget(parent) {
    setFormat(wantedFormat());
    setUpdateBehavior(PartialUpdate);  // what was drawn stays where memory runs out for the next picture
    setAttribute(Qt::WA_TransparentForMouseEvents);
    setFocusPolicy(Qt::NoFocus);
}

GlCanvas::~GlCanvas() {
    if (context()) disconnect(context(), nullptr, this, nullptr);  // it goes after this
    releaseRenderer();
}

void GlCanvas::initializeGL() {
    // A widget that moves to another window gets another context, and everything in the old one goes with it.
    connect(context(), &QOpenGLContext::aboutToBeDestroyed, this, &GlCanvas::releaseRenderer, Qt::UniqueConnection);
    // Nothing may be thrown through QOpenGLWidget: it would take itself for one that is painting.
    attempt([this] {
        auto renderer = render::SceneRenderer::create();
        if (!renderer) {
            Q_EMIT failed(QString::fromStdString(renderer.error().message));
            return;
        }
        renderer_ = std::move(*renderer);
        Q_EMIT ready();
    });
}

void GlCanvas::paintGL() {
    if (renderer_) attempt([this] { Q_EMIT painting(); });
}

void GlCanvas::releaseRenderer() {
    if (!renderer_) return;
    makeCurrent();
    renderer_.reset();
    doneCurrent();
}

}  // namespace imomushi
