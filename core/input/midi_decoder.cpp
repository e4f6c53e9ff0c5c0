// SPDX-License-Identifier: GPL-3.0-or-later
// Bytes of MIDI 1.0, with running status; a message may go on in the next packet. Channels, C from 1 to 16, N from 0 to 127:
//   cc/C/N          0 ... 1     a controller
//   cc14/C/N        0 ... 1     a pair of controllers N and N + 32 (N to 31), when the second one comes
//   note/C/N        0 ... 1     velocity, 0: off
//   pressure/C, key-pressure/C/N   0 ... 1
//   bend/C          -1 ... 1
//   program/C       0 ... 127
// Clock and other messages of the system are ignored. Reset (0xFF), which MidiPort says where a device was plugged out, leaves all channels.
#include <array>
#include <set>
#include <string>

#include "core/input/decoders.h"

namespace imomushi {

namespace {

constexpr double kMostOf7 = 127.0, kMostOf14 = 16383.0, kMiddleOf14 = 8192.0;

/// What is known between two bytes.
struct MidiState {
    int status = 0;            // 0: none, data means nothing
    std::array<int, 2> data{};
    int have = 0;              // of data
    bool exclusive = false;    // within F0 ... F7
    std::array<std::array<int, 32>, 16> high;  // the last value of controllers 0 ... 31, -1: none
    MidiState() {
        for (auto& channel : high) channel.fill(-1);
    }
};

class MidiDecoder final : public InputDecoder {
public:
    using InputDecoder::InputDecoder;

private:
    bool read(std::span<const std::byte> packet) override {
        next_ = state_;
        saidNow_.clear();
        left_ = false;
        for (const std::byte byte : packet)
            if (!take(std::to_integer<int>(byte))) return false;
        return true;
    }
    void accept() override {
        state_ = next_;
        if (left_) said_.clear();
        said_.merge(saidNow_);
    }

    /// How many bytes follow a status byte.
    static int dataOf(int status) {
        if (status < 0xF0) return (status & 0xF0) == 0xC0 || (status & 0xF0) == 0xD0 ? 1 : 2;
        return status == 0xF2 ? 2 : status == 0xF1 || status == 0xF3 ? 1 : 0;
    }

    bool take(int byte) {
        if (byte == 0xFF) return leave();
        if (byte >= 0xF8) {  // at any time, even within another message
            ignore();
            return true;
        }
        if (byte >= 0x80) {
            if (byte == 0xF7) {
                const bool ends = next_.exclusive;
                if (ends) ignore();
                next_.exclusive = false;
                next_.status = 0;
                return ends;
            }
            next_.exclusive = byte == 0xF0;
            next_.status = byte == 0xF0 ? 0 : byte;
            next_.have = 0;
            if (byte > 0xF0 && dataOf(byte) == 0) {
                ignore();
                next_.status = 0;
            }
            return true;
        }
        if (next_.exclusive) return true;
        if (next_.status == 0) return false;
        next_.data[static_cast<std::size_t>(next_.have++)] = byte;
        if (next_.have < dataOf(next_.status)) return true;
        next_.have = 0;
        if (next_.status < 0xF0) return message(next_.status & 0xF0, next_.status & 0x0F, next_.data[0], next_.data[1]);
        ignore();
        next_.status = 0;  // those of the system have no running status
        return true;
    }

    bool message(int kind, int channel, int first, int second) {
        const std::string of = "/" + std::to_string(channel + 1), which = of + "/" + std::to_string(first);
        switch (kind) {
            case 0x80: return say("note" + which, 0.0);
            case 0x90: return say("note" + which, second / kMostOf7);
            case 0xA0: return say("key-pressure" + which, second / kMostOf7);
            case 0xB0: return say("cc" + which, second / kMostOf7) && pair(channel, first, second);
            case 0xC0: return say("program" + of, first);
            case 0xD0: return say("pressure" + of, first / kMostOf7);
            default: {
                const double bend = second * 128.0 + first - kMiddleOf14;
                return say("bend" + of, bend < 0.0 ? bend / kMiddleOf14 : bend / (kMostOf14 - kMiddleOf14));
            }
        }
    }

    bool pair(int channel, int controller, int value) {
        auto& high = next_.high[static_cast<std::size_t>(channel)];
        if (controller < 32) high[static_cast<std::size_t>(controller)] = value;
        if (controller < 32 || controller >= 64) return true;
        const int first = high[static_cast<std::size_t>(controller - 32)];
        if (first < 0) return true;
        return say("cc14/" + std::to_string(channel + 1) + "/" + std::to_string(controller - 32), (first * 128.0 + value) / kMostOf14);
    }

    bool say(const std::string& what, double value) {
        if (left_ || !said_.contains(what)) saidNow_.insert(what);
        return add(what, std::span(&value, 1));
    }

    /// Nothing is known any more. Of more channels than a packet may have, the rest is heard again when it says something.
    bool leave() {
        if (said_.empty() && saidNow_.empty()) ignore();
        for (const auto* said : {&said_, &saidNow_})
            for (const std::string& what : *said)
                if ((said == &said_ && left_) || !addGone(what)) break;
        saidNow_.clear();
        left_ = true;
        next_ = {};
        return true;
    }

    MidiState state_, next_;
    std::set<std::string> said_, saidNow_;  // channels, before and within the packet that is read
    bool left_ = false;                     // within it
};

}  // namespace

std::unique_ptr<InputDecoder> makeMidiDecoder(std::string_view source) { return std::make_unique<MidiDecoder>(source); }

}  // namespace imomushi
