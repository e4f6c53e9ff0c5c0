// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace imomushi {

/// The names of the keys of a keyboard as a source of live input: by where a key is, not by what it types, so that a mapping means the same places under every layout. A key has the name of what is
/// printed there on a US keyboard: "q", "1", "space", "left", "f1", "keypad-1". Shift, Ctrl, Alt and Escape have none: they change or end what other keys do.
bool isKeyName(std::string_view name);

/// Four keys that are a stick, too: its channel has two numbers, -1, 0 or 1, x to the right and y up.
struct KeyStick {
    std::string_view name, left, right, down, up;
};
inline constexpr std::array<KeyStick, 3> kKeySticks{{{"wasd", "a", "d", "s", "w"}, {"ijkl", "j", "l", "k", "i"}, {"arrows", "left", "right", "down", "up"}}};
/// The stick that a key is part of; null: none.
const KeyStick* keyStick(std::string_view key);

/// The name of a key by its code of Linux' input drivers (KEY_Q: 16). None: it has no name.
std::optional<std::string_view> keyName(int code);

}  // namespace imomushi
