// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "core/base/result.h"

namespace imomushi {

/// The number format of A' in the frame, where it is kept as modes (response_blocks.h) with a scale of their own each.
///   Float: 4 bytes per entry, rounding of single precision.
///   Half:  2 bytes per entry, 11 bits: coordinates within 2.5e-4 of the largest displacement of a mode.
///   Int16: 2 bytes per entry, 16 bits: within 1.6e-5 of it. Products are summed in integers, two modes at a time, which makes it the fastest.
enum class ResponseFormat { Float, Half, Int16 };

/// "float", "half", "int16". Errors: "bad-value" with the names there are.
Result<ResponseFormat> responseFormat(const std::string& name);
std::string formatName(ResponseFormat format);

}  // namespace imomushi
