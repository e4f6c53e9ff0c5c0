// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>
#include <vector>

#include "ui/models/input_deck.h"

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
    explicit SourceRows(InputDeck& inputs, QWidget* parent = nullptr);

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
    };
    void rebuild();
    void addRow(std::size_t source);
    void addPort(Row& row, std::size_t source, QHBoxLayout& top);
    void addDevice(Row& row, std::size_t source);
    void fillDevices(QComboBox& box, const InputDeck::Source& source);
    void follow();
    void tell();

    InputDeck& inputs_;
    QVBoxLayout* list_;
    QPushButton* add_;
    std::vector<Row> rows_;
    std::vector<std::string> names_;  // of the sources that have rows
};

}  // namespace imomushi
