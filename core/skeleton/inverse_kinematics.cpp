// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/skeleton/inverse_kinematics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/union_find.h"
#include "core/skeleton/axial_squash.h"
#include "core/skeleton/rod_energy.h"
#include "core/skeleton/roll_field.h"

namespace imomushi {

using Eigen::Quaterniond;

namespace {

constexpr double kTorn = 0.1;  // rest lengths beyond its stretch limits: farther than solve() ever stretches a bone
// What follows is for frames of 1/60 s; "tick" is such a time. State::solve() makes rates of it: a frame of another length has its part of the steps, and each step takes as much time.
// Not rates, as they are no motion but numerics: limits of one linearised step and of its line search, the least viscosity, which keeps the system regular.
// Viscosity: resistance of a joint point to a move of one mean bone length in one step, while targets move. Once they rest it is halved per tick down to
// kMinViscosity, so that the pose converges to a minimum. When held points have not approached their targets for kPatience ticks, it quadruples per
// tick instead: the frames of roots carry no torque, so a body that hangs between two holds could turn for ever.
constexpr double kViscosity = 0.1;
constexpr double kMinViscosity = 1e-5;
constexpr double kPatience = 40.0;
constexpr double kNearer = 1e-3;  // mean bone lengths per tick: a smaller approach counts as none
// One linearised step turns no bone farther (radians) and moves no point farther (mean bone lengths).
constexpr double kStepTurn = 0.35;
constexpr double kStepMove = 0.3;
constexpr int kSteps = 4;        // per tick, when targets move little
constexpr int kQuietSteps = 12;  // per tick, when targets rest and the pose has not converged
constexpr int kMaxSteps = 120;  // per tick, after a large move
constexpr int kHalvings = 12;    // of a step in its line search
constexpr int kRaises = 6;       // of the damping in one solve()
constexpr double kRaise = 6.0;   // factor of each
constexpr double kConvergedMove = 1e-6;  // mean bone lengths per tick
constexpr double kConvergedTurn = 1e-6;  // radians per tick
constexpr double kMiss = 1e-4;         // mean bone lengths: farther from its target a point is out of reach
// The part of their twist by which roots turn back per tick, while targets move and at rest.
constexpr double kRootReturn = 0.1;
constexpr double kRootReturnAtRest = 0.6;
// Pins nearer to each other than this part of a mean bone say no direction; nor do those that agree with no turn of their places at rest by more than this part (1: all do).
constexpr double kStands = 0.1;
// Targets farther away than this many sizes of the skeleton are approached as if they were that far: keeps squares finite.
constexpr double kFarthest = 1e6;
// Frames, in ticks. A longer one would have room for a jump, and where steps count as fewer than that, rounding would.
constexpr std::size_t kFramesOfTick = 64;
constexpr double kShortestFrame = 1.0 / kFramesOfTick, kLongestFrame = 4.0;
static_assert(InverseKinematics::kUsualFrame * 60.0 == 1.0);  // one tick, to the bit

// value * 2^times, to the bit where it is a whole number of times.
double doubled(double value, double times) {
    const double whole = std::floor(times);
    return std::ldexp(times == whole ? value : value * std::exp2(times - whole), static_cast<int>(whole));
}

// What of a part per tick is due in so many ticks.
double partIn(double ticks, double part) { return ticks == 1.0 ? part : 1.0 - std::pow(1.0 - part, ticks); }

// The length of a finite vector without overflow: at most 1e150.
double safeNorm(const Vec3& v) {
    const double m = v.cwiseAbs().maxCoeff();
    return m > 0.0 ? std::min(m, 1e150) * std::min((v / m).norm(), 2.0) : 0.0;
}

}  // namespace

struct InverseKinematics::State {
    explicit State(const Skeleton& input) : rods(input), squash(input), roll(input, rods.tree(), rods.unit()) {
        const int points = static_cast<int>(input.points.size()), bones = static_cast<int>(input.bones.size());
        system = BlockCholesky<3>(std::vector<int>(points, 3), rods.pairs());
        targets.held.assign(points, 0), lastHeld = targets.held;
        targets.place.assign(points, Vec3::Zero());
        targets.directions.reserve(2 * static_cast<std::size_t>(bones));
        UnionFind united(input.points.size());
        for (const auto& bone : input.bones) united.unite(bone.start, bone.end);
        for (int i = 0; i < points; ++i) component.push_back(united.find(i));
        stands.resize(input.points.size());
        for (std::size_t b = 0; b < input.bones.size(); ++b)
            if (input.bones[b].upright > 0.0) upright.push_back(static_cast<int>(b));
        lastTarget = lastPoints = anchor = x = trial = step = targets.place;
        startFrames.assign(bones, Quaterniond::Identity());
        frames = trialFrames = anchorFrames = startFrames;
    }

