// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs of patches that are near, their samples against triangles, and a projected Gauss-Seidel method over all contacts (each alone is solved exactly), with
// the forces on patches as its unknowns: what one contact does, the others feel through them.
#include "core/touch/flesh_contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/mesh/closest_point.h"

namespace imomushi {
namespace {

/// A patch is stretched and bent by its pose: its vertices are within this many radii of its middle.
constexpr double kReach = 1.3;
/// Surfaces can press where their normals are opposed by more than this cosine: at a right angle or so, one looks along the other.
constexpr double kOpposed = -0.1;
/// The cosine of normals that are so after a turn by kMostTurn and as much strain at most.
const double kTurned = std::cos(std::acos(kOpposed) - 2.0 * FleshContact::kMostTurn);
/// Beyond the border of a surface (a joint), a sample is not on it where it is this many times as far to the side as it is deep.
constexpr double kBeside = 0.5;
/// Samples this near to a surface, in spacings of samples, are contacts that may come to press.
constexpr double kMargin = 0.5;
/// Samples no farther than this part of the smaller body from another surface touch it at rest.
constexpr double kTouching = 1e-3;
/// Deeper than this part of the smaller body a sample has passed through, and which way is out is not known.
constexpr double kDeepest = 0.3;
/// Patches of one body are neighbours where their middles at rest are nearer than this many times their radii together.
constexpr double kApart = 2.5;
/// A contact gives way by this part of the mean compliance of the patches around it: many contacts on few patches have an answer.
constexpr double kSoftness = 0.005;
constexpr int kSweeps = 16, kSweepsToSettle = 60, kRoundsToSettle = 12;
/// Forces have settled when what they change moves nothing by more than this part of the body.
constexpr double kSettled = 1e-5;
constexpr int kMostSteps = 24;  // along a surface to the nearest vertex

}  // namespace

/// Patches of one body that are neighbours do not press on each other.
static bool areApart(const ContactSurface& of, int i, int k) {
    const auto& centre = of.patches().centre;
    return (of.surface().vertex(centre[static_cast<std::size_t>(i)]) - of.surface().vertex(centre[static_cast<std::size_t>(k)])).norm() >= kApart * (of.radius(i) + of.radius(k));
}

FleshContact::FleshContact(std::vector<Body> bodies) : bodies_(std::move(bodies)), states_(bodies_.size()) {
    for (std::size_t e = 0; e < bodies_.size(); ++e) {
        const ContactSurface& surface = *bodies_[e].surface;
        const auto& touch = surface.surface().touch();
        const Eigen::Index patches = touch.patches.count();
        State& s = states_[e];
        s.forces = s.before = Eigen::VectorXd::Zero(3 * patches);
        s.pressed.reserve(static_cast<std::size_t>(patches));
        s.active.reserve(static_cast<std::size_t>(patches));
        s.slot.assign(static_cast<std::size_t>(patches), -1);
        s.sums = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(kMostPatches));
        s.memory.resize(surface.samples());
        s.candidates.resize(surface.samples());
        s.met.reserve(surface.samples());
        s.vertices.resize(touch.patches.first.size() - 1);
        s.muted.resize(bodies_.size());
        s.softness = kSoftness * touch.compliance.trace() / static_cast<double>(3 * std::max<Eigen::Index>(patches, 1)) / bodies_[e].shear;
    }
    contacts_.reserve(kMost);
    rows_.resize(2 * kMost * 9 * kMostPatches);

    // At rest: who touches whom, and how far others are.
    class Rest : public Posed {
    public:
        explicit Rest(const std::vector<Body>& of) : of_(of) {}
        [[nodiscard]] Vec3 at(std::size_t body, std::int32_t vertex) const override { return of_[body].surface->surface().vertex(vertex); }
        [[nodiscard]] const Eigen::Matrix3d& axes(std::size_t) const override { return axes_; }

