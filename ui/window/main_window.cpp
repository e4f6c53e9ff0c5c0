// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/main_window.h"

#include <QAbstractButton>
#include <QActionGroup>
#include <QCloseEvent>
#include <QDockWidget>
#include <QDragEnterEvent>
#include <QFileInfo>
#include <QKeyEvent>
#include <QLabel>
#include <QMenuBar>
#include <QMessageBox>
#include <QMimeData>
#include <QSettings>
#include <QStackedLayout>
#include <QStatusBar>
#include <QTimer>
#include <QTabBar>
#include <QToolBar>
#include <QToolButton>
#include <QUrl>
#include <QVBoxLayout>
#include <algorithm>
#include <set>

#include "core/document/version.h"
#include "ui/dialogs/export_dialog.h"
#include "ui/dialogs/preferences_dialog.h"
#include "ui/jobs/export_job.h"
#include "ui/models/effect_texts.h"
#include "ui/models/gesture.h"
#include "ui/models/texts.h"
#include "ui/panels/accuracy/accuracy_panel.h"
#include "ui/panels/effects_panel.h"
#include "ui/panels/inspector/inspector_panel.h"
#include "ui/panels/list_panels.h"
#include "ui/panels/outliner_panel.h"
#include "ui/panels/takes_panel.h"
#include "ui/tools/select_tool.h"
#include "ui/viewport/viewport_widget.h"
#include "ui/widgets/appearance.h"
#include "ui/window/command_search.h"
#include "ui/window/file_flow.h"
#include "ui/window/start_page.h"
#include "ui/window/status_strip.h"
#include "ui/window/studio_actions.h"

