// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/export_dialog.h"

#include <QButtonGroup>
#include <QCheckBox>
#include <QComboBox>
#include <QDesktopServices>
#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <QLabel>
#include <QLineEdit>
#include <QLocale>
#include <QProgressBar>
#include <QPushButton>
#include <QSettings>
#include <QSignalBlocker>
#include <QUrl>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "core/document/export_commands.h"
#include "ui/jobs/export_job.h"
#include "ui/jobs/progress_text.h"
#include "ui/models/effect_texts.h"
#include "ui/models/texts.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/choice_card.h"
#include "ui/widgets/dialog_form.h"

namespace imomushi {
namespace {

using Role = Appearance::Role;

constexpr const char* kLayouts[] = {"baked", "rigged", "skinned", "cache"};
constexpr double kRates[] = {0.0, 24.0, 25.0, 30.0, 60.0};
constexpr int kFastestRate = int(std::size(kRates)) - 1;
constexpr int kTargets[] = {0, 8, 4};
/// A file whose vertices are this near to the character's (over its diagonal) is the character.
constexpr double kSame = 1e-5;

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

/// A part of the diagonal: "0.31 %", and small ones as "2·10⁻⁶".
QString shareText(double share) {
    const QLocale locale;
    if (share >= 1e-4) return QStringLiteral("%1 %").arg(locale.toString(100.0 * share, 'g', 2));
    if (!(share > 0.0)) return QStringLiteral("0");
    int exponent = int(std::floor(std::log10(share)));
    long mantissa = std::lround(share / std::pow(10.0, exponent));
    if (mantissa == 10) {
        mantissa = 1;
        ++exponent;
    }
    static constexpr char16_t kDigits[] = u"⁰¹²³⁴⁵⁶⁷⁸⁹";
    QString power(u'⁻');
    for (const QChar digit : QString::number(-exponent)) power += QChar(kDigits[digit.digitValue()]);
    return QStringLiteral("%1·10%2").arg(mantissa).arg(power);
}

}  // namespace

ExportDialog::ExportDialog(StudioDocument& document, const QString& folder, QWidget* parent) : QDialog(parent), document_(document) {
    setWindowTitle(tr("Export"));
    setObjectName(QStringLiteral("exportDialog"));
    job_ = new ExportJob(this);
    const auto section = [this](const QString& text) {
        auto* label = new QLabel(text, this);
        label->setProperty("role", "section");
        return label;
    };

    presets_ = new QButtonGroup(this);
    auto* presetRow = new QHBoxLayout;
    presetRow->setSpacing(px(8));
    for (const ExportPreset& preset : exportPresets()) {
        auto* card = new ChoiceCard(presetTitle(QString::fromLatin1(preset.name)), presetNote(preset.options), this);
        card->setObjectName(QLatin1String(preset.name));
        presets_->addButton(card, int(presetCards_.size()));
        presetCards_.push_back(card);
        presetRow->addWidget(card, 1);
    }
    layouts_ = new QButtonGroup(this);
    auto* layoutRow = new QHBoxLayout;
    layoutRow->setSpacing(px(8));
    const QString layoutTexts[][2] = {{tr("Baked"), tr("Rigid motion and morphs: exact, plays anywhere")},
                                      {tr("Rigged"), tr("One skeleton with what drives it: can be puppeteered live")},
                                      {tr("Skinned"), tr("Fitted weights, no morph targets: for any engine")},
                                      {tr("Cache"), tr("Every vertex in every frame: everything, but large")}};
    for (int i = 0; i < 4; ++i) {
        auto* card = new ChoiceCard(layoutTexts[i][0], layoutTexts[i][1], this);
        card->setObjectName(QLatin1String(kLayouts[i]));
        layouts_->addButton(card, i);
        layoutRow->addWidget(card, 1);
    }

    take_ = new QComboBox(this);
    fps_ = new QComboBox(this);
    for (const double rate : kRates) fps_->addItem(rate > 0.0 ? tr("%1 per second").arg(rate) : tr("As recorded"));
    targets_ = new QComboBox(this);
    for (const int count : kTargets) targets_->addItem(count > 0 ? tr("The %n most important of each element", nullptr, count) : tr("All"));
    format_ = new QComboBox(this);
    split_ = new QCheckBox(tr("Weights within 0 and 1"), this);
    split_->setToolTip(tr("A target for each sign of a weight, for programs that clamp weights: twice as many targets"));
    quantise_ = new QCheckBox(tr("16 bits per coordinate"), this);
    quantise_->setToolTip(tr("Smaller files by KHR_mesh_quantization; what that costs is measured"));
    normals_ = new QCheckBox(tr("Targets move normals"), this);
    normals_->setToolTip(tr("For engines that do not find normals themselves: larger files"));

    auto* form = new DialogForm;
    form->add(tr("Take"), take_);
    form->add(tr("Keys"), fps_);
    form->add(tr("Format"), format_);
    form->add(tr("Morph targets"), targets_);
    form->add(split_);
    form->add(quantise_);
    form->add(normals_);

    auto* result = new QFrame(this);
    result->setObjectName(QStringLiteral("card"));
    auto* resultLayout = new QVBoxLayout(result);
    resultLayout->setContentsMargins(px(16), px(12), px(16), px(12));
    resultLayout->setSpacing(px(8));
    reportTitle_ = section({});
    reportTitle_->setWordWrap(true);
    resultLayout->addWidget(reportTitle_);
    report_ = new QVBoxLayout;
    report_->setSpacing(px(7));
    resultLayout->addLayout(report_);
    resultLayout->addStretch();
    show_ = new QPushButton(tr("Show in folder"), result);
    show_->setObjectName(QStringLiteral("showInFolder"));
    show_->setIcon(themedIcon(QStringLiteral("open")));
    show_->setAutoDefault(false);
    connect(show_, &QPushButton::clicked, this, [this] { QDesktopServices::openUrl(QUrl::fromLocalFile(QFileInfo(written_).absolutePath())); });
    resultLayout->addWidget(show_, 0, Qt::AlignLeft);

    auto* columns = new QHBoxLayout;
    columns->setSpacing(px(22));
    columns->addLayout(form, 1);
    columns->addWidget(result, 1);

    path_ = new QLineEdit(this);
    path_->setAccessibleName(tr("File"));
    auto* choose = new QPushButton(tr("Choose…"), this);
    choose->setAutoDefault(false);
    connect(choose, &QPushButton::clicked, this, &ExportDialog::browse);
    replaces_ = new QLabel(this);
    replaces_->setProperty("role", "muted");
    auto* fileRow = new QHBoxLayout;
    fileRow->setSpacing(px(8));
    auto* fileLabel = new QLabel(tr("File"), this);
    fileLabel->setProperty("role", "muted");
    fileLabel->setBuddy(path_);
    fileRow->addWidget(fileLabel);
    fileRow->addWidget(path_, 1);
    fileRow->addWidget(choose);

    progress_ = new QProgressBar(this);
    progress_->setRange(0, 1000);
    progress_->setTextVisible(false);
    progress_->setFixedWidth(px(200));
    stage_ = new QLabel(this);
    stage_->setProperty("role", "muted");
    close_ = new QPushButton(this);
    close_->setObjectName(QStringLiteral("closeButton"));
    close_->setAutoDefault(false);
    write_ = new QPushButton(tr("Export"), this);
    write_->setObjectName(QStringLiteral("exportButton"));
    write_->setDefault(true);
    connect(close_, &QPushButton::clicked, this, &ExportDialog::reject);
    connect(write_, &QPushButton::clicked, this, &ExportDialog::write);
    auto* foot = new QHBoxLayout;
    foot->setSpacing(px(12));
    foot->addWidget(progress_);
    foot->addWidget(stage_);
    foot->addWidget(replaces_, 1);
    foot->addWidget(close_);
    foot->addWidget(write_);

    auto* layout = new QVBoxLayout(this);
    layout->setContentsMargins(px(22), px(18), px(22), px(16));
    layout->setSpacing(px(10));
    layout->addWidget(section(tr("For")));
    layout->addLayout(presetRow);
    layout->addSpacing(px(4));
    layout->addWidget(section(tr("As")));
    layout->addLayout(layoutRow);
    layout->addSpacing(px(8));
    layout->addLayout(columns, 1);
    layout->addSpacing(px(4));
    layout->addLayout(fileRow);
    layout->addLayout(foot);
    resize(px(940), px(640));

    const QSettings settings;
    presets_->button(std::clamp(settings.value(keyOf("preset"), 0).toInt(), 0, int(presetCards_.size()) - 1))->setChecked(true);
    layouts_->button(std::clamp(settings.value(keyOf("layout"), 0).toInt(), 0, 3))->setChecked(true);
    fillFormats();
    format_->setCurrentIndex(std::max(0, format_->findData(settings.value(keyOf("format")))));
    takePreset();
    fps_->setCurrentIndex(std::clamp(settings.value(keyOf("fps"), fps_->currentIndex()).toInt(), 0, int(std::size(kRates)) - 1));
    targets_->setCurrentIndex(std::clamp(settings.value(keyOf("targets"), targets_->currentIndex()).toInt(), 0, int(std::size(kTargets)) - 1));
    split_->setChecked(settings.value(keyOf("split"), split_->isChecked()).toBool());
    quantise_->setChecked(settings.value(keyOf("quantise"), quantise_->isChecked()).toBool());
    normals_->setChecked(settings.value(keyOf("normals"), normals_->isChecked()).toBool());
    const auto& project = document.session().path();
    const QString name = project.empty() ? tr("character") : QString::fromStdString(project.stem().string());
    const QString last = settings.value(keyOf("folder")).toString();
    path_->setText(QDir(QFileInfo(last).isDir() ? last : folder).filePath(name + u'.' + suffix()));
    fillTakes();
    takeLayout();
    describe();

    connect(presets_, &QButtonGroup::idClicked, this, &ExportDialog::takePreset);
    connect(layouts_, &QButtonGroup::idToggled, this, &ExportDialog::takeLayout);
    connect(format_, &QComboBox::currentIndexChanged, this, [this] {
        suitFormat();
        takeLayout();
    });
    connect(path_, &QLineEdit::textChanged, this, &ExportDialog::checkPath);
    connect(&document_, &StudioDocument::structureChanged, this, &ExportDialog::fillTakes);
    connect(&document_, &StudioDocument::structureChanged, this, &ExportDialog::checkPath);
    connect(job_, &BackgroundJob::progressed, this, &ExportDialog::showProgress);
    connect(job_, &BackgroundJob::finished, this, [this](bool completed) {
        showProgress();
        if (completed) return showAnswer();
        written_.clear();
        clearReport();
        reportTitle_->setText(tr("Cancelled: nothing was written."));
    });
    showProgress();
    write_->setFocus();
}

// ---- choices -------------------------------------------------------------------------------------------------------------

void ExportDialog::fillTakes() {
    const QString chosen = take_->currentData().toString();
    take_->clear();
    const auto& takes = document_.document().takes;
    const auto add = [this](const QString& text, const Json& keys) { take_->addItem(text, QString::fromStdString(keys.dump())); };
    if (takes.empty()) {
        add(tr("The pose as it is: there are no takes"), Json::object());
    } else {
        add(tr("All takes (%1)").arg(takes.size()), Json::object());
        add(tr("All takes (%1) and the pose as it is").arg(takes.size()), {{"pose", true}});
        for (const auto& [id, take] : takes) add(QStringLiteral("%1 · %2").arg(QString::fromStdString(take->name), durationText(take->duration())), {{"take", take->name}});
        add(tr("The pose as it is"), {{"take", Json::array()}, {"pose", true}});
    }
    take_->setEnabled(!takes.empty());
    take_->setCurrentIndex(std::max(0, take_->findData(chosen)));
}

void ExportDialog::takePreset() {
    const ExportOptions& options = exportPresets()[std::size_t(presets_->checkedId())].options;
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
    const bool cache = layoutName() == "cache";
    if (format_->count() > 0 && (format_->findData(QStringLiteral("pc2")) >= 0) == cache) return;
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
    }
    suitFormat();
}

