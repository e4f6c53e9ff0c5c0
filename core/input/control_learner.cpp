// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/input/control_learner.h"

#include <algorithm>
#include <cmath>

#include "core/input/pose_numbers.h"

namespace imomushi {

namespace {

/// What is sent all the time is heard within this time, ns. What comes later for the first time was moved: a button says only that it is pressed.
constexpr std::int64_t kStreams = 400'000'000;
/// A range that has not grown for so long, ns, has been shown.
constexpr std::int64_t kStill = 900'000'000;
/// A way is told in parts of the size of its numbers, or of 1 where they are smaller: hands tremble less than the first, and mean it from the second on.
constexpr double kTremble = 0.02, kMeant = 0.15;
/// Growth below this part of a range is none.
constexpr double kGrowth = 0.02;
/// How much of a usual range must have been seen for a control to have that one.
constexpr double kSeen = 0.5;
constexpr std::pair<double, double> kUsual[] = {{0.0, 1.0}, {-1.0, 1.0}, {0.0, 127.0}, {0.0, 255.0}};

/// Poses of the VMC protocol have ten numbers; of these, the rotation is told twice, and one number of a quaternion alone means nothing.
bool meansNothing(const InputValue& value, int component) { return value.count == kPoseNumbers && component >= kPoseRotation && component < kPoseTurn; }

std::pair<double, double> usualRange(double low, double high) {
    for (const auto& [usualLow, usualHigh] : kUsual)
        if (low >= usualLow && high <= usualHigh && high - low >= kSeen * (usualHigh - usualLow)) return {usualLow, usualHigh};
    return {low, high};
}

}  // namespace

void ControlLearner::hear(const InputValue& value) {
    if (value.gone) return;
    const std::int64_t now = value.nanoseconds;
    if (!began_) began_ = now;
    const std::pair<std::string, std::string> name(value.source.text(), value.channel.text());
    auto channel = channels_.find(name);
    if (channel == channels_.end()) {
        if (count_ >= kMost) return;
        channel = channels_.try_emplace(name).first;
    }
    for (int k = 0; k < value.count; ++k) {
        const double number = value.numbers[static_cast<std::size_t>(k)];
        if (!InputValue::isSound(number) || meansNothing(value, k)) continue;
        const auto [at, made] = channel->second.try_emplace(k, Number{number, number, number, now, now});
        Number& known = at->second;
        count_ += made ? 1 : 0;
        known.now = number;
        const double room = kGrowth * (known.high - known.low);
        if (number < known.low - room || number > known.high + room) known.grown = now;
        known.low = std::min(known.low, number);
        known.high = std::max(known.high, number);
    }
}

std::optional<ControlLearner::Found> ControlLearner::found(std::int64_t nanoseconds) const {
    std::optional<Found> best;
    double farthest = kTremble;
    std::size_t numbersOfBest = 0;
    for (const auto& [name, numbers] : channels_)
        for (const auto& [component, number] : numbers) {
            double low = number.low, high = number.high;
            if (low == high && number.first - *began_ > kStreams) low = std::min(0.0, low), high = std::max(0.0, high);
            const double way = (high - low) / std::max({1.0, std::abs(low), std::abs(high)});
            // Of two that moved alike the one with fewer numbers is meant: a key, not the stick that it is part of.
            if (way < farthest || (way == farthest && (!best || numbers.size() >= numbersOfBest))) continue;
            farthest = way;
            numbersOfBest = numbers.size();
            const auto [from, to] = usualRange(low, high);
            best = Found{name.first, name.second, component, from, to, number.now, way >= kMeant && nanoseconds - number.grown >= kStill};
        }
    return best;
}

}  // namespace imomushi
