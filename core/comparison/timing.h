// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "core/base/progress.h"

namespace imomushi {

/// Runs several loops in turn, so that what disturbs the machine disturbs all: the median of each, in milliseconds. Each runs twice and the second time
/// counts: its data are in the caches as far as they fit, as in a program that draws little else. At least a few rounds, then until
/// `rounds` are done, `seconds` are over, or `progress` is cancelled.
std::vector<double> mediansInTurn(int rounds, double seconds, const std::vector<std::function<void()>>& loops, const Progress& progress = {});

struct Spread {
    double median = 0.0, p99 = 0.0;  ///< ms
};
/// The same, and the 99th percentile of each loop beside its median, of only those stretches of time in which nothing else disturbed the machine: quietOf(). Runs for
/// `seconds`.
std::vector<Spread> quietSpreads(double seconds, const std::vector<std::function<void()>>& loops, const Progress& progress = {});
/// Of the times of loops that ran in turn (ms, as many of each): those of the quarter of stretches in which the first loop, which calibrates, was quickest.
std::vector<Spread> quietOf(const std::vector<std::vector<double>>& times);

}  // namespace imomushi
