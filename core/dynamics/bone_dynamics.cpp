// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/dynamics/bone_dynamics.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>

#include "core/dynamics/bone_springs.h"
#include "core/skeleton/bone_tree.h"

namespace imomushi {

namespace {

// Alexander's two stages: x_i = start_i + gamma h v_i, the second starting from the first's slope; the last stage is the result.
const double kGamma = 1.0 - std::sqrt(0.5);
const double kSecondStart = (1.0 - kGamma) / kGamma;

constexpr int kIterations = 12;          // of Newton per stage; two or three are common
constexpr double kConverged = 1e-9;      // mean bone lengths: less is left after the last iteration
constexpr double kGuessMove = 0.2;       // mean bone lengths: larger moves are not guessed from the velocities
constexpr double kIterationMove = 0.5;   // of a bone's length, at most, by one iteration
constexpr int kContactRounds = 8;        // a step is done again with the points that it took through the ground, at most so often
constexpr int kShortenings = 8;          // of a step that would gain energy, each to a quarter
constexpr double kRounding = 1e-13;      // of energies
constexpr double kTouching = 1e-10;      // sizes: as near counts as on the plane
constexpr double kStickSpeed = 1e-4;     // sizes per second: slower points on the ground stick
constexpr double kGrabSeconds = 0.04;    // in which a newly held point comes nearer by a factor e
constexpr double kFastest = 100.0;       // sizes per second: free points are not faster
constexpr double kArrived = 1e-12;       // sizes
// At rest: slower than this and so little pushed that it stays so, in sizes per second and per second squared, for so many steps.
constexpr double kRestSpeed = 1e-5;
constexpr double kRestPush = 1e-5;
constexpr int kRestSteps = 24;
constexpr double kRestAngle = 1e-6;      // radians per second
constexpr double kAtTarget = 1e-5;       // sizes: at rest this near counts as at the kinematic pose
constexpr double kLightest = 1e-6;       // of the heaviest joint point
constexpr double kFarthest = 1e6;        // sizes of the skeleton: farther poses are refused, squares stay finite
constexpr double kCollapsed = 1e-3;      // parts of the rest length: kinematic bones count as at least that long
// Outside work is not accounted to the joule: in a step in which something moves the targets, energy may grow to this times what the moved springs hold
// and following the fastest target takes. Steps that are solved stay far below.
constexpr double kDriven = 4.0;

bool within(double value, double low, double high) { return std::isfinite(value) && value >= low && value <= high; }

}  // namespace

struct BoneDynamics::State {
    // What one step changes.
    struct Body {
        std::vector<Vec3> x, v;
        std::vector<double> roll, rollRate;
        std::vector<char> contact;          // of Contact
        std::vector<double> press;          // N, normal force of the ground in the last step
        std::vector<Vec3> offset;           // of held points from their kinematic place
    };
    enum Contact : char { kNone, kSliding, kSticking };

    explicit State(Input given)
        : skeleton(std::move(given.skeleton)), settings(std::move(given.settings)), mass(std::move(given.mass)), springs(skeleton, mass),
          system(static_cast<int>(skeleton.points.size()), springs.pairs()) {
        const std::size_t points = skeleton.points.size(), bones = skeleton.bones.size();
        for (const auto& p : skeleton.points) size = std::max(size, (p - skeleton.points[0]).norm());
        for (const auto& b : skeleton.bones) unit += b.length / static_cast<double>(bones);
        if (bones == 0) unit = size > 0.0 ? size : 1.0;
        size = std::max(size, unit);
        held.assign(points, 0), heldNow = held;
        freedom.assign(points, Freedom::Free);
        const std::vector<Vec3> zeros(points, Vec3::Zero());
        x0 = v0 = xs = vs = force = change = goal = force0 = zeros;
        roll0 = rollRate0 = rollStage = rollRateStage = std::vector<double>(points, 0.0);
        body.x = body.v = body.offset = zeros;
        body.roll = body.rollRate = body.press = roll0;
        body.contact.assign(points, kNone);
        arriving.assign(points, 0);
        kept = body;
        last = next = stage = frameStart = frameEnd = BoneTargets{zeros, std::vector<double>(bones, 1.0), std::vector<Vec3>(bones, Vec3::UnitX()), roll0};
        prepare();
        reset(restPose(skeleton));
    }

