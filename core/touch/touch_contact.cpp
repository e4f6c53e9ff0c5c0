// SPDX-License-Identifier: GPL-3.0-or-later
// Contact of a few fingers by the elastic response (James and Pai 1999): unknown forces at the pressed points, their compliance from the precomputed
// patches, solved by ContactSolver.
#include "core/touch/touch_contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/base/finite.h"
#include "core/mesh/topology.h"

namespace imomushi {
namespace {

constexpr double kMaxFriction = 10.0, kMaxSeconds = 10.0, kMinStrain = 0.05, kMaxStrain = 0.9, kMaxTip = 1000.0;
/// (1 + x) exp(-x) is a tenth.
constexpr double kTenth = 3.889720169867429;
/// Each finger gives way by this part of the compliance of its patches, so that fingers at one place, or at a rim, have an answer.
constexpr double kFingerSoftness = 1e-8;
/// Targets farther than this many sizes are as far as that.
constexpr double kFarthest = 100.0;
/// Dents below this part of the size are gone: single precision does not show them.
constexpr double kGone = 1e-7;
/// Rounds in which the width of a contact and its depth, which follow from each other, are found: to a percent.
constexpr int kWidenings = 10;
/// Of the range of depths (its logarithm) between what patches alone would reach and a goal that is too deep.
constexpr int kHalvings = 12;
/// What is left of coming in, below which a finger is where it wants to be.
constexpr double kArrived = 1e-7;
/// Slack in the tests of goals and of the largest strain.
constexpr double kSlack = 1e-9;

/// A critically damped return to 0, exact for any time: value'' = -2 omega value' - omega^2 value.
void decay(double omega, double seconds, double& value, double& rate) {
    const double e = std::exp(-omega * seconds), slope = rate + omega * value;
    value = (value + slope * seconds) * e;
    rate = (rate - omega * slope * seconds) * e;
}

}  // namespace

Result<void> checkTouchSettings(const TouchSettings& s) {
    const auto within = [](double x, double low, double high) { return std::isfinite(x) && x >= low && x <= high; };
    if (!within(s.friction, 0.0, kMaxFriction)) return fail("bad-value", "The friction of touch must lie between 0 and 10.");
    if (!within(s.pressSeconds, 0.0, kMaxSeconds) || !within(s.releaseSeconds, 0.0, kMaxSeconds))
        return fail("bad-value", "The times of touch must lie between 0 and 10 seconds.");
    if (!within(s.mostStrain, kMinStrain, kMaxStrain)) return fail("bad-value", "The largest strain of touch must lie between 0.05 and 0.9.");
    if (!within(s.tip, 0.0, kMaxTip)) return fail("bad-value", "The finger tip of touch must lie between 0 and 1000 m.");
    return {};
}

Result<TouchContact> TouchContact::build(std::shared_ptr<const TouchSurface> surface, const TouchSettings& settings,
                                         std::shared_ptr<const DentSurface> dents) {
    if (auto ok = checkTouchSettings(settings); !ok) return tl::make_unexpected(ok.error());
    return TouchContact(std::move(surface), settings, std::move(dents));
}

TouchContact::TouchContact(std::shared_ptr<const TouchSurface> surface, const TouchSettings& settings, std::shared_ptr<const DentSurface> dents)
    : surface_(std::move(surface)), settings_(settings), dents_(std::move(dents)), solver_(kFingers) {
    const Eigen::Index count = touch().patches.count(), columns = 3 * count;
    for (Finger& finger : fingers_) {
        finger.weights = Eigen::VectorXd::Zero(count);
        finger.rows = Row3::Zero(3, columns);
        finger.gradients = Row3::Zero(3, touch().gradients.rows());
    }
    left_ = leftRate_ = total_ = before_ = Eigen::VectorXd::Zero(columns);
    weights_ = nextWeights_ = Eigen::VectorXd::Zero(count);
    gradients_ = Eigen::VectorXd::Zero(touch().gradients.rows());
    if (dents_) byPatches_.assign(kFingers * kFingers, Eigen::Matrix3d::Zero());
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
        moved(f, fingers_[other], solver_.compliance(finger, other));
        if (other != finger) moved(fingers_[other], f, solver_.compliance(other, finger));
    }
    solver_.compliance(finger, finger).diagonal().array() += kFingerSoftness * mean;
    if (!dents_) return;
    for (std::size_t other = 0; other < fingers_.size(); ++other) {
        byPatches_[finger * kFingers + other] = solver_.compliance(finger, other);
        byPatches_[other * kFingers + finger] = solver_.compliance(other, finger);
    }
}

