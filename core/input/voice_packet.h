// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/input/voice_analyser.h"

namespace imomushi {

/// What a microphone said in a hundredth of a second, as bytes that can be recorded: no sound, but what was heard of it. Its kind, then each number of VoiceSound in 16 bits (low byte first), 0 ... 65535 for 0 ... 1.
/// kGone: it was plugged out, the numbers are 0.
struct VoicePacket {
    static constexpr std::size_t kBytes = 1 + 2 * kVoiceChannels.size();
    static constexpr unsigned kHeard = 0, kGone = 1;
    static std::array<std::byte, kBytes> of(unsigned kind, const VoiceSound& sound) {
        std::array<std::byte, kBytes> made{std::byte(kind)};
        for (std::size_t i = 0; i < sound.size(); ++i) {
            const auto bits = static_cast<std::uint16_t>(std::lround(65535.0 * std::clamp(sound[i], 0.0, 1.0)));
            made[1 + 2 * i] = static_cast<std::byte>(bits & 0xFF);
            made[2 + 2 * i] = static_cast<std::byte>(bits >> 8);
        }
        return made;
    }
};

}  // namespace imomushi
