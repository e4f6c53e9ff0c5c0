// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "core/character/character.h"
#include "core/dynamics/joint_dynamics.h"

namespace imomushi {

/// Joint dynamics of one joint (model.md section 6): its faces jiggle together about where the pose wants them, by nine parameters in the axes of its first
/// face: in-plane stretch, tilts, shifts and twist, as the columns of the basis "affine". Mass and stiffness are those of its elements while their other
/// faces are held.
class JointJiggle {
public:
    /// Nothing when no element of the joint has a response. `stiffness` of elements counts relative to each other only. Errors: "bad-value".
    static Result<std::optional<JointJiggle>> build(const CharacterInput& input, const CharacterInput::Joint& joint, const CharacterEffects::JointDynamics& settings);
    /// Other frequency and damping; it stops. Errors: "bad-value"; then nothing changes.
    Result<void> set(const CharacterEffects::JointDynamics& settings);

    /// Where the pose wants the joint: rotation (rest to world), place (m, world) and in-plane stretch.
    struct Place {
        Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
        Vec3 at = Vec3::Zero();
        double stretch = 1.0;
    };
    void reset(const Place& wanted);
    /// One frame: `seconds` pass (>= 0; none: the joint stays as far from the pose as it is); `wanted` is changed to where the joint is. `stretch`: how its face stretches besides, in its plane, about 1, rest axes. Neither allocates,
    /// locks nor fails.
    void step(double seconds, Place& wanted, Eigen::Matrix3d& stretch);

    [[nodiscard]] bool resting() const { return dynamics_.resting(); }

private:
    JointJiggle(JointDynamics dynamics, Eigen::MatrixXd mass, Eigen::MatrixXd stiffness)
        : dynamics_(std::move(dynamics)), mass_(std::move(mass)), stiffness_(std::move(stiffness)) {}

    void follow(const Place& wanted);

    JointDynamics dynamics_;
    Eigen::MatrixXd mass_, stiffness_;
    Eigen::Matrix3d axes_ = Eigen::Matrix3d::Identity();  // of the first face, rest
    double size_ = 1.0;                                   // m, of the largest face
    Place last_;
    Eigen::VectorXd target_ = Eigen::VectorXd::Zero(9);   // how far the pose has taken the joint in its own axes, all in all
};

}  // namespace imomushi
