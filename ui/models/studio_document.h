// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QString>
#include <array>
#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "core/session/session.h"
#include "ui/models/slow_step.h"

namespace imomushi {

/// One thing that can be selected: an element, one of its faces, a bone, one of a bone's endpoints, a whole character or one of its cuts.
struct SelectionItem {
    enum class Kind { Element, Face, Bone, Endpoint, Character, Cut } kind = Kind::Element;
    PartId part = 0;       ///< element (Element, Face), bone (Bone, Endpoint), character or cut
    std::string face;      ///< Face only
    bool atEnd = false;    ///< Endpoint only
    bool operator==(const SelectionItem&) const = default;
};

/// A session as Qt sees it: runs commands, says what changed, and holds what is selected. No widgets, no OpenGL.
/// Lives on the GUI thread.
class StudioDocument : public QObject {
    Q_OBJECT
public:
    /// `store`: of responses, see Session.
    explicit StudioDocument(const CommandRegistry& registry, std::shared_ptr<ResponseStore> store = nullptr, QObject* parent = nullptr);

    /// For questions. What changes the document goes through execute() and Gesture.
    [[nodiscard]] const Session& session() const { return session_; }
    [[nodiscard]] const Document& document() const { return session_.document(); }

    /// Runs one command on this thread. On failure emits failed() unless `quiet`.
    Result<Json> execute(const Json& command, bool quiet = false);

    /// Executes what may take its time: at once where the document is small or a gesture is open, else beside the window (setBeside()), some time later.
    void executeSlow(SlowStep step);
    /// executeSlow() would do it beside the window, were no gesture open.
    [[nodiscard]] bool worksBeside(const SlowStep& step) const;
    /// The same while the window waits.
    void executeAtOnce(const SlowStep& step);
    /// Who does slow steps beside the window, and gives up those that are not made yet; nobody: they are done at once.
    void setBeside(std::function<void(SlowStep)> beside, std::function<void()> giveUp) { beside_ = std::move(beside), giveUp_ = std::move(giveUp); }
    void giveUpUnderWay();
    /// The commands that are being done beside the window or wait for that, in their order: what they will make of the document.
    void setUnderWay(std::vector<Json> commands);
    [[nodiscard]] const std::vector<Json>& underWay() const { return underWay_; }
    /// Whether an effect is on, or on an element, when what is under way is done: what switches show.
    [[nodiscard]] bool turnedOn(EffectKind effect) const;
    [[nodiscard]] bool turnedOn(EffectKind effect, PartId element) const;
    /// The same as execute(), of what was done beside the window and fits the document. On failure emits failed().
    Result<Json> takePrepared(const PreparedStep& step);
    /// What slow commands ask for; the studio answers from what was done beside the window.
    [[nodiscard]] Services& services() { return session_.services(); }
    /// Derived from the document; jobs put there what they solved.
    [[nodiscard]] DocumentResponses& responses() { return session_.responses(); }
    void reuseCharacter(std::shared_ptr<const BuiltCharacter> built) { session_.reuseCharacter(std::move(built)); }
    [[nodiscard]] std::shared_ptr<const BuiltCharacter> releaseCharacter() { return session_.releaseCharacter(); }
    [[nodiscard]] Project project();  ///< what is saved
    void setHistoryDepth(int steps) { session_.setHistoryDepth(steps); }
    void setVersionLimits(const VersionLimits& limits) { session_.setVersionLimits(limits); }

    /// Several commands are becoming one step (see Gesture): whatever makes another waits.
    [[nodiscard]] bool inGesture() const { return gestures_ > 0; }

