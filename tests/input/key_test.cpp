// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>
#include <linux/input-event-codes.h>
#include <poll.h>

#include <array>
#include <memory>
#include <string>

#include "core/input/devices.h"
#include "core/input/key_names.h"
#include "core/input/key_port.h"

using namespace imomushi;

namespace {

std::string taken(InputPort& port) {
    std::array<std::byte, 64> room{};
    const auto size = port.take(room);
    return size ? std::string(reinterpret_cast<const char*>(room.data()), *size) : std::string();
}

bool readable(const InputPort& port) {
    pollfd file{port.descriptor(), POLLIN, 0};
    return ::poll(&file, 1, 0) == 1;
}

}  // namespace

TEST_CASE("keys: without a window there are none, and that is said") {
    const auto port = openDevice(InputProtocol::Keys, {});
    REQUIRE(!port);
    CHECK(port.error().code == "no-devices");
}

TEST_CASE("keys: what a window says is in every port that is open, in its order, and a port is readable as long as something waits") {
    const KeyBoard board;
    KeyBoard::say("w", true);  // nobody listens
    auto first = openDevice(InputProtocol::Keys, {}), second = openDevice(InputProtocol::Keys, {});
    REQUIRE(first);
    REQUIRE(second);
    CHECK(!readable(**first));
    KeyBoard::say("space", true);
    KeyBoard::say("space", false);
    CHECK(readable(**first));
    CHECK(taken(**first) == "\1space");
    CHECK(readable(**first));
    CHECK(taken(**first) == std::string("\0space", 6));
    CHECK(!readable(**first));
    CHECK(taken(**first).empty());
    first->reset();
    KeyBoard::say("left", true);
    taken(**second);
    taken(**second);
    CHECK(taken(**second) == "\1left");
}

TEST_CASE("keys: a key has the name of its place on a US keyboard, those that change or end others have none") {
    CHECK(keyName(KEY_Q) == "q");
    CHECK(keyName(KEY_KP7) == "keypad-7");
    for (const int code : {KEY_LEFTSHIFT, KEY_RIGHTCTRL, KEY_LEFTALT, KEY_LEFTMETA, KEY_ESC, KEY_CAPSLOCK}) CHECK(!keyName(code));
    for (const KeyStick& stick : kKeySticks) {
        CHECK(!isKeyName(stick.name));
        for (const std::string_view key : {stick.left, stick.right, stick.up, stick.down}) {
            CHECK(isKeyName(key));
            CHECK(keyStick(key) == &stick);
        }
    }
    CHECK(keyStick("space") == nullptr);
}