    [[nodiscard]] const Skeleton& skeleton() const { return rods.skeleton(); }

    // A pose that solve() never makes, but a file or an edited skeleton can: the trust region then grows until it is repaired.
    [[nodiscard]] bool beyondStretchLimits() const {
        for (std::size_t b = 0; b < skeleton().bones.size(); ++b) {
            const auto& bone = skeleton().bones[b];
            const double stretched = rods.along(static_cast<int>(b), x).norm() / bone.length;
            if (stretched < bone.minStretch - kTorn || stretched > bone.maxStretch + kTorn) return true;
        }
        return false;
    }

    // The part of `step`, 0...1, that keeps every point within `radius` of its anchor.
    [[nodiscard]] double partWithinTrustRegion() const {
        double part = 1.0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const double a = step[i].squaredNorm();
            if (a == 0.0) continue;
            const Vec3 gone = x[i] - anchor[i];
            const double b = gone.dot(step[i]), c = std::min(gone.squaredNorm() - radius * radius, 0.0);
            part = std::min(part, (std::sqrt(b * b - a * c) - b) / a);
        }
        return std::max(part, 0.0);
    }

    // Sets `trial` and its frames to what that part of `step` leads to.
    void tryPart(double part) {
        for (std::size_t i = 0; i < x.size(); ++i) trial[i] = x[i] + part * step[i];
        rods.transport(trial, startFrames, trialFrames);
    }

    // The turn of a bone counts as the move of one end about the other.
    [[nodiscard]] bool turnsBeyondTrustRegion() const {
        for (std::size_t b = 0; b < skeleton().bones.size(); ++b) {
            const double turn = 2.0 * std::acos(std::min(1.0, std::abs(anchorFrames[b].dot(trialFrames[b]))));
            if (turn * skeleton().bones[b].length > radius) return true;
        }
        return false;
    }

    Report solve(const std::vector<IkGoal>& goals, Pose& pose, double seconds) {
        const double ticks = std::clamp(60.0 * seconds, kShortestFrame, kLongestFrame);
        Report report;
        if (pose.points.size() != x.size() || pose.frames.size() != frames.size() || pose.roll.size() != x.size()) pose = restPose(skeleton());
        bool usable = fits(skeleton(), pose);
        for (const auto& goal : goals)
            usable = usable && allFinite(goal.target) && std::isfinite(goal.roll) && goal.point >= 0 &&
                     goal.point < static_cast<int>(x.size()) && goal.heldBone < static_cast<int>(frames.size()) &&
                     (goal.heldBone < 0 || (allFinite(goal.rotation.coeffs()) && std::abs(goal.rotation.squaredNorm() - 1.0) < 1e-3));
        if (!usable) {
            report.finite = false;
            report.converged = false;
            return report;
        }

        // How far the targets moved: since the last solve() where it left this pose, or else from the points they hold.
        const bool continued = pose.points == lastPoints;
        std::fill(targets.held.begin(), targets.held.end(), char(0));
        targets.directions.clear();
        for (const auto& goal : goals) {
            const auto same = [&](const IkTargets::Direction& d) { return d.bone == goal.heldBone; };
            if (goal.heldBone >= 0 && std::none_of(targets.directions.begin(), targets.directions.end(), same))
                targets.directions.push_back({goal.heldBone, (goal.rotation * rods.tree().restDirection[goal.heldBone]).normalized(), rods.heldStiffness()});
            const Vec3 reach = goal.target - pose.points[goal.point];
            const double distance = safeNorm(reach);
            targets.held[goal.point] = 1;
            targets.place[goal.point] = goal.target;
            if (!(distance <= kFarthest * rods.size()))
                targets.place[goal.point] = pose.points[goal.point] + (reach / reach.cwiseAbs().maxCoeff()).normalized() * (kFarthest * rods.size());
        }
        addUpright(goals);
        double moved = 0.0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            if (!targets.held[i]) continue;
            const bool known = continued && lastHeld[i];
            moved = std::max(moved, std::min(safeNorm(targets.place[i] - (known ? lastTarget[i] : pose.points[i])), kFarthest * rods.size()));
        }
        const bool sameHolds = continued && targets.held == lastHeld;
        // Targets rest where a whole tick brings no move: mice say less often where they are than short frames ask.
        const bool moves = !(sameHolds && moved <= 1e-9 * rods.unit()), rests = !moves && openTicks <= kShortestFrame * 0.5;
        restTicks = rests ? restTicks + ticks : 0.0;
        lately[frame++ % kFramesOfTick] = moved;
        double movedInTick = moved;
        const auto framesOfTick = static_cast<std::size_t>(std::max(1l, std::lround(1.0 / ticks)));
        for (std::size_t i = 2; i <= framesOfTick; ++i) movedInTick += lately[(frame - i) % kFramesOfTick];
        lastHeld = targets.held;
        lastTarget = targets.place;
        if (goals.empty()) {
            lastPoints = pose.points;
            return report;
        }

