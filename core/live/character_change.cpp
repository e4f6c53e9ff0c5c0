// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/character_change.h"

#include <algorithm>

namespace imomushi {

namespace {

bool sameSkeleton(const Skeleton& a, const Skeleton& b) {
    return a.points == b.points && std::equal(a.bones.begin(), a.bones.end(), b.bones.begin(), b.bones.end(), [](const auto& p, const auto& q) {
               return p.start == q.start && p.end == q.end && p.parent == q.parent && p.length == q.length && p.minStretch == q.minStretch && p.maxStretch == q.maxStretch &&
                      p.maxBend == q.maxBend && p.maxTwist == q.maxTwist && p.stiffness == q.stiffness;
           });
}

}  // namespace

bool changesCharacter(const DocumentChange& change, const Document& after) {
    if (movesJointPoints(change, after)) return true;
    if (change.settings && !(*change.settings == after.settings)) return true;
    if (change.effects && !sameOnCharacter(*change.effects, after.effects)) return true;
    for (const auto& [id, was] : change.characters) {
        const auto is = after.characters.find(id);
        if (!was || is == after.characters.end() || was->model != is->second->model || was->body != is->second->body ||
            was->attachments != is->second->attachments)
            return true;
    }
    return std::any_of(change.elements.begin(), change.elements.end(), [&](const auto& part) {
        const Element& was = *part.second;
        const Element& is = *after.elements.at(part.first);
        return was.nu != is.nu || was.stiffness != is.stiffness || was.density != is.density || was.damping != is.damping ||
               was.jointPlanes != is.jointPlanes || was.handles != is.handles;
    });
}

bool followSkeleton(Document& document, const CharacterPlan* before, const CharacterPlan& after) {
    std::erase_if(document.goals, [&](const auto& held) { return after.pointIndex(held.first) < 0; });
    std::erase_if(document.handleGoals, [&](const auto& held) { return after.handleIndex(held.first) < 0; });
    if (before && sameSkeleton(before->input.skeleton, after.input.skeleton)) return false;
    document.pose = {};
    bool pulled = false;
    for (auto& [end, held] : document.goals) {
        const Vec3& now = after.input.skeleton.points[static_cast<std::size_t>(after.pointIndex(end))];
        const int old = before ? before->pointIndex(end) : -1;
        if (held.pinned && old >= 0 && held.target == before->input.skeleton.points[static_cast<std::size_t>(old)]) held.target = now;
        pulled = pulled || held.target != now || held.roll || held.rotation;
    }
    return pulled;
}

}  // namespace imomushi
