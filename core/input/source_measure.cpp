// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/input/source_measure.h"

#include <algorithm>
#include <cmath>

#include "core/base/rotation_vector.h"
#include "core/input/pose_numbers.h"

namespace imomushi {

namespace {

bool saysPose(const InputValue& value) { return imomushi::saysPose(std::span(value.numbers).first(static_cast<std::size_t>(value.count))); }

}  // namespace

void SourceMeasure::knew(const InputValue& value) { add(value, true); }

void SourceMeasure::hear(const InputValue& value) { add(value, false); }

void SourceMeasure::add(const InputValue& value, bool before) {
    if (value.source.text() != source_ || value.count < 1) return;
    auto found = channels_.find(value.channel.text());
    if (value.gone) {
        if (found != channels_.end()) channels_.erase(found);
        return;
    }
    if (found == channels_.end()) {
        if (channels_.size() >= kMost) return;
        found = channels_.try_emplace(std::string(value.channel.text())).first;
    }
    heard_ += before ? 0 : 1;
    Channel& channel = found->second;
    // What is of another size now is another thing.
    if (channel.count == 0 || channel.before || channel.numbers != value.count) channel = Channel{{}, value.count, 0, before, true};
    channel.pose = channel.pose && saysPose(value);
    // A rotation and its negative are the same.
    const bool turned = saysPose(value) && rotationIn(value.numbers).dot(rotationIn(channel.sums)) < 0.0;
    for (int k = 0; k < value.count; ++k) {
        const auto at = static_cast<std::size_t>(k);
        channel.sums[at] += turned && k >= kPoseRotation && k < kPoseTurn ? -value.numbers[at] : value.numbers[at];
    }
    ++channel.count;
}

std::map<std::string, std::vector<double>> SourceMeasure::means() const {
    std::map<std::string, std::vector<double>> made;
    for (const auto& [name, channel] : channels_) {
        std::vector<double>& numbers = made[name];
        for (int k = 0; k < channel.numbers; ++k) numbers.push_back(channel.sums[static_cast<std::size_t>(k)] / static_cast<double>(channel.count));
        if (!channel.pose) continue;
        const Eigen::Quaterniond q = Eigen::Quaterniond(numbers[kPoseRotation + 3], numbers[kPoseRotation], numbers[kPoseRotation + 1], numbers[kPoseRotation + 2]).normalized();
        const Vec3 v = rotationVector(q);
        for (int k = 0; k < 4; ++k) numbers[static_cast<std::size_t>(kPoseRotation + k)] = q.coeffs()[k];
        for (int k = 0; k < 3; ++k) numbers[static_cast<std::size_t>(kPoseTurn + k)] = v[k];
    }
    return made;
}

}  // namespace imomushi
