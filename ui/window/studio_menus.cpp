// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/studio_menus.h"

#include <QFileInfo>
#include <QMainWindow>
#include <QMenu>
#include <QMenuBar>
#include <QToolBar>
#include <QToolButton>

#include "ui/models/recent_files.h"
#include "ui/widgets/action_set.h"
#include "ui/widgets/appearance.h"
#include "ui/window/start_page.h"
#include "ui/window/studio_actions.h"

namespace imomushi {

StudioMenus::StudioMenus(QMainWindow& window, ActionSet& actions, RecentFiles& recent, const QList<QAction*>& panels)
    : QObject(&window), window_(window), actions_(actions), recent_(recent), tools_(new QToolBar(&window)) {
    buildMenus(panels);
    buildToolBar();
    connect(&recent, &RecentFiles::changed, this, &StudioMenus::fillFiles);
}

QMenu* StudioMenus::addMenu(QMenu* in, const char* title) {
    QMenu* menu = in ? in->addMenu(QString()) : window_.menuBar()->addMenu(QString());
    menu->setWindowFlag(Qt::NoDropShadowWindowHint);
    menus_.emplace_back(menu, title);
    return menu;
}

void StudioMenus::fill(QMenu& menu, std::initializer_list<const char*> actions) {
    for (const char* id : actions) {
        if (*id) menu.addAction(actions_[id]);
        else menu.addSeparator();
    }
}

void StudioMenus::buildMenus(const QList<QAction*>& panels) {
    QMenu* file = addMenu(nullptr, QT_TR_NOOP("&File"));
    fill(*file, {"new", "open"});
    recentMenu_ = addMenu(file, QT_TR_NOOP("Open &recent"));
    samplesMenu_ = addMenu(file, QT_TR_NOOP("Sa&mples"));
    fill(*file, {"start", "", "import", "import-skeleton", "import-clips", "append", "", "save", "save-as", "save-copy", "versions", "", "export", "write-mesh", "save-script", "", "quit"});
    fill(*addMenu(nullptr, QT_TR_NOOP("&Edit")), {"undo", "redo", "", "rename", "delete", "", "duplicate", "mirror-x", "mirror-y", "mirror-z", "replace-mesh", "", "select-all", "select-none", "", "search", "preferences"});
    fill(*addMenu(nullptr, QT_TR_NOOP("&Character")), {"tool-select", "tool-face", "tool-bone", "tool-handle", "tool-pose", "tool-touch", "", "passing-handles", "", "make-soft", "make-soft-bones", "propose", "", "join", "", "precompute", "soft-at-once", "", "pin", "release", "rest"});
    fill(*addMenu(nullptr, QT_TR_NOOP("&Perform")), {"record", "count-in", "", "play", "take-back", "take-forward", "loop", "leave-take", "", "mark-in", "mark-out", "mark-none", "trim-take", "", "take-clip",
                                                     "rename-take", "duplicate-take", "remove-take"});
    QMenu* view = addMenu(nullptr, QT_TR_NOOP("&View"));
    fill(*view, {"frame-all", "frame-selection", "", "view-front", "view-right", "view-top", "orthographic", "", "bones", "grid", "bodies", "xray", "", "hide", "show-all", ""});
    addMenu(view, QT_TR_NOOP("&Panels"))->addActions(panels);
    fill(*addMenu(view, QT_TR_NOOP("&Theme")), {"theme-dark", "theme-light", "theme-contrast"});
    fill(*addMenu(view, QT_TR_NOOP("&Language")), {"language-en", "language-ja"});
    fill(*view, {"", "full-screen"});
    fill(*addMenu(nullptr, QT_TR_NOOP("&Help")), {"manual", "controls", "search", "", "about"});
}

void StudioMenus::buildToolBar() {
    tools_->setObjectName(QStringLiteral("tools"));
    tools_->setMovable(false);
    tools_->setContextMenuPolicy(Qt::PreventContextMenu);
    tools_->setToolButtonStyle(Qt::ToolButtonIconOnly);
    window_.addToolBar(Qt::LeftToolBarArea, tools_);
    for (const char* id : {"tool-select", "tool-face", "tool-bone", "tool-handle", "tool-pose", "tool-touch", "", "make-soft", "precompute", "rest", "pin", "", "undo", "redo", "", "frame-all", "bones", "grid"}) {
        if (*id) tools_->addAction(actions_[id]);
        else tools_->addSeparator();
    }
    for (QToolButton* button : tools_->findChildren<QToolButton*>()) button->setFocusPolicy(Qt::TabFocus);
}

void StudioMenus::retranslate() {
    for (const auto& [menu, title] : menus_) menu->setTitle(tr(title));
    window_.menuBar()->setAccessibleName(tr("Menus"));
    tools_->setWindowTitle(tr("Tools"));
    tools_->setAccessibleName(tr("Tools"));
    fillFiles();
}

void StudioMenus::takeSizes() { tools_->setIconSize(QSize(px(22), px(22))); }

void StudioMenus::popUpContextMenu(const QPoint& global) {
    QMenu menu(&window_);
    fill(menu, {"rename", "delete", "", "duplicate", "mirror-x", "mirror-y", "mirror-z", "replace-mesh", "", "make-soft", "make-soft-bones", "import-skeleton", "import-clips", "take-clip", "", "join", "pin", "", "hide", "show-all", "frame-selection"});
    menu.exec(global);
}

void StudioMenus::fillFiles() {
    recentMenu_->clear();
    for (const QString& path : recent_.paths()) {
        const QFileInfo info(path);
        addFile(*recentMenu_, info.exists() ? info.completeBaseName() : tr("%1 (missing)").arg(info.completeBaseName()), path);
        recentMenu_->actions().last()->setEnabled(info.exists());
        recentMenu_->actions().last()->setToolTip(path);
    }
    recentMenu_->setEnabled(!recentMenu_->isEmpty());
    samplesMenu_->clear();
    for (const Sample& sample : samples()) addFile(*samplesMenu_, sampleTitle(sample.name), sample.path);
    samplesMenu_->setEnabled(!samplesMenu_->isEmpty());
}

void StudioMenus::addFile(QMenu& menu, const QString& text, const QString& path) {
    connect(menu.addAction(text), &QAction::triggered, this, [this, path] { Q_EMIT fileWanted(path); });
}

}  // namespace imomushi
