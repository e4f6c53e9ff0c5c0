// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/import_dialog.h"

#include <QButtonGroup>
#include <QCheckBox>
#include <QComboBox>
#include <QDialogButtonBox>
#include <QFileInfo>
#include <QLabel>
#include <QListWidget>
#include <QLocale>
#include <QProgressBar>
#include <QPushButton>
#include <QSettings>
#include <QSignalBlocker>
#include <QStyle>
#include <QVBoxLayout>
#include <algorithm>

#include "core/document/character_repair.h"
#include "core/mesh/flat_region.h"
#include "ui/dialogs/bones_dialog.h"
#include "ui/dialogs/links_dialog.h"
#include "ui/dialogs/mesh_preview.h"
#include "ui/jobs/character_job.h"
#include "ui/jobs/import_job.h"
#include "ui/models/body_texts.h"
#include "ui/models/commands.h"
#include "ui/models/texts.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/choice_card.h"
#include "ui/widgets/dialog_form.h"
#include "ui/widgets/layouts.h"
#include "ui/widgets/scrolled.h"

namespace imomushi {
namespace {
constexpr const char* kUnits[] = {"", "mm", "cm", "m"};
constexpr const char* kAxes[] = {"", "y", "z"};
constexpr BodyKind kBodies[] = {BodyKind::Auto, BodyKind::Exact, BodyKind::Mended, BodyKind::Wrapped, BodyKind::Wrapped};
constexpr int kUnmended = 4;  // of these
constexpr const char* kSoft = "import/soft-at-first";
constexpr const char* kSizes = "import/sizes";  // answers to questions about sizes: by file the unit, empty where the size was meant
constexpr int kMostSizes = 200;                 // that are remembered
constexpr double kDetails[] = {0.0, 1.0 / 30.0, 1.0 / 60.0, 1.0 / 120.0, 1.0 / 250.0};  // of the diagonal, 0: chosen from the mesh

QString keyOfFile(const QString& path) { return QFileInfo(path).absoluteFilePath(); }

void rememberSize(const QString& path, const QString& unit) {
    QSettings settings;
    QVariantMap sizes = settings.value(kSizes).toMap();
    if (sizes.size() >= kMostSizes) sizes.clear();
    sizes.insert(keyOfFile(path), unit);
    settings.setValue(kSizes, sizes);
}

/// The file is one element as it is, and nothing is to be said about it: a hole that was capped is somebody's mouth or sleeve.
bool isOneElement(const ImportResult& r) {
    if (r.bodies.size() != 1 || !r.bodies[0].closed || r.bodies[0].components != 1) return false;
    const auto calm = [](const MeshIssue& issue) { return issue.code != "open" && (issue.fixed || issue.severity == Severity::Info); };
    return std::all_of(r.bodies[0].issues.begin(), r.bodies[0].issues.end(), calm) && std::all_of(r.issues.begin(), r.issues.end(), calm);
}
}  // namespace

QStringList meshSuffixes() {
    return {QStringLiteral("obj"), QStringLiteral("ply"), QStringLiteral("stl"), QStringLiteral("glb"), QStringLiteral("gltf"), QStringLiteral("vrm"), QStringLiteral("fbx"), QStringLiteral("dae")};
}

ImportDialog::ImportDialog(const QString& path, QWidget* parent) : QDialog(parent), path_(path) {
    setWindowTitle(tr("Import %1").arg(QFileInfo(path).fileName()));
    setObjectName(QStringLiteral("importDialog"));
    job_ = new ImportJob(this);
    character_ = new CharacterJob(this);
    wholeCard_ = named(new ChoiceCard(tr("Whole character"), tr("Any mesh. It keeps its look; a body moves it."), this), "wholeCharacter");
    elementsCard_ = named(new ChoiceCard(tr("Elements"), tr("Closed surfaces. Each one becomes a soft element."), this), "elements");
    auto* kinds = new QButtonGroup(this);
    for (ChoiceCard* card : {wholeCard_, elementsCard_}) {
        card->setCheckable(true);
        kinds->addButton(card);
    }
    elementsCard_->setChecked(true);
    preview_ = new MeshPreview(this);
    unit_ = new QComboBox(this);
    unit_->addItems({tr("As in the file"), tr("Millimetres"), tr("Centimetres"), tr("Metres")});
    up_ = new QComboBox(this);
    up_->addItems({tr("As in the file"), tr("Y is up"), tr("Z is up")});
    split_ = new QCheckBox(tr("One element per separate part"), this);
    soft_ = named(new QCheckBox(tr("Make it soft: cuts and bones as its shape suggests"), this), "makeSoft");
    soft_->setToolTip(tr("Follows the skeleton of the file, if it has one, else the shape. You can change everything afterwards, or undo it in one step."));
    bodyLabel_ = new QLabel(tr("Body"), this);
    body_ = named(new QComboBox(this), "body");
    body_->addItems({tr("Automatic"), tr("Exact: the mesh itself"), tr("Mended: holes closed, parts united"), tr("Wrapped: a new surface around it"), tr("Unmended: repair it issue by issue")});
    body_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);  // long names are cut, not the picture
    body_->setMinimumContentsLength(12);
    body_->setAccessibleName(bodyLabel_->text());
    detailLabel_ = new QLabel(tr("Detail of a wrap"), this);
    detail_ = named(new QComboBox(this), "detail");
    detail_->addItems({tr("Automatic"), tr("Coarse"), tr("Medium"), tr("Fine"), tr("Very fine")});
    detail_->setAccessibleName(detailLabel_->text());
    detail_->setToolTip(tr("Closes gaps narrower than twice this share of the diagonal: 1/30, 1/60, 1/120, 1/250."));
    bonesLabel_ = new QLabel(tr("Skeleton"), this);
    bones_ = named(new QPushButton(this), "chooseBones");
    bones_->setAutoDefault(false);
    bones_->setAccessibleName(tr("Bones of the skeleton that stay"));
    linksLabel_ = new QLabel(tr("Flesh"), this);
    links_ = named(new QPushButton(this), "chooseLinks");
    links_->setAutoDefault(false);
    links_->setAccessibleName(tr("Links of flesh between parts that do not touch"));
    sizeQuestion_ = named(new QFrame(this), "card");
    sizeText_ = new QLabel(sizeQuestion_);
    sizeText_->setWordWrap(true);
    takeUnit_ = named(new QPushButton(sizeQuestion_), "takeUnit");
    keepSize_ = named(new QPushButton(tr("Keep this size"), sizeQuestion_), "keepSize");
    auto* sizeButtons = fill(new QHBoxLayout, Spacing{px(8)}, takeUnit_, keepSize_, Stretch{});
    fill(new QVBoxLayout(sizeQuestion_), QMargins(px(12), px(10), px(12), px(12)), Spacing{px(8)}, sizeText_, sizeButtons);
    sizeQuestion_->hide();
    connect(takeUnit_, &QPushButton::clicked, this, [this] { answerSize(true); });
    connect(keepSize_, &QPushButton::clicked, this, [this] { answerSize(false); });
    connect(bones_, &QPushButton::clicked, this, &ImportDialog::chooseBones);
    connect(links_, &QPushButton::clicked, this, &ImportDialog::chooseLinks);
    facts_ = new QLabel(this);
    facts_->setTextFormat(Qt::PlainText);
    verdict_ = new QLabel(this);
    verdict_->setWordWrap(true);
    issues_ = new QListWidget(this);
    issues_->setWordWrap(true);
    issues_->setSelectionMode(QAbstractItemView::NoSelection);
    issues_->setFocusPolicy(Qt::NoFocus);
    issues_->setStyleSheet(QStringLiteral("background: transparent;"));
    issues_->setIconSize(QSize(px(16), px(16)));
    progress_ = new QProgressBar(this);
    progress_->setRange(0, 1000);
    progress_->setTextVisible(false);
    stage_ = styled(new QLabel(this), "muted");

