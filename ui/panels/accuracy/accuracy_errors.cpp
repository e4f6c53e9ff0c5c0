// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/accuracy/accuracy_errors.h"

#include <QComboBox>
#include <QEvent>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QSignalBlocker>
#include <algorithm>

#include "core/reports/accuracy_commands.h"
#include "ui/models/texts.h"
#include "ui/panels/accuracy/accuracy_body.h"
#include "ui/panels/accuracy/accuracy_texts.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"

namespace imomushi {
namespace {

constexpr int kFollowMs = 250;         // after the last motion
constexpr int kChangedMs = 400;
constexpr double kFollowSeconds = 2.0;  // poses that take longer wait for the button

/// `errors`: see errorField(). Triangles with a hidden corner are left out.
AccuracyBody::Part partOf(const TriangleMesh& mesh, const Points& shown, const Points& full, const std::vector<float>& errors) {
    AccuracyBody::Part part{shown, full, {}, errors};
    std::vector<Eigen::Index> seen;
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
        bool all = true;
        for (int c = 0; c < 3; ++c) all = all && errors[std::size_t(mesh.triangles(t, c))] >= 0.0f;
        if (all) seen.push_back(t);
    }
    part.triangles.resize(Eigen::Index(seen.size()), 3);
    for (std::size_t k = 0; k < seen.size(); ++k) part.triangles.row(Eigen::Index(k)) = mesh.triangles.row(seen[k]);
    return part;
}

}  // namespace

AccuracyErrors::AccuracyErrors(StudioDocument& document, QWidget* parent)
    : QWidget(parent), document_(document), job_(new PoseErrorJob(this)), cost_(new ReferenceCostJob(this)) {
    auto* line = new QHBoxLayout;
    label_ = new QLabel(this);
    poses_ = named(new QComboBox(this), "accuracyPose");
    measure_ = named(new QPushButton(this), "accuracyPoseMeasure");
    fill(line, label_, poses_, measure_, Stretch{});
    text_ = new QLabel(this);
    text_->setWordWrap(true);
    text_->setProperty("role", "muted");
    body_ = new AccuracyBody(this);
    fill(new QVBoxLayout(this), QMargins(0, px(4), 0, 0), Spacing{px(4)}, line, text_, Share{body_, 1});
    for (auto [timer, ms] : {std::pair{&follow_, kFollowMs}, {&changed_, kChangedMs}}) {
        timer->setSingleShot(true);
        timer->setInterval(ms);
    }
    connect(poses_, &QComboBox::currentIndexChanged, this, &AccuracyErrors::refresh);
    connect(measure_, &QPushButton::clicked, this, [this] {
        if (!job_->running()) return measure();
        job_->cancel();
    });
    connect(job_, &BackgroundJob::progressed, this, [this] {
        if (pose() < 0) refresh();
    });
    connect(job_, &BackgroundJob::finished, this, [this](bool completed) {
        if (completed && moved_) follow_.start();
        refresh();
    });
    connect(cost_, &BackgroundJob::finished, this, &AccuracyErrors::refresh);
    connect(&follow_, &QTimer::timeout, this, [this] {
        if (!isVisible() || pose() >= 0 || job_->running()) return;
        const auto input = poseErrorInput(document_.session());
        if (input && job_->knows(referenceKey(input->reference)) && (!errors() || errors()->seconds <= kFollowSeconds)) measure();
    });
    connect(&changed_, &QTimer::timeout, this, &AccuracyErrors::characterChanged);
    connect(&document, &StudioDocument::poseChanged, this, &AccuracyErrors::moved);
    connect(&document, &StudioDocument::frameStepped, this, &AccuracyErrors::moved);
    connect(&document, &StudioDocument::structureChanged, &changed_, qOverload<>(&QTimer::start));
    connect(&document, &StudioDocument::responsesChanged, &changed_, qOverload<>(&QTimer::start));
    retranslate();
}

void AccuracyErrors::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) retranslate();
}

void AccuracyErrors::showEvent(QShowEvent* event) {
    QWidget::showEvent(event);
    characterChanged();
}

void AccuracyErrors::retranslate() {
    label_->setText(tr("Pose"));
    poses_->setAccessibleName(label_->text());
    body_->setTitles(tr("As it is set now, error in colours"), tr("Full solution"), tr("% of the diagonal"));
    fillPoses();
    refresh();
}

void AccuracyErrors::setStudy(const AccuracyStudy& study, bool outdated) {
    study_ = &study;
    outdated_ = outdated;
    fillPoses();
    refresh();
    if (isVisible() && !errors()) follow_.start();  // the study may have left the full solution
}

void AccuracyErrors::fillPoses() {
    static constexpr const char* known[] = {QT_TR_NOOP("stretch"), QT_TR_NOOP("bend"), QT_TR_NOOP("twist"), QT_TR_NOOP("random 1"), QT_TR_NOOP("random 2"), QT_TR_NOOP("random 3")};
    const QSignalBlocker blocked(poses_);
    const int chosen = std::max(0, poses_->currentIndex());
    poses_->clear();
    poses_->addItem(tr("the pose of now"));
    if (study_ && study_->reference)
        for (const auto& name : study_->poses) {
            const auto found = std::find_if(std::begin(known), std::end(known), [&](const char* k) { return name == k; });
            poses_->addItem(found == std::end(known) ? QString::fromStdString(name) : tr(*found));
        }
    poses_->setCurrentIndex(chosen < poses_->count() ? chosen : 0);
}