    private:
        const std::vector<Body>& of_;
        Eigen::Matrix3d axes_ = Eigen::Matrix3d::Identity();
    } rest(bodies_);
    clearance_.assign(bodies_.size() * bodies_.size(), std::numeric_limits<double>::infinity());
    for (std::size_t a = 0; a < bodies_.size(); ++a)
        for (std::size_t b = a; b < bodies_.size(); ++b) {
            findContacts({{{a, b}}, {}}, rest, {});
            for (const Contact& contact : contacts_) {
                if (contact.at.distance > kTouching * std::min(bodies_[a].surface->surface().size(), bodies_[b].surface->surface().size())) continue;
                auto& muted = states_[contact.on.body].muted[contact.under.body];
                muted.resize(bodies_[contact.on.body].surface->samples(), 0);
                muted[contact.sample] = 1;
            }
            // Of samples that are not, the nearest that a turn by kMostTurn may oppose to each other.
            double least = std::numeric_limits<double>::infinity();
            const ContactSurface &of = *bodies_[a].surface, &to = *bodies_[b].surface;
            bool can = a != b;
            for (int i = 0; i < of.patches().count(); ++i)
                for (int k = i + 1; !can && k < of.patches().count(); ++k) can = areApart(of, i, k);
            for (std::size_t i = 0; can && i < of.samples(); ++i) {
                const Vec3 p = of.surface().vertex(of.vertex(i)), n = of.surface().normal(of.vertex(i));
                for (std::size_t k = a == b ? i + 1 : 0; k < to.samples(); ++k) {
                    const double square = (to.surface().vertex(to.vertex(k)) - p).squaredNorm();
                    if (square < least * least && n.dot(to.surface().normal(to.vertex(k))) < kTurned) least = std::sqrt(square);
                }
            }
            clearance_[a * bodies_.size() + b] = clearance_[b * bodies_.size() + a] = least;
        }
    contacts_.clear();
}

bool FleshContact::areNear(std::size_t a, const Eigen::Matrix3Xd& A, std::size_t b, const Eigen::Matrix3Xd& B) const {
    const ContactSurface &of = *bodies_[a].surface, &to = *bodies_[b].surface;
    for (Eigen::Index p = 0; p < A.cols(); ++p)
        for (Eigen::Index q = a == b ? p + 1 : 0; q < B.cols(); ++q) {
            const double reach = kReach * (of.radius(static_cast<int>(p)) + to.radius(static_cast<int>(q)));
            if ((A.col(p) - B.col(q)).squaredNorm() < reach * reach) return true;
        }
    return false;
}

bool FleshContact::isNearGround(std::size_t body, const Eigen::Matrix3Xd& middles, const Plane& ground) const {
    for (Eigen::Index p = 0; p < middles.cols(); ++p)
        if (ground.height(middles.col(p)) < kReach * bodies_[body].surface->radius(static_cast<int>(p))) return true;
    return false;
}

const Vec3& FleshContact::vertexAt(std::size_t body, std::int32_t vertex, const Posed& posed) {
    Vertex& out = states_[body].vertices[static_cast<std::size_t>(vertex)];
    if (out.step != step_) {
        out.step = step_;
        out.at = posed.at(body, vertex);
    }
    return out.at;
}

const Vec3& FleshContact::normalAt(std::size_t body, std::int32_t vertex, const Posed& posed) {
    Vertex& out = states_[body].vertices[static_cast<std::size_t>(vertex)];
    if (out.stepOfNormal == step_) return out.normal;
    const ContactSurface& surface = *bodies_[body].surface;
    Vec3 sum = Vec3::Zero();
    for (const std::int32_t corner : surface.corners(vertex)) {
        const auto v = surface.surface().corners(corner / 3);
        const Vec3 a = vertexAt(body, v[0], posed);
        sum += (vertexAt(body, v[1], posed) - a).cross(vertexAt(body, v[2], posed) - a);
    }
    const double length = sum.norm();
    out.normal = length > 0.0 ? Vec3(sum / length) : Vec3(Vec3::Zero());
    out.stepOfNormal = step_;
    return out.normal;
}

