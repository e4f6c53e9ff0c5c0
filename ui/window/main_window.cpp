// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/main_window.h"

#include <QAbstractButton>
#include <QApplication>
#include <QCloseEvent>
#include <QDockWidget>
#include <QDragEnterEvent>
#include <QKeyEvent>
#include <QMimeData>
#include <QSettings>
#include <QScreen>
#include <QStackedLayout>
#include <QStatusBar>
#include <QTabBar>
#include <QTimer>
#include <utility>
#include <QUrl>
#include <QVBoxLayout>
#include <QWindow>
#include <algorithm>

#include "core/commands/proposal_commands.h"
#include "ui/dialogs/export_dialog.h"
#include "ui/dialogs/preferences_dialog.h"
#include "ui/jobs/export_job.h"
#include "ui/jobs/proposal_job.h"
#include "ui/models/commands.h"
#include "ui/models/effect_texts.h"
#include "ui/models/failures.h"
#include "ui/models/gesture.h"
#include "ui/models/input_deck.h"
#include "ui/models/output_deck.h"
#include "ui/models/selection_commands.h"
#include "ui/models/texts.h"
#include "ui/panels/accuracy/accuracy_panel.h"
#include "ui/panels/effects_panel.h"
#include "ui/panels/history_panel.h"
#include "ui/panels/inspector/inspector_panel.h"
#include "ui/panels/issues_panel.h"
#include "ui/panels/outliner_panel.h"
#include "ui/panels/poses_panel.h"
#include "ui/panels/takes_panel.h"
#include "ui/viewport/picture_job.h"
#include "ui/viewport/pose_pictures.h"
#include "ui/viewport/viewport_widget.h"
#include "ui/widgets/appearance.h"
#include "ui/window/action_states.h"
#include "ui/window/clipboard_flow.h"
#include "ui/window/file_flow.h"
#include "ui/window/job_card.h"
#include "ui/window/key_listener.h"
#include "ui/window/message_bar.h"
#include "ui/window/next_steps.h"
#include "ui/window/overlays.h"
#include "ui/window/repair_flow.h"
#include "ui/window/replay_bar.h"
#include "ui/window/replay_flow.h"
#include "ui/window/rig_flow.h"
#include "ui/window/stage_mode.h"
#include "ui/window/start_page.h"
#include "ui/window/status_strip.h"
#include "ui/window/step_flow.h"
#include "ui/window/studio_actions.h"
#include "ui/window/studio_docks.h"
#include "ui/window/studio_menus.h"

