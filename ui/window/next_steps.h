// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QFrame>
#include <QString>
#include <set>
#include <string>

#include "core/document/document.h"

class QBoxLayout;
class QLabel;
class QMenu;

namespace imomushi {

class ActionSet;
class StudioDocument;

/// What comes next, over the view: how an empty project begins, and what makes a mesh soft that is there. It goes by itself when that is done; where something is there it can be closed.
class NextSteps : public QFrame {
    Q_OBJECT
public:
    /// `samples`: opens one.
    NextSteps(StudioDocument& document, const ActionSet& actions, QMenu* samples, QWidget* view);
    void retranslate();
    /// Something is being done about it: out of the way.
    void setWaiting(bool waiting);
    /// A file is held over the window.
    void setDropping(bool dropping);

    bool eventFilter(QObject* watched, QEvent* event) override;

signals:
    void makeSoftWanted(imomushi::PartId part);  ///< a character, or an element of its own

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    enum class Step { None, Begin, Soften, Hold, Bones };
    /// What is missing, and of which part.
    struct Wanted {
        Step step = Step::None;
        PartId subject = 0;
        bool operator==(const Wanted&) const = default;
    };
    [[nodiscard]] Wanted wanted() const;
    [[nodiscard]] QString keys() const;
    void follow();
    void rebuild();
    void place();

    StudioDocument& document_;
    const ActionSet& actions_;
    QMenu* samples_;
    QWidget* view_;
    QWidget* content_ = nullptr;
    QLabel* text_ = nullptr;
    QBoxLayout* buttons_ = nullptr;
    QBoxLayout* words_ = nullptr;   // and the buttons, of a step that goes on; null: of the first one
    Wanted shown_;
    std::string name_;              // of the subject, and the keys of its actions, as shown
    QString keys_;
    std::set<PartId> closed_;       // subjects that the artist does not want to hear of
    bool waiting_ = false, dropping_ = false;
};

}  // namespace imomushi
