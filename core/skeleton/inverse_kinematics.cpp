// SPDX-License-Identifier: GPL-3.0-or-later
// A pose is the state of an overdamped elastic rod forest: each solve() takes a few implicit Euler steps of
//     viscosity * dx/dt = -grad (stretch + bend + pull of the holds),
// linearised by Gauss-Newton, so that the pose follows the holds like a body dragged through honey and never jumps to a distant minimum.
// Bending is the discrete curvature of Bergou et al., "Discrete elastic rods" (SIGGRAPH 2008), 2 tan(angle/2), which keeps bones from folding flat.
// Forces are in units of the force that stretches a bone to twice its length; lengths in metres.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/skeleton/block_cholesky.h"
#include "core/skeleton/bone_tree.h"
#include "core/skeleton/skeleton.h"

namespace imomushi {

using Eigen::Matrix3d;
using Eigen::Quaterniond;

namespace {

// Torque of a bend relative to the force of doubling a bone's length: bodies bend before they stretch. At the force of a hold out of reach the
// discrete curvature lets two bones fold to about 160 degrees.
constexpr double kBendStiffness = 0.05;
// The pull of a hold saturates here, ...
constexpr double kHoldForce = 50.0;
// ... is linear within this part of the mean bone length (a reachable target is missed by a fiftieth of it per unit of force), ...
constexpr double kHoldReach = 1e-6;
// ... and falls to this part of itself beyond kFarHold mean bone lengths: several targets out of reach do not tear a point from its pin.
constexpr double kFarPull = 0.1;
constexpr double kFarHold = 0.1;
// A bone pulled with kLimitForce leaves its stretch limits by this part of its rest length.
constexpr double kLimitForce = 10.0;
constexpr double kTorn = 0.1;           // this far beyond its limits, in rest lengths, a bone is torn
constexpr double kLimitSlack = 0.01;
// Resistance of a joint point to a move of one mean bone length in one step, while targets move. Once they rest it is halved per solve() down to
// kLeastViscosity, so that the pose arrives at its equilibrium. When held points no longer come nearer to their targets for kPatience solves, the
// honey sets (4 times stiffer per solve): frames of roots carry no torque, so that a body which hangs between two holds could turn for ever.
constexpr double kViscosity = 0.1;
constexpr double kLeastViscosity = 1e-5;
constexpr int kPatience = 40;
constexpr double kNearer = 1e-3;        // mean bone lengths per solve()
// Sideways force on a compressed bone: gives a straight body a side to bend to. None where the discrete curvature beside the bone
// is above kStraight, so that a bent body rests.
constexpr double kSideForce = 1e-3;
constexpr double kStraight = 0.05;
// One linearised step turns no bone farther (radians) and moves no point farther (mean bone lengths).
constexpr double kStepTurn = 0.35;
constexpr double kStepMove = 0.3;
constexpr int kSteps = 4;         // per solve(), when targets move little
constexpr int kQuietSteps = 12;   // per solve(), when targets rest and the pose does not yet
constexpr int kMostSteps = 120;   // per solve(), after a large move
constexpr int kHalvings = 12;
constexpr int kRaises = 6;
constexpr double kRaise = 6.0;
constexpr double kSettledMove = 1e-6;   // mean bone lengths per solve()
constexpr double kSettledTurn = 1e-6;   // radians per solve()
constexpr double kMiss = 1e-4;          // mean bone lengths: farther away is out of reach
// Frames of roots return to the minimal rotation from rest by this part per solve().
constexpr double kRootReturn = 0.1;
constexpr double kRootReturnAtRest = 0.6;
// Targets farther away than this many sizes of the skeleton are approached as if they were that far: keeps squares finite.
constexpr double kFarthest = 1e6;

// The length of a finite vector without overflow: at most 1e150.
double safeNorm(const Vec3& v) {
    const double m = v.cwiseAbs().maxCoeff();
    return m > 0.0 ? std::min(m, 1e150) * std::min((v / m).norm(), 2.0) : 0.0;
}

Matrix3d cross(const Vec3& a) {
    Matrix3d m;
    m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
    return m;
}

}  // namespace

Pose restPose(const Skeleton& skeleton) {
    Pose pose;
    pose.points = skeleton.points;
    pose.frames.assign(skeleton.bones.size(), Quaterniond::Identity());
    pose.roll.assign(skeleton.points.size(), 0.0);
    return pose;
}

struct InverseKinematics::State {
    // Two neighbouring bones and the joint points they have between them.
    struct Bend {
        int parent = -1, child = -1;
        double stiffness = 0.0;
        int count = 0;
        int point[4] = {};
        double onParent[4] = {}, onChild[4] = {};  // -1 start, +1 end
    };
    struct Tension {
        double force = 0.0, slope = 0.0, energy = 0.0;
    };

