// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/rig_follower.h"

#include <algorithm>
#include <limits>

#include "core/base/union_find.h"

namespace imomushi {

namespace {

constexpr double kSameJoint = 1e-6;  // of the size of the skeleton

double distanceFromBone(const RigBone& bone, const Vec3& p) {
    const Vec3 along = bone.tail - bone.head;
    const double length2 = along.squaredNorm();
    const double t = length2 > 0.0 ? std::clamp((p - bone.head).dot(along) / length2, 0.0, 1.0) : 0.0;
    return (p - bone.head - t * along).norm();
}

}  // namespace

RigFollower::RigFollower(const Document& document, const CharacterPlan& plan, const CharacterSource& character)
    : plan_(plan), rig_(*character.rig), tree_(boneTree(plan.input.skeleton)) {
    for (const RigBone& bone : rig_.bones) same_ = std::max(same_, kSameJoint * (bone.head - rig_.bones[0].head).norm());
    chooseBones(document, character.id);
    choosePoints();
}

void RigFollower::chooseBones(const Document& document, PartId character) {
    const Skeleton& skeleton = plan_.input.skeleton;
    UnionFind trees(skeleton.points.size());
    for (const auto& bone : skeleton.bones) trees.unite(static_cast<std::size_t>(bone.start), static_cast<std::size_t>(bone.end));
    std::vector<char> own(skeleton.points.size(), 0);
    for (std::size_t b = 0; b < plan_.bones.size(); ++b) {
        const PartId through = document.bones.at(plan_.bones[b])->element;
        if (through == 0) continue;
        const auto& piece = document.elements.at(through)->piece;
        if (piece && piece->character == character) own[trees.find(static_cast<std::size_t>(skeleton.bones[b].start))] = 1;
    }
    follows_.assign(plan_.bones.size(), -1);
    for (std::size_t b = 0; b < plan_.bones.size(); ++b) {
        const auto& bone = skeleton.bones[b];
        if (!own[trees.find(static_cast<std::size_t>(bone.start))]) continue;
        const Vec3 &start = skeleton.points[static_cast<std::size_t>(bone.start)], &end = skeleton.points[static_cast<std::size_t>(bone.end)];
        int chosen = rig_.boneIndex(document.bones.at(plan_.bones[b])->name);
        // Bones that lead from the start of another one to its limbs turn with that.
        if (const int parent = tree_.parent[b]; chosen < 0 && parent >= 0 && skeleton.bones[static_cast<std::size_t>(parent)].start == bone.start) chosen = follows_[static_cast<std::size_t>(parent)];
        for (std::size_t r = 0; chosen < 0 && r < rig_.bones.size(); ++r)
            if ((rig_.bones[r].head - start).norm() <= same_) {
                chosen = static_cast<int>(r);
                // Of several bones that start there, the one that leads to the end.
                for (std::size_t other = r + 1; other < rig_.bones.size(); ++other)
                    if ((rig_.bones[other].head - start).norm() <= same_ && distanceFromBone(rig_.bones[other], end) < distanceFromBone(rig_.bones[static_cast<std::size_t>(chosen)], end))
                        chosen = static_cast<int>(other);
            }
        if (chosen < 0 && tree_.parent[b] >= 0) chosen = follows_[static_cast<std::size_t>(tree_.parent[b])];
        double nearest = std::numeric_limits<double>::max();
        for (std::size_t r = 0; chosen < 0 && r < rig_.bones.size(); ++r) {
            const double distance = distanceFromBone(rig_.bones[r], 0.5 * (start + end));
            if (distance < nearest) {
                nearest = distance;
                follows_[b] = static_cast<int>(r);
            }
        }
        if (chosen >= 0) follows_[b] = chosen;
    }
}

void RigFollower::choosePoints() {
    const Skeleton& skeleton = plan_.input.skeleton;
    pointFollows_.assign(skeleton.points.size(), -1);
    // Bones that start at a point come before those that end there.
    for (const bool ends : {false, true})
        for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
            const int follows = follows_[b];
            int& point = pointFollows_[static_cast<std::size_t>(ends ? skeleton.bones[b].end : skeleton.bones[b].start)];
            if (follows >= 0 && point < 0) point = follows;
        }
    for (std::size_t p = 0; p < pointFollows_.size(); ++p) {
        int& follows = pointFollows_[p];
        if (follows < 0) continue;
        const auto isAt = [&](const RigBone& bone) { return (bone.head - skeleton.points[p]).norm() <= same_; };
        if (!isAt(rig_.bones[static_cast<std::size_t>(follows)]))
            if (const auto joint = std::find_if(rig_.bones.begin(), rig_.bones.end(), isAt); joint != rig_.bones.end()) follows = static_cast<int>(joint - rig_.bones.begin());
        ++(isAt(rig_.bones[static_cast<std::size_t>(follows)]) ? exact_ : carried_);
    }
}

Pose RigFollower::pose(const RigClip& clip, double time) const {
    const Skeleton& skeleton = plan_.input.skeleton;
    const std::vector<RigPose> file = posedRig(rig_, clip, time);
    std::vector<Eigen::Quaterniond> turns;
    for (std::size_t r = 0; r < file.size(); ++r) turns.push_back((file[r].rotation * rig_.bones[r].rotation.conjugate()).normalized());
    Pose pose = restPose(skeleton);
    for (std::size_t p = 0; p < pointFollows_.size(); ++p) {
        if (pointFollows_[p] < 0) continue;
        const auto r = static_cast<std::size_t>(pointFollows_[p]);
        const Vec3 arm = skeleton.points[p] - rig_.bones[r].head;
        pose.points[p] = arm.norm() <= same_ ? file[r].head : Vec3(file[r].head + turns[r] * arm);
    }
    for (std::size_t b = 0; b < follows_.size(); ++b) {
        if (follows_[b] < 0) continue;
        const auto& bone = skeleton.bones[b];
        Eigen::Quaterniond& frame = pose.frames[b];
        frame = turns[static_cast<std::size_t>(follows_[b])];
        const Vec3 along = pose.points[static_cast<std::size_t>(bone.end)] - pose.points[static_cast<std::size_t>(bone.start)];
        if (along.norm() > 1e-9 * bone.length) frame = (minimalRotation((frame * tree_.restDirection[b]).normalized(), along.normalized()) * frame).normalized();
        // Bends between bones are less than half a turn.
        const int parent = tree_.parent[b];
        const double sign = parent < 0 ? frame.w() : frame.dot(pose.frames[static_cast<std::size_t>(parent)]);
        if (sign < 0.0) frame.coeffs() = -frame.coeffs();
    }
    return pose;
}

}  // namespace imomushi
