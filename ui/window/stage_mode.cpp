// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/stage_mode.h"

#include <QApplication>
#include <QDockWidget>
#include <QEvent>
#include <QMainWindow>
#include <QMenuBar>
#include <QScreen>
#include <QStatusBar>
#include <QTimer>
#include <QToolBar>

#include "ui/viewport/viewport_widget.h"
#include "ui/window/overlays.h"
#include "ui/window/studio_docks.h"

namespace imomushi {
namespace {

constexpr int kUnmanagedMs = 250;  // then nobody makes windows as large as the screen here, and this one does it itself

}  // namespace

StageMode::StageMode(QMainWindow& window, ViewportWidget& view, Overlays& overlays, StudioDocks& docks) : QObject(&window), window_(window), view_(view), overlays_(overlays), docks_(docks) {
    for (QToolBar* bar : window.findChildren<QToolBar*>()) around_ << bar;
    for (QDockWidget* dock : docks.all()) around_ << dock;
    for (QWidget* widget : around_) widget->installEventFilter(this);
}

void StageMode::set(bool on) {
    if (on == on_) return;
    if (on) {
        arrangement_ = window_.saveState();
        share_ = docks_.inspectorShare();
        state_ = window_.windowState();
        geometry_ = window_.geometry();
        focus_ = QApplication::focusWidget();
    }
    on_ = on;
    for (QWidget* bar : {static_cast<QWidget*>(window_.menuBar()), static_cast<QWidget*>(window_.statusBar())}) bar->setVisible(!on);
    overlays_.setCovered(on);
    view_.setBare(on);
    if (on) {
        for (QWidget* widget : around_) widget->hide();
        window_.setWindowState(state_ | Qt::WindowFullScreen);
        QTimer::singleShot(kUnmanagedMs, this, [this] {
            if (const QRect screen = window_.screen()->geometry(); on_ && window_.geometry() != screen) window_.setGeometry(screen);
        });
        view_.setFocus();
    } else {
        window_.setWindowState(state_);
        if (!(state_ & (Qt::WindowMaximized | Qt::WindowFullScreen))) window_.setGeometry(geometry_);
        window_.restoreState(arrangement_);
        if (share_ > 0.0) docks_.shareHeight(share_);
        if (focus_ && focus_->isVisible()) focus_->setFocus();
    }
    Q_EMIT changed(on);
}

// What a command would bring to the front waits behind the stage.
bool StageMode::eventFilter(QObject* watched, QEvent* event) {
    if (on_ && event->type() == QEvent::Show) QMetaObject::invokeMethod(this, [this, widget = static_cast<QWidget*>(watched)] {
        if (on_) widget->hide();
    }, Qt::QueuedConnection);
    return QObject::eventFilter(watched, event);
}

}  // namespace imomushi
