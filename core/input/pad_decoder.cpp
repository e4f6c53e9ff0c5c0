// SPDX-License-Identifier: GPL-3.0-or-later
// Game controllers, as this program notes them (pad_packet.h). Channels by the names of SDL's game controllers: sticks -1 ... 1 (y up), triggers 0 ... 1, buttons 0 or 1.
#include "core/input/decoders.h"
#include "core/input/pad_packet.h"

namespace imomushi {

namespace {

class PadDecoder final : public InputDecoder {
public:
    using InputDecoder::InputDecoder;

private:
    bool read(std::span<const std::byte> packet) override {
        if (packet.size() % PadPacket::kBytes != 0) return false;
        for (; !packet.empty(); packet = packet.subspan(PadPacket::kBytes)) {
            const auto at = [&](std::size_t i) { return std::to_integer<unsigned>(packet[i]); };
            const unsigned control = at(1);
            const auto value = static_cast<std::int16_t>(static_cast<std::uint16_t>(at(2) | at(3) << 8));
            double number = 0.0;
            std::string_view name;
            if (at(0) == PadPacket::kAxis && control < kPadAxes.size()) {
                name = kPadAxes[control];
                number = value < 0 ? value / 32768.0 : value / 32767.0;
                if (control == 1 || control == 3) number = -number;  // SDL's y points down
            } else if (at(0) == PadPacket::kButton && control < kPadButtons.size() && (value == 0 || value == 1)) {
                name = kPadButtons[control];
                number = value;
            } else {
                return false;
            }
            if (!add(name, std::span(&number, 1))) return false;
        }
        return true;
    }
};

}  // namespace

std::unique_ptr<InputDecoder> makePadDecoder(std::string_view source) { return std::make_unique<PadDecoder>(source); }

}  // namespace imomushi
