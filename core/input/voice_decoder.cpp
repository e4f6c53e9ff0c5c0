// SPDX-License-Identifier: GPL-3.0-or-later
// A microphone, as this program notes it (voice_packet.h): channels "level", "aa", "ih", "ou", "ee" and "oh", 0 ... 1.
#include "core/input/decoders.h"
#include "core/input/voice_packet.h"

namespace imomushi {

namespace {

class VoiceDecoder final : public InputDecoder {
public:
    using InputDecoder::InputDecoder;

private:
    bool read(std::span<const std::byte> packet) override {
        if (packet.size() != VoicePacket::kBytes) return false;
        const auto kind = std::to_integer<unsigned>(packet[0]);
        for (std::size_t i = 0; i < kVoiceChannels.size(); ++i) {
            const auto at = [&](std::size_t byte) { return std::to_integer<unsigned>(packet[1 + 2 * i + byte]); };
            const double number = (at(0) | at(1) << 8) / 65535.0;
            if (kind == VoicePacket::kHeard ? !add(kVoiceChannels[i], std::span(&number, 1)) : kind != VoicePacket::kGone || number != 0.0 || !addGone(kVoiceChannels[i])) return false;
        }
        return true;
    }
};

}  // namespace

std::unique_ptr<InputDecoder> makeVoiceDecoder(std::string_view source) { return std::make_unique<VoiceDecoder>(source); }

}  // namespace imomushi
