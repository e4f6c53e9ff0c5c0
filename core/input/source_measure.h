// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/input/input_value.h"

namespace imomushi {

/// What a source says for a while, on average: the numbers of each of its channels. Rotations of channels that say poses are averaged as rotations.
class SourceMeasure {
public:
    static constexpr std::size_t kMost = 4096;  ///< channels
    explicit SourceMeasure(std::string source) : source_(std::move(source)) {}
    /// What it said before counts only for channels that say nothing from then on: who does not move a fader sends nothing.
    void knew(const InputValue& value);
    void hear(const InputValue& value);
    /// How many values were heard.
    [[nodiscard]] std::uint64_t heard() const { return heard_; }
    [[nodiscard]] std::map<std::string, std::vector<double>> means() const;

private:
    struct Channel {
        std::array<double, InputValue::kMost> sums{};
        int numbers = 0;
        std::uint64_t count = 0;  // of values in the sums
        bool before = false;      // it said that before
        bool pose = true;         // all of them say a pose
    };
    void add(const InputValue& value, bool before);
    std::string source_;
    std::map<std::string, Channel, std::less<>> channels_;
    std::uint64_t heard_ = 0;
};

}  // namespace imomushi
