// SPDX-License-Identifier: GPL-3.0-or-later
// What forces come of meetings: a projected Gauss-Seidel method over the contacts of an island (each alone is solved exactly), with the forces on patches as its
// unknowns: what one contact does, the others feel through them.
#include <algorithm>
#include <cmath>

#include "core/touch/flesh_contact.h"

namespace imomushi {
namespace {

/// In so many sweeps the first looks at all contacts, the others at those that press.
constexpr int kAllOf = 4;
/// Forces have converged when what they change moves nothing by more than this part of the body.
constexpr double kConverged = 1e-5;

}  // namespace

/// Which patches take how much of a force at a point. False: none does.
bool FleshContact::spread(Spread& out, const std::array<std::int32_t, 3>& corners, const Vec3& parts) {
    State& s = states_[out.body];
    const TouchPatches& patches = bodies_[out.body].surface->patches();
    out.count = 0;
    double sum = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
        const double part = parts[static_cast<Eigen::Index>(c)];
        if (!(part > 0.0)) continue;
        const auto v = static_cast<std::size_t>(corners[c]);
        for (auto i = static_cast<std::size_t>(patches.first[v]); i < static_cast<std::size_t>(patches.first[v + 1]); ++i) {
            const std::int32_t patch = patches.patch[i];
            auto& slot = s.slot[static_cast<std::size_t>(patch)];
            if (slot < 0) {
                slot = static_cast<std::int32_t>(s.active.size());
                s.active.push_back(patch);
            }
            const auto known = std::find(out.slot.begin(), out.slot.begin() + static_cast<std::ptrdiff_t>(out.count), slot) - out.slot.begin();
            const auto k = static_cast<std::size_t>(known);
            if (k == out.count) {
                if (out.count == kWidth) continue;
                out.slot[k] = slot;
                out.weight[k] = 0.0;
                ++out.count;
            }
            out.weight[k] += part * static_cast<double>(patches.weight[i]);
            sum += part * static_cast<double>(patches.weight[i]);
        }
    }
    if (!(sum > 0.0)) return false;
    for (std::size_t k = 0; k < out.count; ++k) out.weight[k] /= sum;
    return true;
}

/// How far active patches move a point by their forces, for shear modulus 1.
void FleshContact::findRows(const Spread& of, const std::array<std::int32_t, 3>& corners, const Vec3& parts) {
    const State& s = states_[of.body];
    const TouchSurface& surface = bodies_[of.body].surface->surface();
    const auto& displacement = surface.touch().displacement;
    std::fill_n(rows_.data() + of.rows, kBlock * s.active.size(), 0.0f);
    for (std::size_t c = 0; c < 3; ++c) {
        const auto part = static_cast<float>(parts[static_cast<Eigen::Index>(c)]);
        const std::int32_t row = surface.row(corners[c]);
        if (!(part > 0.0f) || row < 0) continue;
        for (std::size_t k = 0; k < s.active.size(); ++k)
            for (Eigen::Index axis = 0; axis < 3; ++axis) {
                float* to = rows_.data() + of.rows + kBlock * k + 4 * static_cast<std::size_t>(axis);
                const float* from = &displacement.coeffRef(row, 3 * s.active[k] + axis);
                for (int i = 0; i < 3; ++i) to[i] += part * from[i];
            }
    }
}

Vec3 FleshContact::moved(const Spread& of) const {
    if (of.body == kGround) return Vec3::Zero();
    const State& s = states_[of.body];
    using Column = Eigen::Map<const Eigen::Array4f, Eigen::Aligned16>;
    Eigen::Array4f sum = Eigen::Array4f::Zero();
    const float *row = rows_.data() + of.rows, *force = s.sumsFloat.data();
    for (std::size_t k = 0; k < s.active.size(); ++k, row += kBlock, force += 4)
        sum += force[0] * Column(row) + force[1] * Column(row + 4) + force[2] * Column(row + 8);
    return s.axes * (sum.matrix().head<3>().cast<double>() / bodies_[of.body].shear);
}

