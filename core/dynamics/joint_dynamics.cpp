// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/dynamics/joint_dynamics.h"

#include <algorithm>
#include <cmath>

#include "core/base/decompositions.h"
#include "core/dynamics/bone_dynamics.h"

namespace imomushi {

namespace {

constexpr double kMassless = 1e-9;       // added to the mass, whose diagonal is scaled to 1: modes that move nothing become very fast
constexpr double kRigid = 1e-8;          // of the largest eigenvalue: below it a mode has no stiffness; collocation leaves about 1e-10
constexpr double kAsymmetry = 1e-6;      // of the largest entry
constexpr double kNegative = 1e-6;       // of the largest eigenvalue
constexpr double kRestAmplitude = 1e-6;  // of a parameter's unit
constexpr double kLargestParameter = 1e12;       // larger parameters and forces are refused: squares stay finite

bool usable(const Eigen::VectorXd& v, Eigen::Index size) {
    if (v.size() != size) return false;
    for (Eigen::Index i = 0; i < size; ++i)
        if (!std::isfinite(v[i]) || std::abs(v[i]) > kLargestParameter) return false;
    return true;
}

bool symmetric(const Eigen::MatrixXd& m) {
    return m.rows() == m.cols() && allFinite(m) && (m - m.transpose()).cwiseAbs().maxCoeff() <= kAsymmetry * m.cwiseAbs().maxCoeff();
}

// y'' + 2 ratio omega y' + omega^2 y = 0 over t: exact.
void oscillate(double omega, double ratio, double t, double& y, double& rate) {
    const double decay = ratio * omega, y0 = y, rate0 = rate;
    const double square = omega * omega * (1.0 - ratio * ratio);
    // cosine, and sine over its frequency, times the decay; hyperbolic beyond critical damping. Near it the frequency is small: series.
    double c = 0.0, s = 0.0;
    const double w = std::sqrt(std::abs(square)), angle = w * t;
    if (angle < 1e-4) {
        const double e = std::exp(-decay * t), z = square * t * t;
        c = e * (1.0 - 0.5 * z);
        s = e * t * (1.0 - z / 6.0);
    } else if (square > 0.0) {
        const double e = std::exp(-decay * t);
        c = e * std::cos(angle);
        s = e * std::sin(angle) / w;
    } else {
        const double slow = std::exp((w - decay) * t), fast = std::exp(-(w + decay) * t);
        c = 0.5 * (slow + fast);
        s = 0.5 * (slow - fast) / w;
    }
    y = y0 * (c + decay * s) + rate0 * s;
    rate = rate0 * (c - decay * s) - y0 * omega * omega * s;
}

}  // namespace

Result<JointDynamics> JointDynamics::build(const Input& input) {
    const Eigen::Index g = input.mass.rows();
    if (g == 0 || input.stiffness.rows() != g || !symmetric(input.mass) || !symmetric(input.stiffness))
        return fail("bad-value", "Mass and stiffness of joint dynamics are not symmetric matrices of one size: symmetrise them.");
    if (!(input.mass.diagonal().minCoeff() > 0.0)) return fail("bad-value", "A joint parameter has no mass: give its element a density above zero.");
    if (input.damped.size() != 0 && (input.damped.rows() != g || !symmetric(input.damped)))
        return fail("bad-value", "The damped stiffness of joint dynamics is not a symmetric matrix of their size: symmetrise it.");
    if (!std::isfinite(input.hertz) || input.hertz < BoneSpring::kMinHertz || input.hertz > BoneSpring::kMaxHertz)
        return fail("bad-value", "The frequency of joint dynamics is not between 0.01 and 1000 Hz: choose one that is.");
    if (!std::isfinite(input.damping) || input.damping < 0.0 || input.damping > BoneSpring::kMaxDamping)
        return fail("bad-value", "The damping ratio of joint dynamics is not between 0 and 10: choose one that is.");

    const Eigen::VectorXd scale = input.mass.diagonal().cwiseSqrt().cwiseInverse();
    Eigen::MatrixXd mass = scale.asDiagonal() * (0.5 * (input.mass + input.mass.transpose())) * scale.asDiagonal();
    mass.diagonal().array() += kMassless;
    const Eigen::MatrixXd stiffness = scale.asDiagonal() * (0.5 * (input.stiffness + input.stiffness.transpose())) * scale.asDiagonal();
    const auto solver = eigenpairsOf(stiffness, mass);
    if (!solver.converged || !allFinite(solver.values) || !allFinite(solver.vectors))
        return fail("bad-value", "The mass of joint dynamics is not positive semidefinite: check the elements' densities.");
    const Eigen::VectorXd& lambda = solver.values;
    const double most = lambda[g - 1];
    if (!(most > 0.0) || lambda[0] < -kNegative * most)
        return fail("bad-value", "The stiffness of joint dynamics is not positive semidefinite: precompute the elements again.");

    JointDynamics out;
    Eigen::Index rigid = 0;
    while (lambda[rigid] <= kRigid * most) ++rigid;
    const Eigen::Index modes = g - rigid;
    out.shapes_ = scale.asDiagonal() * solver.vectors.rightCols(modes);
    out.momenta_ = scale.cwiseInverse().asDiagonal() * (mass * solver.vectors.rightCols(modes));
    out.hertz_ = input.hertz * (lambda.tail(modes) / lambda[rigid]).cwiseSqrt();
    out.damping_ = Eigen::VectorXd::Constant(modes, input.damping);
    if (input.damped.size() != 0)
        for (Eigen::Index i = 0; i < modes; ++i) {
            const auto shape = out.shapes_.col(i);
            out.damping_[i] *= std::max(shape.dot(input.damped * shape) / shape.dot(input.stiffness * shape), 0.0);
        }
    out.restAmplitude_ = kRestAmplitude * std::sqrt(input.mass.diagonal().minCoeff());
    out.target_ = out.parameters_ = out.change_ = Eigen::VectorXd::Zero(g);
    out.amplitude_ = out.rate_ = out.slope_ = out.push_ = Eigen::VectorXd::Zero(modes);
    return out;
}

void JointDynamics::reset(const Eigen::VectorXd& target) {
    refused_ = !usable(target, target_.size());
    if (!refused_) target_ = target;
    parameters_ = target_;
    amplitude_.setZero();
    rate_.setZero();
    slope_.setZero();
    resting_ = true;
}

void JointDynamics::step(double seconds, const Eigen::VectorXd& target) { advance(seconds, target, nullptr); }
void JointDynamics::step(double seconds, const Eigen::VectorXd& target, const Eigen::VectorXd& force) { advance(seconds, target, &force); }

void JointDynamics::advance(double seconds, const Eigen::VectorXd& target, const Eigen::VectorXd* force) {
    refused_ = !std::isfinite(seconds) || seconds < 0.0 || !usable(target, target_.size()) || (force && !usable(*force, target_.size()));
    if (refused_ || seconds == 0.0) return;
    const bool moved = target != target_;
    const bool pushed = force && !force->isZero(0.0);
    if (resting_ && !moved && !pushed) return;
    resting_ = false;
    // A shorter frame is a jump of the targets, whose slope must stay finite; after a longer one every mode has decayed.
    const double t = std::clamp(seconds, 1e-6, 1e6);
    slope_.setZero();
    if (moved) {
        change_ = (target - target_) / t;
        slope_.noalias() = momenta_.transpose() * change_;
    }
    push_.setZero();
    if (pushed) push_.noalias() = shapes_.transpose() * *force;
    bool quiet = !moved && !pushed;
    for (Eigen::Index i = 0; i < amplitude_.size(); ++i) {
        const double omega = 2.0 * M_PI * hertz_[i];
        const double rest = push_[i] / (omega * omega);
        double y = amplitude_[i] - rest, rate = rate_[i] - slope_[i];
        oscillate(omega, damping_[i], t, y, rate);
        amplitude_[i] = y + rest;
        rate_[i] = rate + slope_[i];
        // An overdamped mode is at rest by its displacement, an oscillating one by displacement and rate.
        quiet = quiet && std::abs(amplitude_[i]) <= restAmplitude_ && std::abs(rate_[i]) <= omega * restAmplitude_;
    }
    target_ = target;
    parameters_ = target;
    if (quiet) {
        amplitude_.setZero();
        rate_.setZero();
        resting_ = true;
        return;
    }
    parameters_.noalias() += shapes_ * amplitude_;
}

double JointDynamics::energy() const {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < amplitude_.size(); ++i) {
        const double omega = 2.0 * M_PI * hertz_[i], rate = rate_[i] - slope_[i];
        sum += 0.5 * (rate * rate + omega * omega * amplitude_[i] * amplitude_[i]);
    }
    return sum;
}

}  // namespace imomushi
