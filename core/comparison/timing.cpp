// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/comparison/timing.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/base/clock.h"

namespace imomushi {

namespace {

constexpr int kMinRounds = 5, kWarmRounds = 2;
/// Rounds of a stretch: short against a disturbance of the machine, and enough for a median.
constexpr std::size_t kStretch = 15;
constexpr std::size_t kQuietShare = 4;  // one stretch in so many counts

/// Times of all rounds, ms. At least a few, then for as long as `more` wants; none where nobody wants the result.
std::vector<std::vector<double>> timesInTurn(const std::vector<std::function<void()>>& loops, const Progress& progress, const std::function<bool(int rounds)>& more) {
    std::vector<std::vector<double>> times(loops.size());
    for (int r = 0; !progress.cancelled() && (r < kMinRounds + kWarmRounds || more(r - kWarmRounds)); ++r)
        for (std::size_t i = 0; i < loops.size(); ++i) {
            loops[i]();
            const auto start = Clock::now();
            loops[i]();
            if (r >= kWarmRounds) times[i].push_back(1e3 * secondsSince(start));
        }
    return times;
}

Spread spreadOf(std::vector<double> times) {
    if (times.empty()) return {};
    std::sort(times.begin(), times.end());
    return {times[times.size() / 2], times[(99 * (times.size() - 1) + 50) / 100]};
}

}  // namespace

std::vector<Spread> quietSpreads(double seconds, const std::vector<std::function<void()>>& loops, const Progress& progress) {
    const auto begin = Clock::now();
    return quietOf(timesInTurn(loops, progress, [&](int) { return secondsSince(begin) < seconds; }));
}

std::vector<Spread> quietOf(const std::vector<std::vector<double>>& times) {
    const std::size_t stretches = std::max<std::size_t>(1, times[0].size() / kStretch);
    const auto stretch = [&](std::size_t loop, std::size_t s) {
        const auto first = times[loop].begin() + static_cast<std::ptrdiff_t>(std::min(s * kStretch, times[loop].size()));
        return std::vector<double>(first, s + 1 < stretches ? first + kStretch : times[loop].end());
    };
    std::vector<std::pair<double, std::size_t>> quickest;
    for (std::size_t s = 0; s < stretches; ++s) quickest.emplace_back(spreadOf(stretch(0, s)).median, s);
    std::sort(quickest.begin(), quickest.end());
    quickest.resize((stretches + kQuietShare - 1) / kQuietShare);
    std::vector<Spread> out;
    for (std::size_t loop = 0; loop < times.size(); ++loop) {
        std::vector<double> kept;
        for (const auto& [median, s] : quickest) {
            const auto some = stretch(loop, s);
            kept.insert(kept.end(), some.begin(), some.end());
        }
        out.push_back(spreadOf(std::move(kept)));
    }
    return out;
}

std::vector<double> mediansInTurn(int rounds, double seconds, const std::vector<std::function<void()>>& loops, const Progress& progress) {
    const auto begin = Clock::now();
    std::vector<double> out;
    for (auto& times : timesInTurn(loops, progress, [&](int done) { return done < rounds && secondsSince(begin) < seconds; })) out.push_back(spreadOf(std::move(times)).median);
    return out;
}

}  // namespace imomushi
