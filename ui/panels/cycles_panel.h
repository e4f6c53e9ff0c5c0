// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QStringList>
#include <QWidget>

#include "ui/models/input_deck.h"
#include "ui/models/studio_document.h"

class QLabel;
class QSlider;
class QToolButton;
class QTreeWidget;

namespace imomushi {

/// The cycles of the document, and two faders that play the chosen one with the mouse, as a controller would: how much there is of it, and how fast it runs.
class CyclesPanel : public QWidget {
    Q_OBJECT
public:
    CyclesPanel(StudioDocument& document, InputDeck& inputs, QWidget* parent = nullptr);
    [[nodiscard]] QTreeWidget* list() const { return list_; }
    [[nodiscard]] QSlider* amount() const { return amount_; }
    [[nodiscard]] QSlider* speed() const { return speed_; }
    /// Kept poses that are chosen, in their order: what a new cycle goes through.
    void choosePoses(const QStringList& poses);
    [[nodiscard]] QString chosen() const;  ///< empty: none
    /// Makes cycles that suit the skeleton, by names in the language of the window, and chooses the first.
    void suggest();
    /// Half of the chosen one, or of the first, runs at once, unless one is drawn up already: then that goes on, if it was waiting.
    void begin();

protected:
    void changeEvent(QEvent* event) override;
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void follow();
    void followFaders();
    void play();
    void retranslate();
    void rename(const QString& cycle, const QString& name);
    void setSeconds(const QString& cycle, const QString& text);
    void makeNew();
    void remove();
    void choose(const QString& cycle);

    StudioDocument& document_;
    InputDeck& inputs_;
    QStringList poses_;
    QLabel *title_, *empty_, *amountLabel_, *speedLabel_, *amountNow_, *speedNow_;
    QToolButton *new_, *suggest_, *remove_;
    QTreeWidget* list_;
    QSlider *amount_, *speed_;
    bool following_ = false;
};

}  // namespace imomushi
