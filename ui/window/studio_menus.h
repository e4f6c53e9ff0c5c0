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
class StudioDocks;

/// Where the actions are found: the menus, with recent files and samples among them, and the tool bar.
class StudioMenus : public QObject {
    Q_OBJECT
public:
    StudioMenus(QMainWindow& window, ActionSet& actions, RecentFiles& recent, StudioDocks& docks);
    void retranslate();
    void takeSizes();
    /// Puts the groups of tools into as many columns as it takes for all of them to be seen.
    void wrapTools();
    [[nodiscard]] QMenu* samplesMenu() const { return samplesMenu_; }
    /// What can be done with what is selected.
    void popUpContextMenu(const QPoint& global);

    bool eventFilter(QObject* watched, QEvent* event) override;  ///< says over a menu why something cannot be done

signals:
    void fileWanted(const QString& path);
    void replayWanted(const QString& title, const QString& script);  ///< how a sample was built

private:
    void buildMenus(StudioDocks& docks);
    void buildToolBar();
    QMenu* addMenu(QMenu* in, const char* title);
    void fill(QMenu& menu, std::initializer_list<const char*> actions);  ///< "": a separator
    void fillFiles();
    void addFile(QMenu& menu, const QString& text, const QString& path);

    QMainWindow& window_;
    ActionSet& actions_;
    RecentFiles& recent_;
    std::vector<QToolBar*> tools_;  ///< groups, one below the other
    QMenu* snapMenu_ = nullptr;
    QMenu *recentMenu_, *samplesMenu_, *replayMenu_;
    std::vector<std::pair<QMenu*, const char*>> menus_;  ///< with their untranslated titles
};

}  // namespace imomushi
