// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QFrame>
#include <QIcon>
#include <QString>
#include <functional>
#include <vector>

class QLabel;
class QLineEdit;
class QListWidget;

namespace imomushi {

/// Something that can be found by its name.
struct Findable {
    QIcon icon;
    QString name, kind;         ///< what it is called, and what it is ("Effect"); of commands the menu says nothing
    QString keys;               ///< its shortcut
    QString why;                ///< why it cannot be done now; empty: it can
    std::function<void()> run;  ///< what Enter does
};

/// Type a few letters, press Enter: commands, panels, effects, settings, samples, and what the project has.
class CommandSearch : public QFrame {
    Q_OBJECT
public:
    CommandSearch(std::vector<Findable> all, QWidget* window);
    void popUp();

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void fill(const QString& text);
    void run();
    std::vector<Findable> all_;
    QLineEdit* line_;
    QListWidget* list_;
    QLabel* none_;
};

/// How well `text` fits what was typed: its letters in order, whole words first. 0: not at all.
int searchScore(const QString& typed, const QString& text);

}  // namespace imomushi
