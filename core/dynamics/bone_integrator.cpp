// SPDX-License-Identifier: GPL-3.0-or-later
// One time step of BoneDynamics: a stiffly accurate, L-stable diagonally implicit Runge-Kutta method of two stages and second order (Alexander, SIAM J. Numer.
// Anal. 14 (1977) 1006), each stage solved by Newton's method with a positive definite matrix.
#include <algorithm>
#include <cmath>

#include "core/dynamics/bone_dynamics_state.h"

namespace imomushi {

namespace {

// Stages x_i = start_i + gamma h v_i; the second starts from the first's slope, and the last is the result.
const double kGamma = 1.0 - std::sqrt(0.5);
const double kSecondStart = (1.0 - kGamma) / kGamma;

constexpr int kIterations = 12;         // of Newton per stage; two or three are common
constexpr double kConverged = 1e-9;     // mean bone lengths: less is left after the last iteration
constexpr double kGuessMove = 0.2;      // mean bone lengths: larger moves are not extrapolated from the velocities
constexpr double kIterationMove = 0.5;  // of a bone's length, at most, by one iteration
constexpr int kContactRounds = 8;       // a step is repeated with the points that it took through the ground, at most so often
constexpr int kShortenings = 8;         // of a step that would gain energy, each to a quarter
constexpr double kRounding = 1e-13;     // of energies
constexpr double kFastest = 100.0;      // sizes per second: free points are not faster
// Slow: less than these speeds (sizes per second, radians per second) and accelerations (sizes per second squared).
constexpr double kRestSpeed = 1e-5;
constexpr double kRestPush = 1e-5;
constexpr double kRestAngle = 1e-6;
// The work of outside forces is only estimated: in a step in which something moves the targets, energy may grow to this times the energy of the moved springs
// and of following the fastest target. Steps that are solved stay far below.
constexpr double kDriven = 4.0;

}  // namespace

double BoneDynamics::State::kineticOf(const std::vector<Vec3>& v) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < v.size(); ++i)
        if (!held[i]) sum += 0.5 * mass[i] * v[i].squaredNorm();
    return sum;
}

double BoneDynamics::State::gravityOf(const std::vector<Vec3>& x) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i)
        if (!held[i]) sum -= mass[i] * settings.gravity.dot(x[i] - skeleton.points[i]);
    return sum;
}

BoneDynamics::Energy BoneDynamics::State::energyOf(const std::vector<Vec3>& x, const std::vector<Vec3>& v, const BoneTargets& targets) const {
    return {kineticOf(v), springs.energy(x, targets), gravityOf(x)};
}

bool BoneDynamics::State::solveStage(double s, double h, double part, const BoneTargets& targets, const BoneSprings::Motion& motion) {
    stageSeconds = s;
    double farthest = 0.0;
    for (std::size_t i = 0; i < xs.size(); ++i)
        if (freedom[i] != Freedom::Fixed) farthest = std::max(farthest, (x0[i] + s * v0[i] - xs[i]).cwiseAbs().maxCoeff());
    const bool guess = farthest <= kGuessMove * unit;
    for (std::size_t i = 0; i < xs.size(); ++i) {
        if (freedom[i] == Freedom::Fixed) {
            xs[i] = body.x[i] + part * (goal[i] - body.x[i]);
            continue;
        }
        if (guess) xs[i] = x0[i] + s * v0[i];
        if (freedom[i] == Freedom::OnPlane) xs[i] += ((1.0 - part) * height(i, body.x[i]) - height(i, xs[i])) * normal;
    }
    double before = 0.0;
    for (int k = 0;; ++k) {
        system.setZero();
        stageVelocities(s, h);
        for (std::size_t i = 0; i < xs.size(); ++i) force[i] = mass[i] * settings.gravity;
        springs.forces(xs, vs, targets, motion, force, &system, s, freedom, normal);
        for (std::size_t i = 0; i < xs.size(); ++i) {
            const int at = static_cast<int>(i);
            const double m = mass[i] / (s * s);
            change[i].setZero();
            if (freedom[i] == Freedom::Fixed) {
                system.add(at, at, Eigen::Matrix3d::Identity());
                continue;
            }
            change[i] = force[i] - mass[i] / s * (vs[i] - v0[i]);
            Eigen::Matrix3d inertia = m * Eigen::Matrix3d::Identity();
            if (freedom[i] == Freedom::OnPlane) {
                const double drag = friction(at);
                change[i] -= drag * vs[i];
                change[i] -= normal.dot(change[i]) * normal;
                inertia += drag / s * (Eigen::Matrix3d::Identity() - normal * normal.transpose());
            }
            system.add(at, at, inertia);
        }
        if (!system.factorise()) return false;
        system.solve(change);
        double longest = 0.0, cut = 1.0;
        for (const auto& d : change) longest = std::max(longest, d.cwiseAbs().maxCoeff());
        if (!std::isfinite(longest)) return false;
        for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
            const auto& bone = skeleton.bones[b];
            const double length = std::max((xs[bone.end] - xs[bone.start]).norm(), 0.05 * bone.length);
            const double most = (change[bone.end] - change[bone.start]).norm();
            if (cut * most > kIterationMove * length) cut = kIterationMove * length / most;
        }
        for (std::size_t i = 0; i < xs.size(); ++i)
            if (freedom[i] != Freedom::Fixed) xs[i] += cut * change[i];
        // What the next iteration would add, as these shrink.
        const double rate = k > 0 && cut == 1.0 ? longest / before : 1.0;
        before = longest;
        if (longest * std::min(rate, 1.0) <= kConverged * unit || k + 1 == kIterations) break;
    }
    stageVelocities(s, h);
    for (std::size_t i = 0; i < xs.size(); ++i)
        if (freedom[i] == Freedom::OnPlane) xs[i] += ((1.0 - part) * height(i, body.x[i]) - height(i, xs[i])) * normal;
    return true;
}

