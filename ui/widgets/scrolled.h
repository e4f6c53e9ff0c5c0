// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QScreen>
#include <QScrollArea>
#include <QScrollBar>

namespace imomushi {

/// `content` without a frame around, which is scrolled where there is less room than it needs.
inline QScrollArea* scrolled(QWidget* content, QWidget* parent) {
    auto* scroll = new QScrollArea(parent);
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    scroll->setFocusPolicy(Qt::NoFocus);
    scroll->setWidget(content);
    return scroll;
}

/// Rows of words, cards and fields, scrolled up and down where there is less height than they need. It is as wide as they ask for, and each has the height that its words need at
/// the width which the scroll bar leaves.
class ScrolledRows : public QScrollArea {
public:
    ScrolledRows(QWidget* rows, QWidget* parent) : QScrollArea(parent) {
        setWidgetResizable(true);
        setFrameShape(QFrame::NoFrame);
        setFocusPolicy(Qt::NoFocus);
        setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
        setWidget(rows);
    }
    [[nodiscard]] QSize minimumSizeHint() const override {
        return {widget()->minimumSizeHint().width() + verticalScrollBar()->sizeHint().width(), QScrollArea::minimumSizeHint().height()};
    }

protected:
    void resizeEvent(QResizeEvent* event) override {
        QScrollArea::resizeEvent(event);
        if (widget()->hasHeightForWidth()) widget()->setMinimumHeight(widget()->heightForWidth(viewport()->width()));
    }
};

/// A size that `window` can have on its screen, `wanted` if possible.
inline QSize withinScreen(const QWidget& window, const QSize& wanted) { return wanted.boundedTo(window.screen()->availableGeometry().size() * 0.9); }

}  // namespace imomushi
