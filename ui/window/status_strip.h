// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QTimer>
#include <QWidget>
#include <functional>

#include "ui/jobs/estimate_job.h"
#include "ui/models/studio_document.h"
#include "ui/viewport/latency_meter.h"

class QLabel;
class QToolButton;

namespace imomushi {

class ElidedLabel;

/// The line at the foot: left what the mouse does now, right what the last frame warns of, the state of the precompute, vertices, milliseconds, frames per second and latency.
class StatusStrip : public QWidget {
    Q_OBJECT
public:
    /// `estimate`: what a precompute would cost now; none: not known yet, update() when it is.
    StatusStrip(StudioDocument& document, std::function<std::optional<PrecomputeEstimate>()> estimate, QWidget* parent = nullptr);
    void setHint(const QString& hint);
    void update();
    void setFrame(double cpuMs, double fps);
    void setLatency(const LatencyMeter::Latency& latency);
    void setBusy(const QString& text);  ///< empty: not busy
    [[nodiscard]] QString hint() const;

signals:
    void precomputeWanted();

protected:
    void changeEvent(QEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;

private:
    void showFrame();
    /// What there is no room for is not shown, what is needed least first.
    void makeRoom();
    void showWarnings();
    StudioDocument& document_;
    std::function<std::optional<PrecomputeEstimate>()> estimate_;
    QLabel* mouse_;
    ElidedLabel* hint_;
    QToolButton* warning_;
    QToolButton* state_;
    QLabel* vertices_;
    QLabel* ms_;
    QLabel* fps_;
    QLabel* latency_;        ///< empty: not measured yet
    LatencyMeter::Latency latencyNow_;
    QString busy_;
    double lastMs_ = -1.0, lastFps_ = 0.0;
    bool scheduled_ = false;
    unsigned warnings_ = 0;  ///< shown
    QTimer warned_;          ///< a warning stays as long as it takes to read it
};

}  // namespace imomushi
