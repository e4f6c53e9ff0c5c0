// SPDX-License-Identifier: GPL-3.0-or-later
// The numbers between the two halves of a frame: what pose and effects decide, and vertices follow.
#include <algorithm>

#include "core/base/rotation_vector.h"
#include "core/character/character_state.h"

namespace imomushi {

using Eigen::Matrix3d;
using Eigen::Quaterniond;

namespace {

double* put(double* to, const double* from, Eigen::Index count) { return std::copy_n(from, count, to); }

Eigen::Index dentNumbers(const ElementState& e) { return Dent::kNumbers * static_cast<Eigen::Index>(e.fingerDents.size()); }

Vec3 mixed(const Vec3& a, const Vec3& b, double part) { return a + part * (b - a); }

/// The short way round; the sign follows the first.
Quaterniond turned(const double* a, const double* b, double part) {
    const Eigen::Map<const Quaterniond> from(a), to(b);
    return from.slerp(part, to).normalized();
}

}  // namespace

ShapeLayout Character::shapeLayout() const {
    ShapeLayout layout;
    const Frame& f = state_->frame;
    for (const auto& e : f.elements) layout.elements.push_back({static_cast<int>(e.weights().size()), static_cast<int>(e.patchForces.size() + dentNumbers(e)), e.fades ? 1 : 0});
    layout.joints = static_cast<int>(f.joints.size());
    layout.warping = f.warpingShapes;
    layout.nodes = static_cast<int>(f.offsets.size());
    for (const auto& e : f.elements) layout.turns += static_cast<int>(e.turns.size());
    for (const auto& weights : f.morphs) layout.morphs += static_cast<int>(weights.size());
    return layout;
}

void Character::shape(double* to) const {
    const Frame& s = state_->frame;
    for (const auto& e : s.elements) {
        to = put(to, e.rotation.coeffs().data(), 4);
        to = put(to, e.frame.shift.data(), 3);
        to = put(to, e.weights().data(), e.weights().size());
        to = put(to, e.patchForces.data(), e.patchForces.size());
        for (const Dent& dent : e.fingerDents) {
            dent.put(to);
            to += Dent::kNumbers;
        }
        if (e.fades) *to++ = e.warpPart;
    }
    for (const auto& j : s.joints) {
        to = put(to, j.rotation.coeffs().data(), 4);
        to = put(to, j.map.linear.data(), 9);
        to = put(to, j.map.shift.data(), 3);
        *to++ = j.part;
        to = put(to, j.warping.data(), j.warping.size());
    }
    for (const auto& offset : s.offsets) to = put(to, offset.data(), 3);
    for (const auto& e : s.elements)
        for (const auto& turn : e.turns) to = put(to, turn.data(), 3);
    for (const auto& weights : s.morphs) to = put(to, weights.data(), static_cast<Eigen::Index>(weights.size()));
}

void Character::show(const double* from) {
    Frame& s = state_->frame;
    const auto start = std::chrono::steady_clock::now();
    s.warnings = 0;
    state_->beginTimes();
    const auto take = [&from](double* to, Eigen::Index count) {
        std::copy_n(from, count, to);
        from += count;
    };
    for (auto& e : s.elements) {
        take(e.rotation.coeffs().data(), 4);
        e.frame.linear = e.rotation.toRotationMatrix();
        take(e.frame.shift.data(), 3);
        if (e.withLoads.size() > 0) {
            take(e.withLoads.data(), e.withLoads.size());
            e.v = e.withLoads.head(e.v.size());
        } else {
            take(e.v.data(), e.v.size());
        }
        take(e.patchForces.data(), e.patchForces.size());
        for (Dent& dent : e.fingerDents) {
            dent.take(from);
            from += Dent::kNumbers;
        }
        if (e.fades) take(&e.warpPart, 1);
    }
    for (auto& j : s.joints) {
        take(j.rotation.coeffs().data(), 4);
        take(j.map.linear.data(), 9);
        take(j.map.shift.data(), 3);
        take(&j.part, 1);
        take(j.warping.data(), j.warping.size());
    }
    for (auto& offset : s.offsets) take(offset.data(), 3);
    for (auto& e : s.elements)
        for (auto& turn : e.turns) take(turn.data(), 3);
    for (auto& weights : s.morphs) take(weights.data(), static_cast<Eigen::Index>(weights.size()));
    s.replaying = true;
    state_->showShape(start);
}

void Character::between(const double* a, const double* b, double part, double* to) const {
    const Frame& s = state_->frame;
    const auto mix = [&](Eigen::Index count) {
        for (; count > 0; --count, ++a, ++b) *to++ = *a + part * (*b - *a);
    };
    const auto turn = [&] {
        const Quaterniond q = turned(a, b, part);
        to = put(to, q.coeffs().data(), 4);
        a += 4, b += 4;
        return q;
    };
    for (const auto& e : s.elements) {
        // About the middle of the element, as its box would move.
        const Matrix3d fromLinear = Eigen::Map<const Quaterniond>(a).toRotationMatrix(), toLinear = Eigen::Map<const Quaterniond>(b).toRotationMatrix();
        const Quaterniond q = turn();
        const Vec3 place = mixed(fromLinear * e.runtime->middle + Eigen::Map<const Vec3>(a), toLinear * e.runtime->middle + Eigen::Map<const Vec3>(b), part);
        const Vec3 shift = place - q.toRotationMatrix() * e.runtime->middle;
        to = put(to, shift.data(), 3);
        a += 3, b += 3;
        mix(e.weights().size() + e.patchForces.size());
        for (std::size_t i = 0; i < e.fingerDents.size(); ++i, a += Dent::kNumbers, b += Dent::kNumbers, to += Dent::kNumbers) {
            Dent first, second;
            first.take(a);
            second.take(b);
            Dent::between(first, second, part).put(to);
        }
        mix(e.fades ? 1 : 0);
    }
    for (const auto& j : s.joints) {
        const Matrix3d fromTurn = Eigen::Map<const Quaterniond>(a).toRotationMatrix(), toTurn = Eigen::Map<const Quaterniond>(b).toRotationMatrix();
        const Matrix3d now = turn().toRotationMatrix();
        const Eigen::Map<const Matrix3d> fromLinear(a), toLinear(b);
        const Matrix3d linear = now * (fromTurn.transpose() * fromLinear + part * (toTurn.transpose() * toLinear - fromTurn.transpose() * fromLinear));
        const Vec3 place = mixed(fromLinear * j.restPlace + Eigen::Map<const Vec3>(a + 9), toLinear * j.restPlace + Eigen::Map<const Vec3>(b + 9), part);
        const Vec3 shift = place - linear * j.restPlace;
        to = put(to, linear.data(), 9);
        to = put(to, shift.data(), 3);
        a += 12, b += 12;
        mix(1);
        for (Eigen::Index k = 0; k < j.warping.cols(); ++k, a += 3, b += 3) {
            const Vec3 w = now * mixed(fromTurn.transpose() * Eigen::Map<const Vec3>(a), toTurn.transpose() * Eigen::Map<const Vec3>(b), part);
            to = put(to, w.data(), 3);
        }
    }
    mix(3 * static_cast<Eigen::Index>(s.offsets.size()));
    for (const auto& e : s.elements)
        for (std::size_t i = 0; i < e.turns.size(); ++i, a += 3, b += 3) {
            const Vec3 mean = rotationVector(rotationOf(Eigen::Map<const Vec3>(a)).slerp(part, rotationOf(Eigen::Map<const Vec3>(b))));
            to = put(to, mean.data(), 3);
        }
    for (const auto& weights : s.morphs) mix(static_cast<Eigen::Index>(weights.size()));
}

void Character::keepExact(bool exact) { state_->frame.exact = exact; }

Points Character::restPositions(int element) const {
    Points out = state_->frame.input.elements[static_cast<std::size_t>(element)].mesh->body.vertices;
    for (const auto& h : state_->frame.elements[static_cast<std::size_t>(element)].held) out.row(h.vertex) = h.rest.transpose();
    return out;
}

std::vector<std::int32_t> Character::heldVertices(int element) const {
    std::vector<std::int32_t> out;
    for (const auto& h : state_->frame.elements[static_cast<std::size_t>(element)].held) out.push_back(h.vertex);
    return out;
}

Points Character::heldPositions(int element) const {
    const auto& e = state_->frame.elements[static_cast<std::size_t>(element)];
    Points out(static_cast<Eigen::Index>(e.held.size()), 3);
    for (std::size_t i = 0; i < e.held.size(); ++i) out.row(static_cast<Eigen::Index>(i)) = state_->frame.heldAt(e, i).transpose();
    return out;
}

std::vector<int> Character::loadColumns(int element) const { return state_->frame.elements[static_cast<std::size_t>(element)].runtime->input.tables.loads; }

bool Character::isWarped(int element) const { return state_->frame.elements[static_cast<std::size_t>(element)].runtime->warp != nullptr; }

double Character::warpPart(int element) const { return state_->frame.elements[static_cast<std::size_t>(element)].warpPart; }

}  // namespace imomushi
