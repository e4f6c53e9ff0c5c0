// SPDX-License-Identifier: GPL-3.0-or-later
// Game controllers, as this program notes them (pad_packet.h). Channels by the names of SDL's game controllers: sticks -1 ... 1 (y up), triggers 0 ... 1, buttons 0 or 1.
// A stick has a round dead zone: how far it leans counts, not how far each axis does, so that a slow circle is one. Both numbers of a stick are said where one of them changes.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/input/decoders.h"
#include "core/input/pad_packet.h"

namespace imomushi {

namespace {

/// Sticks that nobody touches rest within this part of their way; worn ones need more, by the dead zone of their mapping.
constexpr double kRestsWithin = 0.12;
constexpr std::size_t kSticks = 2;  // axes 0 1 and 2 3; triggers follow

class PadDecoder final : public InputDecoder {
public:
    using InputDecoder::InputDecoder;

private:
    struct State {
        std::array<std::array<double, 2>, kSticks> sticks{};  // as the pad says them, y up
        std::array<bool, kPadAxes.size()> saidAxes{};
        std::array<bool, kPadButtons.size()> saidButtons{};
    };

    bool read(std::span<const std::byte> packet) override {
        next_ = state_;
        if (packet.size() % PadPacket::kBytes != 0) return false;
        for (; !packet.empty(); packet = packet.subspan(PadPacket::kBytes)) {
            const auto at = [&](std::size_t i) { return std::to_integer<unsigned>(packet[i]); };
            if (!record(at(0), at(1), static_cast<std::int16_t>(static_cast<std::uint16_t>(at(2) | at(3) << 8)))) return false;
        }
        return true;
    }
    void accept() override { state_ = next_; }

    bool record(unsigned kind, std::size_t control, std::int16_t value) {
        const double part = value < 0 ? value / 32768.0 : value / 32767.0;
        if (kind == PadPacket::kAxis && control < 2 * kSticks) {
            next_.sticks[control / 2][control % 2] = control % 2 == 1 ? -part : part;  // SDL's y points down
            return stick(control / 2);
        }
        if (kind == PadPacket::kAxis && control < kPadAxes.size()) {
            next_.saidAxes[control] = true;
            return say(kPadAxes[control], std::max(0.0, part));
        }
        if (kind == PadPacket::kButton && control < kPadButtons.size() && (value == 0 || value == 1)) {
            next_.saidButtons[control] = true;
            return say(kPadButtons[control], value);
        }
        return kind == PadPacket::kGone && control == 0 && value == 0 && leave();
    }

    bool stick(std::size_t which) {
        const auto [x, y] = next_.sticks[which];
        const double way = std::hypot(x, y), left = std::max(0.0, way - kRestsWithin) / (1.0 - kRestsWithin), scale = way > 0.0 ? left / way : 0.0;
        next_.saidAxes[2 * which] = next_.saidAxes[2 * which + 1] = true;
        return say(kPadAxes[2 * which], std::clamp(scale * x, -1.0, 1.0)) && say(kPadAxes[2 * which + 1], std::clamp(scale * y, -1.0, 1.0));
    }

    /// What was said is not known any more.
    bool leave() {
        for (std::size_t i = 0; i < kPadAxes.size(); ++i)
            if (next_.saidAxes[i] && !addGone(kPadAxes[i])) return false;
        for (std::size_t i = 0; i < kPadButtons.size(); ++i)
            if (next_.saidButtons[i] && !addGone(kPadButtons[i])) return false;
        next_ = {};
        return true;
    }

    bool say(std::string_view what, double value) { return add(what, std::span(&value, 1)); }

    State state_, next_;
};

}  // namespace

std::unique_ptr<InputDecoder> makePadDecoder(std::string_view source) { return std::make_unique<PadDecoder>(source); }

}  // namespace imomushi
