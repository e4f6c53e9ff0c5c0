// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/input/input_port.h"

namespace imomushi {

/// The ports of some sources, which one thread hears together: `live` without a window, and the thread of the studio.
class InputListener {
public:
    using Clock = std::chrono::steady_clock;
    /// Who sends this to a port is answered by the addresses of all that can be driven.
    static constexpr const char* kListAddress = "/imomushi/list";
    /// Of one port in one hear(): more than anybody sends. The rest waits for the next one.
    static constexpr int kMostPackets = 4096;

    explicit InputListener(std::vector<std::unique_ptr<InputPort>> ports) : ports_(std::move(ports)), left_(ports_.size()), tooLong_(ports_.size()) {}

    /// Receives packets until the time `until`, or until `over`, which is polled, returns true. Calls take(index of the port, nanoseconds since `start`, bytes).
    void hear(Clock::time_point start, Clock::time_point until, const std::function<bool()>& over, const std::function<void(std::size_t, std::int64_t, std::span<const std::byte>)>& take);
    /// For whoever sent what a port took last: sends messages, but not twice within a second, and to programs of this machine alone. `messages` is asked where they are sent.
    void answerList(std::size_t port, const std::function<std::vector<std::string>()>& messages);

    [[nodiscard]] const std::vector<std::unique_ptr<InputPort>>& ports() const { return ports_; }
    /// Packets of a port that were longer than any that is read, or empty.
    [[nodiscard]] std::uint64_t tooLong(std::size_t port) const { return tooLong_[port]; }
    /// Adds a port as the last one; closes one. Between two hear().
    void add(std::unique_ptr<InputPort> port);
    void close(std::size_t port);

private:
    std::vector<std::unique_ptr<InputPort>> ports_;
    std::vector<int> left_;  // of kMostPackets
    std::vector<std::uint64_t> tooLong_;
    std::vector<std::byte> room_;
    Clock::time_point listed_{};
};

}  // namespace imomushi
