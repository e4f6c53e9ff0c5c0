// SPDX-License-Identifier: GPL-3.0-or-later
// Contact of a few fingers by the elastic response (James and Pai 1999): unknown forces at the pressed points, their compliance from the precomputed
// patches. Gauss-Seidel over the fingers finds which stick, slip or leave (each alone is solved exactly); the equations of those then are solved at
// once.
#include "core/touch/touch_contact.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <span>

#include "core/base/finite.h"
#include "core/mesh/topology.h"

namespace imomushi {
namespace {

constexpr double kMaxFriction = 10.0, kMaxSeconds = 10.0, kMinStrain = 0.05, kMaxStrain = 0.9;
/// (1 + x) exp(-x) is a tenth.
constexpr double kTenth = 3.889720169867429;
/// Each finger gives way by this part of the compliance of its patches, so that fingers at one place, or at a rim, have an answer.
constexpr double kSoftness = 1e-8;
/// Targets farther than this many sizes are as far as that.
constexpr double kFarthest = 100.0;
/// Dents below this part of the size are gone: single precision does not show them.
constexpr double kGone = 1e-7;
/// What is left of coming in, below which a finger is where it wants to be.
constexpr double kArrived = 1e-7;
/// Friction never takes more than this part of what pushing straight in does, or a slipping finger would have no answer (Painleve's paradox).
constexpr double kMaxCoupling = 0.9;
/// Fingers that hold need one round.
constexpr int kSweeps = 4, kRounds = 6;
/// Slack in the tests whether solved forces are within their cones.
constexpr double kSlack = 1e-9;

/// A critically damped return to 0, exact for any time: value'' = -2 omega value' - omega^2 value.
void decay(double omega, double seconds, double& value, double& rate) {
    const double e = std::exp(-omega * seconds), slope = rate + omega * value;
    value = (value + slope * seconds) * e;
    rate = (rate - omega * slope * seconds) * e;
}

Vec3 unit(const Vec3& v, const Vec3& otherwise) {
    const double length = v.stableNorm();
    return length > 0.0 && std::isfinite(length) ? Vec3(v / length) : otherwise;
}

}  // namespace

Result<void> checkTouchSettings(const TouchSettings& s) {
    const auto within = [](double x, double low, double high) { return std::isfinite(x) && x >= low && x <= high; };
    if (!within(s.friction, 0.0, kMaxFriction)) return fail("bad-value", "The friction of touch must lie between 0 and 10.");
    if (!within(s.pressSeconds, 0.0, kMaxSeconds) || !within(s.releaseSeconds, 0.0, kMaxSeconds))
        return fail("bad-value", "The times of touch must lie between 0 and 10 seconds.");
    if (!within(s.mostStrain, kMinStrain, kMaxStrain)) return fail("bad-value", "The largest strain of touch must lie between 0.05 and 0.9.");
    return {};
}

Result<TouchContact> TouchContact::build(std::shared_ptr<const TouchSurface> surface, const TouchSettings& settings) {
    if (auto ok = checkTouchSettings(settings); !ok) return tl::make_unexpected(ok.error());
    return TouchContact(std::move(surface), settings);
}

TouchContact::TouchContact(std::shared_ptr<const TouchSurface> surface, const TouchSettings& settings) : surface_(std::move(surface)), settings_(settings) {
    const Eigen::Index count = touch().patches.count(), columns = 3 * count;
    for (Finger& finger : fingers_) {
        finger.weights = Eigen::VectorXd::Zero(count);
        finger.rows = Row3::Zero(3, columns);
        finger.gradients = Row3::Zero(3, touch().gradients.rows());
    }
    left_ = leftRate_ = total_ = before_ = Eigen::VectorXd::Zero(columns);
    weights_ = nextWeights_ = Eigen::VectorXd::Zero(count);
    gradients_ = Eigen::VectorXd::Zero(touch().gradients.rows());
    active_.reserve(kFingers);
    contact_.resize(kFingers);
    compliance_.assign(static_cast<std::size_t>(kFingers) * kFingers, Eigen::Matrix3d::Zero());
    matrix_.resize(static_cast<std::size_t>(9 * kFingers) * kFingers);
    right_.resize(3 * kFingers);
    kept_.resize(kFingers);
}

Result<void> TouchContact::set(const TouchSettings& settings) {
    if (auto ok = checkTouchSettings(settings); !ok) return ok;
    settings_ = settings;
    return {};
}

/// What the force of a finger does to the points of all, theirs to its point, and its own to the gradients.
void TouchContact::findCompliance(std::size_t finger) {
    Finger& f = fingers_[finger];
    const Eigen::MatrixXd& C = touch().compliance;
    double mean = 0.0;
    f.gradients.setZero();
    for (Eigen::Index p = 0; p < f.weights.size(); ++p) {
        const double w = f.weights[p];
        if (!(w > 0.0)) continue;
        mean += w * C.block<3, 3>(3 * p, 3 * p).trace() / 3.0;
        f.gradients += w * touch().gradients.middleCols<3>(3 * p).transpose().cast<double>();
    }
    const auto moved = [](const Finger& of, const Finger& by, Eigen::Matrix3d& out) {
        out.setZero();
        for (Eigen::Index p = 0; p < by.weights.size(); ++p)
            if (by.weights[p] > 0.0) out += by.weights[p] * of.rows.middleCols<3>(3 * p);
    };
    for (std::size_t other = 0; other < fingers_.size(); ++other) {
        if (!fingers_[other].down && other != finger) continue;
        moved(f, fingers_[other], compliance(finger, other));
        if (other != finger) moved(fingers_[other], f, compliance(other, finger));
    }
    compliance(finger, finger).diagonal().array() += kSoftness * mean;
}

/// The largest of the probes, Frobenius.
double TouchContact::largestGradient(const Eigen::VectorXd& gradients) const {
    double most = 0.0;
    for (Eigen::Index i = 0; i < gradients.size(); i += 9) most = std::max(most, gradients.segment<9>(i).squaredNorm());
    return std::sqrt(most);
}

bool TouchContact::place(int finger, const Point& point, double radius) {
    if (finger < 0 || finger >= kFingers || !std::isfinite(radius) || radius < 0.0 || !surface_->canTouch(point)) return false;
    Finger& f = fingers_[static_cast<std::size_t>(finger)];
    f.point = point;
    f.point.barycentric = point.barycentric.cwiseMax(0.0);
    f.point.barycentric /= f.point.barycentric.sum();
    f.corner = surface_->corners(point.triangle);
    surface_->weigh(f.point, radius, weights_, nextWeights_);
    f.weights = weights_;
    f.rows.setZero();
    for (std::size_t c = 0; c < 3; ++c) {
        const std::int32_t row = surface_->row(f.corner[c]);
        const double part = f.point.barycentric[static_cast<Eigen::Index>(c)];
        if (row >= 0 && part > 0.0) f.rows += part * touch().displacement.middleRows<3>(row).cast<double>();
    }
    findCompliance(static_cast<std::size_t>(finger));
    if (!f.down) {
        f.down = true;
        f.aimed = false;
        f.remaining = 1.0;
        f.remainingRate = 0.0;
        f.force.setZero();
        f.slip.setZero();
        f.state = State::Outside;
    }
    return true;
}

bool TouchContact::aim(int finger, const Vec3& wanted, const Vec3& normal) {
    if (finger < 0 || finger >= kFingers || !allFinite(wanted) || !allFinite(normal)) return false;
    Finger& f = fingers_[static_cast<std::size_t>(finger)];
    const Vec3 direction = unit(normal, Vec3::Zero());
    if (!f.down || direction.isZero(0.0)) return false;
    f.normal = direction;
    const double length = wanted.stableNorm(), most = kFarthest * surface_->size();
    f.wanted = length > most ? Vec3(wanted * (most / length)) : wanted;
    f.aimed = true;
    return true;
}

bool TouchContact::aim(int finger, const std::array<Vec3, 3>& corners, const Vec3& target, const Eigen::Matrix3d& axes) {
    if (finger < 0 || finger >= kFingers || !fingers_[static_cast<std::size_t>(finger)].down || !allFinite(target) || !allFinite(axes))
        return false;
    for (const Vec3& corner : corners)
        if (!allFinite(corner)) return false;
    const Finger& f = fingers_[static_cast<std::size_t>(finger)];
    std::array<Vec3, 3> rest;
    Vec3 at = Vec3::Zero(), smooth = Vec3::Zero();
    for (std::size_t c = 0; c < 3; ++c) {
        const double part = f.point.barycentric[static_cast<Eigen::Index>(c)];
        rest[c] = surface_->vertex(f.corner[c]);
        at += part * corners[c];
        smooth += part * surface_->normal(f.corner[c]);
    }
    // The smooth normal of the rest surface, carried along as a normal is: its products with the sides of the triangle stay.
    const auto dual = [](const Vec3& a, const Vec3& b, const Vec3& flat) {
        const double area = flat.squaredNorm();
        return std::pair<Vec3, Vec3>(b.cross(flat) / area, flat.cross(a) / area);
    };
    const Vec3 a = rest[1] - rest[0], b = rest[2] - rest[0], flat = a.cross(b);
    const Vec3 posedA = corners[1] - corners[0], posedB = corners[2] - corners[0], posedFlat = posedA.cross(posedB);
    Vec3 normal = axes * smooth;
    const double least = 1e-12 * flat.norm();
    if (posedFlat.norm() > least && least > 0.0) {
        const auto [alongA, alongB] = dual(posedA, posedB, posedFlat);
        normal = smooth.dot(a) * alongA + smooth.dot(b) * alongB + smooth.dot(flat.normalized()) * posedFlat.normalized();
        if (normal.dot(posedFlat) <= 0.0) normal = posedFlat;
    }
    return aim(finger, Vec3(axes.transpose() * (target - at)), Vec3(axes.transpose() * normal));
}

/// The force of a finger that is no longer there stays, and goes.
void TouchContact::leave(Finger& finger) {
    if (!finger.force.isZero(0.0)) {
        for (Eigen::Index p = 0; p < finger.weights.size(); ++p)
            if (finger.weights[p] > 0.0) left_.segment<3>(3 * p) += finger.weights[p] * finger.force;
        resting_ = false;
    }
    finger.force.setZero();
    finger.slip.setZero();
    finger.remaining = 1.0;
    finger.remainingRate = 0.0;
}

void TouchContact::lift(int finger) {
    if (finger < 0 || finger >= kFingers) return;
    Finger& f = fingers_[static_cast<std::size_t>(finger)];
    leave(f);
    f.down = f.aimed = f.clamped = false;
    f.state = State::Up;
    f.moved.setZero();
}

void TouchContact::liftAll() {
    for (int i = 0; i < kFingers; ++i) lift(i);
}

void TouchContact::reset() {
    liftAll();
    left_.setZero();
    leftRate_.setZero();
    resting_ = true;
    sumForces();
}

void TouchContact::step(double seconds) {
    const double t = std::isfinite(seconds) && seconds > 0.0 ? seconds : 0.0;
    bool inside = false;
    for (const Finger& finger : fingers_) inside |= finger.down && finger.aimed && finger.wanted.dot(finger.normal) < 0.0;
    if (!inside && resting_ && idle_) return;  // and all fingers are up or outside
    advance(t);
    solve();
    sumForces();
}

void TouchContact::settle() {
    left_.setZero();
    leftRate_.setZero();
    resting_ = true;
    for (Finger& finger : fingers_) {
        if (finger.wanted.dot(finger.normal) < 0.0)
            finger.remaining = finger.remainingRate = 0.0;
        else
            finger.force.setZero();
    }
    solve();
    sumForces();
}

/// Dents of fingers that are gone go back, fingers that are inside come in.
void TouchContact::advance(double seconds) {
    if (!resting_) {
        const double omega = settings_.releaseSeconds > 0.0 ? kTenth / settings_.releaseSeconds : 0.0;
        const double e = omega > 0.0 ? std::exp(-omega * seconds) : 0.0;
        double most = 0.0;
        for (Eigen::Index i = 0; i < left_.size(); ++i) {
            const double slope = leftRate_[i] + omega * left_[i];
            left_[i] = (left_[i] + slope * seconds) * e;
            leftRate_[i] = (leftRate_[i] - omega * slope * seconds) * e;
            most += surface_->largestDisplacement()[i / 3] * (std::abs(left_[i]) + (omega > 0.0 ? std::abs(leftRate_[i]) / omega : 0.0));
        }
        if (most <= kGone * surface_->size()) {
            left_.setZero();
            leftRate_.setZero();
            resting_ = true;
        }
    }
    for (Finger& finger : fingers_) {
        if (!finger.down || !finger.aimed) continue;
        if (finger.wanted.dot(finger.normal) >= 0.0) {
            leave(finger);
            continue;
        }
        if (settings_.pressSeconds > 0.0)
            decay(kTenth / settings_.pressSeconds, seconds, finger.remaining, finger.remainingRate);
        else
            finger.remaining = finger.remainingRate = 0.0;
        if (finger.remaining < kArrived) finger.remaining = finger.remainingRate = 0.0;
    }
}

/// What the point of an active finger still misses, without its own force.
Vec3 TouchContact::residual(std::size_t i) const {
    Vec3 out = fingers_[active_[i]].goal;
    for (std::size_t j = 0; j < active_.size(); ++j)
        if (j != i) out -= compliance(active_[i], active_[j]) * fingers_[active_[j]].force;
    return out;
}

/// The force of a finger alone that moves its point by `gap`: none, sticking or slipping.
void TouchContact::solveAlone(const Eigen::Matrix3d& D, const Vec3& gap, Finger& f, Contact& how) const {
    const Vec3& n = f.normal;
    const double push = n.dot(D * n);
    f.force.setZero();
    how = Contact::None;
    if (!(gap.dot(n) < 0.0) || !(push > 0.0)) return;
    f.force = D.inverse() * gap;
    double into = -n.dot(f.force);
    const Vec3 along = f.force + into * n;
    how = Contact::Stick;
    if (into > 0.0 && along.norm() <= settings_.friction * into) return;
    // Along the surface towards where sticking would drag it.
    f.slip = settings_.friction * unit(along, Vec3::Zero());
    const double drag = n.dot(D * f.slip);
    if (drag > kMaxCoupling * push) f.slip *= kMaxCoupling * push / drag;
    f.force = n.dot(gap) / (n.dot(D * f.slip) - push) * (f.slip - n);
    how = Contact::Slip;
}

/// One finger, with the others as they are.
void TouchContact::sweep() {
    for (std::size_t i = 0; i < active_.size(); ++i) solveAlone(compliance(active_[i], active_[i]), residual(i), fingers_[active_[i]], contact_[i]);
}

/// Solves the equations of all fingers that stick and slip at once. False, with the forces as they were: then others would stick or slip.
bool TouchContact::solveTogether() {
    const std::size_t count = active_.size();
    std::array<std::size_t, kFingers + 1> at{};
    for (std::size_t i = 0; i < count; ++i) at[i + 1] = at[i] + (contact_[i] == Contact::Stick ? 3u : contact_[i] == Contact::Slip ? 1u : 0u);
    const std::size_t n = at[count];
    if (n == 0) return true;
    double* A = matrix_.data();
    for (std::size_t i = 0; i < count; ++i) {
        const Finger& f = fingers_[active_[i]];
        const bool sticks = contact_[i] == Contact::Stick;
        if (at[i + 1] == at[i]) continue;
        for (std::size_t j = 0; j < count; ++j) {
            const Eigen::Matrix3d& D = compliance(active_[i], active_[j]);
            const Finger& other = fingers_[active_[j]];
            if (at[j + 1] == at[j]) continue;
            if (contact_[j] == Contact::Stick) {
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
    for (std::size_t i = 0; i < count; ++i) kept_[i] = fingers_[active_[i]].force;
    bool holds = true;
    for (std::size_t i = 0; i < count && holds; ++i) {
        Finger& f = fingers_[active_[i]];
        if (contact_[i] == Contact::Stick) {
            const Vec3 force(right_[at[i]], right_[at[i] + 1], right_[at[i] + 2]);
            const double into = -f.normal.dot(force);
            holds = into > 0.0 && (force + into * f.normal).norm() <= (1.0 + kSlack) * settings_.friction * into;
            f.force = force;
        } else if (contact_[i] == Contact::Slip) {
            const double into = right_[at[i]];
            f.force = into * (f.slip - f.normal);
            holds = into > 0.0;
        }
    }
    for (std::size_t i = 0; i < count && holds; ++i)
        if (contact_[i] == Contact::None) holds = residual(i).dot(fingers_[active_[i]].normal) >= -kSlack * surface_->size();
    if (!holds)
        for (std::size_t i = 0; i < count; ++i) fingers_[active_[i]].force = kept_[i];
    return holds;
}

void TouchContact::solve() {
    active_.clear();
    for (std::size_t i = 0; i < fingers_.size(); ++i) {
        Finger& f = fingers_[i];
        f.clamped = false;
        if (!f.down) continue;
        f.state = State::Outside;
        if (!f.aimed || f.wanted.dot(f.normal) >= 0.0) continue;
        f.goal = (1.0 - f.remaining) * f.wanted;
        // Alone it would press no deeper than the largest gradient.
        const Vec3 before = f.force;
        Contact how{};
        solveAlone(compliance(i, i), f.goal, f, how);
        gradients_.noalias() = f.gradients.transpose() * f.force;
        if (const double most = largestGradient(gradients_); most > settings_.mostStrain) {
            f.goal *= settings_.mostStrain / most;
            f.clamped = true;
        }
        f.force = before;
        if (!resting_) f.goal.noalias() -= f.rows * left_;
        active_.push_back(i);
    }
    const std::size_t count = active_.size();
    if (count == 1) {
        sweep();
    } else if (count > 1) {
        for (int round = 0; round < kRounds; ++round) {
            for (int k = 0; k < kSweeps; ++k) sweep();
            if (solveTogether()) break;
        }
    }
    for (std::size_t i = 0; i < count; ++i) {
        Finger& f = fingers_[active_[i]];
        if (contact_[i] != Contact::None) f.state = contact_[i] == Contact::Stick ? State::Sticks : State::Slips;
    }
}

/// Sums the forces, within the largest strain, and says how far points move.
void TouchContact::sumForces() {
    before_.swap(total_);
    total_ = left_;
    bool any = !resting_;
    for (const Finger& f : fingers_)
        if (f.down && !f.force.isZero(0.0)) {
            any = true;
            for (Eigen::Index p = 0; p < f.weights.size(); ++p)
                if (f.weights[p] > 0.0) total_.segment<3>(3 * p) += f.weights[p] * f.force;
        }
    if (any) {
        gradients_.setZero();
        for (const Finger& f : fingers_)
            if (f.down && !f.force.isZero(0.0)) gradients_.noalias() += f.gradients.transpose() * f.force;
        for (Eigen::Index c = 0; c < left_.size() && !resting_; ++c)
            if (left_[c] != 0.0) gradients_ += left_[c] * touch().gradients.col(c).cast<double>();
        // A little above it where several press: the limit of each alone is met but for rounding.
        const double most = largestGradient(gradients_);
        if (most > (1.0 + kSlack) * settings_.mostStrain) {
            const double factor = settings_.mostStrain / most;
            total_ *= factor;
            left_ *= factor;
            leftRate_ *= factor;
            for (Finger& f : fingers_) {
                f.force *= factor;
                f.clamped |= f.down && !f.force.isZero(0.0);
            }
        }
    }
    for (Finger& f : fingers_) {
        f.moved.setZero();
        if (f.down && any) f.moved.noalias() = f.rows * total_;
    }
    idle_ = !any;
    if (total_ != before_) ++revision_;
}

void TouchContact::addJointForces(double shear, Eigen::VectorXd& forces) const {
    if (!idle_) forces.noalias() -= shear * (touch().forces * total_);
}

std::size_t TouchContact::bytes() const {
    const auto ofFinger = static_cast<std::size_t>(fingers_[0].weights.size() + fingers_[0].rows.size() + fingers_[0].gradients.size());
    return (4 * static_cast<std::size_t>(left_.size()) + static_cast<std::size_t>(kFingers) * ofFinger) * sizeof(double) + surface_->bytes();
}

}  // namespace imomushi
