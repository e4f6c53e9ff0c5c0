// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>
#include <optional>
#include <utility>
#include <vector>

#include "ui/models/take_deck.h"
#include "ui/models/take_model.h"

class QLabel;
class QListView;
class QPushButton;
class QToolButton;

namespace imomushi {

class ActionSet;
class ElidedLabel;
class TimeBar;

/// Records takes, lists them, and plays one along a time bar.
class TakesPanel : public QWidget {
    Q_OBJECT
public:
    /// `actions`: "record", "play" and their like do what they say; the panel shows them as buttons.
    TakesPanel(StudioDocument& document, TakeDeck& deck, ActionSet& actions, QWidget* parent = nullptr);
    [[nodiscard]] QListView* list() const { return list_; }
    [[nodiscard]] TimeBar* bar() const { return bar_; }
    [[nodiscard]] int heightForWidth(int width) const override;
    /// Edits the name of the chosen take.
    void rename();

signals:
    void heightWanted(int pixels);  ///< so that all its buttons are seen at this width

protected:
    bool event(QEvent* event) override;
    void changeEvent(QEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void follow();
    void takeSizes();
    /// Without takes the words on the right need the room more.
    void shareWidth();
    void askForHeight();
    void retranslate();
    void dressRecord();
    void showClips();
    void menu(const QPoint& global);

    StudioDocument& document_;
    TakeDeck& deck_;
    ActionSet& actions_;
    TakeModel* model_;
    QPushButton* record_;
    QListView* list_;
    QLabel* empty_;
    QWidget *left_, *records_;
    QWidget* takeButtons_;
    QToolButton *clips_, *moreClips_;  // where the file of the character has clips: while there is no take, and then
    QWidget* transport_;
    std::vector<QToolButton*> buttons_;
    ElidedLabel* clock_;
    QLabel* note_;
    QToolButton* live_;
    TimeBar* bar_;
    std::shared_ptr<const Take> barTake_;
    bool following_ = false;
    std::optional<std::pair<int, bool>> dressed_;  // what the button for recording looks like: -1 recording, else seconds of the count; without its key
};

}  // namespace imomushi
