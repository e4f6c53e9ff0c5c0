// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

namespace imomushi {

/// sRGB (as cameras, paint programs, style sheets and 8-bit vertex colours have it) to linear light, 0...1 (IEC 61966-2-1). Clamped; NaN gives 1.
inline float linearFromSrgb(double encoded) {
    if (std::isnan(encoded)) return 1.0f;
    encoded = std::clamp(encoded, 0.0, 1.0);
    return static_cast<float>(encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4));
}

/// The inverse, clamped to 0...1.
inline double srgbFromLinear(double linear) {
    return std::clamp(linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055, 0.0, 1.0);
}

}  // namespace imomushi