    // After settings changed.
    void prepare() {
        normal = settings.ground ? Vec3(settings.ground->normal / settings.ground->normal.cwiseAbs().maxCoeff()).normalized() : Vec3(Vec3::UnitY());
        springs.calibrate(settings.springs, settings.returnHertz, held);
        weight = 0.0;
        for (const double m : mass) weight += m * settings.gravity.norm();
        wake();
    }

    void wake() {
        resting = false;
        quietSteps = 0;
        energyKnown = false;
    }

    // How high joint point i would be at p, above where it meets the ground.
    [[nodiscard]] double gap(std::size_t i, const Vec3& p) const {
        const auto& g = *settings.ground;
        return normal.dot(p - g.point) - (g.clearance.empty() ? 0.0 : g.clearance[i]);
    }
    [[nodiscard]] Vec3 aboveGround(std::size_t i, const Vec3& p) const {
        if (!settings.ground) return p;
        return p - std::min(gap(i, p), 0.0) * normal;
    }

    [[nodiscard]] bool usable(const Pose& pose) const {
        if (!fits(skeleton, pose)) return false;
        for (const auto& p : pose.points)
            if (!((p - skeleton.points[0]).cwiseAbs().maxCoeff() <= kFarthest * size)) return false;
        for (const double r : pose.roll)
            if (!(std::abs(r) <= kFarthest)) return false;
        return true;
    }

    void takeTargets(const Pose& pose, BoneTargets& to) const {
        to.points = pose.points;
        to.roll = pose.roll;
        for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
            const auto& bone = skeleton.bones[b];
            const Vec3 along = pose.points[bone.end] - pose.points[bone.start];
            const double length = along.norm(), least = kCollapsed * bone.length;
            to.length[b] = std::max(length, least);
            to.direction[b] = length > least ? Vec3(along / length) : (pose.frames[b] * springs.tree().restDirection[b]).normalized();
        }
    }

    static void mix(const BoneTargets& a, const BoneTargets& b, double part, BoneTargets& to) {
        for (std::size_t i = 0; i < a.points.size(); ++i) {
            to.points[i] = a.points[i] + part * (b.points[i] - a.points[i]);
            to.roll[i] = a.roll[i] + part * (b.roll[i] - a.roll[i]);
        }
        for (std::size_t i = 0; i < a.length.size(); ++i) {
            to.length[i] = a.length[i] + part * (b.length[i] - a.length[i]);
            const Vec3 d = a.direction[i] + part * (b.direction[i] - a.direction[i]);
            const double norm = d.norm();
            to.direction[i] = norm > 1e-3 ? Vec3(d / norm) : b.direction[i];
        }
    }

    static bool same(const BoneTargets& a, const BoneTargets& b) {
        return a.points == b.points && a.roll == b.roll && a.direction == b.direction;
    }

    void reset(const Pose& pose) {
        Pose rest;
        const bool good = usable(pose);
        if (!good) rest = restPose(skeleton);
        const Pose& from = good ? pose : rest;
        takeTargets(from, last);
        frameEnd = last;
        kinematic = from;
        out = from;
        for (std::size_t i = 0; i < body.x.size(); ++i) {
            body.x[i] = aboveGround(i, from.points[i]);
            body.v[i].setZero();
            body.roll[i] = from.roll[i];
            body.rollRate[i] = 0.0;
            body.contact[i] = kNone;
            body.press[i] = 0.0;
            body.offset[i] = held[i] ? Vec3(body.x[i] - from.points[i]) : Vec3(Vec3::Zero());
        }
        phase = 0.0;
        warnings = good ? 0u : static_cast<unsigned>(DynamicsWarning::InputRefused);
        wake();
        energy = energyOf(body.x, body.v, last);
        writePose(body, last);
    }

    [[nodiscard]] double kineticOf(const std::vector<Vec3>& v) const {
        double sum = 0.0;
        for (std::size_t i = 0; i < v.size(); ++i)
            if (!held[i]) sum += 0.5 * mass[i] * v[i].squaredNorm();
        return sum;
    }
    [[nodiscard]] double gravityOf(const std::vector<Vec3>& x) const {
        double sum = 0.0;
        for (std::size_t i = 0; i < x.size(); ++i)
            if (!held[i]) sum -= mass[i] * settings.gravity.dot(x[i] - skeleton.points[i]);
        return sum;
    }
    [[nodiscard]] Energy energyOf(const std::vector<Vec3>& x, const std::vector<Vec3>& v, const BoneTargets& targets) const {
        return {kineticOf(v), springs.energy(x, targets), gravityOf(x)};
    }

