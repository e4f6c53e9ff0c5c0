// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/mesh/rig.h"

namespace imomushi {

/// Which flesh of a body each bone of a rig moves: by the skin of the file, or where that binds nothing, by the nearest bone.
struct RigFlesh {
    std::vector<double> share;   ///< per bone, of the volume of the body, 0...1; their sum is 1
    /// Per bone what carries it, -1: none. Its parent in the file; but a small limb that the file hangs on its root beside the trunk (feet that inverse kinematics move) hangs on that bone
    /// of the trunk's limbs whose flesh it touches most.
    std::vector<int> carrier;
    std::vector<Vec3> middle;    ///< per bone, of its flesh, m; its head where it has none
    std::vector<double> volume;  ///< per vertex of the body, of the flesh beneath it, in parts of the whole
    std::vector<std::int32_t> first, bone;  ///< vertex v of the body has the entries [first[v], first[v + 1])
    std::vector<double> weight;             ///< in (0, 1], of a vertex their sum is 1
    /// Per bone a factor of the least share from which on it is kept: less than 1 for the limbs of a human, down to hands and feet, and for the first bone of what swings (hair of a VRM file).
    std::vector<double> leastFactor;
    bool skinned = false;
};

inline Vec3 vertexPlace(const Points& points, Eigen::Index i) { return points.row(i).transpose(); }

/// `render`: the mesh whose vertices the weights of the rig are for; `body`: closed.
RigFlesh rigFlesh(const Rig& rig, const TriangleMesh& render, const TriangleMesh& body);

/// A rig with few bones: what moves little flesh is merged into what carries it.
struct MergedRig {
    std::vector<int> kept;      ///< bones of the rig, parents first; the first is the root, and the only one without a parent
    std::vector<int> parent;    ///< per kept bone: into `kept`, -1: the root
    std::vector<int> mover;     ///< per bone of the rig: into `kept`, which moves its flesh
    std::vector<double> share;  ///< per kept bone, of the flesh, with what was merged into it
    struct Merge {
        int bone = 0;           ///< of the rig
        double share = 0.0;     ///< its own flesh and what was merged into it before
        std::string why;        ///< one sentence
    };
    std::vector<Merge> merges;  ///< ascending by bone
};

/// Merges bones that move less than `least` of the flesh (0...1; times RigFlesh::leastFactor) into what carries them, from the tips inward, so that fingers make a hand; a root that moves too little into its
/// largest child, whose siblings then hang on it. `never`: bones that are merged in any case, with the reason; their children stay. A root among them goes the way of one that moves too little. At least one bone is kept.
MergedRig mergeRig(const Rig& rig, const RigFlesh& flesh, double least, const std::vector<std::pair<int, std::string>>& never = {});

}  // namespace imomushi
