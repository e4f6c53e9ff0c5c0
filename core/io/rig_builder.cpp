// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/io/rig_builder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/finite.h"
#include "core/io/reader_support.h"
#include "core/mesh/bounds.h"

namespace imomushi {

namespace {

constexpr double kLeastWeight = 1e-5;  // of a vertex: smaller ones are what quantised weights leave over

constexpr double kStill = 1e-5;  // relative, or radians: keys that differ by less from rest move nothing

}  // namespace

RigNode rigNode(int parent, const Eigen::Matrix4d& local) {
    RigNode node;
    node.parent = parent;
    node.translation = local.topRightCorner<3, 1>();
    if (!allFinite(local) || local.cwiseAbs().maxCoeff() > kMaxImportedCoordinate) return node;  // refused where it matters
    const Eigen::Matrix3d linear = local.topLeftCorner<3, 3>();
    node.scale = linear.colwise().norm().transpose();
    Eigen::Matrix3d turn = linear;
    for (int k = 0; k < 3; ++k)
        if (node.scale[k] > 0.0) turn.col(k) /= node.scale[k];
    if (turn.determinant() < 0.0) {
        turn.col(2) = -turn.col(2);
        node.scale[2] = -node.scale[2];
    }
    node.rotation = nearestRotation(turn);
    return node;
}

int RigBuilder::addNode(std::string name, int parent, const RigNode& local, const Eigen::Matrix4d& rest) {
    Node node;
    node.name = std::move(name);
    node.parent = parent;
    node.local = local;
    node.rest = rest;
    nodes_.push_back(std::move(node));
    return static_cast<int>(nodes_.size()) - 1;
}

void RigBuilder::setJoint(int node, const std::optional<Eigen::Matrix4d>& rest) {
    Node& joint = nodes_[static_cast<std::size_t>(node)];
    if (rest && !joint.joint) joint.rest = *rest;
    joint.joint = true;
}

void RigBuilder::bind(std::int32_t vertex, int node, double weight) {
    if (isFinite(weight) && weight > 0.0) bindings_.push_back({vertex, node, weight});
}

void RigBuilder::placeLentParts() {
    std::vector<char> carries(nodes_.size(), 0);
    for (const Node& node : nodes_)
        if (node.parent >= 0) carries[static_cast<std::size_t>(node.parent)] = 1;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        Node& node = nodes_[i];
        if (!node.lent) continue;
        const bool parents = node.parent >= 0 && !node.joint && !node.moved && !carries[i];
        (parents ? nodes_[static_cast<std::size_t>(node.parent)] : node).part = true;
    }
}

std::vector<char> RigBuilder::chosenBones() const {
    const std::size_t n = nodes_.size();
    std::vector<char> bones(n, 0), partBelow(n, 0), jointBelow(n, 0), partAbove(n, 0), partUnder(n, 0);
    bool anyJoint = false, anyPart = false;
    for (std::size_t i = n; i-- > 0;) {
        const Node& node = nodes_[i];
        anyJoint = anyJoint || node.joint;
        anyPart = anyPart || node.part;
        partBelow[i] = partBelow[i] || node.part;
        jointBelow[i] = jointBelow[i] || node.joint;
        if (node.parent < 0) continue;
        const auto above = static_cast<std::size_t>(node.parent);
        partBelow[above] = partBelow[above] || partBelow[i];
        partUnder[above] = partUnder[above] || partBelow[i];
        jointBelow[above] = jointBelow[above] || jointBelow[i];
    }
    for (std::size_t i = 0; i < n; ++i) {
        const Node& node = nodes_[i];
        if (node.parent >= 0) {
            const auto above = static_cast<std::size_t>(node.parent);
            partAbove[i] = partAbove[above] || nodes_[above].part;
        }
        const bool movesParts = node.moved && partBelow[i];
        if (anyJoint)
            bones[i] = node.joint || (movesParts && !jointBelow[i]);
        else
            bones[i] = !anyPart || movesParts || (node.part && (partAbove[i] || partUnder[i]));
    }
    return bones;
}

