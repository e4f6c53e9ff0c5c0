// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/input/input_listener.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "core/input/input_decoder.h"

namespace imomushi {

namespace {

/// Who asks for the names is not answered more often.
constexpr std::chrono::seconds kBetweenLists(1);

}  // namespace

void InputListener::hear(Clock::time_point start, Clock::time_point until, const std::function<bool()>& over, const std::function<void(std::size_t, std::int64_t, std::span<const std::byte>)>& take) {
    room_.resize(InputDecoder::kLongestPacket);
    std::ranges::fill(left_, kMostPackets);
    for (bool again = true; again;) {
        InputPort::wait(ports_, until);
        again = Clock::now() < until;
        for (std::size_t i = 0; i < ports_.size(); ++i)
            for (; left_[i] > 0; --left_[i]) {
                const auto size = ports_[i]->take(room_);
                if (!size) break;
                if (*size == 0 || *size > room_.size()) {
                    ++tooLong_[i];
                    continue;
                }
                take(i, std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - start).count(), std::span(room_).first(*size));
            }
        again = again && !over();
        // A port with more would be ready at once, again and again.
        if (again && std::ranges::any_of(left_, [](int left) { return left == 0; })) {
            std::this_thread::sleep_until(until);
            break;
        }
    }
}

void InputListener::answerList(std::size_t port, const std::function<std::vector<std::string>()>& messages) {
    const Clock::time_point now = Clock::now();
    if (listed_ != Clock::time_point{} && now - listed_ < kBetweenLists) return;
    listed_ = now;
    for (const std::string& message : messages())
        if (!ports_[port]->answer(std::as_bytes(std::span(message)))) return;
}

void InputListener::add(std::unique_ptr<InputPort> port) {
    ports_.push_back(std::move(port));
    left_.push_back(0);
    tooLong_.push_back(0);
}

void InputListener::close(std::size_t port) {
    const auto at = static_cast<std::ptrdiff_t>(port);
    ports_.erase(ports_.begin() + at);
    left_.erase(left_.begin() + at);
    tooLong_.erase(tooLong_.begin() + at);
}

}  // namespace imomushi
