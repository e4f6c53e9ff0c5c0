// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/performance.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/base/try.h"
#include "core/base/union_find.h"
#include "core/document/bone_effects.h"
#include "core/document/effect_meetings.h"
#include "core/effects/ground_job.h"
#include "core/mesh/topology.h"
#include "core/skeleton/bone_tree.h"

namespace imomushi {

namespace {

/// kg per joint point: each element's mass on its bones by their lengths, half to each end. Bones through nothing are as heavy per length as the
/// others are on average. Times the weights of the bones.
std::vector<double> massesOf(const Document& document, const CharacterPlan& plan) {
    const Skeleton& skeleton = plan.input.skeleton;
    std::vector<double> boneMass(skeleton.bones.size(), 0.0), masses(skeleton.points.size(), 0.0);
    double massive = 0.0, mass = 0.0;
    for (std::size_t e = 0; e < plan.elements.size(); ++e) {
        const auto& bones = plan.input.elements[e].bones;
        double length = 0.0;
        for (const int b : bones) length += skeleton.bones[static_cast<std::size_t>(b)].length;
        if (bones.empty()) continue;
        const Element& element = *document.elements.at(plan.elements[e]);
        const double all = element.density * std::abs(enclosedVolume(element.mesh->body.vertices, element.mesh->body.triangles));
        for (const int b : bones) boneMass[static_cast<std::size_t>(b)] += all * skeleton.bones[static_cast<std::size_t>(b)].length / length;
        massive += length;
        mass += all;
    }
    const double perLength = mass > 0.0 ? mass / massive : 1.0;
    for (std::size_t b = 0; b < boneMass.size(); ++b) {
        const auto& bone = skeleton.bones[b];
        const double half = 0.5 * document.bones.at(plan.bones[b])->weight * (boneMass[b] > 0.0 ? boneMass[b] : perLength * bone.length);
        masses[static_cast<std::size_t>(bone.start)] += half;
        masses[static_cast<std::size_t>(bone.end)] += half;
    }
    return masses;
}

/// With contact, flesh between a joint point and the ground is pressed together by this part: bones come down until it is, and dents carry them. A
/// tenth is more than the dents of a folded caterpillar carry: its flesh is then 3.4 % of its height below.
constexpr double kPressed = 0.08;
/// But never farther than this (sizes of the skeleton): what is far from its joint point is not thicker there.
constexpr double kMostPressed = 0.008;
/// Flesh without bone dynamics is held when another round would move no joint point by more, in sizes of the skeleton.
constexpr double kHeld = 1e-5;
/// Frames in which joint points follow their flesh down again, while nobody moves them.
constexpr int kFollowed = 30;
/// Joint points that the ground lifts farther than this (sizes) above where they are held say so.
constexpr double kLifted = 1e-3;
/// Flesh that is deeper in the ground than this (sizes of the skeleton) at the end of a frame is not shown so.
constexpr double kDeep = 0.005;
/// The same with contact, of flesh as it is dented.
constexpr double kDeepest = 0.01;

bool same(const Pose& a, const Pose& b) {
    return a.points == b.points && a.roll == b.roll &&
           std::equal(a.frames.begin(), a.frames.end(), b.frames.begin(), b.frames.end(), [](const auto& p, const auto& q) { return p.coeffs() == q.coeffs(); });
}

}  // namespace

Result<Performance> Performance::build(const Document& document, const CharacterPlan& plan) {
    Performance made;
    made.skeleton_ = plan.input.skeleton;
    made.bones_ = plan.bones;
    for (const Vec3& p : made.skeleton_.points) made.size_ = std::max(made.size_, (p - made.skeleton_.points.front()).norm());
    made.clearance_.resize(made.skeleton_.points.size());
    made.depthOf_.resize(made.skeleton_.points.size());
    UnionFind wholes(made.skeleton_.points.size());
    for (const auto& bone : made.skeleton_.bones) wholes.unite(bone.start, bone.end);
    std::vector<int> pointOf(plan.input.elements.size(), -1);
    const auto unite = [&](std::size_t element, int point) {
        if (pointOf[element] < 0) pointOf[element] = point;
        wholes.unite(pointOf[element], point);
    };
    for (std::size_t e = 0; e < pointOf.size(); ++e)
        for (const int bone : plan.input.elements[e].bones) unite(e, made.skeleton_.bones[static_cast<std::size_t>(bone)].start);
    for (const auto& joint : plan.input.joints)
        for (const auto& face : joint.faces)
            if (joint.point >= 0) unite(static_cast<std::size_t>(face.element), joint.point);
    for (std::size_t i = 0; i < made.skeleton_.points.size(); ++i) made.wholeOf_.push_back(wholes.find(static_cast<std::int32_t>(i)));
    made.take(document.effects);
    if (document.effects.has(EffectKind::BoneDynamics) && !plan.input.skeleton.bones.empty()) {
        IMOMUSHI_TRY(made.dynamics_, BoneDynamics::build({plan.input.skeleton, massesOf(document, plan), made.settingsOf(document.effects)}));
    }
    made.clearing_.emplace(made.skeleton_);
    made.kinematic_ = made.raised_ = made.next_ = made.shown_ = restPose(made.skeleton_);
    made.raise(made.kinematic_, made.raised_);
    return made;
}

bool Performance::takeMotion(const Performance& of) {
    if (!dynamics_ || !of.dynamics_ || bones_ != of.bones_ || !dynamics_->takeMotion(*of.dynamics_)) return false;
    // What lift() raised in the last frame stays raised.
    raised_ = of.raised_;
    lifted_ = of.lifted_;
    return true;
}

void Performance::takeMotionOfBones(const Performance& of) {
    if (!dynamics_ || !of.dynamics_) return;
    std::vector<int> pointOf(skeleton_.points.size(), -1);
    for (std::size_t b = 0; b < bones_.size(); ++b) {
        const auto was = std::ranges::find(of.bones_, bones_[b]);
        if (was == of.bones_.end()) continue;
        const Skeleton::Bone &now = skeleton_.bones[b], &then = of.skeleton_.bones[static_cast<std::size_t>(was - of.bones_.begin())];
        pointOf[static_cast<std::size_t>(now.start)] = then.start;
        pointOf[static_cast<std::size_t>(now.end)] = then.end;
    }
    dynamics_->takeMotion(*of.dynamics_, pointOf);
}

double Performance::predict(const Document& document, const CharacterPlan& plan) {
    auto trial = build(document, plan);
    if (!trial || plan.input.skeleton.bones.empty()) return 0.0;
    Pose pose = restPose(plan.input.skeleton);
    trial->reset(pose, {});
    // One bone in three is turned a little, so that all springs work.
    for (std::size_t i = 0; i < pose.points.size(); i += 3) pose.points[i] += Vec3::Constant(0.05 * plan.input.skeleton.bones[0].length);
    // Several runs, as the first ones find cold caches and others are interrupted; few, as the user waits for the answer.
    constexpr std::size_t kFewest = 9, kMax = 40;
    constexpr double kLongest = 4.0;  // ms, all together
    std::vector<double> times;
    for (double sum = 0.0; times.size() < kFewest || (times.size() < kMax && sum < kLongest); sum += times.back()) {
        trial->step(1.0 / 60.0, pose, {});
        times.push_back(trial->milliseconds());
    }
    const auto quiet = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 4);
    std::nth_element(times.begin(), quiet, times.end());
    return *quiet;
}

