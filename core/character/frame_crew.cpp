// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/frame_crew.h"

#include <hwy/cache_control.h>

#include <chrono>

namespace imomushi {

namespace {

// A helper looks for more work this long before it sleeps: the loops of one frame follow each other within less.
constexpr auto kAwake = std::chrono::microseconds(50);

constexpr std::uint64_t packed(std::uint64_t loop, std::uint64_t count, std::uint64_t next) { return loop << 40 | count << 20 | next; }
constexpr std::uint64_t kChunkMask = (1u << 20) - 1;

}  // namespace

FrameCrew::FrameCrew(int threads) {
    for (int i = 1; i < threads; ++i) helpers_.emplace_back([this] { help(); });
}

FrameCrew::~FrameCrew() {
    closing_.store(true);
    calls_.fetch_add(1);
    calls_.notify_all();
    for (auto& h : helpers_) h.join();
}

void FrameCrew::runShared(std::uint32_t count, Job job, const void* body) {
    job_ = job;
    body_ = body;
    finished_.store(0, std::memory_order_relaxed);
    const std::uint64_t loop = (state_.load(std::memory_order_relaxed) >> 40) + 1;
    state_.store(packed(loop, count, 0), std::memory_order_release);
    calls_.fetch_add(1, std::memory_order_release);
    calls_.notify_all();
    while (workOnce()) {
    }
    for (int i = 0; finished_.load(std::memory_order_acquire) != count; ++i) {
        hwy::Pause();
        if (i > 2000) std::this_thread::yield();
    }
}

bool FrameCrew::workOnce() {
    std::uint64_t seen = state_.load(std::memory_order_acquire);
    for (;;) {
        const std::uint64_t next = seen & kChunkMask, count = seen >> 20 & kChunkMask;
        if (next >= count) return false;
        if (!state_.compare_exchange_weak(seen, seen + 1, std::memory_order_acq_rel, std::memory_order_acquire)) continue;
        // The loop cannot end before this chunk is done, so its job is still there.
        job_(body_, next);
        finished_.fetch_add(1, std::memory_order_release);
        return true;
    }
}

void FrameCrew::help() {
    while (!closing_.load(std::memory_order_acquire)) {
        const std::uint32_t calls = calls_.load(std::memory_order_acquire);
        auto until = std::chrono::steady_clock::now() + kAwake;
        while (std::chrono::steady_clock::now() < until) {
            while (workOnce()) until = std::chrono::steady_clock::now() + kAwake;
            hwy::Pause();
        }
        if (!closing_.load(std::memory_order_acquire)) calls_.wait(calls, std::memory_order_acquire);
    }
}

}  // namespace imomushi
