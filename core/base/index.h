// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

namespace imomushi {

/// The index of a vertex or triangle, at least 0, as standard containers take it.
inline std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

}  // namespace imomushi
