// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>

#include "ui/jobs/accuracy_job.h"
#include "ui/models/studio_document.h"
#include "ui/panels/accuracy/frame_costs.h"

class QDoubleSpinBox;
class QLabel;
class QProgressBar;
class QPushButton;
class QSlider;
class QTabWidget;

namespace imomushi {

class AccuracyErrors;
class AccuracyPlot;
class AccuracyTable;
class EffectCostTable;

/// What accuracy costs in time: the study of this character on this machine, and a point of it taken over with one click.
class AccuracyPanel : public QWidget {
    Q_OBJECT
public:
    AccuracyPanel(StudioDocument& document, FrameCostMeter& meter, QWidget* parent = nullptr);
    [[nodiscard]] AccuracyJob& job() { return *job_; }
    [[nodiscard]] const AccuracyStudy& study() const { return study_; }
    /// Shows a study; tests bring their own.
    void show(const AccuracyStudy& study);
    [[nodiscard]] int chosen() const { return chosen_; }
    void choose(int point);
    /// Takes the chosen point over, as one step.
    void apply();
    void showCosts();

protected:
    void changeEvent(QEvent* event) override;
    void showEvent(QShowEvent* event) override;

private:
    QWidget* makeControls();
    QWidget* makeTabs(FrameCostMeter& meter);
    void connectParts();
    void retranslate();
    void start();
    void recall();       ///< takes what is known of the character as it is now
    void showState();
    void showPoints();
    void showChosen();
    [[nodiscard]] QString tip(int point) const;

    StudioDocument& document_;
    AccuracyJob* job_;
    AccuracyStudy study_;
    std::vector<std::size_t> front_;  ///< per frame, cheapest first
    int chosen_ = -1;
    bool outdated_ = true;            ///< the character changed since `study_` was taken

    QLabel *title_, *state_, *reference_, *chosenText_, *budgetLabel_, *budgetText_, *faster_, *truer_;
    QPushButton *measure_, *apply_, *budgetUse_;
    QProgressBar* progress_;
    QSlider* slider_;
    QDoubleSpinBox* budget_;
    AccuracyPlot *frame_, *precompute_;
    QTabWidget* tabs_;
    AccuracyTable* table_;
    EffectCostTable* effects_;
    AccuracyErrors* errors_;
    QTimer recall_;
};

}  // namespace imomushi
