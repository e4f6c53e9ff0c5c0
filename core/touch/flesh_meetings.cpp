// SPDX-License-Identifier: GPL-3.0-or-later
// Where flesh meets: patches whose boxes meet, by trees; their samples against triangles.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/mesh/closest_point.h"
#include "core/touch/flesh_contact.h"

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
constexpr int kMostSteps = 24;  // along a surface to the nearest vertex

}  // namespace

Bounds FleshContact::boxOf(std::size_t body, std::size_t patch, const Vec3& middle) const {
    const Vec3 reach = Vec3::Constant(kReach * bodies_[body].surface->radius(static_cast<int>(patch)));
    return {middle - reach, middle + reach};
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
    for (std::size_t p = 0; p < s.boxes.size(); ++p) s.boxes[p] = boxOf(body, p, middles.col(static_cast<Eigen::Index>(p)));
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
void FleshContact::broadphase(std::size_t body, std::size_t patch, std::size_t other, std::size_t otherPatch, const Posed& posed) {
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
        for (std::size_t p = 0; p < s.boxes.size(); ++p) s.boxes[p] = boxOf(body, p, vertexAt(body, surface.patches().centre[p], posed));
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
        broadphase(a, static_cast<std::size_t>(i), b, static_cast<std::size_t>(k), posed);
        broadphase(b, static_cast<std::size_t>(k), a, static_cast<std::size_t>(i), posed);
    };
    if (a == b)
        states_[a].tree.near(within, meet);
    else
        states_[a].tree.near(states_[b].tree, within, meet);
}

/// Where a sample meets the surface around its candidate. False: it does not.
bool FleshContact::narrowphase(std::size_t body, std::size_t sample, const Posed& posed, Meeting& out) {
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
            if (!narrowphase(body, sample, posed, meetings_.back())) meetings_.pop_back();
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

}  // namespace imomushi
