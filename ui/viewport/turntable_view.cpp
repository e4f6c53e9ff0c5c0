// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/turntable_view.h"

#include <QEvent>
#include <QMouseEvent>
#include <QPainter>
#include <cmath>

#include "core/base/colour.h"
#include "ui/models/failures.h"
#include "ui/models/texts.h"
#include "ui/scene/framing.h"
#include "ui/viewport/picture_warm_up.h"
#include "ui/widgets/appearance.h"

namespace imomushi {

Eigen::Vector3f linearColor(const QColor& color) {
    return {linearFromSrgb(color.redF()), linearFromSrgb(color.greenF()), linearFromSrgb(color.blueF())};
}

TurntableView::TurntableView(QWidget* parent) : QWidget(parent) {
    setCursor(Qt::OpenHandCursor);
    scene_.transparentBackground = true;
    connect(&PictureWarmUp::instance(), &BackgroundJob::finished, this, qOverload<>(&QWidget::update));
}

void TurntableView::invalidate() {
    drawnRatio_ = 0.0;
    update();
}

QImage TurntableView::drawn(const QSize& size, double fill) {
    failure_.clear();
    const double ratio = devicePixelRatioF();
    const int width = int(std::lround(size.width() * ratio)), height = int(std::lround(size.height() * ratio));
    if (scene_.bodies.empty() || width < 1 || height < 1) return {};
    scene_.darkTheme = palette().color(QPalette::Window).lightnessF() < 0.5f;
    scene_.pixelRatio = float(ratio * Appearance::instance().scale());
    scene_.camera = framed(scene_, -camera_.axes().col(2), double(width) / height, fill);
    const auto pixels = renderer_.draw(scene_, width, height);
    if (!pixels) {
        failure_ = errorText(pixels.error());
        return {};
    }
    QImage picture = QImage(pixels->data(), width, height, 4 * width, QImage::Format_RGBA8888).convertToFormat(QImage::Format_ARGB32_Premultiplied);
    picture.setDevicePixelRatio(ratio);
    return picture;
}

void TurntableView::paintEvent(QPaintEvent*) {
    PictureWarmUp& first = PictureWarmUp::instance();
    if (!first.done()) {
        first.begin();
    } else if (drawnRatio_ != devicePixelRatioF() && attempt([this] { drawPictures(); })) {  // else what was drawn last is shown
        drawnRatio_ = devicePixelRatioF();
    }
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    paint(painter);
}

void TurntableView::mousePressEvent(QMouseEvent* event) { pointer_ = event->position(); }

void TurntableView::mouseMoveEvent(QMouseEvent* event) {
    if (!(event->buttons() & Qt::LeftButton)) return;
    const QPointF by = event->position() - pointer_;
    pointer_ = event->position();
    camera_.orbit(by.x(), by.y());
    invalidate();
}

void TurntableView::resizeEvent(QResizeEvent* event) {
    QWidget::resizeEvent(event);
    invalidate();
}

void TurntableView::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::PaletteChange) invalidate();
}

}  // namespace imomushi