void BoneDynamics::State::stageVelocities(double s, double h) {
    for (std::size_t i = 0; i < xs.size(); ++i) {
        if (freedom[i] == Freedom::Fixed) {
            vs[i] = (goal[i] - body.x[i]) / h;
            continue;
        }
        vs[i] = (xs[i] - x0[i]) / s;
        if (freedom[i] == Freedom::OnPlane) vs[i] -= (normal.dot(vs[i]) + height(i, body.x[i]) / h) * normal;
    }
}

double BoneDynamics::State::followingEnergy(double h) const {
    double fastest = 0.0, free = 0.0;
    for (std::size_t i = 0; i < goal.size(); ++i) {
        fastest = std::max({fastest, (goal[i] - body.x[i]).norm(), (next.points[i] - last.points[i]).norm()});
        if (freedom[i] == Freedom::OnPlane) fastest = std::max(fastest, std::abs(height(i, body.x[i])));
        if (!held[i]) free += mass[i];
    }
    return 0.5 * free * (fastest / h) * (fastest / h);
}

void BoneDynamics::State::advance(double h) {
    const std::size_t n = body.x.size();
    if (settings.ground) followFlesh(h);
    const bool driven = prescribe(h);
    double allowed = energy.total();
    if (driven || !energyKnown) {
        for (std::size_t i = 0; i < n; ++i) {
            xs[i] = goal[i];
            if (freedom[i] == Freedom::OnPlane) xs[i] -= std::min(height(i, xs[i]), 0.0) * normal;
        }
        const Energy moved = energyOf(xs, body.v, next);
        allowed = driven ? moved.gravity + kDriven * (moved.kinetic + moved.elastic + followingEnergy(h)) : moved.total();
    }

    const BoneSprings::Motion motion = same(last, next) ? BoneSprings::Motion{} : BoneSprings::Motion{&last, &next, h};
    bool solved = false;
    for (int round = 0;; ++round) {
        solved = solveStages(h, motion);
        if (!solved || !settings.ground || round == kContactRounds || !detectContact()) break;
    }
    allowed += kRounding * (std::abs(allowed) + weight * size);
    // Over the hump of a concave potential a long step can gain energy; shorter ones, by implicit Euler, do not.
    bool bounded = solved && potentialEnergy() <= allowed;
    const bool shortened = !bounded;
    double shorter = h;
    for (int k = 0; k < kShortenings && !bounded; ++k, shorter *= 0.25) {
        xs = x0 = body.x;
        v0 = body.v;
        solved = solveStage(shorter, h, 1.0, next, motion);
        bounded = solved && potentialEnergy() <= allowed;
    }
    if (!bounded) {
        if (!solved) warnings |= static_cast<unsigned>(DynamicsWarning::StepRefused);
        for (std::size_t i = 0; i < n; ++i) {
            xs[i] = held[i] ? goal[i] : aboveGround(i, body.x[i]);
            vs[i].setZero();
        }
        potentialEnergy();
    } else if (settings.ground) {
        updateContact(motion);
    }
    limitEnergy(allowed);
    accept(h);
    slow = slow && !shortened;
    advanceRoll(h, motion);
}

