// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <cstdint>
#include <utility>

#include "core/document/document.h"

namespace imomushi {

/// One input of a hand or of a device, for the next step: the target of a bone end or handle that is held, the weight of a morph target, or the value of an effect's property.
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

}  // namespace imomushi
