// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace imomushi {

/// Which game controller one is. As a text: "GUID VVVV:PPPP NAME", digits of base 16.
struct PadId {
    std::string guid;  ///< 32 digits; it differs between USB and Bluetooth, and between versions of SDL
    std::uint16_t vendor = 0, product = 0;
    std::string name;
    [[nodiscard]] std::string text() const;
    /// Of such a text, or of a name alone.
    static std::string_view nameIn(std::string_view text);
    bool operator==(const PadId&) const = default;
};

/// How well a pad is the one that is wanted, by the text of its PadId or by its name alone: the more the better, 0: it is another one. Nothing wanted: any is as good.
int likeness(std::string_view wanted, const PadId& pad);

}  // namespace imomushi
