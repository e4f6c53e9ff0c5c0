// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/input/input_triggers.h"

#include <utility>

namespace imomushi {

InputTriggers::InputTriggers(std::vector<InputRow> rows) : rows_(std::move(rows)), meters_(rows_.size()) {
    for (const InputRow& row : rows_) {
        sources_.emplace_back(row.source);
        channels_.emplace_back(row.channel);
    }
    happen_.reserve(rows_.size());
}

std::span<const std::size_t> InputTriggers::take(const InputValue& value) {
    happen_.clear();
    for (std::size_t r = 0; r < rows_.size(); ++r) {
        if (!(value.channel == channels_[r]) || !(value.source == sources_[r])) continue;
        const InputRow& row = rows_[r];
        InputMeter& meter = meters_[r];
        if (value.gone) {
            meter.drives = false;
            meter.silent = true;
            continue;
        }
        if (row.component < 0 || row.component >= value.count || !InputValue::isSound(value.numbers[static_cast<std::size_t>(row.component)])) continue;
        meter.raw = value.numbers[static_cast<std::size_t>(row.component)];
        meter.value = row.curve.at(meter.raw);
        meter.known = true;
        meter.silent = false;
        ++meter.heard;
        const double way = row.curve.outHigh - row.curve.outLow, up = way != 0.0 ? (meter.value - row.curve.outLow) / way : 0.0;
        // What becomes less when the control goes up happens when it goes down.
        const double part = way < 0.0 ? 1.0 - up : up;
        if (row.muted || part < 0.5 - kBack) meter.drives = false;
        else if (part > 0.5 && !std::exchange(meter.drives, true)) happen_.push_back(r);
    }
    return happen_;
}

}  // namespace imomushi
