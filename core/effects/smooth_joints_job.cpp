// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/effects/smooth_joints_job.h"

#include <algorithm>

#include "core/character/frame.h"
#include "core/character/frame_job.h"
#include "core/effects/joint_equilibrium.h"
#include "core/effects/previous_model_job.h"

namespace imomushi {

using Eigen::Matrix3d;

namespace {

// Radians between an element and its joint at which the shapes of smooth joints have gone, where elements are warped.
constexpr double kFadedAngle = 0.6;

class SmoothJointsJob final : public FrameJob {
public:
    SmoothJointsJob(Frame& frame, std::span<const JointEquilibrium* const> known) : FrameJob(SmoothJointsEffect::kName, {{Stage::Equilibrium, FrameData::Joints | FrameData::JointMaps | FrameData::Elements | FrameData::Parameters | FrameData::Loads, FrameData::JointMaps | FrameData::Parameters}}), equilibrium_(frame.input, known) {
        frame.smooth = true;
        const int shapes = frame.warpingShapes = equilibrium_.warpingShapes();
        for (auto& j : frame.joints) j.warping = Eigen::Matrix3Xd::Zero(3, shapes);
        for (auto& e : frame.elements) {
            e.shownWarping.assign(e.jointOf.size(), Eigen::Matrix3Xd::Zero(3, shapes));
            e.heldShapes.resize(shapes, static_cast<Eigen::Index>(e.held.size()));
            for (std::size_t i = 0; i < e.held.size(); ++i)
                equilibrium_.shapes(e.held[i].joint, e.held[i].rest, e.heldShapes.col(static_cast<Eigen::Index>(i)).data());
        }
    }

    void run(Stage, Frame& frame) override {
        auto& joints = frame.joints;
        auto& elements = frame.elements;
        for (std::size_t j = 0; j < joints.size(); ++j) equilibrium_.setJoint(static_cast<int>(j), joints[j].rotationMatrix);
        for (std::size_t e = 0; e < elements.size(); ++e)
            if (elements[e].runtime->input.response)
                equilibrium_.setElement(static_cast<int>(e), elements[e].frame.linear, elements[e].v,
                                        {elements[e].jointForces.data(), static_cast<std::size_t>(elements[e].jointForces.size())});
        equilibrium_.solve();
        for (std::size_t j = 0; j < joints.size(); ++j) {
            auto& out = joints[j];
            const Vec3 at = out.map(out.restPlace);
            out.part = !out.warped ? 1.0 : out.fades ? 1.0 + out.warpPart * (shownPart(frame, j) - 1.0) : shownPart(frame, j);
            Matrix3d stretch = equilibrium_.stretch(static_cast<int>(j));
            if (out.warped) stretch = (Matrix3d::Identity() + out.part * (stretch - Matrix3d::Identity())).eval();
            out.map.linear = out.rotationMatrix * stretch;
            out.map.shift = at - out.map.linear * out.restPlace;
            out.warping.noalias() = out.rotationMatrix * equilibrium_.warping(static_cast<int>(j));
            if (out.warped) out.warping *= out.part;
        }
        for (std::size_t e = 0; e < elements.size(); ++e)
            if (elements[e].v.size() > 0) elements[e].v = equilibrium_.parameters(static_cast<int>(e));
    }


    [[nodiscard]] const JointEquilibrium& equilibrium() const { return equilibrium_; }

private:
    // The shape of a joint is of small motions. Where elements are warped it fades while the joint turns away from them: they keep their volume with rigid
    // joints, and creases would come back.
    static double shownPart(const Frame& frame, std::size_t j) {
        double angle = 0.0;
        for (const auto& f : frame.input.joints[j].faces)
            angle = std::max(angle, frame.joints[j].rotation.angularDistance(frame.elements[static_cast<std::size_t>(f.element)].rotation));
        const double part = 1.0 - std::min(1.0, angle * angle / (kFadedAngle * kFadedAngle));
        return part * part;
    }

    JointEquilibrium equilibrium_;
};

}  // namespace

Result<void> SmoothJointsEffect::addJob(Frame& frame, FrameJobs& jobs) const {
    if (frame.input.effects.has<PreviousModelEffect>()) return {};
    std::vector<const JointEquilibrium*> known;
    for (const SmoothJointsJob* job : jobs.former<SmoothJointsJob>()) known.push_back(&job->equilibrium());
    jobs.add<SmoothJointsJob>(frame, known);
    return {};
}

}  // namespace imomushi
