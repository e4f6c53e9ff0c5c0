// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/performer.h"

#include <algorithm>
#include <chrono>
#include <new>

#include "core/live/sending_thread.h"

namespace imomushi {

Performer::Performer(LiveCharacter& live, std::function<void()> stepped)
    : live_(live), stepped_(std::move(stepped)), thread_([this](double seconds, double slept) { return step(seconds, slept); }) {
    live_.leaveVerticesToOthers(true);
}

Performer::~Performer() {
    thread_.park();
    dropFeed();  // who hears goes on
    if (running_) live_.endPerforming();
    live_.leaveVerticesToOthers(false);
}

// On the thread. Where memory runs out, the next step tries again: the last frame stays.
double Performer::step(double seconds, double slept) {
    const auto start = std::chrono::steady_clock::now();
    double sleep = 0.0;
    try {
        InputTime came = 0;
        for (; const Given* given = inputs_.front(); inputs_.pop()) {
            (void)live_.apply(given->input);  // what was let go meanwhile needs none
            came = firstOf(came, given->came);
        }
        if (feed_) came = firstOf(came, feed_->step(seconds, slept, live_));
        live_.advance(seconds);
        if (feed_) feed_->feel(live_.landing());
        ++steps_;
        if (unseen_.came == 0 || taken_.load(std::memory_order_relaxed) >= unseen_.step) unseen_ = {came, steps_};
        PerformedFrame& frame = frames_.back();
        fill(frame);
        frame.input = unseen_.came;
        frame.milliseconds = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
        sleep = rests();
        frame.resting = sleep > 0.0;
        frames_.publish();
        giveFrame();
    } catch (const std::bad_alloc&) {
    }
    stepped_();
    return sleep;
}

void Performer::giveFrame() {
    if (sending_ && std::exchange(sentAs_, live_.shows()) != live_.shows()) sending_->give(live_);
}

double Performer::rests() const {
    if (live_.inMotion()) return 0.0;
    return feed_ ? feed_->rests() : StepThread::kUntilWoken;
}

void Performer::dropFeed() {
    if (feed_) feed_->wakes({});
    feed_.reset();
}

void Performer::fill(PerformedFrame& frame) const {
    frame.step = steps_;
    live_.shape(frame.shape.data());
    frame.pose = live_.presentPose();
    frame.effectMs = live_.effectTimes();
    live_.passed(frame.passed);
    frame.stages = *live_.stages();
    frame.warnings = live_.warnings();
    frame.met = live_.hasMet();
    const auto& recording = live_.recording();
    frame.recorded = recording ? recording->take.times.size() : 0;
    frame.recordedSeconds = recording ? recording->take.duration() : 0.0;
    frame.recordingEnded = recording && !recording->going;
}

void Performer::park() {
    if (parked_++ > 0 || !running_) return;
    thread_.park();
    running_ = false;
    met_ = met_ || live_.hasMet();
    live_.endPerforming();
}

void Performer::resume() noexcept {
    if (--parked_ > 0) return;
    // What must be built first is built when somebody asks, not after each of many commands.
    waiting_ = live_.outOfDate();
    if (!waiting_) start();
}

void Performer::start() noexcept {
    waiting_ = false;
    try {
        const auto built = live_.built();
        if (!built || !*built) return;
        giveFrame();
        if (feed_ && fedHandles_ != live_.plan().handles) dropFeed();
        // A step would end the display of a take.
        if (inputs_.empty() && (!feed_ || live_.showsTake()) && !live_.inMotion()) return;
        follow(*built);
        if (!shown_) return;
        const double milliseconds = frame().milliseconds;
        const InputTime input = frame().input;
        const double sleep = inputs_.empty() ? rests() : 0.0;
        resting_ = sleep > 0.0;
        live_.beginPerforming();
        for (PerformedFrame& frame : frames_.allSlots()) {
            frame.shape.resize(numbers_.size());
            fill(frame);
            frame.milliseconds = milliseconds;  // of the last step: none was made here
            frame.input = input;
            frame.resting = resting_;
        }
        (void)frames_.take();  // what was stepped before is older than what is there
        drawn_ = shownAs_ == live_.shows();
        recording_ = live_.recording() ? std::optional(live_.recording()->take.name) : std::nullopt;
        shownEffects_ = live_.document().effects;
        shownSettings_ = live_.settingsOfEffects();
        running_ = true;
        thread_.run(live_.document().settings.rate, sleep);
    } catch (const std::bad_alloc&) {
        live_.endPerforming();
        live_.drop();  // it stands still until the next command, which says that there is no memory
    }
}

bool Performer::give(const LiveInput& input) {
    if (parked_ > 0 || inputs_.free() == 0) return false;
    inputs_.push({input, inputTime()});
    inputs_.publish();
    resting_ = false;
    if (running_) thread_.wake();
    else start();
    return true;
}

void Performer::dropInputs() { inputs_.clear(); }

void Performer::feed(std::shared_ptr<InputFeed> feed) {
    if (feed_ != feed) dropFeed();
    feed_ = std::move(feed);
    (void)live_.built();
    fedHandles_ = live_.plan().handles;
    if (feed_) feed_->wakes([this] { thread_.wake(); });
}

bool Performer::take() {
    // Whoever parked it meanwhile has the last step in the live character.
    if (!running_) return taken_.exchange(steps_) != steps_;
    // One that was made before somebody parked it, too.
    if (!frames_.take() && taken_ == frame().step) return false;
    taken_ = frame().step;
    resting_ = frame().resting;
    drawn_ = false;
    return true;
}

void Performer::refresh() {
    if (parked_ > 0 || !(running_ ? live_.outOfDate() : waiting_)) return;
    park();
    --parked_;
    start();
}

StageTimes Performer::stages() const {
    StageTimes times = running_ ? frame().stages : live_.stages().value_or(StageTimes{});
    if (!shown_) return times;
    // The other one is given its joints, and only evaluates vertices.
    const StageTimes seen = stageTimes(*shown_);
    times.product += seen.product;
    times.normals += seen.normals;
    return times;
}

void Performer::follow(Character* built) {
    if (builtAs_ != live_.builds() || !shown_) {
        auto made = Character::build(built->input(), {built});
        shown_.reset();
        if (!made) return;  // what could be built once can be built again
        shown_ = std::move(*made);
        numbers_.resize(static_cast<std::size_t>(shown_->shapeLayout().size()));
        builtAs_ = live_.builds();
        tunedAs_ = 0;
        shownAs_ = 0;
        drawn_ = false;
    }
    if (tunedAs_ != live_.tunes()) {
        shown_->tune(live_.effects());
        tunedAs_ = live_.tunes();
        shownAs_ = 0;
    }
}

void Performer::showFrame() {
    const double* now = frame().passed.numbers.data();
    for (std::size_t k = 0; k < kEffects; ++k) {
        auto& values = shownEffects_[static_cast<EffectKind>(k)].values;
        const bool same = std::equal(values.begin(), values.end(), now);
        if (!same) std::copy_n(now, values.size(), values.begin());
        now += values.size();
        if (same || !shownSettings_[k]) continue;
        readNumbers(shownEffects_, static_cast<EffectKind>(k), *shownSettings_[k]);
        shown_->tune(*shownSettings_[k]);
    }
    shown_->show(frame().shape.data());
}

Character* Performer::character() {
    refresh();
    if (running_) {
        if (!drawn_) showFrame();
        drawn_ = true;
        shownAs_ = 0;
        return &*shown_;
    }
    const auto built = live_.built();
    if (!built || !*built) {
        shown_.reset();
        return nullptr;
    }
    follow(*built);
    if (shown_ && shownAs_ != live_.shows()) {
        live_.shape(numbers_.data());
        shown_->show(numbers_.data());
        shownAs_ = live_.shows();
        drawn_ = false;
    }
    return shown_ ? &*shown_ : nullptr;
}

}  // namespace imomushi
