// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/input/input_mapper.h"

namespace imomushi {

/// Rows that let something happen, once each time when their control passes the middle of what it becomes. An answer depends on values alone. take() neither allocates, locks nor fails.
class InputTriggers {
public:
    /// A control that went up must come back by this part of its way before it can happen again: what trembles happens once.
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
