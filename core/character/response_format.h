// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "core/base/result.h"

namespace imomushi {

/// The number format of A' in the frame. Every column has a scale of its own.
///   Float: 4 bytes per entry, rounding of single precision.
///   Half:  2 bytes per entry, 11 bits: at most 2.5e-4 of the largest displacement of a column.
///   Int16: 2 bytes per entry, 16 bits: at most 1.6e-5 of the largest displacement of a column. Products are summed in integers, two columns
///          at a time, which makes it the fastest where responses are in the caches.
enum class ResponseFormat { Float, Half, Int16 };

/// "float", "half", "int16". Errors: "bad-value" with the names there are.
Result<ResponseFormat> responseFormat(const std::string& name);
std::string formatName(ResponseFormat format);

}  // namespace imomushi
