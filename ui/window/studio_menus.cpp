// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/studio_menus.h"

#include <QFileInfo>
#include <QHelpEvent>
#include <QMainWindow>
#include <QMenu>
#include <QMenuBar>
#include <QStatusBar>
#include <QToolBar>
#include <QToolButton>
#include <QToolTip>

#include "ui/models/recent_files.h"
#include "ui/widgets/action_set.h"
#include "ui/widgets/appearance.h"
#include "ui/window/start_page.h"
#include "ui/window/studio_actions.h"
#include "ui/window/studio_docks.h"

namespace imomushi {

StudioMenus::StudioMenus(QMainWindow& window, ActionSet& actions, RecentFiles& recent, StudioDocks& docks)
    : QObject(&window), window_(window), actions_(actions), recent_(recent) {
    buildMenus(docks);
    buildToolBar();
    connect(&recent, &RecentFiles::changed, this, &StudioMenus::fillFiles);
}

QMenu* StudioMenus::addMenu(QMenu* in, const char* title) {
    QMenu* menu = in ? in->addMenu(QString()) : window_.menuBar()->addMenu(QString());
    menu->setWindowFlag(Qt::NoDropShadowWindowHint);
    menu->installEventFilter(this);
    menus_.emplace_back(menu, title);
    return menu;
}

void StudioMenus::fill(QMenu& menu, std::initializer_list<const char*> actions) {
    for (const char* id : actions) {
        if (*id) menu.addAction(actions_[id]);
        else menu.addSeparator();
    }
}

void StudioMenus::buildMenus(StudioDocks& docks) {
    QMenu* file = addMenu(nullptr, QT_TR_NOOP("&File"));
    fill(*file, {"new", "open"});
    recentMenu_ = addMenu(file, QT_TR_NOOP("Open &recent"));
    samplesMenu_ = addMenu(file, QT_TR_NOOP("Sa&mples"));
    replayMenu_ = addMenu(file, QT_TR_NOOP("How samples were &built"));
    fill(*file, {"start", "", "import", "import-skeleton", "import-clips", "append", "", "save", "save-as", "save-copy", "versions", "", "export", "write-mesh", "save-script", "", "quit"});
    fill(*addMenu(nullptr, QT_TR_NOOP("&Edit")), {"undo", "redo", "", "cut", "copy", "paste", "", "rename", "delete", "", "duplicate", "mirror-x", "mirror-y", "mirror-z", "replace-mesh", "", "select-all", "select-none", "select-invert", "select-more", "select-chain", "", "search", "preferences"});
    QMenu* character = addMenu(nullptr, QT_TR_NOOP("&Character"));
    fill(*character, {"tool-select", "tool-face", "tool-bone", "tool-handle", "tool-pose", "tool-touch", "", "passing-handles", "symmetry"});
    fill(*addMenu(character, QT_TR_NOOP("Gi&zmo")), {"gizmo", "", "gizmo-all", "gizmo-move", "gizmo-turn", "gizmo-scale", "", "axes-world", "axes-local", "axes-view"});
    snapMenu_ = addMenu(character, QT_TR_NOOP("S&nap"));
    fill(*snapMenu_, {"snap", "", "snap-grid", "snap-angle", "snap-vertices", "snap-edges", "snap-surface", "snap-middle", "snap-ends", "", "snap-steps"});
    fill(*addMenu(character, QT_TR_NOOP("Place b&y numbers")), {"place-bone", "place-face", "place-cut", "place-handle", "", "edit-face"});
    fill(*character, {"", "make-soft", "make-soft-bones", "propose", "", "join", "", "precompute", "soft-at-once", "", "pin", "release", "rest"});
    fill(*addMenu(character, QT_TR_NOOP("Poses")), {"keep-pose", "mirror-pose", "rest-bones", "rest-chain", "", "pose-1", "pose-2", "pose-3", "pose-4", "pose-5", "pose-6", "pose-7", "pose-8", "pose-9"});
    fill(*addMenu(nullptr, QT_TR_NOOP("Perf&orm")), {"live-inputs", "let-go", "", "suggest-keys", "suggest-pad", "suggest-vmc", "suggest-voice", "load-mappings", "save-mappings", "", "move-by-itself", "", "record", "count-in", "", "play", "take-back", "take-forward", "loop", "leave-take", "", "mark-in", "mark-out", "mark-none", "trim-take", "", "take-clip",
                                                     "rename-take", "duplicate-take", "remove-take"});
    QMenu* view = addMenu(nullptr, QT_TR_NOOP("&View"));
    fill(*view, {"frame-all", "frame-selection", "", "view-front", "view-right", "view-top", "orthographic", "", "bones", "grid", "bodies", "xray", "", "hide", "isolate", "lock", "show-all", ""});
    QMenu* panels = addMenu(view, QT_TR_NOOP("&Panels"));
    panels->addActions(docks.actions());
    connect(panels, &QMenu::aboutToShow, &docks, &StudioDocks::followActions);
    fill(*addMenu(view, QT_TR_NOOP("&Theme")), {"theme-dark", "theme-light", "theme-contrast"});
    fill(*addMenu(view, QT_TR_NOOP("&Language")), {"language-en", "language-ja"});
    fill(*view, {"", "picture", "stage", "full-screen"});
    fill(*addMenu(nullptr, QT_TR_NOOP("Hel&p")), {"manual", "controls", "search", "", "about"});
}

void StudioMenus::buildToolBar() {
    const auto group = [&](const char* name, std::initializer_list<const char*> ids) {
        auto* bar = new QToolBar(&window_);
        bar->setObjectName(QLatin1String(name));
        bar->setMovable(false);
        bar->setContextMenuPolicy(Qt::PreventContextMenu);
        bar->setToolButtonStyle(Qt::ToolButtonIconOnly);
        window_.addToolBar(Qt::LeftToolBarArea, bar);
        bar->addSeparator();  // seen where another group is above
        for (const char* id : ids) bar->addAction(actions_[id]);
        for (QToolButton* button : bar->findChildren<QToolButton*>()) button->setFocusPolicy(Qt::TabFocus);
        // wrapTools() makes room for all; Qt would leave the arrow of narrower moments.
        if (auto* arrow = bar->findChild<QToolButton*>(QStringLiteral("qt_toolbar_ext_button"))) arrow->setFixedSize(0, 0);
        tools_.push_back(bar);
    };
    group("tools", {"tool-select", "tool-face", "tool-bone", "tool-handle", "tool-pose", "tool-touch"});
    group("tools-drag", {"snap", "symmetry"});
    // The arrow of the magnet opens what it goes to.
    if (auto* magnet = qobject_cast<QToolButton*>(tools_.back()->widgetForAction(actions_["snap"]))) {
        magnet->setMenu(snapMenu_);
        magnet->setPopupMode(QToolButton::MenuButtonPopup);
    }
    group("tools-history", {"undo", "redo"});  // here two columns hold all where letters are large
    group("tools-character", {"make-soft", "precompute", "rest", "pin"});
    group("tools-view", {"frame-all", "bones", "grid"});
}

void StudioMenus::retranslate() {
    for (const auto& [menu, title] : menus_) menu->setTitle(tr(title));
    window_.menuBar()->setAccessibleName(tr("Menus"));
    for (QToolBar* bar : tools_) {
        bar->setWindowTitle(tr("Tools"));
        bar->setAccessibleName(tr("Tools"));
    }
    fillFiles();
}

void StudioMenus::takeSizes() {
    for (QToolBar* bar : tools_) bar->setIconSize(QSize(px(22), px(22)));
    wrapTools();
}

void StudioMenus::wrapTools() {
    const int room = window_.height() - window_.menuBar()->sizeHint().height() - window_.statusBar()->sizeHint().height();
    int used = 0;
    for (QToolBar* bar : tools_) {
        QAction* rule = bar->actions().first();
        rule->setVisible(used > 0);
        const bool anew = used > 0 && used + bar->sizeHint().height() > room;
        if (anew) rule->setVisible(false);
        if (anew != window_.toolBarBreak(bar)) {
            if (anew) window_.insertToolBarBreak(bar);
            else window_.removeToolBarBreak(bar);
        }
        used = (anew ? 0 : used) + bar->sizeHint().height();
    }
}

void StudioMenus::popUpContextMenu(const QPoint& global) {
    QMenu menu(&window_);
    menu.installEventFilter(this);
    fill(menu, {"cut", "copy", "paste", "", "rename", "delete", "", "duplicate", "mirror-x", "mirror-y", "mirror-z", "replace-mesh", "", "make-soft", "make-soft-bones", "import-skeleton", "import-clips", "take-clip", "", "join", "pin", "edit-face", "", "hide", "isolate", "lock", "show-all", "frame-selection"});
    fill(*menu.addMenu(tr("Place b&y numbers")), {"place-bone", "place-face", "place-cut", "place-handle"});
    menu.exec(global);
}

bool StudioMenus::eventFilter(QObject* watched, QEvent* event) {
    if (event->type() != QEvent::ToolTip) return QObject::eventFilter(watched, event);
    const auto* help = static_cast<QHelpEvent*>(event);
    auto* menu = static_cast<QMenu*>(watched);
    const QAction* action = menu->actionAt(help->pos());
    QToolTip::showText(help->globalPos(), action ? whyDisabled(*action) : QString(), menu);
    return true;
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
    replayMenu_->clear();
    for (const Sample& sample : samples()) {
        const QString title = sampleTitle(sample.name);
        addFile(*samplesMenu_, title, sample.path);
        if (!sample.script.isEmpty()) connect(replayMenu_->addAction(title), &QAction::triggered, this, [this, title, script = sample.script] { Q_EMIT replayWanted(title, script); });
    }
    samplesMenu_->setEnabled(!samplesMenu_->isEmpty());
    replayMenu_->setEnabled(!replayMenu_->isEmpty());
}

void StudioMenus::addFile(QMenu& menu, const QString& text, const QString& path) {
    connect(menu.addAction(text), &QAction::triggered, this, [this, path] { Q_EMIT fileWanted(path); });
}

}  // namespace imomushi
