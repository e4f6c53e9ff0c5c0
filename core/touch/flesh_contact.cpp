// SPDX-License-Identifier: GPL-3.0-or-later
// Islands of bodies, and which of them are awake; each of these takes its steps: who meets (flesh_meetings.cpp), and what forces come of it (flesh_forces.cpp).
#include "core/touch/flesh_contact.h"

#include <algorithm>
#include <numeric>

namespace imomushi {
namespace {

/// Each contact has a compliance of its own, this part of the mean compliance of the patches around it. Otherwise more contacts than patches would have no solution.
constexpr double kPatchSoftness = 0.005;
constexpr int kSweepsInFrame = 16, kSweepsToConverge = 60, kRoundsToConverge = 12;

}  // namespace

FleshContact::FleshContact(std::vector<Body> bodies) : bodies_(std::move(bodies)), states_(bodies_.size()) {
    const std::size_t count = bodies_.size();
    std::size_t samples = 0, patchesOfOne = 0;
    for (std::size_t e = 0; e < count; ++e) {
        const ContactSurface& surface = *bodies_[e].surface;
        const auto& touch = surface.surface().touch();
        const Eigen::Index patches = touch.patches.count();
        const auto n = static_cast<std::size_t>(patches);
        State& s = states_[e];
        s.forces = s.before = Eigen::VectorXd::Zero(3 * patches);
        s.pressed.reserve(n);
        s.active.reserve(n);
        s.slot.assign(n, -1);
        s.sums = Eigen::Matrix3Xd::Zero(3, patches);
        s.sumsFloat = Eigen::Matrix4Xf::Zero(4, patches);
        s.strain = Eigen::VectorXf::Zero(touch.gradients.rows());
        s.memory.resize(surface.samples());
        s.candidates.resize(surface.samples());
        s.near.reserve(surface.samples());
        s.vertices.resize(touch.patches.first.size() - 1);
        s.sampleAt = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(surface.samples()));
        s.placed.assign(n, 0);
        s.muted.resize(count);
        for (std::size_t i = 0; i < n; ++i) s.boxes.push_back(boxOf(e, i, surface.surface().vertex(touch.patches.centre[i])));
        s.tree = BoxTree(s.boxes);
        s.softness = kPatchSoftness * touch.compliance.trace() / static_cast<double>(3 * std::max<Eigen::Index>(patches, 1)) / bodies_[e].shear;
        samples += surface.samples();
        patchesOfOne = std::max(patchesOfOne, n);
    }
    island_.resize(count);
    std::iota(island_.begin(), island_.end(), std::size_t{0});
    lastIsland_ = island_;
    awake_.resize(count);
    woken_.resize(count);
    members_.reserve(count);
    meetings_.reserve(samples);
    near_.pairs.reserve(count * (count + 1) / 2);
    near_.grounded.reserve(count);
    findTouchingAtRest();
    const std::size_t most = std::min(samples, std::max(kMost, kMostPerBody * count));
    contacts_.reserve(most);
    rows_.resize(static_cast<Eigen::Index>(2 * most * kBlock * patchesOfOne));  // memory that most characters never touch
}

/// The island of this body. True: it has converged.
bool FleshContact::once(const Posed& posed, std::size_t island, int sweeps) {
    members_.clear();
    for (std::size_t body = island; body < bodies_.size(); ++body)
        if (island_[body] == island) members_.push_back(body);
    beginStep(posed);
    findMeetings(posed);
    keepDeepest();
    solve(posed, sweeps);
    return sumForces();
}

void FleshContact::begin(const Near& near, const Settings& settings, std::span<const char> moved) {
    const bool all = moved.empty() || !(settings == settings_);
    near_ = near;
    settings_ = settings;
    // An island wakes as a whole, also where it has lost whom it met.
    lastIsland_.swap(island_);
    std::fill(awake_.begin(), awake_.end(), 0);
    for (std::size_t body = 0; body < bodies_.size(); ++body)
        if (all || moved[body] || !states_[body].converged) awake_[lastIsland_[body]] = 1;
    std::iota(island_.begin(), island_.end(), std::size_t{0});
    const auto find = [&](std::size_t body) {
        while (island_[body] != body) body = island_[body] = island_[island_[body]];
        return body;
    };
    for (State& s : states_) s.met = false;
    for (const std::size_t body : near_.grounded) states_[body].met = true;
    for (const auto& [a, b] : near_.pairs) {
        states_[a].met = states_[b].met = true;
        const std::size_t p = find(a), q = find(b);
        island_[std::max(p, q)] = std::min(p, q);
    }
    std::fill(woken_.begin(), woken_.end(), 0);
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
        island_[body] = find(body);
        if (awake_[lastIsland_[body]]) woken_[island_[body]] = 1;
    }
    for (std::size_t body = 0; body < bodies_.size(); ++body) states_[body].asleep = states_[body].met && !woken_[island_[body]];
}

void FleshContact::finish(const Posed& posed, bool converge) {
    converged_ = true;
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
        if (!states_[body].met) release(body);
        if (!awake(body) || island_[body] != body) continue;
        bool converged = once(posed, body, converge ? kSweepsToConverge : kSweepsInFrame);
        for (int i = 1; converge && !converged && i < kRoundsToConverge; ++i) converged = once(posed, body, kSweepsToConverge);
        converged_ = converged_ && converged;
    }
}

void FleshContact::release(std::size_t body) {
    State& s = states_[body];
    s.converged = true;
    s.bounded = false;
    s.step = 0;  // what its samples knew is forgotten
    if (s.pressed.empty()) return;
    s.forces.setZero();
    s.pressed.clear();
    s.force.setZero();
}

void FleshContact::reset() {
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
        release(body);
        states_[body].converged = false;
    }
    converged_ = true;
}

bool FleshContact::idle() const {
    return std::all_of(states_.begin(), states_.end(), [](const State& s) { return s.pressed.empty(); });
}

bool FleshContact::bounded() const {
    return std::any_of(states_.begin(), states_.end(), [](const State& s) { return s.bounded; });
}

std::size_t FleshContact::bytes() const {
    std::size_t sum = 0;
    for (const auto& body : bodies_) sum += body.surface->bytes();
    return sum;
}

}  // namespace imomushi
