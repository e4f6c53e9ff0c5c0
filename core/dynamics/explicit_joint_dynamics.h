// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <functional>

#include "core/base/result.h"

namespace imomushi {

/// Joint-face dynamics of the paper's previous model, kept for comparison (the manual's model, "The previous model"): every vertex of the joint faces has an equation of motion
/// that the boundary elements' tractions drive, integrated explicitly,
///     velocity += h (force / mass - damping velocity),  displacement += h velocity,
/// with the step h that the artist chose. It diverges where h is above 2 / omega of the fastest mode: stiffer material, finer faces or longer frames.
/// Divergence is noticed within the frame, which is then undone: the last good state stays, at rest, and nothing that is not finite is ever left behind.
class ExplicitJointDynamics {
public:
    struct Input {
        Eigen::VectorXd mass;        ///< kg per degree of freedom (3 per face vertex: x, y, z), > 0
        double damping = 1.0;        ///< 1/s, >= 0
        double seconds = 1.0 / 600;  ///< of one step, 1e-6 ... 1
        double size = 1.0;           ///< m, of the character: a displacement beyond ten of it has diverged
        /// #dofs x k: motions that bones prescribe (a face that moves as a whole); no motion along them remains. May have no columns.
        Eigen::MatrixXd held;
    };
    /// Errors: "bad-value".
    static Result<ExplicitJointDynamics> build(const Input& input);

    /// The force on every degree of freedom, N, at these displacements, m: minus the tractions, times area. Writes all of `force`.
    using Forces = std::function<void(const Eigen::VectorXd& displacement, Eigen::VectorXd& force)>;

    static constexpr int kMaxSteps = 1000;  ///< per frame; the rest of its time is dropped

    /// One frame. Steps that do not fill up wait for the next. False: it diverged. Allocates nothing itself.
    bool step(double seconds, const Forces& forces);

    /// Displacements at rest, #dofs.
    void reset(const Eigen::VectorXd& displacement);

    [[nodiscard]] const Eigen::VectorXd& displacement() const { return displacement_; }  ///< m, #dofs, always finite
    [[nodiscard]] const Eigen::VectorXd& velocity() const { return velocity_; }          ///< m/s, #dofs, always finite
    [[nodiscard]] int divergences() const { return divergences_; }                       ///< since reset() or build()

private:
    ExplicitJointDynamics() = default;
    [[nodiscard]] bool good() const;

    Eigen::VectorXd mass_, displacement_, velocity_, force_, lastGood_, along_;
    Eigen::SparseMatrix<double> held_;  // mass-orthonormal
    double damping_ = 0.0, seconds_ = 0.0, farthest_ = 0.0, waiting_ = 0.0;
    int divergences_ = 0;
};

}  // namespace imomushi
