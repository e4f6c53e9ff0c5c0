// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/input_driver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/rotation_vector.h"
#include "core/document/cycle.h"
#include "core/skeleton/bone_tree.h"

namespace imomushi {

namespace {

/// Weights far beyond 1 shorten no bone to less than this part of its length at rest.
constexpr double kShortest = 0.05;
/// Of an amount or a speed, what is less is nothing: a filter comes near to 0 and does not arrive.
constexpr double kNothing = 1e-6;

/// The number of an effect within the bounds of its property.
double withinProperty(const LiveInput& input) {
    const EffectProperty& p = propertyOf(input).first;
    const double value = std::clamp(input.weight, p.low, p.high);
    return p.whole ? std::round(value) : value;
}

}  // namespace

const InputDriver::Cycled* InputDriver::cycleNamed(std::string_view name) const {
    const auto found = std::ranges::find(cycles_, name, &Cycled::name);
    return found == cycles_.end() ? nullptr : &*found;
}

bool InputDriver::cycling() const {
    return std::ranges::any_of(cycles_, [this](const Cycled& cycle) { return amountOf(cycle) != 0.0; });
}

double InputDriver::amountOf(const Cycled& cycle) const { return std::abs(mapper_.shown(cycle.amount)) < kNothing ? 0.0 : mapper_.shown(cycle.amount); }
double InputDriver::speedOf(const Cycled& cycle) const { return std::abs(mapper_.shown(cycle.speed)) < kNothing ? 0.0 : mapper_.shown(cycle.speed); }

std::optional<double> InputDriver::phaseOf(std::string_view cycle) const {
    const Cycled* found = cycleNamed(cycle);
    return found ? std::optional(found->phase) : std::nullopt;
}

double InputDriver::rests() const {
    return std::ranges::any_of(cycles_, [this](const Cycled& cycle) { return runs(cycle); }) ? 0.0 : mapper_.rests();
}

std::span<const LiveInput> InputDriver::step(double seconds) {
    mapper_.step(seconds);
    turnCycles(seconds);
    moved_.clear();
    const auto moves = [this](const auto& slotNumbers) { return std::any_of(slotNumbers.begin(), slotNumbers.end(), [this](int slot) { return slot >= 0 && mapper_.moved(slot); }); };
    const bool posed = addPoses();
    const bool turns = posed || std::any_of(turned_.begin(), turned_.end(), [&](const Turned& t) { return moves(t.slotNumbers); });
    for (Driven& driven : driven_) {
        driven.moved = !driven.byHand && ((posed && driven.posed) || moves(driven.slotNumbers));
        if (!driven.moved) continue;
        LiveInput& input = driven.input;
        const auto put = [&](std::size_t slot, double& to, double rest, double byPoses, double base, double added) {
            if (driven.slotNumbers[slot] >= 0) to = rest + mapper_.shown(driven.slotNumbers[slot]) + byPoses;
            else if (driven.posed) to = base + added;
        };
        if (input.isNumber()) {
            put(0, input.weight, 0.0, driven.weightByPoses, driven.base.weight, driven.addedWeight);
            if (input.kind == LiveInput::Kind::Effect) input.weight = withinProperty(input);
        } else {
            for (Eigen::Index k = 0; k < 3; ++k) put(static_cast<std::size_t>(k), input.target[k], driven.rest[k], driven.byPoses[k], driven.base.target[k], driven.added[k]);
            if (input.kind == LiveInput::Kind::End) {
                if (driven.slotNumbers[3] >= 0) input.roll = mapper_.shown(driven.slotNumbers[3]);
                input.hasRoll = input.hasRoll || (driven.slotNumbers[3] >= 0 && mapper_.winner(driven.slotNumbers[3]) >= 0);
            } else {
                for (Eigen::Index k = 0; k < 3; ++k) put(static_cast<std::size_t>(3 + k), driven.turn[k], 0.0, driven.turnByPoses[k], driven.baseTurn[k], driven.addedTurn[k]);
                if (driven.posed || driven.slotNumbers[3] >= 0 || driven.slotNumbers[4] >= 0 || driven.slotNumbers[5] >= 0) input.rotation = rotationOf(driven.turn);
            }
        }
    }
    const auto carried = [&](const Turned& t) {
        const Driven& end = driven_[t.end];
        const Driven* start = t.start >= 0 ? &driven_[static_cast<std::size_t>(t.start)] : nullptr;
        return (start && (start->moved || (poses_ && start->byHand))) || (poses_ && (end.moved || end.byHand));
    };
    if (turns || std::ranges::any_of(turned_, carried)) {
        turnAll();
        for (Turned& bone : turned_) follow(bone);
    }
    for (const Driven& driven : driven_)
        if (driven.moved) moved_.push_back(driven.input);
    return moved_;
}

void InputDriver::turnCycles(double seconds) {
    for (Cycled& cycle : cycles_) {
        if (!runs(cycle)) continue;
        cycle.phase += seconds * speedOf(cycle) / cycle.seconds;
        cycle.phase -= std::floor(cycle.phase);
    }
}

void InputDriver::weighPoses() {
    for (Posed& pose : posed_) pose.weight = pose.slot >= 0 ? mapper_.shown(pose.slot) : 0.0;
    for (const Cycled& cycle : cycles_) {
        const double amount = amountOf(cycle);
        if (amount == 0.0) continue;
        for (std::size_t k = 0; k < cycle.poses.size(); ++k) posed_[cycle.poses[k]].weight += amount * cycleWeight(k, cycle.poses.size(), cycle.phase);
    }
}

bool InputDriver::addPoses() {
    const bool moved = std::ranges::any_of(posed_, [this](const Posed& p) { return p.slot >= 0 && mapper_.moved(p.slot); }) ||
                       std::ranges::any_of(cycles_, [this](const Cycled& c) { return mapper_.moved(c.amount) || runs(c); });
    if (!moved) return false;
    weighPoses();
    // Where there never was anything of a pose, bones need not be held for it.
    if (!poses_ && std::ranges::none_of(posed_, [](const Posed& p) { return std::abs(p.weight - p.before) > kNothing; })) return false;
    poses_ = true;
    sumPoses();
    return true;
}

void InputDriver::sumPoses() {
    for (Turned& bone : turned_) bone.added.setZero(), bone.byPoses.setZero(), bone.longer = bone.longerByPoses = 0.0;
    for (Driven& driven : driven_) {
        driven.added.setZero(), driven.addedTurn.setZero(), driven.addedWeight = 0.0;
        driven.byPoses.setZero(), driven.turnByPoses.setZero(), driven.weightByPoses = 0.0;
    }
    for (const Posed& pose : posed_) {
        const double more = pose.weight - pose.before;
        for (const Posed::OfBone& b : pose.bones) {
            Turned& bone = turned_[b.turned];
            bone.added += more * b.turn;
            bone.longer += more * b.longer;
            bone.byPoses += pose.weight * b.turn;
            bone.longerByPoses += pose.weight * b.longer;
        }
        for (const Posed::OfThing& t : pose.things) {
            Driven& driven = driven_[t.driven];
            driven.added += more * t.by;
            driven.addedTurn += more * t.turn;
            driven.addedWeight += more * t.weight;
            driven.byPoses += pose.weight * t.by;
            driven.turnByPoses += pose.weight * t.turn;
            driven.weightByPoses += pose.weight * t.weight;
        }
    }
}

void InputDriver::takePosesOut() {
    sumPoses();
    turnAll();
    for (const Driven& driven : driven_) {
        const Vec3 turn = driven.input.kind == LiveInput::Kind::Handle ? driven.turnByPoses : Vec3::Zero();
        const std::array<double, 6> out = {driven.input.isNumber() ? driven.weightByPoses : driven.byPoses.x(), driven.byPoses.y(), driven.byPoses.z(), turn.x(), turn.y(), turn.z()};
        for (std::size_t k = 0; k < out.size(); ++k)
            if (const int slot = driven.slotNumbers[k]; slot >= 0 && out[k] != 0.0) mapper_.setByHand(slot, false, mapper_.shown(slot) - out[k]);
    }
}

void InputDriver::rebase(Driven& driven) {
    driven.base = driven.input;
    driven.base.target -= driven.added;
    driven.base.weight -= driven.addedWeight;
    driven.baseTurn = driven.turn - driven.addedTurn;
}

void InputDriver::turn(Turned& bone) {
    for (std::size_t k = 0; k < bone.slotNumbers.size(); ++k) {
        const auto axis = static_cast<Eigen::Index>(k);
        bone.turn[axis] = (bone.slotNumbers[k] >= 0 ? mapper_.shown(bone.slotNumbers[k]) : bone.base[axis]) + bone.added[axis];
    }
    const Turned* parent = bone.parent >= 0 ? &turned_[static_cast<std::size_t>(bone.parent)] : nullptr;
    const Driven* start = bone.start >= 0 ? &driven_[static_cast<std::size_t>(bone.start)] : nullptr;
    const bool hangs = parent && !(start && placed(*start));
    bone.startNow = hangs ? Vec3(parent->startNow + parent->now * (parent->length * bone.fromParent)) : start ? start->input.target : bone.startAt;
    // A row that turns a bone gives it its length at rest; poses have lengths of their own.
    const double length = bone.hasRow() && !poses_ ? 1.0 : std::max(bone.baseLength + bone.longer, kShortest);
    bone.length = bone.led ? bone.ledLength : length;
    bone.now = bone.led ? bone.ledNow : (parent ? parent->now : bone.parentTurn) * rotationOf(bone.turn);
    if (posed_.empty() || limbs_.empty()) return;  // nobody asks what it is without poses
    bone.unposedStart = hangs ? Vec3(parent->unposedStart + parent->unposedNow * (parent->unposedLength * bone.fromParent)) : start ? Vec3(start->input.target - start->byPoses) : bone.startAt;
    bone.unposedLength = std::max(length - bone.longerByPoses, kShortest);
    bone.unposedNow = (parent ? parent->unposedNow : bone.parentTurn) * rotationOf(bone.turn - bone.byPoses);
}

void InputDriver::turnAll() {
    for (Turned& bone : turned_) bone.led = false, turn(bone);
    if (posed_.empty()) return;
    for (const Limb& limb : limbs_) {
        const Turned& last = turned_[limb.bones.front()];
        Driven& end = driven_[last.end];
        end.byPoses = last.endNow() - last.unposedEnd();
        if (!poses_ || !(end.byHand || placed(end))) continue;
        if (end.byHand) {
            lead(limb);
            for (Turned& bone : turned_) turn(bone);
            continue;
        }
        end.input.target = last.endNow();
        const Vec3 aside = end.rest - last.unposedEnd();
        for (std::size_t k = 0; k < 3; ++k) {
            const int slot = end.slotNumbers[k];
            if (!leads(slot)) continue;
            // Who lets go leaves it where poses and the bones themselves have it.
            const auto axis = static_cast<Eigen::Index>(k);
            end.input.target[axis] += mapper_.shown(slot) + (mapper_.winner(slot) >= 0 ? 1.0 : mapper_.left(slot)) * aside[axis];
        }
        lead(limb);
        for (Turned& bone : turned_) turn(bone);
    }
}

/// FABRIK (Aristidou and Lasenby 2011) from where poses have the limb, so that it keeps their shape. What is left after these rounds, as of a limb that is too short or is pushed along itself, goes to all its bones.
void InputDriver::lead(const Limb& limb) {
    constexpr int kRounds = 24;
    constexpr double kMet = 1e-6;  // of the limb's length
    std::size_t n = 1;
    const auto isLed = [this](const Turned& bone) { return std::ranges::any_of(bone.slotNumbers, [this](int slot) { return leads(slot); }); };
    while (n < limb.bones.size() && !isLed(turned_[limb.bones[n]]) && !placed(driven_[turned_[limb.bones[n]].end]) && !driven_[turned_[limb.bones[n]].end].byHand) ++n;
    const auto bone = [&](std::size_t i) -> Turned& { return turned_[limb.bones[n - 1 - i]]; };
    const Turned& last = bone(n - 1);
    const Vec3 target = driven_[last.end].input.target;
    const auto startOf = [&](std::size_t i) { return i < n ? bone(i).startNow : last.endNow(); };
    double whole = 0.0;
    for (std::size_t i = 0; i <= n; ++i) limbPoints_[i] = startOf(i);
    for (std::size_t i = 0; i < n; ++i) whole += limbLengths_[i] = (limbPoints_[i + 1] - limbPoints_[i]).norm();
    if (!(whole > 0.0)) return;
    const auto pull = [&](std::size_t i, const Vec3& from, double length) {
        const Vec3 way = limbPoints_[i] - from;
        if (const double far = way.norm(); far > 0.0) limbPoints_[i] = from + length / far * way;
    };
    for (int round = 0; round < kRounds && (limbPoints_[n] - target).norm() > kMet * whole; ++round) {
        limbPoints_[n] = target;
        for (std::size_t i = n; i-- > 1;) pull(i, limbPoints_[i + 1], limbLengths_[i]);
        for (std::size_t i = 1; i <= n; ++i) pull(i, limbPoints_[i - 1], limbLengths_[i - 1]);
    }
    const Vec3 left = target - limbPoints_[n];
    double along = 0.0;
    for (std::size_t i = 1; i <= n; ++i) limbPoints_[i] += (along += limbLengths_[i - 1]) / whole * left;
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3 was = startOf(i + 1) - startOf(i), is = limbPoints_[i + 1] - limbPoints_[i];
        Turned& led = bone(i);
        led.led = true;
        led.ledNow = led.now;
        led.ledLength = led.length;
        if (!(was.norm() > 0.0 && is.norm() > 0.0)) continue;
        led.ledNow = (minimalRotation(was.normalized(), is.normalized()) * led.now).normalized();
        led.ledLength *= is.norm() / was.norm();
    }
}

