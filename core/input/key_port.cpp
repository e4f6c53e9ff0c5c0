// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/input/key_port.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>

namespace imomushi {

namespace {

/// What waits where nobody takes it; the rest is lost.
constexpr std::size_t kMostKeysWaiting = 4096;

struct Keys {
    std::mutex mutex;
    int boards = 0;
    std::vector<KeyPort*> ports;
};
Keys& keys() {
    static Keys all;
    return all;
}

}  // namespace

KeyBoard::KeyBoard() {
    const std::lock_guard lock(keys().mutex);
    ++keys().boards;
}

KeyBoard::~KeyBoard() {
    const std::lock_guard lock(keys().mutex);
    --keys().boards;
}

void KeyBoard::say(std::string_view key, bool down) {
    KeyPort::Packet packet;
    packet.size = 1 + std::min(key.size(), KeyPort::kLongestName);
    packet.bytes[0] = std::byte{down};
    std::transform(key.begin(), key.begin() + static_cast<std::ptrdiff_t>(packet.size - 1), packet.bytes.begin() + 1, [](char c) { return static_cast<std::byte>(c); });
    const std::lock_guard lock(keys().mutex);
    for (KeyPort* port : keys().ports) port->say(packet);
}

Result<std::unique_ptr<KeyPort>> KeyPort::open() {
    // Before the lock: whose destructor takes it, where this fails.
    auto port = std::unique_ptr<KeyPort>(new KeyPort);
    const std::lock_guard lock(keys().mutex);
    if (keys().boards == 0) return fail("no-devices", "Keys are heard by the studio's window alone.");
    if (port->event_ < 0) return fail("no-devices", "The keyboard cannot be heard: this program has too many files open.");
    keys().ports.push_back(port.get());
    return port;
}

KeyPort::KeyPort() : event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}

KeyPort::~KeyPort() {
    {
        const std::lock_guard lock(keys().mutex);
        std::erase(keys().ports, this);
    }
    if (event_ >= 0) ::close(event_);
}

void KeyPort::say(const Packet& packet) {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() == kMostKeysWaiting) return;
    waiting_.push_back(packet);
    if (waiting_.size() == 1) (void)::eventfd_write(event_, 1);
}

std::optional<std::size_t> KeyPort::take(std::span<std::byte> room) {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) return std::nullopt;
    const Packet packet = waiting_.front();
    waiting_.pop_front();
    if (waiting_.empty()) {
        eventfd_t count = 0;
        (void)::eventfd_read(event_, &count);
    }
    std::copy_n(packet.bytes.begin(), std::min(packet.size, room.size()), room.begin());
    return packet.size;
}

}  // namespace imomushi
