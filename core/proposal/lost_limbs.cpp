// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "core/proposal/limb_tree.h"

namespace imomushi {
namespace {

/// What grows from a limb within so many of its radii of its hub, or of another limb that grows from it, grows from that place.
constexpr double kSameHub = 1.2;
/// Parts of a chain at its ends, of its length.
constexpr double kMouth = 0.1;

class Growing {
public:
    Growing(LimbTree& tree, const TriangleMesh& mesh, const SurfaceTips& tips) : tree_(tree), mesh_(mesh), tips_(tips) {}

    bool add(const std::vector<char>& without, double least) {
        std::vector<char> reached(tips_.tips.size(), 0);
        reach(tree_.root, reached);
        std::vector<std::size_t> lost;
        for (std::size_t t = 0; t < tips_.tips.size(); ++t)
            if (!reached[t] && !without[t] && !tips_.tips[t].line.empty() && tips_.tips[t].share >= least) lost.push_back(t);
        if (tree_.chain) openChain(lost);
        if (lost.empty()) return false;
        tree_.blob = false;
        std::vector<std::pair<Hub*, Limb>> onHubs;
        for (const std::size_t t : lost) {
            Place best;
            look(tree_.root, tips_.tips[t].line.front(), best);
            if (best.limb)
                find(*best.limb).push_back({best.way, t});
            else
                onHubs.emplace_back(best.hub, grown(*best.hub, best.point, t));
        }
        for (auto& [limb, growths] : onLimbs_) {
            std::stable_sort(growths.begin(), growths.end(), [](const Growth& a, const Growth& b) { return a.way < b.way; });
            split(*limb, growths);
        }
        for (auto& [hub, limb] : onHubs) hub->limbs.push_back(std::move(limb));
        // What was left out before it was found.
        std::erase_if(tree_.leftOut,
                      [&](const LimbTree::LeftOut& out) { return std::find(lost.begin(), lost.end(), tipAt(out.place)) != lost.end(); });
        return true;
    }

private:
    struct Place {
        double depth = HUGE_VAL;  ///< outside of the flesh there
        Hub* hub = nullptr;
        int point = 0;
        Limb* limb = nullptr;  ///< where it is none of a hub
        double way = 0.0;
    };
    struct Growth {
        double way = 0.0;
        std::size_t tip = 0;
    };

