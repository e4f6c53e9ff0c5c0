// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/proposal/limb_tree.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/base/try.h"
#include "core/base/union_find.h"
#include "core/body/cgal/flow_skeleton.h"
#include "core/body/cgal/rays.h"
#include "core/mesh/topology.h"
#include "core/mesh/triangle_tree.h"
#include "core/worker/worker.h"

namespace imomushi {
namespace {

/// Two places where limbs meet are one hub where their balls nearly touch, or where the line between them, outside the balls, is nowhere thinner than this part of the
/// smaller ball and not longer than so many of its thicknesses: more of them where both hubs have long limbs (chest and hips), fewer where one has short ones only (a head
/// with ears), in parts of the longest limb.
constexpr double kTouching = 0.15, kHubNeck = 0.7, kTrunkLength = 2.2, kHubLength = 0.4, kLongLimb = 0.35;
/// Balls of a hub are one point where they are nearer to each other than this part of their radius.
constexpr double kOnePoint = 1.2;
/// Edges of skeletons. The fine one is made where flesh lies farther than this from all balls along the coarse one, all in diagonals: a limb may have shrunk into its neighbours.
constexpr double kCoarse = 4e-3, kFine = 2e-3, kUnexplained = 0.08;
/// A line without branches is a chain of pieces from so many thicknesses on.
constexpr double kChain = 2.5;

struct Node {
    Vec3 at;
    double radius = 0.0, area = 0.0, flesh = 0.0;
    std::vector<int> next;  // ascending
};

/// A way along nodes of degree two.
struct Branch {
    std::vector<int> nodes;  // from one end to the other, both included
    double length = 0.0;
};

class Builder {
public:
    Builder(const TriangleMesh& mesh, const Vec3& up, double least)
        : surface_(mesh), rays_(mesh), area_(surfaceArea(mesh)), vertices_(mesh.vertices.rows()), up_(up), least_(least) {}

    LimbTree build(const FlowSkeleton& skeleton) {
        load(skeleton);
        prune();
        if (tipsAndForks().second.empty()) return withoutFork();
        makeHubs();
        return std::move(tree_);
    }

private:
    [[nodiscard]] Node& node(int i) { return nodes_[static_cast<std::size_t>(i)]; }
    [[nodiscard]] std::size_t degree(int i) { return node(i).next.size(); }

