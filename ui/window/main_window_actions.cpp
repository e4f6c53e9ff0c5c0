// SPDX-License-Identifier: GPL-3.0-or-later
// What the actions of the window do.
#include <QActionGroup>
#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <QSettings>

#include "core/commands/proposal_commands.h"
#include "core/document/cycle.h"
#include "core/document/kept_pose.h"
#include "ui/dialogs/export_dialog.h"
#include "ui/dialogs/help_dialogs.h"
#include "ui/dialogs/manual_dialog.h"
#include "ui/dialogs/picture_dialog.h"
#include "ui/dialogs/place_dialog.h"
#include "ui/dialogs/preferences_dialog.h"
#include "ui/jobs/proposal_job.h"
#include "ui/models/commands.h"
#include "ui/models/input_deck.h"
#include "ui/models/selection_commands.h"
#include "ui/models/texts.h"
#include "ui/panels/cycles_panel.h"
#include "ui/panels/effects_panel.h"
#include "ui/panels/poses_panel.h"
#include "ui/panels/live/live_panel.h"
#include "ui/panels/outliner_panel.h"
#include "ui/panels/takes_panel.h"
#include "ui/tools/select_tool.h"
#include "ui/viewport/picture_job.h"
#include "ui/viewport/viewport_widget.h"
#include "ui/widgets/appearance.h"
#include "ui/window/action_states.h"
#include "ui/window/clipboard_flow.h"
#include "ui/window/command_search.h"
#include "ui/window/drag_options.h"
#include "ui/window/file_flow.h"
#include "ui/window/main_window.h"
#include "ui/window/job_card.h"
#include "ui/window/message_bar.h"
#include "ui/window/overlays.h"
#include "ui/window/rig_flow.h"
#include "ui/window/stage_mode.h"
#include "ui/window/studio_actions.h"
#include "ui/window/studio_docks.h"

