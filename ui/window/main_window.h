// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QElapsedTimer>
#include <QMainWindow>
#include <QPointer>
#include <functional>
#include <map>

#include "ui/models/studio_document.h"
#include "ui/models/take_deck.h"
#include "ui/tools/tool_kind.h"
#include "ui/window/precompute_flow.h"

class QStackedLayout;

namespace imomushi {

class AccuracyPanel;
class ActionStates;
class ClipboardFlow;
class DragOptions;
class EffectsPanel;
class ExportDialog;
class FileFlow;
struct Findable;
class FrameCostMeter;
class HistoryPanel;
class InspectorPanel;
class IssuesPanel;
class InputDeck;
class OutputDeck;
class LivePanel;
class MessageBar;
enum class NavigationPreset;
class NextSteps;
class OutlinerPanel;
class PictureJob;
class PosePictures;
class Overlays;
class ProposalJob;
class RepairFlow;
class ReplayFlow;
class RigFlow;
class StageMode;
class StartPage;
class StatusStrip;
class StepFlow;
class StudioActions;
class StudioDocks;
class StudioMenus;
class TakesPanel;
class ViewportWidget;

/// The window of the studio: owns the document, puts its parts together, and says what the actions do.
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
    [[nodiscard]] OutlinerPanel& outliner();
    [[nodiscard]] InspectorPanel& inspector();
    [[nodiscard]] EffectsPanel& effects();
    [[nodiscard]] AccuracyPanel& accuracy();
    [[nodiscard]] TakesPanel& takes();
    [[nodiscard]] HistoryPanel& history();
    [[nodiscard]] TakeDeck& deck() { return *deck_; }
    [[nodiscard]] LivePanel& live();
    [[nodiscard]] InputDeck& inputs() { return *inputs_; }
    [[nodiscard]] OutputDeck& outputs() { return *outputs_; }
    [[nodiscard]] PrecomputeFlow& precompute() { return *precompute_; }
    [[nodiscard]] RepairFlow& repairs() { return *repairs_; }
    [[nodiscard]] StepFlow& steps() { return *steps_; }
    [[nodiscard]] RigFlow& rigs() { return *rigs_; }
    [[nodiscard]] ReplayFlow& replay() { return *replay_; }
    [[nodiscard]] IssuesPanel& issues();
    [[nodiscard]] StatusStrip& status() { return *status_; }
    [[nodiscard]] MessageBar& messages();
    /// The start page is in front of the view.
    void showStart(bool show);
    [[nodiscard]] bool startShown() const;

protected:
    void childEvent(QChildEvent* event) override;
    void closeEvent(QCloseEvent* event) override;
    void changeEvent(QEvent* event) override;
    void dragEnterEvent(QDragEnterEvent* event) override;
    void dragLeaveEvent(QDragLeaveEvent* event) override;
    void dropEvent(QDropEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    void showEvent(QShowEvent* event) override;
    bool event(QEvent* event) override;

private:
    void buildStage();
    void buildStatusBar();
    void connectDocument();
    void connectFiles();
    void connectReplay();
    void connectPrecompute();
    void connectRepairs();
    void connectSteps();
    void connectClipboard();
    void connectProposals();
    void connectPanels();
    void connectView();
    void restore();
    void keepOnScreen();
    void retranslate();
    void updateTitle();
    void takeSizes();
    /// Says what the last frame warns of, not every time.
    void warn();
    /// A file is held over the window.
    void setDropping(bool dropping);
    /// Takes a picture of the view for the start page.
    void keepPicture();

    // What the actions do: main_window_actions.cpp.
    void connectActions();
    void connectFileActions();
    void connectEditActions();
    void connectSoftActions();
    void connectTakeActions();
    void connectLiveActions();
    void connectViewActions();
    void on(const char* action, std::function<void()> run);
    void onToggle(const char* action, std::function<void(bool)> run);
    /// Ends what is unfinished in the view first.
    void onSettled(const char* action, std::function<void()> run);
    void sayHint();
    void settle();
    void setTool(ToolKind tool);
    void setNavigation(NavigationPreset preset);
    void startPrecompute();
    /// Asks how the character that is meant would be made soft, and shows it in the view.
    void propose();
    void undo();
    void join();
    void mirror(char axis);
    void record();
    void openExport();
    /// `setting`: what is to be changed; empty: whatever.
    void openPreferences(const QString& setting = {});
    /// Takes a picture of what is seen, into a file.
    void savePicture();
    void showEffect(EffectKind effect);
    /// All that F3 finds: main_window_search.cpp.
    std::vector<Findable> findables();

    StudioDocument document_;
    StudioActions* actions_;
    TakeDeck* deck_;
    InputDeck* inputs_;
    OutputDeck* outputs_;
    StepFlow* steps_;
    FileFlow* files_;
    RigFlow* rigs_;
    RepairFlow* repairs_;
    ReplayFlow* replay_;
    ClipboardFlow* clipboard_;
    PosePictures* posePictures_;
    PictureJob* thumbnail_;  ///< for the start page
    PrecomputeFlow* precompute_;
    DragOptions* drags_ = nullptr;
    ProposalJob* proposals_;
    FrameCostMeter* costs_;
    QWidget* stage_ = nullptr;
    QStackedLayout* stack_ = nullptr;
    ViewportWidget* viewport_ = nullptr;
    StartPage* start_ = nullptr;
    Overlays* overlays_ = nullptr;
    NextSteps* next_ = nullptr;
    StatusStrip* status_ = nullptr;
    StudioDocks* docks_ = nullptr;
    StudioMenus* menus_ = nullptr;
    StageMode* stageMode_ = nullptr;
    ActionStates* states_ = nullptr;
    QPointer<ExportDialog> export_;
    std::map<FrameWarning, QElapsedTimer> warned_;  ///< since each was last said
    bool shown_ = false;
};

}  // namespace imomushi
