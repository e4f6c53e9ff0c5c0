// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/accuracy/accuracy_panel.h"

#include <QDoubleSpinBox>
#include <QEvent>
#include <QHBoxLayout>
#include <QLabel>
#include <QLocale>
#include <QProgressBar>
#include <QPushButton>
#include <QScrollArea>
#include <QSlider>
#include <QTabBar>
#include <QTabWidget>
#include <algorithm>

#include "core/reports/accuracy_commands.h"
#include "ui/models/gesture.h"
#include "ui/models/texts.h"
#include "ui/panels/accuracy/accuracy_errors.h"
#include "ui/panels/accuracy/accuracy_plot.h"
#include "ui/panels/accuracy/accuracy_tables.h"
#include "ui/panels/accuracy/accuracy_texts.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"

namespace imomushi {
namespace {

constexpr int kRecallMs = 400;

constexpr int kCostTab = 3;

}  // namespace

AccuracyPanel::AccuracyPanel(StudioDocument& document, FrameCostMeter& meter, QWidget* parent) : QWidget(parent), document_(document), job_(new AccuracyJob(this)) {
    usePanelBackground(this);
    auto* controls = makeControls();
    frame_ = named(new AccuracyPlot(this), "accuracyPerFrame");
    precompute_ = named(new AccuracyPlot(this), "accuracyPrecompute");
    fill(new QHBoxLayout(this), QMargins(px(14), px(10), px(12), px(10)), Spacing{px(14)}, controls, Share{frame_, 5},
         Share{precompute_, 5}, Share{makeTabs(meter), 7});
    connectParts();
    retranslate();
}

QWidget* AccuracyPanel::makeControls() {
    auto* left = new QWidget(this);
    usePanelBackground(left);
    auto* column = fill(new QVBoxLayout(left), QMargins(0, 0, px(10), 0), Spacing{px(6)});
    const auto label = [&](QVBoxLayout* into, const char* role) {
        auto* l = new QLabel(left);
        l->setWordWrap(true);
        if (role) l->setProperty("role", role);
        into->addWidget(l);
        return l;
    };
    title_ = label(column, "section");
    state_ = label(column, "muted");
    measure_ = named(new QPushButton(left), "accuracyMeasure");
    progress_ = new QProgressBar(left);
    progress_->setRange(0, 1000);
    progress_->setTextVisible(false);
    column->addLayout(fill(new QHBoxLayout, measure_, Share{progress_, 1}));
    faster_ = new QLabel(left);
    truer_ = new QLabel(left);
    slider_ = named(new QSlider(Qt::Horizontal, left), "accuracySlider");
    slider_->setPageStep(1);
    slider_->setTickPosition(QSlider::TicksBelow);
    slider_->setTickInterval(1);
    column->addLayout(fill(new QHBoxLayout, faster_, Share{slider_, 1}, truer_));
    chosenText_ = label(column, nullptr);
    chosenText_->setTextFormat(Qt::RichText);
    apply_ = named(new QPushButton(left), "accuracyApply");
    column->addWidget(apply_);
    budgetLabel_ = new QLabel(left);
    budget_ = named(new QDoubleSpinBox(left), "accuracyBudget");
    budget_->setRange(0.001, 1000.0);
    budget_->setDecimals(3);
    budget_->setButtonSymbols(QAbstractSpinBox::NoButtons);
    budget_->setValue(1000.0 / 60.0);
    budget_->setSuffix(QStringLiteral(" ms"));
    budgetUse_ = new QPushButton(left);
    column->addLayout(fill(new QHBoxLayout, budgetLabel_, Share{budget_, 1}, budgetUse_));
    budgetText_ = label(column, "muted");
    reference_ = label(column, "muted");
    column->addStretch(1);
    auto* scroll = new QScrollArea(this);
    scroll->setWidget(left);
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    const auto sized = [this, scroll] {
        scroll->setFixedWidth(px(276));
        setMinimumHeight(px(270));
    };
    sized();
    connect(&Appearance::instance(), &Appearance::changed, this, sized);
    return scroll;
}

QWidget* AccuracyPanel::makeTabs(FrameCostMeter& meter) {
    tabs_ = new QTabWidget(this);
    tabs_->setDocumentMode(true);
    tabs_->tabBar()->setUsesScrollButtons(true);
    table_ = new AccuracyTable(tabs_);
    tabs_->addTab(table_, {});
    errors_ = new AccuracyErrors(document_, tabs_);
    tabs_->addTab(errors_, {});
    effects_ = new EffectCostTable(tabs_);
    tabs_->addTab(effects_, {});
    auto* costs = new QScrollArea(tabs_);
    costs->setWidgetResizable(true);
    costs->setFrameShape(QFrame::NoFrame);
    costs->setWidget(new CostList(meter, costs));
    tabs_->addTab(costs, {});
    return tabs_;
}

void AccuracyPanel::connectParts() {
    connect(measure_, &QPushButton::clicked, this, [this] { job_->running() ? job_->cancel() : start(); });
    connect(apply_, &QPushButton::clicked, this, &AccuracyPanel::apply);
    connect(slider_, &QSlider::valueChanged, this, [this](int at) {
        if (at >= 0 && at < int(front_.size())) choose(int(front_[std::size_t(at)]));
    });
    connect(budget_, &QDoubleSpinBox::valueChanged, this, [this] { showState(); });
    connect(budgetUse_, &QPushButton::clicked, this, [this] {
        if (const int best = study_.best(budget_->value()); best >= 0) choose(best);
    });
    for (AccuracyPlot* plot : {frame_, precompute_}) connect(plot, &AccuracyPlot::clicked, this, &AccuracyPanel::choose);
    connect(table_, &AccuracyTable::chosen, this, &AccuracyPanel::choose);
    connect(job_, &AccuracyJob::arrived, this, &AccuracyPanel::show);
    connect(job_, &BackgroundJob::progressed, this, [this] {
        progress_->setValue(int(1000.0 * job_->fraction()));
        showState();
    });
    connect(job_, &BackgroundJob::finished, this, &AccuracyPanel::showState);
    recall_.setSingleShot(true);
    recall_.setInterval(kRecallMs);
    connect(&recall_, &QTimer::timeout, this, &AccuracyPanel::recall);
    const auto changed = [this] {
        outdated_ = true;
        errors_->setStudy(study_, true);
        if (job_->running()) return;
        if (isVisible()) recall_.start();
        showState();
    };
    connect(&document_, &StudioDocument::structureChanged, this, changed);
    connect(&document_, &StudioDocument::fileChanged, this, changed);
}

void AccuracyPanel::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) retranslate();
}

