// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QImage>
#include <QWidget>
#include <memory>

#include "core/io/import.h"

namespace imomushi {

/// A small shaded picture of bodies that are not in the document yet, standing on the ground; dragging turns it. Drawn by the processor, so that
/// no second OpenGL context is needed.
class MeshPreview : public QWidget {
    Q_OBJECT
public:
    explicit MeshPreview(QWidget* parent = nullptr);
    void show(std::shared_ptr<const Result<ImportResult>> result);

protected:
    void paintEvent(QPaintEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;

private:
    void draw();
    std::shared_ptr<const Result<ImportResult>> result_;
    QImage picture_;
    double yaw_ = 0.6, pitch_ = 0.35;
    QPointF last_;
};

}  // namespace imomushi
