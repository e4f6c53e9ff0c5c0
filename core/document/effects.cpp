// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/effects.h"

#include <algorithm>
#include <cassert>

namespace imomushi {

namespace {

constexpr std::array<double, 3> one(double x) { return {x, 0.0, 0.0}; }

// Frequencies and ratios as in BoneSpring and JointDynamics.
constexpr EffectProperty kBoneDynamics[] = {
    {"stretch-hertz", "Hz", 0.01, 1000.0, one(5.0), 1, "how fast bones swing in their length"},
    {"stretch-damping", "", 0.0, 10.0, one(0.4), 1, "damping ratio of their length"},
    {"swing-hertz", "Hz", 0.01, 1000.0, one(2.5), 1, "how fast the angles between bones swing"},
    {"swing-damping", "", 0.0, 10.0, one(0.3), 1, "damping ratio of the angles"},
    {"roll-hertz", "Hz", 0.01, 1000.0, one(3.0), 1, "how fast bones swing about themselves"},
    {"roll-damping", "", 0.0, 10.0, one(0.3), 1, "damping ratio of that"},
    {"return-hertz", "Hz", 0.0, 1000.0, one(0.5), 1, "how fast a body that nothing holds comes back; 0: it floats and falls (so it does above the ground)"},
};
constexpr EffectProperty kJointDynamics[] = {
    {"hertz", "Hz", 0.01, 1000.0, one(4.0), 1, "of the softest way in which a joint jiggles"},
    {"damping", "", 0.0, 10.0, one(0.2), 1, "damping ratio"},
};
constexpr EffectProperty kPreviousModel[] = {
    {"step", "s", 1e-6, 1.0, one(1.0 / 600.0), 1, "time step of the explicit integration"},
    {"damping", "1/s", 0.0, 1e6, one(4.0), 1, "of the velocities of joint-face vertices"},
    {"shear-modulus", "Pa", 1e-3, 1e12, one(3000.0), 1, "of elements with stiffness 1"},
};
constexpr EffectProperty kGravity[] = {
    {"acceleration", "m/s^2", -1e6, 1e6, {0.0, -9.81, 0.0}, 3, "of free fall, in the world"},
    {"shear-modulus", "Pa", 1e-3, 1e12, one(3000.0), 1, "of elements with stiffness 1: softer flesh sags more"},
    {"inertia", "", 0.0, 10.0, one(1.0), 1, "how much of its own acceleration the flesh feels; 0: none"},
};
constexpr EffectProperty kInflate[] = {
    {"pressure", "", -10.0, 10.0, one(0.1), 1, "over the shear modulus; positive puffs up"},
    {"breath", "", 0.0, 10.0, one(0.0), 1, "how much the pressure rises and falls with each breath"},
    {"breath-hertz", "Hz", 0.0, 100.0, one(0.25), 1, "breaths per second"},
};
constexpr EffectProperty kTouch[] = {
    {"patches", "", 8.0, 256.0, one(48.0), 1, "how many patches of the surface fingers act on; more makes finer dents"},
    {"friction", "", 0.0, 10.0, one(1.0), 1, "Coulomb's coefficient between a finger and the surface"},
    {"release", "s", 0.0, 10.0, one(0.15), 1, "in which a dent goes back after a finger lifts"},
};
constexpr EffectProperty kGround[] = {
    {"height", "m", -1e9, 1e9, one(0.0), 1, "of the plane"},
    {"friction", "", 0.0, 10.0, one(0.6), 1, "Coulomb's coefficient, with bone dynamics"},
};

}  // namespace

std::optional<EffectKind> effectNamed(std::string_view name) {
    const auto found = std::find(kEffectNames.begin(), kEffectNames.end(), name);
    if (found == kEffectNames.end()) return std::nullopt;
    return static_cast<EffectKind>(found - kEffectNames.begin());
}

std::span<const EffectProperty> effectProperties(EffectKind kind) {
    switch (kind) {
        case EffectKind::BoneDynamics: return kBoneDynamics;
        case EffectKind::JointDynamics: return kJointDynamics;
        case EffectKind::PreviousModel: return kPreviousModel;
        case EffectKind::Gravity: return kGravity;
        case EffectKind::Inflate: return kInflate;
        case EffectKind::Touch: return kTouch;
        case EffectKind::Ground: return kGround;
        case EffectKind::SmoothJoints:
        case EffectKind::BendWarp: break;
    }
    return {};
}

bool isOfElements(EffectKind kind) {
    return kind == EffectKind::BendWarp || kind == EffectKind::Gravity || kind == EffectKind::Inflate || kind == EffectKind::Touch;
}

Effects::Effects() {
    for (std::size_t k = 0; k < kEffects; ++k)
        for (const EffectProperty& property : effectProperties(static_cast<EffectKind>(k)))
            all_[k].values.insert(all_[k].values.end(), property.initial.begin(), property.initial.begin() + property.size);
}

bool Effects::has(EffectKind kind, PartId element) const {
    const Effect& effect = (*this)[kind];
    return effect.enabled && (effect.elements.empty() || effect.elements.contains(element));
}

int Effects::place(EffectKind kind, std::string_view property) {
    int at = 0;
    for (const EffectProperty& p : effectProperties(kind)) {
        if (p.name == property) return at;
        at += p.size;
    }
    return -1;
}

double Effects::number(EffectKind kind, std::string_view property) const {
    const int at = place(kind, property);
    assert(at >= 0);
    return (*this)[kind].values[static_cast<std::size_t>(at)];
}

Vec3 Effects::vector(EffectKind kind, std::string_view property) const {
    const int at = place(kind, property);
    assert(at >= 0);
    return Vec3::Map((*this)[kind].values.data() + at);
}

}  // namespace imomushi
