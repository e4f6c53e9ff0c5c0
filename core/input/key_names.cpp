// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/input/key_names.h"

#include <linux/input-event-codes.h>

#include <algorithm>
#include <utility>

namespace imomushi {

namespace {

constexpr std::pair<int, std::string_view> kKeys[] = {
    {KEY_1, "1"}, {KEY_2, "2"}, {KEY_3, "3"}, {KEY_4, "4"}, {KEY_5, "5"}, {KEY_6, "6"}, {KEY_7, "7"}, {KEY_8, "8"}, {KEY_9, "9"}, {KEY_0, "0"}, {KEY_MINUS, "minus"}, {KEY_EQUAL, "equal"},
    {KEY_BACKSPACE, "backspace"}, {KEY_TAB, "tab"}, {KEY_Q, "q"}, {KEY_W, "w"}, {KEY_E, "e"}, {KEY_R, "r"}, {KEY_T, "t"}, {KEY_Y, "y"}, {KEY_U, "u"}, {KEY_I, "i"}, {KEY_O, "o"}, {KEY_P, "p"},
    {KEY_LEFTBRACE, "left-bracket"}, {KEY_RIGHTBRACE, "right-bracket"}, {KEY_ENTER, "enter"}, {KEY_A, "a"}, {KEY_S, "s"}, {KEY_D, "d"}, {KEY_F, "f"}, {KEY_G, "g"}, {KEY_H, "h"}, {KEY_J, "j"},
    {KEY_K, "k"}, {KEY_L, "l"}, {KEY_SEMICOLON, "semicolon"}, {KEY_APOSTROPHE, "apostrophe"}, {KEY_GRAVE, "grave"}, {KEY_BACKSLASH, "backslash"}, {KEY_Z, "z"}, {KEY_X, "x"}, {KEY_C, "c"},
    {KEY_V, "v"}, {KEY_B, "b"}, {KEY_N, "n"}, {KEY_M, "m"}, {KEY_COMMA, "comma"}, {KEY_DOT, "dot"}, {KEY_SLASH, "slash"}, {KEY_SPACE, "space"}, {KEY_F1, "f1"}, {KEY_F2, "f2"}, {KEY_F3, "f3"},
    {KEY_F4, "f4"}, {KEY_F5, "f5"}, {KEY_F6, "f6"}, {KEY_F7, "f7"}, {KEY_F8, "f8"}, {KEY_F9, "f9"}, {KEY_F10, "f10"}, {KEY_F11, "f11"}, {KEY_F12, "f12"}, {KEY_KP7, "keypad-7"},
    {KEY_KP8, "keypad-8"}, {KEY_KP9, "keypad-9"}, {KEY_KPMINUS, "keypad-minus"}, {KEY_KP4, "keypad-4"}, {KEY_KP5, "keypad-5"}, {KEY_KP6, "keypad-6"}, {KEY_KPPLUS, "keypad-plus"},
    {KEY_KP1, "keypad-1"}, {KEY_KP2, "keypad-2"}, {KEY_KP3, "keypad-3"}, {KEY_KP0, "keypad-0"}, {KEY_KPDOT, "keypad-dot"}, {KEY_KPENTER, "keypad-enter"}, {KEY_KPSLASH, "keypad-slash"},
    {KEY_KPASTERISK, "keypad-times"}, {KEY_102ND, "left-of-z"}, {KEY_RO, "ro"}, {KEY_YEN, "yen"}, {KEY_HENKAN, "convert"}, {KEY_MUHENKAN, "non-convert"}, {KEY_HOME, "home"}, {KEY_UP, "up"},
    {KEY_PAGEUP, "page-up"}, {KEY_LEFT, "left"}, {KEY_RIGHT, "right"}, {KEY_END, "end"}, {KEY_DOWN, "down"}, {KEY_PAGEDOWN, "page-down"}, {KEY_INSERT, "insert"}, {KEY_DELETE, "delete"}};

}  // namespace

bool isKeyName(std::string_view name) { return std::ranges::any_of(kKeys, [&](const auto& key) { return key.second == name; }); }

const KeyStick* keyStick(std::string_view key) {
    const auto found = std::ranges::find_if(kKeySticks, [&](const KeyStick& s) { return key == s.left || key == s.right || key == s.down || key == s.up; });
    return found == kKeySticks.end() ? nullptr : &*found;
}

std::optional<std::string_view> keyName(int code) {
    const auto found = std::ranges::find(kKeys, code, &std::pair<int, std::string_view>::first);
    return found == std::end(kKeys) ? std::nullopt : std::optional(found->second);
}

}  // namespace imomushi