    // Solves x = x0 + s v, mass (v - v0) / s = forces(x, v) for what is free, beginning near xs; what is prescribed has come `part` of its way through
    // the step of h seconds.
    bool solveStage(double s, double h, double part, const BoneTargets& targets, const BoneSprings::Motion& motion) {
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
            if (freedom[i] == Freedom::OnPlane) xs[i] += ((1.0 - part) * gap(i, body.x[i]) - gap(i, xs[i])) * normal;
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
                    const double rub = friction(at);
                    change[i] -= rub * vs[i];
                    change[i] -= normal.dot(change[i]) * normal;
                    inertia += rub / s * (Eigen::Matrix3d::Identity() - normal * normal.transpose());
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
            if (freedom[i] == Freedom::OnPlane) xs[i] += ((1.0 - part) * gap(i, body.x[i]) - gap(i, xs[i])) * normal;
        return true;
    }

    void stageVelocities(double s, double h) {
        for (std::size_t i = 0; i < xs.size(); ++i) {
            if (freedom[i] == Freedom::Fixed) {
                vs[i] = (goal[i] - body.x[i]) / h;
                continue;
            }
            vs[i] = (xs[i] - x0[i]) / s;
            if (freedom[i] == Freedom::OnPlane) vs[i] -= (normal.dot(vs[i]) + gap(i, body.x[i]) / h) * normal;
        }
    }

    // N s/m: Coulomb's force at the speed that the point had, so that it never turns a point back.
    [[nodiscard]] double friction(int i) const {
        const Vec3 along = body.v[i] - normal.dot(body.v[i]) * normal;
        return settings.ground->friction * body.press[i] / std::max(along.norm(), kStickSpeed * size);
    }

    // J: all free points as fast as the fastest target in this step.
    [[nodiscard]] double followingEnergy(double h) const {
        double fastest = 0.0, free = 0.0;
        for (std::size_t i = 0; i < goal.size(); ++i) {
            fastest = std::max({fastest, (goal[i] - body.x[i]).norm(), (next.points[i] - last.points[i]).norm()});
            if (!held[i]) free += mass[i];
        }
        return 0.5 * free * (fastest / h) * (fastest / h);
    }

    // What is prescribed in the next h seconds, into freedom and goal. True: something outside moves.
    bool prescribe(double h) {
        bool driven = !same(last, next);
        for (std::size_t i = 0; i < goal.size(); ++i) {
            freedom[i] = Freedom::Free;
            arriving[i] = 0;
            goal[i] = body.x[i];
            if (held[i]) {
                freedom[i] = Freedom::Fixed;
                body.offset[i] *= std::exp(-h / kGrabSeconds);
                if (body.offset[i].cwiseAbs().maxCoeff() < kArrived * size) body.offset[i].setZero();
                goal[i] = aboveGround(i, next.points[i] + body.offset[i]);
                driven = driven || goal[i] != body.x[i];
            } else if (settings.ground) {
                const double height = gap(i, body.x[i]);
                if (height < -kTouching * size) {  // the plane moved
                    driven = true;
                    body.contact[i] = kSliding;
                    arriving[i] = 1;
                }
                if (body.contact[i] == kSliding) freedom[i] = Freedom::OnPlane;
                if (body.contact[i] == kSticking) freedom[i] = Freedom::Fixed, goal[i] -= height * normal;
            }
        }
        return driven;
    }