    const QSettings settings;
    const QString group = QStringLiteral("import/%1/").arg(QFileInfo(path).suffix().toLower());
    unit_->setCurrentIndex(std::clamp(settings.value(group + QStringLiteral("unit"), 0).toInt(), 0, 3));
    up_->setCurrentIndex(std::clamp(settings.value(group + QStringLiteral("up"), 0).toInt(), 0, 2));
    split_->setChecked(settings.value(group + QStringLiteral("split"), false).toBool());
    wantsSoft_ = settings.value(kSoft, true).toBool();
    soft_->setChecked(wantsSoft_);
    const QString unitOfAnswer = settings.value(kSizes).toMap().value(keyOfFile(path)).toString();
    for (int i = 1; i < int(std::size(kUnits)); ++i)
        if (unit_->currentIndex() == 0 && unitOfAnswer == QLatin1String(kUnits[i])) {
            unit_->setCurrentIndex(i);
            unitOfAnswer_ = true;
        }

    auto* form = new DialogForm;
    form->add(tr("Unit"), unit_);
    form->add(tr("Up axis"), up_);
    form->add(split_);
    form->add(soft_);
    for (auto [label, field] : {std::pair<QLabel*, QWidget*>{bodyLabel_, body_}, {detailLabel_, detail_}, {bonesLabel_, bones_}, {linksLabel_, links_}}) {
        label->setProperty("role", "muted");
        label->setBuddy(field);
        form->addRow(label, field);
    }

    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Cancel, this);
    import_ = buttons->addButton(tr("Import"), QDialogButtonBox::AcceptRole);
    import_->setObjectName(QStringLiteral("importButton"));
    import_->setDefault(true);
    import_->setEnabled(false);
    connect(buttons, &QDialogButtonBox::accepted, this, [this, group] {
        QSettings keep;
        if (!unitOfAnswer_) keep.setValue(group + QStringLiteral("unit"), unit_->currentIndex());
        if (!sizeQuestion_->isHidden()) rememberSize(path_, {});  // who imports it as it is has answered
        keep.setValue(group + QStringLiteral("up"), up_->currentIndex());
        keep.setValue(group + QStringLiteral("split"), split_->isChecked());
        accept();
    });
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);

    auto* title = styled(new QLabel(QFileInfo(path).fileName(), this), "title");
    title->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
    auto* cards = fill(new QHBoxLayout, Spacing{px(8)}, Share{wholeCard_, 1}, Share{elementsCard_, 1});
    auto* rule = named(new QFrame(this), "rule");
    auto* choices = new QWidget;
    fill(new QVBoxLayout(choices), QMargins(0, 0, 0, 0), Spacing{px(12)}, title, cards, form, rule, verdict_, sizeQuestion_, facts_, Share{issues_, 1});
    auto* columns = fill(new QHBoxLayout, Spacing{px(20)}, Share{preview_, 4}, Share<QWidget>{new ScrolledRows(choices, this), 3});
    progress_->setFixedWidth(px(160));
    auto* foot = fill(new QHBoxLayout, Spacing{px(12)}, progress_, Share{stage_, 1}, buttons);
    fill(new QVBoxLayout(this), QMargins(px(20), px(20), px(20), px(16)), Spacing{px(16)}, Share{columns, 1}, foot);
    resize(withinScreen(*this, {px(960), px(660)}));

    connect(unit_, &QComboBox::activated, this, [this] { unitOfAnswer_ = false; });
    for (QComboBox* box : {unit_, up_}) connect(box, &QComboBox::activated, this, [this] { askedLinks_.reset(); });
    for (QComboBox* box : {unit_, up_, body_, detail_}) connect(box, &QComboBox::activated, this, &ImportDialog::read);
    connect(split_, &QCheckBox::toggled, this, &ImportDialog::read);
    connect(soft_, &QCheckBox::toggled, this, [this](bool on) {
        wantsSoft_ = on;
        if (whole()) return read();
        // Elements have neither cuts nor bones at first: what is to have them is a whole character.
        chosenByHand_ = true;
        choose(true);
    });
    connect(kinds, &QButtonGroup::idClicked, this, [this] {
        chosenByHand_ = true;
        choose(wholeCard_->isChecked());
    });
    for (BackgroundJob* job : {static_cast<BackgroundJob*>(job_), static_cast<BackgroundJob*>(character_)}) {
        connect(job, &BackgroundJob::progressed, this, [this, job] {
            progress_->setValue(int(1000.0 * job->fraction()));
            stage_->setText(job->stage().isEmpty() ? tr("Reading") : job->stage());
        });
        connect(job, &BackgroundJob::finished, this, [this](bool completed) {
            if (completed) showResult();
        });
    }
    choose(false);
}

