// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QTimer>
#include <QWidget>
#include <array>
#include <vector>

#include "ui/models/studio_document.h"

namespace imomushi {

/// Where the milliseconds of a frame go.
struct FrameCosts {
    struct Row {
        QString name;
        double ms = -1.0;          ///< smoothed; negative: not measured
        double predicted = -1.0;   ///< negative: there is none
        bool effect = false;       ///< within the stages above it
        bool part = false;         ///< a stage of the character: of the bar
    };
    std::vector<Row> rows;
    double total = -1.0;           ///< ms of all stages of the character
};

/// Takes the costs of frames as they pass and smooths them, for whoever shows them.
class FrameCostMeter : public QObject {
    Q_OBJECT
public:
    explicit FrameCostMeter(StudioDocument& document, QObject* parent = nullptr);
    /// cpuMs: of the frame altogether, drawing included; uploadMs: of it, to bring what changed onto the graphics card.
    void take(double cpuMs, double fps, int vertices, double uploadMs);
    [[nodiscard]] FrameCosts costs() const;
    /// What effects were predicted to cost.
    void setPredicted(const std::array<EffectCost, kEffects>& costs);

signals:
    void changed();  ///< about three times a second

private:
    StudioDocument& document_;
    enum Stage { Bones, Joints, Equilibrium, Surfaces, Normals, Upload, Drawing, Stages };
    std::array<double, Stages> ms_;
    std::array<double, kEffects> predicted_;
    bool known_ = false;
    QTimer tell_;
};

/// One stacked bar of the character's stages, small enough for a status line; the tooltip lists them, and drawing too.
class CostBar : public QWidget {
    Q_OBJECT
public:
    explicit CostBar(FrameCostMeter& meter, QWidget* parent = nullptr);
    [[nodiscard]] QSize sizeHint() const override;

signals:
    void clicked();

protected:
    void paintEvent(QPaintEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;

private:
    FrameCostMeter& meter_;
};

/// The same as a list: a bar per stage and per effect, with what was predicted and how far that was off.
class CostList : public QWidget {
    Q_OBJECT
public:
    explicit CostList(FrameCostMeter& meter, QWidget* parent = nullptr);
    [[nodiscard]] QSize sizeHint() const override;

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    FrameCostMeter& meter_;
};

}  // namespace imomushi
