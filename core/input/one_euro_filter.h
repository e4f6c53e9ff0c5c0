// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/base/rotation_vector.h"

namespace imomushi {

/// The one-euro filter (Casiez, Roussel and Vogel, CHI 2012): a low pass whose cutoff rises with the speed of what it follows, so that what stands still is calm and what moves is not late.
struct OneEuro {
    double hertz = 0.0;     ///< cutoff of what stands still, f_min; 0: no filter
    double reaction = 0.0;  ///< beta: Hz per unit and second
    static constexpr double kDerivativeHertz = 1.0;  ///< cutoff of the speed, as in the paper
    bool operator==(const OneEuro&) const = default;

    /// How much of a new value counts, with a cutoff (Hz) and s since the last one.
    static double alpha(double cutoff, double seconds) { return 1.0 / (1.0 + 1.0 / (2.0 * std::numbers::pi * cutoff * seconds)); }
    /// How late the filter is about what moves slowly, s: its time constant.
    [[nodiscard]] double delay() const { return hertz > 0.0 ? 1.0 / (2.0 * std::numbers::pi * hertz) : 0.0; }
};

/// A number that is filtered.
class FilteredNumber {
public:
    /// Begins anew at a value.
    void restart(double value) { value_ = value, speed_ = 0.0; }
    [[nodiscard]] double value() const { return value_; }
    double follow(double value, double seconds, const OneEuro& filter) {
        if (!(filter.hertz > 0.0)) return value_ = value;
        speed_ += OneEuro::alpha(OneEuro::kDerivativeHertz, seconds) * ((value - value_) / seconds - speed_);
        return value_ += OneEuro::alpha(filter.hertz + filter.reaction * std::abs(speed_), seconds) * (value - value_);
    }

private:
    double value_ = 0.0, speed_ = 0.0;
};

/// A rotation that is filtered, along the shortest way: on its logarithm.
class FilteredRotation {
public:
    void restart(const Eigen::Quaterniond& value) { value_ = value, speed_.setZero(); }
    Eigen::Quaterniond follow(const Eigen::Quaterniond& value, double seconds, const OneEuro& filter) {
        if (!(filter.hertz > 0.0)) return value_ = value;
        const Vec3 way = rotationVector(value * value_.conjugate());
        speed_ += OneEuro::alpha(OneEuro::kDerivativeHertz, seconds) * (way / seconds - speed_);
        return value_ = (rotationOf(OneEuro::alpha(filter.hertz + filter.reaction * speed_.norm(), seconds) * way) * value_).normalized();
    }

private:
    Eigen::Quaterniond value_ = Eigen::Quaterniond::Identity();
    Vec3 speed_ = Vec3::Zero();
};

}  // namespace imomushi