    // One step of `h` seconds from `last` to `next`.
    void advance(double h) {
        const std::size_t n = body.x.size();
        const bool driven = prescribe(h);
        double allowed = energy.total();
        if (driven || !energyKnown) {
            for (std::size_t i = 0; i < n; ++i) {
                xs[i] = goal[i];
                if (freedom[i] == Freedom::OnPlane) xs[i] -= std::min(gap(i, xs[i]), 0.0) * normal;
            }
            const Energy moved = energyOf(xs, body.v, next);
            allowed = driven ? moved.gravity + kDriven * (moved.kinetic + moved.elastic + followingEnergy(h)) : moved.total();
        }

        const BoneSprings::Motion motion = same(last, next) ? BoneSprings::Motion{} : BoneSprings::Motion{&last, &next, h};
        bool solved = false;
        for (int round = 0;; ++round) {
            solved = solveStages(h, motion);
            if (!solved || !settings.ground || round == kContactRounds || !meetGround()) break;
        }
        allowed += kRounding * (std::abs(allowed) + weight * size);
        // Over the hump of a concave potential a long step can gain energy; shorter ones, by implicit Euler, do not.
        bool bounded = solved && restingEnergy() <= allowed;
        const bool shortened = !bounded;
        double shorter = h;
        for (int k = 0; k < kShortenings && !bounded; ++k, shorter *= 0.25) {
            xs = x0 = body.x;
            v0 = body.v;
            solved = solveStage(shorter, h, 1.0, next, motion);
            bounded = solved && restingEnergy() <= allowed;
        }
        if (!bounded) {
            if (!solved) warnings |= static_cast<unsigned>(DynamicsWarning::StepRefused);
            for (std::size_t i = 0; i < n; ++i) {
                xs[i] = held[i] ? goal[i] : aboveGround(i, body.x[i]);
                vs[i].setZero();
            }
            restingEnergy();
        } else if (settings.ground) {
            rubGround(motion);
        }
        boundEnergy(allowed);
        accept(h);
        quiet = quiet && !shortened;
        advanceRoll(h, motion);
    }

    bool solveStages(double h, const BoneSprings::Motion& motion) {
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

    // True: more points meet the ground than were known.
    bool meetGround() {
        bool more = false;
        for (std::size_t i = 0; i < xs.size(); ++i) {
            if (freedom[i] != Freedom::Free || gap(i, xs[i]) >= -kTouching * size) continue;
            freedom[i] = Freedom::OnPlane;
            body.contact[i] = kSliding;
            body.press[i] = 0.0;
            arriving[i] = 1;
            more = true;
        }
        return more;
    }

    // Contact and friction for the next step, from the forces that held points on the ground in this one.
    void rubGround(const BoneSprings::Motion& motion) {
        const double s = stageSeconds, mu = settings.ground->friction;
        for (std::size_t i = 0; i < xs.size(); ++i) force0[i] = mass[i] * settings.gravity;
        springs.forces(xs, vs, next, motion, force0, nullptr, s, freedom, normal);
        for (std::size_t i = 0; i < xs.size(); ++i) {
            if (held[i]) {
                body.contact[i] = kNone;
                continue;
            }
            if (body.contact[i] == kNone) continue;
            const Vec3 reaction = mass[i] / s * (vs[i] - v0[i]) - force0[i];
            const double press = normal.dot(reaction);
            if (arriving[i]) {  // an inelastic impact, and what friction takes along the plane meanwhile
                const double hit = std::max(-normal.dot(body.v[i]), 0.0);
                vs[i] -= normal.dot(vs[i]) * normal;
                const double speed = vs[i].norm();
                if (speed > 0.0) vs[i] *= std::max(0.0, 1.0 - mu * hit / speed);
                body.press[i] = 0.0;
                continue;
            }
            body.press[i] = std::max(press, 0.0);
            if (press < 0.0) {
                body.contact[i] = kNone;
            } else if (body.contact[i] == kSliding) {
                if (mu > 0.0 && vs[i].norm() < kStickSpeed * size) {
                    body.contact[i] = kSticking;
                    vs[i].setZero();
                }
            } else if ((reaction - press * normal).norm() > mu * press) {
                body.contact[i] = kSliding;
            }
        }
    }

    // Of the end of the step, without what is kinetic; kept in `energy`. Points that went through the ground are lifted.
    double restingEnergy() {
        if (settings.ground)
            for (std::size_t i = 0; i < xs.size(); ++i) xs[i] = aboveGround(i, xs[i]);
        energy.elastic = springs.energy(xs, next);
        energy.gravity = gravityOf(xs);
        return energy.elastic + energy.gravity;
    }

    // Slows points down until no more than the allowed energy is left.
    void boundEnergy(double allowed) {
        energy.kinetic = kineticOf(vs);
        if (energy.total() > allowed && energy.kinetic > 0.0) {
            const double left = std::max(allowed - energy.elastic - energy.gravity, 0.0);
            for (std::size_t i = 0; i < vs.size(); ++i)
                if (!held[i]) vs[i] *= std::sqrt(std::min(left / energy.kinetic, 1.0));
            energy.kinetic = std::min(left, energy.kinetic);
        }
        energyKnown = true;
    }

    void accept(double h) {
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
        quiet = fastest <= kRestSpeed * size && pushed <= kRestPush * size;
    }

    void advanceRoll(double h, const BoneSprings::Motion& motion) {
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
            quiet = quiet && std::abs(rollRateStage[i]) <= kRestAngle && std::abs(rollRateStage[i] - body.rollRate[i]) <= h * kRestAngle * 10.0;
            body.roll[i] = rollStage[i];
            body.rollRate[i] = rollRateStage[i];
        }
    }

