// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/vec3.h"

namespace imomushi {

/// A bone of a file at rest, which is how the file's mesh came in. Metres, +Y up.
struct RigBone {
    std::string name;              ///< UTF-8, not empty, unique in the rig
    std::int32_t parent = -1;      ///< a bone before this one, -1: a root
    std::int32_t node = -1;        ///< into Rig::nodes
    Vec3 head = Vec3::Zero();      ///< where it turns
    Vec3 tail = Vec3::Zero();      ///< files do not say it: guessed, see guessTails(). May be the head
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< unit: takes the bone's axes to the scene's
};

/// A node of the file that carries bones, or is one: as the file has it where no clip moves it, in the file's own unit and axes, relative to its parent.
struct RigNode {
    std::int32_t parent = -1;      ///< a node before this one, -1: a root
    Vec3 translation = Vec3::Zero();
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< unit
    Vec3 scale = Vec3::Ones();
    std::string name = {};  ///< UTF-8, not unique; empty: not known, or that of its bone
};

/// How much each bone moves each vertex of a render model (RenderModel::mesh.body). Vertex v has the entries [first[v], first[v + 1]).
struct RigWeights {
    std::vector<std::int32_t> first;  ///< #V + 1, ascending from 0; or empty: the file binds no vertex
    std::vector<std::int32_t> bone;   ///< ascending for each vertex
    std::vector<float> weight;        ///< in (0, 1], of a vertex their sum is 1. A vertex without entries is bound to no bone
    [[nodiscard]] bool empty() const { return bone.empty(); }
};

/// What moves one property of one node in a clip.
struct RigTrack {
    enum class Path : std::uint8_t { Translation, Rotation, Scale };
    enum class Interpolation : std::uint8_t { Step, Linear, Cubic };  ///< of rotations: spherical where linear. Cubic: Hermite, glTF 2.0 appendix C.5
    std::int32_t node = 0;
    Path path = Path::Translation;
    Interpolation interpolation = Interpolation::Linear;
    std::vector<double> times;     ///< s, ascending, the first >= 0
    std::vector<double> values;    ///< per time 3, or 4 of rotations (x y z w, not zero); thrice as many where cubic: in-tangent, value, out-tangent
};

/// What weighs a morph target in a clip.
struct MorphTrack {
    std::string target;            ///< MorphTarget::name
    RigTrack::Interpolation interpolation = RigTrack::Interpolation::Linear;
    std::vector<double> times;     ///< s, ascending, the first >= 0
    std::vector<double> weights;   ///< per time one; thrice as many where cubic: in-tangent, value, out-tangent
};

/// An animation of the file.
struct RigClip {
    std::string name;              ///< UTF-8, not empty, unique in the rig
    double seconds = 0.0;          ///< the last time of its tracks
    std::vector<RigTrack> tracks;  ///< at most one per node and path
    std::vector<MorphTrack> morphs = {};  ///< at most one per target
};

/// What a bone is of a human.
struct RigRole {
    std::string role;              ///< of kHumanRoles (avatar.h)
    std::int32_t bone = 0;
};

/// The skeleton that a file brings: bones, which of them moves which vertex, and animations. A file without bones whose clips weigh morph targets brings these clips alone.
struct Rig {
    std::vector<RigBone> bones;    ///< parents before children
    std::vector<RigNode> nodes;    ///< parents before children
    Eigen::Matrix4d toScene = Eigen::Matrix4d::Identity();  ///< from the file's unit and axes to the scene's
    RigWeights weights;
    std::vector<RigClip> clips;
    std::vector<RigRole> roles = {};  ///< as the file says, each at most once, in the order of kHumanRoles; most files say nothing
    /// What a VRM file says of its figure, JSON in UTF-8 (vrm_reader.h); empty: it is none. Nothing of it is believed.
    std::string avatar = {};

    [[nodiscard]] int boneOfRole(std::string_view role) const;  ///< -1: no bone has it
    [[nodiscard]] int boneIndex(std::string_view name) const;  ///< -1: no such bone
    [[nodiscard]] int clipIndex(std::string_view name) const;  ///< -1: no such clip
};

/// Limits of what is kept of a file; more is left out with a word to the artist.
inline constexpr std::size_t kMostRigBones = 4096, kMostRigNodes = 65536, kMostRigClips = 1024;
inline constexpr std::size_t kMostRigNumbers = std::size_t{1} << 25;  ///< of all tracks, times included
inline constexpr std::size_t kLargestAvatar = std::size_t{1} << 22;   ///< bytes of Rig::avatar

/// Why a rig cannot be used: indices out of range, parents after children, names that are empty or used twice, numbers that are not finite, tracks of a wrong size.
/// Empty: it can. `vertices`: of the render model.
std::string checkRig(const Rig& rig, std::size_t vertices);

/// The same of one clip, whose nodes are these many.
std::string checkClip(const RigClip& clip, std::size_t nodes);

/// Sets the tails from the heads: that of the only child; of several, the child that goes on straightest; without children, as far on in the direction of the parent as the
/// parent is long. Children at the head itself do not count.
void guessTails(Rig& rig);

/// Moves, turns and scales a rig: heads and tails, and where clips take them.
void placeRig(Rig& rig, const Eigen::Matrix4d& place);

/// The rotation nearest to a matrix, which may scale, shear and mirror; identity where it flattens space to a line.
Eigen::Quaterniond nearestRotation(const Eigen::Matrix3d& m);

/// Where a bone is in a clip.
struct RigPose {
    Vec3 head = Vec3::Zero();  ///< m
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< unit, as RigBone::rotation
};
/// All bones at a time of a clip (s; outside of a track its first or last key holds). #bones.
std::vector<RigPose> posedRig(const Rig& rig, const RigClip& clip, double time);
/// The same of a weight.
double weightAt(const MorphTrack& track, double time);

}  // namespace imomushi
