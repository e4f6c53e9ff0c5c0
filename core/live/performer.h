// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/spsc_queue.h"
#include "core/base/triple_buffer.h"
#include "core/live/input_feed.h"
#include "core/live/live_character.h"
#include "core/live/step_thread.h"

namespace imomushi {

class SendingThread;

/// What a step of a performance shows: the numbers that a take keeps, and what the step has to say. Nobody changes it once it is published.
struct PerformedFrame {
    std::uint64_t step = 0;      ///< how many were made
    InputTime input = 0;         ///< when the oldest input came that this frame shows and that no frame before it, of those that were taken, did
    std::vector<double> shape;   ///< Character::shape()
    Pose pose;                   ///< LiveCharacter::shownPose()
    std::array<double, kEffects> effectMs{};  ///< negative: it had no such effect
    PassedTime passed;           ///< of the document
    double milliseconds = 0.0;   ///< wall time of the step
    StageTimes stages;
    unsigned warnings = 0;       ///< of FrameWarning
    bool resting = false;        ///< no step follows, or not soon
    bool met = false;            ///< flesh of two elements met
    std::size_t recorded = 0;    ///< frames of the take that is being recorded
    double recordedSeconds = 0.0;
    bool recordingEnded = false; ///< that take gets no more frames
};

/// Steps a live character on a thread of its own, at the rate of its document (CharacterSettings::rate) and only while something moves or is heard, and shows its frames to everybody else by a second character that
/// shares its tables. Whoever wants to change the live character, or its document, parks the performer first. All functions are for one thread, that of the window.
class Performer {
public:
    /// `live` must outlive it. `stepped` is called on the thread after each step, must return at once and not throw.
    Performer(LiveCharacter& live, std::function<void()> stepped);
    ~Performer();
    Performer(const Performer&) = delete;
    Performer& operator=(const Performer&) = delete;

    /// The live character and its document are the caller's until resume(): waits for one step at most. Calls may be nested.
    void park();
    /// Steps go on if something moves. If the character is out of date, they go on with the next query.
    void resume() noexcept;
    /// The live character is away on the thread: only frames may be asked.
    [[nodiscard]] bool running() const { return running_; }
    /// Steps are made: something moves, or was given. While there is a feed the thread also has the character when it rests, so that input wakes it without the window.
    [[nodiscard]] bool moving() const { return running_ && !resting_; }
    [[nodiscard]] double leftOut() const { return thread_.leftOut(); }  ///< s, see StepThread

    /// An input for the next step, which wakes what rests. False: it cannot be taken now. Inputs that were given before a command that changes the document are dropped.
    bool give(const LiveInput& input);
    void dropInputs();  ///< while it is parked
    /// While it is parked: steps take live input from there, and what is given there wakes what rests. Null: from nowhere. It is let go where the character gets other handles.
    void feed(std::shared_ptr<InputFeed> feed);
    [[nodiscard]] InputFeed* feed() const { return feed_.get(); }
    /// While it is parked: what is shown is given there from now on. Null: nowhere.
    void send(SendingThread* to) { sending_ = to, sentAs_ = 0; }
    /// From now on frame() and character() show the step that was made last. False: none was made since the last call.
    bool take();
    /// Flesh of two elements met since the last call, and lacks its patches (the effect "contact"): the document says so.
    bool takeMeeting() { return std::exchange(met_, false); }
    /// What was shown when take() or resume() was called last, while running().
    [[nodiscard]] const PerformedFrame& frame() const { return frames_.front(); }
    /// The take that is being recorded; none: nothing is.
    [[nodiscard]] const std::optional<std::string>& recording() const { return recording_; }
    /// Another character that shows what the live one shows. Null: there is none, or it cannot be built.
    Character* character();
    /// Of the last frame, in both characters.
    [[nodiscard]] StageTimes stages() const;
    /// Builds the live character where it is out of date, and steps it where it moves.
    void refresh();

private:
    void start() noexcept;
    double step(double seconds, double slept);
    /// For how many seconds no step would change anything; see StepThread.
    [[nodiscard]] double rests() const;
    void dropFeed();
    void fill(PerformedFrame& frame) const;
    /// shown_ is a copy of the character that the live one has built.
    void follow(Character* built);
    /// shown_ shows frame(), by the numbers that effects had then.
    void showFrame();

    LiveCharacter& live_;
    const std::function<void()> stepped_;
    TripleBuffer<PerformedFrame> frames_;
    struct Given {
        LiveInput input;
        InputTime came = 0;
    };
    SpscQueue<Given, 1024> inputs_;
    std::shared_ptr<InputFeed> feed_;
    std::vector<FaceRef> fedHandles_;  // that feed_ was made for
    SendingThread* sending_ = nullptr;
    std::uint64_t sentAs_ = 0;         // shows() of the live character that was given there last
    void giveFrame();
    std::optional<Character> shown_;
    std::vector<double> numbers_;   // of shown_
    std::uint64_t builtAs_ = 0, tunedAs_ = 0;   // of the live character: builds() and tunes() that shown_ has
    Effects shownEffects_;          // whose numbers shown_ has, and
    std::array<std::shared_ptr<EffectSettings>, kEffects> shownSettings_;  // its settings, null: an effect that it has not
    std::uint64_t shownAs_ = 0;     // and shows(); 0: it shows a frame, or nothing yet
    bool drawn_ = false;            // shown_ shows frame()
    std::optional<std::string> recording_;
    int parked_ = 0;
    bool running_ = false;
    bool resting_ = false;          // while running_: the frame that was taken last rests, and nothing was given since
    bool waiting_ = false;          // to be started when somebody asks
    bool met_ = false;
    std::uint64_t steps_ = 0;       // of the thread
    std::atomic<std::uint64_t> taken_{0};  // of these
    struct {
        InputTime came = 0;
        std::uint64_t step = 0;     // that showed it first
    } unseen_;                      // of the thread: the first input that no taken frame showed
    StepThread thread_;             // last: it ends first
};

/// Parks a performer for as long as this lives. Null: there is none, and nothing to do.
class ParkedPerformer {
public:
    explicit ParkedPerformer(Performer* performer) : performer_(performer) {
        if (performer_) performer_->park();
    }
    ~ParkedPerformer() {
        if (performer_) performer_->resume();
    }
    ParkedPerformer(const ParkedPerformer&) = delete;
    ParkedPerformer& operator=(const ParkedPerformer&) = delete;

private:
    Performer* performer_;
};

}  // namespace imomushi
