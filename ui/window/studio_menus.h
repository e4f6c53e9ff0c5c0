// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QList>
#include <QObject>
#include <utility>
#include <vector>

class QAction;
class QMainWindow;
class QMenu;
class QToolBar;

namespace imomushi {

class ActionSet;
class RecentFiles;

/// Where the actions are found: the menus, with recent files and samples among them, and the tool bar.
class StudioMenus : public QObject {
    Q_OBJECT
public:
    /// `panels`: shows and hides each panel.
    StudioMenus(QMainWindow& window, ActionSet& actions, RecentFiles& recent, const QList<QAction*>& panels);
    void retranslate();
    void takeSizes();
    [[nodiscard]] QMenu* samplesMenu() const { return samplesMenu_; }
    /// What can be done with what is selected.
    void popUpContextMenu(const QPoint& global);

signals:
    void fileWanted(const QString& path);

private:
    void buildMenus(const QList<QAction*>& panels);
    void buildToolBar();
    QMenu* addMenu(QMenu* in, const char* title);
    void fill(QMenu& menu, std::initializer_list<const char*> actions);  ///< "": a separator
    void fillFiles();
    void addFile(QMenu& menu, const QString& text, const QString& path);

    QMainWindow& window_;
    ActionSet& actions_;
    RecentFiles& recent_;
    QToolBar* tools_;
    QMenu *recentMenu_, *samplesMenu_;
    std::vector<std::pair<QMenu*, const char*>> menus_;  ///< with their untranslated titles
};

}  // namespace imomushi