/// Samples of a patch and the nearest ones of another.
void FleshContact::look(std::size_t body, std::size_t patch, std::size_t other, std::size_t otherPatch, const Posed& posed) {
    const ContactSurface &of = *bodies_[body].surface, &to = *bodies_[other].surface;
    State& s = states_[body];
    const auto& muted = s.muted[other];
    // Beyond it, no sample that is as near as samples are to each other presses.
    const double far = 2.0 * std::max(of.spacing(static_cast<int>(patch)), to.spacing(static_cast<int>(otherPatch))) + 0.5 * (of.radius(static_cast<int>(patch)) + to.radius(static_cast<int>(otherPatch)));
    const Vec3 middle = vertexAt(other, to.patches().centre[otherPatch], posed);
    const double within = far + kReach * to.radius(static_cast<int>(otherPatch));
    for (std::size_t i = of.firstOf(static_cast<int>(patch)); i < of.firstOf(static_cast<int>(patch) + 1); ++i) {
        if (!muted.empty() && muted[i]) continue;
        const Vec3 at = vertexAt(body, of.vertex(i), posed);
        if ((at - middle).squaredNorm() > within * within) continue;
        Candidate& known = s.candidates[i];
        const bool fresh = known.step != step_;
        Candidate best{step_, fresh ? far * far : known.square, known.body, known.vertex};
        bool found = false;
        for (std::size_t k = to.firstOf(static_cast<int>(otherPatch)); k < to.firstOf(static_cast<int>(otherPatch) + 1); ++k) {
            const double square = (vertexAt(other, to.vertex(k), posed) - at).squaredNorm();
            if (square >= best.square) continue;
            best = {step_, square, other, to.vertex(k)};
            found = true;
        }
        if (!found) continue;
        if (fresh) s.met.push_back(i);
        known = best;
    }
}

void FleshContact::findCandidates(std::size_t a, std::size_t b, const Posed& posed) {
    const ContactSurface &of = *bodies_[a].surface, &to = *bodies_[b].surface;
    const auto &p = of.patches(), &q = to.patches();
    for (int i = 0; i < p.count(); ++i) {
        const Vec3 at = vertexAt(a, p.centre[static_cast<std::size_t>(i)], posed);
        for (int k = a == b ? i + 1 : 0; k < q.count(); ++k) {
            const double reach = kReach * (of.radius(i) + to.radius(k));
            if ((vertexAt(b, q.centre[static_cast<std::size_t>(k)], posed) - at).squaredNorm() >= reach * reach) continue;
            if (a == b && !areApart(of, i, k)) continue;
            look(a, static_cast<std::size_t>(i), b, static_cast<std::size_t>(k), posed);
            look(b, static_cast<std::size_t>(k), a, static_cast<std::size_t>(i), posed);
        }
    }
}

/// The contact of a sample with the surface around its candidate. False: it does not touch it.
bool FleshContact::meet(std::size_t body, std::size_t sample, const Posed& posed, Contact& out) {
    const ContactSurface& of = *bodies_[body].surface;
    const Candidate& candidate = states_[body].candidates[sample];
    const std::size_t other = candidate.body;
    const ContactSurface& to = *bodies_[other].surface;
    const Vec3 at = vertexAt(body, of.vertex(sample), posed);
    std::int32_t nearest = candidate.vertex;
    double square = candidate.square;
    for (int i = 0; i < kMostSteps; ++i) {
        const std::int32_t from = nearest;
        for (const std::int32_t corner : to.corners(from))
            for (const std::int32_t v : to.surface().corners(corner / 3))
                if (const double d = (vertexAt(other, v, posed) - at).squaredNorm(); d < square) {
                    square = d;
                    nearest = v;
                }
        if (nearest == from) break;
    }
    double best = std::numeric_limits<double>::infinity();
    for (const std::int32_t corner : to.corners(nearest)) {
        const auto v = to.surface().corners(corner / 3);
        const Vec3 a = vertexAt(other, v[0], posed), b = vertexAt(other, v[1], posed), c = vertexAt(other, v[2], posed);
        const ClosestOnTriangle on = closestOnTriangle(b - a, c - a, at - a, at - b, at - c);
        const Vec3 parts = on.weights / on.weights.sum();
        if (const double d = (parts[0] * a + parts[1] * b + parts[2] * c - at).squaredNorm(); d < best) {
            best = d;
            out.at = {corner / 3, parts, 0.0};
        }
    }
    if (!std::isfinite(best)) return false;

    const auto v = to.surface().corners(out.at.triangle);
    Vec3 on = Vec3::Zero(), normal = Vec3::Zero();
    bool border = false;
    for (std::size_t c = 0; c < 3; ++c) {
        const double part = out.at.barycentric[static_cast<Eigen::Index>(c)];
        if (!(part > 0.0)) continue;
        on += part * vertexAt(other, v[c], posed);
        normal += part * normalAt(other, v[c], posed);
        border = border || to.onBorder(v[c]);
    }
    if (!(normal.norm() > 0.0)) return false;
    normal.normalize();
    const Vec3 way = at - on;
    const double gap = way.dot(normal);
    const double margin = kMargin * std::min(of.spacing(), to.spacing()), most = kDeepest * std::min(of.surface().size(), to.surface().size());
    if (gap > margin || gap < -most) return false;
    if (border && (way - gap * normal).norm() > kBeside * std::abs(gap)) return false;
    const Vec3 own = normalAt(body, of.vertex(sample), posed);
    if (own.dot(normal) > kOpposed) return false;
    out.sample = sample;
    out.at.distance = gap;
    out.on.body = body;
    out.under.body = other;
    // Both give way, about evenly: where they will meet, the surface looks the mean way. A force on the sample pushes it back into its body.
    out.normal = (own - normal).normalized();
    out.apart = way - (way.dot(out.normal) - gap / normal.dot(out.normal)) * out.normal;
    deepest_ = std::max(deepest_, -gap);
    return true;
}

