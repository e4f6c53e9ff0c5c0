// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/proposal/limb_tree.h"
#include "core/proposal/mirror_plane.h"

namespace imomushi {
namespace {

/// Limbs are a pair where their mirrored tips and middles are together nearer than this, in diagonals; a limb whose tip is this near to the plane lies in it.
constexpr double kPair = 0.2, kInPlane = 0.035;
/// Points of a line that is mean of itself and its image.
constexpr int kPoints = 64;

Limb mirrored(const Limb& limb, const CutPlane& plane);

Hub mirrored(const Hub& hub, const CutPlane& plane) {
    Hub made = hub;
    for (Vec3& p : made.points) p = mirroredPoint(plane, p);
    for (Limb& limb : made.limbs) limb = mirrored(limb, plane);
    return made;
}

Limb mirrored(const Limb& limb, const CutPlane& plane) {
    Limb made = limb;
    for (Vec3& p : made.line) p = mirroredPoint(plane, p);
    for (Hub& hub : made.end) hub = mirrored(hub, plane);
    made.side = -limb.side;
    return made;
}

double away(const CutPlane& plane, const Vec3& p) { return plane.normal.dot(p - plane.origin); }

void layInto(Hub& hub, const CutPlane& plane);

void layInto(Limb& limb, const CutPlane& plane) {
    for (Vec3& p : limb.line) p = ontoPlane(plane, p);
    limb.side = 0;
    for (Hub& hub : limb.end) layInto(hub, plane);
}

/// A hub across the plane.
void layInto(Hub& hub, const CutPlane& plane) {
    for (Vec3& p : hub.points) p = ontoPlane(plane, p);
    if (hub.points.size() > 1 && (hub.points[1] - hub.points[0]).norm() < 0.5 * std::max(hub.radius[0], hub.radius[1])) {
        hub.points.pop_back();
        hub.radius.pop_back();
        for (Limb& limb : hub.limbs) limb.point = 0;
    }
    auto& limbs = hub.limbs;
    struct Pair {
        double cost;
        std::size_t a, b;
    };
    std::vector<Pair> pairs;
    const auto middle = [](const Limb& limb) { return pointAlong(limb.line, 0.6 * limb.length()); };
    for (std::size_t a = 0; a < limbs.size(); ++a)
        for (std::size_t b = a + 1; b < limbs.size(); ++b) {
            if (away(plane, limbs[a].tip()) * away(plane, limbs[b].tip()) >= 0.0) continue;
            const double cost = (mirroredPoint(plane, limbs[a].tip()) - limbs[b].tip()).norm() + (mirroredPoint(plane, middle(limbs[a])) - middle(limbs[b])).norm();
            // What lies in the plane is no pair with what lies near it by chance.
            if (cost < kPair && cost < std::abs(away(plane, limbs[a].tip())) + std::abs(away(plane, limbs[b].tip()))) pairs.push_back({cost, a, b});
        }
    std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& x, const Pair& y) { return x.cost < y.cost; });
    std::vector<Limb> made;
    std::vector<char> done(limbs.size(), 0);
    const auto addPair = [&](Limb limb) {
        limb.side = away(plane, limb.tip()) > 0.0 ? 1 : -1;
        limb.line.front() = hub.points[static_cast<std::size_t>(limb.point)];
        Limb other = mirrored(limb, plane);
        if (limb.side < 0) std::swap(limb, other);
        limb.twin = static_cast<int>(made.size()) + 1;
        other.twin = static_cast<int>(made.size());
        made.push_back(std::move(limb));
        made.push_back(std::move(other));
    };
    for (const Pair& pair : pairs) {
        if (done[pair.a] || done[pair.b]) continue;
        done[pair.a] = done[pair.b] = 1;
        // The one with more to it, else the one in front.
        const auto worth = [](const Limb& limb) { return limb.end.empty() ? std::size_t(0) : limb.end[0].limbs.size(); };
        const bool first = worth(limbs[pair.a]) != worth(limbs[pair.b]) ? worth(limbs[pair.a]) > worth(limbs[pair.b]) : away(plane, limbs[pair.a].tip()) > 0.0;
        addPair(std::move(limbs[first ? pair.a : pair.b]));
    }
    for (std::size_t i = 0; i < limbs.size(); ++i) {
        if (done[i]) continue;
        Limb& limb = limbs[i];
        if (std::abs(away(plane, limb.tip())) <= kInPlane || (!limb.end.empty() && std::abs(away(plane, limb.end[0].points[0])) <= kInPlane)) {
            limb.line.front() = hub.points[static_cast<std::size_t>(limb.point)];
            layInto(limb, plane);
            made.push_back(std::move(limb));
        } else if (limb.end.empty() && std::abs(away(plane, middle(limb))) <= kInPlane) {
            // It lies in the plane, up to one of two ends beside it.
            while (limb.line.size() > 2 && std::abs(away(plane, limb.tip())) > kInPlane) limb.line.pop_back(), limb.radius.pop_back();
            limb.line.front() = hub.points[static_cast<std::size_t>(limb.point)];
            layInto(limb, plane);
            made.push_back(std::move(limb));
        } else {
            addPair(std::move(limb));  // the skeleton missed its twin
        }
    }
    limbs = std::move(made);
}

/// A chain that lies across the plane: each half is the image of the other.
bool balance(LimbTree& tree, const CutPlane& plane) {
    Limb &a = tree.root.limbs[0], &b = tree.root.limbs[1];
    if (away(plane, a.tip()) * away(plane, b.tip()) >= 0.0 || (mirroredPoint(plane, a.tip()) - b.tip()).norm() > kPair) return false;
    if (std::abs(away(plane, a.tip())) <= kInPlane) return false;
    tree.root.points[0] = ontoPlane(plane, tree.root.points[0]);
    Limb mean = a;
    mean.line.clear();
    mean.radius.clear();
    const double la = a.length(), lb = b.length();
    for (int i = 0; i <= kPoints; ++i) {
        const double t = static_cast<double>(i) / kPoints;
        mean.line.push_back(0.5 * (pointAlong(a.line, t * la) + mirroredPoint(plane, pointAlong(b.line, t * lb))));
        mean.radius.push_back(a.radius[std::min(a.radius.size() - 1, static_cast<std::size_t>(t * static_cast<double>(a.radius.size())))]);
    }
    mean.line.front() = tree.root.points[0];
    mean.side = away(plane, mean.tip()) > 0.0 ? 1 : -1;
    a = mean;
    b = mirrored(mean, plane);
    a.twin = 1;
    b.twin = 0;
    return true;
}

}  // namespace

void symmetrise(LimbTree& tree, const CutPlane& plane) {
    if (tree.blob) {
        for (Vec3& p : tree.root.points) p = ontoPlane(plane, p);
        return;
    }
    if (tree.chain) {
        if (balance(tree, plane)) return;
        for (Vec3& p : tree.root.points) p = ontoPlane(plane, p);
        for (Limb& limb : tree.root.limbs) layInto(limb, plane);
        return;
    }
    layInto(tree.root, plane);
}

}  // namespace imomushi
