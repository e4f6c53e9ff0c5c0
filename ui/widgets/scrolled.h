// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QScreen>
#include <QScrollArea>
#include <QScrollBar>

namespace imomushi {

/// What is scrolled where there is less room than it needs, without a frame.
class Scrolled : public QScrollArea {
public:
    Scrolled(QWidget* content, QWidget* parent) : QScrollArea(parent) {
        setWidgetResizable(true);
        setFrameShape(QFrame::NoFrame);
        setFocusPolicy(Qt::NoFocus);
        setWidget(content);
    }
};

/// Rows of words, cards and fields that are only scrolled up and down. As wide as they ask for; each row has the height that its words need beside the scroll bar.
class ScrolledRows : public Scrolled {
public:
    ScrolledRows(QWidget* rows, QWidget* parent) : Scrolled(rows, parent) { setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff); }
    [[nodiscard]] QSize minimumSizeHint() const override {
        return {widget()->minimumSizeHint().width() + verticalScrollBar()->sizeHint().width(), Scrolled::minimumSizeHint().height()};
    }

protected:
    void resizeEvent(QResizeEvent* event) override {
        Scrolled::resizeEvent(event);
        if (widget()->hasHeightForWidth()) widget()->setMinimumHeight(widget()->heightForWidth(viewport()->width()));
    }
};

/// A size that `window` can have on its screen, `wanted` if possible.
inline QSize withinScreen(const QWidget& window, const QSize& wanted) { return wanted.boundedTo(window.screen()->availableGeometry().size() * 0.9); }

}  // namespace imomushi
