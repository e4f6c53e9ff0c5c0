// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/limit_words.h"

#include "core/document/bone_limits.h"
#include "core/document/character_input.h"
#include "core/session/session.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {
namespace {

/// An end that is farther from its target than this part of the character's size does not come there.
constexpr double kOutOfReach = 0.01;

/// The diagonal of the box around joint points at rest, m.
double sizeOf(const Skeleton& skeleton) {
    Vec3 low = skeleton.points.front(), high = low;
    for (const Vec3& p : skeleton.points) low = low.cwiseMin(p), high = high.cwiseMax(p);
    return (high - low).norm();
}

/// Of a bone and those that carry it.
QString wordOf(const Skeleton& skeleton, const Pose& pose, int bone) {
    for (; bone >= 0; bone = skeleton.bones[static_cast<std::size_t>(bone)].parent) switch (limitOf(skeleton, pose, bone)) {
            case BoneLimit::Stretched: return ToolTexts::tr("Stretched as far as it goes");
            case BoneLimit::Shortened: return ToolTexts::tr("Pressed together as far as it goes");
            case BoneLimit::Bent: return ToolTexts::tr("Bent as far as it goes");
            case BoneLimit::None: break;
        }
    return ToolTexts::tr("Out of reach");
}

}  // namespace

std::vector<LimitWord> limitWords(const Session& session) {
    std::vector<LimitWord> words;
    const Document& d = session.document();
    if (session.showsTake() || !session.character()) return words;
    const Skeleton& skeleton = session.plan().input.skeleton;
    for (const auto& [end, goal] : d.goals) {
        const int point = session.pointIndex(end), bone = session.plan().boneIndex(end.bone);
        if (goal.pinned || goal.elapsed < goal.seconds || point < 0 || bone < 0 || d.pose.points.size() != skeleton.points.size()) continue;
        const Vec3& at = d.pose.points[static_cast<std::size_t>(point)];
        if ((at - goal.target).norm() < kOutOfReach * sizeOf(skeleton)) continue;
        const auto shown = session.positionOf(end);
        words.push_back({shown ? *shown : at, wordOf(skeleton, d.pose, bone)});
    }
    return words;
}

}  // namespace imomushi