void ExportDialog::suitFormat() {
    if (splitByItself()) split_->setChecked(true);
    // These hold whole frames of one rate; what was recorded comes at any time.
    if ((suffix() == u"fbx" || suffix() == u"pc2") && fps_->currentIndex() == 0) fps_->setCurrentIndex(kFastestRate);
}

QString ExportDialog::suffix() const { return format_->currentData().toString(); }

/// What the weights are where the command is not told: FBX is made by Blender, which clamps them.
bool ExportDialog::splitByItself() const { return exportPresets()[std::size_t(presets_->checkedId())].options.split || suffix() == u"fbx"; }

std::string ExportDialog::layoutName() const { return kLayouts[layouts_->checkedId()]; }

void ExportDialog::takeLayout() {
    if (layouts_->checkedId() < 0) return;
    fillFormats();
    const bool cache = layoutName() == "cache", morphs = layoutName() == "baked" || layoutName() == "rigged";
    targets_->setEnabled(morphs);
    split_->setEnabled(morphs);
    normals_->setEnabled(morphs);
    quantise_->setEnabled(!cache);
    const QFileInfo info(path_->text());
    if (!info.fileName().isEmpty() && info.suffix() != suffix()) setPath(info.dir().filePath(info.completeBaseName() + u'.' + suffix()));
    checkPath();
}

