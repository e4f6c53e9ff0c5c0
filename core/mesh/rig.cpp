// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/rig.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/base/decompositions.h"
#include "core/base/finite.h"
#include "core/mesh/avatar.h"
#include "core/mesh/bounds.h"
#include "core/mesh/render_model.h"

namespace imomushi {

namespace {

using Matrix = Eigen::Matrix4d;
using Path = RigTrack::Path;
using Interpolation = RigTrack::Interpolation;

constexpr double kSmallestScale = 1e-12;  // of a bone's axes, relative to its largest: flatter ones turn with their parent's
constexpr double kUnit = 1e-6;            // unit quaternions are unit to this
constexpr double kFarthest = 1e100;       // of a transformation, so that products of them stay finite: beyond it a node stays with its parent
constexpr double kLongestClip = 1e9;      // s

std::size_t widthOf(Path path) { return path == Path::Rotation ? 4 : 3; }

/// The value of keys of `width` numbers, 4 at most, at a time; `turns`: these are rotations.
Eigen::Vector4d valueAt(Interpolation interpolation, const std::vector<double>& times, const std::vector<double>& values, std::size_t width, bool turns, double time) {
    const std::size_t stride = interpolation == Interpolation::Cubic ? 3 * width : width;
    const std::size_t middle = interpolation == Interpolation::Cubic ? width : 0;
    const auto read = [&](std::size_t key, std::size_t offset) {
        Eigen::Vector4d v = Eigen::Vector4d::Zero();
        for (std::size_t i = 0; i < width; ++i) v[static_cast<Eigen::Index>(i)] = values[key * stride + offset + i];
        return v;
    };
    const auto after = std::upper_bound(times.begin(), times.end(), time);
    if (after == times.begin()) return read(0, middle);
    const auto key = static_cast<std::size_t>(after - times.begin()) - 1;
    if (after == times.end() || interpolation == Interpolation::Step) return read(key, middle);
    const double length = times[key + 1] - times[key], t = (time - times[key]) / length;
    const Eigen::Vector4d from = read(key, middle), to = read(key + 1, middle);
    if (interpolation == Interpolation::Cubic) {
        const Eigen::Vector4d out = length * read(key, 2 * width), in = length * read(key + 1, 0);
        const double t2 = t * t, t3 = t2 * t;
        return (2.0 * t3 - 3.0 * t2 + 1.0) * from + (t3 - 2.0 * t2 + t) * out + (3.0 * t2 - 2.0 * t3) * to + (t3 - t2) * in;
    }
    if (!turns) return from + t * (to - from);
    return Eigen::Quaterniond(from).normalized().slerp(t, Eigen::Quaterniond(to).normalized()).coeffs();
}

Eigen::Vector4d valueAt(const RigTrack& track, double time) {
    return valueAt(track.interpolation, track.times, track.values, widthOf(track.path), track.path == Path::Rotation, time);
}

Matrix matrixOf(const RigNode& node) {
    Matrix m = Matrix::Identity();
    m.topLeftCorner<3, 3>() = node.rotation.toRotationMatrix() * node.scale.asDiagonal();
    m.topRightCorner<3, 1>() = node.translation;
    return m;
}

bool isUnit(const Eigen::Quaterniond& q) { return allFinite(q.coeffs()) && std::abs(q.norm() - 1.0) < kUnit; }

template <class Numbers>
bool inRange(const Numbers& numbers) {
    return allFinite(numbers) && std::all_of(numbers.data(), numbers.data() + numbers.size(), [](double x) { return std::abs(x) <= kMaxImportedCoordinate; });
}

bool inScene(const Vec3& place) { return allFinite(place) && place.cwiseAbs().maxCoeff() <= kMaxCoordinate; }

/// `width`: numbers of a value.
const char* faultOfKeys(Interpolation interpolation, const std::vector<double>& times, const std::vector<double>& values, std::size_t width) {
    if (times.empty() || values.size() != width * (interpolation == Interpolation::Cubic ? 3 : 1) * times.size()) return "a track has a wrong number of keys";
    if (!allFinite(times) || !inRange(values)) return "a track has a number that is not finite or too large";
    if (times.front() < 0.0) return "a track begins before 0 s";
    if (std::adjacent_find(times.begin(), times.end(), std::greater_equal<>()) != times.end()) return "the times of a track do not rise";
    return nullptr;
}

const char* faultOf(const RigTrack& track, std::size_t nodes) {
    if (track.node < 0 || static_cast<std::size_t>(track.node) >= nodes) return "a track moves a node that does not exist";
    return faultOfKeys(track.interpolation, track.times, track.values, widthOf(track.path));
}

const char* faultOf(const MorphTrack& track) {
    if (track.target.empty()) return "a track weighs a morph target without a name";
    if (const char* fault = faultOfKeys(track.interpolation, track.times, track.weights, 1)) return fault;
    const auto large = [](double weight) { return std::abs(weight) > kLargestMorphWeight; };
    return std::any_of(track.weights.begin(), track.weights.end(), large) ? "a weight of a morph target is too large" : nullptr;
}

}  // namespace

int Rig::boneIndex(std::string_view name) const {
    const auto found = std::find_if(bones.begin(), bones.end(), [&](const RigBone& bone) { return bone.name == name; });
    return found == bones.end() ? -1 : static_cast<int>(found - bones.begin());
}

int Rig::boneOfRole(std::string_view role) const {
    const auto found = std::find_if(roles.begin(), roles.end(), [&](const RigRole& r) { return r.role == role; });
    return found == roles.end() ? -1 : found->bone;
}

int Rig::clipIndex(std::string_view name) const {
    const auto found = std::find_if(clips.begin(), clips.end(), [&](const RigClip& clip) { return clip.name == name; });
    return found == clips.end() ? -1 : static_cast<int>(found - clips.begin());
}

std::string checkClip(const RigClip& clip, std::size_t nodes) {
    if (!isFinite(clip.seconds) || clip.seconds < 0.0 || clip.seconds > kLongestClip) return "a clip has no length";
    std::set<std::pair<std::int32_t, Path>> moved;
    for (const RigTrack& track : clip.tracks) {
        if (const char* fault = faultOf(track, nodes)) return fault;
        if (!moved.emplace(track.node, track.path).second) return "a clip moves a node twice";
        if (track.times.back() > clip.seconds) return "a clip is shorter than its tracks";
    }
    std::set<std::string_view> weighed;
    for (const MorphTrack& track : clip.morphs) {
        if (const char* fault = faultOf(track)) return fault;
        if (!weighed.insert(track.target).second) return "a clip weighs a morph target twice";
        if (track.times.back() > clip.seconds) return "a clip is shorter than its tracks";
    }
    return "";
}

std::string checkRig(const Rig& rig, std::size_t vertices) {
    const auto weighs = [](const RigClip& clip) { return !clip.morphs.empty(); };
    if (rig.bones.empty() && std::none_of(rig.clips.begin(), rig.clips.end(), weighs)) return "it has no bones";
    if (rig.bones.size() > kMostRigBones || rig.nodes.size() > kMostRigNodes || rig.clips.size() > kMostRigClips) return "it has too many bones or clips";
    if (!inRange(rig.toScene)) return "its unit is out of range";
    const auto before = [](std::int32_t parent, std::size_t own) { return parent >= -1 && parent < static_cast<std::int64_t>(own); };
    for (std::size_t n = 0; n < rig.nodes.size(); ++n) {
        const RigNode& node = rig.nodes[n];
        if (!before(node.parent, n)) return "a node comes before its parent";
        if (!inRange(node.translation) || !inRange(node.scale) || !isUnit(node.rotation)) return "a node has a number that is not finite or too large";
    }
    std::set<std::string_view> names;
    for (std::size_t b = 0; b < rig.bones.size(); ++b) {
        const RigBone& bone = rig.bones[b];
        if (bone.name.empty() || !names.insert(bone.name).second) return "two bones have one name";
        if (!before(bone.parent, b)) return "a bone comes before its parent";
        if (bone.node < 0 || static_cast<std::size_t>(bone.node) >= rig.nodes.size()) return "a bone has no node";
        if (!inScene(bone.head) || !inScene(bone.tail) || !isUnit(bone.rotation)) return "a bone has a number that is not finite or too large";
    }
    const RigWeights& w = rig.weights;
    if (!w.first.empty() || !w.bone.empty() || !w.weight.empty()) {
        if (w.first.size() != vertices + 1 || w.first.front() != 0 || static_cast<std::size_t>(w.first.back()) != w.bone.size() || w.bone.size() != w.weight.size())
            return "the skin has a wrong size";
        if (!std::is_sorted(w.first.begin(), w.first.end())) return "the skin has a wrong size";
        for (std::size_t v = 0; v < vertices; ++v) {
            for (auto i = static_cast<std::size_t>(w.first[v]); i < static_cast<std::size_t>(w.first[v + 1]); ++i) {
                if (w.bone[i] < 0 || static_cast<std::size_t>(w.bone[i]) >= rig.bones.size()) return "the skin refers to a bone that does not exist";
                if (i > static_cast<std::size_t>(w.first[v]) && w.bone[i] <= w.bone[i - 1]) return "the bones of a vertex are out of order";
                if (!isFinite(w.weight[i]) || w.weight[i] <= 0.0f || w.weight[i] > 1.0f) return "the skin has a weight out of range";
            }
        }
    }
    names.clear();
    for (const RigRole& role : rig.roles) {
        if (role.bone < 0 || static_cast<std::size_t>(role.bone) >= rig.bones.size()) return "a humanoid bone does not exist";
        if (!humanRole(role.role) || !names.insert(role.role).second) return "a humanoid bone is unknown or named twice";
    }
    if (rig.avatar.size() > kLargestAvatar) return "its avatar is too large";
    names.clear();
    std::size_t numbers = 0;
    for (const RigClip& clip : rig.clips) {
        if (clip.name.empty() || !names.insert(clip.name).second) return "two clips have one name";
        if (std::string fault = checkClip(clip, rig.nodes.size()); !fault.empty()) return fault;
        for (const RigTrack& track : clip.tracks) numbers += track.times.size() + track.values.size();
        for (const MorphTrack& track : clip.morphs) numbers += track.times.size() + track.weights.size();
    }
    return numbers > kMostRigNumbers ? "its clips have too many keys" : "";
}

void guessTails(Rig& rig) {
    double reach = 0.0;
    for (const RigBone& bone : rig.bones) reach = std::max(reach, (bone.head - rig.bones.front().head).norm());
    const double atHead = 1e-6 * reach;
    std::vector<std::vector<std::size_t>> children(rig.bones.size());
    for (std::size_t b = 0; b < rig.bones.size(); ++b)
        if (rig.bones[b].parent >= 0 && (rig.bones[b].head - rig.bones[static_cast<std::size_t>(rig.bones[b].parent)].head).norm() > atHead)
            children[static_cast<std::size_t>(rig.bones[b].parent)].push_back(b);
    for (std::size_t b = 0; b < rig.bones.size(); ++b) {
        RigBone& bone = rig.bones[b];
        Vec3 before = Vec3::Zero();  // of what leads here
        if (bone.parent >= 0) before = bone.head - rig.bones[static_cast<std::size_t>(bone.parent)].head;
        bone.tail = bone.head;
        if (children[b].empty()) {
            bone.tail += before;
            continue;
        }
        double straightest = -2.0, farthest = 0.0;
        for (const std::size_t child : children[b]) {
            const Vec3 along = rig.bones[child].head - bone.head;
            const double straight = before.norm() > atHead ? along.normalized().dot(before.normalized()) : 0.0;
            if (straight > straightest + 1e-6 || (straight > straightest - 1e-6 && along.norm() > farthest)) {
                straightest = straight;
                farthest = along.norm();
                bone.tail = rig.bones[child].head;
            }
        }
    }
}

void placeRig(Rig& rig, const Eigen::Matrix4d& place) {
    rig.toScene = place * rig.toScene;
    const Eigen::Matrix3d linear = place.topLeftCorner<3, 3>();
    const Vec3 shift = place.topRightCorner<3, 1>();
    const Eigen::Quaterniond turn = nearestRotation(linear);
    for (RigBone& bone : rig.bones) {
        bone.head = linear * bone.head + shift;
        bone.tail = linear * bone.tail + shift;
        bone.rotation = (turn * bone.rotation).normalized();
    }
}

Eigen::Quaterniond nearestRotation(const Eigen::Matrix3d& matrix) {
    const double size = matrix.cwiseAbs().maxCoeff();
    if (!(size > 0.0)) return Eigen::Quaterniond::Identity();
    Eigen::Matrix3d m = matrix / size;
    if (m.determinant() < 0.0) m = -m;
    const auto [u, v, values] = singularValuesOf(m);
    if (values[1] < kSmallestScale * values[0]) return Eigen::Quaterniond::Identity();
    Eigen::Matrix3d turn = u * v.transpose();
    if (turn.determinant() < 0.0) turn = u * Vec3(1.0, 1.0, -1.0).asDiagonal() * v.transpose();
    return Eigen::Quaterniond(turn).normalized();
}

std::vector<RigPose> posedRig(const Rig& rig, const RigClip& clip, double time) {
    std::vector<RigNode> nodes = rig.nodes;
    for (const RigTrack& track : clip.tracks) {
        RigNode& node = nodes[static_cast<std::size_t>(track.node)];
        const Eigen::Vector4d v = valueAt(track, time);
        switch (track.path) {
            case Path::Translation: node.translation = v.head<3>(); break;
            case Path::Scale: node.scale = v.head<3>(); break;
            case Path::Rotation:
                if (v.norm() > 0.0) node.rotation = Eigen::Quaterniond(v).normalized();
                break;
        }
    }
    std::vector<Matrix> global(nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const Matrix& parent = nodes[n].parent < 0 ? rig.toScene : global[static_cast<std::size_t>(nodes[n].parent)];
        global[n] = parent * matrixOf(nodes[n]);
        if (global[n].cwiseAbs().maxCoeff() > kFarthest) global[n] = parent;
    }
    std::vector<RigPose> pose;
    for (const RigBone& bone : rig.bones) {
        const Matrix& m = global[static_cast<std::size_t>(bone.node)];
        pose.push_back({m.topRightCorner<3, 1>(), nearestRotation(m.topLeftCorner<3, 3>())});
    }
    return pose;
}

double weightAt(const MorphTrack& track, double time) { return valueAt(track.interpolation, track.times, track.weights, 1, false, time)[0]; }

}  // namespace imomushi
