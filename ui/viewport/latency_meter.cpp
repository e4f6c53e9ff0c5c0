// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/latency_meter.h"

#include <algorithm>

namespace imomushi {
namespace {

constexpr InputTime kAnswerNs = 500'000'000;

}  // namespace

void LatencyMeter::moved(InputTime came, InputTime given) {
    if (move_.given <= followed_) move_ = {came, given};
}

void LatencyMeter::shows(InputTime input) {
    if (input <= followed_) return;
    followed_ = input;
    const bool byMove = move_.given != 0 && move_.came <= input && input <= move_.given;
    shown_ = firstOf(shown_, byMove ? move_.came : input);
}

std::optional<LatencyMeter::Latency> LatencyMeter::swapped(InputTime now) {
    if (painted_ == 0) return std::nullopt;
    ms_[count_++ % kKept] = 1e-6 * static_cast<double>(now - painted_);
    painted_ = 0;
    if (now - answered_ < kAnswerNs) return std::nullopt;
    answered_ = now;
    return latency();
}

std::optional<LatencyMeter::Latency> LatencyMeter::latency() const {
    const std::size_t count = std::min(count_, kKept);
    if (count == 0) return std::nullopt;
    std::array<double, kKept> sorted = ms_;
    const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(count);
    std::sort(sorted.begin(), end);
    return Latency{sorted[count / 2], sorted[std::min(count - 1, count * 99 / 100)], count};
}

}  // namespace imomushi
