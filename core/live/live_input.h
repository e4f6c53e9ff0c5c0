// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/document/document.h"

namespace imomushi {

/// Where something that is held already is to be from the next step on, how much of a morph target is seen, or a number of an effect: what a hand, or any other device, gives a performance while it
/// goes on.
struct LiveInput {
    enum class Kind : std::uint8_t { End, Handle, Morph, Effect } kind = Kind::End;
    EndpointRef end;          ///< of a bone
    int handle = -1;          ///< index in the character's plan
    MorphRef morph;
    Vec3 target = Vec3::Zero();  ///< m, world
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< of a handle, unit, world
    double roll = 0.0;        ///< radians, of an end
    bool hasRoll = false;     ///< false: it keeps its own
    EffectKind effect = EffectKind::kCount;
    int value = 0;            ///< which of Effect::values
    double weight = 0.0;      ///< of a morph target; the number of an effect, in its unit
    /// It is a number that is set, not something that is held in space.
    [[nodiscard]] bool isNumber() const { return kind == Kind::Morph || kind == Kind::Effect; }
    [[nodiscard]] bool sameTarget(const LiveInput& o) const {
        if (kind != o.kind) return false;
        switch (kind) {
            case Kind::End: return end == o.end;
            case Kind::Handle: return handle == o.handle;
            case Kind::Morph: return morph == o.morph;
            case Kind::Effect: return effect == o.effect && value == o.value;
        }
        return false;
    }
};

/// The property of an effect that an input sets, and where it begins in Effect::values.
std::pair<const EffectProperty&, int> propertyOf(const LiveInput& input);

/// When an input came: steady_clock, ns; 0: none did.
using InputTime = std::int64_t;
inline InputTime inputTime() { return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count(); }
/// The one that came first, of two of which each may be none.
inline InputTime firstOf(InputTime a, InputTime b) { return a == 0 || (b != 0 && b < a) ? b : a; }

/// Inputs on their way from one thread to another one, in order. Neither waits, and nothing is allocated.
class LiveInputs {
public:
    static constexpr std::size_t kRoom = 1024;
    /// The giving thread. False: there is no room, as nobody takes any.
    bool give(const LiveInput& input) {
        const std::size_t end = end_.load(std::memory_order_relaxed);
        if (end - begin_.load(std::memory_order_acquire) == kRoom) return false;
        inputs_[end % kRoom] = {input, inputTime()};
        end_.store(end + 1, std::memory_order_release);
        return true;
    }
    [[nodiscard]] bool empty() const { return begin_.load(std::memory_order_acquire) == end_.load(std::memory_order_acquire); }
    /// Forgets all, while no other thread takes or gives.
    void clear() { begin_.store(end_.load(std::memory_order_relaxed), std::memory_order_relaxed); }
    struct Given {
        LiveInput input;
        InputTime came = 0;
    };
    /// The taking thread. False: there is none.
    bool take(Given& given) {
        const std::size_t begin = begin_.load(std::memory_order_relaxed);
        if (begin == end_.load(std::memory_order_acquire)) return false;
        given = inputs_[begin % kRoom];
        begin_.store(begin + 1, std::memory_order_release);
        return true;
    }

private:
    std::array<Given, kRoom> inputs_;
    std::atomic<std::size_t> begin_{0}, end_{0};  // how many were taken and given
};

}  // namespace imomushi
