// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/proposal/surface_tips.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/mesh/surface_distance.h"

namespace imomushi {
namespace {

/// Places that distances are measured from, spread evenly.
constexpr int kFrom = 48;
/// From an end it goes down at least this far, in diagonals: shorter ones are folds.
constexpr double kLeastDown = 0.008;
/// A tip is a limb where it stands out by so many diagonals, and by so many of its thicknesses: more than a cone of 90 degrees, .7.
constexpr double kStandsOut = 0.02, kSlender = 0.8;
/// From one disc around a tip to the next, and the farthest.
constexpr double kRing = 6e-3, kFarthest = 0.5;
/// A disc that is less slender than this part of the most slender one before it reaches beyond the limb.
constexpr double kFlared = 0.85;
/// Of the whole surface: half an egg is no limb.
constexpr double kMostShare = 0.2;

class TipFinder {
public:
    explicit TipFinder(const TriangleMesh& mesh)
        : mesh_(mesh), distance_(mesh), count_(static_cast<std::size_t>(mesh.vertices.rows())), next_(count_), area_(count_, 0.0) {
        for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
            const auto p = [&](int k) { return at(mesh.triangles(f, k)); };
            const double area = 0.5 * (p(1) - p(0)).cross(p(2) - p(0)).norm();
            whole_ += area;
            for (int k = 0; k < 3; ++k) {
                const std::int32_t v = mesh.triangles(f, k);
                area_[index(v)] += area / 3.0;
                next_[index(v)].push_back(mesh.triangles(f, (k + 1) % 3));  // closed: each edge comes once from each of its ends
            }
        }
    }

    SurfaceTips find() {
        if (count_ == 0) return {};
        measure();
        meet();
        for (SurfaceTip& tip : made_.tips) follow(tip);
        return std::move(made_);
    }

private:
    static std::size_t index(std::int32_t v) { return static_cast<std::size_t>(v); }
    [[nodiscard]] Vec3 at(std::int32_t v) const { return mesh_.vertices.row(v).transpose(); }

    /// How far it is to everywhere else, in the mean.
    void measure() {
        far_.assign(count_, 0.0);
        std::vector<double> nearest(count_, SurfaceDistance::kFar);
        const Eigen::RowVector3d middle = mesh_.vertices.colwise().mean();
        Eigen::Index from = 0;
        (mesh_.vertices.rowwise() - middle).rowwise().squaredNorm().maxCoeff(&from);
        for (int k = 0; k < kFrom; ++k) {
            distance_.spread(
                static_cast<std::int32_t>(from), SurfaceDistance::kFar, [](std::int32_t, double) { return true; },
                [&](std::int32_t v, double d) { far_[index(v)] += d / kFrom, nearest[index(v)] = std::min(nearest[index(v)], d); });
            from = std::max_element(nearest.begin(), nearest.end()) - nearest.begin();
        }
    }