    // Frames hang on their parents, those of roots turn from the kinematic pose by the least angle.
    void writePose(const Body& from, const BoneTargets& targets) {
        out.points = from.x;
        out.roll = from.roll;
        const auto& tree = springs.tree();
        for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
            const auto& bone = skeleton.bones[b];
            const Vec3 along = from.x[bone.end] - from.x[bone.start];
            const double length = along.norm();
            const int parent = tree.parent[b];
            const Eigen::Quaterniond base = parent < 0 ? kinematic.frames[b] : out.frames[parent];
            const Vec3 carried = parent < 0 ? targets.direction[b] : (base * tree.restDirection[b]).normalized();
            const Vec3 d = length > 1e-9 * bone.length ? Vec3(along / length) : carried;
            out.frames[b] = (minimalRotation(carried, d) * base).normalized();
        }
    }

    void step(double seconds, const Pose& target, std::span<const Hold> holds) {
        warnings = 0;
        const int points = static_cast<int>(body.x.size());
        std::fill(heldNow.begin(), heldNow.end(), char(0));
        for (const auto& hold : holds) {
            if (hold.point < 0 || hold.point >= points)
                warnings |= static_cast<unsigned>(DynamicsWarning::InputRefused);
            else
                heldNow[hold.point] = 1;
        }
        if (!std::isfinite(seconds) || seconds < 0.0 || !usable(target)) {
            warnings |= static_cast<unsigned>(DynamicsWarning::InputRefused);
            return;
        }
        const bool sameTarget = target.points == kinematic.points && target.roll == kinematic.roll && sameFrames(target);
        if (resting && sameTarget && heldNow == held) return;
        if (seconds == 0.0) return;
        if (heldNow != held) {
            for (int i = 0; i < points; ++i) {
                if (heldNow[i] && !held[i]) body.offset[i] = body.x[i] - last.points[i];
                if (!heldNow[i]) body.offset[i].setZero();
                if (heldNow[i]) body.contact[i] = kNone;
            }
            held.swap(heldNow);
            springs.calibrate(settings.springs, settings.returnHertz, held);
            wake();
        }
        if (!sameTarget) {
            resting = false;
            quietSteps = 0;
        }
        if (seconds > kMostSeconds) {
            warnings |= static_cast<unsigned>(DynamicsWarning::TimeDropped);
            seconds = kMostSeconds;
        }

        frameStart = frameEnd;
        takeTargets(target, frameEnd);
        kinematic.points = target.points;
        kinematic.frames = target.frames;
        kinematic.roll = target.roll;
        const double ahead = phase;
        phase += seconds;
        for (int k = 1; phase >= kStep * (1.0 - 1e-9); ++k) {
            phase = std::max(phase - kStep, 0.0);
            const double part = std::clamp((k * kStep - ahead) / seconds, 0.0, 1.0);
            targetsAt(part);
            advance(kStep);
            std::swap(last, next);
            quietSteps = quiet && sameTarget ? quietSteps + 1 : 0;
        }
        if (phase < 1e-9 * kStep) phase = 0.0;
        if (quietSteps >= kRestSteps) return settle();
        if (phase == 0.0) {
            writePose(body, last);
            return;
        }
        kept = body;
        const Energy keptEnergy = energy;
        const bool keptKnown = energyKnown, keptQuiet = quiet;
        targetsAt(1.0);
        advance(phase);
        writePose(body, next);
        std::swap(kept, body);
        energy = keptEnergy;
        energyKnown = keptKnown;
        quiet = keptQuiet;
    }

    [[nodiscard]] bool sameFrames(const Pose& target) const {
        for (std::size_t b = 0; b < target.frames.size(); ++b)
            if (target.frames[b].coeffs() != kinematic.frames[b].coeffs()) return false;
        return true;
    }

    // Into `next`: the kinematic pose at a part of the frame. Bit for bit the same while it rests.
    void targetsAt(double part) {
        if (part >= 1.0 || same(frameStart, frameEnd))
            next = frameEnd;
        else
            mix(frameStart, frameEnd, part, next);
    }

    void settle() {
        resting = true;
        phase = 0.0;
        double away = 0.0, turned = 0.0;
        for (std::size_t i = 0; i < body.x.size(); ++i) {
            away = std::max(away, (body.x[i] - last.points[i]).cwiseAbs().maxCoeff());
            turned = std::max(turned, std::abs(body.roll[i] - last.roll[i]));
            body.v[i].setZero();
            body.rollRate[i] = 0.0;
            body.offset[i].setZero();
        }
        if (away <= kAtTarget * size && turned <= kAtTarget) {
            body.x = last.points;
            body.roll = last.roll;
            out.points = kinematic.points;
            out.frames = kinematic.frames;
            out.roll = kinematic.roll;
        } else {
            writePose(body, last);
        }
        energy = energyOf(body.x, body.v, last);
    }

    const Skeleton skeleton;
    BoneDynamicsSettings settings;
    std::vector<double> mass;
    BoneSprings springs;
    BlockCholesky system;
    double unit = 0.0;  // mean rest length of the bones, m
    double size = 0.0;  // of the skeleton, m
    Vec3 normal = Vec3::UnitY();
    double weight = 0.0;  // N

    Body body, kept;               // at the last full step; room to keep it while a part of a step is tried
    BoneTargets last;              // at the last full step
    BoneTargets next, stage;       // at the end of the step, and at its first stage
    BoneTargets frameStart, frameEnd;
    Pose kinematic, out;
    double phase = 0.0;            // s, from the last full step to the end of the last frame
    std::vector<char> held, heldNow;
    bool resting = false, quiet = false;
    int quietSteps = 0;
    unsigned warnings = 0;
    Energy energy;
    bool energyKnown = false;

    // Of one step.
    std::vector<Freedom> freedom;
    double stageSeconds = 0.0;     // of its last stage
    std::vector<char> arriving;
    std::vector<Vec3> goal;        // where fixed points are at the end of the step
    std::vector<Vec3> x0, v0, xs, vs, force, change, force0;
    std::vector<double> roll0, rollRate0, rollStage, rollRateStage;
};

