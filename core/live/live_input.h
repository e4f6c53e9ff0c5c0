// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <atomic>
#include <cstddef>

#include "core/document/document.h"

namespace imomushi {

/// Where something that is held already is to be from the next step on: what a hand, or any other device, gives a performance while it goes on.
struct LiveInput {
    EndpointRef end;          ///< of a bone, where `handle` is -1
    int handle = -1;          ///< index in the character's plan
    Vec3 target = Vec3::Zero();  ///< m, world
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< of a handle, unit, world
    double roll = 0.0;        ///< radians, of an end
    bool hasRoll = false;     ///< false: it keeps its own
    [[nodiscard]] bool sameTarget(const LiveInput& o) const { return handle == o.handle && (handle >= 0 || end == o.end); }
};

/// Inputs on their way from one thread to another one, in order. Neither waits, and nothing is allocated.
class LiveInputs {
public:
    static constexpr std::size_t kRoom = 1024;
    /// The giving thread. False: there is no room, as nobody takes any.
    bool give(const LiveInput& input) {
        const std::size_t end = end_.load(std::memory_order_relaxed);
        if (end - begin_.load(std::memory_order_acquire) == kRoom) return false;
        inputs_[end % kRoom] = input;
        end_.store(end + 1, std::memory_order_release);
        return true;
    }
    [[nodiscard]] bool empty() const { return begin_.load(std::memory_order_acquire) == end_.load(std::memory_order_acquire); }
    /// Forgets all, while no other thread takes or gives.
    void clear() { begin_.store(end_.load(std::memory_order_relaxed), std::memory_order_relaxed); }
    /// The taking thread. False: there is none.
    bool take(LiveInput& input) {
        const std::size_t begin = begin_.load(std::memory_order_relaxed);
        if (begin == end_.load(std::memory_order_acquire)) return false;
        input = inputs_[begin % kRoom];
        begin_.store(begin + 1, std::memory_order_release);
        return true;
    }

private:
    std::array<LiveInput, kRoom> inputs_;
    std::atomic<std::size_t> begin_{0}, end_{0};  // how many were taken and given
};

}  // namespace imomushi
