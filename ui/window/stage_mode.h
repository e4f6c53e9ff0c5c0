// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QByteArray>
#include <QObject>
#include <QPointer>
#include <QRect>

class QMainWindow;
class QWidget;

namespace imomushi {

class Overlays;
class StudioDocks;
class ViewportWidget;

/// The stage: the view alone, on the whole screen where the window stands, without panels, bars, marks or words. Afterwards the window is as it was.
class StageMode : public QObject {
    Q_OBJECT
public:
    StageMode(QMainWindow& window, ViewportWidget& view, Overlays& overlays, StudioDocks& docks);
    [[nodiscard]] bool on() const { return on_; }
    void set(bool on);

    bool eventFilter(QObject* watched, QEvent* event) override;

Q_SIGNALS:
    void changed(bool on);

private:
    QMainWindow& window_;
    ViewportWidget& view_;
    Overlays& overlays_;
    StudioDocks& docks_;
    QList<QWidget*> around_;     ///< panels and tool bars
    bool on_ = false;
    QByteArray arrangement_;     ///< as it was
    double share_ = 0.0;
    QRect geometry_;
    Qt::WindowStates state_;
    QPointer<QWidget> focus_;
};

}  // namespace imomushi