    void load(const FlowSkeleton& skeleton) {
        nodes_.resize(skeleton.points.size());
        double whole = 0.0;
        const double perVertex = area_ / static_cast<double>(std::max<Eigen::Index>(1, vertices_));
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            nodes_[i].at = skeleton.points[i];
            nodes_[i].radius = std::sqrt(surface_.nearest(nodes_[i].at).squaredDistance);
            nodes_[i].area = perVertex * static_cast<double>(skeleton.vertices[i].size());
            nodes_[i].flesh = nodes_[i].area * nodes_[i].radius;  // a tube: twice its volume
            whole += nodes_[i].flesh;
        }
        for (Node& n : nodes_) n.flesh /= std::max(whole, 1e-300);
        // A spanning tree that keeps thick lines together: edges in the order of their radius.
        std::vector<std::size_t> order(skeleton.edges.size());
        std::iota(order.begin(), order.end(), 0);
        const auto thickness = [&](std::size_t e) { return std::min(node(skeleton.edges[e][0]).radius, node(skeleton.edges[e][1]).radius); };
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return thickness(a) > thickness(b); });
        UnionFind sets(nodes_.size());
        for (const std::size_t e : order) {
            const auto [a, b] = skeleton.edges[e];
            if (sets.find(a) == sets.find(b)) {
                ++tree_.rings;
                continue;
            }
            sets.unite(a, b);
            node(a).next.push_back(b);
            node(b).next.push_back(a);
        }
        for (Node& n : nodes_) std::sort(n.next.begin(), n.next.end());
    }

    std::pair<std::vector<int>, std::vector<int>> tipsAndForks() {
        std::pair<std::vector<int>, std::vector<int>> out;
        for (int i = 0; i < static_cast<int>(nodes_.size()); ++i) {
            if (degree(i) == 1) out.first.push_back(i);
            if (degree(i) > 2) out.second.push_back(i);
        }
        return out;
    }

    /// From `from` by way of `next` to the next node that is not of degree two.
    Branch follow(int from, int next) {
        Branch branch;
        branch.nodes = {from, next};
        branch.length = (node(from).at - node(next).at).norm();
        while (degree(branch.nodes.back()) == 2) {
            const int last = branch.nodes.back(), before = branch.nodes[branch.nodes.size() - 2];
            const int on = node(last).next[0] == before ? node(last).next[1] : node(last).next[0];
            branch.length += (node(last).at - node(on).at).norm();
            branch.nodes.push_back(on);
        }
        return branch;
    }

    /// Where the surface ends beyond the last point of a line.
    Vec3 tipBeyond(const std::vector<Vec3>& line, double radius) {
        Vec3 back = line.front();
        for (std::size_t i = line.size(); i-- > 0;)
            if ((line.back() - line[i]).norm() > std::max(2.0 * radius, 0.02)) {
                back = line[i];
                break;
            }
        const Vec3 way = line.back() - back;
        if (!(way.norm() > 1e-9)) return line.back();
        const auto hit = rays_.first(line.back(), way.normalized(), 0.5, -1);
        return hit.triangle < 0 ? line.back() : Vec3(line.back() + std::min(hit.distance, 0.2) * way.normalized());
    }

    /// Takes branches out that are no limbs, the least slender first.
    void prune() {
        while (true) {
            const auto [tips, forks] = tipsAndForks();
            if (forks.empty()) return;
            double worst = HUGE_VAL;
            Branch out;
            double share = 0.0;
            bool thin = false;
            for (const int tip : tips) {
                const Branch branch = follow(tip, node(tip).next[0]);
                const int fork = branch.nodes.back();
                std::vector<Vec3> line;
                for (std::size_t i = branch.nodes.size(); i-- > 0;) line.push_back(node(branch.nodes[i]).at);
                const double outside = branch.length + (tipBeyond(line, node(tip).radius) - node(tip).at).norm() - node(fork).radius;
                std::vector<double> radii;
                double flesh = 0.0, area = 0.0;
                for (const int i : branch.nodes)
                    if (i != fork && (node(i).at - node(fork).at).norm() > node(fork).radius) radii.push_back(node(i).radius), flesh += node(i).flesh, area += node(i).area;
                if (radii.empty()) radii.push_back(node(tip).radius);
                std::nth_element(radii.begin(), radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2), radii.end());
                // That of a tube of its area, as balls are small in the corners of a box.
                const double thickness = std::max(2.0 * radii[radii.size() / 2], area / (std::numbers::pi * std::max(outside, 1e-9)));
                const double slenderness = outside / std::max(thickness, 1e-9);
                if (outside >= kLeastReach && slenderness >= kLeastSlenderness && flesh >= least_) continue;
                if (slenderness < worst) worst = slenderness, out = branch, share = flesh, thin = outside >= kLeastReach && slenderness >= kLeastSlenderness;
            }
            if (out.nodes.empty()) return;
            if (share > 0.0)
                tree_.leftOut.push_back({node(out.nodes.front()).at, share, thin ? "It has less flesh than the least share." : "It hardly stands out of the flesh that it grows from."});
            // Its flesh goes to the fork.
            const int fork = out.nodes.back();
            for (const int i : out.nodes)
                if (i != fork) {
                    node(fork).flesh += node(i).flesh;
                    node(i).flesh = 0.0;
                    node(i).next.clear();
                }
            std::erase(node(fork).next, out.nodes[out.nodes.size() - 2]);
        }
    }

    /// A single line: a chain, or a blob.
    LimbTree withoutFork() {
        const auto tips = tipsAndForks().first;
        Hub& root = tree_.root;
        if (tips.size() != 2) {
            std::size_t thickest = 0;
            for (std::size_t i = 1; i < nodes_.size(); ++i)
                if (nodes_[i].radius > nodes_[thickest].radius) thickest = i;
            root.points = {nodes_[thickest].at};
            root.radius = {nodes_[thickest].radius};
            tree_.blob = true;
            return std::move(tree_);
        }
        const Branch whole = follow(tips[0], node(tips[0]).next[0]);
        std::vector<Vec3> line;
        for (const int i : whole.nodes) line.push_back(node(i).at);
        const Vec3 last = tipBeyond(line, node(tips[1]).radius);
        std::reverse(line.begin(), line.end());
        const Vec3 first = tipBeyond(line, node(tips[0]).radius);
        line.push_back(first);
        line.insert(line.begin(), last);
        const double length = lengthOf(line);
        const Vec3 middle = pointAlong(line, 0.5 * length);
        double sum = 0.0;
        for (const int i : whole.nodes) sum += node(i).radius;
        const double thickness = 2.0 * sum / static_cast<double>(whole.nodes.size());
        root.points = {middle};
        root.radius = {std::sqrt(surface_.nearest(middle).squaredDistance)};
        if (length < kChain * thickness) {
            tree_.blob = true;
            return std::move(tree_);
        }
        tree_.chain = true;
        double way = 0.0;
        Limb head, tail;
        head.line = tail.line = {middle};
        std::vector<Vec3> before;
        for (std::size_t i = 0; i < line.size(); ++i) {
            if (i > 0) way += (line[i] - line[i - 1]).norm();
            if (way < 0.5 * length - 1e-9)
                before.push_back(line[i]);
            else if (way > 0.5 * length + 1e-9)
                head.line.push_back(line[i]);
        }
        tail.line.insert(tail.line.end(), before.rbegin(), before.rend());
        for (Limb* limb : {&head, &tail}) {
            for (const Vec3& p : limb->line) limb->radius.push_back(std::sqrt(surface_.nearest(p).squaredDistance));
            limb->share = 0.5;
        }
        root.limbs = {std::move(head), std::move(tail)};
        return std::move(tree_);
    }

    void makeHubs() {
        const auto forks = tipsAndForks().second;
        std::vector<int> number(nodes_.size(), -1);
        for (std::size_t i = 0; i < forks.size(); ++i) number[static_cast<std::size_t>(forks[i])] = static_cast<int>(i);
        std::vector<double> longest(nodes_.size(), 0.0);  // of the branches from a fork to a tip, beyond its ball
        for (const int tip : tipsAndForks().first) {
            const Branch branch = follow(tip, node(tip).next[0]);
            double& known = longest[static_cast<std::size_t>(branch.nodes.back())];
            known = std::max(known, branch.length - node(branch.nodes.back()).radius);
        }
        const double longLimb = kLongLimb * *std::max_element(longest.begin(), longest.end());
        UnionFind sets(forks.size());
        for (const int a : forks)
            for (const int next : std::vector<int>(node(a).next)) {
                const Branch branch = follow(a, next);
                const int b = branch.nodes.back();
                if (number[static_cast<std::size_t>(b)] <= number[static_cast<std::size_t>(a)]) continue;
                const double ra = node(a).radius, rb = node(b).radius;
                std::vector<double> radii;
                for (const int i : branch.nodes)
                    if ((node(i).at - node(a).at).norm() > ra && (node(i).at - node(b).at).norm() > rb) radii.push_back(node(i).radius);
                const double between = branch.length - ra - rb;
                bool one = radii.empty() || between <= kTouching * 2.0 * std::min(ra, rb);
                if (!one) {
                    const double thinnest = *std::min_element(radii.begin(), radii.end());
                    std::nth_element(radii.begin(), radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2), radii.end());
                    const bool trunk = longest[static_cast<std::size_t>(a)] >= longLimb && longest[static_cast<std::size_t>(b)] >= longLimb;
                    one = between <= (trunk ? kTrunkLength : kHubLength) * 2.0 * radii[radii.size() / 2] && thinnest >= kHubNeck * std::min(ra, rb);
                }
                if (one) sets.unite(number[static_cast<std::size_t>(a)], number[static_cast<std::size_t>(b)]);
            }
        hubOf_.assign(nodes_.size(), -1);
        for (const int f : forks) hubOf_[static_cast<std::size_t>(f)] = sets.find(number[static_cast<std::size_t>(f)]);
        // The root: most limbs, then most flesh around.
        std::vector<int> limbs(forks.size(), 0);
        std::vector<double> flesh(forks.size(), 0.0);
        for (const int f : forks) {
            const auto hub = static_cast<std::size_t>(hubOf_[static_cast<std::size_t>(f)]);
            for (const int next : std::vector<int>(node(f).next)) {
                const int other = follow(f, next).nodes.back();
                if (hubOf_[static_cast<std::size_t>(other)] != static_cast<int>(hub)) ++limbs[hub];
            }
            for (const Node& n : nodes_)
                if ((n.at - node(f).at).norm() <= node(f).radius) flesh[hub] += n.flesh;
        }
        std::size_t root = 0;
        for (std::size_t h = 1; h < forks.size(); ++h)
            if (limbs[h] > limbs[root] || (limbs[h] == limbs[root] && flesh[h] > flesh[root])) root = h;
        tree_.root = hub(static_cast<int>(root), -1, -1);
    }

    /// The hub that is entered at node `entry` from `from`; -1: the root.
    Hub hub(int which, int entry, int from) {
        std::vector<int> forks;
        for (int i = 0; i < static_cast<int>(nodes_.size()); ++i)
            if (hubOf_[static_cast<std::size_t>(i)] == which) forks.push_back(i);
        Hub made;
        // Its line: the two forks that are farthest apart; from the entry, where there is one.
        int first = entry >= 0 ? entry : forks[0], last = first;
        double farthest = 0.0;
        for (const int a : forks)
            for (const int b : forks) {
                if (entry >= 0 && a != entry) continue;
                const double d = (node(a).at - node(b).at).norm();
                if (d > farthest + 1e-12) farthest = d, first = a, last = b;
            }
        if (entry < 0 && up_.dot(node(last).at) < up_.dot(node(first).at) - 0.25 * farthest) std::swap(first, last);  // upward
        if (farthest > kOnePoint * std::max(node(first).radius, node(last).radius)) {
            made.points = {node(first).at, node(last).at};
            made.radius = {node(first).radius, node(last).radius};
        } else {
            Vec3 middle = Vec3::Zero();
            double weight = 0.0, radius = 0.0;
            for (const int f : forks) middle += node(f).radius * node(f).at, weight += node(f).radius, radius = std::max(radius, node(f).radius);
            made.points = {Vec3(middle / weight)};
            made.radius = {radius};
        }
        for (const int f : forks)
            for (const int next : std::vector<int>(node(f).next)) {
                if (f == entry && next == from) continue;
                const Branch branch = follow(f, next);
                if (hubOf_[static_cast<std::size_t>(branch.nodes.back())] == which) continue;
                made.limbs.push_back(limb(made, branch));
            }
        return made;
    }

    Limb limb(const Hub& from, const Branch& branch) {
        Limb made;
        const Vec3 start = node(branch.nodes.front()).at;
        if (from.points.size() > 1 && (from.points[1] - start).norm() < (from.points[0] - start).norm()) made.point = 1;
        const Vec3 begin = from.points[static_cast<std::size_t>(made.point)];
        if ((begin - start).norm() > 1e-9) {
            made.hidden = (begin - start).norm() + kOutside * node(branch.nodes.front()).radius;
            made.line.push_back(begin);
            made.radius.push_back(from.radius[static_cast<std::size_t>(made.point)]);
        }
        for (const int i : branch.nodes) {
            made.line.push_back(node(i).at);
            made.radius.push_back(node(i).radius);
            if (i != branch.nodes.front()) made.share += node(i).flesh;
        }
        const int last = branch.nodes.back();
        if (degree(last) == 1) {
            const Vec3 tip = tipBeyond(made.line, node(last).radius);
            if ((tip - made.line.back()).norm() > 1e-6) {
                made.line.push_back(tip);
                made.radius.push_back(0.0);
            }
            return made;
        }
        made.end.push_back(hub(hubOf_[static_cast<std::size_t>(last)], last, branch.nodes[branch.nodes.size() - 2]));
        const Hub& end = made.end[0];
        if ((end.points[0] - made.line.back()).norm() > 1e-9) {
            made.line.push_back(end.points[0]);
            made.radius.push_back(end.radius[0]);
        }
        for (const Limb& on : end.limbs) made.share += on.share;
        return made;
    }

    TriangleTree surface_;
    RayTree rays_;
    double area_;
    Eigen::Index vertices_;
    Vec3 up_;
    double least_;
    std::vector<Node> nodes_;
    std::vector<int> hubOf_;
    LimbTree tree_;
};

