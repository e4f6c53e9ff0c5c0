// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/studio_docks.h"

#include <QAction>
#include <QDockWidget>
#include <QMainWindow>
#include <QScreen>
#include <QStyle>
#include <QTabBar>
#include <QTimer>
#include <algorithm>
#include <utility>

#include "ui/panels/accuracy/accuracy_panel.h"
#include "ui/panels/effects_panel.h"
#include "ui/panels/history_panel.h"
#include "ui/panels/inspector/inspector_panel.h"
#include "ui/panels/issues_panel.h"
#include "ui/panels/live/live_panel.h"
#include "ui/panels/outliner_panel.h"
#include "ui/panels/poses_panel.h"
#include "ui/panels/takes_panel.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/scrolled.h"

namespace imomushi {
namespace {

/// Of the live inputs, design pixels: a few rows, and the form of one.
constexpr int kLiveHeight = 262;

/// The artist sees it: no other tab is before it.
bool inFront(const QDockWidget& dock) { return dock.isVisible() && (dock.isFloating() || !dock.visibleRegion().isEmpty()); }

}  // namespace

StudioDocks::StudioDocks(QMainWindow& window, StudioDocument& document, TakeDeck& deck, InputDeck& inputs, OutputDeck& outputs, FrameCostMeter& costs, ActionSet& actions) : QObject(&window), window_(window), scale_(Appearance::instance().scale()) {
    window.setDockOptions(QMainWindow::AnimatedDocks | QMainWindow::AllowTabbedDocks | QMainWindow::AllowNestedDocks);
    window.setTabPosition(Qt::RightDockWidgetArea, QTabWidget::North);
    window.setTabPosition(Qt::BottomDockWidgetArea, QTabWidget::North);
    window.setCorner(Qt::BottomRightCorner, Qt::RightDockWidgetArea);
    outliner_ = new OutlinerPanel(document, &window);
    history_ = new HistoryPanel(document, &window);
    issues_ = new IssuesPanel(document, &window);
    inspector_ = new InspectorPanel(document, &window);
    effects_ = new EffectsPanel(document, &window);
    const auto dock = [this, &window](const char* name, QWidget* panel, Qt::DockWidgetArea area) {
        auto* d = new QDockWidget(&window);
        d->setObjectName(QLatin1String(name));
        d->setWidget(panel);
        untitled_[d] = new QWidget(d);
        d->setTitleBarWidget(untitled_[d]);
        window.addDockWidget(area, d);
        for (const auto signal : {&QDockWidget::topLevelChanged, &QDockWidget::visibilityChanged})
            connect(d, signal, this, [this] { QMetaObject::invokeMethod(this, &StudioDocks::showTitles, Qt::QueuedConnection); });
        connect(d, &QDockWidget::dockLocationChanged, this, [this] { QMetaObject::invokeMethod(this, &StudioDocks::showTitles, Qt::QueuedConnection); });
        return d;
    };
    outlinerDock_ = dock("outlinerDock", outliner_, Qt::RightDockWidgetArea);
    historyDock_ = dock("historyDock", history_, Qt::RightDockWidgetArea);
    issuesDock_ = dock("issuesDock", issues_, Qt::RightDockWidgetArea);
    inspectorDock_ = dock("inspectorDock", inspector_, Qt::RightDockWidgetArea);
    effectsDock_ = dock("effectsDock", effects_, Qt::RightDockWidgetArea);
    accuracy_ = new AccuracyPanel(document, costs, &window);
    accuracyDock_ = dock("accuracyDock", new Scrolled(accuracy_, &window), Qt::BottomDockWidgetArea);
    accuracyDock_->hide();
    takes_ = new TakesPanel(document, deck, actions, &window);
    takesDock_ = dock("takesDock", new Scrolled(takes_, &window), Qt::BottomDockWidgetArea);
    takesDock_->widget()->setMinimumHeight(takes_->minimumHeight());
    // Later: while docks find their places, panels are narrow for a moment. Whoever made the dock higher than it must be keeps its height.
    connect(takes_, &TakesPanel::heightWanted, this, [this](int pixels) {
        QWidget* area = takesDock_->widget();
        const bool tight = area->height() <= area->minimumHeight();
        const int above = takesDock_->height() - area->height();
        area->setMinimumHeight(pixels);
        if (tight && area->height() > pixels) window_.resizeDocks({takesDock_}, {above + pixels}, Qt::Vertical);
    }, Qt::QueuedConnection);
    poses_ = new PosesPanel(document, inputs, actions, &window);
    posesDock_ = dock("posesDock", new Scrolled(poses_, &window), Qt::BottomDockWidgetArea);
    posesDock_->hide();
    live_ = new LivePanel(document, inputs, outputs, deck, actions, &window);
    liveDock_ = dock("liveDock", new Scrolled(live_, &window), Qt::BottomDockWidgetArea);
    liveDock_->hide();
    window.tabifyDockWidget(accuracyDock_, takesDock_);
    window.tabifyDockWidget(takesDock_, posesDock_);
    window.tabifyDockWidget(posesDock_, liveDock_);
    // Split first: a dock that is split off a tab only becomes another tab.
    window.splitDockWidget(outlinerDock_, inspectorDock_, Qt::Vertical);
    window.tabifyDockWidget(outlinerDock_, historyDock_);
    window.tabifyDockWidget(historyDock_, issuesDock_);
    window.tabifyDockWidget(inspectorDock_, effectsDock_);
    window.resizeDocks({outlinerDock_, inspectorDock_}, {px(width_), px(width_)}, Qt::Horizontal);
    outlinerDock_->raise();
    inspectorDock_->raise();
    for (QDockWidget* d : all()) {
        auto* action = new QAction(this);
        action->setCheckable(true);
        connect(action, &QAction::triggered, this, [this, d] {
            if (inFront(*d)) d->close();
            else raise(*d);
            followActions();
        });
        actions_ << action;
    }
    connect(issues_, &IssuesPanel::problemsChanged, this, &StudioDocks::tellIssues);
}

StudioDocks::~StudioDocks() { qDeleteAll(all()); }

void StudioDocks::raise(QWidget& panel) {
    for (QWidget* widget = &panel; widget; widget = widget->parentWidget())
        if (auto* dock = qobject_cast<QDockWidget*>(widget)) {
            dock->show();
            dock->raise();
            return;
        }
}

void StudioDocks::retranslate() {
    outlinerDock_->setWindowTitle(tr("Outliner"));
    historyDock_->setWindowTitle(tr("History"));
    inspectorDock_->setWindowTitle(tr("Properties"));
    effectsDock_->setWindowTitle(tr("Effects"));
    accuracyDock_->setWindowTitle(tr("Accuracy and cost"));
    takesDock_->setWindowTitle(tr("Takes"));
    posesDock_->setWindowTitle(tr("Poses"));
    liveDock_->setWindowTitle(tr("Live inputs"));
    tellIssues();
    followActions();
    for (QTabBar* tabs : window_.findChildren<QTabBar*>(Qt::FindDirectChildrenOnly)) tabs->setAccessibleName(tr("Panels"));
}

void StudioDocks::tellIssues() {
    const int problems = issues_->problems();
    issuesDock_->setWindowTitle(problems > 0 ? tr("Issues (%1)").arg(problems) : tr("Issues"));
}

void StudioDocks::takeSizes() {
    const int room = window_.screen()->availableGeometry().width();
    // Wider than it must be: that is how somebody wants it.
    if (window_.isVisible() && !outlinerDock_->isFloating() && outlinerDock_->width() > outlinerDock_->minimumWidth()) width_ = outlinerDock_->width() / scale_;
    for (QDockWidget* dock : {outlinerDock_, inspectorDock_, effectsDock_}) dock->setMinimumWidth(std::min(px(300), room * 2 / 5));
    accuracyDock_->widget()->setMinimumHeight(accuracy_->minimumHeight());
    liveDock_->widget()->setMinimumHeight(px(kLiveHeight));
    const double scale = Appearance::instance().scale(), before = std::exchange(scale_, scale);
    // Docks grow with what stands in them, but do not shrink with it by themselves.
    if (scale < before) QTimer::singleShot(0, this, [this] { window_.resizeDocks({outlinerDock_, inspectorDock_}, {px(width_), px(width_)}, Qt::Horizontal); });
}

void StudioDocks::followActions() {
    for (qsizetype i = 0; i < actions_.size(); ++i) {
        actions_[i]->setText(all()[i]->windowTitle());
        actions_[i]->setChecked(inFront(*all()[i]));
    }
}

void StudioDocks::showTitles() {
    for (QDockWidget* d : all()) {
        const auto beside = window_.tabifiedDockWidgets(d);
        const bool tabbed = !d->isFloating() && std::any_of(beside.begin(), beside.end(), [](const QDockWidget* other) { return !other->isHidden() && !other->isFloating(); });
        QWidget* wanted = tabbed ? untitled_[d] : nullptr;
        if (d->titleBarWidget() == wanted) continue;
        d->setTitleBarWidget(wanted);
        untitled_[d]->setVisible(tabbed);
    }
}

double StudioDocks::inspectorShare() const {
    const auto shown = [](std::initializer_list<QDockWidget*> tabs) {
        const auto* found = std::find_if(tabs.begin(), tabs.end(), [](const QDockWidget* dock) { return inFront(*dock) && !dock->isFloating(); });
        return found == tabs.end() ? nullptr : *found;
    };
    QDockWidget *upper = shown({outlinerDock_, historyDock_, issuesDock_}), *lower = shown({inspectorDock_, effectsDock_});
    if (!upper || !lower) return 0.0;
    // Tabs count, as where sizes are given.
    const int tabs = std::max(0, lower->y() - upper->geometry().bottom() - 1 - window_.style()->pixelMetric(QStyle::PM_DockWidgetSeparatorExtent, nullptr, &window_));
    const auto whole = [&](QDockWidget* dock) { return dock->height() + (window_.tabifiedDockWidgets(dock).isEmpty() ? 0 : tabs); };
    return double(whole(lower)) / (whole(upper) + whole(lower));
}

void StudioDocks::shareHeight(double inspector) {
    if (!(inspector > 0.0)) return;
    inspector = std::clamp(inspector, 0.1, 0.9);
    QTimer::singleShot(0, this, [this, inspector] {
        window_.resizeDocks({outlinerDock_, inspectorDock_}, {int(1000.0 * (1.0 - inspector)), int(1000.0 * inspector)}, Qt::Vertical);
    });
}

}  // namespace imomushi
