// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

namespace imomushi {

/// How the value of a control becomes another one. A range that has 0 within has its middle there (a stick): both halves are alike, each with its own end.
struct ResponseCurve {
    double inLow = 0.0, inHigh = 1.0;    ///< of the control, low < high; values beyond are at the ends
    double outLow = 0.0, outHigh = 1.0;  ///< what the ends become, in the unit of the target; high may be less
    double exponent = 1.0;               ///< 1: straight; more: finer near the beginning, or the middle
    double deadZone = 0.0;               ///< part of the range next to its beginning, or middle, that counts as that: 0 ... below 1
    bool operator==(const ResponseCurve&) const = default;

    [[nodiscard]] double at(double value) const {
        const bool middle = inLow < 0.0 && inHigh > 0.0;
        const double x = std::clamp(value, inLow, inHigh);
        const double u = !middle ? (x - inLow) / (inHigh - inLow) : x < 0.0 ? -x / inLow : x / inHigh;
        const double part = std::pow(std::max(0.0, (std::abs(u) - deadZone) / (1.0 - deadZone)), exponent);
        const double t = !middle ? part : 0.5 + 0.5 * std::copysign(part, u);
        return outLow + t * (outHigh - outLow);
    }
};

}  // namespace imomushi