void FleshContact::meetGround(std::size_t body, const Posed& posed, const Plane& ground) {
    const ContactSurface& of = *bodies_[body].surface;
    for (std::size_t i = 0; i < of.samples() && contacts_.size() < kMost; ++i) {
        const Vec3 at = vertexAt(body, of.vertex(i), posed);
        const double gap = ground.height(at);
        if (gap > kMargin * of.spacing()) continue;
        Contact& out = contacts_.emplace_back();
        out.sample = i;
        out.at.distance = gap;
        out.on.body = body;
        out.under.body = kGround;
        out.normal = -ground.normal();
        out.apart = at - ground.origin();
        states_[body].candidates[i] = {step_, -1.0, kGround, 0};  // it looks for nobody else
        deepest_ = std::max(deepest_, -gap);
    }
}

void FleshContact::findContacts(const Near& near, const Posed& posed, const Plane& ground) {
    ++step_;
    contacts_.clear();
    deepest_ = 0.0;
    for (State& s : states_) s.met.clear();
    for (const std::size_t body : near.grounded) meetGround(body, posed, ground);
    for (const auto& [a, b] : near.pairs) findCandidates(a, b, posed);
    for (std::size_t e = 0; e < bodies_.size(); ++e)
        for (const std::size_t sample : states_[e].met) {
            if (contacts_.size() == kMost) return;
            contacts_.emplace_back();
            if (!meet(e, sample, posed, contacts_.back())) contacts_.pop_back();
        }
}

/// Which patches take how much of a force at a point. False: too many are pressed already.
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
                if (s.active.size() == kMostPatches) return false;
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

/// How far active patches move a point by their forces, both in the world.
void FleshContact::findRows(Spread& out, const std::array<std::int32_t, 3>& corners, const Vec3& parts, const Eigen::Matrix3d& axes) {
    const State& s = states_[out.body];
    const TouchSurface& surface = bodies_[out.body].surface->surface();
    const double perShear = 1.0 / bodies_[out.body].shear;
    for (std::size_t k = 0; k < s.active.size(); ++k) {
        Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
        for (std::size_t c = 0; c < 3; ++c) {
            const double part = parts[static_cast<Eigen::Index>(c)];
            const std::int32_t row = surface.row(corners[c]);
            if (part > 0.0 && row >= 0) block += part * surface.touch().displacement.block<3, 3>(row, 3 * s.active[k]).cast<double>();
        }
        Eigen::Map<Eigen::Matrix3f>(rows_.data() + out.rows + 9 * k) = (perShear * (axes * block * axes.transpose())).cast<float>();
    }
}

Vec3 FleshContact::moved(const Spread& of) const {
    if (of.body == kGround) return Vec3::Zero();
    const State& s = states_[of.body];
    Vec3 out = Vec3::Zero();
    for (std::size_t k = 0; k < s.active.size(); ++k)
        out += Eigen::Map<const Eigen::Matrix3f>(rows_.data() + of.rows + 9 * k).cast<double>() * s.sums.col(static_cast<Eigen::Index>(k));
    return out;
}

