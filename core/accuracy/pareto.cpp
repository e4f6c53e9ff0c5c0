// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/accuracy/pareto.h"

#include <algorithm>

namespace imomushi {

std::vector<char> dominated(std::span<const Trade> trades) {
    std::vector<char> out(trades.size(), 0);
    for (std::size_t i = 0; i < trades.size(); ++i)
        for (std::size_t k = 0; k < trades.size() && trades[i].known; ++k)
            if (trades[k].known && trades[k].cost <= trades[i].cost && trades[k].error <= trades[i].error &&
                (trades[k].cost < trades[i].cost || trades[k].error < trades[i].error))
                out[i] = 1;
    return out;
}

std::vector<std::size_t> paretoFront(std::span<const Trade> trades) {
    const std::vector<char> worse = dominated(trades);
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < trades.size(); ++i) {
        const auto same = [&](std::size_t k) { return trades[k].cost == trades[i].cost && trades[k].error == trades[i].error; };
        if (trades[i].known && !worse[i] && std::none_of(out.begin(), out.end(), same)) out.push_back(i);
    }
    std::sort(out.begin(), out.end(), [&](std::size_t a, std::size_t b) { return trades[a].cost < trades[b].cost; });
    return out;
}

}  // namespace imomushi
