// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>
#include <vector>

#include "ui/models/source_calibrator.h"

class QComboBox;
class QHBoxLayout;
class QLabel;
class QLineEdit;
class QPushButton;
class QToolButton;
class QVBoxLayout;

namespace imomushi {

class Switch;

/// Who may send: a switch, a port and whether other machines may, or a device, and what came so far, for each source.
class SourceRows : public QWidget {
    Q_OBJECT
public:
    SourceRows(InputDeck& inputs, SourceCalibrator& calibrator, QWidget* parent = nullptr);

Q_SIGNALS:
    void calibrationWanted(const std::string& source);

protected:
    void changeEvent(QEvent* event) override;

private:
    struct Row {
        QWidget* all = nullptr;
        Switch* on = nullptr;
        QLineEdit* port = nullptr;
        QToolButton* network = nullptr;
        QComboBox* device = nullptr;  // of devices in the place of both
        QLabel* state = nullptr;
        QPushButton* calibrate = nullptr;
    };
    void rebuild();
    void addRow(std::size_t source);
    void addPort(Row& row, std::size_t source, QHBoxLayout& top);
    void addDevice(Row& row, std::size_t source);
    void fillDevices(QComboBox& box, const InputDeck::Source& source);
    void follow();
    void tell();
    void followCalibrations();

    InputDeck& inputs_;
    SourceCalibrator& calibrator_;
    QVBoxLayout* list_;
    QPushButton* add_;
    std::vector<Row> rows_;
    std::vector<std::string> names_;  // of the sources that have rows
};

}  // namespace imomushi
