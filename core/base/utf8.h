// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string_view>

namespace imomushi {

/// Length of the UTF-8 character that begins at `at`, 0: none does.
std::size_t utf8Length(std::string_view s, std::size_t at);
bool isUtf8(std::string_view text);

}  // namespace imomushi
