// SPDX-License-Identifier: GPL-3.0-or-later
// Keys of the keyboard, as KeyPort has them. A channel for each key, by its name: 1 while it is held, 0 when it is let go. A channel for each stick of four keys (kKeySticks).
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "core/input/decoders.h"
#include "core/input/key_names.h"

namespace imomushi {

namespace {

class KeyDecoder final : public InputDecoder {
public:
    using InputDecoder::InputDecoder;

private:
    bool read(std::span<const std::byte> packet) override {
        const auto down = std::to_integer<unsigned>(packet[0]);
        key_.assign(reinterpret_cast<const char*>(packet.data()) + 1, packet.size() - 1);
        down_ = down == 1;
        const double value = down;
        if (down > 1 || !isKeyName(key_) || !add(key_, std::span(&value, 1))) return false;
        const KeyStick* stick = keyStick(key_);
        if (!stick) return true;
        const auto held = [&](std::string_view key) { return key == key_ ? down_ : std::ranges::find(held_, key) != held_.end(); };
        const std::array<double, 2> lean{double(held(stick->right)) - double(held(stick->left)), double(held(stick->up)) - double(held(stick->down))};
        return add(stick->name, lean);
    }
    void accept() override {
        std::erase(held_, key_);
        if (down_ && keyStick(key_)) held_.push_back(key_);
    }

    std::string key_;  // of the packet that was read
    bool down_ = false;
    std::vector<std::string> held_;  // of sticks
};

}  // namespace

std::unique_ptr<InputDecoder> makeKeyDecoder(std::string_view source) { return std::make_unique<KeyDecoder>(source); }

}  // namespace imomushi