namespace imomushi {
namespace {

using Kind = SelectionItem::Kind;
constexpr double kInspectorShare = 0.6;  // of the height, at first
constexpr int kWarnAgainMs = 5000;
constexpr int kStateVersion = 3;  // of the arrangement of docks in QSettings

constexpr std::pair<const char*, ToolKind> kTools[] = {
    {"tool-select", ToolKind::Select}, {"tool-face", ToolKind::Face}, {"tool-bone", ToolKind::Bone}, {"tool-pose", ToolKind::Pose}, {"tool-touch", ToolKind::Touch}};

}  // namespace

MainWindow::MainWindow(const CommandRegistry& registry, std::shared_ptr<ResponseStore> store) : document_(registry, std::move(store)) {
    setObjectName(QStringLiteral("studio"));
    setAcceptDrops(true);
    setDockOptions(QMainWindow::AnimatedDocks | QMainWindow::AllowTabbedDocks | QMainWindow::AllowNestedDocks);
    setTabPosition(Qt::RightDockWidgetArea, QTabWidget::North);
    setTabPosition(Qt::BottomDockWidgetArea, QTabWidget::North);
    setCorner(Qt::BottomRightCorner, Qt::RightDockWidgetArea);
    actions_ = new StudioActions(this);
    deck_ = new TakeDeck(document_, this);
    files_ = new FileFlow(document_, this);
    precompute_ = new PrecomputeJob(document_, this);

    stage_ = new QWidget(this);
    stack_ = new QStackedLayout(stage_);
    viewHost_ = new QWidget(stage_);
    auto* viewLayout = new QVBoxLayout(viewHost_);
    viewLayout->setContentsMargins(0, 0, 0, 0);
    viewport_ = new ViewportWidget(document_, viewHost_);
    viewport_->follow(*deck_);
    viewLayout->addWidget(viewport_);
    start_ = new StartPage(files_->recent(), stage_);
    stack_->addWidget(viewHost_);
    stack_->addWidget(start_);
    setCentralWidget(stage_);
    message_ = new MessageBar(stage_);
    job_ = new JobCard(stage_);
    stage_->installEventFilter(this);
    message_->installEventFilter(this);
    job_->installEventFilter(this);

    status_ = new StatusStrip(document_, [this] { return precompute_->estimate(); }, this);
    auto* bar = new QStatusBar(this);
    bar->setSizeGripEnabled(false);
    bar->setStyleSheet(QStringLiteral("QStatusBar::item { border: none; } QStatusBar { border: none; }"));
    bar->setContentsMargins(0, 0, px(10), 0);
    bar->addWidget(status_, 1);
    costs_ = new FrameCostMeter(document_, this);
    auto* costBar = new CostBar(*costs_, this);
    connect(costBar, &CostBar::clicked, this, [this] {
        accuracyDock_->show();
        accuracyDock_->raise();
        accuracy_->showCosts();
    });
    bar->addPermanentWidget(costBar);
    setStatusBar(bar);

    buildDocks();
    buildActions();
    buildMenus();
    buildToolBar();
    connectView();

    const auto soon = [this] {
        if (updateScheduled_) return;
        updateScheduled_ = true;
        QMetaObject::invokeMethod(this, &MainWindow::updateActions, Qt::QueuedConnection);
    };
    connect(&document_, &StudioDocument::structureChanged, this, soon);
    connect(&document_, &StudioDocument::selectionChanged, this, soon);
    connect(&document_, &StudioDocument::historyChanged, this, soon);
    connect(&document_, &StudioDocument::responsesChanged, this, soon);
    connect(&document_, &StudioDocument::fileChanged, this, soon);
    connect(&document_, &StudioDocument::failed, this, [this](const QString& text) { message_->say(text, MessageBar::Tone::Warning); });
    connect(&document_, &StudioDocument::frameStepped, this, &MainWindow::warn);
    connect(&document_, &StudioDocument::offered, this, [this](const QString& text, const QString& label, const Json& command) {
        message_->offer(text, label, [this, command] {
            if (command.at("do") == "precompute") return startPrecompute();
            settle();
            // What was turned on may need a precompute, which the tool then offers.
            if (document_.execute(command)) viewport_->beginTool();
        });
    });
    connect(deck_, &TakeDeck::said, this, [this](const QString& text) { message_->say(text, MessageBar::Tone::Warning); });
    connect(deck_, &TakeDeck::changed, this, &MainWindow::updateTakeActions);
    connect(files_, &FileFlow::leaving, this, [this] {
        settle();
        deck_->stopRecording();  // so that the artist is asked whether to keep it
    });
    connect(files_, &FileFlow::said, this, [this](const QString& text) { message_->say(text, MessageBar::Tone::Good); });
    connect(files_, &FileFlow::opened, this, [this] {
        precompute_->cancel();
        showStart(false);
        viewport_->frameAll(false);
        keepPicture();
    });
    connect(files_, &FileFlow::imported, this, [this](int elements) {
        showStart(false);
        viewport_->frameAll(document_.document().elements.size() > std::size_t(elements));
    });
    connect(files_, &FileFlow::saved, this, [this] { keepPicture(); });
    connect(&files_->recent(), &RecentFiles::changed, this, &MainWindow::fillRecent);
    connect(start_, &StartPage::newWanted, files_, &FileFlow::newProject);
    connect(start_, &StartPage::openWanted, files_, &FileFlow::askOpen);
    connect(start_, &StartPage::importWanted, files_, &FileFlow::askImport);
    connect(start_, &StartPage::fileWanted, files_, [this](const QString& path) { files_->open(path); }, Qt::QueuedConnection);

    job_->follow(precompute_, [this] { return tr("Precomputing %1").arg(precompute_->element()); });
    connect(precompute_, &BackgroundJob::progressed, this, [this] {
        if (precompute_->running()) status_->setBusy(tr("Precomputing %1 %").arg(int(100.0 * precompute_->fraction())));
    });
    connect(precompute_, &PrecomputeJob::elementFailed, this, [this](const QString& element, const QString& message) {
        precomputeFailed_ = true;
        message_->say(tr("%1: %2", "element, what went wrong").arg(element, message), MessageBar::Tone::Warning);
    });
    connect(precompute_, &BackgroundJob::finished, this, [this, soon](bool completed) {
        status_->setBusy({});
        const int kept = precompute_->kept();
        if (kept > 0) files_->autosave().saveSoon();
        if (!completed) message_->say(kept > 0 ? tr("Precompute cancelled; %n element(s) were done and are kept.", nullptr, kept) : tr("Precompute cancelled"), MessageBar::Tone::Info);
        else if (!precomputeFailed_) message_->say(tr("Precomputed. Drag a joint point with the drag tool (D)."), MessageBar::Tone::Good);
        soon();
    });
    connect(&Appearance::instance(), &Appearance::changed, this, &MainWindow::takeSizes);
    // New metrics make the docks forget how they shared their height.
    connect(&Appearance::instance(), &Appearance::aboutToChange, this, [this] {
        if (isVisible()) shareHeight(inspectorShare());
    });

    takeSizes();
    retranslate();
    updateActions();
    viewport_->setTool(ToolKind::Select);
    showStart(true);

    const QSettings settings;
    resize(px(1440), px(900));
    restoreGeometry(settings.value(QStringLiteral("window/geometry")).toByteArray());
    restoreState(settings.value(QStringLiteral("window/docks")).toByteArray(), kStateVersion);
}

MainWindow::~MainWindow() {
    // Panels hear the document; they go before it does.
    delete takeCentralWidget();
    for (QDockWidget* dock : {outlinerDock_, historyDock_, issuesDock_, inspectorDock_, effectsDock_, accuracyDock_, takesDock_}) delete dock;
    delete export_;
    delete deck_;
    delete precompute_;
    delete files_;
    delete statusBar();
    document_.disconnect();
}

// ---- putting together ------------------------------------------------------------------------------------------------------

void MainWindow::buildDocks() {
    outliner_ = new OutlinerPanel(document_, this);
    history_ = new HistoryPanel(document_, this);
    issues_ = new IssuesPanel(document_, this);
    inspector_ = new InspectorPanel(document_, this);
    effects_ = new EffectsPanel(document_, this);
    const auto dock = [this](const char* name, QWidget* panel) {
        auto* d = new QDockWidget(this);
        d->setObjectName(QLatin1String(name));
        d->setWidget(panel);
        d->setFeatures(QDockWidget::DockWidgetClosable | QDockWidget::DockWidgetMovable);
        addDockWidget(Qt::RightDockWidgetArea, d);
        return d;
    };
    outlinerDock_ = dock("outlinerDock", outliner_);
    historyDock_ = dock("historyDock", history_);
    issuesDock_ = dock("issuesDock", issues_);
    inspectorDock_ = dock("inspectorDock", inspector_);
    effectsDock_ = dock("effectsDock", effects_);
    accuracy_ = new AccuracyPanel(document_, *costs_, this);
    accuracyDock_ = dock("accuracyDock", accuracy_);
    addDockWidget(Qt::BottomDockWidgetArea, accuracyDock_);
    accuracyDock_->setTitleBarWidget(new QWidget(accuracyDock_));  // as above
    accuracyDock_->hide();
    takes_ = new TakesPanel(document_, *deck_, *actions_, this);
    takesDock_ = dock("takesDock", takes_);
    addDockWidget(Qt::BottomDockWidgetArea, takesDock_);
    tabifyDockWidget(accuracyDock_, takesDock_);
    // The tabs say the names; a title below them would say them twice. That takes are here is plain to see.
    for (QDockWidget* d : {outlinerDock_, historyDock_, issuesDock_, inspectorDock_, effectsDock_, takesDock_}) d->setTitleBarWidget(new QWidget(d));
    // Split first: a dock that is split off a tab only becomes another tab.
    splitDockWidget(outlinerDock_, inspectorDock_, Qt::Vertical);
    tabifyDockWidget(outlinerDock_, historyDock_);
    tabifyDockWidget(historyDock_, issuesDock_);
    tabifyDockWidget(inspectorDock_, effectsDock_);
    resizeDocks({outlinerDock_, inspectorDock_}, {px(340), px(340)}, Qt::Horizontal);
    outlinerDock_->raise();
    inspectorDock_->raise();
    connect(outliner_, &OutlinerPanel::contextMenuWanted, this, &MainWindow::contextMenu);
    connect(inspector_, &InspectorPanel::precomputeWanted, this, &MainWindow::startPrecompute);
    connect(effects_, &EffectsPanel::precomputeWanted, this, &MainWindow::startPrecompute);
    connect(status_, &StatusStrip::precomputeWanted, this, &MainWindow::startPrecompute);
    connect(issues_, &IssuesPanel::frameWanted, this, [this] { viewport_->frameSelection(); });
    connect(issues_, &IssuesPanel::markWanted, viewport_, &ViewportWidget::setHighlightedTriangles);
    connect(issues_, &IssuesPanel::worthChanged, this, [this] {
        const int worth = issues_->worth();
        issuesDock_->setWindowTitle(worth > 0 ? tr("Issues (%1)").arg(worth) : tr("Issues"));
    });
}

void MainWindow::buildActions() {
    StudioActions& a = *actions_;
    const auto on = [&](const char* id, auto slot) { connect(a[id], &QAction::triggered, this, slot); };
    on("start", [this] { showStart(!startShown()); });
    on("new", [this] { settle(); files_->newProject(); });
    on("open", [this] { settle(); files_->askOpen(); });
    on("import", [this] { settle(); files_->askImport(); });
    on("save", [this] { settle(); files_->save(); });
    on("save-as", [this] { settle(); files_->saveAs(); });
    on("save-copy", [this] { settle(); files_->saveCopy(); });
    on("save-script", [this] { settle(); files_->saveScript(); });
    on("export", [this] { openExport(); });
    on("write-mesh", [this] { settle(); files_->writeMesh(); });
    on("quit", [this] { close(); });
    on("undo", [this] { undo(1); });
    on("redo", [this] { settle(); document_.execute({{"do", "redo"}}); });
    on("delete", [this] { settle(); removeSelection(document_); });
    on("rename", [this] {
        outlinerDock_->show();
        outlinerDock_->raise();
        outliner_->renameSelected();
    });
    on("select-all", [this] {
        std::vector<SelectionItem> items;
        for (const auto& [id, element] : document_.document().elements)
            if (element->visible && !element->locked) items.push_back({Kind::Element, id, {}, false});
        document_.select(std::move(items));
    });
    on("select-none", [this] { document_.select({}); });
    on("preferences", [this] {
        PreferencesDialog dialog(*actions_, this);
        connect(&dialog, &PreferencesDialog::navigationChanged, this, [this](int preset) { viewport_->setNavigationPreset(NavigationPreset(preset)); });
        connect(&dialog, &PreferencesDialog::deformOnChanged, this, [this](int where) { viewport_->setDeformOn(ViewportWidget::DeformOn(where)); });
        dialog.exec();
    });
    auto* tools = new QActionGroup(this);
    for (const auto& [id, kind] : kTools) {
        tools->addAction(a[id]);
        on(id, [this, tool = kind] {
            showStart(false);
            viewport_->setTool(tool);
            viewport_->setFocus();
        });
    }
    on("precompute", [this] { startPrecompute(); });
    on("join", [this] { joinSelected(); });
    on("pin", [this] { pinSelected(); });
    on("release", [this] { settle(); document_.execute({{"do", "release"}}); });
    on("rest", [this] { settle(); document_.execute({{"do", "rest"}}); });
    on("record", [this] { record(); });
    on("play", [this] {
        settle();
        showStart(false);
        deck_->setPlaying(!deck_->playing());
    });
    on("take-back", [this] { settle(); deck_->step(-1); });
    on("take-forward", [this] { settle(); deck_->step(1); });
    on("loop", [this](bool checked) { deck_->setLooping(checked); });
    on("mark-in", [this] { deck_->setSpan(deck_->time(), deck_->to()); });
    on("mark-out", [this] { deck_->setSpan(deck_->from(), deck_->time()); });
    on("mark-none", [this] { if (const Take* take = deck_->take()) deck_->setSpan(0.0, take->duration()); });
    on("trim-take", [this] { settle(); deck_->trim(); });
    on("rename-take", [this] { takesDock_->show(); takesDock_->raise(); takes_->rename(); });
    on("duplicate-take", [this] { settle(); deck_->duplicate(); });
    on("remove-take", [this] { settle(); deck_->remove(); });
    on("count-in", [this](bool checked) {
        deck_->setCountsIn(checked);
        QSettings().setValue(QStringLiteral("takes/count-in"), checked);
    });
    deck_->setCountsIn(QSettings().value(QStringLiteral("takes/count-in"), false).toBool());
    on("leave-take", [this] { deck_->leave(); });
    on("hide", [this] { hideSelected(); });
    on("show-all", [this] { showAll(); });
    on("frame-all", [this] { viewport_->frameAll(); });
    on("frame-selection", [this] { viewport_->frameSelection(); });
    on("view-front", [this] { viewport_->setViewAxis(ViewAxis::Front); });
    on("view-right", [this] { viewport_->setViewAxis(ViewAxis::Right); });
    on("view-top", [this] { viewport_->setViewAxis(ViewAxis::Top); });
    on("orthographic", [this](bool checked) { viewport_->setOrthographic(checked); });
    on("bones", [this](bool checked) { viewport_->setBonesVisible(checked); });
    on("grid", [this](bool checked) { viewport_->setGridVisible(checked); });
    on("xray", [this](bool checked) { viewport_->setXray(checked); });
    on("full-screen", [this](bool checked) { checked ? showFullScreen() : showNormal(); });
    auto* themes = new QActionGroup(this);
    static constexpr const char* kThemes[] = {"theme-dark", "theme-light", "theme-contrast"};
    for (int i = 0; i < 3; ++i) {
        themes->addAction(a[kThemes[i]]);
        on(kThemes[i], [i] { Appearance::instance().setTheme(Appearance::Theme(i)); });
    }
    auto* languages = new QActionGroup(this);
    for (const auto& [id, language] : {std::pair{"language-en", "en"}, std::pair{"language-ja", "ja"}}) {
        languages->addAction(a[id]);
        on(id, [language = QString::fromLatin1(language)] { Appearance::instance().setLanguage(language); });
    }
    on("search", [this] {
        auto* search = new CommandSearch(actions_->all(), this);
        search->popUp();
    });
    on("controls", [this] { showControls(); });
    on("about", [this] { showAbout(); });
}

void MainWindow::buildMenus() {
    StudioActions& a = *actions_;
    const auto menu = [this](QMenu* in, const char* title) {
        QMenu* m = in ? in->addMenu(QString()) : menuBar()->addMenu(QString());
        menus_.emplace_back(m, title);
        return m;
    };
    const auto fill = [&](QMenu* m, std::initializer_list<const char*> ids) {
        for (const char* id : ids) {
            if (*id) m->addAction(a[id]);
            else m->addSeparator();
        }
    };
    QMenu* file = menu(nullptr, QT_TR_NOOP("&File"));
    fill(file, {"new", "open"});
    recentMenu_ = menu(file, QT_TR_NOOP("Open &recent"));
    samplesMenu_ = menu(file, QT_TR_NOOP("Sa&mples"));
    fill(file, {"start", "", "import", "", "save", "save-as", "save-copy", "", "export", "write-mesh", "save-script", "", "quit"});
    QMenu* edit = menu(nullptr, QT_TR_NOOP("&Edit"));
    fill(edit, {"undo", "redo", "", "rename", "delete", "", "select-all", "select-none", "", "search", "preferences"});
    QMenu* character = menu(nullptr, QT_TR_NOOP("&Character"));
    fill(character, {"tool-select", "tool-face", "tool-bone", "tool-pose", "tool-touch", "", "join", "", "precompute", "", "pin", "release", "rest"});
    fill(menu(nullptr, QT_TR_NOOP("&Perform")), {"record", "count-in", "", "play", "take-back", "take-forward", "loop", "leave-take", "", "mark-in", "mark-out", "mark-none", "trim-take", "",
                                                    "rename-take", "duplicate-take", "remove-take"});
    QMenu* view = menu(nullptr, QT_TR_NOOP("&View"));
    fill(view, {"frame-all", "frame-selection", "", "view-front", "view-right", "view-top", "orthographic", "", "bones", "grid", "xray", "", "hide", "show-all", ""});
    panelsMenu_ = menu(view, QT_TR_NOOP("&Panels"));
    for (QDockWidget* d : {outlinerDock_, inspectorDock_, effectsDock_, takesDock_, accuracyDock_, historyDock_, issuesDock_}) panelsMenu_->addAction(d->toggleViewAction());
    fill(menu(view, QT_TR_NOOP("&Theme")), {"theme-dark", "theme-light", "theme-contrast"});
    fill(menu(view, QT_TR_NOOP("&Language")), {"language-en", "language-ja"});
    fill(view, {"", "full-screen"});
    QMenu* help = menu(nullptr, QT_TR_NOOP("&Help"));
    fill(help, {"controls", "search", "", "about"});
    for (const auto& [m, title] : menus_) m->setWindowFlag(Qt::NoDropShadowWindowHint);
    fillRecent();
}

void MainWindow::buildToolBar() {
    tools_ = new QToolBar(this);
    tools_->setObjectName(QStringLiteral("tools"));
    tools_->setMovable(false);
    tools_->setContextMenuPolicy(Qt::PreventContextMenu);
    tools_->setToolButtonStyle(Qt::ToolButtonIconOnly);
    addToolBar(Qt::LeftToolBarArea, tools_);
    StudioActions& a = *actions_;
    for (const auto& [id, kind] : kTools) tools_->addAction(a[id]);
    tools_->addSeparator();
    for (const char* id : {"precompute", "rest", "pin"}) tools_->addAction(a[id]);
    tools_->addSeparator();
    for (const char* id : {"undo", "redo"}) tools_->addAction(a[id]);
    tools_->addSeparator();
    for (const char* id : {"frame-all", "bones", "grid"}) tools_->addAction(a[id]);
    for (QToolButton* button : tools_->findChildren<QToolButton*>()) button->setFocusPolicy(Qt::TabFocus);
}

void MainWindow::connectView() {
    connect(viewport_, &ViewportWidget::hintChanged, status_, &StatusStrip::setHint);
    connect(viewport_, &ViewportWidget::frameMeasured, status_, &StatusStrip::setFrame);
    connect(viewport_, &ViewportWidget::frameMeasured, costs_, &FrameCostMeter::take);
    connect(viewport_, &ViewportWidget::toolChanged, this, [this](ToolKind kind) {
        for (const auto& [id, tool] : kTools)
            if (tool == kind) (*actions_)[id]->setChecked(true);
    });
    const auto view = [this] {
        (*actions_)["orthographic"]->setChecked(viewport_->orthographic());
        (*actions_)["bones"]->setChecked(viewport_->bonesVisible());
        (*actions_)["grid"]->setChecked(viewport_->gridVisible());
        (*actions_)["xray"]->setChecked(viewport_->xray());
    };
    connect(viewport_, &ViewportWidget::viewChanged, this, view);
    view();
    (*actions_)["tool-select"]->setChecked(true);
    status_->setHint(viewport_->hint());
    viewport_->setNavigationPreset(NavigationPreset(std::clamp(QSettings().value(QStringLiteral("view/navigation"), 0).toInt(), 0, 1)));
    viewport_->setDeformOn(ViewportWidget::DeformOn(std::clamp(QSettings().value(QStringLiteral("view/deform-on"), 0).toInt(), 0, 2)));
}

// Docks get their tab bars when they are laid out, and again when they move.
void MainWindow::childEvent(QChildEvent* event) {
    QMainWindow::childEvent(event);
    if (auto* tabs = event->type() == QEvent::ChildPolished ? qobject_cast<QTabBar*>(event->child()) : nullptr) tabs->setAccessibleName(tr("Panels"));
}

void MainWindow::retranslate() {
    for (const auto& [menu, title] : menus_) menu->setTitle(tr(title));
    actions_->retranslate();
    outlinerDock_->setWindowTitle(tr("Outliner"));
    historyDock_->setWindowTitle(tr("History"));
    inspectorDock_->setWindowTitle(tr("Properties"));
    effectsDock_->setWindowTitle(tr("Effects"));
    accuracyDock_->setWindowTitle(tr("Accuracy and cost"));
    takesDock_->setWindowTitle(tr("Takes"));
    issuesDock_->setWindowTitle(issues_->worth() > 0 ? tr("Issues (%1)").arg(issues_->worth()) : tr("Issues"));
    tools_->setWindowTitle(tr("Tools"));
    tools_->setAccessibleName(tr("Tools"));
    menuBar()->setAccessibleName(tr("Menus"));
    for (QTabBar* tabs : findChildren<QTabBar*>(Qt::FindDirectChildrenOnly)) tabs->setAccessibleName(tr("Panels"));
    viewport_->setAccessibleName(tr("View of the character"));
    status_->setAccessibleName(tr("Status"));
    fillRecent();
    updateTitle();
    updateActions();
    placeOverlays();
}

void MainWindow::changeEvent(QEvent* event) {
    QMainWindow::changeEvent(event);
    if (event->type() == QEvent::LanguageChange && tools_) {
        retranslate();
        if (export_ && !export_->job().running()) {  // says everything anew
            delete export_;
            openExport();
        }
    }
    if (event->type() == QEvent::WindowStateChange && tools_) (*actions_)["full-screen"]->setChecked(isFullScreen());
}

void MainWindow::takeSizes() {
    tools_->setIconSize(QSize(px(22), px(22)));
    outlinerDock_->setMinimumWidth(px(300));
    inspectorDock_->setMinimumWidth(px(300));
    effectsDock_->setMinimumWidth(px(300));
    placeOverlays();
    updateActions();
}

void MainWindow::fillRecent() {
    if (!recentMenu_) return;
    recentMenu_->clear();
    for (const QString& path : files_->recent().paths()) {
        const QFileInfo info(path);
        QAction* action = recentMenu_->addAction(info.exists() ? info.completeBaseName() : tr("%1 (missing)").arg(info.completeBaseName()));
        action->setEnabled(info.exists());
        action->setToolTip(path);
        connect(action, &QAction::triggered, this, [this, path] {
            settle();
            files_->open(path);
        });
    }
    recentMenu_->setEnabled(!recentMenu_->isEmpty());
    samplesMenu_->clear();
    for (const Sample& sample : samples()) {
        connect(samplesMenu_->addAction(sampleTitle(sample.name)), &QAction::triggered, this, [this, path = sample.path] {
            settle();
            files_->open(path);
        });
    }
    samplesMenu_->setEnabled(!samplesMenu_->isEmpty());
}

// ---- state ---------------------------------------------------------------------------------------------------------------

void MainWindow::updateTitle() {
    const auto& path = document_.session().path();
    const QString name = path.empty() ? tr("New project") : QString::fromStdString(path.stem().string());
    setWindowTitle(QStringLiteral("%1[*] – Imomushi").arg(name));
    setWindowModified(document_.session().modified());
}

void MainWindow::updateActions() {
    updateScheduled_ = false;
    updateTitle();
    StudioActions& a = *actions_;
    const Document& d = document_.document();
    const Session& session = document_.session();
    const auto& selection = document_.selection();
    const int position = session.position(), steps = int(session.steps().size());
    a["undo"]->setEnabled(position > 0);
    a["redo"]->setEnabled(position < steps);
    const auto step = [&](const char* id, const QString& text, int i) {
        if (i < 0 || i >= steps) return;
        const auto& s = session.steps()[std::size_t(i)];
        a[id]->setToolTip(QStringLiteral("%1  (%2)").arg(text.arg(stepText(s.name, s.subject)), a[id]->shortcut().toString(QKeySequence::NativeText)));
    };
    step("undo", tr("Undo: %1"), position - 1);
    step("redo", tr("Redo: %1"), position);
    const auto count = [&](auto... kinds) { return std::count_if(selection.begin(), selection.end(), [&](const SelectionItem& i) { return ((i.kind == kinds) || ...); }); };
    a["delete"]->setEnabled(count(Kind::Element, Kind::Face, Kind::Bone) > 0);
    a["rename"]->setEnabled(selection.size() == 1 && selection.front().kind != Kind::Endpoint);
    a["hide"]->setEnabled(count(Kind::Element) > 0);
    a["join"]->setEnabled(count(Kind::Face) == 2);
    a["pin"]->setEnabled(count(Kind::Endpoint, Kind::Bone) > 0);
    a["release"]->setEnabled(!d.held.empty());
    a["rest"]->setEnabled(!d.held.empty() || !d.pose.points.empty());
    a["select-all"]->setEnabled(!d.elements.empty());
    a["export"]->setEnabled(!d.elements.empty());
    a["write-mesh"]->setEnabled(!d.elements.empty());
    const bool stale = std::any_of(d.elements.begin(), d.elements.end(), [&](const auto& e) {
        return !e.second->faces.empty() && session.responseState(e.first) != Session::ResponseState::Fresh;
    });
    a["precompute"]->setEnabled(stale && !precompute_->running());
    updateTakeActions();
    static constexpr const char* kThemes[] = {"theme-dark", "theme-light", "theme-contrast"};
    a[kThemes[int(Appearance::instance().theme())]]->setChecked(true);
    a[QLocale().language() == QLocale::Japanese ? "language-ja" : "language-en"]->setChecked(true);
}

bool MainWindow::startShown() const { return stack_->currentWidget() == start_; }

void MainWindow::showStart(bool show) {
    if (show && viewport_->busy()) viewport_->cancel();
    stack_->setCurrentWidget(show ? static_cast<QWidget*>(start_) : viewHost_);
    for (QDockWidget* d : {outlinerDock_, historyDock_, issuesDock_, inspectorDock_, effectsDock_}) d->setEnabled(true);
    if (!show) viewport_->setFocus();
}

void MainWindow::keepPicture() {
    // Once the view has drawn what is there now.
    QTimer::singleShot(400, this, [this] {
        const auto& path = document_.session().path();
        if (path.empty() || startShown() || !viewport_->isVisible() || document_.document().elements.empty()) return;
        const QString file = QString::fromStdString(path.string());
        if (!isSample(file)) files_->recent().setThumbnail(file, viewport_->grabFramebuffer());
    });
}

double MainWindow::inspectorShare() const {
    const QDockWidget* inFront = effectsDock_->visibleRegion().isEmpty() ? inspectorDock_ : effectsDock_;
    return double(inFront->height()) / std::max(stage_->height(), 1);
}

void MainWindow::shareHeight(double inspector) {
    inspector = std::clamp(inspector, 0.1, 0.9);
    QTimer::singleShot(0, this, [this, inspector] {
        resizeDocks({outlinerDock_, inspectorDock_}, {int(1000.0 * (1.0 - inspector)), int(1000.0 * inspector)}, Qt::Vertical);
    });
}

void MainWindow::showEvent(QShowEvent* event) {
    QMainWindow::showEvent(event);
    if (shown_) return;
    shown_ = true;
    // restoreState() knows pixels of a window that has not its size yet.
    shareHeight(QSettings().value(QStringLiteral("window/inspector"), kInspectorShare).toDouble());
}

void MainWindow::settle() {
    if (viewport_->busy()) viewport_->cancel();
}

void MainWindow::placeOverlays() {
    if (!job_ || !stage_) return;
    int bottom = stage_->height() - px(18);
    for (QFrame* overlay : {static_cast<QFrame*>(job_), static_cast<QFrame*>(message_)}) {
        if (!overlay->isVisible()) continue;
        const int width = std::min(px(520), stage_->width() - px(32));
        overlay->setFixedWidth(std::max(px(200), width));
        overlay->adjustSize();
        overlay->move((stage_->width() - overlay->width()) / 2, bottom - overlay->height());
        overlay->raise();
        bottom -= overlay->height() + px(8);
    }
}

bool MainWindow::event(QEvent* event) {
    // Space plays, but a button that has the focus is pressed by it.
    if (event->type() == QEvent::ShortcutOverride) {
        const auto* key = static_cast<QKeyEvent*>(event);
        if (key->key() == Qt::Key_Space && key->modifiers() == Qt::NoModifier && qobject_cast<QAbstractButton*>(focusWidget())) {
            event->accept();
            return true;
        }
    }
    return QMainWindow::event(event);
}

bool MainWindow::eventFilter(QObject* watched, QEvent* event) {
    if (event->type() == QEvent::Resize || event->type() == QEvent::Show || event->type() == QEvent::Hide || event->type() == QEvent::LayoutRequest)
        if (watched == stage_ || event->type() != QEvent::Resize) QMetaObject::invokeMethod(this, &MainWindow::placeOverlays, Qt::QueuedConnection);
    return QMainWindow::eventFilter(watched, event);
}

void MainWindow::resizeEvent(QResizeEvent* event) {
    QMainWindow::resizeEvent(event);
    placeOverlays();
}

void MainWindow::closeEvent(QCloseEvent* event) {
    settle();
    if (!files_->mayDiscard()) {
        event->ignore();
        return;
    }
    precompute_->cancel();
    QSettings settings;
    settings.setValue(QStringLiteral("window/geometry"), saveGeometry());
    settings.setValue(QStringLiteral("window/docks"), saveState(kStateVersion));
    settings.setValue(QStringLiteral("window/inspector"), inspectorShare());
    event->accept();
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
    if (event->mimeData()->hasUrls()) event->acceptProposedAction();
}

void MainWindow::dropEvent(QDropEvent* event) {
    QStringList paths;
    for (const QUrl& url : event->mimeData()->urls())
        if (url.isLocalFile()) paths << url.toLocalFile();
    event->acceptProposedAction();
    // After the drop is over: what follows may open windows.
    QMetaObject::invokeMethod(this, [this, paths] { files_->drop(paths); }, Qt::QueuedConnection);
}

// ---- commands ------------------------------------------------------------------------------------------------------------

void MainWindow::warn() {
    for (const WarningText& text : warningTexts(document_.warnings())) {
        if (!text.severe) continue;
        QElapsedTimer& since = warned_[text.warning];
        const bool anew = !since.isValid() || since.elapsed() > kWarnAgainMs;
        since.start();  // what goes on and on is said once; the status line keeps it
        if (anew) message_->say(text.text, MessageBar::Tone::Warning);
    }
}

void MainWindow::startPrecompute() {
    settle();
    precomputeFailed_ = false;
    if (!precompute_->start()) message_->say(tr("Everything is precomputed already."), MessageBar::Tone::Info);
    updateActions();
}

void MainWindow::openExport() {
    settle();
    if (!export_) {
        export_ = new ExportDialog(document_, files_->folder(), this);
        export_->setAttribute(Qt::WA_DeleteOnClose);
    }
    export_->show();
    export_->raise();
    export_->activateWindow();
}

void MainWindow::record() {
    settle();
    if (deck_->recording() || deck_->counting()) return deck_->stopRecording();
    showStart(false);
    takesDock_->show();
    takesDock_->raise();
    // What is performed is dragged or touched.
    if (viewport_->tool() != ToolKind::Pose && viewport_->tool() != ToolKind::Touch) viewport_->setTool(ToolKind::Pose);
    deck_->startRecording();
    viewport_->setFocus();
}

void MainWindow::updateTakeActions() {
    StudioActions& a = *actions_;
    const bool chosen = deck_->take() && !deck_->recording();
    a["record"]->setEnabled(deck_->canRecord());
    for (const char* id : {"play", "take-back", "take-forward", "mark-in", "mark-out", "rename-take", "duplicate-take", "remove-take"}) a[id]->setEnabled(chosen);
    for (const char* id : {"mark-none", "trim-take"}) a[id]->setEnabled(chosen && deck_->marked());
    a["count-in"]->setChecked(deck_->countsIn());
    a["leave-take"]->setEnabled(deck_->shown());
    a["loop"]->setChecked(deck_->looping());
    static const QIcon play = themedIcon(QStringLiteral("play")), pause = themedIcon(QStringLiteral("pause"));
    a["play"]->setIcon(deck_->playing() ? pause : play);
}

void MainWindow::undo(int count) {
    // Undo in the middle of a drag takes the drag back, nothing more.
    if (viewport_->busy()) {
        viewport_->cancel();
        return;
    }
    document_.execute({{"do", "undo"}, {"count", count}});
}

void MainWindow::hideSelected() {
    settle();
    Gesture gesture(document_);
    for (const SelectionItem& item : std::vector(document_.selection())) {
        const auto element = document_.document().elements.find(item.part);
        if (item.kind != Kind::Element || element == document_.document().elements.end()) continue;
        if (!document_.execute({{"do", "set"}, {"target", element->second->name}, {"property", "visible"}, {"value", false}})) return;
    }
    gesture.commit();
}

void MainWindow::showAll() {
    settle();
    Gesture gesture(document_);
    std::vector<std::string> hidden;
    for (const auto& [id, element] : document_.document().elements)
        if (!element->visible) hidden.push_back(element->name);
    for (const std::string& name : hidden)
        if (!document_.execute({{"do", "set"}, {"target", name}, {"property", "visible"}, {"value", true}})) return;
    gesture.commit();
}

void MainWindow::pinSelected() {
    settle();
    std::set<EndpointRef> ends;
    for (const SelectionItem& item : document_.selection()) {
        if (item.kind == Kind::Endpoint) ends.insert({item.part, item.atEnd});
        if (item.kind == Kind::Bone) ends.insert({item.part, true});
    }
    Gesture gesture(document_);
    for (const EndpointRef& end : ends) {
        const auto bone = document_.document().bones.find(end.bone);
        if (bone == document_.document().bones.end()) continue;
        const auto held = document_.document().held.find(end);
        const bool pinned = held != document_.document().held.end() && held->second.pinned;
        if (!document_.execute({{"do", pinned ? "unpin" : "pin"}, {"endpoint", bone->second->name + (end.atEnd ? "/end" : "/start")}})) return;
    }
    gesture.commit();
}

void MainWindow::joinSelected() {
    settle();
    std::vector<std::string> faces;
    for (const SelectionItem& item : document_.selection())
        if (item.kind == Kind::Face) faces.push_back(document_.document().elements.at(item.part)->name + "/" + item.face);
    if (faces.size() != 2) return;
    const auto joined = document_.execute({{"do", "join"}, {"a", faces[0]}, {"b", faces[1]}});
    if (joined) message_->say(tr("Joined %1 and %2").arg(QString::fromStdString(faces[0]), QString::fromStdString(faces[1])), MessageBar::Tone::Good);
}

void MainWindow::contextMenu(const QPoint& global) {
    QMenu menu(this);
    for (const char* id : {"rename", "delete", "", "join", "pin", "", "hide", "show-all", "frame-selection"}) {
        if (*id) menu.addAction((*actions_)[id]);
        else menu.addSeparator();
    }
    menu.exec(global);
}

void MainWindow::showControls() {
    const bool blender = viewport_->navigationPreset() == NavigationPreset::Blender;
    // Keys can be changed.
    const auto keys = [this](std::initializer_list<const char*> actions) {
        QStringList found;
        for (const char* id : actions)
            if (const QKeySequence key = (*actions_)[id]->shortcut(); !key.isEmpty()) found << key.toString(QKeySequence::NativeText);
        return found.join(QStringLiteral(", "));
    };
    const std::pair<QString, QString> rows[] = {
        {tr("Turn the view"), blender ? tr("Middle mouse button") : tr("Alt + left mouse button")},
        {tr("Move the view"), blender ? tr("Shift + middle mouse button") : tr("Alt + middle mouse button")},
        {tr("Nearer, farther"), blender ? tr("Wheel") : tr("Wheel, Alt + right mouse button")},
        {tr("Select"), tr("Click, or drag a box from nothing; Shift adds")},
        {tr("Take back what is unfinished"), tr("Esc or right mouse button")},
        {tr("Frame all, frame the selection"), keys({"frame-all", "frame-selection"})},
        {tr("Views along the axes"), QStringLiteral("1, 3, 7, 5")},
        {tr("Tools"), keys({"tool-select", "tool-face", "tool-bone", "tool-pose", "tool-touch"})},
        {tr("Precompute"), keys({"precompute"})},
        {tr("Record, play"), keys({"record", "play"})},
        {tr("Search commands"), keys({"search"})},
    };
    QString text = QStringLiteral("<table cellspacing='0' cellpadding='5' style='font-weight:400'>");
    for (const auto& [what, how] : rows) text += QStringLiteral("<tr><td style='padding-right:28px'>%1</td><td><b>%2</b></td></tr>").arg(what.toHtmlEscaped(), how.toHtmlEscaped());
    QMessageBox box(this);
    box.setWindowTitle(tr("Mouse and keys"));
    box.setTextFormat(Qt::RichText);
    box.setText(text + QStringLiteral("</table>"));
    box.addButton(tr("Close"), QMessageBox::RejectRole);
    box.exec();
}

void MainWindow::showAbout() {
    QMessageBox box(this);
    box.setWindowTitle(tr("About Imomushi"));
    box.setIconPixmap(QIcon(QStringLiteral(":/icons/imomushi.svg")).pixmap(QSize(px(64), px(64)), devicePixelRatioF()));
    box.setTextFormat(Qt::RichText);
    box.setText(QStringLiteral("<b>Imomushi %1</b><p style='font-weight:400'>%2</p><p style='font-weight:400'>%3</p>")
                    .arg(QLatin1String(kVersion), tr("Articulated elastic characters in real time.").toHtmlEscaped(), tr("Free software under the GNU General Public License, version 3 or later.").toHtmlEscaped()));
    box.addButton(tr("Close"), QMessageBox::RejectRole);
    box.exec();
}

}  // namespace imomushi
