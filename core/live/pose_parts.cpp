// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/pose_parts.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <map>

#include "core/base/rotation_vector.h"
#include "core/document/names.h"
#include "core/mesh/render_model.h"

namespace imomushi {

namespace {

/// What moves by less is at rest: radians, and parts of a length.
constexpr double kStill = 1e-6;

double sizeOf(const Skeleton& skeleton) {
    double size = 0.0;
    for (const Vec3& point : skeleton.points) size = std::max(size, (point - skeleton.points.front()).norm());
    return size > 0.0 ? size : 1.0;
}

/// The numbers of a pose in one row, lengths in sizes of the skeleton.
Eigen::VectorXd row(const PoseParts& parts, const CharacterPlan& plan, const std::map<MorphRef, Eigen::Index>& placeOf) {
    const double size = sizeOf(plan.input.skeleton);
    const auto bones = static_cast<Eigen::Index>(plan.bones.size()), handles = static_cast<Eigen::Index>(plan.handles.size());
    Eigen::VectorXd made = Eigen::VectorXd::Zero(7 * bones + 6 * handles + static_cast<Eigen::Index>(placeOf.size()));
    for (const PoseParts::Bone& b : parts.bones) made.segment<4>(7 * b.bone) << b.turn, b.longer;
    for (const PoseParts::Root& r : parts.roots) made.segment<3>(7 * r.bone + 4) = r.by / size;
    for (const PoseParts::Handle& h : parts.handles) made.segment<6>(7 * bones + 6 * h.handle) << h.by / size, h.turn;
    for (const PoseParts::Morph& m : parts.morphs)
        if (const auto place = placeOf.find(m.morph); place != placeOf.end()) made[7 * bones + 6 * handles + place->second] = m.more;
    return made;
}

}  // namespace

Eigen::Quaterniond wholeRotation(const BoneTree& tree, std::size_t bone, const Eigen::Quaterniond& frame, double roll) {
    const Eigen::Quaterniond q = frame.normalized();
    return rotationOf(Vec3(tree.rollSign[bone] * roll * (q * tree.restDirection[bone]))) * q;
}

PoseParts partsOf(const KeptPose& pose, const Document& document, const CharacterPlan& plan, const BoneTree& tree) {
    const Skeleton& skeleton = plan.input.skeleton;
    PoseParts made;
    std::vector<Eigen::Quaterniond> whole(skeleton.bones.size(), Eigen::Quaterniond::Identity());
    for (std::size_t b = 0; b < whole.size(); ++b) {
        const int parent = tree.parent[b];
        const Eigen::Quaterniond carried = parent < 0 ? Eigen::Quaterniond::Identity() : whole[static_cast<std::size_t>(parent)];
        const auto kept = pose.bones.find(plan.bones[b]);
        if (kept == pose.bones.end()) {  // came later: it goes along
            whole[b] = carried;
            continue;
        }
        whole[b] = wholeRotation(tree, b, kept->second.frame, kept->second.endRoll);
        const PoseParts::Bone bone{static_cast<int>(b), rotationVector((carried.conjugate() * whole[b]).normalized()), (kept->second.end - kept->second.start).norm() / skeleton.bones[b].length - 1.0};
        if (bone.turn.norm() > kStill || std::abs(bone.longer) > kStill) made.bones.push_back(bone);
        if (parent >= 0) continue;
        const Vec3 by = kept->second.start - skeleton.points[static_cast<std::size_t>(skeleton.bones[b].start)];
        if (by.norm() > kStill * sizeOf(skeleton)) made.roots.push_back({static_cast<int>(b), by});
    }
    for (const auto& [handle, goal] : pose.handles) {
        const int index = plan.handleIndex(handle);
        if (index >= 0 && goal.target.held) made.handles.push_back({index, goal.target.at - faceOf(document, handle).frame.origin, rotationVector(goal.target.rotation)});
    }
    for (const auto& [morph, weight] : pose.morphs) {
        const auto character = document.characters.find(morph.character);
        if (character == document.characters.end() || morph.target < 0 || static_cast<std::size_t>(morph.target) >= character->second->model->morphs.size()) continue;
        made.morphs.push_back({morph, weight - character->second->model->morphs[static_cast<std::size_t>(morph.target)].atRest});
    }
    return made;
}

std::vector<double> weightsIn(const PoseParts& now, std::span<const PoseParts> poses, const CharacterPlan& plan, std::span<const double> known, const std::vector<bool>& asked) {
    std::map<MorphRef, Eigen::Index> placeOf;
    for (const PoseParts& pose : poses)
        for (const PoseParts::Morph& m : pose.morphs) placeOf.try_emplace(m.morph, static_cast<Eigen::Index>(placeOf.size()));
    const auto count = static_cast<Eigen::Index>(poses.size());
    Eigen::VectorXd wanted = row(now, plan, placeOf);
    Eigen::MatrixXd rows(wanted.size(), count);
    for (Eigen::Index p = 0; p < count; ++p) {
        const auto of = static_cast<std::size_t>(p);
        rows.col(p) = row(poses[of], plan, placeOf);
        wanted -= known[of] * rows.col(p);
        if (!asked[of]) rows.col(p).setZero();
    }
    // Poses that are alike share the weight, and one that is all rest has none.
    Eigen::MatrixXd normal = rows.transpose() * rows;
    normal.diagonal().array() += 1e-12 * (1.0 + normal.trace());
    const Eigen::VectorXd weights = normal.llt().solve(rows.transpose() * wanted);
    std::vector<double> made;
    for (Eigen::Index p = 0; p < count; ++p) made.push_back(std::clamp(weights[p], 0.0, 1.0));
    return made;
}

}  // namespace imomushi