void AccuracyPanel::showEvent(QShowEvent* event) {
    QWidget::showEvent(event);
    if (outdated_ && !job_->running()) recall_.start();
}

void AccuracyPanel::retranslate() {
    title_->setText(tr("What accuracy costs"));
    faster_->setText(tr("faster"));
    truer_->setText(tr("more accurate"));
    slider_->setAccessibleName(tr("From faster to more accurate, along the best settings"));
    apply_->setText(tr("Use this setting"));
    apply_->setToolTip(tr("Sets basis, solver meshes, number format and smooth joints of the character, as one step that can be undone"));
    budgetLabel_->setText(tr("Budget"));
    budget_->setAccessibleName(tr("Budget per frame"));
    budget_->setToolTip(tr("At 60 frames per second a frame has 16.7 ms for everything"));
    budgetUse_->setText(tr("Choose"));
    progress_->setAccessibleName(tr("Progress of the measurements"));
    frame_->setTitles(tr("Error against time per frame"), tr("ms per frame"), tr("error, %"));
    precompute_->setTitles(tr("Error against precompute"), tr("s of precompute"), tr("error, %"));
    const std::pair<QString, QString> tabs[] = {{tr("Table"), tr("Measured settings")}, {tr("Body"), tr("Error on the body")}, {tr("Effects"), tr("Cost of effects")},
                                                {tr("Frame"), tr("Cost of a frame")}};
    for (int i = 0; i < 4; ++i) {
        tabs_->setTabText(i, tabs[i].first);
        tabs_->setTabToolTip(i, tabs[i].second);
    }
    tabs_->setAccessibleName(title_->text());
    table_->retranslate();
    effects_->retranslate();
    show(AccuracyStudy(study_));
}