void ExportDialog::setPath(const QString& path) { path_->setText(path); }

void ExportDialog::checkPath() {
    const QFileInfo info(path_->text());
    const bool names = !info.fileName().isEmpty() && !info.isDir();
    replaces_->setText(job_->running() || !names || !info.exists() || path_->text() == written_ ? QString() : tr("Replaces the file that is there."));
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
    const ExportPreset& preset = exportPresets()[std::size_t(presets_->checkedId())];
    Json command = {{"do", "export"}, {"path", path_->text().toStdString()}, {"layout", layoutName()}, {"preset", preset.name}};
    command.update(Json::parse(take_->currentData().toString().toStdString()));
    if (const double fps = kRates[fps_->currentIndex()]; fps != preset.options.fps) command["fps"] = fps;
    if (const int targets = kTargets[targets_->currentIndex()]; targets != preset.options.targets) command["targets"] = targets ? Json(targets) : Json("all");
    if (split_->isChecked() != splitByItself()) command["split"] = split_->isChecked();
    if (quantise_->isChecked() != preset.options.quantised) command["quantise"] = quantise_->isChecked();
    if (normals_->isChecked() != preset.options.normals) command["normals"] = normals_->isChecked();
    return command;
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
    settings.setValue(keyOf("normals"), normals_->isChecked());
    settings.setValue(keyOf("folder"), QFileInfo(path_->text()).absolutePath());
}