void ImportDialog::leadToSoft(bool rigged) {
    wantsSkeleton_ = rigged;
    chosenByHand_ = true;
    wantsSoft_ = true;
    choose(true);
}

void ImportDialog::replaces(const std::string& name, bool whole) {
    replaced_ = name;
    setWindowTitle(tr("Replace the mesh of %1").arg(QString::fromStdString(name)));
    import_->setText(tr("Replace"));
    for (ChoiceCard* card : {wholeCard_, elementsCard_}) card->setVisible(false);
    body_->removeItem(kUnmended);
    split_->setChecked(false);
    chosenByHand_ = true;
    choose(whole);
    split_->setVisible(false);
    for (QWidget* field : std::initializer_list<QWidget*>{detailLabel_, detail_}) field->setVisible(false);
}

bool ImportDialog::whole() const { return wholeCard_->isChecked(); }

ImportRequest ImportDialog::chosen() const {
    ImportRequest request;
    request.path = path_.toStdString();
    request.unit = Unit(unit_->currentIndex());
    request.up = UpAxis(up_->currentIndex());
    request.split = split_->isChecked();
    request.bonesSuffice = noMesh_;
    return request;
}

bool ImportDialog::soft() const {
    const auto made = preparedCharacter();
    return made && made->proposal && *made->proposal;
}

