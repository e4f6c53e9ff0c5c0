// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

namespace imomushi {

/// Runs body(begin, end) over consecutive chunks of [0, count) on up to `threads` threads. The chunks are the same for every number
/// of threads (each has `grain` items, the last fewer), and each is done by one thread: a body that writes only what belongs
/// to its chunk gives the same bytes for any number of threads. Blocks until all are done. body must not throw.
void parallelFor(int threads, std::size_t count, std::size_t grain,
                 const std::function<void(std::size_t begin, std::size_t end)>& body);

/// The number of processors of this machine, at least 1.
int hardwareThreads();

}  // namespace imomushi
