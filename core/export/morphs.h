// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "core/export/motion.h"

namespace imomushi {

/// An element as a rigid frame, morph targets and their weights: x = rotation (rest - middle + sum of weight * target) + place. V: Motion::Seen.
struct ElementMorphs {
    Vec3 middle = Vec3::Zero();  ///< m: the origin of its node
    /// Targets and weights are those of the other elements under its mesh, too: what each does to its vertices; the matrices of all elements add up.
    bool shared = false;
    Points rest;                 ///< #V x 3, m, from the middle
    Eigen::MatrixXf targets;     ///< 3 #V x #targets, m per unit of weight
    std::vector<std::string> names;
    /// #targets x #columns: weights of what v and body loads do, see driver.h. Targets that were fitted have zeros.
    Eigen::MatrixXd matrix;
    Eigen::VectorXd reach;       ///< per target: the farthest that a unit of weight moves a vertex, m
    struct Track {
        std::vector<double> times;
        Eigen::Matrix4Xd rotations;  ///< x y z w, signs without jumps
        Eigen::Matrix3Xd places;     ///< m
        Eigen::MatrixXd weights;     ///< #targets x #keys, within -1 ... 1
    };
    std::vector<Track> tracks;   ///< per clip
};

struct MorphErrors {
    ExportError warped, touched, followed, dropped;
};

/// The columns of A' as targets, exactly; what they cannot say (large motions, fingers) by targets fitted to the frames of the clips, as many as kMaxFitted.
/// With options.targets, or where there are more than kMaxTargets columns (kMaxOfMesh of all elements under a mesh), the best combinations of all instead:
/// principal components of what the clips do.
/// `live`: targets that the clips do not use stay, and weights have room for other poses.
/// Errors: "cancelled".
Result<std::vector<ElementMorphs>> buildMorphs(Motion& motion, const ExportScene& scene, const ExportOptions& options, bool live, MorphErrors& errors,
                                               const Progress& progress);

inline constexpr int kMaxFitted = 24;
inline constexpr int kMaxTargets = 128;  // more are a burden in every engine
inline constexpr int kMaxOfMesh = 240;   // phones failed above

}  // namespace imomushi