    /// Goes down from the farthest vertices: where two ends meet, the lower one is an end of its own if it stands high enough above that place.
    void meet() {
        std::vector<std::int32_t> order(count_);
        std::iota(order.begin(), order.end(), 0);
        std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return far_[index(a)] > far_[index(b)]; });
        std::vector<std::int32_t> parent(count_, -1), peak(count_, -1),
            into(count_, -1);  // of sets; per vertex the end above it; of ends, the one that took it over
        std::vector<char> counts(count_, 0);
        const auto root = [&](std::int32_t v) {
            while (parent[index(v)] != v) v = parent[index(v)] = parent[index(parent[index(v)])];
            return v;
        };
        for (const std::int32_t v : order) {
            parent[index(v)] = v;
            peak[index(v)] = v;
            for (const std::int32_t n : next_[index(v)]) {
                if (parent[index(n)] < 0) continue;
                // A root's own entry of `peak` is its set's end.
                const std::int32_t a = root(v), b = root(n);
                if (a == b) continue;
                std::int32_t high = peak[index(a)], low = peak[index(b)];
                if (far_[index(high)] < far_[index(low)]) std::swap(high, low);
                if (far_[index(low)] - far_[index(v)] >= kLeastDown) {
                    counts[index(low)] = 1;
                } else {
                    into[index(low)] = high;
                }
                const std::int32_t kept = peak[index(a)] == high ? a : b;
                parent[index(a)] = parent[index(b)] = kept;
            }
            above_.push_back(peak[index(root(v))]);
        }
        counts[index(order.front())] = 1;
        std::vector<std::int32_t> number(count_, -1);
        for (const std::int32_t v : order)
            if (counts[index(v)]) {
                number[index(v)] = static_cast<std::int32_t>(made_.tips.size());
                made_.tips.push_back({v, {}, {}, 0.0});
            }
        made_.tipOf.assign(count_, 0);
        for (std::size_t i = 0; i < count_; ++i) {
            std::int32_t end = above_[i];
            while (!counts[index(end)] && into[index(end)] >= 0) end = into[index(end)];
            made_.tipOf[index(order[i])] = std::max(0, number[index(end)]);
        }
    }

    /// The line of a tip: middles of the rims of discs around it, up to the last one that is nearly as slender as any. A tube grows more slender with length,
    /// a cone is as slender everywhere, and both are less so from where they flare.
    void follow(SurfaceTip& tip) {
        const Vec3 end = at(tip.vertex);
        std::vector<double> way(count_, SurfaceDistance::kFar);
        distance_.spread(
            tip.vertex, kFarthest, [](std::int32_t, double) { return true; }, [&](std::int32_t v, double d) { way[index(v)] = d; });
        double until = kFarthest;  // another tip is another limb
        for (const SurfaceTip& other : made_.tips)
            if (other.vertex != tip.vertex) until = std::min(until, way[index(other.vertex)]);
        std::vector<Vec3> middles;
        std::vector<double> radii;
        std::size_t last = 0;
        double slenderest = 0.0;
        for (double r = kRing; r < until; r += kRing) {
            std::vector<Vec3> rim;
            double area = 0.0;
            for (std::int32_t v = 0; v < static_cast<std::int32_t>(count_); ++v) {
                if (way[index(v)] > r) continue;
                area += area_[index(v)];
                for (const std::int32_t n : next_[index(v)])
                    if (way[index(n)] > r) {
                        const double t = way[index(n)] < SurfaceDistance::kFar
                                             ? (r - way[index(v)]) / std::max(way[index(n)] - way[index(v)], 1e-300)
                                             : 0.0;
                        rim.push_back(at(v) + t * (at(n) - at(v)));
                    }
            }
            if (rim.size() < 3 || area > kMostShare * whole_) break;
            Vec3 middle = Vec3::Zero();
            for (const Vec3& p : rim) middle += p / static_cast<double>(rim.size());
            double radius = 0.0;
            for (const Vec3& p : rim) radius += (p - middle).norm() / static_cast<double>(rim.size());
            middles.push_back(middle);
            radii.push_back(radius);
            const double out = (end - middle).norm(), slender = std::numbers::pi * out * out / std::max(area, 1e-300);
            if (out < kStandsOut) continue;
            slenderest = std::max(slenderest, slender);
            if (slender >= kFlared * slenderest)
                last = middles.size(), tip.share = area / whole_;
            else if (slenderest >= kSlender)
                break;
        }
        if (slenderest < kSlender) return;
        for (std::size_t i = last; i-- > 0;) tip.line.push_back(middles[i]), tip.radius.push_back(radii[i]);
        tip.line.push_back(end);
        tip.radius.push_back(0.0);
    }

    const TriangleMesh& mesh_;
    SurfaceDistance distance_;
    std::size_t count_;
    std::vector<std::vector<std::int32_t>> next_;  // per vertex those around it
    std::vector<double> area_;                     // per vertex
    double whole_ = 0.0;
    std::vector<double> far_;          // per vertex
    std::vector<std::int32_t> above_;  // per vertex in the order of far_, its end
    SurfaceTips made_;
};

}  // namespace

SurfaceTips findSurfaceTips(const TriangleMesh& mesh) { return TipFinder(mesh).find(); }

}  // namespace imomushi
