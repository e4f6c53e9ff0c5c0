// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <atomic>

namespace imomushi {

/// One thread writes values, another one reads the latest; neither waits, and a value that is being read stays as it is. Three slots: the writer's, the
/// reader's, and the one in between that both exchange.
template <class T>
class TripleBuffer {
public:
    /// Writer: the slot to fill next. It holds an older value, whose memory can be used again.
    [[nodiscard]] T& back() { return slots_[back_]; }
    /// Writer: back() is the latest from now on.
    void publish() { back_ = between_.exchange(back_ | kFresh, std::memory_order_acq_rel) & kSlot; }

    /// Reader: front() becomes the latest. False: it was already.
    bool take() {
        if ((between_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
        front_ = between_.exchange(front_, std::memory_order_acq_rel) & kSlot;
        return true;
    }
    [[nodiscard]] const T& front() const { return slots_[front_]; }

    /// All slots, while no other thread writes or reads.
    [[nodiscard]] std::array<T, 3>& allSlots() { return slots_; }

private:
    static constexpr unsigned kSlot = 3, kFresh = 4;
    std::array<T, 3> slots_;
    unsigned back_ = 0, front_ = 1;
    std::atomic<unsigned> between_{2};
};

}  // namespace imomushi
