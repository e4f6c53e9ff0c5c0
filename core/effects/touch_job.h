// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "core/character/character.h"
#include "core/touch/touch_contact.h"

namespace imomushi {

struct ElementState;

/// Fingers press dents into elements (core/touch/touch_contact.h).
struct TouchEffect : EffectOf<TouchEffect>, TouchSettings {
    static constexpr std::string_view kName = "touch";
    static constexpr auto kTitle = IMOMUSHI_TEXT("Effects", "Touch");
    static constexpr auto kHelp = IMOMUSHI_TEXT("Effects", "Fingers press dents into the surface (touch tool, T).");
    double patches = 48.0;  ///< of the surface of each element, on which fingers act: columns of its response

    static constexpr auto properties() {
        return std::array{
            number<&TouchEffect::patches>(
                "patches", "", 8.0, 256.0, IMOMUSHI_TEXT("Effects", "Patches"),
                IMOMUSHI_TEXT("Effects",
                              "How many patches of a surface fingers act on. More of them make finer dents, and a longer precompute."),
                true, true),
            number<&TouchEffect::tip>(
                "tip", "m", 0.0, 1000.0, IMOMUSHI_TEXT("Effects", "Finger tip"),
                IMOMUSHI_TEXT("Effects", "Radius of finger tips, smooth spheres, which make fine dents at once. 0: only patches give way."), false, true),
            number<&TouchEffect::friction>(
                "friction", "", 0.0, 10.0, IMOMUSHI_TEXT("Effects", "Friction"),
                IMOMUSHI_TEXT("Effects", "Coulomb’s coefficient between a finger and the surface. 0: it only pushes straight in.")),
            number<&TouchEffect::releaseSeconds>("release", "s", 0.0, 10.0, IMOMUSHI_TEXT("Effects", "Release"),
                                                 IMOMUSHI_TEXT("Effects", "In this time a dent goes back after its finger lifts.")),
        };
    }
    void ask(ElementTables& tables) const override;
    [[nodiscard]] Result<void> addJob(Frame& frame, FrameJobs& jobs) const override;
};

/// Contact of fingers with the surfaces that the pose alone leaves.
class TouchJob final : public EffectJob<TouchEffect> {
public:
    /// Errors: "bad-value" (settings).
    static Result<TouchJob> build(Frame& frame, const TouchEffect& settings);

    /// See setFinger() and liftFinger() below.
    bool setFinger(int element, int finger, const Vec3& rest, const Vec3& target, double radius);
    void liftFinger(int element, int finger);

    void run(Stage stage, Frame& frame) override;
    [[nodiscard]] bool resting(const Frame&) const override;
    [[nodiscard]] std::size_t bytes() const override;
    void report(Frame& frame, double ms) const override;

private:
    explicit TouchJob(const TouchEffect& settings) : EffectJob(settings, {{Stage::Weights, {}, FrameData::Wants}, {Stage::Dents, FrameData::JointMaps | FrameData::Elements | FrameData::FaceOffsets | FrameData::Local, FrameData::Forces}}) {}
    bool take(const TouchEffect& settings) override;
    struct Finger {
        Vec3 rest, target;  // m, rest and world
        double radius = 0.0;
    };
    struct Element {
        int index = 0;
        TouchContact contact;
        std::array<Finger, TouchContact::kFingers> fingers{};
        bool pressed = false;  // in the last frame
    };
    static bool active(const Element& touched);
    static void aimFingers(Element& touched, const Frame& frame);

    std::vector<Element> elements_;
};

/// A finger (0 ... TouchContact::kFingers - 1) on an element: at the surface point nearest to `rest` (m, rest pose) it pushes towards `target` (m, world).
/// radius: m, 0: as small as can be. Or moves one that is there. False: the element feels no touch, or the point is not a number.
inline bool setFinger(Character& character, int element, int finger, const Vec3& rest, const Vec3& target, double radius) {
    TouchJob* touch = character.job<TouchJob>();
    return touch && touch->setFinger(element, finger, rest, target, radius);
}
inline void liftFinger(Character& character, int element, int finger) {
    if (TouchJob* touch = character.job<TouchJob>()) touch->liftFinger(element, finger);
}

}  // namespace imomushi
