// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/dynamics/bone_dynamics.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/dynamics/bone_dynamics_state.h"

namespace imomushi {

namespace {

// Sleep after so many steps in which nothing moves and pushes; then a pose this near (sizes, radians) counts as the kinematic pose.
constexpr int kRestSteps = 24;
constexpr double kAtTarget = 1e-5;
constexpr double kLightest = 1e-6;   // of the heaviest joint point
constexpr double kFarthest = 1e6;    // sizes of the skeleton: farther poses are refused, squares stay finite
constexpr double kCollapsed = 1e-3;  // of the rest length: kinematic bones count as at least that long

}  // namespace

BoneDynamics::State::State(Input given)
    : skeleton(std::move(given.skeleton)), settings(std::move(given.settings)), mass(std::move(given.mass)), springs(skeleton, mass),
      system(std::vector<int>(skeleton.points.size(), 3), springs.pairs()), flesh(skeleton) {
    const std::size_t points = skeleton.points.size(), bones = skeleton.bones.size();
    for (const auto& p : skeleton.points) size = std::max(size, (p - skeleton.points[0]).norm());
    for (const auto& b : skeleton.bones) unit += b.length / static_cast<double>(bones);
    if (bones == 0) unit = size > 0.0 ? size : 1.0;
    size = std::max(size, unit);
    held.assign(points, 0), heldNow = held;
    pointing.assign(bones, 0), pointingNow = pointing;
    freedom.assign(points, Freedom::Free);
    const std::vector<Vec3> zeros(points, Vec3::Zero());
    x0 = v0 = xs = vs = force = change = goal = force0 = zeros;
    roll0 = rollRate0 = rollStage = rollRateStage = std::vector<double>(points, 0.0);
    body.x = body.v = body.offset = zeros;
    body.roll = body.rollRate = body.normalForce = roll0;
    body.contact.assign(points, kNone);
    body.clearance = wanted = roll0;
    arriving.assign(points, 0);
    alone = arriving;
    saved = body;
    last = next = stage = frameStart = frameEnd = BoneTargets{zeros, std::vector<double>(bones, 1.0), std::vector<Vec3>(bones, Vec3::UnitX()), roll0, {}};
    if (springs.limitsBends())
        for (BoneTargets* targets : {&last, &next, &stage, &frameStart, &frameEnd}) targets->unbent.assign(bones, Vec3::UnitX());
    prepare();
    reset(restPose(skeleton));
}

void BoneDynamics::State::prepare() {
    normal = settings.ground ? settings.ground->plane.normal() : Vec3(Vec3::UnitY());
    springs.calibrate(settings.springs, settings.returnHertz, settings.airDamping, held, pointing);
    weight = 0.0;
    for (const double m : mass) weight += m * settings.gravity.norm();
    wake();
}

void BoneDynamics::State::wake() {
    resting = false;
    slowSteps = 0;
    energyKnown = false;
}

bool BoneDynamics::State::usable(const Pose& pose) const {
    if (!fits(skeleton, pose)) return false;
    for (const auto& p : pose.points)
        if (!((p - skeleton.points[0]).cwiseAbs().maxCoeff() <= kFarthest * size)) return false;
    for (const double r : pose.roll)
        if (!(std::abs(r) <= kFarthest)) return false;
    return true;
}

void BoneDynamics::State::takeTargets(const Pose& pose, BoneTargets& to) const {
    to.points = pose.points;
    to.roll = pose.roll;
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
        const auto& bone = skeleton.bones[b];
        const Vec3 along = pose.points[bone.end] - pose.points[bone.start];
        const double length = along.norm(), least = kCollapsed * bone.length;
        to.length[b] = std::max(length, least);
        to.direction[b] = length > least ? Vec3(along / length) : (pose.frames[b] * springs.tree().restDirection[b]).normalized();
    }
    for (std::size_t b = 0; b < to.unbent.size(); ++b)
        if (const int parent = springs.tree().parent[b]; parent >= 0) to.unbent[b] = (pose.frames[parent] * springs.tree().restDirection[b]).normalized();
}

void BoneDynamics::State::mix(const BoneTargets& a, const BoneTargets& b, double part, BoneTargets& to) {
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
    for (std::size_t i = 0; i < a.unbent.size(); ++i) {
        const Vec3 d = a.unbent[i] + part * (b.unbent[i] - a.unbent[i]);
        const double norm = d.norm();
        to.unbent[i] = norm > 1e-3 ? Vec3(d / norm) : b.unbent[i];
    }
}

bool BoneDynamics::State::same(const BoneTargets& a, const BoneTargets& b) {
    return a.points == b.points && a.roll == b.roll && a.direction == b.direction && a.unbent == b.unbent;
}

