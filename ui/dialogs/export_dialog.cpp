// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/export_dialog.h"

#include <QButtonGroup>
#include <QCheckBox>
#include <QComboBox>
#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <QLabel>
#include <QLineEdit>
#include <QProgressBar>
#include <QPushButton>
#include <QSettings>
#include <QSignalBlocker>
#include <QVBoxLayout>
#include <algorithm>

#include "core/commands/export_commands.h"
#include "ui/dialogs/export_report_view.h"
#include "ui/jobs/export_job.h"
#include "ui/jobs/progress_text.h"
#include "ui/models/texts.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/choice_card.h"
#include "ui/widgets/dialog_form.h"
#include "ui/widgets/layouts.h"
#include "ui/widgets/scrolled.h"

namespace imomushi {
namespace {

constexpr const char* kLayouts[] = {"baked", "rigged", "skinned", "cache"};
constexpr double kRates[] = {0.0, 24.0, 25.0, 30.0, 60.0};
constexpr int kFastestRate = int(std::size(kRates)) - 1;
constexpr int kTargets[] = {0, 8, 4};

QString keyOf(const char* name) { return QStringLiteral("export/") + QLatin1String(name); }

QString presetTitle(const QString& name) {
    if (name == u"exact") return ExportDialog::tr("Exact");
    if (name == u"threejs") return QStringLiteral("three.js");
    return name.isEmpty() ? name : name.at(0).toUpper() + name.mid(1);
}

/// What a preset sets.
QString presetNote(const ExportOptions& options) {
    QStringList parts;
    if (options.fps > 0.0) parts << ExportDialog::tr("%1 frames/s").arg(options.fps);
    if (options.targets > 0) parts << ExportDialog::tr("%n target(s)", nullptr, options.targets);
    if (options.split) parts << ExportDialog::tr("weights 0–1");
    if (options.quantised) parts << ExportDialog::tr("16 bits");
    return parts.isEmpty() ? ExportDialog::tr("All targets, keys as recorded") : parts.join(ExportDialog::tr(", "));
}

}  // namespace

ExportDialog::ExportDialog(StudioDocument& document, const QString& folder, QWidget* parent) : QDialog(parent), document_(document), job_(new ExportJob(this)) {
    setWindowTitle(tr("Export"));
    setObjectName(QStringLiteral("exportDialog"));
    const auto section = [this](const QString& text) {
        auto* label = styled(new QLabel(text, this), "section");
        return label;
    };
    // In the order in which the keyboard goes through them.
    auto* page = new QWidget;
    auto* layout = fill(new QVBoxLayout(page), QMargins(px(22), px(18), px(22), px(6)), Spacing{px(10)}, section(tr("For")));
    fill(layout, makePresets(), Space{px(4)}, section(tr("As")));
    fill(layout, makeLayouts(), Space{px(8)});
    auto* columns = fill(new QHBoxLayout, Spacing{px(22)}, Share{makeOptions(), 1});
    report_ = new ExportReportView(this);
    columns->addWidget(report_, 1);
    fill(layout, Share{columns, 1}, Space{px(4)}, makeFile());
    auto* foot = makeFoot();
    foot->setContentsMargins(px(22), px(4), px(22), px(16));
    fill(new QVBoxLayout(this), QMargins(0, 0, 0, 0), Spacing{0}, Share<QWidget>{new ScrolledRows(page, this), 1}, foot);
    resize(withinScreen(*this, {px(940), px(640)}));

    recall(folder);
    fillTakes();
    takeLayout();
    report_->showBefore(document.document().effects);

    connect(presets_, &QButtonGroup::idClicked, this, &ExportDialog::takePreset);
    connect(layouts_, &QButtonGroup::idToggled, this, &ExportDialog::takeLayout);
    connect(format_, &QComboBox::currentIndexChanged, this, [this] {
        suitFormat();
        takeLayout();
    });
    connect(path_, &QLineEdit::textChanged, this, &ExportDialog::checkPath);
    connect(&document_, &StudioDocument::structureChanged, this, [this](const DocumentChange& change) {
        if (change.has(&DocumentChange::takes)) fillTakes();
        checkPath();
    });
    connect(job_, &BackgroundJob::progressed, this, &ExportDialog::showProgress);
    connect(job_, &BackgroundJob::finished, this, &ExportDialog::showOutcome);
    showProgress();
    write_->setFocus();
}

// ---- parts of the form ---------------------------------------------------------------------------------------------------

QLayout* ExportDialog::makePresets() {
    presets_ = new QButtonGroup(this);
    auto* row = fill(new QHBoxLayout, Spacing{px(8)});
    int id = 0;
    for (const ExportPreset& preset : exportPresets()) {
        auto* card = new ChoiceCard(presetTitle(QString::fromLatin1(preset.name)), presetNote(preset.options), this);
        card->setObjectName(QLatin1String(preset.name));
        presets_->addButton(card, id++);
        row->addWidget(card, 1);
    }
    return row;
}

QLayout* ExportDialog::makeLayouts() {
    layouts_ = new QButtonGroup(this);
    auto* row = fill(new QHBoxLayout, Spacing{px(8)});
    const QString texts[][2] = {{tr("Baked"), tr("Rigid motion and morphs: exact, plays anywhere")},
                                {tr("Rigged"), tr("A skeleton that drives morph targets: for live puppeteering")},
                                {tr("Skinned"), tr("Fitted weights, no morph targets: for any engine")},
                                {tr("Cache"), tr("Every vertex in every frame: everything, but large")}};
    for (int i = 0; i < 4; ++i) {
        auto* card = new ChoiceCard(texts[i][0], texts[i][1], this);
        card->setObjectName(QLatin1String(kLayouts[i]));
        layouts_->addButton(card, i);
        row->addWidget(card, 1);
    }
    return row;
}

QLayout* ExportDialog::makeOptions() {
    take_ = new QComboBox(this);
    fps_ = new QComboBox(this);
    for (const double rate : kRates) fps_->addItem(rate > 0.0 ? tr("%1 per second").arg(rate) : tr("As recorded"));
    targets_ = new QComboBox(this);
    for (const int count : kTargets) targets_->addItem(count > 0 ? tr("The %n most important of each element or character", nullptr, count) : tr("All"));
    format_ = new QComboBox(this);
    split_ = new QCheckBox(tr("Weights within 0 and 1"), this);
    split_->setToolTip(tr("A target for each sign of a weight, for programs that clamp weights: twice as many targets"));
    quantise_ = new QCheckBox(tr("16 bits per coordinate"), this);
    quantise_->setToolTip(tr("Smaller files by KHR_mesh_quantization; what that costs is measured"));
    compress_ = new QCheckBox(tr("Compressed by meshopt"), this);
    compress_->setToolTip(tr("Smaller files by EXT_meshopt_compression, without loss; programs must know it: three.js and Babylon.js do, Blender does not"));
    normals_ = new QCheckBox(tr("Targets move normals"), this);
    normals_->setToolTip(tr("For engines that do not find normals themselves: larger files"));
    auto* form = new DialogForm;
    form->add(tr("Take"), take_);
    form->add(tr("Keys"), fps_);
    form->add(tr("Format"), format_);
    form->add(tr("Morph targets"), targets_);
    form->add(split_);
    form->add(quantise_);
    form->add(compress_);
    form->add(normals_);
    return form;
}

QLayout* ExportDialog::makeFile() {
    path_ = new QLineEdit(this);
    path_->setAccessibleName(tr("File"));
    auto* choose = new QPushButton(tr("Choose…"), this);
    choose->setAutoDefault(false);
    connect(choose, &QPushButton::clicked, this, &ExportDialog::browse);
    auto* label = styled(new QLabel(tr("File"), this), "muted");
    label->setBuddy(path_);
    return fill(new QHBoxLayout, Spacing{px(8)}, label, Share{path_, 1}, choose);
}

QLayout* ExportDialog::makeFoot() {
    replaces_ = styled(new QLabel(this), "muted");
    progress_ = new QProgressBar(this);
    progress_->setRange(0, 1000);
    progress_->setTextVisible(false);
    progress_->setFixedWidth(px(200));
    stage_ = styled(new QLabel(this), "muted");
    close_ = named(new QPushButton(this), "closeButton");
    close_->setAutoDefault(false);
    write_ = named(new QPushButton(tr("Export"), this), "exportButton");
    write_->setDefault(true);
    connect(close_, &QPushButton::clicked, this, &ExportDialog::reject);
    connect(write_, &QPushButton::clicked, this, &ExportDialog::write);
    return fill(new QHBoxLayout, Spacing{px(12)}, progress_, stage_, Share{replaces_, 1}, close_, write_);
}

void ExportDialog::recall(const QString& folder) {
    const QSettings settings;
    const auto within = [&](const char* key, int standard, int count) { return std::clamp(settings.value(keyOf(key), standard).toInt(), 0, count - 1); };
    presets_->button(within("preset", 0, int(exportPresets().size())))->setChecked(true);
    layouts_->button(within("layout", 0, int(std::size(kLayouts))))->setChecked(true);
    fillFormats();
    format_->setCurrentIndex(std::max(0, format_->findData(settings.value(keyOf("format")))));
    takePreset();
    fps_->setCurrentIndex(within("fps", fps_->currentIndex(), int(std::size(kRates))));
    targets_->setCurrentIndex(within("targets", targets_->currentIndex(), int(std::size(kTargets))));
    split_->setChecked(settings.value(keyOf("split"), split_->isChecked()).toBool());
    quantise_->setChecked(settings.value(keyOf("quantise"), quantise_->isChecked()).toBool());
    compress_->setChecked(settings.value(keyOf("compress"), false).toBool());
    normals_->setChecked(settings.value(keyOf("normals"), normals_->isChecked()).toBool());
    const auto& project = document_.session().path();
    const QString name = project.empty() ? tr("character") : QString::fromStdString(project.stem().string());
    const QString last = settings.value(keyOf("folder")).toString();
    setPath(QDir(QFileInfo(last).isDir() ? last : folder).filePath(name + u'.' + suffix()));
}

// ---- choices -------------------------------------------------------------------------------------------------------------

void ExportDialog::fillTakes() {
    using What = commands::Export::What;
    const int was = take_->currentIndex();
    const TakeChoice chosen = was < 0 ? TakeChoice() : takeChoices_[std::size_t(was)];
    take_->clear();
    takeChoices_.clear();
    const auto& takes = document_.document().takes;
    const auto add = [this](const QString& text, What what, const std::string& take = {}) {
        take_->addItem(text);
        takeChoices_.push_back({what, take});
    };
    if (takes.empty()) {
        add(tr("The pose as it is: there are no takes"), What::Takes);
    } else {
        add(tr("All takes (%1)").arg(takes.size()), What::Takes);
        add(tr("All takes (%1) and the pose as it is").arg(takes.size()), What::TakesAndPose);
        for (const auto& [id, take] : takes) add(QStringLiteral("%1 · %2").arg(QString::fromStdString(take->name), durationText(take->duration())), What::OneTake, take->name);
        add(tr("The pose as it is"), What::Pose);
    }
    take_->setEnabled(!takes.empty());
    const auto again = std::find(takeChoices_.begin(), takeChoices_.end(), chosen);
    take_->setCurrentIndex(again == takeChoices_.end() ? 0 : int(again - takeChoices_.begin()));
}

void ExportDialog::takePreset() {
    const ExportOptions& options = chosenPreset().options;
    const auto at = [](const auto& list, auto value) { return int(std::max<std::ptrdiff_t>(0, std::find(std::begin(list), std::end(list), value) - std::begin(list))) % int(std::size(list)); };
    fps_->setCurrentIndex(at(kRates, options.fps));
    targets_->setCurrentIndex(at(kTargets, options.targets));
    split_->setChecked(splitByItself());
    quantise_->setChecked(options.quantised);
    normals_->setChecked(options.normals);
    suitFormat();
}

/// Caches have formats of their own.
void ExportDialog::fillFormats() {
    // An avatar goes out by its bones alone.
    const auto& characters = document_.document().characters;
    const bool cache = layoutName() == "cache";
    const bool avatar = layoutName() == "skinned" && std::any_of(characters.begin(), characters.end(), [](const auto& c) { return c.second->rig && !c.second->rig->roles.empty(); });
    const auto has = [this](const char* format) { return format_->findData(QString::fromLatin1(format)) >= 0; };
    if (format_->count() > 0 && has("pc2") == cache && has("vrm") == avatar) return;
    const QSignalBlocker quiet(format_);
    format_->clear();
    if (cache) {
        format_->addItem(QStringLiteral("PC2"), QStringLiteral("pc2"));
        format_->addItem(QStringLiteral("MDD"), QStringLiteral("mdd"));
        format_->addItem(tr("OBJ, a file per frame"), QStringLiteral("obj"));
        format_->addItem(tr("PLY, a file per frame"), QStringLiteral("ply"));
    } else {
        format_->addItem(QStringLiteral("glTF (GLB)"), QStringLiteral("glb"));
        format_->addItem(tr("FBX, by Blender"), QStringLiteral("fbx"));
        if (avatar) format_->addItem(tr("VRM 1.0 avatar"), QStringLiteral("vrm"));
    }
    suitFormat();
}

void ExportDialog::suitFormat() {
    if (splitByItself()) split_->setChecked(true);
    compress_->setEnabled(layoutName() != "cache" && suffix() != u"fbx");
    // These hold whole frames of one rate; what was recorded comes at any time.
    if ((suffix() == u"fbx" || suffix() == u"pc2") && fps_->currentIndex() == 0) fps_->setCurrentIndex(kFastestRate);
}

QString ExportDialog::suffix() const { return format_->currentData().toString(); }

/// What the weights are where the command is not told: FBX is made by Blender, which clamps them.
bool ExportDialog::splitByItself() const { return chosenPreset().options.split || suffix() == u"fbx"; }

const ExportPreset& ExportDialog::chosenPreset() const { return exportPresets()[std::size_t(presets_->checkedId())]; }

std::string ExportDialog::layoutName() const { return kLayouts[layouts_->checkedId()]; }

void ExportDialog::takeLayout() {
    if (layouts_->checkedId() < 0) return;
    fillFormats();
    const bool cache = layoutName() == "cache", morphs = layoutName() == "baked" || layoutName() == "rigged";
    targets_->setEnabled(morphs);
    split_->setEnabled(morphs);
    normals_->setEnabled(morphs);
    quantise_->setEnabled(!cache);
    compress_->setEnabled(!cache && suffix() != u"fbx");
    const QFileInfo info(path_->text());
    if (!info.fileName().isEmpty() && info.suffix() != suffix()) setPath(info.dir().filePath(info.completeBaseName() + u'.' + suffix()));
    checkPath();
}

void ExportDialog::setPath(const QString& path) { path_->setText(path); }

void ExportDialog::checkPath() {
    const QFileInfo info(path_->text());
    const bool names = !info.fileName().isEmpty() && !info.isDir();
    replaces_->setText(job_->running() || !names || !info.exists() || path_->text() == report_->written() ? QString() : tr("Replaces the file that is there."));
    write_->setEnabled(names && !job_->running() && !document_.document().elements.empty());
}

void ExportDialog::browse() {
    const QString kind = suffix();
    QString path = QFileDialog::getSaveFileName(this, tr("Export to"), path_->text(), QStringLiteral("%1 (*.%2)").arg(kind == u"glb" ? QStringLiteral("glTF") : kind.toUpper(), kind));
    if (path.isEmpty()) return;
    if (QFileInfo(path).suffix().toLower() != kind) path += u'.' + kind;
    setPath(path);
}

Json ExportDialog::command() const {
    const ExportPreset& preset = chosenPreset();
    const TakeChoice& take = takeChoices_[std::size_t(take_->currentIndex())];
    // What is as the preset has it is not said.
    const auto unless = [](auto standard, auto value) { return value == standard ? std::nullopt : std::optional(value); };
    commands::Export choices;
    choices.path = path_->text().toStdString();
    choices.layout = layoutName();
    choices.preset = preset.name;
    choices.what = take.what;
    choices.take = take.take;
    choices.fps = unless(preset.options.fps, kRates[fps_->currentIndex()]);
    choices.targets = unless(preset.options.targets, kTargets[targets_->currentIndex()]);
    choices.split = unless(splitByItself(), split_->isChecked());
    choices.quantise = unless(preset.options.quantised, quantise_->isChecked());
    if (compress_->isEnabled() && compress_->isChecked()) choices.compress = true;
    choices.normals = unless(preset.options.normals, normals_->isChecked());
    return commands::exportCharacter(choices);
}

void ExportDialog::remember() const {
    QSettings settings;
    settings.setValue(keyOf("preset"), presets_->checkedId());
    settings.setValue(keyOf("layout"), layouts_->checkedId());
    settings.setValue(keyOf("format"), suffix());
    settings.setValue(keyOf("fps"), fps_->currentIndex());
    settings.setValue(keyOf("targets"), targets_->currentIndex());
    settings.setValue(keyOf("split"), split_->isChecked());
    settings.setValue(keyOf("quantise"), quantise_->isChecked());
    settings.setValue(keyOf("compress"), compress_->isChecked());
    settings.setValue(keyOf("normals"), normals_->isChecked());
    settings.setValue(keyOf("folder"), QFileInfo(path_->text()).absolutePath());
}

// ---- writing -------------------------------------------------------------------------------------------------------------

void ExportDialog::write() {
    if (job_->running()) return;
    auto plan = planExport(document_.session(), command());
    if (!plan) return report_->showFailure(plan.error());
    remember();
    report_->showWriting(path_->text());
    job_->start(std::move(*plan));
    showProgress();
}

void ExportDialog::reject() {
    if (job_->running()) job_->cancel();
    else QDialog::reject();
}

void ExportDialog::showProgress() {
    const bool running = job_->running();
    progress_->setVisible(running);
    stage_->setVisible(running);
    progress_->setValue(int(1000.0 * job_->fraction()));
    stage_->setText(progressText(*job_));
    close_->setText(running ? tr("Cancel") : tr("Close"));
    checkPath();
}

void ExportDialog::showOutcome(bool completed) {
    showProgress();
    if (!completed) return report_->showCancelled();
    const auto outcome = job_->answer();
    if (!*outcome) return report_->showFailure(outcome->error());
    report_->showAnswer(**outcome);
    checkPath();
}

}  // namespace imomushi
