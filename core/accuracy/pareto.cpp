// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/accuracy/pareto.h"

#include <algorithm>
#include <numeric>

namespace imomushi {

namespace {

/// A smaller gain in error does not count: nobody can see it.
constexpr double kGain = 0.01;

}  // namespace

std::vector<std::size_t> paretoFront(std::span<const Trade> trades) {
    std::vector<std::size_t> cheapest(trades.size()), out;
    std::iota(cheapest.begin(), cheapest.end(), std::size_t{0});
    std::erase_if(cheapest, [&](std::size_t i) { return !trades[i].known; });
    std::stable_sort(cheapest.begin(), cheapest.end(), [&](std::size_t a, std::size_t b) {
        return trades[a].cost != trades[b].cost ? trades[a].cost < trades[b].cost : trades[a].error < trades[b].error;
    });
    for (const std::size_t i : cheapest)
        if (out.empty() || trades[i].error < (1.0 - kGain) * trades[out.back()].error) out.push_back(i);
    return out;
}

std::vector<char> dominated(std::span<const Trade> trades) {
    std::vector<char> out(trades.size(), 0);
    for (std::size_t i = 0; i < trades.size(); ++i) out[i] = trades[i].known;
    for (const std::size_t i : paretoFront(trades)) out[i] = 0;
    return out;
}

}  // namespace imomushi
