// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/meshing/short_edges.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <queue>
#include <tuple>
#include <utility>

#include "core/meshing/mesh_pieces.h"

namespace imomushi {
namespace {

using Index = std::int32_t;

/// An edge is short below this part of the longest ones at both of its ends.
constexpr double kFarShorter = 0.05;
/// The end that stays may lie off the planes of the triangles around the one that goes by this part of the longest edges, and of the short one: walls keep their two sides, creases their line.
constexpr double kOff = 2e-3, kAcross = 0.75;
/// Cosine of the largest angle by which a triangle may turn (60 degrees).
constexpr double kMayTurn = 0.5;

class ShortEdges {
public:
    explicit ShortEdges(const SolverMesh& mesh) : pieces_(mesh), faces_(mesh.faces.size()), fixed_(static_cast<Index>(pieces_.points.size() - pieces_.origin.size())), around_(pieces_.points.size()) {
        for (std::size_t t = 0; t < pieces_.corners.size(); ++t)
            for (const Index v : pieces_.corners[t]) around_[at(v)].push_back(static_cast<Index>(t));
        for (std::size_t v = 0; v < around_.size(); ++v) push(static_cast<Index>(v));
    }

    SolverMesh result() {
        // What is in the way of one edge may go with another one.
        for (bool any = true; any;) {
            any = false;
            std::vector<Entry> stay;
            while (!queue_.empty()) {
                const auto [length, a, b] = queue_.top();
                queue_.pop();
                if (around_[at(a)].empty() || around_[at(b)].empty() || !isShort(a, b)) continue;
                if (collapse(std::max(a, b), std::min(a, b)) || collapse(std::min(a, b), std::max(a, b))) any = true;
                else stay.emplace_back(length, a, b);
            }
            for (const Entry& entry : stay) queue_.push(entry);
        }
        return compact();
    }

private:
    using Entry = std::tuple<double, Index, Index>;  // length and ends of an edge

    static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
    [[nodiscard]] double length(Index a, Index b) const { return (pieces_.at(a) - pieces_.at(b)).norm(); }

    [[nodiscard]] std::vector<Index> neighbours(Index v) const {
        std::vector<Index> out;
        for (const Index t : around_[at(v)])
            for (const Index w : pieces_.corners[at(t)])
                if (w != v) out.push_back(w);
        std::sort(out.begin(), out.end());
        out.erase(std::unique(out.begin(), out.end()), out.end());
        return out;
    }
    [[nodiscard]] double longest(Index v) const {
        double out = 0.0;
        for (const Index w : neighbours(v)) out = std::max(out, length(v, w));
        return out;
    }
    [[nodiscard]] bool isShort(Index a, Index b) const { return length(a, b) < kFarShorter * std::min(longest(a), longest(b)); }
    /// The short edges at a vertex.
    void push(Index v) {
        const double most = kFarShorter * longest(v);
        for (const Index w : neighbours(v))
            if (const double l = length(v, w); l < most && std::max(v, w) >= fixed_ && l < kFarShorter * longest(w)) queue_.emplace(l, std::min(v, w), std::max(v, w));
    }

    /// Whether faces, or a face and the free surface, meet along an edge.
    [[nodiscard]] bool isRim(Index a, Index b) const {
        Index first = -2;
        for (const Index t : around_[at(a)]) {
            const auto& k = pieces_.corners[at(t)];
            if (std::find(k.begin(), k.end(), b) == k.end()) continue;
            if (first == -2) first = pieces_.face[at(t)];
            if (pieces_.face[at(t)] != first) return true;
        }
        return false;
    }
    [[nodiscard]] bool isAtRim(Index v) const {
        return std::ranges::any_of(around_[at(v)], [&](Index t) { return pieces_.face[at(t)] != pieces_.face[at(around_[at(v)].front())]; });
    }