bool ImportDialog::unmended() const { return body_->currentIndex() == kUnmended; }

BodySetting ImportDialog::body() const {
    const double detail = kDetails[std::size_t(detail_->currentIndex())];
    const BodyKind how = kBodies[std::size_t(body_->currentIndex())];
    const bool mends = how == BodyKind::Auto || how == BodyKind::Mended;  // others have no links
    return {how, unmended() && detail == 0.0 ? kPassingDetail : detail, mends ? askedLinks_ : std::nullopt};
}

void ImportDialog::choose(bool whole) {
    (whole ? wholeCard_ : elementsCard_)->setChecked(true);
    split_->setVisible(!whole);
    for (QWidget* field : std::initializer_list<QWidget*>{bodyLabel_, body_, detailLabel_, detail_}) field->setVisible(whole);
    soft_->setVisible(replaced_.empty());
    {
        const QSignalBlocker quiet(soft_);  // this reads below
        soft_->setChecked(whole && wantsSoft_);
    }
    for (QWidget* field : std::initializer_list<QWidget*>{bonesLabel_, bones_, linksLabel_, links_}) field->hide();
    read();
}

void ImportDialog::read() {
    import_->setEnabled(false);
    const bool wraps = kBodies[std::size_t(body_->currentIndex())] == BodyKind::Auto || kBodies[std::size_t(body_->currentIndex())] == BodyKind::Wrapped;
    soft_->setEnabled(!unmended());
    detailLabel_->setEnabled(wraps);
    detail_->setEnabled(wraps);
    for (QWidget* field : std::initializer_list<QWidget*>{sizeQuestion_, bonesLabel_, bones_, linksLabel_, links_}) field->hide();
    progress_->setValue(0);
    progress_->setVisible(true);
    stage_->setVisible(true);
    stage_->setText(tr("Reading"));
    job_->cancel();
    character_->cancel();
    if (whole()) {
        say(tr("The body is being made…"), "muted");
        facts_->clear();
        issues_->clear();
        character_->start(chosen(), body(), soft_->isChecked() && !unmended() && replaced_.empty() ? std::optional(asked_) : std::nullopt);
    } else {
        job_->start(chosen());
    }
}

void ImportDialog::say(const QString& text, const char* role) {
    verdict_->setText(text);
    verdict_->setProperty("role", role);
    verdict_->style()->unpolish(verdict_);
    verdict_->style()->polish(verdict_);
}

void ImportDialog::addIssue(const MeshIssue& issue) {
    const bool calm = issue.fixed || issue.severity == Severity::Info;
    const QString icon = issue.fixed ? QStringLiteral("check") : calm ? QStringLiteral("info") : issue.severity == Severity::Error ? QStringLiteral("error") : QStringLiteral("warning");
    const auto role = issue.fixed ? Appearance::Role::Good : calm ? Appearance::Role::Info : issue.severity == Severity::Error ? Appearance::Role::Error : Appearance::Role::Warning;
    issues_->addItem(new QListWidgetItem(themedIcon(icon, role), issueText(issue)));
}