void InputDriver::follow(Turned& bone) {
    const bool mine = bone.hasRow();
    const Turned* parent = bone.parent >= 0 ? &turned_[static_cast<std::size_t>(bone.parent)] : nullptr;
    const bool moves = mine || bone.between || poses_;  // else it only carries others
    if (bone.start >= 0 && !parent && moves) {
        Driven& start = driven_[static_cast<std::size_t>(bone.start)];
        start.moved = !start.byHand;  // held, too
    }
    const Eigen::Quaterniond& carried = parent ? parent->untwisted : bone.parentUntwisted;
    const Vec3 way = bone.now * (bone.length * bone.along), direction = way.normalized();
    bone.untwisted = (minimalRotation(carried * bone.along.normalized(), direction) * carried).normalized();
    Driven& end = driven_[bone.end];
    LiveInput& input = end.input;
    const Eigen::Quaterniond twist = bone.now * bone.untwisted.conjugate();
    if (end.byHand || !moves || (bone.pinned && !mine)) return;
    // Where something drives its place or roll themselves, that counts.
    if (!placed(end)) input.target = bone.startNow + way;
    if (end.slotNumbers[3] < 0 || mapper_.winner(end.slotNumbers[3]) < 0) input.roll = bone.rollSign * rotationVector(twist.w() < 0.0 ? Eigen::Quaterniond(-twist.coeffs()) : twist).dot(direction);
    input.hasRoll = end.moved = true;
}

