// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>

namespace imomushi {

/// A queue between two threads, one that produces and one that consumes. Neither waits, and nothing is allocated after the beginning.
template <class Thing, std::size_t room>
class SpscQueue {
public:
    // ---- the producing thread
    [[nodiscard]] std::size_t free() const { return room - (pushed_ - popped_.load(std::memory_order_acquire)); }
    /// Where free() > 0. The other thread sees it after publish().
    void push(const Thing& thing) { (*things_)[pushed_++ % room] = thing; }
    void publish() { published_.store(pushed_, std::memory_order_release); }

    // ---- the consuming thread
    /// The oldest that is published. Null: there is none.
    [[nodiscard]] const Thing* front() const {
        const std::size_t at = popped_.load(std::memory_order_relaxed);
        return at == published_.load(std::memory_order_acquire) ? nullptr : &(*things_)[at % room];
    }
    void pop() { popped_.store(popped_.load(std::memory_order_relaxed) + 1, std::memory_order_release); }

    // ---- any thread
    [[nodiscard]] bool empty() const { return popped_.load(std::memory_order_acquire) == published_.load(std::memory_order_acquire); }
    /// While no thread produces or consumes.
    void clear() { popped_.store(published_.load(std::memory_order_relaxed), std::memory_order_relaxed); }

private:
    std::unique_ptr<std::array<Thing, room>> things_ = std::make_unique<std::array<Thing, room>>();
    std::size_t pushed_ = 0;  // of the producing thread
    std::atomic<std::size_t> published_{0}, popped_{0};
};

}  // namespace imomushi
