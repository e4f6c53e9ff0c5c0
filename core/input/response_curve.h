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

    /// A value that becomes this one, or the nearest that can be: the beginning, or the middle, of a dead zone and of a curve without a height.
    [[nodiscard]] double back(double out) const {
        const bool middle = inLow < 0.0 && inHigh > 0.0;
        const double t = outHigh == outLow ? (middle ? 0.5 : 0.0) : std::clamp((out - outLow) / (outHigh - outLow), 0.0, 1.0);
        const double part = middle ? std::abs(2.0 * t - 1.0) : t;
        const double u = part > 0.0 ? deadZone + (1.0 - deadZone) * std::pow(part, 1.0 / exponent) : 0.0;
        return !middle ? inLow + u * (inHigh - inLow) : t < 0.5 ? u * inLow : u * inHigh;
    }
    /// Its ends lie on one line through its middle: what it makes more of a control it makes the same everywhere, but for exponent and dead zone.
    [[nodiscard]] bool isEven() const { return !(inLow < 0.0 && inHigh > 0.0) || inLow == -inHigh; }
    [[nodiscard]] double slope() const { return (outHigh - outLow) / (inHigh - inLow); }
};

}  // namespace imomushi
