// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/comparison/timing.h"

#include <algorithm>
#include <chrono>

namespace imomushi {

namespace {
constexpr int kLeastRounds = 5, kWarmRounds = 2;
}

std::vector<Spread> spreadsInTurn(int rounds, double seconds, const std::vector<std::function<void()>>& loops, const Progress& progress) {
    using Clock = std::chrono::steady_clock;
    const auto since = [](Clock::time_point from) { return std::chrono::duration<double>(Clock::now() - from).count(); };
    std::vector<std::vector<double>> times(loops.size());
    const auto begin = Clock::now();
    for (int r = 0; r < std::max(rounds, kLeastRounds) + kWarmRounds; ++r) {
        if (progress.cancelled() || (r >= kLeastRounds + kWarmRounds && since(begin) > seconds)) break;
        for (std::size_t i = 0; i < loops.size(); ++i) {
            loops[i]();
            const auto start = Clock::now();
            loops[i]();
            if (r >= kWarmRounds) times[i].push_back(1e3 * since(start));
        }
    }
    std::vector<Spread> out;
    for (auto& t : times) {
        if (t.empty()) t.push_back(0.0);
        std::sort(t.begin(), t.end());
        out.push_back({t[t.size() / 2], t[(99 * (t.size() - 1) + 50) / 100]});
    }
    return out;
}

std::vector<double> mediansInTurn(int rounds, double seconds, const std::vector<std::function<void()>>& loops, const Progress& progress) {
    std::vector<double> out;
    for (const Spread& s : spreadsInTurn(rounds, seconds, loops, progress)) out.push_back(s.median);
    return out;
}

}  // namespace imomushi