    /// From now on what moves by itself is stepped on a thread of its own (Session::perform()), and frameStepped() tells of it.
    void perform();
    /// A target of what is held already, for the next step. False: a command must do it, see Session::give().
    bool give(const LiveInput& input) { return session_.give(input); }
    /// Live input for the performance, see Session::performInputs().
    void performInputs(std::shared_ptr<InputFeed> feed);
    /// Where the performance is sent, see Session::performOutputs().
    void performOutputs(SendingThread* to) { session_.performOutputs(to); }
    /// Takes hold of what inputs move, as one step. False: it could not, and failed() said why.
    bool holdInputs();
    /// See Session::inputsLeft().
    [[nodiscard]] bool inputsLeft() { return session_.inputsLeft(); }
    /// Lets go what they hold and do not move any more, with the step that took hold of it or recorded it, if that is the last one. False: it failed.
    bool releaseInputs();
    /// One frame more: steps the session by `seconds` and measures it.
    void stepFrame(double seconds);
    /// Milliseconds that an effect, and stepping altogether, take in a frame: smoothed over some frames, those of the last ones where nothing moves now.
    /// None: not measured since it was turned on.
    [[nodiscard]] std::optional<double> effectMilliseconds(EffectKind effect) const;
    [[nodiscard]] std::optional<double> frameMilliseconds() const;
    /// How fast time passes in the performance, over the last second: 1 is real time, less where steps take longer than their time.
    [[nodiscard]] double pace() const { return pace_; }

    /// Bits of FrameWarning: what the last frame or pose had to say.
    [[nodiscard]] unsigned warnings();

    /// What solving an element would take, as it was estimated beside the window (EstimateJob). None: not yet, since the element is as it is.
    struct Estimate {
        std::shared_ptr<const Element> element;
        ResponseEstimate estimate;
    };
    [[nodiscard]] const ResponseEstimate* estimateOf(PartId element) const;
    void setEstimates(std::map<PartId, Estimate> estimates);

    [[nodiscard]] const std::vector<SelectionItem>& selection() const { return selection_; }
    void select(std::vector<SelectionItem> items);
    [[nodiscard]] bool isSelected(const SelectionItem& item) const;
    [[nodiscard]] const std::optional<SelectionItem>& hovered() const { return hovered_; }
    void setHovered(std::optional<SelectionItem> item);

Q_SIGNALS:
    /// Elements, faces, joints, bones, settings, effects or takes: the parts that changed, as they were. All parts where another document took the place of this one.
    void structureChanged(const imomushi::DocumentChange& change);
    void poseChanged();        ///< the character moved
    void responsesArriving();  ///< they are about to change what is seen
    /// A command runs next that may change what elements are made of, besides how they are posed. changeDone() follows, whether it succeeds or not.
    void changing();
    void changeDone();
    void underWayChanged();
    void estimated();          ///< estimateOf() says more
    void responsesChanged();   ///< a precompute finished or went out of date
    void historyChanged();     ///< undo, redo, steps
    void fileChanged();        ///< path or saved state
    void selectionChanged();
    void hoverChanged();
    void frameStepped();       ///< a frame was stepped, and is what is seen
    /// Something that was tried needs this command first, or an array of them; it is worth one click.
    void offered(const QString& text, const QString& label, const imomushi::Json& command);
    void madeCut(const QString& message);  ///< a tool cut an element; bones are what comes next
    void failed(const QString& message);  ///< a command was refused: one translated sentence

private:
    friend class Gesture;
    [[nodiscard]] bool exists(const SelectionItem& item) const;
    void tell(const Session::Change& change);
    /// Takes the latest frame, in a moment.
    void askForFrame();
    void takeFrame();
    void measure(double milliseconds);

    std::function<void(SlowStep)> beside_;
    std::function<void()> giveUp_;
    std::vector<Json> underWay_;
    std::atomic<bool> frameAsked_{false};
    bool performing_ = false;
    Session session_;
    int gestures_ = 0;
    std::array<double, kEffects> effectMs_;  ///< negative: none
    double frameMs_ = -1.0;
    double pace_ = 1.0, leftOut_ = 0.0;  ///< leftOut_: s, when pacing_ was started
    QElapsedTimer pacing_;
    bool unheard_ = false;                      ///< not everybody was told what changed
    std::array<bool, kEffects> measured_ = {};  ///< the effects that frames were measured with
    std::map<PartId, Estimate> estimates_;
    std::vector<SelectionItem> selection_;
    std::optional<SelectionItem> hovered_;
    std::jthread freeing_;  ///< what the document before this one held
};

}  // namespace imomushi
