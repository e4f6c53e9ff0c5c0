// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace imomushi {

void parallelFor(int threads, std::size_t count, std::size_t grain,
                 const std::function<void(std::size_t, std::size_t)>& body) {
    grain = std::max<std::size_t>(grain, 1);
    const std::size_t chunks = (count + grain - 1) / grain;
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        for (std::size_t c; (c = next.fetch_add(1, std::memory_order_relaxed)) < chunks;)
            body(c * grain, std::min(count, (c + 1) * grain));
    };
    const std::size_t helpers = std::min<std::size_t>(std::max(threads, 1), chunks);
    std::vector<std::jthread> crew;
    for (std::size_t i = 1; i < helpers; ++i) crew.emplace_back(work);
    work();
}

int hardwareThreads() {
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace imomushi
