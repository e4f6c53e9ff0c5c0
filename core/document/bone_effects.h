// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "core/character/effect_settings.h"
#include "core/dynamics/bone_dynamics.h"

namespace imomushi {

// Effects that act on bones before a character is deformed (performance.h), and have no job in its frames.

/// Bones are springs (core/dynamics/bone_dynamics.h).
struct BoneDynamicsEffect : EffectOf<BoneDynamicsEffect> {
    static constexpr std::string_view kName = "bone-dynamics";
    static constexpr auto kTitle = IMOMUSHI_TEXT("Effects", "Bone dynamics");
    static constexpr auto kHelp = IMOMUSHI_TEXT("Effects", "Bones swing, stretch and settle after each move.");
    double stretchHertz = 5.0, stretchDamping = 0.4;
    double swingHertz = 2.5, swingDamping = 0.3;
    double rollHertz = 3.0, rollDamping = 0.3;
    double returnHertz = 0.5;
    double airDamping = 0.0;

    static constexpr auto properties() {
        return std::array{
            number<&BoneDynamicsEffect::stretchHertz>("stretch-hertz", "Hz", 0.01, 1000.0, IMOMUSHI_TEXT("Effects", "Stretch"),
                                                      IMOMUSHI_TEXT("Effects", "How fast bones swing in their length.")),
            number<&BoneDynamicsEffect::stretchDamping>("stretch-damping", "", 0.0, 10.0, IMOMUSHI_TEXT("Effects", "Stretch damping"),
                                                        IMOMUSHI_TEXT("Effects", "Damping ratio of the length. 0: it never stops; 1: no swing.")),
            number<&BoneDynamicsEffect::swingHertz>("swing-hertz", "Hz", 0.01, 1000.0, IMOMUSHI_TEXT("Effects", "Swing"),
                                                    IMOMUSHI_TEXT("Effects", "How fast the angles between bones swing.")),
            number<&BoneDynamicsEffect::swingDamping>("swing-damping", "", 0.0, 10.0, IMOMUSHI_TEXT("Effects", "Swing damping"),
                                                      IMOMUSHI_TEXT("Effects", "Damping ratio of the angles. 0: they never stop; 1: no swing.")),
            number<&BoneDynamicsEffect::rollHertz>("roll-hertz", "Hz", 0.01, 1000.0, IMOMUSHI_TEXT("Effects", "Roll"),
                                                   IMOMUSHI_TEXT("Effects", "How fast bones swing about themselves.")),
            number<&BoneDynamicsEffect::rollDamping>("roll-damping", "", 0.0, 10.0, IMOMUSHI_TEXT("Effects", "Roll damping"),
                                                     IMOMUSHI_TEXT("Effects", "Damping ratio of the roll. 0: it never stops; 1: no swing.")),
            number<&BoneDynamicsEffect::returnHertz>(
                "return-hertz", "Hz", 0.0, 1000.0, IMOMUSHI_TEXT("Effects", "Return"),
                IMOMUSHI_TEXT("Effects", "How fast a character that nothing holds returns to its place. 0: not at all. With gravity and ground it falls, whatever this says.")),
            number<&BoneDynamicsEffect::airDamping>(
                "air-damping", "1/s", 0.0, BoneDynamicsSettings::kMaxAirDamping, IMOMUSHI_TEXT("Effects", "Air damping"),
                IMOMUSHI_TEXT("Effects", "How fast every swing of a held character dies out, its slow sway as a whole too: half of it is left after 1.4 s over this.")),
        };
    }
};

}  // namespace imomushi