/// Displacement of the finger's point per force of a dent.
Eigen::Matrix3d TouchContact::dented(const Finger& finger, const Dent& by) const {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (std::size_t c = 0; c < 3; ++c)
        if (const double part = finger.point.barycentric[static_cast<Eigen::Index>(c)]; part > 0.0) sum += part * dents_->compliance(by, finger.corner[c]);
    return sum;
}

/// Its contact is that of a sphere as deep as it would press alone (radius^2 = tip * depth), but as wide as mostStrain wants, which slopes are, and the vertices.
void TouchContact::widen(std::size_t finger) {
    Finger& f = fingers_[finger];
    const double wide = f.dent.patchRadius, depth = -f.goal.dot(f.normal), patches = f.normal.dot(byPatches_[finger * kFingers + finger] * f.normal);
    const auto contact = [&](double deep) { return std::max({std::sqrt(f.tip * deep), deep / settings_.mostStrain, f.narrowest}); };
    double radius = std::min(contact(depth), wide);
    for (int i = 0; i < kWidenings && radius > 0.0; ++i) {
        f.dent.radius = radius;
        const double all = patches + f.normal.dot(dented(f, f.dent) * f.normal);
        radius = std::min(std::sqrt(radius * contact(depth * dents_->depth() / (radius * all))), wide);
    }
    f.dent.radius = radius < wide ? radius : 0.0;
}

/// The largest of the probes, Frobenius.
double TouchContact::largestGradient(const Eigen::VectorXd& gradients) const {
    double most = 0.0;
    for (Eigen::Index i = 0; i < gradients.size(); i += 9) most = std::max(most, gradients.segment<9>(i).squaredNorm());
    return std::sqrt(most);
}

/// The largest gradient that it makes alone at its goal, with its contact and its compliance there.
double TouchContact::strainAlone(std::size_t finger) {
    Finger& f = fingers_[finger];
    Eigen::Matrix3d& compliance = solver_.compliance(finger, finger);
    if (f.dent.patchRadius > 0.0) {
        widen(finger);
        compliance = byPatches_[finger * kFingers + finger];
        if (f.dent.radius > 0.0) compliance += dented(f, f.dent);
    }
    ContactSolver::solveAlone(compliance, f.goal, settings_.friction, f);
    gradients_.noalias() = f.gradients.transpose() * f.force;
    return largestGradient(gradients_);
}

/// Takes its goal, where strainAlone() is `strain`, back to where it is mostStrain. The strain grows more than the depth: contacts get wider, and dents stiffer.
void TouchContact::reach(std::size_t finger, double strain) {
    Finger& f = fingers_[finger];
    const Vec3 goal = f.goal;
    double reached = settings_.mostStrain / strain, beyond = 1.0;
    for (int i = 0; i < kHalvings; ++i) {
        const double part = std::sqrt(reached * beyond);
        f.goal = part * goal;
        (strainAlone(finger) > settings_.mostStrain ? beyond : reached) = part;
    }
    f.goal = reached * goal;
    (void)strainAlone(finger);
}

bool TouchContact::place(int finger, const Point& point, double radius) {
    if (finger < 0 || finger >= kFingers || !std::isfinite(radius) || radius < 0.0 || !surface_->canTouch(point)) return false;
    Finger& f = fingers_[static_cast<std::size_t>(finger)];
    f.point = point;
    f.point.barycentric = point.barycentric.cwiseMax(0.0);
    f.point.barycentric /= f.point.barycentric.sum();
    f.corner = surface_->corners(point.triangle);
    const bool dents = dents_ && settings_.tip > 0.0;
    f.tip = radius > 0.0 ? radius : settings_.tip;
    surface_->weigh(f.point, dents ? 0.0 : radius, weights_, nextWeights_);
    f.weights = weights_;
    f.dent = dents ? dents_->at(f.point, f.weights) : Dent();
    f.narrowest = dents ? dents_->narrowest(f.point) : 0.0;
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
    const Vec3 direction = unitOrZero(normal);
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
        if (finger.dent.active()) {
            // Where there are too many, the weakest goes at once.
            auto weakest = std::min_element(fading_.begin(), fading_.end(), [](const Fading& a, const Fading& b) { return a.dent.force.squaredNorm() < b.dent.force.squaredNorm(); });
            *weakest = {finger.dent, Vec3::Zero()};
        }
    }
    finger.dent.force.setZero();
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
    f.dent = {};
}

void TouchContact::liftAll() {
    for (int i = 0; i < kFingers; ++i) lift(i);
}