        x = pose.points;
        rods.setNatural(squash.update(targets, x, continued));
        rods.transport(x, pose.frames, startFrames);
        frames = startFrames;
        if (moves) {
            anchor = x;
            anchorFrames = frames;
            // The room of a whole tick is given, however short the frame is in which a target moves last.
            openTicks = std::max(1.0 - ticks, 0.0);
            owed = openTicks > 0.0 ? kMotionGain * (movedInTick - moved) + kTrustRadius * openTicks * rods.unit() : 0.0;
            radius = kMotionGain * moved + kTrustRadius * ticks * rods.unit();
            rootRadius = 0.5 * radius;
            stalledTicks = 0.0;
            gain = 0.0;
            leastMiss = std::numeric_limits<double>::max();
        } else if (!rests) {
            const double more = ticks < openTicks ? owed * ticks / openTicks : owed;
            openTicks = std::max(openTicks - ticks, 0.0);
            owed -= more;
            radius += more;
            rootRadius += 0.5 * more;
        } else if (const bool torn = beyondStretchLimits(); torn || (leastMiss > kMiss * rods.unit() && gain > kNearer * ticks * rods.unit())) {
            radius += kTrustRadius * ticks * rods.unit();
            if (torn) stalledTicks = 0.0;
        }
        const double hardening = doubled(1.0, std::clamp(2.0 * (stalledTicks - kPatience), 0.0, 100.0));
        // As many steps as a tick would have in which targets move as fast.
        const double room = ticks < 1.0 ? kMotionGain * movedInTick + kTrustRadius * rods.unit() : radius / ticks;
        const int stepsOfTick = rests ? kQuietSteps : static_cast<int>(std::min(kSteps + room / (0.5 * kStepMove * rods.unit()), double(kMaxSteps)));
        const int steps = std::max(1, static_cast<int>(std::lround(stepsOfTick * ticks)));
        const double ticksOfStep = stepsOfTick * ticks / steps;  // 1 where it comes out even
        const double viscosity = std::max(doubled(kViscosity, -std::min(restTicks, 60.0)) / ticksOfStep, kMinViscosity) * hardening;

