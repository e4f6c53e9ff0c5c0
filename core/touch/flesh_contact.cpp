// SPDX-License-Identifier: GPL-3.0-or-later
// Patches whose boxes meet, by trees; their samples against triangles; and for each island that is awake a projected Gauss-Seidel method over its contacts (each
// alone is solved exactly), with the forces on patches as its unknowns: what one contact does, the others feel through them.
#include "core/touch/flesh_contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/mesh/closest_point.h"

namespace imomushi {
namespace {

/// A patch is stretched and bent by its pose: its vertices are within this many radii of its middle.
constexpr double kReach = 1.3;
/// Beyond the border of a surface (a joint), a sample is not on it where it is this many times as far to the side as it is deep.
constexpr double kBeside = 0.5;
/// Samples this near to a surface, in spacings of samples, are contacts that may come to press.
constexpr double kMargin = 0.5;
/// Samples no farther than this part of the smaller body from another surface touch it at rest.
constexpr double kTouching = 1e-3;
/// Deeper than this part of the smaller body a sample has passed through, and which way is out is not known.
constexpr double kDeepest = 0.3;
/// A contact gives way by this part of the mean compliance of the patches around it: many contacts on few patches have an answer.
constexpr double kSoftness = 0.005;
constexpr int kSweeps = 16, kSweepsToSettle = 60, kRoundsToSettle = 12;
/// In so many sweeps the first looks at all contacts, the others at those that press.
constexpr int kAllOf = 4;
/// Forces have settled when what they change moves nothing by more than this part of the body.
constexpr double kSettled = 1e-5;
constexpr int kMostSteps = 24;  // along a surface to the nearest vertex

Bounds boxAround(const Vec3& middle, double reach) { return {middle - Vec3::Constant(reach), middle + Vec3::Constant(reach)}; }

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
        for (int i = 0; i < touch.patches.count(); ++i)
            s.boxes.push_back(
                boxAround(surface.surface().vertex(touch.patches.centre[static_cast<std::size_t>(i)]), kReach * surface.radius(i)));
        s.tree = BoxTree(s.boxes);
        s.softness = kSoftness * touch.compliance.trace() / static_cast<double>(3 * std::max<Eigen::Index>(patches, 1)) / bodies_[e].shear;
        samples += surface.samples();
        patchesOfOne = std::max(patchesOfOne, n);
    }
    island_.resize(count);
    std::iota(island_.begin(), island_.end(), std::size_t{0});
    lastIsland_ = island_;
    stirred_.resize(count);
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

/// Who touches whom at rest, and how far others are.
void FleshContact::findTouchingAtRest() {
    class Rest : public Posed {
    public:
        explicit Rest(const std::vector<Body>& of) : of_(of) {}
        [[nodiscard]] Vec3 at(std::size_t body, std::int32_t vertex) const override { return of_[body].surface->surface().vertex(vertex); }
        [[nodiscard]] const Eigen::Matrix3d& axes(std::size_t) const override { return axes_; }

    private:
        const std::vector<Body>& of_;
        Eigen::Matrix3d axes_ = Eigen::Matrix3d::Identity();
    } rest(bodies_);
    const std::size_t count = bodies_.size();
    clearance_.assign(count * count, std::numeric_limits<double>::infinity());
    for (std::size_t a = 0; a < count; ++a)
        for (std::size_t b = a; b < count; ++b) {
            const ContactSurface &of = *bodies_[a].surface, &to = *bodies_[b].surface;
            clearance_[a * count + b] = clearance_[b * count + a] = a == b ? of.ownClearance() : ContactSurface::clearance(of, to);
            if (a != b && !areNear(a, b)) continue;
            members_ = {a};
            if (a != b) members_.push_back(b);
            near_.pairs = {{a, b}};
            for (const std::size_t body : members_) island_[body] = a;
            beginStep(rest);
            findMeetings(rest);
            for (const std::size_t body : members_) island_[body] = body;
            for (const Meeting& m : meetings_) {
                if (m.gap > kTouching * std::min(of.surface().size(), to.surface().size())) continue;
                auto& muted = states_[m.body].muted[m.other];
                muted.resize(bodies_[m.body].surface->samples(), 0);
                muted[m.sample] = 1;
            }
        }
    near_.pairs.clear();
    members_.clear();
    meetings_.clear();
    for (State& s : states_) s.step = s.lastStep = 0;
}

void FleshContact::place(std::size_t body, const Eigen::Matrix3Xd& middles) {
    State& s = states_[body];
    for (Eigen::Index p = 0; p < middles.cols(); ++p)
        s.boxes[static_cast<std::size_t>(p)] = boxAround(middles.col(p), kReach * bodies_[body].surface->radius(static_cast<int>(p)));
    s.tree.follow(s.boxes);
}

bool FleshContact::areNear(std::size_t a, std::size_t b) const {
    const State &A = states_[a], &B = states_[b];
    double within = 0.0;
    const auto look = [&](std::int32_t i, std::int32_t k) {
        const Bounds &p = A.boxes[static_cast<std::size_t>(i)], &q = B.boxes[static_cast<std::size_t>(k)];
        const double reach = 0.5 * (p.size().x() + q.size().x());
        if ((p.low + p.high - q.low - q.high).squaredNorm() < 4.0 * reach * reach) within = -1.0;
    };
    if (a == b)
        A.tree.near(within, look);
    else
        A.tree.near(B.tree, within, look);
    return within < 0.0;
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

void FleshContact::placeSamples(std::size_t body, std::size_t patch, const Posed& posed) {
    State& s = states_[body];
    if (s.placed[patch] == step_) return;
    s.placed[patch] = step_;
    const ContactSurface& of = *bodies_[body].surface;
    for (std::size_t i = of.firstOf(static_cast<int>(patch)); i < of.firstOf(static_cast<int>(patch) + 1); ++i)
        s.sampleAt.col(static_cast<Eigen::Index>(i)) = vertexAt(body, of.vertex(i), posed);
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
    placeSamples(body, patch, posed);
    placeSamples(other, otherPatch, posed);
    const Eigen::Matrix3Xd &here = s.sampleAt, &there = states_[other].sampleAt;
    for (std::size_t i = of.firstOf(static_cast<int>(patch)); i < of.firstOf(static_cast<int>(patch) + 1); ++i) {
        if (!muted.empty() && muted[i]) continue;
        const Vec3 at = here.col(static_cast<Eigen::Index>(i));
        if ((at - middle).squaredNorm() > within * within) continue;
        Candidate& known = s.candidates[i];
        const bool fresh = known.step != step_;
        Candidate best{step_, fresh ? far * far : known.square, known.body, known.vertex};
        bool found = false;
        for (std::size_t k = to.firstOf(static_cast<int>(otherPatch)); k < to.firstOf(static_cast<int>(otherPatch) + 1); ++k) {
            const double square = (there.col(static_cast<Eigen::Index>(k)) - at).squaredNorm();
            if (square >= best.square) continue;
            best = {step_, square, other, to.vertex(k)};
            found = true;
        }
        if (!found) continue;
        if (fresh) s.near.push_back(i);
        known = best;
    }
}

/// Places the members.
void FleshContact::beginStep(const Posed& posed) {
    ++step_;
    for (const std::size_t body : members_) {
        State& s = states_[body];
        s.lastStep = s.step;
        s.step = step_;
        s.near.clear();
        s.bounded = false;
        s.axes = posed.axes(body);
        const ContactSurface& surface = *bodies_[body].surface;
        for (std::size_t p = 0; p < s.boxes.size(); ++p)
            s.boxes[p] = boxAround(vertexAt(body, surface.patches().centre[p], posed), kReach * surface.radius(static_cast<int>(p)));
        s.tree.follow(s.boxes);
    }
}

void FleshContact::findCandidates(std::size_t a, std::size_t b, const Posed& posed) {
    const ContactSurface &of = *bodies_[a].surface, &to = *bodies_[b].surface;
    const auto &p = of.patches(), &q = to.patches();
    const double within = 0.0;
    const auto meet = [&](std::int32_t i, std::int32_t k) {
        const double reach = kReach * (of.radius(i) + to.radius(k));
        const Vec3 at = vertexAt(a, p.centre[static_cast<std::size_t>(i)], posed);
        if ((vertexAt(b, q.centre[static_cast<std::size_t>(k)], posed) - at).squaredNorm() >= reach * reach) return;
        if (a == b && !of.areApart(i, k)) return;
        look(a, static_cast<std::size_t>(i), b, static_cast<std::size_t>(k), posed);
        look(b, static_cast<std::size_t>(k), a, static_cast<std::size_t>(i), posed);
    };
    if (a == b)
        states_[a].tree.near(within, meet);
    else
        states_[a].tree.near(states_[b].tree, within, meet);
}

/// Where a sample meets the surface around its candidate. False: it does not.
bool FleshContact::meet(std::size_t body, std::size_t sample, const Posed& posed, Meeting& out) {
    const ContactSurface& of = *bodies_[body].surface;
    const Candidate& candidate = states_[body].candidates[sample];
    const std::size_t other = candidate.body;
    const Vec3 at = vertexAt(body, of.vertex(sample), posed);
    out.body = body;
    out.sample = sample;
    out.other = other;
    if (other == kGround) {
        out.gap = settings_.ground.height(at);
        out.normal = -settings_.ground.normal();
        out.apart = at - settings_.ground.origin();
        return true;
    }
    const ContactSurface& to = *bodies_[other].surface;
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
    if (own.dot(normal) > ContactSurface::kOpposed) return false;
    out.gap = gap;
    // Both give way, about evenly: where they will meet, the surface looks the mean way. A force on the sample pushes it back into its body.
    out.normal = (own - normal).normalized();
    out.apart = way - (way.dot(out.normal) - gap / normal.dot(out.normal)) * out.normal;
    return true;
}

void FleshContact::findGround(std::size_t body, const Posed& posed) {
    const ContactSurface& of = *bodies_[body].surface;
    const double margin = kMargin * of.spacing();
    State& s = states_[body];
    for (int p = 0; p < of.patches().count(); ++p) {
        if (settings_.ground.height(vertexAt(body, of.patches().centre[static_cast<std::size_t>(p)], posed)) >
            kReach * of.radius(p) + margin)
            continue;
        for (std::size_t i = of.firstOf(p); i < of.firstOf(p + 1); ++i) {
            if (settings_.ground.height(vertexAt(body, of.vertex(i), posed)) > margin) continue;
            s.candidates[i] = {step_, -1.0, kGround, 0};  // it looks for nobody else
            s.near.push_back(i);
        }
    }
}

void FleshContact::findMeetings(const Posed& posed) {
    meetings_.clear();
    const std::size_t island = members_.front();
    for (const std::size_t body : near_.grounded)
        if (island_[body] == island) findGround(body, posed);
    for (const auto& [a, b] : near_.pairs)
        if (island_[a] == island) findCandidates(a, b, posed);
    for (const std::size_t body : members_) {
        // In an order that no tree has a say in.
        auto& near = states_[body].near;
        std::sort(near.begin(), near.end());
        for (const std::size_t sample : near) {
            meetings_.emplace_back();
            if (!meet(body, sample, posed, meetings_.back())) meetings_.pop_back();
        }
    }
}

/// The same number of each body, at most, the deepest: those that are solved in one step.
void FleshContact::keepDeepest() {
    const std::size_t most = std::max(kMost, kMostPerBody * members_.size());
    if (meetings_.size() <= most) return;
    const auto endOf = [&](std::size_t begin) {
        std::size_t end = begin;
        while (end < meetings_.size() && meetings_[end].body == meetings_[begin].body) ++end;
        return end;
    };
    const auto kept = [&](std::size_t each) {
        std::size_t sum = 0;
        for (std::size_t begin = 0, end = 0; begin < meetings_.size(); begin = end) sum += std::min((end = endOf(begin)) - begin, each);
        return sum;
    };
    std::size_t each = most / members_.size(), tooMany = most + 1;
    while (tooMany - each > 1) {
        const std::size_t middle = each + (tooMany - each) / 2;
        (kept(middle) <= most ? each : tooMany) = middle;
    }
    const auto at = [&](std::size_t i) { return meetings_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::size_t to = 0;
    for (std::size_t begin = 0, end = 0; begin < meetings_.size(); begin = end) {
        end = endOf(begin);
        const std::size_t last = std::min(end, begin + each);
        if (last < end) {
            std::nth_element(at(begin), at(last), at(end),
                             [](const Meeting& a, const Meeting& b) { return a.gap < b.gap || (a.gap == b.gap && a.sample < b.sample); });
            std::sort(at(begin), at(last), [](const Meeting& a, const Meeting& b) { return a.sample < b.sample; });
            State& s = states_[meetings_[begin].body];
            s.bounded = std::any_of(at(last), at(end), [](const Meeting& m) { return m.gap < 0.0; });
        }
        for (std::size_t i = begin; i < last; ++i) meetings_[to++] = meetings_[i];
    }
    meetings_.resize(to);
}

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

void FleshContact::push(const Spread& of, const Vec3& force) {
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
        push(c.on, c.force);
        push(c.under, -c.force);
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
            push(c.on, c.force - before);
            push(c.under, before - c.force);
            moves = moves || (c.compliance * (c.force - before)).norm() > kSettled * bodies_[c.on.body].surface->surface().size();
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
    bool settled = true;
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
        s.settled = moves <= kSettled * surface.size();
        settled = settled && s.settled;
    }
    return settled;
}

/// The island of this body. True: it has settled.
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
    std::fill(stirred_.begin(), stirred_.end(), 0);
    for (std::size_t body = 0; body < bodies_.size(); ++body)
        if (all || moved[body] || !states_[body].settled) stirred_[lastIsland_[body]] = 1;
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
        if (stirred_[lastIsland_[body]]) woken_[island_[body]] = 1;
    }
    for (std::size_t body = 0; body < bodies_.size(); ++body) states_[body].asleep = states_[body].met && !woken_[island_[body]];
}

void FleshContact::finish(const Posed& posed, bool settle) {
    settled_ = true;
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
        if (!states_[body].met) release(body);
        if (!awake(body) || island_[body] != body) continue;
        bool settled = once(posed, body, settle ? kSweepsToSettle : kSweeps);
        for (int i = 1; settle && !settled && i < kRoundsToSettle; ++i) settled = once(posed, body, kSweepsToSettle);
        settled_ = settled_ && settled;
    }
}

void FleshContact::release(std::size_t body) {
    State& s = states_[body];
    s.settled = true;
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
        states_[body].settled = false;
    }
    settled_ = true;
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
