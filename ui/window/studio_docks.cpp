// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/studio_docks.h"

#include <QDockWidget>
#include <QMainWindow>
#include <QTabBar>
#include <QTimer>
#include <algorithm>

#include "ui/panels/accuracy/accuracy_panel.h"
#include "ui/panels/effects_panel.h"
#include "ui/panels/history_panel.h"
#include "ui/panels/inspector/inspector_panel.h"
#include "ui/panels/issues_panel.h"
#include "ui/panels/outliner_panel.h"
#include "ui/panels/takes_panel.h"
#include "ui/widgets/appearance.h"

namespace imomushi {

StudioDocks::StudioDocks(QMainWindow& window, StudioDocument& document, TakeDeck& deck, FrameCostMeter& costs, ActionSet& actions) : QObject(&window), window_(window) {
    window.setDockOptions(QMainWindow::AnimatedDocks | QMainWindow::AllowTabbedDocks | QMainWindow::AllowNestedDocks);
    window.setTabPosition(Qt::RightDockWidgetArea, QTabWidget::North);
    window.setTabPosition(Qt::BottomDockWidgetArea, QTabWidget::North);
    window.setCorner(Qt::BottomRightCorner, Qt::RightDockWidgetArea);
    outliner_ = new OutlinerPanel(document, &window);
    history_ = new HistoryPanel(document, &window);
    issues_ = new IssuesPanel(document, &window);
    inspector_ = new InspectorPanel(document, &window);
    effects_ = new EffectsPanel(document, &window);
    const auto dock = [&window](const char* name, QWidget* panel, Qt::DockWidgetArea area) {
        auto* d = new QDockWidget(&window);
        d->setObjectName(QLatin1String(name));
        d->setWidget(panel);
        d->setFeatures(QDockWidget::DockWidgetClosable | QDockWidget::DockWidgetMovable);
        // The tabs say the names; a title below them would say them twice. That takes are here is plain to see.
        d->setTitleBarWidget(new QWidget(d));
        window.addDockWidget(area, d);
        return d;
    };
    outlinerDock_ = dock("outlinerDock", outliner_, Qt::RightDockWidgetArea);
    historyDock_ = dock("historyDock", history_, Qt::RightDockWidgetArea);
    issuesDock_ = dock("issuesDock", issues_, Qt::RightDockWidgetArea);
    inspectorDock_ = dock("inspectorDock", inspector_, Qt::RightDockWidgetArea);
    effectsDock_ = dock("effectsDock", effects_, Qt::RightDockWidgetArea);
    accuracy_ = new AccuracyPanel(document, costs, &window);
    accuracyDock_ = dock("accuracyDock", accuracy_, Qt::BottomDockWidgetArea);
    accuracyDock_->hide();
    takes_ = new TakesPanel(document, deck, actions, &window);
    takesDock_ = dock("takesDock", takes_, Qt::BottomDockWidgetArea);
    window.tabifyDockWidget(accuracyDock_, takesDock_);
    // Split first: a dock that is split off a tab only becomes another tab.
    window.splitDockWidget(outlinerDock_, inspectorDock_, Qt::Vertical);
    window.tabifyDockWidget(outlinerDock_, historyDock_);
    window.tabifyDockWidget(historyDock_, issuesDock_);
    window.tabifyDockWidget(inspectorDock_, effectsDock_);
    window.resizeDocks({outlinerDock_, inspectorDock_}, {px(340), px(340)}, Qt::Horizontal);
    outlinerDock_->raise();
    inspectorDock_->raise();
    connect(issues_, &IssuesPanel::worthChanged, this, &StudioDocks::tellIssues);
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
    tellIssues();
    for (QTabBar* tabs : window_.findChildren<QTabBar*>(Qt::FindDirectChildrenOnly)) tabs->setAccessibleName(tr("Panels"));
}

void StudioDocks::tellIssues() {
    const int worth = issues_->worth();
    issuesDock_->setWindowTitle(worth > 0 ? tr("Issues (%1)").arg(worth) : tr("Issues"));
}

void StudioDocks::takeSizes() {
    for (QDockWidget* dock : {outlinerDock_, inspectorDock_, effectsDock_}) dock->setMinimumWidth(px(300));
}

double StudioDocks::inspectorShare(const QWidget& view) const {
    const QDockWidget* inFront = effectsDock_->visibleRegion().isEmpty() ? inspectorDock_ : effectsDock_;
    return double(inFront->height()) / std::max(view.height(), 1);
}

void StudioDocks::shareHeight(double inspector) {
    inspector = std::clamp(inspector, 0.1, 0.9);
    QTimer::singleShot(0, this, [this, inspector] {
        window_.resizeDocks({outlinerDock_, inspectorDock_}, {int(1000.0 * (1.0 - inspector)), int(1000.0 * inspector)}, Qt::Vertical);
    });
}

}  // namespace imomushi