void ImportDialog::showResult() {
    clips_ = false;
    const auto hasNoMesh = [](const auto& outcome) { return !outcome && outcome.error().code == "empty-mesh"; };
    if (!clipsFor_.empty() && !noMesh_ && (whole() ? hasNoMesh(*character_->result()->file) : hasNoMesh(*job_->result()))) {
        noMesh_ = true;  // once more, for its bones
        return choose(true);
    }
    if (!whole()) {
        // What is not one clean closed surface is a whole character, and so is what looks like a creature, unless somebody said otherwise.
        const auto outcome = job_->result();
        if (!chosenByHand_ && *outcome && (!isOneElement(**outcome) || (wantsSoft_ && !hasFlatRegion((**outcome).bodies[0].mesh.body)))) return choose(true);
    }
    progress_->setVisible(false);
    stage_->setVisible(false);
    issues_->clear();
    facts_->clear();
    whole() ? showCharacter() : showElements();
    if (replaced_.empty() && !clips_) import_->setText(soft() ? tr("Import and make soft") : tr("Import"));
    if (import_->isEnabled()) (sizeQuestion_->isHidden() ? import_ : takeUnit_)->setFocus();
}

void ImportDialog::showElements() {
    const auto outcome = job_->result();
    preview_->show(*outcome);
    if (!*outcome) {
        say(errorText(outcome->error()), "error");
        return;
    }
    const ImportResult& r = **outcome;
    qlonglong vertices = 0, triangles = 0;
    int usable = 0, parts = 0;
    Vec3 low = Vec3::Constant(1e300), high = -low;
    for (const ImportedBody& body : r.bodies) {
        vertices += body.mesh.body.vertices.rows();
        triangles += body.mesh.body.triangles.rows();
        usable += body.closed ? 1 : 0;
        parts += body.components;
        if (body.mesh.body.vertices.rows() == 0) continue;
        low = low.cwiseMin(body.mesh.body.vertices.colwise().minCoeff().transpose());
        high = high.cwiseMax(body.mesh.body.vertices.colwise().maxCoeff().transpose());
    }
    const int bodies = int(r.bodies.size());
    if (usable == 0) {
        say(tr("This mesh cannot be used as an element: it is not a closed surface. Import it as a whole character."), "error");
    } else if (usable < bodies) {
        say(tr("%1 of %2 bodies can be used; the others are left out.").arg(usable).arg(bodies), "warning");
    } else {
        say(!replaced_.empty() ? tr("Ready to replace the mesh.") : usable == 1 ? tr("Ready to import.") : tr("Ready to import as %n element(s).", nullptr, usable), "good");
    }
    if (bodies > 0) {
        const Vec3 size = high - low;
        const QLocale locale;
        QStringList lines;
        lines << tr("Size  %1 × %2 × %3").arg(lengthText(size.x()), lengthText(size.y()), lengthText(size.z()));
        lines << tr("%1 vertices, %2 triangles").arg(locale.toString(vertices), locale.toString(triangles));
        if (parts > 1) lines << tr("%n separate part(s)", nullptr, parts);
        facts_->setText(lines.join(u'\n'));
    }
    for (const MeshIssue& issue : r.issues) addIssue(issue);
    for (const ImportedBody& body : r.bodies)
        for (const MeshIssue& issue : body.issues) addIssue(issue);
    import_->setEnabled(usable > 0);
}