void AccuracyPanel::recall() {
    outdated_ = false;
    const auto input = studyInput(document_.session());
    show(input ? knownStudy(*input) : AccuracyStudy());
}

void AccuracyPanel::start() {
    auto input = studyInput(document_.session());
    if (!input) {
        state_->setText(errorText(input.error()));
        return;
    }
    outdated_ = false;
    input->keeper = errors_->job().keeper();
    job_->start(std::move(*input));
    showState();
}

void AccuracyPanel::show(const AccuracyStudy& study) {
    const bool chose = chosen_ >= 0 && chosen_ < int(study_.points.size());
    const AccuracySetting known = chose ? study_.points[std::size_t(chosen_)].setting : AccuracySetting();
    study_ = study;
    front_ = study_.frontPerFrame();
    chosen_ = -1;
    for (std::size_t i = 0; chose && i < study_.points.size(); ++i)
        if (study_.points[i].setting == known) chosen_ = int(i);
    if (chosen_ < 0) chosen_ = study_.present();
    showPoints();
    effects_->showStudy(study_);
    showState();
    showChosen();
    errors_->setStudy(study_, outdated_);
}

QString AccuracyPanel::tip(int point) const {
    const AccuracyPoint& p = study_.points[std::size_t(point)];
    QStringList lines{settingText(p.setting)};
    if (p.problem) lines << errorText(*p.problem);
    lines << tr("error %1 (largest %2 of the diagonal)").arg(shareText(p.relative), diagonalText(p.percent));
    lines << tr("frame %1 (99 of 100 within %2), predicted %3").arg(millisecondsText(p.frameMs), millisecondsText(p.frameP99Ms), millisecondsText(p.predictedMs));
    lines << tr("precompute %1, predicted %2").arg(secondsText(p.precomputeSeconds), secondsText(p.predictedSeconds));
    if (p.frameBytes >= 0.0) lines << tr("memory of a frame %1").arg(bytesText(p.frameBytes));
    if (p.dominatedPerFrame && p.dominatedInPrecompute) lines << tr("not worth choosing: another setting is at least as good in everything");
    if (study_.reference && p.relative >= 0.0 && p.relative < study_.floor())
        lines << tr("below the error of the reference itself");
    if (point == study_.present()) lines << tr("the present setting");
    return lines.join(u'\n');
}

void AccuracyPanel::showPoints() {
    const auto front = study_.frontInPrecompute();
    std::vector<AccuracyPlot::Point> perFrame, inPrecompute;
    std::vector<QString> tips;
    for (std::size_t i = 0; i < study_.points.size(); ++i) {
        const AccuracyPoint& p = study_.points[i];
        const bool now = int(i) == study_.present();
        tips.push_back(tip(int(i)));
        perFrame.push_back({p.frameMs, 100.0 * p.relative, tips.back(), std::find(front_.begin(), front_.end(), i) != front_.end(), now});
        inPrecompute.push_back({p.precomputeSeconds, 100.0 * p.relative, tips.back(), std::find(front.begin(), front.end(), i) != front.end(), now});
    }
    for (AccuracyPlot* plot : {frame_, precompute_}) plot->setFloor(100.0 * study_.floor());
    frame_->setPoints(std::move(perFrame));
    precompute_->setPoints(std::move(inPrecompute));
    const QSignalBlocker blocked(slider_);
    slider_->setRange(0, std::max(0, int(front_.size()) - 1));
    slider_->setEnabled(front_.size() > 1);
    table_->showStudy(study_, front_, tips);
}

