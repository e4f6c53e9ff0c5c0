// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/input/input_port.h"

namespace imomushi {

class KeyPort;

/// The keys of the keyboard, as whoever has them says: a program hears them through its windows alone. Any thread may say them.
class KeyBoard {
public:
    KeyBoard();
    ~KeyBoard();
    KeyBoard(const KeyBoard&) = delete;
    KeyBoard& operator=(const KeyBoard&) = delete;
    /// To each port that is open. `key`: see isKeyName().
    static void say(std::string_view key, bool down);
};

/// The keyboard as a source. A packet is one byte, 1 where a key goes down and 0 where it comes up, and the name of the key.
class KeyPort final : public InputPort {
public:
    static constexpr std::size_t kLongestName = 31;  ///< bytes
    /// Errors: "no-devices", where nobody has a KeyBoard.
    static Result<std::unique_ptr<KeyPort>> open();
    ~KeyPort() override;
    KeyPort(const KeyPort&) = delete;
    KeyPort& operator=(const KeyPort&) = delete;

    std::optional<std::size_t> take(std::span<std::byte> room) override;
    [[nodiscard]] std::string device() const override { return "keyboard"; }
    [[nodiscard]] int descriptor() const override { return event_; }

private:
    friend class KeyBoard;
    struct Packet {
        std::array<std::byte, 1 + kLongestName> bytes{};
        std::size_t size = 0;
    };
    KeyPort();
    void say(const Packet& packet);
    std::mutex mutex_;
    std::deque<Packet> waiting_;
    int event_ = -1;  // readable while packets wait
};

}  // namespace imomushi
