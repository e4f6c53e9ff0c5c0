// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QList>
#include <QObject>
#include <map>

class QAction;
class QDockWidget;
class QMainWindow;

namespace imomushi {

class AccuracyPanel;
class ActionSet;
class EffectsPanel;
class FrameCostMeter;
class HistoryPanel;
class InspectorPanel;
class IssuesPanel;
class InputDeck;
class OutputDeck;
class LivePanel;
class OutlinerPanel;
class PosesPanel;
class StudioDocument;
class TakeDeck;
class TakesPanel;

/// The panels around the view, each in a dock: at the right the lists above the properties, at the foot accuracy and takes.
class StudioDocks : public QObject {
    Q_OBJECT
public:
    StudioDocks(QMainWindow& window, StudioDocument& document, TakeDeck& deck, InputDeck& inputs, OutputDeck& outputs, FrameCostMeter& costs, ActionSet& actions);
    /// Panels hear the document; they go before it does.
    ~StudioDocks() override;

    [[nodiscard]] OutlinerPanel& outliner() const { return *outliner_; }
    [[nodiscard]] HistoryPanel& history() const { return *history_; }
    [[nodiscard]] IssuesPanel& issues() const { return *issues_; }
    [[nodiscard]] InspectorPanel& inspector() const { return *inspector_; }
    [[nodiscard]] EffectsPanel& effects() const { return *effects_; }
    [[nodiscard]] AccuracyPanel& accuracy() const { return *accuracy_; }
    [[nodiscard]] TakesPanel& takes() const { return *takes_; }
    [[nodiscard]] PosesPanel& poses() const { return *poses_; }
    [[nodiscard]] LivePanel& live() const { return *live_; }

    /// In the order of the menu.
    [[nodiscard]] QList<QDockWidget*> all() const { return {outlinerDock_, inspectorDock_, effectsDock_, takesDock_, posesDock_, liveDock_, accuracyDock_, historyDock_, issuesDock_}; }
    /// Brings the dock of a panel to the front.
    static void raise(QWidget& panel);

    void retranslate();
    /// Lower bounds as large as the interface asks for; widths follow its scale.
    void takeSizes();
    /// What shows each panel in front, or hides it where it is there already; in the order of the menu.
    [[nodiscard]] const QList<QAction*>& actions() const { return actions_; }
    /// Says in the menu what the panels are called now, and which are in front.
    void followActions();
    /// How much of the height of both the lower right docks have.
    [[nodiscard]] double inspectorShare() const;
    /// Gives it to them, once the docks are laid out.
    void shareHeight(double inspector);

private:
    void tellIssues();
    /// A dock that is alone says its name itself; among others its tab does.
    void showTitles();

    QMainWindow& window_;
    double scale_;           ///< of the interface, when docks were given their sizes
    double width_ = 340.0;   ///< of the docks at the right, design pixels
    QList<QAction*> actions_;
    std::map<QDockWidget*, QWidget*> untitled_;  ///< what stands for the title of a dock that has a tab
    OutlinerPanel* outliner_;
    HistoryPanel* history_;
    IssuesPanel* issues_;
    InspectorPanel* inspector_;
    EffectsPanel* effects_;
    AccuracyPanel* accuracy_;
    TakesPanel* takes_;
    PosesPanel* poses_;
    LivePanel* live_;
    QDockWidget *outlinerDock_, *historyDock_, *issuesDock_, *inspectorDock_, *effectsDock_, *accuracyDock_, *takesDock_, *posesDock_, *liveDock_;
};

}  // namespace imomushi