void RigBuilder::keep(const std::vector<char>& chosen, Rig& rig) {
    std::vector<char> needed = chosen;
    for (std::size_t i = nodes_.size(); i-- > 0;)
        if (needed[i] && nodes_[i].parent >= 0) needed[static_cast<std::size_t>(nodes_[i].parent)] = 1;
    std::set<std::string> names;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        Node& node = nodes_[i];
        const Node* above = node.parent < 0 ? nullptr : &nodes_[static_cast<std::size_t>(node.parent)];
        node.bone = above ? above->bone : -1;
        if (!needed[i]) continue;
        node.kept = static_cast<int>(rig.nodes.size());
        rig.nodes.push_back(node.local);
        rig.nodes.back().parent = above ? above->kept : -1;
        if (!chosen[i]) rig.nodes.back().name = node.name;
        if (!chosen[i]) continue;
        RigBone bone;
        bone.name = uniqueName(names, node.name);
        bone.parent = node.bone;
        bone.node = node.kept;
        bone.head = node.rest.topRightCorner<3, 1>();
        if (allFinite(node.rest) && node.rest.cwiseAbs().maxCoeff() <= kMaxImportedCoordinate) bone.rotation = nearestRotation(node.rest.topLeftCorner<3, 3>());
        node.bone = static_cast<int>(rig.bones.size());
        node.isBone = true;
        rig.bones.push_back(std::move(bone));
    }
}

void RigBuilder::weigh(std::size_t vertices, Rig& rig) const {
    std::vector<std::vector<std::pair<std::int32_t, double>>> of(vertices);
    for (const Binding& binding : bindings_) {
        const std::int32_t bone = nodes_[static_cast<std::size_t>(binding.node)].bone;
        if (bone < 0 || static_cast<std::size_t>(binding.vertex) >= vertices) continue;
        auto& own = of[static_cast<std::size_t>(binding.vertex)];
        const auto known = std::find_if(own.begin(), own.end(), [&](const auto& entry) { return entry.first == bone; });
        if (known == own.end())
            own.emplace_back(bone, binding.weight);
        else
            known->second += binding.weight;
    }
    rig.weights.first.push_back(0);
    for (auto& own : of) {
        std::sort(own.begin(), own.end());
        double sum = 0.0, kept = 0.0;
        for (const auto& [bone, weight] : own) sum += weight;
        std::erase_if(own, [&](const auto& entry) { return entry.second < kLeastWeight * sum; });
        for (const auto& [bone, weight] : own) kept += weight;
        for (const auto& [bone, weight] : own) {
            rig.weights.bone.push_back(bone);
            rig.weights.weight.push_back(static_cast<float>(weight / kept));
        }
        rig.weights.first.push_back(static_cast<std::int32_t>(rig.weights.bone.size()));
    }
    if (rig.weights.empty()) rig.weights = {};
}

void RigBuilder::takeClips(RawScene& scene, Rig& rig) {
    std::set<std::string> names;
    std::size_t numbers = 0, tooMany = 0;
    if (clips_.size() > 1 && staysAtRest(clips_.front())) {
        tell(scene, Severity::Info, "clip-empty", "The animation '" + clips_.front().name + "' moves nothing and was left out.", 1, false);
        clips_.erase(clips_.begin());
    }
    for (RigClip& clip : clips_) {
        std::erase_if(clip.tracks, [&](const RigTrack& track) { return nodes_[static_cast<std::size_t>(track.node)].kept < 0; });
        if (clip.tracks.empty() && clip.morphs.empty()) continue;  // it moves cameras, or nothing
        std::size_t own = 0;
        clip.seconds = 0.0;
        for (RigTrack& track : clip.tracks) {
            track.node = nodes_[static_cast<std::size_t>(track.node)].kept;
            own += track.times.size() + track.values.size();
            if (!track.times.empty() && isFinite(track.times.back())) clip.seconds = std::max(clip.seconds, track.times.back());
        }
        for (const MorphTrack& track : clip.morphs) {
            own += track.times.size() + track.weights.size();
            if (!track.times.empty() && isFinite(track.times.back())) clip.seconds = std::max(clip.seconds, track.times.back());
        }
        if (numbers + own > kMostRigNumbers || rig.clips.size() == kMostRigClips) {
            ++tooMany;
            continue;
        }
        if (const std::string fault = checkClip(clip, rig.nodes.size()); !fault.empty()) {
            tell(scene, Severity::Warning, "clip", "The animation '" + clip.name + "' is damaged and was left out: " + fault + ".", 1);
            continue;
        }
        numbers += own;
        clip.name = uniqueName(names, clip.name);
        rig.clips.push_back(std::move(clip));
    }
    if (tooMany > 0) tell(scene, Severity::Warning, "clip", std::to_string(tooMany) + (tooMany == 1 ? " animation" : " animations") + " left out: the file has too many.", tooMany);
}

