// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

namespace imomushi {

/// Threads that help the thread of a frame with its loops: they wait for work without a lock, and neither start nor end in a frame.
/// A loop ends when all its chunks are done; it never waits for a helper that has not begun.
class FrameCrew {
public:
    /// threads: of a loop, the caller's included. One: no helpers.
    explicit FrameCrew(int threads);
    ~FrameCrew();
    FrameCrew(const FrameCrew&) = delete;
    FrameCrew& operator=(const FrameCrew&) = delete;

    [[nodiscard]] int threads() const { return static_cast<int>(helpers_.size()) + 1; }

    /// body(chunk) for all chunks in [0, count), in any order, on this thread and the helpers. A body that writes only what belongs to its
    /// chunk gives the same bytes for any number of threads. Does not allocate; body must not throw. One caller at a time.
    template <class Body>
    void run(std::size_t count, const Body& body) {
        if (helpers_.empty() || count < 2 || count > kMostChunks) {
            for (std::size_t i = 0; i < count; ++i) body(i);
            return;
        }
        runShared(static_cast<std::uint32_t>(count), [](const void* b, std::size_t i) { (*static_cast<const Body*>(b))(i); }, &body);
    }

private:
    using Job = void (*)(const void*, std::size_t);
    static constexpr std::size_t kMostChunks = (1u << 20) - 1;

    void runShared(std::uint32_t count, Job job, const void* body);
    bool workOnce();
    void help();

    // 24 bits: which loop; 20: its chunks; 20: the next chunk. A helper owns a chunk by changing this, so it can never take one of a loop that is over.
    std::atomic<std::uint64_t> state_{0};
    std::atomic<std::uint32_t> finished_{0}, calls_{0};
    std::atomic<bool> closing_{false};
    Job job_ = nullptr;
    const void* body_ = nullptr;
    std::vector<std::thread> helpers_;
};

}  // namespace imomushi
