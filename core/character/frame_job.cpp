// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/frame_job.h"

#include <algorithm>
#include <string>

#include "core/character/frame.h"

namespace imomushi {

namespace {

using enum FrameData;
// What is known from the stage of the same name on.
constexpr FrameDataSet kJoints = Joints | Elements | Ground, kMaps = kJoints | JointMaps, kLoads = kMaps | Parameters, kOffsets = kLoads | Loads,
                       kWeights = kOffsets | FaceOffsets, kShape = kWeights | Wants | Forces, kDents = kShape | Local, kPlaced = kDents | Positions, kNormals = kPlaced | Normals;

// By stage.
constexpr StageUse kAllowed[] = {
    {Stage::Joints, kJoints, Joints},
    {Stage::JointMaps, kMaps, JointMaps},
    {Stage::Loads, kLoads, Loads},
    {Stage::FaceOffsets, kOffsets, FaceOffsets | Parameters},
    {Stage::Equilibrium, kWeights, JointMaps | Parameters},
    {Stage::Weights, kShape, Wants | Forces},
    {Stage::LocalShape, kShape, Local | Positions},  // positions are made anew after it
    {Stage::Dents, kDents, Forces},
    {Stage::Placed, kPlaced, Positions | Ground},  // positions behind those of the body
    {Stage::Normals, kNormals, {}},
};
static_assert(std::size(kAllowed) == static_cast<std::size_t>(Stage::kCount));

}  // namespace

StageUse stageAllows(Stage stage) { return kAllowed[static_cast<std::size_t>(stage)]; }

Result<void> FrameJobs::validate() const {
    for (const auto& job : all_) {
        const auto uses = job->uses();
        if (!std::is_sorted(uses.begin(), uses.end(), [](const StageUse& a, const StageUse& b) { return a.stage < b.stage; }))
            return fail("internal", "A job of \"" + std::string(job->effect()) + "\" lists its stages out of order.");
        for (const StageUse& use : uses) {
            const StageUse allowed = stageAllows(use.stage);
            if (!use.reads.within(allowed.reads)) return fail("internal", "A job of \"" + std::string(job->effect()) + "\" reads what is not known yet in one of its stages.");
            if (!use.writes.within(allowed.writes)) return fail("internal", "A job of \"" + std::string(job->effect()) + "\" writes what its stage does not allow.");
        }
    }
    return {};
}

void FrameJobs::tell(const FrameJob& job, Stage stage, const Frame& frame, bool done) const {
    for (const StageUse& use : job.uses())
        if (use.stage == stage) seen_(job, use, frame, done);
}

void FrameJob::report(Frame& frame, double ms) const { frame.setTime(effect_, ms); }

}  // namespace imomushi