bool RigBuilder::staysAtRest(const RigClip& clip) const {
    if (!clip.morphs.empty()) return false;
    // A pose may be meant; what programs write unasked has a single key, or the name that they give it.
    const bool unnamed = clip.name.rfind("Take ", 0) == 0;
    if (!unnamed && std::any_of(clip.tracks.begin(), clip.tracks.end(), [](const RigTrack& track) { return track.times.size() > 1; })) return false;
    return std::all_of(clip.tracks.begin(), clip.tracks.end(), [&](const RigTrack& track) {
        if (track.interpolation == RigTrack::Interpolation::Cubic) return false;
        const RigNode& rest = nodes_[static_cast<std::size_t>(track.node)].local;
        const bool turns = track.path == RigTrack::Path::Rotation;
        const Vec3& fixed = track.path == RigTrack::Path::Scale ? rest.scale : rest.translation;
        const std::size_t width = turns ? 4 : 3;
        for (std::size_t k = 0; k + width <= track.values.size(); k += width) {
            const double* v = track.values.data() + k;
            if (turns ? !(std::abs(Eigen::Vector4d(v[0], v[1], v[2], v[3]).normalized().dot(rest.rotation.coeffs())) > 1.0 - kStill * kStill)
                      : !((Vec3(v[0], v[1], v[2]) - fixed).norm() <= kStill * fixed.norm()))
                return false;
        }
        return true;
    });
}

std::optional<Rig> RigBuilder::finish(RawScene& scene) {
    for (const RigClip& clip : clips_)
        for (const RigTrack& track : clip.tracks) nodes_[static_cast<std::size_t>(track.node)].moved = true;
    placeLentParts();
    const std::vector<char> chosen = chosenBones();
    const auto bones = static_cast<std::size_t>(std::count(chosen.begin(), chosen.end(), 1));
    if (bones == 0 && std::all_of(clips_.begin(), clips_.end(), [](const RigClip& clip) { return clip.morphs.empty(); })) return std::nullopt;
    const auto leftOut = [&](const std::string& why) {
        tell(scene, Severity::Warning, "skeleton", "The skeleton was left out: " + why + ".", bones);
        return std::nullopt;
    };
    if (bones > kMostRigBones) return leftOut("it has " + std::to_string(bones) + " bones, more than " + std::to_string(kMostRigBones));
    Rig rig;
    keep(chosen, rig);
    if (rig.nodes.size() > kMostRigNodes) return leftOut("its bones hang on more than " + std::to_string(kMostRigNodes) + " nodes");
    const auto vertices = static_cast<std::size_t>(scene.surface.mesh.body.vertices.rows());
    if (const std::string fault = bones > 0 ? checkRig(rig, vertices) : std::string(); !fault.empty()) return leftOut(fault);
    weigh(vertices, rig);
    guessTails(rig);
    takeClips(scene, rig);
    if (rig.bones.empty() && rig.clips.empty()) return std::nullopt;
    if (const std::string fault = checkRig(rig, vertices); !fault.empty()) return leftOut(fault);
    return rig;
}

}  // namespace imomushi
