// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// One point of contact. A force pushes along - normal, unilaterally, and sticks up to a Coulomb cone.
struct ContactPoint {
    enum class How : char { None, Stick, Slip };

    Vec3 normal = Vec3::UnitZ();  ///< outward, of unit length
    Vec3 goal = Vec3::Zero();     ///< displacement that the forces of all points are to make here, m
    Vec3 force = Vec3::Zero();    ///< what is solved for
    Vec3 slip = Vec3::Zero();     ///< direction of friction while it slips, times its coefficient
    How how = How::None;
};

/// 0 for a vector that has no direction.
[[nodiscard]] Vec3 unitOrZero(const Vec3& v);

/// Unilateral, frictional contact of a few points on an elastic body (James and Pai 1999). Points are told apart by slots, which keep their
/// compliances from frame to frame. Allocates where it is made, nowhere else; the same calls give the same bytes.
class ContactSolver {
public:
    explicit ContactSolver(std::size_t slots);

    /// Displacement of the point in slot `of` by the force of the one in slot `by`. A slot's own is positive definite.
    [[nodiscard]] Eigen::Matrix3d& compliance(std::size_t of, std::size_t by) { return compliance_[of * slots_ + by]; }
    [[nodiscard]] const Eigen::Matrix3d& compliance(std::size_t of, std::size_t by) const { return compliance_[of * slots_ + by]; }

    /// The force of a point alone that moves it by `gap`: none, sticking or slipping.
    static void solveAlone(const Eigen::Matrix3d& compliance, const Vec3& gap, double friction, ContactPoint& point);

    /// A point of the next solve(), at most once per slot; it must live until then.
    void add(std::size_t slot, ContactPoint& point) { active_.push_back({slot, &point}); }
    /// Forces, slips and states of the points that were added, and forgets them. slack: m, by how much a point that is left alone may miss its goal.
    void solve(double friction, double slack);

private:
    struct Active {
        std::size_t slot = 0;
        ContactPoint* point = nullptr;
    };
    void sweep(double friction);
    bool solveTogether(double friction, double slack);
    [[nodiscard]] Vec3 residual(std::size_t i) const;

    std::size_t slots_ = 0;
    std::vector<Eigen::Matrix3d> compliance_;  // slots x slots
    std::vector<Active> active_;
    std::vector<std::size_t> at_;  // per active point its first equation, and their number
    std::vector<double> matrix_, right_;
    std::vector<Vec3> kept_;
};

}  // namespace imomushi
