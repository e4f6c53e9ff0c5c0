// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/dynamics/explicit_joint_dynamics.h"

#include <algorithm>
#include <cmath>

#include "core/skeleton/bone_tree.h"

namespace imomushi {

namespace {
constexpr double kDivergedSizes = 10.0;
constexpr double kParallel = 1e-9;  // part of a held motion that must not lie along those before it
}  // namespace

Result<ExplicitJointDynamics> ExplicitJointDynamics::build(const Input& input) {
    const Eigen::Index n = input.mass.size();
    if (n == 0 || !allFinite(input.mass) || !(input.mass.minCoeff() > 0.0))
        return fail("bad-value", "A vertex of a joint face has no mass: give its element a density above zero.");
    if (!std::isfinite(input.damping) || input.damping < 0.0) return fail("bad-value", "The damping of joint-face dynamics is negative: choose 0 or more.");
    if (!std::isfinite(input.seconds) || input.seconds < 1e-6 || input.seconds > 1.0)
        return fail("bad-value", "The step of joint-face dynamics is not between a microsecond and a second: choose one that is.");
    if (!std::isfinite(input.size) || input.size <= 0.0 || input.size > 1e30)
        return fail("bad-value", "The size of the character is not above zero: give its extent in metres.");
    if (input.held.cols() > 0 && (input.held.rows() != n || !allFinite(input.held)))
        return fail("bad-value", "A held motion does not fit the joint faces: give one finite number per degree of freedom.");

    ExplicitJointDynamics out;
    out.mass_ = input.mass;
    out.damping_ = input.damping;
    out.seconds_ = input.seconds;
    out.farthest_ = kDivergedSizes * input.size;
    Eigen::MatrixXd held(n, 0);
    for (Eigen::Index k = 0; k < input.held.cols(); ++k) {
        Eigen::VectorXd motion = input.held.col(k);
        const double before = std::sqrt(motion.dot(input.mass.cwiseProduct(motion)));
        for (int twice = 0; twice < 2; ++twice)
            for (Eigen::Index j = 0; j < held.cols(); ++j) motion -= held.col(j) * held.col(j).dot(input.mass.cwiseProduct(motion));
        const double left = std::sqrt(motion.dot(input.mass.cwiseProduct(motion)));
        if (!(left > kParallel * before)) continue;
        held.conservativeResize(Eigen::NoChange, held.cols() + 1);
        held.rightCols(1) = motion / left;
    }
    out.held_ = held.sparseView();
    out.displacement_ = out.velocity_ = out.force_ = out.lastGood_ = Eigen::VectorXd::Zero(n);
    out.along_.resize(out.held_.cols());
    return out;
}

void ExplicitJointDynamics::reset(const Eigen::VectorXd& displacement) {
    displacement_.setZero();
    if (displacement.size() == displacement_.size() && allFinite(displacement)) displacement_ = displacement;
    velocity_.setZero();
    waiting_ = 0.0;
    divergences_ = 0;
}

bool ExplicitJointDynamics::good() const {
    for (Eigen::Index i = 0; i < displacement_.size(); ++i) {
        if (!std::isfinite(force_[i]) || !std::isfinite(velocity_[i]) || !std::isfinite(displacement_[i])) return false;
        if (std::abs(displacement_[i]) > farthest_ || std::abs(velocity_[i]) * seconds_ > farthest_) return false;
    }
    return true;
}

bool ExplicitJointDynamics::step(double seconds, const Forces& forces) {
    if (!std::isfinite(seconds) || seconds <= 0.0) return true;
    waiting_ = std::min(waiting_ + seconds, kMaxSteps * seconds_);
    lastGood_ = displacement_;
    for (; waiting_ >= seconds_ * (1.0 - 1e-9); waiting_ = std::max(waiting_ - seconds_, 0.0)) {
        forces(displacement_, force_);
        bool fine = force_.size() == mass_.size();
        // Forces of a state that is still small can be beyond all bounds: they are looked at before they are used.
        for (Eigen::Index i = 0; fine && i < mass_.size(); ++i) {
            const double most = mass_[i] * farthest_ / (seconds_ * seconds_);
            fine = std::isfinite(force_[i]) && std::abs(force_[i]) <= most;
        }
        if (fine) {
            velocity_ += seconds_ * (force_.cwiseQuotient(mass_) - damping_ * velocity_);
            if (held_.cols() > 0) {
                force_ = mass_.cwiseProduct(velocity_);
                along_.noalias() = held_.transpose() * force_;
                velocity_.noalias() -= held_ * along_;
            }
            displacement_ += seconds_ * velocity_;
            fine = good();
        }
        if (!fine) {
            force_.resize(mass_.size());
            displacement_ = lastGood_;
            velocity_.setZero();
            waiting_ = 0.0;
            ++divergences_;
            return false;
        }
    }
    return true;
}

}  // namespace imomushi
