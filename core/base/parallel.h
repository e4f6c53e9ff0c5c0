// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>

#include "core/base/thread_pool.h"

namespace imomushi {

/// The number of processors of this machine, at least 1.
int hardwareThreads();

/// The threads of builders: all loops of parallelFor() share them. Frames have their own, so that they never wait for a chunk of a builder.
ThreadPool& builderPool(int threads);

/// body(begin, end) over consecutive chunks of [0, count) on up to `threads` threads (ThreadPool::run). The chunks are the same for every number of
/// threads: each has `grain` items, the last fewer.
template <class Body>
void parallelFor(int threads, std::size_t count, std::size_t grain, const Body& body) {
    grain = std::max<std::size_t>(grain, 1);
    builderPool(threads).run((count + grain - 1) / grain, [&](std::size_t c) { body(c * grain, std::min(count, (c + 1) * grain)); }, threads);
}

}  // namespace imomushi
