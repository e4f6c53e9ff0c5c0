// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "core/base/vec3.h"

namespace imomushi {

/// The rigid motion that is nearest to those of some parts of a body at once. Parts that all move alike give their own motion, by any angle. Where their centres
/// are turned one way and the parts themselves another, it is between the two, so that a part that is pulled across the body does not flip it.
///   rotation  maximises sum_i area_i (d_i . R r_i + l_i^2 tr(R_i^T R)),  r_i, d_i: the part's centre about the mean one, at rest and now, d_i no longer than r_i;
///             l_i^2 = the part's size squared + the mean square of all r_i   (Horn, Closed-form solution of absolute orientation, 1987)
///   shift     takes the mean centre at rest to the one now
/// Allocates in its constructor only.
class RigidFit {
public:
    struct Part {
        Vec3 centre = Vec3::Zero();  ///< m, at rest
        double area = 0.0;           ///< m^2, > 0
        double size = 0.0;           ///< m, > 0
    };
    explicit RigidFit(std::vector<Part> parts);

    /// The motion of a part: where its centre is (m) and how it is turned.
    void set(std::size_t part, const Vec3& at, const Eigen::Quaterniond& turn);
    /// Real part of `rotation` >= 0. False: the parts disagree so much that no rotation is better than another, `rotation` stays as it is.
    bool solve(Eigen::Quaterniond& rotation, Vec3& shift) const;

private:
    std::vector<Part> parts_;
    std::vector<Vec3> at_;
    std::vector<Eigen::Quaterniond> turn_;
    Vec3 mean_ = Vec3::Zero();  // of centres at rest, by area
    double area_ = 0.0, spread2_ = 0.0;
};

}  // namespace imomushi