void FleshContact::applyForce(const Spread& of, const Vec3& force) {
    if (of.body == kGround) return;
    State& s = states_[of.body];
    const Vec3 here = s.axes.transpose() * force;
    for (std::size_t k = 0; k < of.count; ++k) {
        const auto slot = of.slot[k];
        s.sums.col(slot) += of.weight[k] * here;
        s.sumsFloat.col(slot).head<3>() = s.sums.col(slot).cast<float>();
    }
}

double FleshContact::softness(const Contact& c) const { return states_[c.on.body].softness + (c.under.body == kGround ? 0.0 : states_[c.under.body].softness); }

Eigen::Matrix3d FleshContact::axesUnder(const Contact& c) const {
    return c.under.body == kGround ? Eigen::Matrix3d::Identity() : states_[c.under.body].axes;
}

void FleshContact::solve(const Posed& posed, int sweeps) {
    for (const std::size_t body : members_) {
        State& s = states_[body];
        for (const std::int32_t patch : s.active) s.slot[static_cast<std::size_t>(patch)] = -1;
        s.active.clear();
    }
    const auto alone = [](std::int32_t v) { return std::array<std::int32_t, 3>{v, v, v}; };
    contacts_.clear();
    for (const Meeting& m : meetings_) {
        Contact& c = contacts_.emplace_back();
        c.met = m;
        c.normal = m.normal;
        c.on.body = m.body;
        c.under.body = m.other;
        const bool spreads =
            spread(c.on, alone(bodies_[m.body].surface->vertex(m.sample)), Vec3::UnitX()) &&
            (m.other == kGround || spread(c.under, bodies_[m.other].surface->surface().corners(m.at.triangle), m.at.barycentric));
        if (!spreads) contacts_.pop_back();
    }
    for (const std::size_t body : members_) {
        State& s = states_[body];
        s.sums.leftCols(static_cast<Eigen::Index>(s.active.size())).setZero();
        s.sumsFloat.leftCols(static_cast<Eigen::Index>(s.active.size())).setZero();
    }
    std::size_t rows = 0;
    const auto takeRows = [&](Spread& of, const std::array<std::int32_t, 3>& corners, const Vec3& parts) {
        of.rows = rows;
        rows += kBlock * states_[of.body].active.size();
        findRows(of, corners, parts);
    };
    for (Contact& c : contacts_) {
        const Meeting& m = c.met;
        const bool ground = m.other == kGround;
        const std::int32_t vertex = bodies_[m.body].surface->vertex(m.sample);
        takeRows(c.on, alone(vertex), Vec3::UnitX());
        if (!ground) takeRows(c.under, bodies_[m.other].surface->surface().corners(m.at.triangle), m.at.barycentric);
        // What a force on it and its counterforce do to where the two are.
        c.compliance = softness(c) * Eigen::Matrix3d::Identity();
        const auto add = [&](const Spread& at, const Spread& by, double sign) {
            if (at.body != by.body || at.body == kGround) return;
            Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
            for (std::size_t k = 0; k < by.count; ++k) {
                const float* block = rows_.data() + at.rows + kBlock * static_cast<std::size_t>(by.slot[k]);
                sum += by.weight[k] * Eigen::Map<const Eigen::Matrix4f>(block).topLeftCorner<3, 3>().cast<double>();
            }
            const Eigen::Matrix3d& axes = states_[at.body].axes;
            c.compliance += sign / bodies_[at.body].shear * (axes * sum * axes.transpose());
        };
        add(c.on, c.on, 1.0);
        add(c.under, c.under, 1.0);
        add(c.on, c.under, -1.0);
        add(c.under, c.on, -1.0);

        const State& s = states_[m.body];
        const Memory& known = s.memory[m.sample];
        c.force.setZero();
        c.goal = m.apart.dot(c.normal) * c.normal;
        if (known.step != 0 && known.step == s.lastStep && known.other == m.other) {
            // It sticks to the flesh that it was on: to the side it is apart from there.
            Vec3 held = ground ? settings_.ground.origin() : Vec3(Vec3::Zero());
            for (std::size_t k = 0; !ground && k < 3; ++k)
                if (const double part = known.held.barycentric[static_cast<Eigen::Index>(k)]; part > 0.0)
                    held += part * vertexAt(m.other, bodies_[m.other].surface->surface().corners(known.held.triangle)[k], posed);
            const Vec3 apart = vertexAt(m.body, vertex, posed) - held - axesUnder(c) * known.slipped;
            c.goal += apart - apart.dot(c.normal) * c.normal;
            c.force = axesUnder(c) * known.force;
        }
        c.goal = -c.goal;
    }
    for (const Contact& c : contacts_) {
        applyForce(c.on, c.force);
        applyForce(c.under, -c.force);
    }
    for (int i = 0, sinceAll = 0; i < sweeps; ++i, ++sinceAll) {
        const bool all = sinceAll % kAllOf == 0;
        bool moves = false;
        for (Contact& c : contacts_) {
            if (!all && c.how == ContactPoint::How::None) continue;
            const Vec3 before = c.force;
            const double soft = softness(c);
            const Vec3 gap = c.goal - (moved(c.on) - moved(c.under)) - soft * before + c.compliance * before;
            ContactSolver::solveAlone(c.compliance, gap, c.under.body == kGround ? settings_.groundFriction : settings_.friction, c);
            applyForce(c.on, c.force - before);
            applyForce(c.under, before - c.force);
            moves = moves || (c.compliance * (c.force - before)).norm() > kConverged * bodies_[c.on.body].surface->surface().size();
        }
        if (moves) continue;
        if (all) break;
        sinceAll = -1;  // the next one looks at all
    }
}

