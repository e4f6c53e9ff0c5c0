// SPDX-License-Identifier: GPL-3.0-or-later
// Gauss-Seidel over the points finds which stick, slip or leave (each alone is solved exactly); the equations of those then are solved at once.
#include "core/touch/contact_solve.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace imomushi {
namespace {

using How = ContactPoint::How;

/// Friction never takes more than this part of what pushing straight in does, or a slipping point would have no answer (Painleve's paradox).
constexpr double kMaxCoupling = 0.9;
/// Points that hold need one round.
constexpr int kSweeps = 4, kRounds = 6;
/// Slack in the tests whether solved forces are within their cones.
constexpr double kConeSlack = 1e-9;

}  // namespace

Vec3 unitOrZero(const Vec3& v) {
    const double length = v.stableNorm();
    return length > 0.0 && std::isfinite(length) ? Vec3(v / length) : Vec3(Vec3::Zero());
}

ContactSolver::ContactSolver(std::size_t slots) : slots_(slots) {
    compliance_.assign(slots * slots, Eigen::Matrix3d::Zero());
    active_.reserve(slots);
    at_.resize(slots + 1);
    matrix_.resize(9 * slots * slots);
    right_.resize(3 * slots);
    kept_.resize(slots);
}

/// What an active point still misses, without its own force.
Vec3 ContactSolver::residual(std::size_t i) const {
    Vec3 out = active_[i].point->goal;
    for (std::size_t j = 0; j < active_.size(); ++j)
        if (j != i) out -= compliance(active_[i].slot, active_[j].slot) * active_[j].point->force;
    return out;
}

void ContactSolver::solveAlone(const Eigen::Matrix3d& D, const Vec3& gap, double friction, ContactPoint& f) {
    const Vec3& n = f.normal;
    const double push = n.dot(D * n);
    f.force.setZero();
    f.how = How::None;
    if (!(gap.dot(n) < 0.0) || !(push > 0.0)) return;
    f.force = D.inverse() * gap;
    double into = -n.dot(f.force);
    const Vec3 along = f.force + into * n;
    f.how = How::Stick;
    if (into > 0.0 && along.norm() <= friction * into) return;
    // Along the surface towards where sticking would drag it.
    f.slip = friction * unitOrZero(along);
    const double drag = n.dot(D * f.slip);
    if (drag > kMaxCoupling * push) f.slip *= kMaxCoupling * push / drag;
    f.force = n.dot(gap) / (n.dot(D * f.slip) - push) * (f.slip - n);
    f.how = How::Slip;
}

/// One point after the other, with the others as they are.
void ContactSolver::sweep(double friction) {
    for (std::size_t i = 0; i < active_.size(); ++i)
        solveAlone(compliance(active_[i].slot, active_[i].slot), residual(i), friction, *active_[i].point);
}

/// Solves the equations of all points that stick and slip at once. False, with the forces as they were: then others would stick or slip.
bool ContactSolver::solveTogether(double friction, double slack) {
    const std::size_t count = active_.size();
    std::vector<std::size_t>& at = at_;
    for (std::size_t i = 0; i < count; ++i) {
        const How how = active_[i].point->how;
        at[i + 1] = at[i] + (how == How::Stick ? 3u : how == How::Slip ? 1u : 0u);
    }
    const std::size_t n = at[count];
    if (n == 0) return true;
    double* A = matrix_.data();
    for (std::size_t i = 0; i < count; ++i) {
        const ContactPoint& f = *active_[i].point;
        const bool sticks = f.how == How::Stick;
        if (at[i + 1] == at[i]) continue;
        for (std::size_t j = 0; j < count; ++j) {
            const Eigen::Matrix3d& D = compliance(active_[i].slot, active_[j].slot);
            const ContactPoint& other = *active_[j].point;
            if (at[j + 1] == at[j]) continue;
            if (other.how == How::Stick) {
                for (int k = 0; k < (sticks ? 3 : 1); ++k)
                    for (int l = 0; l < 3; ++l) A[(at[i] + k) * n + at[j] + l] = sticks ? D(k, l) : f.normal.dot(D.col(l));
            } else {
                const Vec3 by = D * (other.slip - other.normal);
                for (int k = 0; k < (sticks ? 3 : 1); ++k) A[(at[i] + k) * n + at[j]] = sticks ? by[k] : f.normal.dot(by);
            }
        }
        for (int k = 0; k < (sticks ? 3 : 1); ++k) right_[at[i] + k] = sticks ? f.goal[k] : f.normal.dot(f.goal);
    }
    // Gauss with the largest of each column.
    for (std::size_t c = 0; c < n; ++c) {
        std::size_t pivot = c;
        for (std::size_t r = c + 1; r < n; ++r)
            if (std::abs(A[r * n + c]) > std::abs(A[pivot * n + c])) pivot = r;
        if (!(std::abs(A[pivot * n + c]) > 0.0)) return false;
        if (pivot != c) {
            std::swap_ranges(A + pivot * n, A + pivot * n + n, A + c * n);
            std::swap(right_[pivot], right_[c]);
        }
        for (std::size_t r = c + 1; r < n; ++r) {
            const double factor = A[r * n + c] / A[c * n + c];
            if (factor == 0.0) continue;
            for (std::size_t k = c + 1; k < n; ++k) A[r * n + k] -= factor * A[c * n + k];
            right_[r] -= factor * right_[c];
        }
    }
    for (std::size_t c = n; c-- > 0;) {
        for (std::size_t k = c + 1; k < n; ++k) right_[c] -= A[c * n + k] * right_[k];
        right_[c] /= A[c * n + c];
    }
    for (std::size_t i = 0; i < count; ++i) kept_[i] = active_[i].point->force;
    bool holds = true;
    for (std::size_t i = 0; i < count && holds; ++i) {
        ContactPoint& f = *active_[i].point;
        if (f.how == How::Stick) {
            const Vec3 force(right_[at[i]], right_[at[i] + 1], right_[at[i] + 2]);
            const double into = -f.normal.dot(force);
            holds = into > 0.0 && (force + into * f.normal).norm() <= (1.0 + kConeSlack) * friction * into;
            f.force = force;
        } else if (f.how == How::Slip) {
            const double into = right_[at[i]];
            f.force = into * (f.slip - f.normal);
            holds = into > 0.0;
        }
    }
    for (std::size_t i = 0; i < count && holds; ++i)
        if (active_[i].point->how == How::None) holds = residual(i).dot(active_[i].point->normal) >= -slack;
    if (!holds)
        for (std::size_t i = 0; i < count; ++i) active_[i].point->force = kept_[i];
    return holds;
}

void ContactSolver::solve(double friction, double slack) {
    if (active_.size() == 1) {
        sweep(friction);
    } else if (!active_.empty()) {
        for (int round = 0; round < kRounds; ++round) {
            for (int k = 0; k < kSweeps; ++k) sweep(friction);
            if (solveTogether(friction, slack)) break;
        }
    }
    active_.clear();
}

}  // namespace imomushi
