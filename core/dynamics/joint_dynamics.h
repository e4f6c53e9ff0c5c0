// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "core/base/result.h"

namespace imomushi {

/// Joint dynamics, implicit (the manual's effects): joint parameters v oscillate about the values `target` that the pose prescribes,
///     M y'' + D y' + K y = f - M target'',   y = v - target,
/// with reduced mass M and joint stiffness K, in the eigenmodes K phi = lambda M phi. Each mode is a damped oscillator that is advanced by its exact solution,
/// so that nothing diverges however long the frame and however stiff the mode, and motion depends on the frame rate only as far as frames sample the
/// targets. Modes without stiffness (rigid motions) follow the targets.
class JointDynamics {
public:
    struct Input {
        Eigen::MatrixXd mass;       ///< g x g, symmetric positive semidefinite with a positive diagonal, kg times the units of v squared
        Eigen::MatrixXd stiffness;  ///< g x g, symmetric positive semidefinite, up to a factor: `hertz` sets the scale
        double hertz = 4.0;         ///< of the softest mode, 0.01 ... 1000; the others keep their ratios to it
        double damping = 0.2;       ///< ratio, of all modes, 0 ... 10
        /// The stiffness with each element's part of it times that element's own damping: a mode has `damping` times what is stored in it as elastic energy, so
        /// weighted, over that energy (composite modal damping). Empty: the stiffness.
        Eigen::MatrixXd damped = {};
    };
    /// Errors: "bad-value".
    static Result<JointDynamics> build(const Input& input);

    /// Stops at these parameters.
    void reset(const Eigen::VectorXd& target);

    /// One frame: `seconds` pass (>= 0), in which the targets move evenly from the last ones to `target`. What is not finite or not of g numbers is
    /// refused: nothing moves, refused() says so. Neither allocates, locks nor fails.
    void step(double seconds, const Eigen::VectorXd& target);
    /// The same under generalised forces f (N times the units of v) that stay all through the frame.
    void step(double seconds, const Eigen::VectorXd& target, const Eigen::VectorXd& force);

    [[nodiscard]] const Eigen::VectorXd& parameters() const { return parameters_; }  ///< v at the end of the last frame, g
    [[nodiscard]] bool resting() const { return resting_; }  ///< v is the target, bit for bit, and stays until targets or forces change
    [[nodiscard]] bool refused() const { return refused_; }  ///< of the last step()
    [[nodiscard]] double energy() const;                     ///< J: kinetic relative to the moving targets, and elastic
    [[nodiscard]] const Eigen::VectorXd& frequencies() const { return hertz_; }  ///< Hz per mode, ascending

private:
    JointDynamics() = default;
    void advance(double seconds, const Eigen::VectorXd& target, const Eigen::VectorXd* force);

    Eigen::MatrixXd shapes_;        // g x modes, mass-orthonormal
    Eigen::MatrixXd momenta_;       // g x modes: mass x shapes
    Eigen::VectorXd hertz_;
    Eigen::VectorXd damping_;       // per mode
    double restAmplitude_ = 0.0;
    Eigen::VectorXd target_, parameters_, change_;
    Eigen::VectorXd amplitude_, rate_, slope_, push_;  // per mode: of y, of v - and of the targets; static response to the force
    bool resting_ = true, refused_ = false;
};

}  // namespace imomushi