/// True: what changed does not show.
bool FleshContact::sumForces() {
    for (const std::size_t body : members_) {
        State& s = states_[body];
        s.before.swap(s.forces);
        s.forces.setZero();
        s.pressed.clear();
        s.force.setZero();
    }
    for (const Contact& c : contacts_) {
        const Meeting& m = c.met;
        State& s = states_[m.body];
        Memory& known = s.memory[m.sample];
        const bool goesOn = known.step != 0 && known.step == s.lastStep && known.other == m.other;
        if (c.how == ContactPoint::How::None) continue;
        if (!goesOn || c.how == ContactPoint::How::Slip) {
            // It sticks from here on: where it met the surface, or as far as it has slipped.
            Vec3 apart = m.apart;
            if (c.how == ContactPoint::How::Slip) apart += moved(c.on) - moved(c.under);
            known.held = m.at;
            known.slipped = axesUnder(c).transpose() * (apart - apart.dot(c.normal) * c.normal);
        }
        known.step = s.step;
        known.other = m.other;
        known.force = axesUnder(c).transpose() * c.force;
        s.force += c.force;
        if (m.other != kGround) states_[m.other].force -= c.force;
    }
    bool converged = true;
    for (const std::size_t body : members_) {
        State& s = states_[body];
        const TouchSurface& surface = bodies_[body].surface->surface();
        for (std::size_t k = 0; k < s.active.size(); ++k) {
            const Vec3 force = s.sums.col(static_cast<Eigen::Index>(k)) / bodies_[body].shear;
            if (force.isZero(0.0)) continue;
            s.pressed.push_back(s.active[k]);
            s.forces.segment<3>(3 * s.active[k]) = force;
        }
        std::sort(s.pressed.begin(), s.pressed.end());
        s.strain.setZero();
        for (const std::int32_t p : s.pressed)
            for (Eigen::Index i = 3 * p; i < 3 * p + 3; ++i) s.strain += static_cast<float>(s.forces[i]) * surface.touch().gradients.col(i);
        double most = 0.0;
        for (Eigen::Index i = 0; !s.pressed.empty() && i < s.strain.size(); i += 9)
            most = std::max(most, static_cast<double>(s.strain.segment<9>(i).squaredNorm()));
        most = std::sqrt(most);
        if (most > settings_.mostStrain) s.forces *= settings_.mostStrain / most;
        double moves = 0.0;
        for (Eigen::Index i = 0; i < s.forces.size(); ++i) moves += surface.largestDisplacement()[i / 3] * std::abs(s.forces[i] - s.before[i]);
        s.converged = moves <= kConverged * surface.size();
        converged = converged && s.converged;
    }
    return converged;
}

}  // namespace imomushi