void Performance::take(const Effects& effects) {
    ground_.reset();
    if (effects.has(EffectKind::Ground)) {
        const auto asked = effects.settings<GroundEffect>(EffectKind::Ground);
        ground_ = BoneDynamicsSettings::Ground{asked.plane(), asked.friction};
    }
    pressed_ = effects.has(EffectKind::Contact) && !waitsToMeet(effects, EffectKind::Contact) ? kPressed : 0.0;
}

const BoneDynamicsSettings& Performance::settingsOf(const Effects& effects) {
    const auto asked = effects.settings<BoneDynamicsEffect>(EffectKind::BoneDynamics);
    BoneDynamicsSettings& settings = asked_;
    settings.springs.assign(1, {asked.stretchHertz, asked.stretchDamping, asked.swingHertz, asked.swingDamping, asked.rollHertz, asked.rollDamping});
    settings.airDamping = asked.airDamping;
    settings.ground = ground_;
    settings.gravity = effects.has(EffectKind::Gravity) ? effects.vector(EffectKind::Gravity, "acceleration") : BoneDynamicsSettings().gravity;
    // What falls on the ground must be free to lie where it falls; without such gravity it comes back, and rests on the ground where its pose is in it.
    settings.returnHertz = ground_ && ground_->plane.normal().dot(settings.gravity) < 0.0 ? 0.0 : asked.returnHertz;
    return settings;
}

Result<void> Performance::set(const Effects& effects) {
    const auto ground = ground_;
    const double pressed = pressed_;
    take(effects);
    if (dynamics_)
        if (auto ok = dynamics_->set(settingsOf(effects)); !ok) {
            ground_ = ground;
            pressed_ = pressed;
            return ok;
        }
    held_ = false;
    still_ = 0;
    return {};
}

void Performance::reset(const Pose& kinematic, std::span<const IkGoal> goals) {
    lifted_ = held_ = false;
    still_ = 0;
    if (dynamics_)
        dynamics_->reset(kinematic);
    else
        follow(kinematic, goals);
}

