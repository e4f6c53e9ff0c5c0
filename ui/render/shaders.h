// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace imomushi::render {

/// The source of a shader file ("body.frag"), part of the program; empty: no such file.
std::string_view shaderText(std::string_view name);

}  // namespace imomushi::render
