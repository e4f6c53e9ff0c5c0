// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace imomushi {

/// Open Sound Control as a sender writes it, byte by byte as its specification 1.0 says.
using OscArgument = std::variant<float, std::int32_t, std::string>;

inline void addOscText(std::string& to, const std::string& text) {
    to += text;
    to.append(4 - text.size() % 4, '\0');
}

inline void addOscNumber(std::string& to, std::uint32_t bits) {
    for (int shift = 24; shift >= 0; shift -= 8) to += static_cast<char>(bits >> shift & 0xFF);
}

inline std::string oscBytes(const std::string& address, const std::vector<OscArgument>& arguments) {
    std::string made, tags = ",";
    addOscText(made, address);
    for (const auto& a : arguments) tags += "fis"[a.index()];
    addOscText(made, tags);
    for (const auto& a : arguments) {
        if (const auto* text = std::get_if<std::string>(&a))
            addOscText(made, *text);
        else
            addOscNumber(made, std::holds_alternative<float>(a) ? std::bit_cast<std::uint32_t>(std::get<float>(a)) : static_cast<std::uint32_t>(std::get<std::int32_t>(a)));
    }
    return made;
}

inline std::string oscBundle(const std::vector<std::string>& packets) {
    std::string made("#bundle\0\0\0\0\0\0\0\0\1", 16);
    for (const std::string& packet : packets) {
        addOscNumber(made, static_cast<std::uint32_t>(packet.size()));
        made += packet;
    }
    return made;
}

inline std::span<const std::byte> asBytes(const std::string& text) { return std::as_bytes(std::span(text)); }

}  // namespace imomushi