namespace imomushi {
namespace {

constexpr double kInspectorShare = 0.65;  // of the height of the docks on the right, at first
constexpr int kFrameWide = 16, kFrameHigh = 48;  // that a desktop puts around a window
constexpr int kWarnAgainMs = 5000;
constexpr int kPictureMs = 400;          // until the view has drawn what is there now
constexpr int kStateVersion = 4;         // of the arrangement of docks in QSettings

}  // namespace

MainWindow::MainWindow(const CommandRegistry& registry, std::shared_ptr<ResponseStore> store) : document_(registry, std::move(store)) {
    setObjectName(QStringLiteral("studio"));
    setAcceptDrops(true);
    actions_ = new StudioActions(this);
    deck_ = new TakeDeck(document_, this);
    inputs_ = new InputDeck(document_, *deck_, this);
    outputs_ = new OutputDeck(document_, this);
    steps_ = new StepFlow(document_, [this] { return document_.inGesture() || (viewport_ && viewport_->tools().busy()); }, this);
    files_ = new FileFlow(document_, *steps_, this);
    rigs_ = new RigFlow(document_, *files_, *steps_, *deck_, this);
    repairs_ = new RepairFlow(document_, *files_, this);
    replay_ = new ReplayFlow(document_, *files_, *steps_, this);
    clipboard_ = new ClipboardFlow(document_, *steps_, this);
    posePictures_ = new PosePictures(document_, this);
    thumbnail_ = new PictureJob(this);
    precompute_ = new PrecomputeFlow(document_, [this] { return viewport_->tools().busy(); }, this);
    proposals_ = new ProposalJob(this);
    costs_ = new FrameCostMeter(document_, this);
    buildStage();
    document_.perform();
    buildStatusBar();
    docks_ = new StudioDocks(*this, document_, *deck_, *inputs_, *outputs_, *costs_, *actions_);
    connectActions();
    menus_ = new StudioMenus(*this, *actions_, files_->recent(), *docks_);
    states_ = new ActionStates(*actions_, document_, *deck_, *inputs_, precompute_->job(), *steps_, *clipboard_, this);
    new KeyListener(*this, *inputs_, [this] { return viewport_->tools().tool().modal(); });
    next_ = new NextSteps(document_, *actions_, menus_->samplesMenu(), viewport_->parentWidget());

    stageMode_ = new StageMode(*this, *viewport_, *overlays_, *docks_);

    connectDocument();
    connectFiles();
    connectReplay();
    connectPrecompute();
    connectRepairs();
    connectSteps();
    connectClipboard();
    connectProposals();
    connectPanels();
    connectView();
    connect(states_, &ActionStates::updated, this, &MainWindow::updateTitle);
    // Keys that no field waits for are the view's.
    connect(qApp, &QApplication::focusChanged, this, [this](const QWidget*, const QWidget* now) {
        if (!now && isActiveWindow() && viewport_->isVisible() && !QApplication::activeModalWidget() && !QApplication::activePopupWidget()) viewport_->setFocus();
    });
    connect(&Appearance::instance(), &Appearance::changed, this, &MainWindow::takeSizes);
    // New metrics make the docks forget how they shared their height.
    connect(&Appearance::instance(), &Appearance::aboutToChange, this, [this] {
        if (isVisible()) docks_->shareHeight(docks_->inspectorShare());
    });

    takeSizes();
    retranslate();
    viewport_->tools().setTool(ToolKind::Select);
    showStart(true);
    restore();
}

MainWindow::~MainWindow() {
    disconnect(qApp, nullptr, this, nullptr);
    // What hears the document goes before it does.
    delete takeCentralWidget();
    delete docks_;
    delete export_;
    delete states_;
    delete outputs_;
    delete inputs_;
    delete deck_;
    delete precompute_;
    delete proposals_;
    delete clipboard_;
    delete posePictures_;
    delete thumbnail_;
    delete replay_;
    delete repairs_;
    delete rigs_;
    delete files_;
    delete steps_;
    delete statusBar();
    document_.disconnect();
}

OutlinerPanel& MainWindow::outliner() { return docks_->outliner(); }
InspectorPanel& MainWindow::inspector() { return docks_->inspector(); }
EffectsPanel& MainWindow::effects() { return docks_->effects(); }
AccuracyPanel& MainWindow::accuracy() { return docks_->accuracy(); }
TakesPanel& MainWindow::takes() { return docks_->takes(); }
LivePanel& MainWindow::live() { return docks_->live(); }
IssuesPanel& MainWindow::issues() { return docks_->issues(); }
HistoryPanel& MainWindow::history() { return docks_->history(); }
MessageBar& MainWindow::messages() { return overlays_->message(); }

// ---- putting together ------------------------------------------------------------------------------------------------------

void MainWindow::buildStage() {
    stage_ = new QWidget(this);
    stack_ = new QStackedLayout(stage_);
    auto* viewHost = new QWidget(stage_);
    auto* viewLayout = new QVBoxLayout(viewHost);
    viewLayout->setContentsMargins(0, 0, 0, 0);
    viewport_ = new ViewportWidget(document_, viewHost);
    viewport_->follow(*deck_);
    viewLayout->addWidget(viewport_);
    start_ = new StartPage(files_->recent(), stage_);
    stack_->addWidget(viewHost);
    stack_->addWidget(start_);
    setCentralWidget(stage_);
    overlays_ = new Overlays(stage_);
}

void MainWindow::buildStatusBar() {
    status_ = new StatusStrip(document_, [this] {
        const auto& known = precompute_->estimates().latest();
        return known ? std::optional(known->precompute) : std::nullopt;
    }, this);
    auto* bar = new QStatusBar(this);
    bar->setSizeGripEnabled(false);
    bar->setStyleSheet(QStringLiteral("QStatusBar::item { border: none; } QStatusBar { border: none; }"));
    bar->setContentsMargins(0, 0, px(10), 0);
    bar->addWidget(status_, 1);
    auto* costs = new CostBar(*costs_, this);
    connect(costs, &CostBar::clicked, this, [this] {
        StudioDocks::raise(accuracy());
        accuracy().showCosts();
    });
    bar->addPermanentWidget(costs);
    setStatusBar(bar);
}

void MainWindow::connectDocument() {
    const auto warning = [this](const QString& text) { messages().say(text, MessageBar::Tone::Warning); };
    connect(&document_, &StudioDocument::failed, this, warning);
    connect(&Failures::instance(), &Failures::failed, this, warning);
    connect(&document_, &StudioDocument::frameStepped, this, &MainWindow::warn);
    connect(&document_, &StudioDocument::madeCut, this, [this](const QString& text) { messages().offer(text, tr("Place bones"), [this] { setTool(ToolKind::Bone); }); });
    connect(&document_, &StudioDocument::offered, this, [this](const QString& text, const QString& label, const Json& command) {
        messages().offer(text, label, [this, command] {
            if (command == commands::precompute()) return startPrecompute();
            settle();
            // What was turned on may need a precompute, which the tool then offers.
            document_.executeSlow({command, {}, [this](const Json&) { viewport_->tools().begin(); }});
        });
    });
    connect(deck_, &TakeDeck::said, this, warning);
    connect(deck_, &TakeDeck::recorded, this, [this](const QString& take, double seconds) {
        messages().offer(tr("Recorded “%1”, %2 s").arg(take, QLocale().toString(seconds, 'f', 1)), tr("Play"), [this, take] {
            const Take* recorded = document_.document().takeNamed(take.toStdString());
            if (!recorded) return;
            StudioDocks::raise(takes());
            deck_->choose(recorded->id);
            deck_->setPlaying(true);
        });
    });
}

void MainWindow::connectFiles() {
    connect(files_, &FileFlow::leaving, this, [this] {
        settle();
        deck_->stopRecording();  // so that the artist is asked whether to keep it
    });
    connect(files_, &FileFlow::warned, this, [this](const QString& text) { messages().say(text, MessageBar::Tone::Warning); });
    connect(files_, &FileFlow::working, this, [this](const QString& text) { messages().say(text, MessageBar::Tone::Info); });
    connect(files_, &FileFlow::worked, this, [this](const QString& text) { messages().withdraw(text); });
    connect(files_, &FileFlow::said, this, [this](const QString& text) { messages().say(text, MessageBar::Tone::Good); });
    connect(files_, &FileFlow::opened, this, [this] {
        precompute_->job().cancel();
        repairs_->cancel();
        steps_->cancel();
        rigs_->job().cancel();
        proposals_->cancel();
        effects().forgetOffers();
        showStart(false);
        viewport_->frameAll(false);
        keepPicture();
    });
    connect(files_, &FileFlow::imported, this, [this](int elements) {
        showStart(false);
        viewport_->frameAll(document_.document().elements.size() > std::size_t(elements));
    });
    connect(files_, &FileFlow::performable, this, [this] { (*actions_)["tool-pose"]->trigger(); });
    connect(files_, &FileFlow::saved, this, &MainWindow::keepPicture);
    connect(start_, &StartPage::newWanted, files_, &FileFlow::newProject);
    connect(start_, &StartPage::openWanted, files_, &FileFlow::askOpen);
    connect(start_, &StartPage::meshWanted, this, [this] { files_->askImport(FileFlow::Lead::Mesh); });
    connect(start_, &StartPage::riggedFileWanted, this, [this] { files_->askImport(FileFlow::Lead::RiggedFile); });
    connect(start_, &StartPage::fileWanted, files_, &FileFlow::open, Qt::QueuedConnection);
    connect(menus_, &StudioMenus::fileWanted, this, [this](const QString& path) {
        settle();
        files_->open(path);
    });
}

void MainWindow::connectReplay() {
    overlays_->add(new ReplayBar(*replay_, stage_));
    const auto start = [this](const QString& title, const QString& script) {
        settle();
        replay_->start(title, script);
    };
    connect(start_, &StartPage::replayWanted, this, start);
    connect(menus_, &StudioMenus::replayWanted, this, start);
    connect(replay_, &ReplayFlow::built, this, [this] { viewport_->frameAll(); });
    connect(replay_, &ReplayFlow::precomputeWanted, this, &MainWindow::startPrecompute);
    connect(replay_, &ReplayFlow::ended, this, [this](const QString& title) { messages().say(tr("“%1” is built. It is your project now: each step can be undone.").arg(title), MessageBar::Tone::Good); });
}

void MainWindow::connectPrecompute() {
    PrecomputeJob* job = &precompute_->job();
    overlays_->job().follow(job, [job] { return tr("Precomputing %1").arg(job->element()); });
    connect(job, &BackgroundJob::progressed, this, [this, job] {
        if (job->running()) status_->setBusy(tr("Precomputing %1 %").arg(int(100.0 * job->fraction())));
    });
    connect(job, &BackgroundJob::finished, this, [this] { status_->setBusy({}); });
    connect(precompute_, &PrecomputeFlow::started, states_, &ActionStates::update);
    connect(precompute_, &PrecomputeFlow::keptSome, &files_->autosave(), &Autosave::saveSoon);
    connect(precompute_, &PrecomputeFlow::done, this, [this](const QString& text) { messages().say(text, MessageBar::Tone::Good); });
    connect(precompute_, &PrecomputeFlow::said, this, [this](const QString& text) { messages().say(text, MessageBar::Tone::Info); });
    connect(precompute_, &PrecomputeFlow::warned, this, [this](const QString& text) { messages().say(text, MessageBar::Tone::Warning); });
    connect(&precompute_->estimates(), &EstimateJob::estimated, this, [this] {
        const auto& costs = precompute_->estimates().latest()->effects;
        status_->update();
        effects().setCosts(costs);
        costs_->setPredicted(costs);
    });
}

void MainWindow::connectRepairs() {
    overlays_->job().follow(&repairs_->job(), [this] { return tr("Mending %1").arg(repairs_->subject()); });
    connect(&issues(), &IssuesPanel::repairWanted, this, [this](const std::vector<Json>& commands) {
        settle();
        repairs_->start(commands);
    });
    connect(repairs_, &RepairFlow::unchanged, this, [this](const QString& text) { messages().say(text, MessageBar::Tone::Info); });
    connect(repairs_, &RepairFlow::repaired, this, [this](const QString& text) {
        messages().offer(text, tr("Undo"), [this, position = document_.session().position()] {
            if (document_.session().position() == position) undo();
        });
    });
}

void MainWindow::connectSteps() {
    overlays_->job().follow(&steps_->job(), [this] { return steps_->title(); });
    overlays_->job().follow(&rigs_->job(), [this] { return tr("Looking at the bones of “%1”").arg(QString::fromStdString(rigs_->job().character()->name)); });
    steps_->job().setAfterwards(prepareView);
    document_.setBeside([this](SlowStep step) { steps_->start(std::move(step)); }, [this] { steps_->giveUp(); });
    connect(steps_, &StepFlow::changed, viewport_, [this] { viewport_->redraw(); });  // what stood where it is going is there, or back
    connect(steps_, &StepFlow::cancelled, this, [this] { messages().say(tr("Cancelled; nothing has changed."), MessageBar::Tone::Info); });
    // What comes next is out of the way while it is being done, also by changing a proposal, which has a banner there.
    const auto wait = [this] { next_->setWaiting(steps_->running() || viewport_->tools().proposal() || stageMode_->on() || replay_->running()); };
    connect(steps_, &StepFlow::changed, this, wait);
    connect(&viewport_->tools(), &ToolHost::toolChanged, this, wait);
    connect(stageMode_, &StageMode::changed, this, wait);
    connect(replay_, &ReplayFlow::changed, this, wait);
    connect(stageMode_, &StageMode::changed, (*actions_)["stage"], &QAction::setChecked);
    connect(next_, &NextSteps::makeSoftWanted, this, [this](PartId part) {
        settle();
        const Document& d = document_.document();
        if (const auto character = d.characters.find(part); character != d.characters.end()) files_->makeSoft(*character->second);
        else files_->makeSoft(*d.elements.at(part));
    });
    connect(rigs_, &RigFlow::said, this, [this](const QString& text) { messages().say(text, MessageBar::Tone::Good); });
    connect(files_, &FileFlow::skeletonCame, this, [this](const QString& name, const QString& text) {
        const CharacterSource* character = document_.document().characterNamed(name.toStdString());
        if (!character || !canBecomeSoft(document_.document(), *character)) return messages().say(text, MessageBar::Tone::Good);
        messages().offer(text, tr("Make it soft"), [this, id = character->id] {
            const auto now = document_.document().characters.find(id);
            if (now != document_.document().characters.end() && !steps_->running()) files_->makeSoft(*now->second);
        });
    });
}

void MainWindow::connectProposals() {
    overlays_->job().follow(proposals_, [this] { return tr("Finding limbs of %1", "a character").arg(proposals_->character() ? QString::fromStdString(proposals_->character()->name) : QString()); });
    connect(proposals_, &BackgroundJob::finished, this, [this](bool completed) {
        if (!completed || !proposals_->result()) return;
        const Result<Proposal>& proposal = *proposals_->result();
        const PartId character = proposals_->character()->id;
        if (!proposal) return messages().say(errorText(proposal.error()), MessageBar::Tone::Warning);
        // It may be another one by now.
        const auto now = document_.document().characters.find(character);
        if (now == document_.document().characters.end() || now->second->body != proposals_->character()->body || !canBecomeSoft(document_.document(), *now->second)) return;
        showStart(false);
        viewport_->tools().propose(character, *proposal);
        viewport_->setFocus();
    });
    connect(&viewport_->tools(), &ToolHost::proposalAccepted, this, [this](const Json& command) { files_->makeSoft(command); });
    connect(&viewport_->tools(), &ToolHost::proposalKept, this, [this] { messages().offer(tr("The proposal is kept as it is."), tr("Show it"), [this] { propose(); }); });
    // Cancelled or refused; what is done is not there any more.
    connect(steps_, &StepFlow::changed, this, [this] {
        if (!steps_->running()) viewport_->tools().handBackProposal();
    });
}

void MainWindow::connectPanels() {
    connect(&docks_->poses(), &PosesPanel::seen, posePictures_, &PosePictures::setWanted);
    connect(posePictures_, &PosePictures::drawn, &docks_->poses(), &PosesPanel::setPicture);
    connect(&outliner(), &OutlinerPanel::contextMenuWanted, menus_, &StudioMenus::popUpContextMenu);
    connect(&outliner(), &OutlinerPanel::effectWanted, this, &MainWindow::showEffect);
    connect(&inspector(), &InspectorPanel::precomputeWanted, this, &MainWindow::startPrecompute);
    connect(&effects(), &EffectsPanel::precomputeWanted, this, &MainWindow::startPrecompute);
    connect(status_, &StatusStrip::precomputeWanted, this, &MainWindow::startPrecompute);
    connect(&issues(), &IssuesPanel::frameWanted, viewport_, [this] { viewport_->frameSelection(); });
    connect(&issues(), &IssuesPanel::markWanted, viewport_, &ViewportWidget::setHighlightedTriangles);
    const auto mark = [this](PartId character, const std::vector<std::int32_t>& triangles, const std::optional<Vec3>& point) {
        viewport_->setMarked(character ? std::optional(MarkedPlace{character, triangles, point}) : std::nullopt);
    };
    connect(&issues(), &IssuesPanel::placeWanted, this, mark);
    connect(&issues(), &IssuesPanel::placeFrameWanted, viewport_, &ViewportWidget::frameMarked);
    connect(&inspector(), &InspectorPanel::placeWanted, this, [this, mark](PartId character, const Vec3& point) {
        mark(character, {}, point);
        viewport_->frameMarked();
    });
    connect(&inspector(), &InspectorPanel::partWanted, this, [mark](PartId character, const std::vector<std::int32_t>& triangles) { mark(character, triangles, std::nullopt); });
}

void MainWindow::connectView() {
    connect(viewport_, &ViewportWidget::hintChanged, this, &MainWindow::sayHint);
    connect(viewport_, &ViewportWidget::frameMeasured, status_, &StatusStrip::setFrame);
    connect(viewport_, &ViewportWidget::latencyMeasured, status_, &StatusStrip::setLatency);
    connect(viewport_, &ViewportWidget::frameMeasured, costs_, &FrameCostMeter::take);
    sayHint();
    const QSettings settings;
    setNavigation(NavigationPreset(std::clamp(settings.value(QStringLiteral("view/navigation"), 0).toInt(), 0, 1)));
    document_.setHistoryDepth(PreferencesDialog::historyDepth());
    document_.setVersionLimits(PreferencesDialog::versionLimits());
    viewport_->setDeformOn(ViewportWidget::DeformOn(std::clamp(settings.value(QStringLiteral("view/deform-on"), 0).toInt(), 0, 2)));
    viewport_->setPictureQuality(ViewportWidget::PictureQuality(std::clamp(settings.value(QStringLiteral("view/picture"), 0).toInt(), 0, 2)));
}

void MainWindow::restore() {
    const QSettings settings;
    const QSize room = screen()->availableGeometry().size() - QSize(kFrameWide, kFrameHigh), wanted(px(1440), px(900));
    resize(wanted.boundedTo(room));
    if (size() != wanted) setWindowState(Qt::WindowMaximized);
    restoreGeometry(settings.value(QStringLiteral("window/geometry")).toByteArray());
    restoreState(settings.value(QStringLiteral("window/docks")).toByteArray(), kStateVersion);
    menus_->wrapTools();
}

// Larger letters and longer words push the window's edges out.
void MainWindow::keepOnScreen() {
    if (!isVisible() || isFullScreen()) return;
    layout()->activate();
    const QRect room = screen()->availableGeometry().marginsRemoved(windowHandle()->frameMargins());
    const QRect now = geometry();
    if (room.contains(now)) return;
    QRect kept({}, now.size().boundedTo(room.size()));
    kept.moveTo(std::clamp(now.left(), room.left(), room.left() + room.width() - kept.width()), std::clamp(now.top(), room.top(), room.top() + room.height() - kept.height()));
    setGeometry(kept);
}

// Docks get their tab bars when they are laid out, and again when they move.
void MainWindow::childEvent(QChildEvent* event) {
    QMainWindow::childEvent(event);
    if (auto* tabs = event->type() == QEvent::ChildPolished ? qobject_cast<QTabBar*>(event->child()) : nullptr) tabs->setAccessibleName(StudioDocks::tr("Panels"));
}

void MainWindow::retranslate() {
    actions_->retranslate();
    menus_->retranslate();
    docks_->retranslate();
    viewport_->setAccessibleName(tr("View of the character"));
    status_->setAccessibleName(tr("Status"));
    states_->update();
    next_->retranslate();
    sayHint();
    overlays_->place();
    QTimer::singleShot(0, this, &MainWindow::keepOnScreen);
}

void MainWindow::takeSizes() {
    menus_->takeSizes();
    docks_->takeSizes();
    overlays_->place();
    states_->update();
    QTimer::singleShot(0, this, &MainWindow::keepOnScreen);
}

void MainWindow::changeEvent(QEvent* event) {
    QMainWindow::changeEvent(event);
    if (!states_) return;  // not put together yet
    if (event->type() == QEvent::LanguageChange) {
        retranslate();
        if (export_ && !export_->job().running()) {  // says everything anew
            delete export_;
            openExport();
        }
    }
    if (event->type() == QEvent::WindowStateChange) (*actions_)["full-screen"]->setChecked(isFullScreen());
}

// ---- state ---------------------------------------------------------------------------------------------------------------

void MainWindow::updateTitle() {
    const auto& path = document_.session().path();
    const QString name = path.empty() ? tr("New project") : QString::fromStdString(path.stem().string());
    setWindowTitle(QStringLiteral("%1[*] – Imomushi").arg(name));
    setWindowModified(document_.session().modified());
}

bool MainWindow::startShown() const { return stack_->currentWidget() == start_; }

void MainWindow::showStart(bool show) {
    if (show) settle();
    stack_->setCurrentWidget(show ? static_cast<QWidget*>(start_) : viewport_->parentWidget());
    if (!show) viewport_->setFocus();
    sayHint();
}

void MainWindow::sayHint() { status_->setHint(startShown() ? tr("Choose a sample, or drop a file on the window · Help > Mouse and keys lists all keys") : viewport_->hint()); }

void MainWindow::keepPicture() {
    QTimer::singleShot(kPictureMs, this, [this] {
        const auto& path = document_.session().path();
        if (path.empty() || startShown() || !viewport_->isVisible() || document_.document().elements.empty()) return;
        const QString file = QString::fromStdString(path.string());
        if (isSample(file)) return;
        // The middle of the view.
        const QSize size = viewport_->size().scaled(RecentFiles::kThumbnail, Qt::KeepAspectRatioByExpanding);
        thumbnail_->start(viewport_->pictureScene({size, false, true, true}), size, files_->recent().thumbnailFile(file), [this](const Result<void>&) { files_->recent().thumbnailDrawn(); }, RecentFiles::kThumbnail);
    });
}

void MainWindow::warn() {
    for (const WarningText& text : warningTexts(document_.warnings())) {
        if (!text.severe) continue;
        QElapsedTimer& since = warned_[text.warning];
        const bool anew = !since.isValid() || since.elapsed() > kWarnAgainMs;
        since.start();  // what goes on and on is said once; the status line keeps it
        if (anew) messages().say(text.text, MessageBar::Tone::Warning);
    }
}

// ---- events --------------------------------------------------------------------------------------------------------------

void MainWindow::showEvent(QShowEvent* event) {
    QMainWindow::showEvent(event);
    if (shown_) return;
    shown_ = true;
    QTimer::singleShot(0, this, &MainWindow::keepOnScreen);
    // restoreState() knows pixels of a window that has not its size yet.
    docks_->shareHeight(QSettings().value(QStringLiteral("window/inspector"), kInspectorShare).toDouble());
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

// Nobody took it: the key of something that cannot be done now says why.
void MainWindow::keyPressEvent(QKeyEvent* event) {
    if (event->key() == Qt::Key_Escape && stageMode_->on()) return stageMode_->set(false);
    const QKeySequence keys(event->keyCombination());
    for (const QAction* action : actions_->all())
        if (!action->isEnabled() && !event->isAutoRepeat() && action->shortcuts().contains(keys))
            if (const QString why = whyDisabled(*action); !why.isEmpty()) return messages().say(why, MessageBar::Tone::Info);
    QMainWindow::keyPressEvent(event);
}

void MainWindow::resizeEvent(QResizeEvent* event) {
    QMainWindow::resizeEvent(event);
    menus_->wrapTools();
    overlays_->place();
}

void MainWindow::closeEvent(QCloseEvent* event) {
    settle();
    if (!files_->mayDiscard()) {
        event->ignore();
        return;
    }
    precompute_->cancel();
    stageMode_->set(false);
    QSettings settings;
    settings.setValue(QStringLiteral("window/geometry"), saveGeometry());
    settings.setValue(QStringLiteral("window/docks"), saveState(kStateVersion));
    if (const double share = docks_->inspectorShare(); share > 0.0) settings.setValue(QStringLiteral("window/inspector"), share);
    event->accept();
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
    if (!event->mimeData()->hasUrls()) return;
    event->acceptProposedAction();
    setDropping(true);
}

void MainWindow::dragLeaveEvent(QDragLeaveEvent* event) {
    setDropping(false);
    QMainWindow::dragLeaveEvent(event);
}

void MainWindow::setDropping(bool dropping) {
    start_->setDropping(dropping);
    next_->setDropping(dropping);
}

void MainWindow::dropEvent(QDropEvent* event) {
    setDropping(false);
    QStringList paths;
    for (const QUrl& url : event->mimeData()->urls())
        if (url.isLocalFile()) paths << url.toLocalFile();
    event->acceptProposedAction();
    // After the drop is over: what follows may open windows.
    QMetaObject::invokeMethod(this, [this, paths] { files_->drop(paths); }, Qt::QueuedConnection);
}

}  // namespace imomushi
