// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>

#include "core/base/spsc_queue.h"
#include "core/base/triple_buffer.h"
#include "core/live/input_driver.h"

namespace imomushi {

class LiveCharacter;

/// Live input on its way into the steps of a Performer: one thread hears it, another one steps. Which packets a step took is told, so that a recording of them does the same again.
class InputFeed {
public:
    static constexpr std::size_t kValues = 8192;  ///< half a second of 15,000 a second
    static constexpr std::size_t kSteps = 4096;   ///< a minute
    static constexpr std::size_t kHolds = 1024;
    explicit InputFeed(InputDriver driver);

    // ---- the hearing thread, and whoever it lets speak
    /// The values of a packet, which one step takes whole. False: there is no room, as nobody steps; the packet is lost.
    bool give(std::span<const InputValue> packet);
    /// The strongest that was to be felt since the last call; 0: nothing.
    double takeFelt() { return felt_.exchange(0.0F, std::memory_order_relaxed); }
    /// The oldest step that was not asked for yet: how many packets the driver had by then. None: all were asked for.
    std::optional<std::uint64_t> takeStep();

    // ---- the stepping thread
    /// Before a step of so many seconds, after so many more in which no step was made. Answers when the first came of what it takes.
    InputTime step(double seconds, double slept, LiveCharacter& live);
    /// After a step: what devices that are heard let be felt, 0 to 1 (LiveCharacter::landing()).
    void feel(double strength);
    /// For how many seconds from the last step on it has nothing to say, if nothing is given or told meanwhile; 0: it has.
    [[nodiscard]] double rests() const;

    /// Nobody may step meanwhile.
    [[nodiscard]] const InputDriver& driver() const { return driver_; }

    // ---- the thread of the window
    /// `wake` is called after whatever is given or told, by the thread that does so, and must return at once. Null: nobody is woken; no call goes on when this returns.
    void wakes(std::function<void()> wake);
    /// See InputDriver::hold(); from the next step on. False: there is no room, as nobody steps.
    bool hold(const LiveInput& held);
    /// See InputDriver::giveToHand(); from the next step on. False: there is no room, as nobody steps.
    bool giveToHand(const LiveInput& held);
    /// See InputDriver::letGo(); with the next step.
    void letGo();
    /// See InputDriver::forgetNumbers(); with the next step: what was held was undone.
    void forgetNumbers();
    /// Brings meters() up to the last step. False: nothing is new.
    bool takeMeters() { return meters_.take(); }
    /// Of each row of the document's table.
    [[nodiscard]] const std::vector<InputMeter>& meters() const { return meters_.front(); }
    /// takeRefused() has one.
    [[nodiscard]] bool refuses() const { return refused_.front() != nullptr; }
    /// An input that the character did not take, as nobody holds what it moves. None: all were taken.
    std::optional<LiveInput> takeRefused();
private:
    struct Heard {
        InputValue value;
        bool last = false;   // of its packet
        InputTime came = 0;
    };
    struct Hand {
        LiveInput input;
        bool has = false;  // else it has let go
    };
    bool tell(const Hand& hand);
    void wake();
    std::mutex waking_;           // of wake_: held for a call of it
    std::function<void()> wake_;
    InputDriver driver_;
    TripleBuffer<std::vector<InputMeter>> meters_;
    std::atomic<float> felt_{0.0F};
    std::atomic<bool> letsGo_{false};
    std::atomic<bool> forgets_{false};
    SpscQueue<Heard, kValues> values_;
    SpscQueue<std::uint64_t, kSteps> steps_;
    SpscQueue<LiveInput, kHolds> refused_;
    SpscQueue<Hand, kHolds> hands_;
    std::uint64_t packets_ = 0;  // that were taken
};

}  // namespace imomushi
