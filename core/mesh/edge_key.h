// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>

namespace imomushi {

/// The side from vertex `from` to vertex `to` as one number; those of the same vertices the other way around have another.
inline std::uint64_t sideKey(std::int32_t from, std::int32_t to) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(from)) << 32 | static_cast<std::uint32_t>(to);
}
/// The edge between two vertices as one number, whichever comes first. Ascends by the lower vertex, then the higher.
inline std::uint64_t edgeKey(std::int32_t a, std::int32_t b) { return sideKey(std::min(a, b), std::max(a, b)); }

}  // namespace imomushi
