// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/import_dialog.h"

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
#include <QStyle>
#include <QVBoxLayout>
#include <algorithm>

#include "ui/dialogs/mesh_preview.h"
#include "ui/jobs/import_job.h"
#include "ui/models/commands.h"
#include "ui/models/texts.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/dialog_form.h"

namespace imomushi {
namespace {
constexpr const char* kUnits[] = {"", "mm", "cm", "m"};
constexpr const char* kAxes[] = {"", "y", "z"};
}  // namespace

QStringList meshSuffixes() {
    return {QStringLiteral("obj"), QStringLiteral("ply"), QStringLiteral("stl"), QStringLiteral("glb"), QStringLiteral("gltf"), QStringLiteral("fbx"), QStringLiteral("dae")};
}

ImportDialog::ImportDialog(const QString& path, QWidget* parent) : QDialog(parent), path_(path) {
    setWindowTitle(tr("Import %1").arg(QFileInfo(path).fileName()));
    setObjectName(QStringLiteral("importDialog"));
    job_ = new ImportJob(this);
    preview_ = new MeshPreview(this);
    unit_ = new QComboBox(this);
    unit_->addItems({tr("As in the file"), tr("Millimetres"), tr("Centimetres"), tr("Metres")});
    up_ = new QComboBox(this);
    up_->addItems({tr("As in the file"), tr("Y is up"), tr("Z is up")});
    split_ = new QCheckBox(tr("One element per separate part"), this);
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
    stage_ = new QLabel(this);
    stage_->setProperty("role", "muted");

    const QSettings settings;
    const QString group = QStringLiteral("import/%1/").arg(QFileInfo(path).suffix().toLower());
    unit_->setCurrentIndex(std::clamp(settings.value(group + QStringLiteral("unit"), 0).toInt(), 0, 3));
    up_->setCurrentIndex(std::clamp(settings.value(group + QStringLiteral("up"), 0).toInt(), 0, 2));
    split_->setChecked(settings.value(group + QStringLiteral("split"), false).toBool());

    auto* form = new DialogForm;
    form->add(tr("Unit"), unit_);
    form->add(tr("Up axis"), up_);
    form->add(split_);

    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Cancel, this);
    import_ = buttons->addButton(tr("Import"), QDialogButtonBox::AcceptRole);
    import_->setObjectName(QStringLiteral("importButton"));
    import_->setDefault(true);
    import_->setEnabled(false);
    connect(buttons, &QDialogButtonBox::accepted, this, [this, group] {
        QSettings keep;
        keep.setValue(group + QStringLiteral("unit"), unit_->currentIndex());
        keep.setValue(group + QStringLiteral("up"), up_->currentIndex());
        keep.setValue(group + QStringLiteral("split"), split_->isChecked());
        accept();
    });
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);

    auto* right = new QVBoxLayout;
    right->setSpacing(px(12));
    auto* title = new QLabel(QFileInfo(path).fileName(), this);
    title->setProperty("role", "title");
    title->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
    right->addWidget(title);
    right->addLayout(form);
    auto* rule = new QFrame(this);
    rule->setObjectName(QStringLiteral("rule"));
    right->addWidget(rule);
    right->addWidget(verdict_);
    right->addWidget(facts_);
    right->addWidget(issues_, 1);
    auto* columns = new QHBoxLayout;
    columns->setSpacing(px(20));
    columns->addWidget(preview_, 3);
    columns->addLayout(right, 2);
    auto* foot = new QHBoxLayout;
    foot->setSpacing(px(12));
    progress_->setFixedWidth(px(160));
    foot->addWidget(progress_);
    foot->addWidget(stage_, 1);
    foot->addWidget(buttons);
    auto* layout = new QVBoxLayout(this);
    layout->setContentsMargins(px(20), px(20), px(20), px(16));
    layout->setSpacing(px(16));
    layout->addLayout(columns, 1);
    layout->addLayout(foot);
    resize(px(860), px(520));

    connect(unit_, &QComboBox::activated, this, &ImportDialog::read);
    connect(up_, &QComboBox::activated, this, &ImportDialog::read);
    connect(split_, &QCheckBox::toggled, this, &ImportDialog::read);
    connect(job_, &BackgroundJob::progressed, this, [this] {
        progress_->setValue(int(1000.0 * job_->fraction()));
        stage_->setText(progressText());
    });
    connect(job_, &BackgroundJob::finished, this, [this](bool completed) {
        if (completed) showResult();
    });
    read();
}

QString ImportDialog::progressText() const { return job_->stage().isEmpty() ? tr("Reading") : job_->stage(); }

ImportRequest ImportDialog::chosen() const {
    ImportRequest request;
    request.path = path_.toStdString();
    request.unit = Unit(unit_->currentIndex());
    request.up = UpAxis(up_->currentIndex());
    request.split = split_->isChecked();
    return request;
}

void ImportDialog::read() {
    import_->setEnabled(false);
    progress_->setValue(0);
    progress_->setVisible(true);
    stage_->setVisible(true);
    stage_->setText(tr("Reading"));
    job_->start(chosen());
}

void ImportDialog::showResult() {
    progress_->setVisible(false);
    stage_->setVisible(false);
    const auto outcome = job_->result();
    preview_->show(*outcome);
    issues_->clear();
    facts_->clear();
    const auto add = [this](const MeshIssue& issue) {
        const bool calm = issue.fixed || issue.severity == Severity::Info;
        const QString icon = issue.fixed ? QStringLiteral("check") : calm ? QStringLiteral("info") : issue.severity == Severity::Error ? QStringLiteral("error") : QStringLiteral("warning");
        const auto role = issue.fixed ? Appearance::Role::Good : calm ? Appearance::Role::Info : issue.severity == Severity::Error ? Appearance::Role::Error : Appearance::Role::Warning;
        issues_->addItem(new QListWidgetItem(themedIcon(icon, role), issueText(issue.code, issue.count, issue.text)));
    };
    const auto say = [this](const QString& text, const char* role) {
        verdict_->setText(text);
        verdict_->setProperty("role", role);
        verdict_->style()->unpolish(verdict_);
        verdict_->style()->polish(verdict_);
    };
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
        say(tr("This mesh cannot be used as it is: it is not a closed surface."), "error");
    } else if (usable < bodies) {
        say(tr("%1 of %2 bodies can be used; the others are left out.").arg(usable).arg(bodies), "warning");
    } else {
        say(usable == 1 ? tr("Ready to import.") : tr("Ready to import as %n element(s).", nullptr, usable), "good");
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
    for (const MeshIssue& issue : r.issues) add(issue);
    for (const ImportedBody& body : r.bodies)
        for (const MeshIssue& issue : body.issues) add(issue);
    import_->setEnabled(usable > 0);
    if (usable > 0) import_->setFocus();
}

Json ImportDialog::command() const {
    commands::Import import;
    import.path = path_.toStdString();
    if (unit_->currentIndex() > 0) import.unit = kUnits[unit_->currentIndex()];
    if (up_->currentIndex() > 0) import.up = kAxes[up_->currentIndex()];
    import.split = split_->isChecked();
    return commands::importElement(import);
}

const ImportRequest& ImportDialog::request() const { return job_->request(); }

std::shared_ptr<const Result<ImportResult>> ImportDialog::prepared() const { return job_->result(); }

}  // namespace imomushi
