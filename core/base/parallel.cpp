// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/base/parallel.h"

#include <thread>

namespace imomushi {

int hardwareThreads() {
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

ThreadPool& builderPool(int threads) {
    static auto& pool = *new ThreadPool(1);  // never destroyed: a builder may still be in a loop when main ends
    pool.grow(threads);
    return pool;
}

}  // namespace imomushi
