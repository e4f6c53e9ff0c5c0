// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>
#include <vector>

#include "ui/models/input_deck.h"
#include "ui/models/mapping_texts.h"

class QComboBox;
class QLabel;
class QPushButton;

namespace imomushi {

class ElidedLabel;

/// Chooses what a control is to drive, by a list or by what is selected, and learns the control that somebody moves.
class LearnBar : public QWidget {
    Q_OBJECT
public:
    LearnBar(StudioDocument& document, InputDeck& inputs, QWidget* parent = nullptr);
    /// As a mapping writes it; empty: nothing can be driven.
    [[nodiscard]] std::string target() const;
    void setTarget(const std::string& target);

protected:
    void changeEvent(QEvent* event) override;

private:
    void fillThings();
    void fillNumbers();
    void followSelection();
    void follow();
    void tell();
    void retranslate();

    StudioDocument& document_;
    InputDeck& inputs_;
    std::vector<DrivenThing> things_;
    QComboBox *thing_, *number_;
    QPushButton *learn_, *use_, *stop_;
    QLabel* sign_;
    ElidedLabel* says_;
    QWidget *choosing_, *learning_;
};

}  // namespace imomushi