void BoneDynamics::State::reset(const Pose& pose) {
    Pose rest;
    const bool good = usable(pose);
    if (!good) rest = restPose(skeleton);
    const Pose& from = good ? pose : rest;
    takeTargets(from, last);
    frameEnd = last;
    kinematic = from;
    out = from;
    body.x = from.points;
    if (settings.ground) flesh.raise(body.x, settings.ground->plane, body.clearance);
    for (std::size_t i = 0; i < body.x.size(); ++i) {
        body.v[i].setZero();
        body.roll[i] = from.roll[i];
        body.rollRate[i] = 0.0;
        body.contact[i] = kNone;
        body.normalForce[i] = 0.0;
        body.offset[i] = held[i] ? Vec3(body.x[i] - from.points[i]) : Vec3(Vec3::Zero());
    }
    phase = 0.0;
    unseen = -1.0;
    warnings = good ? 0u : static_cast<unsigned>(DynamicsWarning::InputRefused);
    wake();
    energy = energyOf(body.x, body.v, last);
    writePose(body, last);
}

bool BoneDynamics::State::takeMotion(const State& of) {
    const auto sameBone = [](const Skeleton::Bone& a, const Skeleton::Bone& b) { return a.start == b.start && a.end == b.end && a.parent == b.parent; };
    if (skeleton.points != of.skeleton.points || springs.limitsBends() != of.springs.limitsBends() || !std::ranges::equal(skeleton.bones, of.skeleton.bones, sameBone)) return false;
    body = of.body;
    last = of.last;
    frameStart = of.frameStart;
    frameEnd = of.frameEnd;
    kinematic = of.kinematic;
    out = of.out;
    phase = of.phase;
    held = of.held;
    heldNow = of.heldNow;
    pointing = of.pointing;
    pointingNow = of.pointingNow;
    warnings = of.warnings;
    unseen = -1.0;
    prepare();
    energy = energyOf(body.x, body.v, last);
    return true;
}

void BoneDynamics::State::takeMotion(const State& of, std::span<const int> pointOf) {
    std::vector<char> known(body.x.size(), 0);
    for (std::size_t i = 0; i < body.x.size(); ++i) {
        if (pointOf[i] < 0) continue;
        const auto j = static_cast<std::size_t>(pointOf[i]);
        known[i] = 1;
        body.x[i] = of.out.points[j] + (skeleton.points[i] - of.skeleton.points[j]);
        body.v[i] = of.body.v[j];
        body.roll[i] = of.out.roll[j];
        body.rollRate[i] = of.body.rollRate[j];
        body.clearance[i] = of.body.clearance[j];
    }
    for (const auto& bone : skeleton.bones) {
        const auto start = static_cast<std::size_t>(bone.start), end = static_cast<std::size_t>(bone.end);
        if (known[end] || !known[start]) continue;
        known[end] = 1;
        body.x[end] += body.x[start] - kinematic.points[start];
        body.v[end] = body.v[start];
    }
    for (std::size_t i = 0; i < body.x.size(); ++i) body.x[i] = aboveGround(i, body.x[i]);
    prepare();
    energy = energyOf(body.x, body.v, last);
    writePose(body, last);
}

