// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/base/thread_pool.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <map>
#include <utility>

namespace imomushi {

namespace {

/// A worker looks for work this long before it sleeps: the loops of one frame follow each other within less.
constexpr auto kAwake = std::chrono::microseconds(50);
/// A caller looks this often whether its helpers have finished before it sleeps: about as long.
constexpr int kLooks = 2000;

constexpr std::uint32_t kInside = 0xffff;
constexpr std::uint32_t kSeat = kInside + 1;

thread_local bool insideLoop = false;

}  // namespace

ThreadPool::ThreadPool(int threads) { grow(threads); }

ThreadPool::~ThreadPool() {
    closing_.store(true);
    calls_.fetch_add(1);
    calls_.notify_all();
    for (auto& worker : workers_) worker.join();
}

std::shared_ptr<ThreadPool> ThreadPool::shared(int threads) {
    static std::mutex guard;
    static auto& pools = *new std::map<int, std::weak_ptr<ThreadPool>>;  // never destroyed: characters may outlive the end of main
    const std::lock_guard lock(guard);
    std::erase_if(pools, [](const auto& entry) { return entry.second.expired(); });
    auto& known = pools[threads];
    auto pool = known.lock();
    if (!pool) known = pool = std::make_shared<ThreadPool>(threads);
    return pool;
}

void ThreadPool::grow(int threads) {
    threads = std::min(threads, kMaxThreads);
    if (this->threads() >= threads) return;
    const std::lock_guard lock(growing_);
    workers_.reserve(static_cast<std::size_t>(threads) - 1);
    while (this->threads() < threads) {
        try {
            workers_.emplace_back([this] { serve(); });
        } catch (const std::exception&) {
            return;  // the system gives no more: loops run with those that there are
        }
        workerCount_.fetch_add(1, std::memory_order_relaxed);
    }
}

bool ThreadPool::runShared(std::size_t count, int threads, Job job, const void* body) {
    const std::size_t most = static_cast<std::size_t>(std::clamp(std::min(threads, this->threads()), 1, kMaxThreads)) - 1;
    if (most == 0 || count < 2 || insideLoop) return false;
    const auto free = std::find_if(loops_.begin(), loops_.end(), [](Loop& l) { return !l.taken.load(std::memory_order_relaxed) && !l.taken.exchange(true, std::memory_order_acquire); });
    if (free == loops_.end()) return false;
    Loop& loop = *free;
    loop.count = loop.failedChunk = count;
    loop.job = job;
    loop.body = body;
    std::fegetenv(&loop.environment);
    loop.next.store(0, std::memory_order_relaxed);
    loop.gate.store(static_cast<std::uint32_t>(std::min(most, count - 1)) * kSeat, std::memory_order_release);
    calls_.fetch_add(1, std::memory_order_release);
    calls_.notify_all();

    insideLoop = true;
    loop.work();
    insideLoop = false;
    // All chunks have begun. Nobody enters any more; those inside finish theirs.
    std::uint32_t inside = loop.gate.fetch_and(kInside, std::memory_order_acq_rel) & kInside;
    for (int looks = 0; inside != 0; inside = loop.gate.load(std::memory_order_acquire)) {
        if (++looks < kLooks)
            hwy::Pause();
        else
            loop.gate.wait(inside, std::memory_order_acquire);
    }
    std::exception_ptr failure = std::exchange(loop.failure, nullptr);
    loop.taken.store(false, std::memory_order_release);
    if (failure) std::rethrow_exception(std::move(failure));
    return true;
}

void ThreadPool::Loop::work() {
    for (std::size_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < count;) {
        try {
            job(body, i);
        } catch (...) {
            // Chunks before this one have begun, so that the first that throws is always among those that come here.
            next.store(count, std::memory_order_relaxed);
            const std::lock_guard lock(failing);
            if (i >= failedChunk) continue;
            failedChunk = i;
            failure = std::current_exception();
        }
    }
}

bool ThreadPool::help() {
    for (Loop& loop : loops_) {
        std::uint32_t gate = loop.gate.load(std::memory_order_acquire);
        while (gate >= kSeat && !loop.gate.compare_exchange_weak(gate, gate - kSeat + 1, std::memory_order_acq_rel, std::memory_order_acquire)) {
        }
        if (gate < kSeat) continue;
        std::fesetenv(&loop.environment);
        loop.work();
        if (loop.gate.fetch_sub(1, std::memory_order_acq_rel) == 1) loop.gate.notify_one();
        return true;
    }
    return false;
}

void ThreadPool::serve() {
    insideLoop = true;
    while (!closing_.load(std::memory_order_acquire)) {
        const std::uint32_t calls = calls_.load(std::memory_order_acquire);
        auto until = std::chrono::steady_clock::now() + kAwake;
        do {
            while (help()) until = std::chrono::steady_clock::now() + kAwake;
            hwy::Pause();
        } while (std::chrono::steady_clock::now() < until);
        if (!closing_.load(std::memory_order_acquire)) calls_.wait(calls, std::memory_order_acquire);
    }
}

}  // namespace imomushi