// ---- writing -------------------------------------------------------------------------------------------------------------

void ExportDialog::write() {
    if (job_->running()) return;
    clearReport();
    const Json asked = command();
    auto plan = planExport(document_.session(), asked);
    if (!plan) {
        reportTitle_->setText(tr("It could not be exported."));
        say(QStringLiteral("error"), int(Role::Error), errorText(plan.error()));
        return;
    }
    remember();
    written_ = path_->text();
    reportTitle_->setText(tr("Writing %1").arg(QFileInfo(written_).fileName()));
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

void ExportDialog::clearReport() {
    while (QLayoutItem* item = report_->takeAt(0)) {
        if (QLayout* line = item->layout())
            while (QLayoutItem* part = line->takeAt(0)) {
                delete part->widget();
                delete part;
            }
        delete item;
    }
    show_->hide();
}

void ExportDialog::say(const QString& icon, int role, const QString& text) {
    auto* line = new QHBoxLayout;
    line->setSpacing(px(8));
    auto* sign = new QLabel(this);
    sign->setPixmap(themedIcon(icon, Role(role)).pixmap(QSize(px(16), px(16)), devicePixelRatioF()));
    auto* words = new QLabel(text, this);
    words->setWordWrap(true);
    words->setTextInteractionFlags(Qt::TextSelectableByMouse);
    line->addWidget(sign, 0, Qt::AlignTop);
    line->addWidget(words, 1);
    report_->addLayout(line);
}

/// Before anything is written: what will be told.
void ExportDialog::describe() {
    clearReport();
    reportTitle_->setText(tr("Nothing written yet"));
    QStringList effects;
    for (std::size_t k = 0; k < kEffects; ++k)
        if (document_.document().effects.has(EffectKind(k))) effects << effectTitle(EffectKind(k));
    if (!effects.isEmpty()) say(QStringLiteral("spring"), int(Role::Muted), tr("Effects of this character: %1. What becomes of each is told here.").arg(effects.join(tr(", "))));
    say(QStringLiteral("check"), int(Role::Muted), tr("What was written is read back and compared with the character."));
}

void ExportDialog::showAnswer() {
    clearReport();
    const auto& outcome = job_->answer();
    if (!*outcome) {
        reportTitle_->setText(tr("It could not be exported."));
        say(QStringLiteral("error"), int(Role::Error), errorText(outcome->error()));
        written_.clear();
        return;
    }
    const Json& answer = **outcome;
    const QLocale locale;
    const auto number = [&](const char* key) { return locale.toString(answer.at(key).get<qlonglong>()); };
    written_ = QString::fromStdString(answer.at("path").get<std::string>());
    const int files = answer.at("files").get<int>();
    reportTitle_->setText(files == 1 ? tr("Wrote %1, %2").arg(QFileInfo(written_).fileName(), bytesText(answer.at("bytes").get<double>()))
                                     : tr("Wrote %n file(s) from %1 on, %2", nullptr, files).arg(QFileInfo(written_).fileName(), bytesText(answer.at("bytes").get<double>())));
    const double off = answer.at("check").at("max_percent").get<double>() / 100.0;
    const QString compared = tr("Read back and compared: largest deviation %1 of the diagonal").arg(shareText(off));
    off <= kSame ? say(QStringLiteral("check"), int(Role::Good), compared) : say(QStringLiteral("info"), int(Role::Info), compared);
    for (const Json& told : answer.at("effects")) {
        const auto effect = effectNamed(told.at("effect").get<std::string>());
        const QString title = effect ? effectTitle(*effect) : QString::fromStdString(told.at("effect").get<std::string>());
        const std::string result = told.at("result").get<std::string>();
        if (result == "exact") say(QStringLiteral("check"), int(Role::Good), tr("%1: exact").arg(title));
        else if (result == "fitted") say(QStringLiteral("info"), int(Role::Info), tr("%1: fitted, off by %2 at most").arg(title, shareText(told.at("error").at("max_percent").get<double>() / 100.0)));
        else say(QStringLiteral("warning"), int(Role::Warning), tr("%1: left out").arg(title));
    }
    if (answer.contains("skin")) say(QStringLiteral("info"), int(Role::Info), tr("The skin is fitted: off by %1 at most").arg(shareText(answer.at("skin").at("max_percent").get<double>() / 100.0)));
    if (answer.contains("quantised"))
        say(QStringLiteral("info"), int(Role::Info), tr("16 bits: off by %1 at most").arg(shareText(answer.at("quantised").at("max_percent").get<double>() / 100.0)));
    if (answer.contains("dropped_targets"))
        say(QStringLiteral("info"), int(Role::Info), tr("Targets left out: off by %1 at most").arg(shareText(answer.at("dropped_targets").at("max_percent").get<double>() / 100.0)));
    for (const Json& warning : answer.at("warnings")) say(QStringLiteral("warning"), int(Role::Warning), warningText(warning));
    QStringList facts{tr("%1 vertices").arg(number("vertices"))};
    if (answer.at("targets").get<int>() > 0) facts << tr("%1 targets").arg(number("targets"));
    facts << tr("%1 keys").arg(number("keys"));
    say(QStringLiteral("info"), int(Role::Muted), facts.join(QStringLiteral(" · ")));
    show_->show();
    checkPath();
}

}  // namespace imomushi
