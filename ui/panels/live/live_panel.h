// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>

#include "ui/panels/live/calibration_bar.h"
#include "ui/panels/live/learn_bar.h"
#include "ui/panels/live/mapping_form.h"
#include "ui/panels/live/mapping_view.h"
#include "ui/panels/live/receiver_rows.h"
#include "ui/panels/live/source_rows.h"

class QLabel;
class QPushButton;
class QToolButton;

namespace imomushi {

class ActionSet;

/// Live inputs: who sends, what each control drives, what comes of it now, and who is told.
class LivePanel : public QWidget {
    Q_OBJECT
public:
    /// `actions`: "let-go", "load-mappings", "save-mappings" and "record" do what they say; the panel shows them as buttons, or names their keys.
    LivePanel(StudioDocument& document, InputDeck& inputs, OutputDeck& outputs, TakeDeck& deck, ActionSet& actions, QWidget* parent = nullptr);
    [[nodiscard]] MappingView* view() const { return view_; }
    [[nodiscard]] MappingModel* model() const { return model_; }
    [[nodiscard]] LearnBar* learnBar() const { return learn_; }

protected:
    void changeEvent(QEvent* event) override;
    void showEvent(QShowEvent* event) override;

private:
    void follow();   ///< says what comes next
    void followRow();
    void removeRow();
    void moveRow(int by);
    void takeSizes();
    void retranslate();
    [[nodiscard]] QString guide() const;

    StudioDocument& document_;
    InputDeck& inputs_;
    TakeDeck& deck_;
    ActionSet& actions_;
    MappingModel* model_;
    SourceRows* sources_;
    LearnBar* learn_;
    MappingView* view_;
    MappingForm* form_;
    QWidget *left_, *right_;
    QLabel* guide_;
    QPushButton *goOn_, *letGo_;
    QToolButton *up_, *down_, *remove_, *suggest_;
    std::vector<QToolButton*> buttons_;
    InputMapping chosen_;  ///< the row that was chosen, to be found again
};

}  // namespace imomushi
