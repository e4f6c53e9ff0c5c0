// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QElapsedTimer>
#include <QMainWindow>
#include <QPointer>
#include <map>
#include <vector>

#include "ui/jobs/precompute_job.h"
#include "ui/models/studio_document.h"
#include "ui/models/take_deck.h"
#include "ui/window/message_bar.h"

class QDockWidget;
class QStackedLayout;
class QToolBar;

namespace imomushi {

class CommandSearch;
class AccuracyPanel;
class EffectsPanel;
class ExportDialog;
class FrameCostMeter;
class FileFlow;
class HistoryPanel;
class InspectorPanel;
class IssuesPanel;
class OutlinerPanel;
class StartPage;
class StatusStrip;
class StudioActions;
class TakesPanel;
class ViewportWidget;

/// The window of the studio: puts the panels together and connects menus to commands.
class MainWindow : public QMainWindow {
    Q_OBJECT
public:
    /// `store`: of responses, see Session.
    explicit MainWindow(const CommandRegistry& registry, std::shared_ptr<ResponseStore> store = nullptr);
    ~MainWindow() override;

    [[nodiscard]] StudioDocument& document() { return document_; }
    [[nodiscard]] ViewportWidget& viewport() { return *viewport_; }
    [[nodiscard]] FileFlow& files() { return *files_; }
    [[nodiscard]] StudioActions& actions() { return *actions_; }
    [[nodiscard]] OutlinerPanel& outliner() { return *outliner_; }
    [[nodiscard]] InspectorPanel& inspector() { return *inspector_; }
    [[nodiscard]] EffectsPanel& effects() { return *effects_; }
    [[nodiscard]] AccuracyPanel& accuracy() { return *accuracy_; }
    [[nodiscard]] TakesPanel& takes() { return *takes_; }
    [[nodiscard]] TakeDeck& deck() { return *deck_; }
    [[nodiscard]] HistoryPanel& history() { return *history_; }
    [[nodiscard]] PrecomputeJob& precomputeJob() { return *precompute_; }
    [[nodiscard]] StatusStrip& status() { return *status_; }
    [[nodiscard]] MessageBar& messages() { return *message_; }
    /// The start page is in front of the view.
    void showStart(bool show);
    [[nodiscard]] bool startShown() const;

protected:
    void childEvent(QChildEvent* event) override;
    void closeEvent(QCloseEvent* event) override;
    void changeEvent(QEvent* event) override;
    void dragEnterEvent(QDragEnterEvent* event) override;
    void dropEvent(QDropEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    void showEvent(QShowEvent* event) override;
    bool event(QEvent* event) override;
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void buildActions();
    void buildMenus();
    void buildToolBar();
    void buildDocks();
    void connectView();
    void retranslate();
    void fillRecent();
    void updateTitle();
    void updateActions();
    void takeSizes();
    void placeOverlays();
    void contextMenu(const QPoint& global);
    void showControls();
    void showAbout();

    void warn();           ///< says what the last frame warns of, not every time
    void startPrecompute();
    void undo(int count);
    void record();
    void openExport();
    void updateTakeActions();
    void hideSelected();
    void showAll();
    void pinSelected();
    void joinSelected();
    /// Ends what is unfinished in the view before a command comes from elsewhere.
    void settle();
    /// Takes a picture of the view for the start page.
    void keepPicture();
    [[nodiscard]] double inspectorShare() const;  ///< of the height of the docks
    void shareHeight(double inspector);

    StudioDocument document_;
    StudioActions* actions_;
    TakeDeck* deck_;
    FileFlow* files_;
    PrecomputeJob* precompute_;
    QWidget* stage_ = nullptr;
    QStackedLayout* stack_ = nullptr;
    QWidget* viewHost_ = nullptr;
    ViewportWidget* viewport_ = nullptr;
    StartPage* start_ = nullptr;
    MessageBar* message_ = nullptr;
    JobCard* job_ = nullptr;
    OutlinerPanel* outliner_ = nullptr;
    InspectorPanel* inspector_ = nullptr;
    EffectsPanel* effects_ = nullptr;
    FrameCostMeter* costs_ = nullptr;
    AccuracyPanel* accuracy_ = nullptr;
    TakesPanel* takes_ = nullptr;
    QPointer<ExportDialog> export_;
    HistoryPanel* history_ = nullptr;
    IssuesPanel* issues_ = nullptr;
    StatusStrip* status_ = nullptr;
    QToolBar* tools_ = nullptr;
    QMenu* recentMenu_ = nullptr;
    QMenu* samplesMenu_ = nullptr;
    QMenu* panelsMenu_ = nullptr;
    QDockWidget* outlinerDock_ = nullptr;
    QDockWidget* historyDock_ = nullptr;
    QDockWidget* issuesDock_ = nullptr;
    QDockWidget* inspectorDock_ = nullptr;
    QDockWidget* effectsDock_ = nullptr;
    QDockWidget* accuracyDock_ = nullptr;
    QDockWidget* takesDock_ = nullptr;
    std::vector<std::pair<QMenu*, const char*>> menus_;  ///< with their titles in this class's context
    bool updateScheduled_ = false;
    std::map<FrameWarning, QElapsedTimer> warned_;  ///< since each was last said
    bool precomputeFailed_ = false;
    bool shown_ = false;
};

}  // namespace imomushi
