// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/performance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/document/bone_effects.h"
#include "core/mesh/topology.h"

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

/// m per joint point: the radius of the joint faces there; where there is none, the distance of the nearest skin of its elements.
std::vector<double> clearancesOf(const CharacterPlan& plan) {
    const Skeleton& skeleton = plan.input.skeleton;
    std::vector<double> clearance(skeleton.points.size(), 0.0);
    for (const auto& joint : plan.input.joints) {
        if (joint.point < 0) continue;
        for (const auto& f : joint.faces) {
            const JointFace& face = plan.input.elements[static_cast<std::size_t>(f.element)].faces[static_cast<std::size_t>(f.face)];
            auto& c = clearance[static_cast<std::size_t>(joint.point)];
            c = std::max(c, face.size);
        }
    }
    for (const auto& element : plan.input.elements)
        for (const int b : element.bones)
            for (const int p : {skeleton.bones[static_cast<std::size_t>(b)].start, skeleton.bones[static_cast<std::size_t>(b)].end}) {
                auto& c = clearance[static_cast<std::size_t>(p)];
                if (c == 0.0 && element.mesh->body.vertices.rows() > 0)
                    c = (element.mesh->body.vertices.rowwise() - skeleton.points[static_cast<std::size_t>(p)].transpose()).rowwise().norm().minCoeff();
            }
    return clearance;
}

}  // namespace

Result<Performance> Performance::build(const Document& document, const CharacterPlan& plan) {
    Performance made;
    made.skeleton_ = plan.input.skeleton;
    made.tree_ = boneTree(made.skeleton_);
    if (document.effects.has(EffectKind::Ground)) made.clearance_ = clearancesOf(plan);
    made.ground_ = made.groundOf(document.effects);
    if (document.effects.has(EffectKind::BoneDynamics) && !plan.input.skeleton.bones.empty()) {
        auto dynamics = BoneDynamics::build({plan.input.skeleton, massesOf(document, plan), made.settingsOf(document.effects)});
        if (!dynamics) return tl::unexpected(dynamics.error());
        made.dynamics_ = std::move(*dynamics);
    }
    made.raise(restPose(made.skeleton_));
    return made;
}

double Performance::predict(const Document& document, const CharacterPlan& plan) {
    auto trial = build(document, plan);
    if (!trial || plan.input.skeleton.bones.empty()) return 0.0;
    Pose pose = restPose(plan.input.skeleton);
    trial->reset(pose);
    // One bone in three is turned a little, so that all springs work.
    for (std::size_t i = 0; i < pose.points.size(); i += 3) pose.points[i] += Vec3::Constant(0.05 * plan.input.skeleton.bones[0].length);
    // The first ones find caches cold, and others are disturbed. Somebody waits for the answer.
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

std::optional<BoneDynamicsSettings::Ground> Performance::groundOf(const Effects& effects) const {
    if (!effects.has(EffectKind::Ground)) return std::nullopt;
    const auto asked = effects.settings<GroundEffect>(EffectKind::Ground);
    return BoneDynamicsSettings::Ground{asked.plane(), asked.friction, clearance_};
}

BoneDynamicsSettings Performance::settingsOf(const Effects& effects) const {
    const auto asked = effects.settings<BoneDynamicsEffect>(EffectKind::BoneDynamics);
    BoneDynamicsSettings settings;
    settings.springs = {{asked.stretchHertz, asked.stretchDamping, asked.swingHertz, asked.swingDamping, asked.rollHertz, asked.rollDamping}};
    settings.ground = groundOf(effects);
    // Whatever rests on the ground must be free to fall on it.
    settings.returnHertz = settings.ground ? 0.0 : asked.returnHertz;
    if (effects.has(EffectKind::Gravity)) settings.gravity = effects.vector(EffectKind::Gravity, "acceleration");
    return settings;
}

Result<void> Performance::set(const Effects& effects) {
    if (dynamics_)
        if (auto ok = dynamics_->set(settingsOf(effects)); !ok) return ok;
    ground_ = groundOf(effects);
    return {};
}

void Performance::reset(const Pose& kinematic) {
    if (dynamics_)
        dynamics_->reset(kinematic);
    else
        raise(kinematic);
}

void Performance::step(double seconds, const Pose& kinematic, std::span<const IkGoal> goals) {
    const auto start = std::chrono::steady_clock::now();
    if (dynamics_)
        dynamics_->step(seconds, kinematic, goals);
    else
        raise(kinematic);
    milliseconds_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

// Joint points that the ground lifts take their bones along; each frame hangs on its parent's by the least rotation.
void Performance::raise(const Pose& kinematic) {
    raised_ = kinematic;
    if (!ground_ || !fits(skeleton_, kinematic)) return;
    bool lifted = false;
    for (std::size_t i = 0; i < raised_.points.size(); ++i) {
        const double gap = ground_->plane.height(raised_.points[i]) - ground_->clearance[i];
        if (gap >= 0.0) continue;
        raised_.points[i] -= gap * ground_->plane.normal();
        lifted = true;
    }
    if (!lifted) return;
    for (std::size_t b = 0; b < skeleton_.bones.size(); ++b) {
        const auto& bone = skeleton_.bones[b];
        const Vec3 along = raised_.points[static_cast<std::size_t>(bone.end)] - raised_.points[static_cast<std::size_t>(bone.start)];
        if (along.norm() <= 1e-9 * bone.length) continue;
        const int parent = tree_.parent[b];
        const Eigen::Quaterniond base = parent < 0 ? kinematic.frames[b] : raised_.frames[static_cast<std::size_t>(parent)];
        raised_.frames[b] = (minimalRotation((base * tree_.restDirection[b]).normalized(), along.normalized()) * base).normalized();
    }
}

}  // namespace imomushi