namespace imomushi {
namespace {

constexpr std::pair<const char*, ToolKind> kTools[] = {
    {"tool-select", ToolKind::Select}, {"tool-face", ToolKind::Face}, {"tool-bone", ToolKind::Bone}, {"tool-handle", ToolKind::Handle}, {"tool-pose", ToolKind::Pose}, {"tool-touch", ToolKind::Touch}};

constexpr std::pair<const char*, PlaceDialog::Kind> kPlaced[] = {
    {"place-bone", PlaceDialog::Kind::Bone}, {"place-face", PlaceDialog::Kind::Face}, {"place-cut", PlaceDialog::Kind::Cut}, {"place-handle", PlaceDialog::Kind::Handle}};

}  // namespace

void MainWindow::on(const char* action, std::function<void()> run) { connect((*actions_)[action], &QAction::triggered, this, [run = std::move(run)] { run(); }); }
void MainWindow::onToggle(const char* action, std::function<void(bool)> run) { connect((*actions_)[action], &QAction::triggered, this, std::move(run)); }

void MainWindow::onSettled(const char* action, std::function<void()> run) {
    on(action, [this, run = std::move(run)] {
        settle();
        // What a panel is in the middle of is not the action's to end.
        if (!document_.inGesture()) run();
    });
}

void MainWindow::settle() {
    if (viewport_->tools().busy()) viewport_->tools().cancel();
}

void MainWindow::connectActions() {
    connectFileActions();
    connectEditActions();
    connectSoftActions();
    connectTakeActions();
    connectLiveActions();
    connectViewActions();
    on("search", [this] { (new CommandSearch(findables(), this))->popUp(); });
    on("manual", [this] {
        auto* manual = findChild<ManualDialog*>();
        if (!manual) manual = new ManualDialog(this);
        manual->show();
        manual->raise();
        manual->activateWindow();
    });
    on("controls", [this] { ControlsDialog(*actions_, viewport_->navigationPreset() == NavigationPreset::Blender, this).exec(); });
    on("about", [this] { AboutDialog(this).exec(); });
}

void MainWindow::connectFileActions() {
    on("start", [this] { showStart(!startShown()); });
    onSettled("new", [this] { files_->newProject(); });
    onSettled("open", [this] { files_->askOpen(); });
    onSettled("import", [this] { files_->askImport(); });
    onSettled("append", [this] { files_->askAppend(); });
    onSettled("save", [this] { files_->save(); });
    onSettled("save-as", [this] { files_->saveAs(); });
    onSettled("save-copy", [this] { files_->saveCopy(); });
    onSettled("versions", [this] { files_->askVersion(); });
    onSettled("save-script", [this] { files_->saveScript(); });
    on("export", [this] { openExport(); });
    onSettled("write-mesh", [this] { files_->writeMesh(); });
    on("quit", [this] { close(); });
}

void MainWindow::connectEditActions() {
    on("undo", [this] { undo(); });
    onSettled("redo", [this] {
        if (!viewport_->tools().redo()) document_.execute(commands::redo());
    });
    onSettled("delete", [this] { removeSelection(document_); });
    onSettled("copy", [this] { clipboard_->copySelected(); });
    onSettled("cut", [this] { clipboard_->cutSelected(); });
    onSettled("paste", [this] {
        showStart(false);
        clipboard_->paste();
    });
    onSettled("duplicate", [this] { duplicateSelected(document_); });
    for (const char* axis : {"x", "y", "z"}) onSettled(QByteArray("mirror-").append(axis).constData(), [this, axis] { mirror(*axis); });
    onSettled("replace-mesh", [this] { files_->askReplaceMesh(); });
    on("rename", [this] {
        StudioDocks::raise(outliner());
        outliner().renameSelected();
    });
    on("select-all", [this] { selectAll(document_); });
    on("select-none", [this] { document_.select({}); });
    on("select-invert", [this] { invertSelection(document_); });
    on("select-more", [this] { growSelection(document_); });
    on("select-chain", [this] { selectChain(document_); });
    onSettled("keep-pose", [this] {
        if (document_.execute(commands::keepPose())) StudioDocks::raise(docks_->poses());
    });
    onSettled("mirror-pose", [this] { document_.execute(commands::mirrorPose()); });
    const auto restSelected = [this](bool chain) {
        std::vector<std::string> names;
        for (const SelectionItem& item : document_.selection())
            if (item.kind == SelectionItem::Kind::Bone || item.kind == SelectionItem::Kind::Endpoint) names.push_back(document_.document().bones.at(item.part)->name);
        if (!names.empty()) document_.execute(commands::restBones(names, chain));
    };
    onSettled("rest-bones", [restSelected] { restSelected(false); });
    onSettled("rest-chain", [restSelected] { restSelected(true); });
    for (std::size_t n = 1; n <= 9; ++n)
        onSettled(QByteArray("pose-").append(QByteArray::number(qulonglong(n))).constData(), [this, n] {
            const KeptPoses& poses = keptPoses(document_.document());
            if (poses.size() >= n) document_.execute(commands::applyPose(poses[n - 1].name));
        });
    on("preferences", [this] { openPreferences(); });
    auto* tools = new QActionGroup(this);
    for (const auto& [id, kind] : kTools) {
        tools->addAction((*actions_)[id]);
        on(id, [this, tool = kind] { setTool(tool); });
    }
    (*actions_)["tool-select"]->setChecked(true);
    connect(&viewport_->tools(), &ToolHost::toolChanged, this, [this](ToolKind kind) {
        for (const auto& [id, tool] : kTools)
            if (tool == kind) (*actions_)[id]->setChecked(true);
    });
    onSettled("propose", [this] { propose(); });
    on("precompute", [this] { startPrecompute(); });
    const QString softAtOnce = QStringLiteral("precompute/soft-at-once");
    onToggle("soft-at-once", [this, softAtOnce](bool checked) {
        precompute_->drafts().setEnabled(checked);
        QSettings().setValue(softAtOnce, checked);
    });
    precompute_->drafts().setEnabled(QSettings().value(softAtOnce, true).toBool());
    (*actions_)["soft-at-once"]->setChecked(precompute_->drafts().enabled());
    viewport_->setAwaits([this](PartId element) { return precompute_->drafts().awaits(element); });
    drags_ = new DragOptions(
        *actions_, viewport_->tools(), [this](const Element& element) { return precompute_->drafts().enabled() && element.mesh->body.vertices.rows() <= DraftJob::kLargest; }, [this] { settle(); }, this);
    for (const auto& [action, kind] : kPlaced)
        onSettled(action, [this, kind = kind] {
            showStart(false);
            auto* dialog = new PlaceDialog(document_, kind, this);
            dialog->setAttribute(Qt::WA_DeleteOnClose);
            dialog->open();
        });
    onSettled("edit-face", [this] {
        if (document_.selection().size() != 1 || document_.selection().front().kind != SelectionItem::Kind::Face) return;
        showStart(false);
        auto* dialog = new PlaceDialog(document_, FaceRef{document_.selection().front().part, document_.selection().front().face}, this);
        dialog->setAttribute(Qt::WA_DeleteOnClose);
        dialog->open();
    });
    onSettled("join", [this] { join(); });
    onSettled("pin", [this] { togglePins(document_); });
    onSettled("release", [this] { document_.execute(commands::releaseAll()); });
    onSettled("rest", [this] { document_.execute(commands::rest()); });
    onSettled("hide", [this] { hideSelected(document_); });
    onSettled("isolate", [this] { isolateSelected(document_); });
    onSettled("lock", [this] { lockSelected(document_); });
    onSettled("show-all", [this] { showAll(document_); });
}

void MainWindow::connectClipboard() {
    connect(clipboard_, &ClipboardFlow::said, this, [this](const QString& text) { messages().say(text, MessageBar::Tone::Good); });
    connect(clipboard_, &ClipboardFlow::warned, this, [this](const QString& text) { messages().say(text, MessageBar::Tone::Warning); });
    connect(&effects(), &EffectsPanel::copyWanted, this, [this](const std::vector<EffectKind>& wanted) {
        std::vector<std::string> names;
        for (const EffectKind effect : wanted) names.emplace_back(effectName(effect));
        if (clipboard_->copy(names)) messages().say(tr("Copied the settings"), MessageBar::Tone::Good);
    });
    connect(&effects(), &EffectsPanel::pasteWanted, this, [this] {
        settle();
        clipboard_->paste();
    });
}

void MainWindow::connectSoftActions() {
    const auto onCharacter = [this](const char* action, std::function<void(const CharacterSource&)> run) {
        onSettled(action, [this, run = std::move(run)] {
            const CharacterSource* character = chosenCharacter(document_);
            if (!character) return;
            showStart(false);
            run(*character);
        });
    };
    onSettled("make-soft", [this] {
        const SoftWish wish = softWish(document_);
        if (wish.character || wish.element) showStart(false);
        if (wish.character) files_->makeSoft(*wish.character);
        if (wish.element) files_->makeSoft(*wish.element);
    });
    onCharacter("make-soft-bones", [this](const CharacterSource& character) { rigs_->chooseBones(character); });
    onCharacter("import-skeleton", [this](const CharacterSource& character) { files_->askImportSkeleton(character); });
    onCharacter("import-clips", [this](const CharacterSource& character) { files_->askImportClips(character); });
    onCharacter("take-clip", [this](const CharacterSource& character) {
        StudioDocks::raise(takes());
        rigs_->takeClips(character);
    });
}

void MainWindow::connectTakeActions() {
    onSettled("record", [this] { record(); });
    onSettled("play", [this] {
        showStart(false);
        deck_->setPlaying(!deck_->playing());
    });
    onSettled("take-back", [this] { deck_->step(-1); });
    onSettled("take-forward", [this] { deck_->step(1); });
    onToggle("loop", [this](bool checked) { deck_->setLooping(checked); });
    on("mark-in", [this] { deck_->setSpan(deck_->time(), deck_->to()); });
    on("mark-out", [this] { deck_->setSpan(deck_->from(), deck_->time()); });
    on("mark-none", [this] {
        if (const Take* take = deck_->take()) deck_->setSpan(0.0, take->duration());
    });
    onSettled("trim-take", [this] { deck_->trim(); });
    on("rename-take", [this] {
        StudioDocks::raise(takes());
        takes().rename();
    });
    onSettled("duplicate-take", [this] { deck_->duplicate(); });
    onSettled("remove-take", [this] { deck_->remove(); });
    const QString countsIn = QStringLiteral("takes/count-in");
    onToggle("count-in", [this, countsIn](bool checked) {
        deck_->setCountsIn(checked);
        QSettings().setValue(countsIn, checked);
    });
    deck_->setCountsIn(QSettings().value(countsIn, false).toBool());
    on("leave-take", [this] { deck_->leave(); });
}

void MainWindow::connectLiveActions() {
    on("live-inputs", [this] {
        showStart(false);
        StudioDocks::raise(live());
    });
    onSettled("move-by-itself", [this] {
        showStart(false);
        StudioDocks::raise(docks_->poses());
        CyclesPanel& cycles = *docks_->poses().cycles();
        if (cyclesOf(document_.document()).empty()) cycles.suggest();
        cycles.begin();
    });
    on("let-go", [this] { inputs_->letGo(); });
    for (const auto& [action, protocol] : {std::pair("suggest-keys", InputProtocol::Keys), std::pair("suggest-pad", InputProtocol::Pad), std::pair("suggest-vmc", InputProtocol::Vmc), std::pair("suggest-voice", InputProtocol::Voice)})
        onSettled(action, [this, protocol = protocol] {
            const auto answer = document_.execute(commands::suggestMappings(protocol, std::string(protocolName(protocol))));
            if (!answer) return;
            // Whoever maps a source wants it heard.
            const auto& sources = inputs_->sources();
            for (std::size_t i = 0; i < sources.size(); ++i)
                if (sources[i].name == protocolName(protocol) && !sources[i].on) inputs_->setOn(i, true);
            inputs_->goOn();
            StudioDocks::raise(live());
            messages().say(tr("%n mapping(s) made. Change them as you like.", nullptr, answer->at("suggested").get<int>()), MessageBar::Tone::Good);
        });
    const QString filter = tr("Mappings (*.json)");
    onSettled("load-mappings", [this, filter] {
        const QString path = QFileDialog::getOpenFileName(this, tr("Load mappings"), files_->folder(), filter);
        if (path.isEmpty()) return;
        const auto answer = document_.execute(commands::loadMappings(path.toStdString()));
        if (!answer) return;
        StudioDocks::raise(live());
        const int loaded = answer->at("loaded").get<int>(), missing = int(answer->at("missing").size());
        if (missing > 0) messages().say(tr("%n mapping(s) loaded.", nullptr, loaded) + u' ' + tr("%n of them wait(s) for what the character does not have.", nullptr, missing), MessageBar::Tone::Warning);
        else messages().say(tr("%n mapping(s) loaded.", nullptr, loaded), MessageBar::Tone::Good);
    });
    onSettled("save-mappings", [this, filter] {
        QString path = QFileDialog::getSaveFileName(this, tr("Save mappings"), QDir(files_->folder()).filePath(QStringLiteral("mappings.json")), filter);
        if (path.isEmpty()) return;
        if (QFileInfo(path).suffix().isEmpty()) path += QStringLiteral(".json");
        if (document_.execute(commands::saveMappings(path.toStdString()))) messages().say(tr("Wrote “%1”").arg(QFileInfo(path).fileName()), MessageBar::Tone::Good);
    });
}

void MainWindow::connectViewActions() {
    StudioActions& a = *actions_;
    on("frame-all", [this] { viewport_->frameAll(); });
    on("frame-selection", [this] { viewport_->frameSelection(); });
    on("view-front", [this] { viewport_->setViewAxis(ViewAxis::Front); });
    on("view-right", [this] { viewport_->setViewAxis(ViewAxis::Right); });
    on("view-top", [this] { viewport_->setViewAxis(ViewAxis::Top); });
    onToggle("orthographic", [this](bool checked) { viewport_->setOrthographic(checked); });
    onToggle("bones", [this](bool checked) { viewport_->setBonesVisible(checked); });
    onToggle("grid", [this](bool checked) { viewport_->setGridVisible(checked); });
    onToggle("bodies", [this](bool checked) { viewport_->setBodiesVisible(checked); });
    onToggle("xray", [this](bool checked) { viewport_->setXray(checked); });
    const auto follow = [this, &a] {
        a["orthographic"]->setChecked(viewport_->orthographic());
        a["bones"]->setChecked(viewport_->bonesVisible());
        a["grid"]->setChecked(viewport_->gridVisible());
        a["bodies"]->setChecked(viewport_->bodiesVisible());
        a["xray"]->setChecked(viewport_->xray());
    };
    connect(viewport_, &ViewportWidget::viewChanged, this, follow);
    follow();
    onSettled("picture", [this] { savePicture(); });
    onToggle("stage", [this](bool checked) {
        if (checked) showStart(false);
        stageMode_->set(checked);
    });
    onToggle("full-screen", [this](bool checked) { checked ? showFullScreen() : showNormal(); });
    auto* themes = new QActionGroup(this);
    for (int i = 0; i < int(std::size(kThemeActions)); ++i) {
        themes->addAction(a[kThemeActions[i]]);
        on(kThemeActions[i], [i] { Appearance::instance().setTheme(Appearance::Theme(i)); });
    }
    auto* languages = new QActionGroup(this);
    for (const auto& [id, language] : {std::pair{"language-en", "en"}, std::pair{"language-ja", "ja"}}) {
        languages->addAction(a[id]);
        on(id, [language = QString::fromLatin1(language)] { Appearance::instance().setLanguage(language); });
    }
}

void MainWindow::setTool(ToolKind tool) {
    showStart(false);
    viewport_->tools().setTool(tool);
    viewport_->setFocus();
}

void MainWindow::setNavigation(NavigationPreset preset) {
    viewport_->setNavigationPreset(preset);
    drags_->setIndustryKeys(preset == NavigationPreset::Industry);
}

void MainWindow::startPrecompute() {
    settle();
    precompute_->start();
}

void MainWindow::propose() {
    const SoftWish wish = softWish(document_);
    const CharacterSource* character = wish.character;
    if (wish.element && canBecomeSoft(document_.document(), *wish.element)) {
        const std::string name = wish.element->name;
        if (document_.execute(commands::makeCharacter(name))) character = document_.document().characterNamed(name);
    }
    if (!character || !canBecomeSoft(document_.document(), *character)) return;
    if (!viewport_->tools().resumeProposal(character->id)) return proposals_->start(document_.document().characters.at(character->id));
    showStart(false);
    viewport_->setFocus();
}

void MainWindow::undo() {
    // Undo in the middle of a drag takes the drag back, nothing more.
    if (viewport_->tools().busy()) viewport_->tools().cancel();
    else if (steps_->isLatest()) steps_->cancelLatest();  // not made yet, and what was asked for last
    else if (!document_.inGesture() && !viewport_->tools().undo()) document_.execute(commands::undo());
}

void MainWindow::join() {
    if (const auto faces = joinSelected(document_))
        messages().say(tr("Joined %1 and %2").arg(QString::fromStdString(faces->first), QString::fromStdString(faces->second)), MessageBar::Tone::Good);
}

void MainWindow::mirror(char axis) {
    mirrorSelected(document_, axis, [this] { messages().say(tr("Mirrored"), MessageBar::Tone::Good); });
}

void MainWindow::record() {
    if (deck_->recording() || deck_->counting()) return deck_->stopRecording();
    showStart(false);
    // Whoever performs by the faders of cycles, or looks at meters, keeps them.
    if (!stageMode_->on() && !live().isVisible() && !docks_->poses().isVisible()) StudioDocks::raise(takes());
    // What is performed is dragged or touched.
    if (viewport_->tools().kind() != ToolKind::Pose && viewport_->tools().kind() != ToolKind::Touch) viewport_->tools().setTool(ToolKind::Pose);
    deck_->startRecording();
    viewport_->setFocus();
}

void MainWindow::savePicture() {
    showStart(false);
    PictureDialog dialog(viewport_->size() * devicePixelRatioF(), this);
    if (dialog.exec() != QDialog::Accepted) return;
    const QString start = QDir(files_->folder()).filePath(QStringLiteral("%1.png").arg(document_.session().path().empty() ? QStringLiteral("picture") : QString::fromStdString(document_.session().path().stem().string())));
    QString path = QFileDialog::getSaveFileName(this, tr("Save a picture"), start, tr("Pictures (*.png)"));
    if (path.isEmpty()) return;
    if (QFileInfo(path).suffix().isEmpty()) path += QStringLiteral(".png");
    auto* job = new PictureJob(this);
    overlays_->job().follow(job, [path] { return tr("Drawing “%1”").arg(QFileInfo(path).fileName()); });
    connect(job, &BackgroundJob::finished, job, &QObject::deleteLater);
    job->start(viewport_->pictureScene(dialog.picture()), dialog.picture().size, path, [this, path](const Result<void>& done) {
        if (done) messages().say(tr("Wrote “%1”").arg(QFileInfo(path).fileName()), MessageBar::Tone::Good);
        else messages().say(errorText(done.error()), MessageBar::Tone::Warning);
    });
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

void MainWindow::openPreferences(const QString& setting) {
    PreferencesDialog dialog(*actions_, this);
    connect(&dialog, &PreferencesDialog::navigationChanged, this, [this](int preset) { setNavigation(NavigationPreset(preset)); });
    connect(&dialog, &PreferencesDialog::deformOnChanged, this, [this](int where) { viewport_->setDeformOn(ViewportWidget::DeformOn(where)); });
    connect(&dialog, &PreferencesDialog::pictureQualityChanged, this, [this](int quality) { viewport_->setPictureQuality(ViewportWidget::PictureQuality(quality)); });
    connect(&dialog, &PreferencesDialog::historyDepthChanged, this, [this](int steps) { document_.setHistoryDepth(steps); });
    connect(&dialog, &PreferencesDialog::versionsChanged, this, [this] { document_.setVersionLimits(PreferencesDialog::versionLimits()); });
    connect(&dialog, &PreferencesDialog::responsesChanged, this, [this] { document_.session().responses().store().setLimits(PreferencesDialog::responseLimits()); });
    dialog.choose(setting);
    dialog.exec();
}

}  // namespace imomushi