    explicit State(const Skeleton& input) : skeleton(input), tree(boneTree(input)), system(0, {}), rollSystem(0, {}) {
        const int points = static_cast<int>(skeleton.points.size()), bones = static_cast<int>(skeleton.bones.size());
        for (const auto& p : skeleton.points) size = std::max(size, (p - skeleton.points[0]).norm());
        for (const auto& b : skeleton.bones) unit += b.length / bones;
        if (bones == 0) unit = size > 0.0 ? size : 1.0;
        size = std::max(size, unit);

        std::vector<std::pair<int, int>> pairs, alongBones;
        for (int b = 0; b < bones; ++b) {
            const auto& bone = skeleton.bones[b];
            alongBones.emplace_back(bone.start, bone.end);
            pairs.push_back(alongBones.back());
            Vec3 across = Vec3::UnitY() - tree.restDirection[b].y() * tree.restDirection[b];
            if (across.norm() < 0.1) across = Vec3::UnitX() - tree.restDirection[b].x() * tree.restDirection[b];
            restSide.push_back(across.normalized());
            if (tree.parent[b] < 0) continue;
            Bend bend;
            bend.parent = tree.parent[b];
            bend.child = b;
            const auto& parent = skeleton.bones[bend.parent];
            bend.stiffness = kBendStiffness * 0.5 * (bone.length + parent.length);
            const auto touch = [&bend](int point, double onParent, double onChild) {
                int i = 0;
                while (i < bend.count && bend.point[i] != point) ++i;
                bend.count = std::max(bend.count, i + 1);
                bend.point[i] = point;
                bend.onParent[i] += onParent;
                bend.onChild[i] += onChild;
            };
            touch(parent.start, -1, 0), touch(parent.end, 1, 0), touch(bone.start, 0, -1), touch(bone.end, 0, 1);
            for (int i = 0; i < bend.count; ++i)
                for (int j = 0; j < i; ++j) pairs.emplace_back(bend.point[i], bend.point[j]);
            bends.push_back(bend);
        }
        system = BlockCholesky(points, pairs);
        rollSystem = BlockCholesky(points, alongBones);
        held.assign(points, 0), lastHeld = held;
        target.assign(points, Vec3::Zero()), lastTarget = target, lastPoints = target;
        anchor = x = trial = step = gradient = side = target;
        startFrames.assign(bones, Quaterniond::Identity());
        frames = trialFrames = anchorFrames = startFrames;
        direction.assign(bones, Vec3::UnitX());
        bent.assign(bends.size(), Vec3::UnitX());
        rolls.assign(points, Vec3::Zero());
        bend2.assign(bones, 0.0);
    }

    [[nodiscard]] Vec3 along(int b, const std::vector<Vec3>& points) const {
        return points[skeleton.bones[b].end] - points[skeleton.bones[b].start];
    }
    // Unit; a bone without length keeps the direction of its frame.
    [[nodiscard]] Vec3 directionOf(int b, const std::vector<Vec3>& points, const Quaterniond& frame) const {
        const Vec3 v = along(b, points);
        const double length = v.norm();
        if (length > 1e-9 * skeleton.bones[b].length) return v / length;
        return frame * tree.restDirection[b];
    }

