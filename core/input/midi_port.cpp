// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/input/midi_port.h"

#include <algorithm>
#include <cctype>
#include <utility>

namespace imomushi {

namespace {

/// A message says two values at most: a packet has fewer than a decoder takes.
constexpr std::size_t kMostMessages = 400;
constexpr std::byte kReset{0xFF};
/// What ALSA always has: it connects programs.
constexpr std::string_view kThrough = "Midi Through";

}  // namespace

std::string plainMidiName(std::string_view name) {
    // " 20:0" at the end is the number of a client and of its port.
    if (const auto space = name.rfind(' '); space != std::string_view::npos) {
        const std::string_view end = name.substr(space + 1);
        const auto colon = end.find(':');
        const auto digits = [](std::string_view text) { return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; }); };
        if (colon != std::string_view::npos && digits(end.substr(0, colon)) && digits(end.substr(colon + 1))) name = name.substr(0, space);
    }
    // "CLIENT:PORT", where the port mostly repeats the client.
    if (const auto colon = name.find(':'); colon != std::string_view::npos && name.substr(colon + 1).starts_with(name.substr(0, colon))) name = name.substr(colon + 1);
    return std::string(name);
}

void MidiPort::look(bool& gone) {
    const Clock::time_point now = Clock::now();
    if (looked_ != Clock::time_point{} && now - looked_ < betweenLooks_) return;
    looked_ = now;
    const std::vector<std::string> names = system_->names();
    if (input_ && std::ranges::find(names, place_) == names.end()) {
        input_.reset();
        name_.clear();
        gone = true;
    }
    for (std::size_t i = 0; i < names.size() && !input_; ++i) {
        const std::string plain = plainMidiName(names[i]);
        if (wanted_.empty() ? plain.starts_with(kThrough) : plain != wanted_) continue;
        input_ = system_->open(i);
        if (!input_) continue;
        name_ = plain;
        place_ = names[i];
    }
}

std::optional<std::size_t> MidiPort::take(std::span<std::byte> room) {
    bool gone = false;
    look(gone);
    std::size_t size = 0;
    if (gone) {
        waits_ = false;
        room[size++] = kReset;
    }
    for (std::size_t i = 0; i < kMostMessages && input_ && (waits_ || input_->take(message_)); ++i) {
        waits_ = size + message_.size() > room.size();
        if (waits_ && message_.size() > room.size()) waits_ = false;  // no packet could have it
        else if (waits_) break;
        else size = static_cast<std::size_t>(std::ranges::transform(message_, room.begin() + static_cast<std::ptrdiff_t>(size), [](std::uint8_t byte) { return std::byte{byte}; }).out - room.begin());
    }
    return size > 0 ? std::optional(size) : std::nullopt;
}

}  // namespace imomushi