        bool limited = false;
        double damping = viscosity;
        int raised = 0;
        for (int s = 0; s < steps && !limited;) {
            rods.linearise(x, frames, targets, damping, system, step);
            if (!system.factorise()) break;
            system.solve(step);
            double longest = 0.0;
            for (const auto& d : step) longest = std::max(longest, safeNorm(d));
            if (!std::isfinite(longest)) {
                report.finite = false;
                break;
            }
            if (longest <= 1e-4 * kConvergedMove * rods.unit()) break;
            if (longest > kStepMove * rods.unit())
                for (auto& d : step) d *= kStepMove * rods.unit() / longest;

            // More damping slows down what the energy hardly resists (a body about to buckle) more than held points. Only after that the whole step is cut.
            double part = partWithinTrustRegion();
            limited = part < 1.0;
            tryPart(part);
            bool turns = turnsBeyondTrustRegion();
            if ((part < 0.5 || turns) && raised < kRaises) {
                ++raised;
                damping *= kRaise;
                limited = false;
                continue;
            }
            ++s;
            const double before = rods.energy(x, targets);
            bool taken = false;
            for (int h = 0; h < kHalvings; ++h) {
                if (h > 0) {
                    tryPart(part *= 0.5);
                    turns = turnsBeyondTrustRegion();
                }
                taken = !turns && !rods.turnsBeyond(std::cos(kStepTurn), trial) && rods.energy(trial, targets) <= before + 1e-13 * std::abs(before);
                if (taken) break;
            }
            if (!taken) break;
            x.swap(trial);
            frames.swap(trialFrames);
        }