void AccuracyPanel::showState() {
    const bool running = job_->running();
    measure_->setText(running ? tr("Stop") : study_.complete ? tr("Measured") : tr("Measure"));
    measure_->setEnabled(running || (!study_.complete && !document_.document().elements.empty()));
    progress_->setVisible(running);
    const auto measured = std::count_if(study_.points.begin(), study_.points.end(), [](const AccuracyPoint& p) { return p.measured(); });
    if (running) {
        const double left = job_->secondsLeft();
        state_->setText(left > 0.0 ? tr("%1 of %2 settings measured · about %3 left").arg(measured).arg(study_.points.size()).arg(durationText(left))
                                   : tr("%1 of %2 settings measured").arg(measured).arg(study_.points.size()));
    } else if (job_->error() && job_->error()->code != kCancelled) {
        state_->setText(errorText(*job_->error()));
    } else if (outdated_ && measured > 0) {
        state_->setText(tr("The character changed since this was measured."));
    } else {
        state_->setText(measured == 0 ? tr("Not measured yet: it takes some minutes in the background, and can be stopped and continued.")
                                      : tr("%1 of %2 settings measured on this machine").arg(measured).arg(study_.points.size()));
    }
    if (const auto& r = study_.reference) {
        reference_->setText(tr("Errors are measured against the full solution on the mesh “%1”. Its own error is %2 (largest %3), and %4 at joint faces.")
                                .arg(QString::fromStdString(r->mesh), r->relative < 0.0 ? tr("unknown") : shareText(r->relative), r->percent < 0.0 ? tr("unknown") : diagonalText(r->percent),
                                     r->faceRelative < 0.0 ? tr("unknown") : shareText(r->faceRelative)));
        reference_->setToolTip(QString::fromStdString(r->how));
    } else {
        reference_->setText({});
    }
    const double budget = budget_->value();
    frame_->setBudget(budget);
    const int best = study_.best(budget);
    budgetUse_->setEnabled(best >= 0);
    budgetText_->setText(best >= 0 ? tr("Best within the budget: %1").arg(settingText(study_.points[std::size_t(best)].setting)) : measured > 0 ? tr("No measured setting is within the budget.") : QString());
}

void AccuracyPanel::choose(int point) {
    if (point == chosen_ || point < 0 || point >= int(study_.points.size())) return;
    chosen_ = point;
    showChosen();
}

void AccuracyPanel::showChosen() {
    frame_->setChosen(chosen_);
    precompute_->setChosen(chosen_);
    const bool any = chosen_ >= 0 && chosen_ < int(study_.points.size());
    apply_->setEnabled(any && chosen_ != study_.present() && !outdated_);
    if (!any) {
        chosenText_->setText({});
        return;
    }
    const AccuracyPoint& p = study_.points[std::size_t(chosen_)];
    const double off = p.frameMs > 0.0 && p.predictedMs > 0.0 ? std::max(p.frameMs / p.predictedMs, p.predictedMs / p.frameMs) : 0.0;
    chosenText_->setText(QStringLiteral("<b>%1</b><br>%2<br>%3")
                             .arg(settingText(p.setting).toHtmlEscaped(),
                                  tr("error %1 (largest %2 of the diagonal)").arg(shareText(p.relative), diagonalText(p.percent)),
                                  off > 0.0 ? tr("%1 per frame (prediction off by × %2), %3 of precompute").arg(millisecondsText(p.frameMs), QLocale().toString(off, 'f', 2), secondsText(p.precomputeSeconds))
                                            : tr("predicted: %1 per frame, %2 of precompute").arg(millisecondsText(p.predictedMs), secondsText(p.predictedSeconds))));
    const auto at = std::find(front_.begin(), front_.end(), std::size_t(chosen_));
    const QSignalBlocker blocked(slider_);
    if (at != front_.end()) slider_->setValue(int(at - front_.begin()));
    table_->setChosen(chosen_);
}

void AccuracyPanel::apply() {
    if (chosen_ < 0 || chosen_ >= int(study_.points.size())) return;
    executeTogether(document_, settingCommands(document_.document(), study_.points[std::size_t(chosen_)].setting));
}

void AccuracyPanel::showCosts() { tabs_->setCurrentIndex(kCostTab); }

}  // namespace imomushi
