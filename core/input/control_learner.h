// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "core/input/input_value.h"

namespace imomushi {

/// Finds the control that somebody moves, among all that is heard meanwhile: the number that has gone the longest way.
class ControlLearner {
public:
    /// Numbers that are followed; a body with a face has a thousand.
    static constexpr std::size_t kMost = 8192;
    struct Found {
        std::string source, channel;
        int component = 0;
        double low = 0.0, high = 0.0;  ///< the range that was seen, widened to a usual one (0...1, -1...1) if most of that was seen: low < high
        double now = 0.0;
        bool settled = false;          ///< it went a long way, and its range has not grown for a while
        bool operator==(const Found&) const = default;
    };
    void hear(const InputValue& value);
    /// `nanoseconds`: now, by the clock of the values. None: nothing has moved.
    [[nodiscard]] std::optional<Found> found(std::int64_t nanoseconds) const;

private:
    struct Number {
        double low = 0.0, high = 0.0, now = 0.0;
        std::int64_t first = 0, grown = 0;  // ns
    };
    std::map<std::pair<std::string, std::string>, std::map<int, Number>> channels_;  // by source and channel
    std::size_t count_ = 0;
    std::optional<std::int64_t> began_;  // ns, of the first value
};

}  // namespace imomushi