void InputDriver::forgetNumbers() {
    for (Driven& driven : driven_) driven.held = false;
}

bool InputDriver::holds(const LiveInput& input) const {
    return std::any_of(driven_.begin(), driven_.end(), [&](const Driven& d) { return d.held && d.input.sameTarget(input); });
}

bool InputDriver::moves(const LiveInput& input) const {
    const auto driven = [this](const auto& slots) { return std::ranges::any_of(slots, [this](int slot) { return slot >= 0 && mapper_.winner(slot) >= 0; }); };
    if (std::ranges::any_of(posed_, [](const Posed& pose) { return std::abs(pose.weight) > kNothing; }) || cycling()) return true;
    const auto thing = std::ranges::find_if(driven_, [&](const Driven& d) { return d.input.sameTarget(input); });
    if (thing == driven_.end()) return false;
    if (driven(thing->slotNumbers)) return true;
    // Bones that are turned hang on others, which are held for them.
    const auto index = static_cast<std::size_t>(thing - driven_.begin());
    return std::ranges::any_of(turned_, [&](const Turned& t) { return t.end == index || t.start == static_cast<int>(index); }) && std::ranges::any_of(turned_, [&](const Turned& t) { return driven(t.slotNumbers); });
}

void InputDriver::giveToHand(const LiveInput& held) {
    for (Driven& driven : driven_) {
        if (!driven.input.sameTarget(held)) continue;
        driven.byHand = true;
        driven.input.target = held.target;  // bones that start there are turned about it
        for (const int slot : driven.slotNumbers)
            if (slot >= 0) mapper_.setByHand(slot, true, mapper_.shown(slot));
        for (const Turned& bone : turned_)
            for (const int slot : bone.slotNumbers)
                if (slot >= 0 && &driven_[bone.end] == &driven) mapper_.setByHand(slot, true, mapper_.shown(slot));
    }
}