void ImportDialog::showCharacter() {
    const PreparedCharacter& made = *character_->result();
    if (!*made.file) {
        preview_->show(Result<ImportResult>(tl::unexpected(made.file->error())));
        return say(errorText(made.file->error()), "error");
    }
    const CharacterFile& file = **made.file;
    if (file.renderModel.mesh.body.triangles.rows() == 0) {
        preview_->show(Result<ImportResult>(tl::unexpected(made.body->error())));
        return showClips(file);
    }
    const Body* body = *made.body ? &**made.body : nullptr;
    const Proposal* proposal = made.proposal && *made.proposal ? &**made.proposal : nullptr;
    preview_->show(file, body, proposal);
    const auto flawed = [](const Body& of) { return std::any_of(of.report.issues.begin(), of.report.issues.end(), [](const MeshIssue& issue) { return issue.severity != Severity::Info; }); };
    if (body)
        say((replaced_.empty() ? tr("Ready to import. The body is %1.") : tr("Ready to replace the mesh. The body is %1.")).arg(bodyKindText(body->report.how)), flawed(*body) ? "warning" : "good");
    else
        say(errorText(made.body->error()), "error");
    const QLocale locale;
    const TriangleMesh& mesh = file.renderModel.mesh.body;
    Vec3 low = Vec3::Constant(1e300), high = -low;
    for (Eigen::Index i = 0; i < mesh.triangles.size(); ++i) {
        const Vec3 p = mesh.vertices.row(mesh.triangles.data()[i]);
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const Vec3 size = high - low;
    QStringList lines;
    lines << tr("Size  %1 × %2 × %3").arg(lengthText(size.x()), lengthText(size.y()), lengthText(size.z()));
    lines << tr("%1 vertices, %2 triangles").arg(locale.toString(qlonglong(mesh.vertices.rows())), locale.toString(qlonglong(mesh.triangles.rows())));
    if (file.renderModel.parts.size() > 1) lines << tr("%n separate part(s)", nullptr, int(file.renderModel.parts.size()));
    if (body) lines << bodyLines(*body);
    if (body && replaced_.empty() && (this->body().links || !body->report.links.empty())) {
        links_->setText(tr("%n link(s) – change…", nullptr, int(body->report.links.size())));
        for (QWidget* field : std::initializer_list<QWidget*>{linksLabel_, links_}) field->show();
    }
    if (proposal) {
        QStringList parts;
        if (const int n = int(proposal->cuts.size()); n > 0) parts << tr("%n cut(s)", nullptr, n);
        if (const int n = int(proposal->bones.size()); n > 0) parts << tr("%n bone(s)", nullptr, n);
        if (const int n = int(proposal->handles.size()); n > 0) parts << tr("%n handle(s)", nullptr, n);
        if (const int n = int(proposal->pins.size()); n > 0) parts << tr("%n pin(s)", nullptr, n);
        if (proposal->from == Proposal::Source::Skeleton && file.rig) {
            const int all = int(file.rig->bones.size()), stay = all - int(proposal->merged.size());
            bones_->setText(tr("%1 of %2 bones stay – choose…").arg(stay).arg(all));
            for (QWidget* field : std::initializer_list<QWidget*>{bonesLabel_, bones_}) field->show();
            if (const int lost = asked_.bones ? int(asked_.bones->size()) - stay : 0; lost > 0) lines << tr("%n chosen bone(s) cannot stay: no cut works there.", nullptr, lost);
        }
        lines << (proposal->from == Proposal::Source::Skeleton ? tr("Proposed from its skeleton: %1") : tr("Proposed from its shape: %1")).arg(parts.join(QStringLiteral(", ")));
    }
    facts_->setText(lines.join(u'\n'));
    if (made.proposal && !proposal) issues_->addItem(new QListWidgetItem(themedIcon(QStringLiteral("warning"), Appearance::Role::Warning), errorText(made.proposal->error())));
    if (wantsSkeleton_ && (!file.rig || file.rig->bones.empty()))
        issues_->addItem(new QListWidgetItem(themedIcon(QStringLiteral("info"), Appearance::Role::Info), tr("The file holds no skeleton: cuts and bones follow the shape.")));
    for (const MeshIssue& issue : file.issues) addIssue(issue);
    if (body && replaced_.empty()) askAboutSize(doubtedSize(mesh.vertices));
    if (body)
        for (const MeshIssue& issue : unmended() ? mendableIssues(file.renderModel) : body->report.issues) addIssue(issue);
    import_->setEnabled(body != nullptr);
}

void ImportDialog::showClips(const CharacterFile& file) {
    for (QWidget* widget : std::initializer_list<QWidget*>{wholeCard_, elementsCard_, soft_, bodyLabel_, body_, detailLabel_, detail_}) widget->hide();
    for (const MeshIssue& issue : file.issues) addIssue(issue);
    if (!file.rig || file.rig->clips.empty()) return say(tr("The file holds bones, but neither a mesh nor clips."), "error");
    say(tr("The file holds no mesh, but %n clip(s) that can move “%1”.", nullptr, int(file.rig->clips.size())).arg(QString::fromStdString(clipsFor_)), "good");
    QStringList lines;
    for (const RigClip& clip : file.rig->clips) lines << QStringLiteral("%1 · %2").arg(QString::fromStdString(clip.name), durationText(clip.seconds));
    constexpr qsizetype kShown = 8;
    if (const qsizetype more = lines.size() - kShown; more > 0) lines = lines.mid(0, kShown) << tr("%n more", nullptr, int(more));
    facts_->setText(lines.join(u'\n'));
    clips_ = true;
    import_->setText(tr("Import clips"));
    import_->setEnabled(true);
}

void ImportDialog::askAboutSize(const std::optional<SizeDoubt>& doubt) {
    doubt_ = doubt;
    if (!doubt || doubt->unit.empty() || unit_->currentIndex() != 0 || QSettings().value(kSizes).toMap().contains(keyOfFile(path_))) return;
    const bool centimetres = doubt->unit == "cm";
    sizeText_->setText((centimetres ? tr("It is %1 large. Is that the right unit? In centimetres it is %2.") : tr("It is %1 large. Is that the right unit? In millimetres it is %2."))
                           .arg(lengthText(doubt->size), lengthText(doubt->meant)));
    takeUnit_->setText(centimetres ? tr("Use centimetres") : tr("Use millimetres"));
    sizeQuestion_->show();
}

void ImportDialog::answerSize(bool takeUnit) {
    rememberSize(path_, takeUnit ? QString::fromStdString(doubt_->unit) : QString());
    sizeQuestion_->hide();
    if (!takeUnit) return import_->setFocus();
    askedLinks_.reset();
    unit_->setCurrentIndex(doubt_->unit == "cm" ? int(Unit::Centimetre) : int(Unit::Millimetre));
    unitOfAnswer_ = true;
    read();
}

void ImportDialog::chooseBones() {
    const PreparedCharacter& made = *character_->result();
    BonesDialog dialog(*(*made.file)->rig, **made.proposal, this);
    if (dialog.exec() != QDialog::Accepted) return;
    asked_.bones = dialog.chosen();
    asked_.from = asked_.bones ? ProposalRequest::From::Skeleton : ProposalRequest::From::Auto;
    read();
}

void ImportDialog::chooseLinks() {
    const PreparedCharacter& made = *character_->result();
    LinksDialog dialog(**made.file, **made.body, askedLinks_, this);
    if (dialog.exec() != QDialog::Accepted) return;
    askedLinks_ = dialog.chosen();
    read();
}

Json ImportDialog::command() const {
    commands::Import import;
    import.links = body().links;
    import.path = path_.toStdString();
    if (unit_->currentIndex() > 0) import.unit = kUnits[unit_->currentIndex()];
    if (up_->currentIndex() > 0) import.up = kAxes[up_->currentIndex()];
    if (clips_) return commands::importClips(clipsFor_, import);
    if (!replaced_.empty()) return commands::replaceMesh(replaced_, whole(), import, body().how == BodyKind::Auto ? std::string() : std::string(nameOf(body().how)));
    if (whole()) {
        const BodyKind how = body().how;
        const double detail = kDetails[std::size_t(detail_->currentIndex())];
        if (soft()) return commands::makeSoft(import, how == BodyKind::Auto ? std::string() : std::string(nameOf(how)), detail > 0.0 ? std::optional(detail) : std::nullopt, asked_.bones);
        return commands::importCharacter(import, unmended() ? "unmended" : how == BodyKind::Auto ? std::string() : std::string(nameOf(how)), detail > 0.0 ? std::optional(detail) : std::nullopt);
    }
    import.split = split_->isChecked();
    return commands::importElement(import);
}

const ImportRequest& ImportDialog::request() const { return job_->request(); }

std::shared_ptr<const PreparedCharacter> ImportDialog::preparedCharacter() const { return whole() ? character_->result() : nullptr; }

std::shared_ptr<const Result<ImportResult>> ImportDialog::prepared() const { return job_->result(); }

std::int64_t ImportDialog::vertices() const {
    std::int64_t all = 0;
    if (const auto made = preparedCharacter()) {
        if (made->file && *made->file) all += (*made->file)->renderModel.mesh.body.vertices.rows();
    } else if (const auto read = prepared(); read && *read) {
        for (const ImportedBody& body : (*read)->bodies) all += body.mesh.body.vertices.rows();
    }
    return all;
}

}  // namespace imomushi