void BoneDynamics::State::writePose(const Body& from, const BoneTargets& targets) {
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

void BoneDynamics::State::step(double seconds, const Pose& target, std::span<const IkGoal> goals) {
    const unsigned before = std::exchange(warnings, 0u);
    const int points = static_cast<int>(body.x.size());
    std::fill(heldNow.begin(), heldNow.end(), char(0));
    std::fill(pointingNow.begin(), pointingNow.end(), char(0));
    for (const IkGoal& ik : goals) {
        if (ik.point < 0 || ik.point >= points)
            warnings |= static_cast<unsigned>(DynamicsWarning::InputRefused);
        else
            heldNow[ik.point] = 1;
        if (ik.heldBone >= 0 && ik.heldBone < static_cast<int>(pointingNow.size())) pointingNow[ik.heldBone] = 1;
    }
    if (!std::isfinite(seconds) || seconds < 0.0 || !usable(target)) {
        warnings |= static_cast<unsigned>(DynamicsWarning::InputRefused);
        return;
    }
    if (unseen >= 0.0) unseen += seconds;
    const bool sameTarget = target.points == kinematic.points && target.roll == kinematic.roll && sameFrames(target);
    if (resting && sameTarget && heldNow == held && pointingNow == pointing) {
        warnings |= before & static_cast<unsigned>(DynamicsWarning::HeldByGround);
        return;
    }
    if (seconds == 0.0) return;
    if (heldNow != held || pointingNow != pointing) {
        for (int i = 0; i < points; ++i) {
            if (heldNow[i] && !held[i]) {
                // What is grabbed where it is stays there: its kinematic place before, a long way off perhaps, is nothing to it.
                if ((body.x[i] - target.points[i]).squaredNorm() < (body.x[i] - last.points[i]).squaredNorm()) last.points[i] = frameEnd.points[i] = target.points[i];
                body.offset[i] = body.x[i] - last.points[i];
            }
            if (!heldNow[i]) body.offset[i].setZero();
            if (heldNow[i]) body.contact[i] = kNone;
        }
        held.swap(heldNow);
        pointing.swap(pointingNow);
        springs.calibrate(settings.springs, settings.returnHertz, settings.airDamping, held, pointing);
        wake();
    }
    if (!sameTarget) {
        resting = false;
        slowSteps = 0;
    }
    if (seconds > kMaxSeconds) {
        warnings |= static_cast<unsigned>(DynamicsWarning::TimeDropped);
        seconds = kMaxSeconds;
    }

    frameStart = frameEnd;
    takeTargets(target, frameEnd);
    kinematic.points = target.points;
    kinematic.frames = target.frames;
    kinematic.roll = target.roll;
    const double ahead = phase;
    phase += seconds;
    remaining = phase;
    for (int k = 1; phase >= kStep * (1.0 - 1e-9); ++k) {
        phase = std::max(phase - kStep, 0.0);
        const double part = std::clamp((k * kStep - ahead) / seconds, 0.0, 1.0);
        targetsAt(part);
        advance(kStep);
        std::swap(last, next);
        slowSteps = slow && sameTarget ? slowSteps + 1 : 0;
    }
    if (phase < 1e-9 * kStep) phase = 0.0;
    if (slowSteps >= kRestSteps) return sleep();
    if (phase == 0.0) {
        writePose(body, last);
        return;
    }
    saved = body;
    const Energy savedEnergy = energy;
    const bool savedKnown = energyKnown, savedQuiet = slow;
    targetsAt(1.0);
    advance(phase);
    writePose(body, next);
    std::swap(saved, body);
    energy = savedEnergy;
    energyKnown = savedKnown;
    slow = savedQuiet;
}

bool BoneDynamics::State::sameFrames(const Pose& target) const {
    for (std::size_t b = 0; b < target.frames.size(); ++b)
        if (target.frames[b].coeffs() != kinematic.frames[b].coeffs()) return false;
    return true;
}

void BoneDynamics::State::targetsAt(double part) {
    if (part >= 1.0 || same(frameStart, frameEnd))
        next = frameEnd;
    else
        mix(frameStart, frameEnd, part, next);
}

void BoneDynamics::State::sleep() {
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

BoneDynamics::BoneDynamics(std::unique_ptr<State> state) : state_(std::move(state)) {}
BoneDynamics::BoneDynamics(BoneDynamics&&) noexcept = default;
BoneDynamics& BoneDynamics::operator=(BoneDynamics&&) noexcept = default;
BoneDynamics::~BoneDynamics() = default;

Result<BoneDynamics> BoneDynamics::build(Input input) {
    if (const auto ok = checkInput(input); !ok) return tl::unexpected(ok.error());
    double heaviest = 0.0;
    for (const double m : input.mass) heaviest = std::max(heaviest, m);
    for (double& m : input.mass) m = std::max(m, kLightest * heaviest);
    return BoneDynamics(std::make_unique<State>(std::move(input)));
}

Result<void> BoneDynamics::set(const BoneDynamicsSettings& settings) {
    if (const auto ok = checkSettings(settings, state_->skeleton.bones.size()); !ok) return ok;
    std::fill(state_->body.contact.begin(), state_->body.contact.end(), State::kNone);  // the ground may have sunk
    state_->settings = settings;
    state_->prepare();
    return {};
}

bool BoneDynamics::takeMotion(const BoneDynamics& of) { return state_->takeMotion(*of.state_); }
void BoneDynamics::takeMotion(const BoneDynamics& of, std::span<const int> pointOf) { state_->takeMotion(*of.state_, pointOf); }
void BoneDynamics::reset(const Pose& pose) { state_->reset(pose); }
void BoneDynamics::step(double seconds, const Pose& kinematic, std::span<const IkGoal> goals) { state_->step(seconds, kinematic, goals); }
void BoneDynamics::seeFlesh(std::span<const FleshPoint> flesh, const std::vector<Vec3>& points) { state_->seeFlesh(flesh, points); }
const Pose& BoneDynamics::pose() const { return state_->out; }
bool BoneDynamics::resting() const { return state_->resting; }
unsigned BoneDynamics::warnings() const { return state_->warnings; }
BoneDynamics::Energy BoneDynamics::energy() const { return state_->energy; }
const std::vector<Vec3>& BoneDynamics::velocities() const { return state_->body.v; }

}  // namespace imomushi
