// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QFrame>
#include <array>
#include <string>

#include "core/document/source_calibration.h"
#include "ui/models/source_calibrator.h"

class QComboBox;
class QLabel;
class QPushButton;
class QToolButton;

namespace imomushi {

/// Calibrates one source: chooses the pose, counts down in numbers that are read from afar, and says how far off each pose is that was measured. Hidden unless open.
class CalibrationBar : public QFrame {
    Q_OBJECT
public:
    CalibrationBar(StudioDocument& document, InputDeck& inputs, SourceCalibrator& calibrator, QWidget* parent = nullptr);
    void open(const std::string& source);
    void close();
    [[nodiscard]] bool isOpen() const { return !source_.empty(); }

Q_SIGNALS:
    void opened(bool open);

protected:
    void changeEvent(QEvent* event) override;
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    struct Taken {
        QWidget* all = nullptr;
        QLabel* says = nullptr;
        QToolButton* clear = nullptr;
        std::string pose;
    };
    void fillPoses();
    void follow();
    void retranslate();

    StudioDocument& document_;
    InputDeck& inputs_;
    SourceCalibrator& calibrator_;
    std::string source_;  // empty: closed
    QWidget *choosing_, *counting_;
    QLabel *title_, *hint_, *trouble_, *countdown_, *says_;
    QComboBox* pose_;
    QPushButton *measure_, *cancel_;
    QToolButton* close_;
    std::array<Taken, SourceCalibration::kMostPoses> taken_;
};

}  // namespace imomushi
