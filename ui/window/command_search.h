// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAction>
#include <QFrame>
#include <QList>

class QLineEdit;
class QListWidget;

namespace imomushi {

/// Type a few letters, press Enter: every action of the menus, with its shortcut.
class CommandSearch : public QFrame {
    Q_OBJECT
public:
    CommandSearch(const QList<QAction*>& actions, QWidget* window);
    void popUp();

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void fill(const QString& text);
    void run();
    QList<QAction*> actions_;
    QLineEdit* line_;
    QListWidget* list_;
};

/// How well `text` fits what was typed: its letters in order, whole words first. 0: not at all.
int searchScore(const QString& typed, const QString& text);

}  // namespace imomushi