void FleshContact::push(const Spread& of, const Vec3& force) {
    if (of.body == kGround) return;
    State& s = states_[of.body];
    for (std::size_t k = 0; k < of.count; ++k) s.sums.col(of.slot[k]) += of.weight[k] * force;
}

double FleshContact::softness(const Contact& c) const { return states_[c.on.body].softness + (c.under.body == kGround ? 0.0 : states_[c.under.body].softness); }

Eigen::Matrix3d FleshContact::axesUnder(const Contact& c, const Posed& posed) const { return c.under.body == kGround ? Eigen::Matrix3d::Identity() : posed.axes(c.under.body); }

void FleshContact::solve(const Posed& posed, const Settings& settings, int sweeps) {
    for (State& s : states_) {
        for (const std::int32_t patch : s.active) s.slot[static_cast<std::size_t>(patch)] = -1;
        s.active.clear();
    }
    const auto alone = [](std::int32_t v) { return std::array<std::int32_t, 3>{v, v, v}; };
    std::erase_if(contacts_, [&](Contact& c) {
        const ContactSurface& of = *bodies_[c.on.body].surface;
        if (!spread(c.on, alone(of.vertex(c.sample)), Vec3::UnitX())) return true;
        return c.under.body != kGround && !spread(c.under, bodies_[c.under.body].surface->surface().corners(c.at.triangle), c.at.barycentric);
    });
    for (State& s : states_) s.sums.leftCols(static_cast<Eigen::Index>(s.active.size())).setZero();
    std::size_t rows = 0;
    const auto takeRows = [&](Spread& of, const std::array<std::int32_t, 3>& corners, const Vec3& parts) {
        of.rows = rows;
        rows += 9 * states_[of.body].active.size();
        findRows(of, corners, parts, posed.axes(of.body));
    };
    for (Contact& c : contacts_) {
        const bool ground = c.under.body == kGround;
        const std::int32_t vertex = bodies_[c.on.body].surface->vertex(c.sample);
        takeRows(c.on, alone(vertex), Vec3::UnitX());
        if (!ground) takeRows(c.under, bodies_[c.under.body].surface->surface().corners(c.at.triangle), c.at.barycentric);
        // What a force on it and its counterforce do to where the two are.
        c.compliance = softness(c) * Eigen::Matrix3d::Identity();
        const auto add = [&](const Spread& at, const Spread& by, double sign) {
            if (at.body != by.body || at.body == kGround) return;
            for (std::size_t k = 0; k < by.count; ++k)
                c.compliance += sign * by.weight[k] * Eigen::Map<const Eigen::Matrix3f>(rows_.data() + at.rows + 9 * static_cast<std::size_t>(by.slot[k])).cast<double>();
        };
        add(c.on, c.on, 1.0);
        add(c.under, c.under, 1.0);
        add(c.on, c.under, -1.0);
        add(c.under, c.on, -1.0);

        const Memory& known = states_[c.on.body].memory[c.sample];
        c.force.setZero();
        c.goal = c.apart.dot(c.normal) * c.normal;
        if (known.step + 1 == step_ && known.other == c.under.body) {
            // It sticks to the flesh that it was on: to the side it is apart from there.
            Vec3 held = ground ? settings.ground.origin() : Vec3(Vec3::Zero());
            for (std::size_t k = 0; !ground && k < 3; ++k)
                if (const double part = known.held.barycentric[static_cast<Eigen::Index>(k)]; part > 0.0) held += part * vertexAt(c.under.body, bodies_[c.under.body].surface->surface().corners(known.held.triangle)[k], posed);
            const Vec3 apart = vertexAt(c.on.body, vertex, posed) - held - axesUnder(c, posed) * known.slipped;
            c.goal += apart - apart.dot(c.normal) * c.normal;
            c.force = axesUnder(c, posed) * known.force;
        }
        c.goal = -c.goal;
    }
    for (const Contact& c : contacts_) {
        push(c.on, c.force);
        push(c.under, -c.force);
    }
    bool moves = true;
    for (int i = 0; i < sweeps && moves; ++i) {
        moves = false;
        for (Contact& c : contacts_) {
            const Vec3 before = c.force;
            const Vec3 gap = c.goal - (moved(c.on) - moved(c.under)) - softness(c) * before + c.compliance * before;
            ContactSolver::solveAlone(c.compliance, gap, c.under.body == kGround ? settings.groundFriction : settings.friction, c);
            push(c.on, c.force - before);
            push(c.under, before - c.force);
            moves = moves || (c.compliance * (c.force - before)).norm() > kSettled * bodies_[c.on.body].surface->surface().size();
        }
    }
}