void InputDriver::pointAt(Turned& bone, const Vec3& end) {
    const Vec3 way = end - bone.startNow, was = bone.now * bone.along;
    const bool knows = way.norm() > 0.0 && was.norm() > 0.0;
    if (knows) {
        const Turned* parent = bone.parent >= 0 ? &turned_[static_cast<std::size_t>(bone.parent)] : nullptr;
        const Eigen::Quaterniond now = minimalRotation(was.normalized(), way.normalized()) * bone.now;
        bone.turn = rotationVector(((parent ? parent->now : bone.parentTurn).conjugate() * now).normalized());
        bone.base = bone.turn - bone.added;
        if (poses_) bone.baseLength = way.norm() / bone.along.norm() - bone.longer;
    }
    for (std::size_t k = 0; k < bone.slotNumbers.size(); ++k)
        if (bone.slotNumbers[k] >= 0) mapper_.setByHand(bone.slotNumbers[k], false, bone.turn[static_cast<Eigen::Index>(k)] - bone.added[static_cast<Eigen::Index>(k)]);
}

void InputDriver::leaveLimb(const Driven& end, const Vec3& at) {
    for (const Limb& limb : limbs_) {
        if (&driven_[turned_[limb.bones.front()].end] != &end) continue;
        for (std::size_t i = limb.bones.size(); i-- > 1;)
            if (Turned& bone = turned_[limb.bones[i]]; bone.led) pointAt(bone, bone.endNow());
    }
    for (Turned& bone : turned_)
        if (&driven_[bone.end] == &end) pointAt(bone, at);
}

