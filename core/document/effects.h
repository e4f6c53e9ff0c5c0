// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// Identity of a part within one document; never used again after the part is gone. 0: none.
using PartId = std::uint64_t;

/// What a scene may ask for beyond the static pose (model.md section 6). All are off until they are enabled; one that is off has no state, no columns
/// and no row in the statistics.
enum class EffectKind { BoneDynamics, SmoothJoints, BendWarp, JointDynamics, PreviousModel, Gravity, Inflate, Touch, Ground };

/// Names of effects by kind: elements and bones cannot have them, so that one name says what a command means.
inline constexpr std::array<std::string_view, 9> kEffectNames = {
    "bone-dynamics", "smooth-joints", "bend-warp", "joint-dynamics", "previous-model", "gravity", "inflate", "touch", "ground"};
inline constexpr std::size_t kEffects = kEffectNames.size();

/// Nullopt: there is no such effect.
std::optional<EffectKind> effectNamed(std::string_view name);
inline std::string_view effectName(EffectKind kind) { return kEffectNames[static_cast<std::size_t>(kind)]; }

/// A setting of an effect: one number, or a vector of three within the same range.
struct EffectProperty {
    std::string_view name;
    std::string_view unit;  ///< "Hz", "s", "m", "m/s^2", "Pa"; empty: a ratio
    double low = 0.0, high = 1.0;
    std::array<double, 3> initial = {0.0, 0.0, 0.0};
    int size = 1;           ///< 1 or 3
    std::string_view help;  ///< English, one clause
};

/// In a fixed order: that of Effect::values.
std::span<const EffectProperty> effectProperties(EffectKind kind);
/// Whether the effect can be asked for on some elements alone.
bool isOfElements(EffectKind kind);

struct Effect {
    bool enabled = false;
    std::set<PartId> elements;   ///< on these alone; empty: on all
    std::vector<double> values;  ///< of effectProperties(), vectors as three numbers
    bool operator==(const Effect&) const = default;
};

/// The effects of a document with their settings, which stay while an effect is off.
class Effects {
public:
    Effects();

    [[nodiscard]] const Effect& operator[](EffectKind kind) const { return all_[static_cast<std::size_t>(kind)]; }
    Effect& operator[](EffectKind kind) { return all_[static_cast<std::size_t>(kind)]; }
    [[nodiscard]] bool has(EffectKind kind) const { return (*this)[kind].enabled; }
    /// Enabled, and on this element.
    [[nodiscard]] bool has(EffectKind kind, PartId element) const;

    /// The value of a property that exists.
    [[nodiscard]] double number(EffectKind kind, std::string_view property) const;
    [[nodiscard]] Vec3 vector(EffectKind kind, std::string_view property) const;
    /// Where the values of a property begin in Effect::values, -1: there is no such property.
    static int place(EffectKind kind, std::string_view property);

    bool operator==(const Effects&) const = default;

private:
    std::array<Effect, kEffects> all_;
};

}  // namespace imomushi