int AccuracyErrors::pose() const { return poses_->currentIndex() - 1; }

void AccuracyErrors::measure() {
    auto input = poseErrorInput(document_.session());
    if (!input) {
        text_->setText(errorText(input.error()));
        return;
    }
    moved_ = false;
    solved_ = referenceKey(input->reference);
    input->reference.seconds = limit_;
    job_->start(std::move(*input));
    refresh();
}

// The full solution is that of one body: a changed one gives its memory back.
void AccuracyErrors::characterChanged() {
    if (!isVisible()) return;
    const auto input = studiedCharacter(document_.session());
    const ContentKey key = input ? referenceKey(*input) : ContentKey{};
    if ((job_->running() || errors()) && key != solved_) job_->forget();
    if (input && !job_->running() && !job_->knows(key)) cost_->start(*input);
    moved();
    refresh();
}

void AccuracyErrors::moved() {
    if (!isVisible()) return;
    follow_.start();
    if (moved_ || !errors()) return;
    moved_ = true;
    if (pose() < 0) refresh();
}

void AccuracyErrors::refresh() {
    if (!isVisible()) return;
    measure_->setVisible(pose() < 0);
    measure_->setText(job_->running() ? tr("Stop") : tr("Measure"));
    if (pose() < 0)
        showPoseOfNow();
    else
        showPoseOfStudy(pose());
}

void AccuracyErrors::showPoseOfNow() {
    std::vector<AccuracyBody::Part> parts;
    const Character* live = document_.session().character();
    if (const auto& e = errors(); e && live && live->input().elements.size() == e->field.size()) {
        for (std::size_t i = 0; i < e->field.size(); ++i) {
            const TriangleMesh& mesh = live->input().elements[i].mesh->body;
            if (mesh.vertices.rows() != e->shown[i].rows()) continue;
            parts.push_back(partOf(mesh, e->shown[i], e->reference.positions[0][i], e->field[i]));
        }
    }
    QString text, more;
    if (job_->running()) {
        const double left = job_->secondsLeft();
        text = QStringLiteral("%1 · %2 %").arg(job_->stage()).arg(int(100.0 * job_->fraction()));
        if (left > 0.0) text = tr("%1 · about %2 left").arg(text, durationText(left));
    } else if (const auto& e = errors(); e && !parts.empty()) {
        text = tr("error %1 (largest %2 of the diagonal)").arg(shareText(e->error.relative), diagonalText(e->error.percent));
        text += QStringLiteral(" · ") + tr("full solution itself %1").arg(e->reference.relative < 0.0 ? tr("unknown") : shareText(std::max(e->reference.relative, e->reference.faceRelative)));
        more = tr("The full solution took %1 and keeps %2; this pose took %3.").arg(durationText(e->reference.seconds), bytesText(double(e->bytes)), durationText(e->seconds));
        if (moved_) text += QStringLiteral(" · ") + tr("the character has moved or changed since");
    } else if (job_->error() && job_->error()->code != kCancelled) {
        text = errorText(*job_->error());
    } else if (const auto input = poseErrorInput(document_.session()); !input) {
        text = errorText(input.error());
    } else if (const auto& cost = cost_->cost(); cost && cost->seconds > 0.0) {
        // What was measured is better than what is estimated.
        const bool known = study_ && study_->reference && !outdated_;
        text = tr("The full solution takes about %1 and %2, once, in the background; then every pose takes a moment.")
                   .arg(durationText(known ? study_->reference->seconds : cost->seconds), bytesText(double(cost->bytes)));
    }
    text_->setText(text);
    text_->setToolTip(more);
    measure_->setEnabled(job_->running() || !document_.document().elements.empty());
    body_->setParts(std::move(parts));
}

void AccuracyErrors::showPoseOfStudy(int pose) {
    Character* live = document_.session().character();
    const auto input = studiedCharacter(document_.session());
    std::vector<AccuracyBody::Part> parts;
    QString text;
    if (study_ && study_->reference && live && input && !outdated_ && pose < int(input->poses.size()) && pose < int(study_->reference->positions.size())) {
        CharacterInput given = input->character;
        for (std::size_t e = 0; e < given.elements.size(); ++e) given.elements[e].response = live->input().elements[e].response;
        if (auto character = Character::build(std::move(given), {live})) {
            character->update(input->poses[std::size_t(pose)].pose);
            const PoseError error = errorOf(*character, *study_->reference, std::size_t(pose)).error();
            text = tr("error %1 (largest %2 of the diagonal)").arg(shareText(error.relative), diagonalText(error.percent));
            const auto errors = errorField(*character, *study_->reference, std::size_t(pose));
            for (std::size_t e = 0; e < errors.size(); ++e)
                parts.push_back(partOf(character->input().elements[e].mesh->body, character->positions(int(e)), study_->reference->positions[std::size_t(pose)][e], errors[e]));
        }
    }
    text_->setText(text);
    body_->setParts(std::move(parts));
}

}  // namespace imomushi
