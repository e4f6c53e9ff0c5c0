// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/input/input_mapper.h"

namespace imomushi {

/// Rows of triggers: each fires once when the output of its curve rises through the middle of its output range. An answer depends on values alone. take() neither allocates, locks nor fails.
class InputTriggers {
public:
    /// Hysteresis: the output must fall by this part of its range before its row fires again.
    static constexpr double kBack = 0.1;

    InputTriggers() = default;
    explicit InputTriggers(std::vector<InputRow> rows);
    /// Which rows happen, by their place; until the next call. Those that are muted never do.
    std::span<const std::size_t> take(const InputValue& value);
    /// raw, value, heard and known of a row; it drives while it is up.
    [[nodiscard]] const InputMeter& meter(std::size_t row) const { return meters_[row]; }
    [[nodiscard]] const std::vector<InputRow>& rows() const { return rows_; }

private:
    std::vector<InputRow> rows_;
    std::vector<InputName> sources_, channels_;
    std::vector<InputMeter> meters_;
    std::vector<std::size_t> happen_;
};

}  // namespace imomushi