    bool collapse(Index gone, Index kept) {
        if (gone < fixed_ || (isAtRim(gone) && !isRim(gone, kept))) return false;
        const std::vector<Index> a = neighbours(gone), b = neighbours(kept);
        std::vector<Index> both;
        std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
        if (both.size() != 2) return false;  // the surface would touch itself
        const auto area = [&](const std::array<Index, 3>& k) -> Vec3 { return (pieces_.at(k[1]) - pieces_.at(k[0])).cross(pieces_.at(k[2]) - pieces_.at(k[0])); };
        const double mostOff = std::min(kOff * std::min(longest(gone), longest(kept)), kAcross * length(gone, kept));
        for (const Index t : around_[at(gone)]) {
            std::array<Index, 3> k = pieces_.corners[at(t)];
            if (std::find(k.begin(), k.end(), kept) != k.end()) continue;
            const Vec3 before = area(k);
            if (!(std::abs(before.dot(pieces_.at(kept) - pieces_.at(gone))) <= mostOff * before.norm())) return false;
            std::replace(k.begin(), k.end(), gone, kept);
            const Vec3 after = area(k);
            if (!(before.dot(after) > kMayTurn * before.norm() * after.norm())) return false;
        }
        for (const Index t : std::exchange(around_[at(gone)], {})) {
            auto& k = pieces_.corners[at(t)];
            if (std::find(k.begin(), k.end(), kept) != k.end()) {
                for (const Index v : k)
                    if (v != gone) std::erase(around_[at(v)], t);
                k = {-1, -1, -1};
            } else {
                std::replace(k.begin(), k.end(), gone, kept);
                around_[at(kept)].push_back(t);
            }
        }
        push(kept);
        return true;
    }

    /// Each vertex with an origin, between those without one: all that it lies between belong to one triangle of them.
    [[nodiscard]] std::vector<std::vector<std::pair<Index, double>>> places() const {
        std::vector<std::vector<std::pair<Index, double>>> out(pieces_.points.size());
        for (std::size_t v = 0; v < out.size(); ++v) {
            if (static_cast<Index>(v) < fixed_) {
                out[v] = {{static_cast<Index>(v), 1.0}};
                continue;
            }
            const SolverMesh::Origin& o = pieces_.origin[v - at(fixed_)];
            for (std::size_t k = 0; k < 3; ++k) {
                if (o.share[k] == 0.0) continue;
                for (const auto& [w, share] : out[at(o.of[k])]) {
                    const auto found = std::ranges::find(out[v], w, &std::pair<Index, double>::first);
                    if (found != out[v].end()) found->second += o.share[k] * share;
                    else out[v].emplace_back(w, o.share[k] * share);
                }
            }
        }
        return out;
    }

    SolverMesh compact() const {
        MeshPieces out = pieces_;
        out.points.clear();
        out.origin.clear();
        out.corners.clear();
        out.face.clear();
        std::vector<Index> number(around_.size(), -1);
        const auto between = places();
        for (Index v = 0; v < static_cast<Index>(around_.size()); ++v) {
            if (v >= fixed_ && around_[at(v)].empty()) continue;
            number[at(v)] = static_cast<Index>(out.points.size());
            out.points.push_back(pieces_.at(v));
            if (v < fixed_) continue;
            const auto& shares = between[at(v)];
            SolverMesh::Origin o{{shares[0].first, shares[0].first, shares[0].first}, {0.0, 0.0, 0.0}};
            for (std::size_t k = 0; k < shares.size(); ++k) {
                o.of[k] = shares[k].first;
                o.share[k] = shares[k].second;
            }
            out.origin.push_back(o);
        }
        for (std::size_t t = 0; t < pieces_.corners.size(); ++t) {
            const auto& k = pieces_.corners[t];
            if (k[0] >= 0) out.triangle(number[at(k[0])], number[at(k[1])], number[at(k[2])], pieces_.face[t]);
        }
        return out.joined(faces_);
    }

    MeshPieces pieces_;
    std::size_t faces_;
    Index fixed_;                            // so many vertices stay
    std::vector<std::vector<Index>> around_;  // triangles of each vertex; none: it is gone
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;  // shortest first
};

}  // namespace

SolverMesh withoutShortEdges(const SolverMesh& mesh) { return ShortEdges(mesh).result(); }

}  // namespace imomushi