namespace {

Result<void> check(const BoneDynamicsSettings& s, std::size_t bones, std::size_t points) {
    if (s.springs.size() != 1 && s.springs.size() != bones)
        return fail("bad-value", "There are springs for " + std::to_string(s.springs.size()) + " of " + std::to_string(bones) +
                                     " bones: give one for all or one per bone.");
    for (const auto& b : s.springs) {
        for (const double hertz : {b.stretchHertz, b.swingHertz, b.rollHertz})
            if (!within(hertz, BoneSpring::kLeastHertz, BoneSpring::kMostHertz))
                return fail("bad-value", "The frequency of a bone is not between 0.01 and 1000 Hz: choose one that is.");
        for (const double ratio : {b.stretchDamping, b.swingDamping, b.rollDamping})
            if (!within(ratio, 0.0, BoneSpring::kMostDamping))
                return fail("bad-value", "The damping ratio of a bone is not between 0 and 10: choose one that is.");
    }
    if (!within(s.returnHertz, 0.0, BoneSpring::kMostHertz))
        return fail("bad-value", "The frequency of the return is not between 0 and 1000 Hz: choose one that is.");
    constexpr double kMostGravity = 1e12;  // m/s^2
    if (!allFinite(s.gravity) || s.gravity.cwiseAbs().maxCoeff() > kMostGravity)
        return fail("bad-value", "Gravity is not below 1e12 m/s^2: choose a weaker one.");
    if (!s.ground) return {};
    if (!allFinite(s.ground->point) || s.ground->point.cwiseAbs().maxCoeff() > 1e30)
        return fail("bad-value", "The ground has no place: give a point of it.");
    if (!allFinite(s.ground->normal) || !(s.ground->normal.cwiseAbs().maxCoeff() > 0.0))
        return fail("bad-value", "The ground has no direction: give a normal that is not zero.");
    if (!within(s.ground->friction, 0.0, 10.0)) return fail("bad-value", "The friction of the ground is not between 0 and 10: choose one that is.");
    const auto& clearance = s.ground->clearance;
    if (!clearance.empty() && clearance.size() != points) return fail("bad-value", "There is not one clearance per joint point: give as many, or none.");
    for (const double c : clearance)
        if (!within(c, 0.0, 1e30)) return fail("bad-value", "A clearance above the ground is not a length of 0 or more: choose one that is.");
    return {};
}

}  // namespace