void Performance::step(double seconds, const Pose& kinematic, std::span<const IkGoal> goals) {
    const auto start = std::chrono::steady_clock::now();
    if (dynamics_) {
        lifted_ = false;
        dynamics_->step(seconds, kinematic, goals);
    } else {
        follow(kinematic, goals);
    }
    milliseconds_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void Performance::follow(const Pose& kinematic, std::span<const IkGoal> goals) {
    warnings_ = 0;
    if (!fits(skeleton_, kinematic)) return;
    const bool known = same(kinematic, kinematic_);
    still_ = known ? std::min(still_ + 1, kFollowed) : 0;
    // What is held stays where it is, to the bit. Where flesh and its joint points chase each other, from then on points go up only.
    if (!(known && (held_ || still_ == kFollowed))) {
        kinematic_ = kinematic;
        shown_ = raised_;
        lifted_ = false;
        raise(kinematic_, raised_);
    } else if (still_ == kFollowed) {
        shown_ = raised_;
        lifted_ = true;
    }
    for (const IkGoal& goal : goals) {
        if (!ground_ || goal.point < 0 || goal.point >= static_cast<int>(raised_.points.size())) continue;
        const auto i = static_cast<std::size_t>(goal.point);
        if (ground_->plane.normal().dot(raised_.points[i] - kinematic_.points[i]) > kLifted * size_) warnings_ |= static_cast<unsigned>(DynamicsWarning::HeldByGround);
    }
}

void Performance::seeFlesh(std::span<const FleshPoint> flesh, const std::vector<Vec3>& points) {
    if (!ground_) return;
    flesh_.assign(flesh.begin(), flesh.end());
    for (FleshPoint& f : flesh_)
        if (const double far = pressed_ > 0.0 ? f.offset.norm() : 0.0; far > 0.0) f.offset *= 1.0 - std::min(pressed_, kMostPressed * size_ / far);
    if (dynamics_) dynamics_->seeFlesh(flesh_, points);
    clearing_->see(flesh_, points);
    if (dynamics_) {
        held_ = clearing_->depth(ground_->plane) <= kHeld * size_;
        return;
    }
    // Where flesh had to be lifted, the way there goes on: what counts is that it ends where it did in the last frame.
    if (!lifted_) raise(kinematic_, next_);
    const Pose& again = lifted_ ? shown_ : next_;
    double moved = 0.0;
    for (std::size_t i = 0; i < raised_.points.size(); ++i) moved = std::max(moved, (again.points[i] - raised_.points[i]).cwiseAbs().maxCoeff());
    held_ = moved <= kHeld * size_;
}

bool Performance::lift() {
    if (!ground_ || clearing_->depth(ground_->plane) <= kDeep * size_) return false;
    // From where it is shown: each time only farther up.
    raise(pose(), next_);
    std::swap(next_, raised_);
    lifted_ = true;
    return true;
}

bool Performance::liftWhole(std::span<const FleshDepth> depths) {
    if (!ground_) return false;
    const double allowed = (pressed_ > 0.0 ? kDeepest : kDeep) * size_;
    next_ = pose();
    std::fill(depthOf_.begin(), depthOf_.end(), 0.0);
    double deepest = 0.0;
    for (const FleshDepth& f : depths) {
        double& depth = depthOf_[static_cast<std::size_t>(wholeOf_[static_cast<std::size_t>(f.point)])];
        depth = std::max(depth, f.depth);
        deepest = std::max(deepest, depth);
    }
    if (deepest <= allowed) return false;
    for (std::size_t i = 0; i < next_.points.size(); ++i)
        next_.points[i] += std::max(0.0, depthOf_[static_cast<std::size_t>(wholeOf_[i])] - allowed) * ground_->plane.normal();
    std::swap(next_, raised_);
    lifted_ = true;
    return true;
}

// Joint points that the ground lifts take their bones along; each frame hangs on its parent's by the least rotation.
void Performance::raise(const Pose& pose, Pose& raised) {
    raised = pose;
    if (!ground_) return;
    clearing_->raise(raised.points, ground_->plane, clearance_);
    if (raised.points == pose.points) return;
    for (std::size_t b = 0; b < skeleton_.bones.size(); ++b) {
        const auto& bone = skeleton_.bones[b];
        const auto start = static_cast<std::size_t>(bone.start), end = static_cast<std::size_t>(bone.end);
        const Vec3 was = pose.points[end] - pose.points[start], is = raised.points[end] - raised.points[start];
        if (is.norm() <= 1e-9 * bone.length || was.norm() <= 1e-9 * bone.length) continue;
        raised.frames[b] = (minimalRotation(was.normalized(), is.normalized()) * pose.frames[b]).normalized();
    }
}

EffectCost effectCost(const Document& document, const DocumentResponses& responses, EffectKind effect) {
    EffectCost cost = responses.costOf(effect);
    if (effectDescriptor(effect).scope != EffectScope::Bones) return cost;
    Document asked = document;
    for (const EffectKind other : {EffectKind::BoneDynamics, EffectKind::Ground}) asked.effects[other].enabled = other == effect;
    if (const auto planned = planCharacter(asked)) cost.milliseconds += Performance::predict(asked, *planned);
    return cost;
}

}  // namespace imomushi