bool BoneDynamics::State::solveStages(double h, const BoneSprings::Motion& motion) {
    const double s = kGamma * h;
    if (motion.from) mix(last, next, kGamma, stage);
    xs = x0 = body.x;
    v0 = body.v;
    if (!solveStage(s, h, kGamma, motion.from ? stage : next, motion)) return false;
    for (std::size_t i = 0; i < x0.size(); ++i) {
        x0[i] = body.x[i] + kSecondStart * (xs[i] - body.x[i]);
        v0[i] = body.v[i] + kSecondStart * (vs[i] - body.v[i]);
    }
    return solveStage(s, h, 1.0, next, motion);
}

double BoneDynamics::State::potentialEnergy() {
    if (settings.ground)
        for (std::size_t i = 0; i < xs.size(); ++i) xs[i] = aboveGround(i, xs[i]);
    energy.elastic = springs.energy(xs, next);
    energy.gravity = gravityOf(xs);
    return energy.elastic + energy.gravity;
}

void BoneDynamics::State::limitEnergy(double allowed) {
    energy.kinetic = kineticOf(vs);
    if (energy.total() > allowed && energy.kinetic > 0.0) {
        const double left = std::max(allowed - energy.elastic - energy.gravity, 0.0);
        for (std::size_t i = 0; i < vs.size(); ++i)
            if (!held[i]) vs[i] *= std::sqrt(std::min(left / energy.kinetic, 1.0));
        energy.kinetic = std::min(left, energy.kinetic);
    }
    energyKnown = true;
}

void BoneDynamics::State::accept(double h) {
    double fastest = 0.0, pushed = 0.0;
    for (std::size_t i = 0; i < xs.size(); ++i) {
        const double speed = held[i] ? 0.0 : vs[i].norm();
        if (speed > kFastest * size) {
            vs[i] *= kFastest * size / speed;
            energyKnown = false;
        }
        fastest = std::max(fastest, vs[i].cwiseAbs().maxCoeff());
        pushed = std::max(pushed, (vs[i] - body.v[i]).cwiseAbs().maxCoeff() / h);
        body.x[i] = xs[i];
        body.v[i] = vs[i];
    }
    slow = fastest <= kRestSpeed * size && pushed <= kRestPush * size && !fleshMoves;
}

void BoneDynamics::State::advanceRoll(double h, const BoneSprings::Motion& motion) {
    const auto still = [](const std::vector<double>& r) { return std::all_of(r.begin(), r.end(), [](double a) { return a == 0.0; }); };
    if (still(body.roll) && still(body.rollRate) && still(next.roll) && still(last.roll)) return;
    const double s = kGamma * h;
    for (int k = 0; k < 2; ++k) {
        const double part = k == 0 ? kGamma : 1.0;
        const BoneTargets& targets = k == 0 && motion.from ? stage : next;
        for (std::size_t i = 0; i < roll0.size(); ++i) {
            if (held[i]) {
                const double rate = (next.roll[i] - body.roll[i]) / h;
                rollStage[i] = body.roll[i] + part * h * rate;
                roll0[i] = rollStage[i] - s * rate;
                continue;
            }
            roll0[i] = body.roll[i] + (k ? kSecondStart * (rollStage[i] - body.roll[i]) : 0.0);
            rollRate0[i] = body.rollRate[i] + (k ? kSecondStart * (rollRateStage[i] - body.rollRate[i]) : 0.0);
        }
        springs.solveRoll(targets, motion, s, roll0, rollRate0, held, rollStage);
        for (std::size_t i = 0; i < roll0.size(); ++i) rollRateStage[i] = (rollStage[i] - roll0[i]) / s;
    }
    for (std::size_t i = 0; i < roll0.size(); ++i) {
        slow = slow && std::abs(rollRateStage[i]) <= kRestAngle && std::abs(rollRateStage[i] - body.rollRate[i]) <= h * kRestAngle * 10.0;
        body.roll[i] = rollStage[i];
        body.rollRate[i] = rollRateStage[i];
    }
}

}  // namespace imomushi
