// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/overlays.h"

#include <QEvent>
#include <algorithm>

#include "ui/widgets/appearance.h"
#include "ui/window/job_card.h"
#include "ui/window/message_bar.h"

namespace imomushi {

Overlays::Overlays(QWidget* view) : QObject(view), view_(view), message_(new MessageBar(view)), job_(new JobCard(view)) {
    view_->installEventFilter(this);
    add(job_);
    add(message_);
}

void Overlays::add(QFrame* overlay) {
    all_ << overlay;
    overlay->installEventFilter(this);
}

void Overlays::place() {
    int bottom = view_->height() - px(18);
    for (QFrame* overlay : all_) {
        if (!overlay->isVisible()) continue;
        // A job stands in the corner, beside the character; a message that takes its time lies where it is read.
        const bool corner = overlay == job_;
        const int width = std::min(px(corner ? 380 : 520), view_->width() - px(32));
        overlay->setFixedWidth(std::max(px(200), width));
        overlay->adjustSize();
        if (overlay->hasHeightForWidth()) overlay->resize(overlay->width(), overlay->heightForWidth(overlay->width()));  // no more than its words need
        overlay->move(corner ? px(16) : (view_->width() - overlay->width()) / 2, bottom - overlay->height());
        covered_ ? overlay->lower() : overlay->raise();
        bottom -= overlay->height() + px(8);
    }
}

void Overlays::setCovered(bool covered) {
    covered_ = covered;
    for (QFrame* overlay : all_) covered_ ? overlay->lower() : overlay->raise();
    place();
}

bool Overlays::eventFilter(QObject* watched, QEvent* event) {
    const auto type = event->type();
    // place() itself resizes the overlays.
    if (type == QEvent::Show || type == QEvent::Hide || type == QEvent::LayoutRequest || (type == QEvent::Resize && watched == view_))
        QMetaObject::invokeMethod(this, &Overlays::place, Qt::QueuedConnection);
    return QObject::eventFilter(watched, event);
}

}  // namespace imomushi
