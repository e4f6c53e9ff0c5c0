// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <unordered_map>
#include <vector>

#include "core/input/control_learner.h"
#include "core/input/input_listener.h"
#include "core/input/input_triggers.h"
#include "core/input/raw_inputs.h"
#include "core/input/source_measure.h"
#include "core/input/udp_port.h"

namespace imomushi {

class InputFeed;

/// Hears sources for as long as there are some, on a thread of its own, and gives what they say to the feed of a performance. Without sources there is no thread and no open port.
/// All functions are for one thread, that of the window; the thread that steps never waits for any of them.
class HearingThread {
public:
    /// Others that send to the same port are not heard, until one of these has been silent for a while.
    static constexpr std::size_t kMostSenders = 16;
    /// What came from a source since its port was opened.
    struct Heard {
        InputCounts counts;          ///< malformed: too long ones, too
        std::uint64_t lost = 0;      ///< packets that found no room in the feed
        std::uint64_t refused = 0;   ///< packets of a sender too many
        int senders = 0;             ///< who sent something lately
        std::string device;          ///< InputPort::device()
        bool operator==(const Heard&) const = default;
    };

    HearingThread() = default;
    ~HearingThread() { stop(); }
    HearingThread(const HearingThread&) = delete;
    HearingThread& operator=(const HearingThread&) = delete;

    /// Opens the port of a source, whose name no other one has. Answers its number. Errors: those of UdpPort::listen().
    Result<std::uint16_t> open(const RawSource& source, std::uint16_t port, UdpPort::From from);
    /// The same for a port that is open, or a device.
    void open(const RawSource& source, std::unique_ptr<InputPort> port);
    void close(const std::string& source);
    [[nodiscard]] bool hears() const { return !sources_.empty(); }
    [[nodiscard]] std::optional<Heard> heard(const std::string& source) const;

    /// Sets the feed; null: none. The last value of each channel is given to it at once, as a fader that stands still sends nothing. `names`: the answer to InputListener::kListAddress.
    void feed(std::shared_ptr<InputFeed> feed, std::vector<std::string> names);
    /// What the window itself says: given to the feed like what is heard, and remembered as the last value of its channel. No port is needed.
    void say(const InputValue& value);
    /// What a source said is not remembered any more.
    void forget(const std::string& source);
    /// Values are counted, and learned from, but not given to the feed.
    void hold(bool held);
    /// From now on the control that moves is looked for; false: no more.
    void learn(bool on);
    /// From now on what a source says is measured, whether it is given to the feed or not; empty: no more.
    void measure(const std::string& source);
    /// None: nobody measures.
    [[nodiscard]] std::optional<SourceMeasure> measured() const;
    /// Sets the rows of triggers. `happened` is called with the index of a row, on the thread that hears; it must return at once and not throw. Rows that are all as before keep their state.
    void triggers(std::vector<InputRow> rows, std::function<void(std::size_t)> happened);
    /// Of each of these rows.
    [[nodiscard]] std::vector<InputMeter> triggerMeters() const;
    /// None: nothing has moved, or nobody learns.
    [[nodiscard]] std::optional<ControlLearner::Found> learned() const;

private:
    struct Sender {
        std::uint64_t id = 0;
        std::int64_t last = 0;  // ns
    };
    struct Source {
        RawSource source;
        std::unique_ptr<InputDecoder> decoder;
        std::array<Sender, kMostSenders> senders{};
        std::size_t known = 0;  // of these
        std::uint64_t lost = 0, refused = 0, tooLong = 0;
        std::string device;
    };
    void run();
    void stop();
    void serve();
    void remember(const InputValue& value);
    void take(std::size_t source, std::int64_t nanoseconds, std::span<const std::byte> bytes);
    static bool admits(Source& source, std::uint64_t sender, std::int64_t nanoseconds);
    [[nodiscard]] std::int64_t now() const;

    InputListener listener_{{}};      // of the thread while it runs
    std::vector<Source> sources_;     // as many; who they are does not change while it runs
    mutable std::mutex mutex_;        // what both threads see: counts and senders of sources, and from here on
    std::shared_ptr<InputFeed> feed_;
    std::vector<std::string> names_;
    std::unordered_map<std::uint64_t, InputValue> last_;  // of each channel, by a hash of source and name
    bool held_ = false;
    InputTriggers triggers_;
    std::function<void(std::size_t)> happened_;
    std::unique_ptr<ControlLearner> learner_;
    std::optional<SourceMeasure> measure_;
    std::vector<InputValue> values_;  // of the packet that is read
    const InputListener::Clock::time_point start_ = InputListener::Clock::now();
    std::atomic<bool> over_{false};
    std::thread thread_;
};

}  // namespace imomushi
