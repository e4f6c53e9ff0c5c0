// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/base/result.h"
#include "core/reduction/element_response.h"

namespace imomushi {

/// Two elements of the same triangles, joint faces, Poisson ratio, basis and solver mesh are congruent when a rotation and a shift carry the
/// vertices of one to those of the other. The response of one then is that of the other, turned. Of mirror images the triangles of one are those of the other
/// turned round, their second and third corners exchanged; elasticity knows no handedness, so that the response is reflected in the same way.
struct Congruence {
    Eigen::Matrix3d rotation;              ///< to = rotation * from + shift; a rotation and a reflection (of determinant -1) where `mirrored`
    bool mirrored = false;
    Vec3 shift;                            ///< m
    double miss = 0.0;                     ///< largest distance of a vertex from where it should be, in diagonals of the bounding box
    /// Per face, g_f x g_f: the joint parameters of `from` that move its face as a unit of each joint parameter of `to` moves the other's. The
    /// frames of the faces follow global axes, so they are not turned with the body.
    std::vector<Eigen::MatrixXd> columns;
    std::vector<FaceBasis> bases;          ///< of `to`
    double modeMiss = 0.0;                 ///< what `columns` leave of a joint mode, relative

    /// Vertices of copies in files agree to the digits that files hold: 1e-7 of their coordinates in single precision, 1e-6 in six decimal
    /// digits. A response follows the shape continuously, so that it changes by about as much, a thousand times the width over the
    /// length at worst (thin plates): less than discretisation leaves (1e-2).
    static constexpr double kMiss = 1e-6;
    /// A small face of a large body sees the same distance as a larger part of itself.
    static constexpr double kModeMiss = 1e-5;

    /// The response of `to` from that of `from`: A'_to = R A'_from N, K_to = N^T K_from N with N of blocks `columns`, tractions like A', loads and
    /// fingers turned on both sides; quality and cost are those of `from`. One thread. Errors: "bad-value" (a response that is not one of `from`).
    [[nodiscard]] Result<ElementResponse> carry(const ElementResponse& from) const;
};

/// How `to` is congruent with `from`; empty where it is not (or has no joint face). Time grows with the number of vertices.
std::optional<Congruence> findCongruence(const ResponseInput& from, const ResponseInput& to);

/// What carrying costs where solving `from` costs `solved`; its size and time per frame are the same.
ResponseEstimate carryEstimate(const ResponseEstimate& solved, const ResponseInput& to);

}  // namespace imomushi
