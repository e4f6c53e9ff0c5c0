// SPDX-License-Identifier: GPL-3.0-or-later
// Open Sound Control: a channel per address.
#include "core/input/decoders.h"
#include "core/input/osc_packet.h"

namespace imomushi {

namespace {

class OscDecoder final : public InputDecoder {
public:
    using InputDecoder::InputDecoder;

private:
    bool read(std::span<const std::byte> packet) override {
        return readOscPacket(packet, [this](const OscMessage& message) {
            std::array<double, OscMessage::kMost> numbers{};
            std::size_t count = 0;
            for (std::size_t i = 0; i < message.count; ++i)
                if (!message.arguments[i].isText) numbers[count++] = message.arguments[i].number;
            if (count == 0 && message.count > 0) {
                ignore();  // only texts
                return true;
            }
            if (count == 0) numbers[count++] = 1.0;
            return !message.more && add(message.address, std::span(numbers).first(count));
        });
    }
};

}  // namespace

std::unique_ptr<InputDecoder> makeOscDecoder(std::string_view source) { return std::make_unique<OscDecoder>(source); }

}  // namespace imomushi
