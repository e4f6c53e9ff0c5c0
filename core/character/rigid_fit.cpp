// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/rigid_fit.h"

#include <algorithm>
#include <cmath>

#include "core/base/decompositions.h"

namespace imomushi {

using Eigen::Quaterniond;

namespace {

/// Two rotations whose fit differs by less than this, relative to that of the better one, are equally good.
constexpr double kTie = 1e-9;

}  // namespace

RigidFit::RigidFit(std::vector<Part> parts) : parts_(std::move(parts)), turn_(parts_.size(), Quaterniond::Identity()) {
    for (const Part& p : parts_) {
        at_.push_back(p.centre);
        mean_ += p.area * p.centre;
        area_ += p.area;
    }
    if (area_ > 0.0) mean_ /= area_;
    for (const Part& p : parts_) spread2_ += p.area * (p.centre - mean_).squaredNorm();
    if (area_ > 0.0) spread2_ /= area_;
}

void RigidFit::set(std::size_t part, const Vec3& at, const Quaterniond& turn) {
    at_[part] = at;
    turn_[part] = turn;
}

bool RigidFit::solve(Quaterniond& rotation, Vec3& shift) const {
    const auto atRest = [this] {
        for (std::size_t i = 0; i < parts_.size(); ++i)
            if (at_[i] != parts_[i].centre || turn_[i].vec() != Vec3::Zero()) return false;
        return true;
    };
    if (parts_.empty() || atRest()) {
        rotation = Quaterniond::Identity();
        shift.setZero();
        return true;
    }
    Vec3 now = Vec3::Zero();
    for (std::size_t i = 0; i < parts_.size(); ++i) now += parts_[i].area / area_ * at_[i];
    // Best is the eigenvector of the largest eigenvalue of a symmetric matrix of quaternions (w, x, y, z): that of the sum of d r^T, and q q^T for each turn q, as
    // tr(R_q^T R_p) = 4 (q . p)^2 - 1.
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        const Part& part = parts_[i];
        const double share = part.area / area_;
        const Vec3 rest = part.centre - mean_;
        Vec3 moved = at_[i] - now;
        const double length = rest.norm(), far = moved.norm();
        if (far > length) moved *= length / far;
        const Eigen::Matrix3d m = share * rest * moved.transpose();
        matrix(0, 0) += m.trace();
        const Vec3 twist(m(1, 2) - m(2, 1), m(2, 0) - m(0, 2), m(0, 1) - m(1, 0));
        matrix.block<1, 3>(0, 1) += twist.transpose();
        matrix.block<3, 1>(1, 0) += twist;
        matrix.block<3, 3>(1, 1) += m + m.transpose() - m.trace() * Eigen::Matrix3d::Identity();
        const Eigen::Vector4d q(turn_[i].w(), turn_[i].x(), turn_[i].y(), turn_[i].z());
        matrix += 4.0 * share * (part.size * part.size + spread2_) * (q * q.transpose());
    }
    const auto solver = eigenpairsOf(matrix);
    const bool unique = solver.values[3] - solver.values[2] > kTie * std::max(std::abs(solver.values[0]), std::abs(solver.values[3]));
    if (unique) {
        const Eigen::Vector4d best = solver.vectors.col(3);
        rotation = Quaterniond(best[0], best[1], best[2], best[3]).normalized();
        if (rotation.w() < 0.0) rotation.coeffs() = -rotation.coeffs();
    }
    shift = now - rotation * mean_;
    return unique;
}

}  // namespace imomushi