    // Roots are carried from `from` without spin, the others hang on their parents.
    void transport(const std::vector<Vec3>& points, const std::vector<Quaterniond>& from, std::vector<Quaterniond>& to) const {
        for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
            const int parent = tree.parent[b];
            const Quaterniond base = parent < 0 ? from[b] : to[parent];
            const Vec3 d = directionOf(static_cast<int>(b), points, from[b]);
            to[b] = (minimalRotation(base * tree.restDirection[b], d) * base).normalized();
        }
    }

    // Tension of a bone of that length, its derivative by the length, and its energy. Twice differentiable.
    [[nodiscard]] Tension stretch(const Skeleton::Bone& bone, double length) const {
        const double strain = length / bone.length - 1.0;
        Tension r{strain, 1.0 / bone.length, 0.5 * strain * strain * bone.length};
        const double low = std::max(bone.minStretch, 0.02) - 1.0, high = std::max(bone.maxStretch, 0.03) - 1.0;
        for (const double excess : {strain - high, low - strain}) {
            if (excess <= 0.0) continue;
            const double sign = strain > high ? 1.0 : -1.0, y = excess / kLimitSlack;
            r.force += sign * kLimitForce * y * y;
            r.slope += 2.0 * kLimitForce * y / (kLimitSlack * bone.length);
            r.energy += kLimitForce * kLimitSlack * bone.length * y * y * y / 3.0;
        }
        return r;
    }

    // Pull of a hold per metre at that distance, and its energy. A function of the distance whose force falls: taking the pull per metre as
    // a stiffness bounds the energy from above, so that steps always descend.
    struct Pull {
        double perMetre = 0.0, energy = 0.0;
    };
    [[nodiscard]] Pull pull(const Vec3& miss) const {
        const double reach = kHoldReach * unit, far = kFarHold * unit;
        const double r = std::sqrt(miss.squaredNorm() + reach * reach);
        const double near = (1.0 - kFarPull) * far;
        return {kHoldForce * (kFarPull + near / (far + r)) / r, kHoldForce * (kFarPull * r + near * std::log1p(r / far))};
    }

