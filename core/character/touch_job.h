// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "core/character/aligned_buffer.h"
#include "core/character/effect_settings.h"
#include "core/character/frame_job.h"
#include "core/touch/touch_blocks.h"
#include "core/touch/touch_contact.h"

namespace imomushi {

struct ElementFrame;

/// Fingers press dents into elements (core/touch/touch_contact.h).
struct TouchEffect : EffectOf<TouchEffect>, TouchSettings {
    static constexpr std::string_view kName = "touch";
    [[nodiscard]] Result<void> validate() const override { return checkTouchSettings(*this); }
    void ask(ElementTables& tables) const override;
    [[nodiscard]] Result<void> addJob(Frame& frame, FrameJobs& jobs) const override;
};

/// Contact of fingers with the surfaces that the pose alone leaves.
///   reads   ElementFrame::frame, local; patchForces while a shape is shown again (Frame::replaying)
///   writes  ElementFrame::wantsLocal, patchForces, dented, positions
class TouchJob final : public FrameJob {
public:
    /// Errors: "bad-value" (settings).
    static Result<TouchJob> build(Frame& frame, const TouchSettings& settings);

    /// See Character::setFinger() and liftFinger().
    bool setFinger(int element, int finger, const Vec3& rest, const Vec3& target, double radius);
    void liftFinger(int element, int finger);

    void run(Stage stage, Frame& frame) override;
    void tune(const EffectSettings& settings) override;
    [[nodiscard]] bool resting(const Frame& frame) const override;
    [[nodiscard]] std::size_t bytes() const override;

private:
    TouchJob() : FrameJob(TouchEffect::kName, {Stage::Weights, Stage::Dents}) {}
    struct Finger {
        Vec3 rest, target;  // m, rest and world
        double radius = 0.0;
    };
    struct Element {
        int index = 0;
        TouchContact contact;
        TouchBlocks blocks;
        std::array<Finger, TouchContact::kFingers> fingers{};
        AlignedBuffer<float> dented;  // like ElementFrame::local
    };
    static bool active(const Element& touched, const Frame& frame);
    static void press(Element& touched, Frame& frame);
    static void aimFingers(Element& touched, const Frame& frame);

    std::vector<Element> elements_;
};

}  // namespace imomushi
