// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/machine_rates.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <mutex>
#include <string>
#include <vector>

#include "core/base/clock.h"
#include "core/base/parallel.h"
#include "core/elasticity/dense_lu.h"
#include "core/elasticity/kernels.h"

namespace imomushi {

namespace {

/// What disturbs a machine lasts about a second; after so many looks one of them was quiet.
constexpr double kPause = 1.0;  // s
constexpr int kLooks = 5;

template <class Work>
double fastest(int rounds, Work work) {
    double best = 1e30;
    for (int i = 0; i < rounds; ++i) {
        const auto start = Clock::now();
        work();
        best = std::min(best, secondsSince(start));
    }
    return best;
}

MachineRates measureRates() {
    MachineRates rates{};
    // A strip of triangles, seen from points beside it.
    constexpr std::int32_t kTriangles = 512, kPoints = 32;
    TriangleMesh strip;
    strip.vertices.resize(kTriangles + 2, 3);
    strip.triangles.resize(kTriangles, 3);
    std::vector<std::int32_t> which(kTriangles), columns(kTriangles + 2);
    for (std::int32_t i = 0; i < kTriangles + 2; ++i) {
        strip.vertices.row(i) << i / 512.0, (i % 2) / 256.0, 0.1 * std::sin(i / 50.0);
        columns[static_cast<std::size_t>(i)] = i;
    }
    for (std::int32_t f = 0; f < kTriangles; ++f) {
        strip.triangles.row(f) << f, f + 1 + f % 2, f + 2 - f % 2;
        which[static_cast<std::size_t>(f)] = f;
    }
    const TriangleBatch batch(strip, which, columns);
    std::vector<double> h(9 * columns.size());
    rates.secondsPerPair = fastest(3, [&] {
                               for (std::int32_t i = 0; i < kPoints; ++i)
                                   addBlocks(batch, Vec3(i / 32.0, 0.3, 0.2), 0.3, h.data(), nullptr);
                           }) / (kTriangles * kPoints);
    rates.flops = measureProductRate();
    const std::vector<double> memory(std::size_t{2} << 20, 1.0);  // 16 MB
    volatile double sum = 0.0;
    rates.bytesPerSecond = static_cast<double>(memory.size() * sizeof(double)) / fastest(3, [&] {
                               sum = Eigen::Map<const Eigen::VectorXd>(memory.data(), static_cast<Eigen::Index>(memory.size())).sum();
                           });
    return rates;
}

}  // namespace

MachineRates machineRates() {
    static std::mutex mutex;
    static MachineRates best;
    static int looks = 0;
    static Clock::time_point last;
    const std::scoped_lock lock(mutex);
    if (looks == 0 || (looks < kLooks && secondsSince(last) > kPause)) {
        const MachineRates now = measureRates();
        best.secondsPerPair = looks == 0 ? now.secondsPerPair : std::min(best.secondsPerPair, now.secondsPerPair);
        best.flops = std::max(best.flops, now.flops);
        best.bytesPerSecond = std::max(best.bytesPerSecond, now.bytesPerSecond);
        ++looks;
        last = Clock::now();
    }
    return best;
}

namespace {

/// What the address space of this process may still grow by; without a limit more than there is.
std::size_t addressesLeft() {
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return ~std::size_t{0};
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    // OpenBLAS asks for a buffer of 128 MiB for each thread that uses it, and tries for ever where it gets none.
    const std::size_t used = pages * static_cast<std::size_t>(sysconf(_SC_PAGE_SIZE)) + (static_cast<std::size_t>(hardwareThreads()) + 1) * (std::size_t{128} << 20);
    return limit.rlim_cur > used ? limit.rlim_cur - used : 0;
}

}  // namespace

std::size_t availableMemory() {
    std::size_t free = 0;
    std::ifstream file("/proc/meminfo");
    for (std::string key; free == 0 && file >> key;)
        if (key == "MemAvailable:") file >> free;
    free *= 1024;
    if (const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGE_SIZE); free == 0)
        free = pages > 0 && size > 0 ? static_cast<std::size_t>(pages) * static_cast<std::size_t>(size) : ~std::size_t{0};
    return std::min(free, addressesLeft());
}

}  // namespace imomushi