        untwistRoots(partIn(ticks, rests ? kRootReturnAtRest : kRootReturn) / hardening);
        double change = 0.0, turn = 0.0, miss = 0.0, misses = 0.0;
        for (std::size_t i = 0; i < x.size(); ++i) change = std::max(change, safeNorm(x[i] - pose.points[i]));
        for (std::size_t b = 0; b < frames.size(); ++b) turn = std::max(turn, (frames[b].coeffs() - pose.frames[b].coeffs()).norm());
        if (!std::isfinite(change) || !std::isfinite(turn)) report.finite = false;
        if (report.finite) {
            pose.points = x;
            pose.frames = frames;
        }
        roll.spread(goals, targets.held, pose);
        lastPoints = pose.points;
        for (const auto& goal : goals) {
            miss = std::max(miss, safeNorm(pose.points[goal.point] - goal.target));
            misses += safeNorm(pose.points[goal.point] - targets.place[goal.point]);
        }
        report.largestMiss = miss;
        stalledTicks = misses < leastMiss - kNearer * ticks * rods.unit() ? 0.0 : stalledTicks + ticks;
        gain = rests ? leastMiss - misses : misses;
        leastMiss = std::min(leastMiss, misses);
        const double settled = std::min(ticks, 1.0);  // no coarser where frames are long
        report.converged = report.finite && change <= kConvergedMove * settled * rods.unit() && turn <= kConvergedTurn * settled;
        report.outOfReach = miss > kMiss * rods.unit() && !limited && change <= 0.5 * radius;
        return report;
    }

    // Upright bones keep the direction of rest, turned about +Y as the pins of their character have turned: a figure whose feet are moved round turns with them.
    void addUpright(const std::vector<IkGoal>& goals) {
        if (upright.empty()) return;
        std::fill(stands.begin(), stands.end(), Stand());
        const auto eachPin = [&](const auto& visit) {
            for (const auto& goal : goals)
                if (goal.pinned) visit(stands[static_cast<std::size_t>(component[static_cast<std::size_t>(goal.point)])], skeleton().points[static_cast<std::size_t>(goal.point)], targets.place[static_cast<std::size_t>(goal.point)]);
        };
        eachPin([](Stand& stand, const Vec3& rest, const Vec3& now) {
            stand.rest += rest;
            stand.now += now;
            ++stand.pins;
        });
        eachPin([](Stand& stand, const Vec3& rest, const Vec3& now) {
            const Vec3 a = rest - stand.rest / stand.pins, b = now - stand.now / stand.pins;
            stand.cosine += a.x() * b.x() + a.z() * b.z();
            stand.sine += a.z() * b.x() - a.x() * b.z();
            stand.spread += a.x() * a.x() + a.z() * a.z();
        });
        for (Stand& stand : stands)
            if (std::hypot(stand.cosine, stand.sine) > kStands * stand.spread && stand.spread > kStands * kStands * rods.unit() * rods.unit())
                stand.rotation = Eigen::AngleAxisd(std::atan2(stand.sine, stand.cosine), Vec3::UnitY());
        for (const int b : upright) targets.directions.push_back({b, turnOf(b) * rods.tree().restDirection[b], skeleton().bones[static_cast<std::size_t>(b)].upright});
    }
    [[nodiscard]] const Quaterniond& turnOf(int bone) const {
        return stands[static_cast<std::size_t>(component[static_cast<std::size_t>(skeleton().bones[static_cast<std::size_t>(bone)].start)])].rotation;
    }

    // Turns roots by part of their twist back to the minimal rotation from rest: parallel transport in time is path-dependent (holonomy), so that a body which
    // wanders in space would turn about its bones. Not near the opposite of rest, where the minimal rotation is not unique.
    void untwistRoots(double part) {
        bool any = false;
        double used = 0.0;
        for (std::size_t b = 0; b < frames.size(); ++b) {
            if (rods.tree().parent[b] >= 0) continue;
            const Vec3 d = frames[b] * rods.tree().restDirection[b];
            const Quaterniond& turned = turnOf(static_cast<int>(b));  // identity where no bone is upright
            const Vec3 rest = turned * rods.tree().restDirection[b];
            const Quaterniond spin = minimalRotation(rest, d) * turned * frames[b].conjugate();
            double angle = 2.0 * std::atan2(spin.vec().dot(d), spin.w());
            angle -= 2.0 * M_PI * std::round(angle / (2.0 * M_PI));
            const double open = 0.5 * (1.0 + rest.dot(d));
            const double most = rootRadius / skeleton().bones[b].length;
            angle = std::clamp(angle * part * open * open, -most, most);
            if (angle == 0.0) continue;
            any = true;
            used = std::max(used, std::abs(angle) * skeleton().bones[b].length);
            startFrames[b] = (Quaterniond(Eigen::AngleAxisd(angle, d)) * frames[b]).normalized();
            frames[b] = startFrames[b];
        }
        if (!any) return;
        rootRadius = std::max(rootRadius - used, 0.0);
        for (std::size_t b = 0; b < frames.size(); ++b)
            if (rods.tree().parent[b] >= 0) startFrames[b] = frames[b];
        rods.transport(x, startFrames, frames);
    }

    RodEnergy rods;
    AxialSquash squash;
    RollField roll;
    BlockCholesky<3> system;

    // Where the pins of one character are, at rest and now: sums.
    struct Stand {
        Vec3 rest = Vec3::Zero(), now = Vec3::Zero();
        int pins = 0;
        double cosine = 0.0, sine = 0.0, spread = 0.0;
        Quaterniond rotation = Quaterniond::Identity();  // about +Y
    };
    std::vector<int> component;  // per joint point: of the bones that hang together
    std::vector<Stand> stands;   // by component
    std::vector<int> upright;    // bones that keep their direction

    IkTargets targets;
    std::vector<char> lastHeld;
    std::vector<Vec3> lastTarget, lastPoints;
    double restTicks = 0.0;    // since targets rest
    double stalledTicks = 0.0; // since a held point approached its target
    std::array<double, kFramesOfTick> lately{};  // m, moves of targets
    std::size_t frame = kFramesOfTick;           // how many were solved, and so many more
    double openTicks = 0.0;    // in which a target that moves counts as moving on
    double owed = 0.0;         // m, room about the anchors that is given in these
    double leastMiss = 0.0;    // m, sum over the held points
    double gain = 0.0;         // m, by which the last solve() brought held points nearer
    double radius = 0.0;       // m, of the trust region about the anchors
    double rootRadius = 0.0;   // m, how much of it is left for roots that turn back
    std::vector<Vec3> anchor;  // the pose when a target moved last
    std::vector<Quaterniond> anchorFrames;

    std::vector<Vec3> x, trial, step;
    std::vector<Quaterniond> startFrames, frames, trialFrames;
};

InverseKinematics::InverseKinematics(const Skeleton& skeleton) : state_(std::make_unique<State>(skeleton)) {}
InverseKinematics::InverseKinematics(InverseKinematics&&) noexcept = default;
InverseKinematics& InverseKinematics::operator=(InverseKinematics&&) noexcept = default;
InverseKinematics::~InverseKinematics() = default;

InverseKinematics::Report InverseKinematics::solve(const std::vector<IkGoal>& goals, Pose& pose, double seconds) {
    return state_->solve(goals, pose, seconds);
}

}  // namespace imomushi
