// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/accuracy/study_frames.h"

#include <optional>
#include <utility>
#include <vector>

#include "core/effects/touch_job.h"
#include "core/mesh/triangle_tree.h"

namespace imomushi {

namespace {

/// How deep the finger presses, in diagonals of its element.
constexpr double kPressed = 0.03;

}  // namespace

TestFinger::TestFinger(const CharacterInput& input) {
    Eigen::Index most = 0;
    const auto* touch = input.effects.find<TouchEffect>();
    for (std::size_t e = 0; e < input.elements.size(); ++e)
        if (touch && touch->on(e) && input.elements[e].mesh->body.vertices.rows() > most) element_ = static_cast<int>(e), most = input.elements[e].mesh->body.vertices.rows();
    if (element_ < 0) return;
    const auto& element = input.elements[static_cast<std::size_t>(element_)];
    const Points& rest = element.mesh->body.vertices;
    std::vector<std::int32_t> held;
    for (const JointFace& face : element.faces) held.insert(held.end(), face.triangles.begin(), face.triangles.end());
    std::optional<TriangleTree> faces;
    if (!held.empty()) faces.emplace(element.mesh->body, std::move(held));
    double farthest = -1.0;
    for (Eigen::Index v = 0; v < rest.rows(); ++v) {
        const double nearest = faces ? faces->nearest(rest.row(v).transpose()).squaredDistance : 0.0;
        if (nearest > farthest) farthest = nearest, point_ = rest.row(v).transpose();
    }
    const Vec3 low = rest.colwise().minCoeff().transpose(), high = rest.colwise().maxCoeff().transpose();
    pressed_ = point_ + kPressed * (high - low).norm() * (0.5 * (low + high) - point_).normalized();
}

void TestFinger::press(Character& character) const {
    if (element_ >= 0) (void)setFinger(character, element_, 0, point_, character.frame(element_) * pressed_, 0.0);
}

StudyFrames::StudyFrames(Character& character, const StudyInput::Effect* effect)
    : character_(character), effect_(effect), finger_(character.input()), motion_(character.input().skeleton), pose_(restPose(character.input().skeleton)) {}

void StudyFrames::operator()() {
    constexpr double kFrame = 1.0 / 60.0;
    motion_.move(phase_ += 0.013);
    character_.solvePose(motion_.goals, pose_);
    finger_.press(character_);
    character_.update(effect_ && effect_->step ? effect_->step(kFrame, pose_, motion_.goals) : pose_, kFrame);
}

}  // namespace imomushi
