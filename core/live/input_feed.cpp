// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/input_feed.h"

#include "core/live/live_character.h"

namespace imomushi {

InputFeed::InputFeed(InputDriver driver) : driver_(std::move(driver)) {
    for (std::vector<InputMeter>& meters : meters_.allSlots()) meters.resize(driver_.mappings());
}

bool InputFeed::give(std::span<const InputValue> packet) {
    if (values_.free() < packet.size()) return false;
    const InputTime came = inputTime();
    for (std::size_t i = 0; i < packet.size(); ++i) values_.push({packet[i], i + 1 == packet.size(), came});
    values_.publish();
    wake();
    return true;
}

std::optional<std::uint64_t> InputFeed::takeStep() {
    const std::uint64_t* packets = steps_.front();
    if (!packets) return std::nullopt;
    const std::uint64_t count = *packets;
    steps_.pop();
    return count;
}

bool InputFeed::tell(const Hand& hand) {
    if (hands_.free() == 0) return false;
    hands_.push(hand);
    hands_.publish();
    wake();
    return true;
}

bool InputFeed::hold(const LiveInput& held) { return tell({held, false}); }
bool InputFeed::giveToHand(const LiveInput& held) { return tell({held, true}); }

void InputFeed::wakes(std::function<void()> wake) {
    const std::lock_guard lock(waking_);
    wake_ = std::move(wake);
}

void InputFeed::wake() {
    const std::lock_guard lock(waking_);
    if (wake_) wake_();
}

void InputFeed::letGo() {
    letsGo_.store(true, std::memory_order_release);
    wake();
}

void InputFeed::forgetNumbers() {
    forgets_.store(true, std::memory_order_release);
    wake();
}

double InputFeed::rests() const {
    const bool told = values_.front() || hands_.front() || letsGo_.load(std::memory_order_relaxed) || forgets_.load(std::memory_order_relaxed);
    return told ? 0.0 : driver_.rests();
}

InputTime InputFeed::step(double seconds, double slept, LiveCharacter& live) {
    InputTime first = 0;
    if (slept > 0.0) driver_.pass(slept);
    for (; const Hand* hand = hands_.front(); hands_.pop()) hand->has ? driver_.giveToHand(hand->input) : driver_.hold(hand->input);
    while (const Heard* heard = values_.front()) {
        (void)driver_.take(heard->value);
        if (heard->last) ++packets_;
        first = firstOf(first, heard->came);
        values_.pop();
    }
    if (letsGo_.exchange(false, std::memory_order_acquire)) driver_.letGo();  // of what was heard until then, too
    if (forgets_.exchange(false, std::memory_order_acquire)) driver_.forgetNumbers();
    for (const LiveInput& input : driver_.step(seconds)) {
        if ((!input.isNumber() || driver_.holds(input)) && live.apply(input)) continue;
        if (refused_.free() == 0) continue;
        refused_.push(input);
        refused_.publish();
    }
    driver_.read(meters_.back());
    meters_.publish();
    if (steps_.free() == 0) return first;  // nobody records
    steps_.push(packets_);
    steps_.publish();
    return first;
}

void InputFeed::feel(double strength) {
    const auto wanted = static_cast<float>(strength);
    for (float felt = felt_.load(std::memory_order_relaxed); wanted > felt && !felt_.compare_exchange_weak(felt, wanted, std::memory_order_relaxed);) {}
}

std::optional<LiveInput> InputFeed::takeRefused() {
    const LiveInput* refused = refused_.front();
    if (!refused) return std::nullopt;
    const LiveInput input = *refused;
    refused_.pop();
    return input;
}

}  // namespace imomushi
