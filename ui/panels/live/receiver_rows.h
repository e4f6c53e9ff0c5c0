// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>
#include <vector>

#include "ui/models/output_deck.h"

class QLabel;
class QLineEdit;
class QPushButton;
class QVBoxLayout;

namespace imomushi {

class Switch;

/// Who is told what is performed: a switch, an address, a port and what was sent, for each receiver.
class ReceiverRows : public QWidget {
    Q_OBJECT
public:
    explicit ReceiverRows(OutputDeck& outputs, QWidget* parent = nullptr);

protected:
    void changeEvent(QEvent* event) override;

private:
    struct Row {
        int key = 0;
        QWidget* all = nullptr;
        Switch* on = nullptr;
        QLineEdit *host = nullptr, *port = nullptr;
        QLabel* state = nullptr;
    };
    void rebuild();
    void addRow(std::size_t receiver);
    void follow();
    void tell();

    OutputDeck& outputs_;
    QLabel* title_;
    QVBoxLayout* list_;
    QPushButton* add_;
    std::vector<Row> rows_;
};

}  // namespace imomushi
