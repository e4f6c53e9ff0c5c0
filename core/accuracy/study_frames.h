// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/accuracy/study.h"
#include "core/comparison/test_motion.h"

namespace imomushi {

/// A finger that presses the element of most vertices where its joint faces are farthest. Presses nothing where no element is touched.
class TestFinger {
public:
    explicit TestFinger(const CharacterInput& input);
    void press(Character& character) const;

private:
    int element_ = -1;
    Vec3 point_ = Vec3::Zero(), pressed_ = Vec3::Zero();  // m, at rest
};

/// Whole frames of one character in the test motion, one per call: inverse kinematics, what the effect makes of the pose, the update.
class StudyFrames {
public:
    /// `effect`: may be null. All must outlive this.
    explicit StudyFrames(Character& character, const StudyInput::Effect* effect = nullptr);
    void operator()();

private:
    Character& character_;
    const StudyInput::Effect* effect_;
    TestFinger finger_;
    TestMotion motion_;
    Pose pose_;
    double phase_ = 0.0;
};

}  // namespace imomushi