void FleshContact::sumForces(const Posed& posed, const Settings& settings) {
    settled_ = true;
    for (State& s : states_) {
        s.before.swap(s.forces);
        s.forces.setZero();
        s.pressed.clear();
        s.force.setZero();
    }
    for (const Contact& c : contacts_) {
        Memory& known = states_[c.on.body].memory[c.sample];
        const bool goesOn = known.step + 1 == step_ && known.other == c.under.body;
        if (c.how == ContactPoint::How::None) continue;
        if (!goesOn || c.how == ContactPoint::How::Slip) {
            // It sticks from here on: where it met the surface, or as far as it has slipped.
            Vec3 apart = c.apart;
            if (c.how == ContactPoint::How::Slip) apart += moved(c.on) - moved(c.under);
            known.held = c.at;
            known.slipped = axesUnder(c, posed).transpose() * (apart - apart.dot(c.normal) * c.normal);
        }
        known.step = step_;
        known.other = c.under.body;
        known.force = axesUnder(c, posed).transpose() * c.force;
        states_[c.on.body].force += c.force;
        if (c.under.body != kGround) states_[c.under.body].force -= c.force;
    }
    for (std::size_t e = 0; e < bodies_.size(); ++e) {
        State& s = states_[e];
        const TouchSurface& surface = bodies_[e].surface->surface();
        for (std::size_t k = 0; k < s.active.size(); ++k) {
            const Vec3 force = posed.axes(e).transpose() * s.sums.col(static_cast<Eigen::Index>(k)) / bodies_[e].shear;
            if (force.isZero(0.0)) continue;
            s.pressed.push_back(s.active[k]);
            s.forces.segment<3>(3 * s.active[k]) = force;
        }
        std::sort(s.pressed.begin(), s.pressed.end());
        const auto& gradients = surface.touch().gradients;
        double most = 0.0;
        for (Eigen::Index i = 0; !s.pressed.empty() && i < gradients.rows(); i += 9) {
            Eigen::Matrix<double, 9, 1> sum = Eigen::Matrix<double, 9, 1>::Zero();
            for (const std::int32_t p : s.pressed) sum += gradients.block<9, 3>(i, 3 * p).cast<double>() * s.forces.segment<3>(3 * p);
            most = std::max(most, sum.squaredNorm());
        }
        most = std::sqrt(most);
        if (most > settings.mostStrain) s.forces *= settings.mostStrain / most;
        double moves = 0.0;
        for (Eigen::Index i = 0; i < s.forces.size(); ++i) moves += surface.largestDisplacement()[i / 3] * std::abs(s.forces[i] - s.before[i]);
        settled_ = settled_ && moves <= kSettled * surface.size();
    }
}

void FleshContact::once(const Posed& posed, const Near& near, const Settings& settings, int sweeps) {
    findContacts(near, posed, settings.ground);
    solve(posed, settings, sweeps);
    sumForces(posed, settings);
}

void FleshContact::step(const Posed& posed, const Near& near, const Settings& settings, bool settle) {
    if (near.none()) {
        if (!idle()) reset();
        return;
    }
    once(posed, near, settings, settle ? kSweepsToSettle : kSweeps);
    for (int i = 1; settle && !settled_ && i < kRoundsToSettle; ++i) once(posed, near, settings, kSweepsToSettle);
}

void FleshContact::reset() {
    for (State& s : states_) {
        s.forces.setZero();
        s.pressed.clear();
        s.force.setZero();
        for (Memory& m : s.memory) m.step = 0;
    }
    contacts_.clear();
    settled_ = true;
}

bool FleshContact::idle() const {
    return std::all_of(states_.begin(), states_.end(), [](const State& s) { return s.pressed.empty(); });
}

std::size_t FleshContact::bytes() const {
    std::size_t sum = 0;
    for (const auto& body : bodies_) sum += body.surface->bytes();
    return sum;
}

}  // namespace imomushi