void TouchContact::reset() {
    liftAll();
    left_.setZero();
    leftRate_.setZero();
    fading_ = {};
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

void TouchContact::converge() {
    left_.setZero();
    leftRate_.setZero();
    fading_ = {};
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
        for (Fading& gone : fading_)
            for (int axis = 0; axis < 3 && gone.dent.radius > 0.0; ++axis) {
                const double slope = gone.rate[axis] + omega * gone.dent.force[axis];
                gone.dent.force[axis] = (gone.dent.force[axis] + slope * seconds) * e;
                gone.rate[axis] = (gone.rate[axis] - omega * slope * seconds) * e;
                most += dents_->depth() / gone.dent.radius * (std::abs(gone.dent.force[axis]) + (omega > 0.0 ? std::abs(gone.rate[axis]) / omega : 0.0));
            }
        if (most <= kGone * surface_->size()) {
            left_.setZero();
            leftRate_.setZero();
            fading_ = {};
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

void TouchContact::solve() {
    for (std::size_t i = 0; i < fingers_.size(); ++i) {
        Finger& f = fingers_[i];
        f.clamped = false;
        if (!f.down) continue;
        f.state = State::Outside;
        f.how = ContactPoint::How::None;
        if (!f.aimed || f.wanted.dot(f.normal) >= 0.0) continue;
        f.goal = (1.0 - f.remaining) * f.wanted;
        // Alone it would press no deeper than the largest gradient. Where it wants to, its contact is as wide as what it reaches calls for.
        const Vec3 before = f.force;
        if (const double most = strainAlone(i); most > settings_.mostStrain) {
            f.clamped = true;
            if (f.dent.patchRadius > 0.0)
                reach(i, most);
            else
                f.goal *= settings_.mostStrain / most;
        }
        f.force = before;
        if (!resting_) f.goal.noalias() -= f.rows * left_;
        for (const Fading& gone : fading_)
            if (!resting_ && gone.dent.active()) f.goal -= dented(f, gone.dent) * gone.dent.force;
        solver_.add(i, f);
    }
    const auto presses = [](const Finger& f) { return f.down && f.aimed && f.wanted.dot(f.normal) < 0.0; };
    for (std::size_t i = 0; i < fingers_.size() && dents_; ++i)
        for (std::size_t j = 0; j < fingers_.size() && presses(fingers_[i]); ++j) {
            const Finger &of = fingers_[i], &by = fingers_[j];
            if (i == j || !presses(by)) continue;
            solver_.compliance(i, j) = byPatches_[i * kFingers + j];
            if (by.dent.radius > 0.0) solver_.compliance(i, j) += dented(of, by.dent);
        }
    solver_.solve(settings_.friction, kSlack * surface_->size());
    for (Finger& f : fingers_)
        if (f.down && f.how != ContactPoint::How::None) f.state = f.how == ContactPoint::How::Stick ? State::Sticks : State::Slips;
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
            for (Fading& gone : fading_) {
                gone.dent.force *= factor;
                gone.rate *= factor;
            }
            for (Finger& f : fingers_) {
                f.force *= factor;
                f.clamped |= f.down && !f.force.isZero(0.0);
            }
        }
    }
    if (dents_) findDents();
    for (Finger& f : fingers_) {
        f.moved.setZero();
        if (!f.down || !any) continue;
        f.moved.noalias() = f.rows * total_;
        for (const Dent& dent : dents())
            if (dent.active()) f.moved += dented(f, dent) * dent.force;
    }
    idle_ = !any;
    if (total_ != before_) ++revision_;
}

void TouchContact::findDents() {
    for (std::size_t i = 0; i < fingers_.size(); ++i) {
        Finger& f = fingers_[i];
        f.dent.force = f.force;
        shown_[i] = f.down && f.dent.active() ? f.dent : Dent();
    }
    for (std::size_t i = 0; i < fading_.size(); ++i) shown_[fingers_.size() + i] = fading_[i].dent.active() ? fading_[i].dent : Dent();
}

void TouchContact::addJointForces(double shear, Eigen::VectorXd& forces) const {
    if (!idle_) forces.noalias() -= shear * (touch().forces * total_);
}

std::size_t TouchContact::bytes() const {
    const auto ofFinger = static_cast<std::size_t>(fingers_[0].weights.size() + fingers_[0].rows.size() + fingers_[0].gradients.size());
    return (4 * static_cast<std::size_t>(left_.size()) + static_cast<std::size_t>(kFingers) * ofFinger) * sizeof(double) + byPatches_.size() * sizeof(Eigen::Matrix3d) + surface_->bytes() + (dents_ ? dents_->bytes() : 0);
}

}  // namespace imomushi