    // A pose that no solve() leaves: someone else made it, and it may be mended as long as that takes.
    [[nodiscard]] bool beyondStretch() const {
        for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
            const auto& bone = skeleton.bones[b];
            const double stretched = along(static_cast<int>(b), x).norm() / bone.length;
            if (stretched < bone.minStretch - kTorn || stretched > bone.maxStretch + kTorn) return true;
        }
        return false;
    }

    [[nodiscard]] double energy(const std::vector<Vec3>& points) const {
        double sum = 0.0;
        for (std::size_t b = 0; b < skeleton.bones.size(); ++b)
            sum += stretch(skeleton.bones[b], along(static_cast<int>(b), points).norm()).energy;
        for (std::size_t i = 0; i < bends.size(); ++i) {
            const auto& bend = bends[i];
            const Vec3 p = directionOf(bend.parent, points, frames[bend.parent]);
            const Vec3 d = directionOf(bend.child, points, frames[bend.child]);
            const Vec3 t = minimalRotation(direction[bend.parent], p) * bent[i];
            const double c = t.dot(d);
            sum += 2.0 * bend.stiffness * (1.0 - c) / std::max(1.0 + c, 1e-12);
        }
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (held[i]) sum += pull(points[i] - target[i]).energy;
            sum -= side[i].dot(points[i] - x[i]);
        }
        return sum;
    }

    // gradient and system at x, for steps against `viscosity`.
    void assemble(double viscosity) {
        system.setZero();
        const Matrix3d eye = Matrix3d::Identity();
        for (std::size_t i = 0; i < x.size(); ++i) {
            gradient[i].setZero();
            side[i].setZero();
            system.add(static_cast<int>(i), static_cast<int>(i), viscosity / unit * eye);
            if (!held[i]) continue;
            const Vec3 miss = x[i] - target[i];
            const double weight = pull(miss).perMetre;
            gradient[i] += weight * miss;
            system.add(static_cast<int>(i), static_cast<int>(i), weight * eye);
        }
        for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
            const auto& bone = skeleton.bones[b];
            const double length = along(static_cast<int>(b), x).norm();
            const Vec3 d = direction[b] = directionOf(static_cast<int>(b), x, frames[b]);
            const Tension r = stretch(bone, length);
            const Matrix3d outer = d * d.transpose();
            // Under compression the transverse stiffness is negative and left out: what remains is positive definite.
            const Matrix3d h = r.slope * outer + std::max(r.force, 0.0) / std::max(length, 0.01 * bone.length) * (eye - outer);
            system.add(bone.start, bone.start, h);
            system.add(bone.end, bone.end, h);
            system.add(bone.start, bone.end, -h);
            gradient[bone.start] -= r.force * d;
            gradient[bone.end] += r.force * d;
            bend2[b] = 0.0;
        }
        for (std::size_t i = 0; i < bends.size(); ++i) {
            const auto& bend = bends[i];
            const Vec3 p = direction[bend.parent], d = direction[bend.child];
            const Vec3 t = bent[i] = frames[bend.parent] * tree.restDirection[bend.child];
            const double parentLength = std::max(along(bend.parent, x).norm(), 0.01 * skeleton.bones[bend.parent].length);
            const double childLength = std::max(along(bend.child, x).norm(), 0.01 * skeleton.bones[bend.child].length);
            const double cosine = std::max(1.0 + t.dot(d), 1e-9);
            const Vec3 r = 2.0 * t.cross(d) / cosine;
            const Matrix3d byChild = (2.0 * cross(t) - r * t.transpose()) / cosine * (eye - d * d.transpose()) / childLength;
            const Matrix3d byParent = (2.0 * cross(d) + r * d.transpose()) / cosine * (cross(t) * cross(p)) / parentLength;
            bend2[bend.parent] = std::max(bend2[bend.parent], r.squaredNorm());
            bend2[bend.child] = std::max(bend2[bend.child], r.squaredNorm());
            Matrix3d jacobian[4];
            for (int k = 0; k < bend.count; ++k) {
                jacobian[k] = bend.onParent[k] * byParent + bend.onChild[k] * byChild;
                gradient[bend.point[k]].noalias() += bend.stiffness * jacobian[k].transpose() * r;
                for (int l = 0; l <= k; ++l)
                    system.add(bend.point[k], bend.point[l], bend.stiffness * jacobian[k].transpose() * jacobian[l]);
            }
        }
        for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
            const auto& bone = skeleton.bones[b];
            const double compressed = 1.0 - along(static_cast<int>(b), x).norm() / bone.length;
            const double straight = 1.0 - bend2[b] / (kStraight * kStraight);
            if (compressed <= 0.0 || straight <= 0.0) continue;
            const Vec3 push = kSideForce * compressed * straight * (frames[b] * restSide[b]);
            side[bone.start] += push;
            side[bone.end] += push;
        }
        for (std::size_t i = 0; i < x.size(); ++i) step[i] = side[i] - gradient[i];
    }

    // The part of `step` (at most 1) that keeps every point within `limit` of its anchor.
    [[nodiscard]] double withinLimit() const {
        double part = 1.0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const double a = step[i].squaredNorm();
            if (a == 0.0) continue;
            const Vec3 gone = x[i] - anchor[i];
            const double b = gone.dot(step[i]), c = std::min(gone.squaredNorm() - limit * limit, 0.0);
            part = std::min(part, (std::sqrt(b * b - a * c) - b) / a);
        }
        return std::max(part, 0.0);
    }

    [[nodiscard]] bool stepTurnsTooFar() const {
        for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
            // The direction of a collapsed bone means nothing.
            if (along(static_cast<int>(b), x).norm() < 1e-3 * skeleton.bones[b].length) continue;
            if (direction[b].dot(directionOf(static_cast<int>(b), trial, frames[b])) < std::cos(kStepTurn)) return true;
        }
        return false;
    }

    // Turns of bones count as moves of one end about the other.
    [[nodiscard]] bool turnedTooFar() const {
        for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
            const double turn = 2.0 * std::acos(std::min(1.0, std::abs(anchorFrames[b].dot(trialFrames[b]))));
            if (turn * skeleton.bones[b].length > limit) return true;
        }
        return false;
    }

    void spreadRoll(const std::vector<Hold>& holds, Pose& pose) {
        bool any = std::any_of(pose.roll.begin(), pose.roll.end(), [](double r) { return r != 0.0; });
        for (const auto& hold : holds) {
            any = any || hold.hasRoll;
            if (!hold.hasRoll) continue;
            double sign = 0.0;  // of a bone that ends at the point, or else of one that starts there
            for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
                if (skeleton.bones[b].end == hold.point) sign = tree.rollSign[b];
                if (skeleton.bones[b].start == hold.point && sign == 0.0) sign = tree.rollSign[b];
            }
            pose.roll[hold.point] = (sign < 0.0 ? -1.0 : 1.0) * hold.roll;
        }
        if (!any) return;
        // Harmonic along the bones; so little resistance that it shows only where no point is held, and keeps those where they are.
        constexpr double kKeep = 1e-12;
        const Matrix3d eye = Matrix3d::Identity();
        rollSystem.setZero();
        for (std::size_t i = 0; i < rolls.size(); ++i) {
            const double weight = held[i] ? 1.0 : kKeep;
            rollSystem.add(static_cast<int>(i), static_cast<int>(i), weight * eye);
            rolls[i] = Vec3::Constant(weight * pose.roll[i]);
        }
        for (const auto& bone : skeleton.bones) {
            const double weight = unit / bone.length;
            for (const auto& [one, other] : {std::pair(bone.start, bone.end), std::pair(bone.end, bone.start)}) {
                if (held[one]) continue;
                rollSystem.add(one, one, weight * eye);
                if (held[other]) rolls[one].array() += weight * pose.roll[other];
            }
            if (!held[bone.start] && !held[bone.end]) rollSystem.add(bone.start, bone.end, -weight * eye);
        }
        if (!rollSystem.factorise()) return;
        rollSystem.solve(rolls);
        for (std::size_t i = 0; i < rolls.size(); ++i)
            if (!held[i]) pose.roll[i] = rolls[i].x();
    }

    Report solve(const std::vector<Hold>& holds, Pose& pose) {
        Report report;
        if (pose.points.size() != x.size() || pose.frames.size() != frames.size() || pose.roll.size() != x.size()) pose = restPose(skeleton);
        bool usable = fits(skeleton, pose);
        for (const auto& hold : holds)
            usable = usable && allFinite(hold.target) && std::isfinite(hold.roll) && hold.point >= 0 &&
                     hold.point < static_cast<int>(x.size());
        if (!usable) {
            report.finite = false;
            report.settled = false;
            return report;
        }

        // How far the targets moved: since the last solve() where it left this pose, or else from the points they hold.
        const bool continued = pose.points == lastPoints;
        std::fill(held.begin(), held.end(), char(0));
        for (const auto& hold : holds) {
            const Vec3 reach = hold.target - pose.points[hold.point];
            const double distance = safeNorm(reach);
            held[hold.point] = 1;
            target[hold.point] = distance <= kFarthest * size ? hold.target : Vec3(pose.points[hold.point] + (reach / reach.cwiseAbs().maxCoeff()).normalized() * (kFarthest * size));
        }
        double moved = 0.0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            if (!held[i]) continue;
            const bool known = continued && lastHeld[i];
            moved = std::max(moved, std::min(safeNorm(target[i] - (known ? lastTarget[i] : pose.points[i])), kFarthest * size));
        }
        const bool sameHolds = continued && held == lastHeld;
        quiet = sameHolds && moved <= 1e-9 * unit ? quiet + 1 : 0;
        lastHeld = held;
        lastTarget = target;
        if (holds.empty()) {
            lastPoints = pose.points;
            return report;
        }

        x = pose.points;
        transport(x, pose.frames, startFrames);
        frames = startFrames;
        if (quiet == 0) {
            anchor = x;
            anchorFrames = frames;
            limit = kMotionGain * moved + kRelaxation * unit;
            rootLimit = 0.5 * limit;
            resting = 0;
            gain = 0.0;
            leastMiss = std::numeric_limits<double>::max();
        } else if (const bool torn = beyondStretch(); torn || (leastMiss > kMiss * unit && gain > kNearer * unit)) {
            limit += kRelaxation * unit;
            if (torn) resting = 0;
        }
        const double setting = std::ldexp(1.0, std::clamp(2 * (resting - kPatience), 0, 100));
        const double viscosity = std::max(std::ldexp(kViscosity, -std::min(quiet, 60)), kLeastViscosity) * setting;
        const int steps = quiet ? kQuietSteps : static_cast<int>(std::min(kSteps + limit / (0.5 * kStepMove * unit), double(kMostSteps)));

        bool limited = false;
        double resistance = viscosity;
        int raised = 0;
        for (int s = 0; s < steps && !limited;) {
            assemble(resistance);
            if (!system.factorise()) break;
            system.solve(step);
            double longest = 0.0;
            for (const auto& d : step) longest = std::max(longest, safeNorm(d));
            if (!std::isfinite(longest)) {
                report.finite = false;
                break;
            }
            if (longest <= 1e-4 * kSettledMove * unit) break;
            if (longest > kStepMove * unit)
                for (auto& d : step) d *= kStepMove * unit / longest;

            // More resistance holds back what is loose (a body about to buckle) and lets the held points go on; only then all are cut short.
            double part = withinLimit();
            limited = part < 1.0;
            for (std::size_t i = 0; i < x.size(); ++i) trial[i] = x[i] + part * step[i];
            transport(trial, startFrames, trialFrames);
            if ((part < 0.5 || turnedTooFar()) && raised < kRaises) {
                ++raised;
                resistance *= kRaise;
                limited = false;
                continue;
            }
            ++s;
            const double before = energy(x);
            bool taken = false;
            for (int h = 0; h < kHalvings && !taken; ++h, part *= 0.5) {
                for (std::size_t i = 0; i < x.size(); ++i) trial[i] = x[i] + part * step[i];
                transport(trial, startFrames, trialFrames);
                if (stepTurnsTooFar() || turnedTooFar()) continue;
                taken = energy(trial) <= before + 1e-13 * std::abs(before);
            }
            if (!taken) break;
            x.swap(trial);
            frames.swap(trialFrames);
        }

        returnRoots((quiet ? kRootReturnAtRest : kRootReturn) / setting);
        double change = 0.0, turn = 0.0, miss = 0.0, misses = 0.0;
        for (std::size_t i = 0; i < x.size(); ++i) change = std::max(change, safeNorm(x[i] - pose.points[i]));
        for (std::size_t b = 0; b < frames.size(); ++b) turn = std::max(turn, (frames[b].coeffs() - pose.frames[b].coeffs()).norm());
        if (!std::isfinite(change) || !std::isfinite(turn)) report.finite = false;
        if (report.finite) {
            pose.points = x;
            pose.frames = frames;
        }
        spreadRoll(holds, pose);
        lastPoints = pose.points;
        for (const auto& hold : holds) {
            miss = std::max(miss, safeNorm(pose.points[hold.point] - hold.target));
            misses += safeNorm(pose.points[hold.point] - target[hold.point]);
        }
        report.largestMiss = miss;
        resting = misses < leastMiss - kNearer * unit ? 0 : resting + 1;
        gain = quiet == 0 ? misses : leastMiss - misses;
        leastMiss = std::min(leastMiss, misses);
        report.settled = report.finite && change <= kSettledMove * unit && turn <= kSettledTurn;
        report.outOfReach = miss > kMiss * unit && !limited && change <= 0.5 * limit;
        return report;
    }

    // Without this the roll of a body that wanders in space would drift. Nothing at the opposite of rest, where the minimal rotation jumps.
    void returnRoots(double part) {
        bool any = false;
        double used = 0.0;
        for (std::size_t b = 0; b < frames.size(); ++b) {
            if (tree.parent[b] >= 0) continue;
            const Vec3 d = frames[b] * tree.restDirection[b];
            const Quaterniond spin = minimalRotation(tree.restDirection[b], d) * frames[b].conjugate();
            double angle = 2.0 * std::atan2(spin.vec().dot(d), spin.w());
            angle -= 2.0 * M_PI * std::round(angle / (2.0 * M_PI));
            const double open = 0.5 * (1.0 + tree.restDirection[b].dot(d));
            const double most = rootLimit / skeleton.bones[b].length;
            angle = std::clamp(angle * part * open * open, -most, most);
            if (angle == 0.0) continue;
            any = true;
            used = std::max(used, std::abs(angle) * skeleton.bones[b].length);
            startFrames[b] = (Quaterniond(Eigen::AngleAxisd(angle, d)) * frames[b]).normalized();
            frames[b] = startFrames[b];
        }
        if (!any) return;
        rootLimit = std::max(rootLimit - used, 0.0);
        for (std::size_t b = 0; b < frames.size(); ++b)
            if (tree.parent[b] >= 0) startFrames[b] = frames[b];
        transport(x, startFrames, frames);
    }

    const Skeleton skeleton;
    const BoneTree tree;
    double unit = 0.0;  // mean rest length of the bones, m
    double size = 0.0;  // of the skeleton, m
    std::vector<Bend> bends;
    std::vector<Vec3> restSide;
    BlockCholesky system, rollSystem;

    std::vector<char> held, lastHeld;
    std::vector<Vec3> target, lastTarget, lastPoints;
    int quiet = 0;        // solves since a target moved
    int resting = 0;      // solves since a held point came nearer to its target
    double leastMiss = 0.0;  // m, sum over the held points
    double gain = 0.0;    // m, by which the last solve() brought held points nearer
    double limit = 0.0;      // m, how far points may be from their anchors
    double rootLimit = 0.0;  // m, how much of it is left for roots that turn back
    std::vector<Vec3> anchor;  // the pose when a target moved last
    std::vector<Quaterniond> anchorFrames;

    std::vector<Vec3> x, trial, step, gradient, side, direction, bent, rolls;
    std::vector<double> bend2;  // per bone: largest squared discrete curvature beside it
    std::vector<Quaterniond> startFrames, frames, trialFrames;
};

InverseKinematics::InverseKinematics(const Skeleton& skeleton) : state_(std::make_unique<State>(skeleton)) {}
InverseKinematics::InverseKinematics(InverseKinematics&&) noexcept = default;
InverseKinematics& InverseKinematics::operator=(InverseKinematics&&) noexcept = default;
InverseKinematics::~InverseKinematics() = default;

InverseKinematics::Report InverseKinematics::solve(const std::vector<Hold>& holds, Pose& pose) {
    return state_->solve(holds, pose);
}

}  // namespace imomushi
