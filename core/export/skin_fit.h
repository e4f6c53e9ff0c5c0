// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "core/export/motion.h"

namespace imomushi {

/// Linear blend skinning that is as near to the elastic body as its poses allow. Joints of the skin: the frame of each element, each plane where
/// elements meet, handles of elements under a mesh of the scene, and, where body loads act, a load joint per element: the rigid motion that best fits its deformation by the loads.
/// Where the scene has rigs their bones come first, in the order of their files. The bone that leads an element stands in for its frame (an element with several bones keeps
/// both), and its weights are shared among the bones that were merged into it as the file shares them: while takes play these move as one, and animations of the old
/// skeleton still bend what the file has there. The other joints hang on such bones, and those without weight are left out.
struct FittedSkin {
    static constexpr int kMax = 4;
    struct Vertex {
        std::array<int, kMax> joint{};
        std::array<float, kMax> weight{};  ///< descending, sum 1
    };
    struct Joint {
        std::string name;
        Vec3 origin = Vec3::Zero();  ///< m, at rest
        int rigBone = -1;            ///< the bone that it is, among those of all rigs; or
        int parent = -1;             ///< the one that it hangs on; -1: it stands free
    };
    struct Track {
        Eigen::Matrix4Xd rotations;  ///< per key, x y z w, signs without jumps
        Eigen::Matrix3Xd places;     ///< m
    };
    std::vector<Joint> joints;
    std::vector<std::vector<Vertex>> elements;  ///< per element, per vertex that goes out (Motion::Seen)
    /// Per element: where the skin has these when no joint has moved, m. Settled: body loads deform the character at rest, and this is what suits
    /// the clips best; else its rest positions.
    std::vector<Points> bind;
    bool settled = false;
    std::vector<std::vector<Track>> tracks;     ///< per clip, per joint
    ExportError error;                          ///< over frames of the clips, all where that is affordable
};

/// Weights, and where it is settled the bind positions, by least squares over frames of the clips and a little over the standard poses of the skeleton
/// (character/standard_poses.h) and its rest; weights are not negative, and welded vertices have the same. Errors: "cancelled".
Result<FittedSkin> fitSkin(Motion& motion, const ExportScene& scene, const Progress& progress);

}  // namespace imomushi
