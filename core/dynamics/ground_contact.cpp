// SPDX-License-Identifier: GPL-3.0-or-later
// Contact of BoneDynamics with the ground plane: unilateral, inelastic, with Coulomb friction; and what else is prescribed in a step.
#include <algorithm>
#include <cmath>

#include "core/dynamics/bone_dynamics_state.h"

namespace imomushi {

namespace {

constexpr double kTouching = 1e-10;    // sizes: as near counts as on the plane
constexpr double kStickSpeed = 1e-4;   // sizes per second: slower points on the ground stick
constexpr double kGrabSeconds = 0.04;  // time constant with which a newly held point approaches its kinematic place
constexpr double kArrived = 1e-12;     // sizes: as near to it is there
constexpr double kSameFlesh = 2e-6;    // sizes: flesh is seen in single precision, and what lies on it would never rest
// Time constant with which bones follow what flesh does by itself. Flesh lags behind bones: who follows that at once drives them on, and flesh never rests.
constexpr double kFleshSeconds = 0.1;
constexpr double kLifted = 1e-3;       // sizes: held points that the ground keeps this far above their kinematic places say so

}  // namespace

double BoneDynamics::State::friction(int i) const {
    const Vec3 along = body.v[i] - normal.dot(body.v[i]) * normal;
    return settings.ground->friction * body.normalForce[i] / std::max(along.norm(), kStickSpeed * size);
}

bool BoneDynamics::State::touches(std::size_t i) const { return body.contact[i] != kNone || (held[i] && height(i, body.x[i]) < kLifted * size); }

// What flesh does by itself is seen once a frame: it is spread over the frame, as motion and not as blows.
void BoneDynamics::State::followFlesh(double h) {
    fleshMoves = false;
    for (std::size_t i = 0; i < alone.size(); ++i) alone[i] = held[i] || body.contact[i] != kNone;
    flesh.find(body.x, settings.ground->plane, alone, wanted);
    const double part = remaining > h ? h / remaining : 1.0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        const double more = wanted[i] - body.clearance[i];
        if (std::abs(more) <= kSameFlesh * size) continue;
        fleshMoves = fleshMoves || touches(i);
        body.clearance[i] += part * more;
    }
    remaining -= h;
}

void BoneDynamics::State::seeFlesh(std::span<const FleshPoint> seen, const std::vector<Vec3>& points) {
    flesh.see(seen, points, unseen < 0.0 ? 1.0 : 1.0 - std::exp(-unseen / kFleshSeconds));
    unseen = 0.0;
    if (!resting || !settings.ground) return;
    for (std::size_t i = 0; i < alone.size(); ++i) alone[i] = held[i] || body.contact[i] != kNone;
    flesh.find(body.x, settings.ground->plane, alone, wanted);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        const double more = wanted[i] - (touches(i) ? body.clearance[i] : std::max(body.clearance[i], settings.ground->plane.height(body.x[i])));
        if (more > 2.0 * kSameFlesh * size || (touches(i) && more < -2.0 * kSameFlesh * size)) return wake();
    }
}

bool BoneDynamics::State::prescribe(double h) {
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
            if (settings.ground && height(i, next.points[i]) < -kLifted * size) warnings |= static_cast<unsigned>(DynamicsWarning::HeldByGround);
            driven = driven || goal[i] != body.x[i];
        } else if (settings.ground) {
            const double above = height(i, body.x[i]);
            // The plane moved, or the flesh did.
            if (above < -kTouching * size && body.contact[i] == kNone) {
                body.contact[i] = kSliding;
                arriving[i] = 1;
            }
            driven = driven || above < -kTouching * size || (fleshMoves && body.contact[i] != kNone);
            if (body.contact[i] == kSliding) freedom[i] = Freedom::OnPlane;
            if (body.contact[i] == kSticking) freedom[i] = Freedom::Fixed, goal[i] -= above * normal;
        }
    }
    return driven;
}

bool BoneDynamics::State::detectContact() {
    bool more = false;
    for (std::size_t i = 0; i < xs.size(); ++i) {
        if (freedom[i] != Freedom::Free || height(i, xs[i]) >= -kTouching * size) continue;
        freedom[i] = Freedom::OnPlane;
        body.contact[i] = kSliding;
        body.normalForce[i] = 0.0;
        arriving[i] = 1;
        more = true;
    }
    return more;
}

void BoneDynamics::State::updateContact(const BoneSprings::Motion& motion) {
    const double s = stageSeconds, mu = settings.ground->friction;
    for (std::size_t i = 0; i < xs.size(); ++i) force0[i] = mass[i] * settings.gravity;
    springs.forces(xs, vs, next, motion, force0, nullptr, s, freedom, normal);
    for (std::size_t i = 0; i < xs.size(); ++i) {
        if (held[i]) {
            body.contact[i] = kNone;
            continue;
        }
        if (body.contact[i] == kNone) continue;
        // A ground or flesh that rises lifts what lies on it, and does not throw it.
        const Vec3 lifted = std::max(normal.dot(vs[i]), 0.0) * normal;
        const Vec3 reaction = mass[i] / s * (vs[i] - v0[i]) - force0[i];
        const double pressed = normal.dot(reaction);
        vs[i] -= lifted;
        if (arriving[i]) {  // an inelastic impact, and what friction takes along the plane meanwhile
            const double hit = std::max(-normal.dot(body.v[i]), 0.0);
            vs[i] -= normal.dot(vs[i]) * normal;
            const double speed = vs[i].norm();
            if (speed > 0.0) vs[i] *= std::max(0.0, 1.0 - mu * hit / speed);
            body.normalForce[i] = 0.0;
            continue;
        }
        body.normalForce[i] = std::max(pressed, 0.0);
        if (pressed < 0.0) {
            body.contact[i] = kNone;
        } else if (body.contact[i] == kSliding) {
            if (mu > 0.0 && vs[i].norm() < kStickSpeed * size) {
                body.contact[i] = kSticking;
                vs[i].setZero();
            }
        } else if ((reaction - pressed * normal).norm() > mu * pressed) {
            body.contact[i] = kSliding;
        }
    }
}

}  // namespace imomushi