BoneDynamics::BoneDynamics(std::unique_ptr<State> state) : state_(std::move(state)) {}
BoneDynamics::BoneDynamics(BoneDynamics&&) noexcept = default;
BoneDynamics& BoneDynamics::operator=(BoneDynamics&&) noexcept = default;
BoneDynamics::~BoneDynamics() = default;

Result<BoneDynamics> BoneDynamics::build(Input input) {
    const int points = static_cast<int>(input.skeleton.points.size());
    if (input.mass.size() != input.skeleton.points.size())
        return fail("bad-value", "There are masses for " + std::to_string(input.mass.size()) + " of " + std::to_string(points) +
                                     " joint points: give one per joint point.");
    double heaviest = 0.0;
    for (const double m : input.mass) {
        if (!within(m, 1e-60, 1e60)) return fail("bad-value", "A joint point has no mass: give every one a mass above zero.");
        heaviest = std::max(heaviest, m);
    }
    for (double& m : input.mass) m = std::max(m, kLightest * heaviest);
    for (const auto& p : input.skeleton.points)
        if (!allFinite(p) || p.cwiseAbs().maxCoeff() > 1e30) return fail("bad-value", "A joint point has no place: give every one finite coordinates.");
    std::vector<int> leader(points);
    for (int i = 0; i < points; ++i) leader[i] = i;
    const auto find = [&leader](int i) {
        while (leader[i] != i) i = leader[i] = leader[leader[i]];
        return i;
    };
    for (const auto& b : input.skeleton.bones) {
        if (b.start < 0 || b.end < 0 || b.start >= points || b.end >= points)
            return fail("bad-place", "A bone ends at a joint point that is not there: connect it to one that is.");
        if (!within(b.length, 1e-30, 1e30) || (input.skeleton.points[b.start] - input.skeleton.points[b.end]).norm() == 0.0)
            return fail("bad-value", "A bone has no length: move its ends apart.");
        if (find(b.start) == find(b.end)) return fail("bone-loop", "The bones close a loop: bones form trees, so leave one bone of the loop out.");
        leader[find(b.start)] = find(b.end);
    }
    if (const auto ok = check(input.settings, input.skeleton.bones.size(), input.skeleton.points.size()); !ok) return tl::unexpected(ok.error());
    return BoneDynamics(std::make_unique<State>(std::move(input)));
}

Result<void> BoneDynamics::set(const BoneDynamicsSettings& settings) {
    if (const auto ok = check(settings, state_->skeleton.bones.size(), state_->skeleton.points.size()); !ok) return ok;
    std::fill(state_->body.contact.begin(), state_->body.contact.end(), State::kNone);  // the ground may have sunk
    state_->settings = settings;
    state_->prepare();
    return {};
}

void BoneDynamics::reset(const Pose& pose) { state_->reset(pose); }
void BoneDynamics::step(double seconds, const Pose& kinematic, std::span<const Hold> holds) { state_->step(seconds, kinematic, holds); }
const Pose& BoneDynamics::pose() const { return state_->out; }
bool BoneDynamics::resting() const { return state_->resting; }
unsigned BoneDynamics::warnings() const { return state_->warnings; }
BoneDynamics::Energy BoneDynamics::energy() const { return state_->energy; }
const std::vector<Vec3>& BoneDynamics::velocities() const { return state_->body.v; }

}  // namespace imomushi