void InputDriver::read(std::span<InputMeter> meters) const {
    for (std::size_t i = 0; i < rowOf_.size() && i < meters.size(); ++i) meters[i] = rowOf_[i] < 0 ? InputMeter() : mapper_.meterOf(static_cast<std::size_t>(rowOf_[i]));
}

void InputDriver::hold(const LiveInput& held) {
    for (Driven& driven : driven_) {
        LiveInput& input = driven.input;
        if (!input.sameTarget(held)) continue;
        if (driven.byHand) input.target = held.target, turnAll();  // it may have let go elsewhere than where it was told last
        const bool byHand = std::exchange(driven.byHand, false);
        if (byHand) leaveLimb(driven, held.target), turnAll();
        driven.held = true;
        // What only poses move was taken hold of where it is, and goes on by them.
        const auto restarts = [&](int slot) { return slot >= 0 && (byHand || !driven.posed || mapper_.winner(slot) >= 0); };
        if (input.isNumber()) {
            if (restarts(driven.slotNumbers[0])) mapper_.setByHand(driven.slotNumbers[0], false, held.weight - driven.weightByPoses);
            input.weight = held.weight;
            continue;
        }
        input.target = held.target;
        input.rotation = held.rotation;
        input.roll = held.roll;
        driven.turn = rotationVector(held.rotation);
        if (byHand) rebase(driven);
        const Vec3 place = held.target - driven.byPoses - driven.rest, turn = driven.turn - driven.turnByPoses;
        const std::array<double, 6> shown = {place.x(), place.y(), place.z(), input.kind == LiveInput::Kind::End ? held.roll : turn.x(), turn.y(), turn.z()};
        for (std::size_t k = 0; k < shown.size(); ++k)
            if (restarts(driven.slotNumbers[k])) mapper_.setByHand(driven.slotNumbers[k], false, shown[k]);
    }
}

}  // namespace imomushi
