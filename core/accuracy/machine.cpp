// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/accuracy/machine.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <mutex>
#include <numeric>
#include <thread>
#include <vector>

#include "core/base/clock.h"
#include "core/base/parallel.h"

namespace imomushi {

namespace {


constexpr double kRateSeconds = 0.5, kMin = 0.1;  // less does not last as long as a precompute
constexpr int kWorkRounds = 20'000;  // of a block of work: some tenths of a millisecond, much less than a time slice of the scheduler


}  // namespace

std::string machineName() {
    static const std::string name = [] {
        std::ifstream file("/proc/cpuinfo");
        for (std::string line; std::getline(file, line);)
            if (line.starts_with("model name"))
                if (const auto colon = line.find(": "); colon != std::string::npos) return line.substr(colon + 2) + ", " + std::to_string(hardwareThreads()) + " threads";
        return std::to_string(hardwareThreads()) + " threads";
    }();
    return name;
}

double machineShare(int threads) {
    threads = std::clamp(threads, 1, hardwareThreads());
    std::mutex mutex;
    double blocks = 0.0, fastest = 1e9;
    const auto begin = Clock::now();
    const auto work = [&] {
        std::array<double, 16> x{};
        volatile double sum = 0.0;  // keeps the work where it is timed
        double done = 0.0, best = 1e9;
        while (secondsSince(begin) < kRateSeconds) {
            const auto start = Clock::now();
            for (int round = 0; round < kWorkRounds; ++round)
                for (double& value : x) value = 0.999 * value + 1.0;
            sum = std::accumulate(x.begin(), x.end(), 0.0);
            best = std::min(best, secondsSince(start));
            ++done;
        }
        (void)sum;
        const std::scoped_lock lock(mutex);
        blocks += done;
        fastest = std::min(fastest, best);
    };
    {
        std::vector<std::jthread> others;
        for (int i = 1; i < threads; ++i) others.emplace_back(work);
        work();
    }
    return std::clamp(blocks * fastest / (threads * secondsSince(begin)), kMin, 1.0);
}

}  // namespace imomushi
