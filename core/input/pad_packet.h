// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace imomushi {

/// Axes and buttons of a game controller, by SDL's numbers.
inline constexpr std::array<std::string_view, 6> kPadAxes = {"left-x", "left-y", "right-x", "right-y", "left-trigger", "right-trigger"};
inline constexpr std::array<std::string_view, 21> kPadButtons = {"a", "b", "x", "y", "back", "guide", "start", "left-stick", "right-stick", "left-shoulder", "right-shoulder",
                                                                 "up", "down", "left", "right", "misc", "paddle-1", "paddle-2", "paddle-3", "paddle-4", "touchpad"};

/// What a game controller said, as bytes that can be recorded: kind, number of the control, value in 16 bits (low byte first). Of an axis as SDL has it, -32768 ... 32767; of a button 0 or 1.
/// kGone: it was plugged out, control and value are 0.
struct PadPacket {
    static constexpr std::size_t kBytes = 4;
    static constexpr unsigned kAxis = 0, kButton = 1, kGone = 2;
    static std::array<std::byte, kBytes> of(unsigned kind, unsigned control, std::int16_t value) {
        const auto bits = static_cast<std::uint16_t>(value);
        return {static_cast<std::byte>(kind), static_cast<std::byte>(control), static_cast<std::byte>(bits & 0xFF), static_cast<std::byte>(bits >> 8)};
    }
};

}  // namespace imomushi
