// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "core/base/triple_buffer.h"
#include "core/live/input_driver.h"

namespace imomushi {

class LiveCharacter;

/// A row between two threads: one gives, one takes, in order. Neither waits, and nothing is allocated but at the beginning.
template <class Thing, std::size_t room>
class TwoThreadRow {
public:
    [[nodiscard]] std::size_t free() const { return room - (given_ - taken_.load(std::memory_order_acquire)); }
    /// The giving thread, where there is room; others see it after publish().
    void give(const Thing& thing) { (*things_)[given_++ % room] = thing; }
    void publish() { published_.store(given_, std::memory_order_release); }
    /// The taking thread. Null: there is none.
    [[nodiscard]] const Thing* front() const {
        const std::size_t at = taken_.load(std::memory_order_relaxed);
        return at == published_.load(std::memory_order_acquire) ? nullptr : &(*things_)[at % room];
    }
    void pop() { taken_.store(taken_.load(std::memory_order_relaxed) + 1, std::memory_order_release); }

private:
    std::unique_ptr<std::array<Thing, room>> things_ = std::make_unique<std::array<Thing, room>>();
    std::size_t given_ = 0;  // of the giving thread
    std::atomic<std::size_t> published_{0}, taken_{0};
};

/// Live input on its way into the steps of a Performer: one thread hears it, another one steps. Which packets a step took is told, so that a recording of them does the same again.
class InputFeed {
public:
    static constexpr std::size_t kValues = 8192;  ///< half a second of 15,000 a second
    static constexpr std::size_t kSteps = 4096;   ///< a minute
    static constexpr std::size_t kHolds = 1024;
    explicit InputFeed(InputDriver driver);

    // ---- the hearing thread
    /// The values of a packet, which one step takes whole. False: there is no room, as nobody steps; the packet is lost.
    bool give(std::span<const InputValue> packet);
    /// How many packets had been given to the driver when the next step was made that this was not told of; none: no such step was made.
    std::optional<std::uint64_t> takeStep();

    // ---- the stepping thread
    /// Before a step of so many seconds. Answers when the first came of what it takes.
    InputTime step(double seconds, LiveCharacter& live);

    // ---- the thread of the window
    /// See InputDriver::hold(); from the next step on. False: there is no room, as nobody steps.
    bool hold(const LiveInput& held);
    /// See InputDriver::giveToHand(); from the next step on. False: there is no room, as nobody steps.
    bool giveToHand(const LiveInput& held);
    /// See InputDriver::letGo(); with the next step.
    void letGo() { letsGo_.store(true, std::memory_order_release); }
    /// See InputDriver::forgetNumbers(); with the next step: what was held was undone.
    void forgetNumbers() { forgets_.store(true, std::memory_order_release); }
    /// meters() are those of the last step from now on. False: they were.
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
    InputDriver driver_;
    TripleBuffer<std::vector<InputMeter>> meters_;
    std::atomic<bool> letsGo_{false};
    std::atomic<bool> forgets_{false};
    TwoThreadRow<Heard, kValues> values_;
    TwoThreadRow<std::uint64_t, kSteps> steps_;
    TwoThreadRow<LiveInput, kHolds> refused_;
    TwoThreadRow<Hand, kHolds> hands_;
    std::uint64_t packets_ = 0;  // that were taken
};

}  // namespace imomushi