/// How far the farthest vertex is from the balls along a skeleton.
double farthestFlesh(const TriangleMesh& mesh, const FlowSkeleton& skeleton) {
    const TriangleTree surface(mesh);
    std::vector<double> radius;
    for (const Vec3& p : skeleton.points) radius.push_back(std::sqrt(surface.nearest(p).squaredDistance));
    double farthest = 0.0;
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
        const Vec3 place = mesh.vertices.row(v);
        double nearest = HUGE_VAL;
        for (std::size_t i = 0; i < radius.size() && nearest > farthest; ++i) nearest = std::min(nearest, (place - skeleton.points[i]).norm() - radius[i]);
        farthest = std::max(farthest, nearest);
    }
    return farthest;
}

std::size_t limbCount(const Hub& hub) {
    std::size_t count = hub.limbs.size();
    for (const Limb& limb : hub.limbs)
        for (const Hub& end : limb.end) count += limbCount(end);
    return count;
}

}  // namespace

double Limb::length() const { return lengthOf(line); }

double lengthOf(const std::vector<Vec3>& line) {
    double sum = 0.0;
    for (std::size_t i = 1; i < line.size(); ++i) sum += (line[i] - line[i - 1]).norm();
    return sum;
}

Vec3 pointAlong(const std::vector<Vec3>& line, double way) {
    for (std::size_t i = 1; i < line.size(); ++i) {
        const double step = (line[i] - line[i - 1]).norm();
        if (way <= step && step > 0.0) return line[i - 1] + std::max(way, 0.0) / step * (line[i] - line[i - 1]);
        way -= step;
    }
    return line.back();
}

Result<LimbTree> findLimbs(const TriangleMesh& mesh, const Vec3& up, double least, const Progress& progress) {
    const auto skeleton = [&](double shortest) -> Result<FlowSkeleton> {
        const Attempt shrinking("shrinking the shape to lines");
        if (!shrinking) return fail("no-skeleton", "Shrinking the body to lines breaks down or comes to no end: cut it by hand, or use handles.");
        return flowSkeleton(mesh, shortest, progress);
    };
    IMOMUSHI_TRY(const auto coarse, skeleton(kCoarse));
    LimbTree tree = Builder(mesh, up, least).build(coarse);
    if (farthestFlesh(mesh, coarse) > kUnexplained) {
        const auto fine = skeleton(kFine);
        if (!fine && fine.error().code == kCancelled) return tl::unexpected(fine.error());
        if (fine) {
            LimbTree finer = Builder(mesh, up, least).build(*fine);
            if (limbCount(finer.root) > limbCount(tree.root)) tree = std::move(finer);
        }
    }
    return tree;
}

}  // namespace imomushi
