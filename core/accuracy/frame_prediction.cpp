// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/accuracy/frame_prediction.h"

#include "core/accuracy/synthetic_response.h"
#include "core/base/try.h"
#include "core/comparison/test_motion.h"
#include "core/comparison/timing.h"
#include "core/effects/touch_job.h"

namespace imomushi {

namespace {

constexpr double kPredictionSeconds = 0.1;

}  // namespace

Result<double> predictFrame(const CharacterInput& input, const Progress& progress) {
    CharacterInput synthetic = withSyntheticResponses(input);
    synthetic.effects.erase<TouchEffect>();
    IMOMUSHI_TRY(auto character, Character::build(std::move(synthetic)));
    TestMotion motion(input.skeleton);
    Pose pose = restPose(input.skeleton);
    double at = 0.0;
    // As frames are measured in a study.
    const double ms = quietSpreads(kPredictionSeconds,
                                   {[&] {
                                       motion.move(at += 0.013);
                                       character.solvePose(motion.goals, pose);
                                       character.update(pose, 1.0 / 60.0);
                                   }},
                                   progress)[0].median;
    if (progress.cancelled()) return fail(kCancelled, "The prediction was cancelled.");
    return ms;
}

}  // namespace imomushi
