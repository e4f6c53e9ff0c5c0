// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>
#include <vector>

#include "ui/models/input_deck.h"

class QLabel;
class QLineEdit;
class QPushButton;
class QToolButton;
class QVBoxLayout;

namespace imomushi {

class Switch;

/// Who may send: a switch, a port, whether other machines may, and what came so far, for each source.
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
        QLabel* state = nullptr;
    };
    void rebuild();
    void addRow(std::size_t source);
    void follow();
    void tell();

    InputDeck& inputs_;
    QVBoxLayout* list_;
    QPushButton* add_;
    std::vector<Row> rows_;
    std::vector<std::string> names_;  // of the sources that have rows
};

}  // namespace imomushi