    [[nodiscard]] std::size_t tipAt(const Vec3& place) const {
        Eigen::Index nearest = 0;
        (mesh_.vertices.rowwise() - place.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
        return static_cast<std::size_t>(tips_.tipOf[static_cast<std::size_t>(nearest)]);
    }

    void reach(const Hub& hub, std::vector<char>& reached) const {
        for (const Limb& limb : hub.limbs) {
            if (limb.end.empty()) reached[tipAt(limb.tip())] = 1;
            for (const Hub& end : limb.end) reach(end, reached);
        }
    }

    std::vector<Growth>& find(Limb& limb) {
        for (auto& [of, growths] : onLimbs_)
            if (of == &limb) return growths;
        return onLimbs_.emplace_back(&limb, std::vector<Growth>()).second;
    }

    void look(Hub& hub, const Vec3& base, Place& best) {
        const auto atHub = [&](Hub& at, int point, double depth) {
            if (depth < best.depth) best = {depth, &at, point, nullptr, 0.0};
        };
        for (std::size_t p = 0; p < hub.points.size(); ++p) atHub(hub, static_cast<int>(p), (base - hub.points[p]).norm() - hub.radius[p]);
        for (Limb& limb : hub.limbs) {
            double way = 0.0;
            const Vec3 begin = hub.points[static_cast<std::size_t>(limb.point)];
            const double ball = hub.radius[static_cast<std::size_t>(limb.point)];
            for (std::size_t i = 1; i < limb.line.size(); ++i) {
                const Vec3 side = limb.line[i] - limb.line[i - 1];
                const double t = std::clamp(side.dot(base - limb.line[i - 1]) / std::max(side.squaredNorm(), 1e-300), 0.0, 1.0);
                const Vec3 at = limb.line[i - 1] + t * side;
                const double depth = (base - at).norm() - ((1.0 - t) * limb.radius[i - 1] + t * limb.radius[i]);
                if (depth < best.depth) {
                    if ((at - begin).norm() <= kSameHub * ball)
                        atHub(hub, limb.point, depth);
                    else if (!limb.end.empty() && (at - limb.end[0].points[0]).norm() <= kSameHub * limb.end[0].radius[0])
                        atHub(limb.end[0], 0, depth);
                    else
                        best = {depth, &hub, limb.point, &limb, way + t * side.norm()};
                }
                way += side.norm();
            }
            for (Hub& end : limb.end) look(end, base, best);
        }
    }

    [[nodiscard]] Limb grown(const Hub& hub, int point, std::size_t tip) const {
        const SurfaceTip& from = tips_.tips[tip];
        Limb made;
        made.point = point;
        made.line = {hub.points[static_cast<std::size_t>(point)]};
        made.radius = {hub.radius[static_cast<std::size_t>(point)]};
        made.line.insert(made.line.end(), from.line.begin(), from.line.end());
        made.radius.insert(made.radius.end(), from.radius.begin(), from.radius.end());
        made.share = from.share;
        made.lost = static_cast<int>(tip);
        made.own = lengthOf(from.line);
        return made;
    }

    /// A limb ends in a hub where others grow from it; what is left of it goes on from there.
    void split(Limb& limb, std::span<const Growth> growths) const {
        if (growths.empty()) return;
        const auto ball = [&](double way) {
            double from = 0.0;
            for (std::size_t i = 1; i < limb.line.size(); ++i) {
                const double side = (limb.line[i] - limb.line[i - 1]).norm();
                if (from + side >= way) return std::max(limb.radius[i - 1], limb.radius[i]);
                from += side;
            }
            return limb.radius.back();
        };
        std::size_t here = 1;
        while (here < growths.size() && growths[here].way <= growths[0].way + kSameHub * ball(growths[0].way)) ++here;
        const double way = 0.5 * (growths[0].way + growths[here - 1].way);
        Hub hub;
        hub.points = {pointAlong(limb.line, way)};
        hub.radius = {ball(way)};
        Limb rest;
        rest.end = std::move(limb.end);
        rest.line = hub.points;
        rest.radius = hub.radius;
        std::vector<Vec3> line;
        std::vector<double> radius;
        double from = 0.0;
        for (std::size_t i = 0; i < limb.line.size(); ++i) {
            if (i > 0) from += (limb.line[i] - limb.line[i - 1]).norm();
            const bool before = from<way - 1e-9, beyond = from> way + 1e-9;
            if (before) line.push_back(limb.line[i]), radius.push_back(limb.radius[i]);
            if (beyond) rest.line.push_back(limb.line[i]), rest.radius.push_back(limb.radius[i]);
        }
        line.push_back(hub.points[0]);
        radius.push_back(hub.radius[0]);
        limb.line = std::move(line);
        limb.radius = std::move(radius);
        rest.share = limb.share;
        rest.beyond = limb.beyond;
        limb.beyond += rest.length();
        std::vector<Growth> on(growths.begin() + static_cast<std::ptrdiff_t>(here), growths.end());
        for (Growth& g : on) g.way -= way;
        split(rest, on);
        if (rest.line.size() > 1) {
            const double outside = rest.length() - hub.radius[0];
            double area = 0.0;  // of a tube, over pi, as in the pruning of the skeleton
            for (std::size_t i = 1; i < rest.line.size(); ++i)
                if ((rest.line[i] - rest.line[0]).norm() > hub.radius[0])
                    area += (rest.radius[i - 1] + rest.radius[i]) * (rest.line[i] - rest.line[i - 1]).norm();
            rest.stump = rest.end.empty() && (outside < kLeastReach || outside * outside < kLeastSlenderness * area);
            hub.limbs.push_back(std::move(rest));
        }
        for (std::size_t i = 0; i < here; ++i) hub.limbs.push_back(grown(hub, 0, growths[i].tip));
        limb.end.clear();
        limb.end.push_back(std::move(hub));
    }

    /// A chain from whose flesh limbs grow begins at the one that is nearest to it. What grows from its ends is a mouth, no limb.
    void openChain(std::vector<std::size_t>& lost) {
        Limb whole;
        Hub& root = tree_.root;
        for (std::size_t i = root.limbs[1].line.size(); i-- > 1;)
            whole.line.push_back(root.limbs[1].line[i]), whole.radius.push_back(root.limbs[1].radius[i]);
        whole.line.insert(whole.line.end(), root.limbs[0].line.begin(), root.limbs[0].line.end());
        whole.radius.insert(whole.radius.end(), root.limbs[0].radius.begin(), root.limbs[0].radius.end());
        const double length = whole.length();
        std::size_t at = 0;
        double least = HUGE_VAL;
        std::erase_if(lost, [&](std::size_t t) {
            double way = 0.0, own = HUGE_VAL;
            std::size_t place = 0;
            bool inside = false;
            for (std::size_t i = 1; i + 1 < whole.line.size(); ++i) {
                way += (whole.line[i] - whole.line[i - 1]).norm();
                const double depth = (tips_.tips[t].line.front() - whole.line[i]).norm() - whole.radius[i];
                if (depth < own) own = depth, place = i, inside = way > kMouth * length && way < (1.0 - kMouth) * length;
            }
            if (inside && own < least) least = own, at = place;
            return !inside;
        });
        if (lost.empty()) return;
        Hub made;
        made.points = {whole.line[at]};
        made.radius = {whole.radius[at]};
        Limb ahead, back;
        for (std::size_t i = at; i < whole.line.size(); ++i) ahead.line.push_back(whole.line[i]), ahead.radius.push_back(whole.radius[i]);
        for (std::size_t i = at + 1; i-- > 0;) back.line.push_back(whole.line[i]), back.radius.push_back(whole.radius[i]);
        ahead.share = back.share = 0.5;
        made.limbs = {std::move(ahead), std::move(back)};
        root = std::move(made);
        tree_.chain = false;
    }

    LimbTree& tree_;
    const TriangleMesh& mesh_;
    const SurfaceTips& tips_;
    std::vector<std::pair<Limb*, std::vector<Growth>>> onLimbs_;
};

}  // namespace

bool addLostLimbs(LimbTree& tree, const TriangleMesh& mesh, const SurfaceTips& tips, const std::vector<char>& without, double least) {
    return !tips.tips.empty() && !tree.root.points.empty() && Growing(tree, mesh, tips).add(without, least);
}

}  // namespace imomushi
