// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QColor>
#include <QImage>
#include <QPointF>
#include <QString>
#include <QWidget>

#include "ui/render/offscreen.h"
#include "ui/viewport/camera_controller.h"

namespace imomushi {

/// The colour as the renderer takes it: linear RGB.
Eigen::Vector3f linearColor(const QColor& color);

/// Bodies beside the document, drawn by the renderer of the viewport without a window of its own, as large as fits; dragging turns them.
class TurntableView : public QWidget {
    Q_OBJECT
public:
    explicit TurntableView(QWidget* parent = nullptr);

protected:
    /// Draws the pictures that paint() shows; called before it where something changed.
    virtual void drawPictures() = 0;
    virtual void paint(QPainter& painter) = 0;

    /// scene_ or the size of pictures changed.
    void invalidate();
    /// A picture of the visible bodies of scene_, `size` in logical pixels, on nothing. All bodies are framed, also invisible ones. `fill`: as framed().
    /// Null: it cannot be drawn, and failure() says why.
    QImage drawn(const QSize& size, double fill);
    [[nodiscard]] const QString& failure() const { return failure_; }

    void paintEvent(QPaintEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    void changeEvent(QEvent* event) override;

    render::Scene scene_;

private:
    CameraController camera_;
    render::OffscreenView renderer_;
    QString failure_;
    QPointF pointer_;
    double drawnRatio_ = 0.0;  ///< device pixels per logical pixel of the pictures; 0: they must be drawn
};

}  // namespace imomushi
