// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/base/index.h"
#include "core/meshing/edge_collapse.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <queue>
#include <utility>

namespace imomushi {
namespace {

using Index = std::int32_t;

/// Distance from the body counts this times as much as length: on a sphere both weigh the same where an edge is a quarter of the radius. Less
/// changes how stiff thin bodies are (measured on a fin: 1.7 % at 10, 0.2 % at 30), more takes the vertices from flat parts.
constexpr double kDistanceWeight = 30.0;

/// Away from a fine rim an edge may be as long as this times its distance from it, as in a refined solver mesh.
constexpr double kGrading = 0.6;

/// A collapse may make no triangle worse than this, unless there was a worse one: 4 sqrt(3) area / sum of squared edges, 1 if equilateral. 0.2 is a
/// right triangle of sides 1 : 8.
constexpr double kPoor = 0.2;

/// Cosine of the angle that a triangle may turn in one collapse (60 degrees): far from folding over.
constexpr double kTurn = 0.5;

/// A rim is straight at a vertex that is no farther than this from the line between its neighbours, in diagonals of the body: single precision.
constexpr double kStraightLine = 1e-7;

/// Weight of staying in the middle of an edge against the distance from planes: decides only along the surface.
constexpr double kMiddle = 1e-3;

/// An edge shorter than this part of the wanted one is of a needle: where needles lie side by side, the vertex of the collapsed edge may only fit at one of its ends.
constexpr double kShort = 0.05;

/// Between looks at the clock; a collapse takes some microseconds.
constexpr int kLook = 1024;

/// What a vertex may do: Free: vanish and move; InFace: vanish into a neighbour in its face; OnRim: vanish along a straight rim; Fixed: nothing.
enum class Constraint : std::uint8_t { Free, InFace, OnRim, Fixed };

/// Sum of squared distances from planes, by area.
struct Quadric {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Vec3 b = Vec3::Zero();
    double c = 0.0, weight = 0.0;

    Quadric& operator+=(const Quadric& o) {
        A += o.A, b += o.b, c += o.c, weight += o.weight;
        return *this;
    }
    /// Mean squared distance of x from the planes.
    [[nodiscard]] double operator()(const Vec3& x) const {
        return weight > 0.0 ? std::max(0.0, x.dot(A * x) - 2.0 * b.dot(x) + c) / weight : 0.0;
    }
};

double quality(const Vec3& a, const Vec3& b, const Vec3& c, double doubleArea) {
    const double squares = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
    return squares > 0.0 ? 2.0 * std::sqrt(3.0) * doubleArea / squares : 0.0;
}

}  // namespace

/// Half-edges 3 t + c run from corner c of triangle t to the next.
class EdgeCollapse::State {
public:
    State(const LabelledSurface& surface, std::vector<double> limit, double uniform, std::vector<double> tolerance, std::vector<double> size)
        : s_(surface), limit_(std::move(limit)), uniform_(uniform), tolerance_(std::move(tolerance)), wanted_(std::move(size)) {}

    bool connect(const Progress& progress) {
        const std::size_t n = s_.points.size(), sides = 3 * s_.corners.size();
        // Half-edges by their lower vertex; each vertex has few, so that searching them is linear in all.
        std::vector<Index> first(n + 1, 0), at_(sides), fan(n, 0);
        origin_.resize(sides);
        twin_.assign(sides, -1);
        leaving_.assign(n, -1);
        for (std::size_t t = 0; t < s_.corners.size(); ++t)
            for (std::size_t c = 0; c < 3; ++c) origin_[3 * t + c] = s_.corners[t][c];
        const auto count = static_cast<Index>(sides);
        for (Index h = 0; h < count; ++h) ++first[at(std::min(from(h), to(h))) + 1], leaving_[at(from(h))] = h, ++fan[at(from(h))];
        if (progress.cancelled()) return false;
        for (std::size_t v = 0; v < n; ++v) first[v + 1] += first[v];
        std::vector<Index> next(first.begin(), first.end() - 1);
        for (Index h = 0; h < count; ++h) at_[at(next[at(std::min(from(h), to(h)))]++)] = h;
        for (std::size_t v = 0; v < n; ++v) {
            if (v % (64 * kLook) == 0 && progress.cancelled()) return false;
            for (Index i = first[v]; i < first[v + 1]; ++i) {
                const Index h = at_[at(i)];
                for (Index j = first[v]; j < first[v + 1] && twin_[at(h)] < 0; ++j) {
                    const Index g = at_[at(j)];
                    if (from(g) != to(h) || to(g) != from(h)) continue;
                    if (twin_[at(g)] >= 0) return false;
                    twin_[at(h)] = g, twin_[at(g)] = h;
                }
                if (twin_[at(h)] < 0 || from(h) == to(h)) return false;
            }
        }
        for (Index v = 0; v < static_cast<Index>(n); ++v) {
            if (leaving_[at(v)] < 0 || (v % (64 * kLook) == 0 && progress.cancelled())) return false;
            int around = 0;
            for (Index h = leaving_[at(v)]; around <= fan[at(v)]; ++around, h = around_(h))
                if (around > 0 && h == leaving_[at(v)]) break;
            if (around != fan[at(v)]) return false;
        }
        return true;
    }

    bool run(int vertices, const Progress& progress) {
        const auto n = static_cast<Index>(s_.points.size());
        became_.resize(at(n));
        for (Index v = 0; v < n; ++v) became_[at(v)] = v;
        mark_.assign(at(n), -1);
        left_ = n;
        if (!constrain(progress) || !measure(progress) || !grade(progress)) return false;
        stamp_.assign(twin_.size(), 0);
        const int wanted = std::max(vertices, 4), all = left_;
        for (int before = -1; left_ > wanted && left_ != before;) {
            before = left_;  // what could not be collapsed earlier may be possible now that its surroundings have changed
            std::vector<Entry> room;
            room.reserve(twin_.size());  // about what is ever in it: growing would copy all entries at once
            queue_ = std::priority_queue<Entry>({}, std::move(room));
            for (Index h = 0; h < static_cast<Index>(twin_.size()); ++h) {
                if (h % (64 * kLook) == 0 && progress.cancelled()) return false;
                if (alive(h) && h < twin_[at(h)]) push(h);
            }
            int pops = 0;
            while (left_ > wanted && !queue_.empty()) {
                if (++pops % kLook == 0) {
                    if (progress.cancelled()) return false;
                    progress.report("decimate", static_cast<double>(all - left_) / (all - wanted));
                }
                const Entry top = queue_.top();
                queue_.pop();
                if (alive(top.side) && stamp_[at(top.side)] == top.stamp) tryEdge(top.side);
            }
        }
        return true;
    }

    LabelledSurface result(std::vector<Index>& number) const {
        LabelledSurface out;
        std::vector<Index> fresh(s_.points.size(), -1);
        for (std::size_t v = 0; v < s_.points.size(); ++v)
            if (became_[v] == static_cast<Index>(v)) {
                fresh[v] = static_cast<Index>(out.points.size());
                out.points.push_back(s_.points[v]);
                out.place.push_back(s_.place[v]);
            }
        for (std::size_t t = 0; t < s_.corners.size(); ++t)
            if (origin_[3 * t] >= 0) {
                out.corners.push_back({fresh[at(origin_[3 * t])], fresh[at(origin_[3 * t + 1])], fresh[at(origin_[3 * t + 2])]});
                out.label.push_back(s_.label[t]);
            }
        number.resize(s_.points.size());
        for (std::size_t v = 0; v < s_.points.size(); ++v) {
            Index now = static_cast<Index>(v);
            while (became_[at(now)] != now) now = became_[at(now)];
            number[v] = fresh[at(now)];
        }
        return out;
    }

private:
    struct Entry {
        double cost;
        Index side;
        std::uint32_t stamp;
        bool operator<(const Entry& o) const { return cost > o.cost || (cost == o.cost && side > o.side); }  // the least costly is on top
    };

    [[nodiscard]] static Index next(Index h) { return h % 3 == 2 ? h - 2 : h + 1; }
    [[nodiscard]] static Index previous(Index h) { return h % 3 == 0 ? h + 2 : h - 1; }
    [[nodiscard]] Index from(Index h) const { return origin_[at(h)]; }
    [[nodiscard]] Index to(Index h) const { return origin_[at(next(h))]; }
    [[nodiscard]] Index around_(Index h) const { return twin_[at(previous(h))]; }  ///< the next half-edge that leaves the same vertex
    [[nodiscard]] bool alive(Index h) const { return origin_[at(h)] >= 0; }
    [[nodiscard]] Index label(Index h) const { return s_.label[at(h / 3)]; }
    [[nodiscard]] bool rim(Index h) const { return label(h) != label(twin_[at(h)]); }
    [[nodiscard]] const Vec3& point(Index v) const { return s_.points[at(v)]; }
    [[nodiscard]] Constraint constraintOf(Index v) const { return constraint_[at(v)]; }

    template <class Visit>
    void eachLeaving(Index v, const Visit& visit) const {
        Index h = leaving_[at(v)];
        do {
            visit(h);
            h = around_(h);
        } while (h != leaving_[at(v)]);
    }

    /// The two neighbours of v along a rim; nothing where v is on no rim or on several.
    [[nodiscard]] std::optional<std::array<Index, 2>> rimNeighbours(Index v) const {
        std::array<Index, 2> ends{};
        std::size_t count = 0;
        eachLeaving(v, [&](Index h) {
            if (rim(h) && count++ < 2) ends[count - 1] = to(h);
        });
        if (count != 2) return std::nullopt;
        return ends;
    }
    [[nodiscard]] bool straight(Index v, const std::array<Index, 2>& ends) const {
        const Vec3 along = point(ends[1]) - point(ends[0]), arm = point(v) - point(ends[0]);
        const double squared = along.squaredNorm(), share = arm.dot(along);
        double tolerance = kStraightLine;
        eachLeaving(v, [&](Index h) {
            if (label(h) >= 0) tolerance = std::max(tolerance, tolerance_[at(label(h))]);
        });
        return share > 0.0 && share < squared && (arm - along * (share / squared)).norm() <= tolerance;
    }

    bool constrain(const Progress& progress) {
        constraint_.resize(s_.points.size());
        for (Index v = 0; v < static_cast<Index>(s_.points.size()); ++v) {
            if (v % (64 * kLook) == 0 && progress.cancelled()) return false;
            bool mixed = false;
            const Index own = label(leaving_[at(v)]);
            eachLeaving(v, [&](Index h) { mixed = mixed || label(h) != own; });
            if (!mixed) {
                constraint_[at(v)] = own < 0 ? Constraint::Free : Constraint::InFace;
                continue;
            }
            const auto ends = rimNeighbours(v);
            constraint_[at(v)] = ends && straight(v, *ends) ? Constraint::OnRim : Constraint::Fixed;
        }
        return true;
    }

    bool measure(const Progress& progress) {
        quadric_.resize(s_.points.size());
        for (std::size_t t = 0; t < s_.corners.size(); ++t) {
            if (t % (64 * kLook) == 0 && progress.cancelled()) return false;
            const auto [i, j, k] = s_.corners[t];
            const Vec3 cross = (point(j) - point(i)).cross(point(k) - point(i));
            const double doubleArea = cross.norm();
            if (!(doubleArea > 0.0)) continue;
            const Vec3 normal = cross / doubleArea;
            const double offset = normal.dot(point(i)), share = doubleArea / 6.0;
            Quadric q;
            q.A = share * normal * normal.transpose();
            q.b = share * offset * normal;
            q.c = share * offset * offset;
            q.weight = share;
            for (const Index v : {i, j, k}) quadric_[at(v)] += q;
        }
        return true;
    }

    /// The wanted size of edges at each vertex: that of a uniform mesh, less near rims that are finer and must stay.
    bool grade(const Progress& progress) {
        size_.assign(s_.points.size(), uniform_);
        using Reached = std::pair<double, Index>;
        std::priority_queue<Reached, std::vector<Reached>, std::greater<>> open;
        const auto reach = [&](Index v, double size) {
            if (size >= size_[at(v)]) return;
            size_[at(v)] = size;
            open.emplace(size, v);
        };
        for (Index h = 0; h < static_cast<Index>(twin_.size()); ++h)
            if (rim(h) && constraintOf(from(h)) == Constraint::Fixed && constraintOf(to(h)) == Constraint::Fixed) reach(from(h), (point(to(h)) - point(from(h))).norm());
        for (std::size_t v = 0; v < wanted_.size(); ++v) reach(static_cast<Index>(v), wanted_[v]);
        for (int pops = 0; !open.empty(); ++pops) {
            if (pops % (16 * kLook) == 0 && progress.cancelled()) return false;
            const auto [size, v] = open.top();
            open.pop();
            if (size > size_[at(v)]) continue;
            eachLeaving(v, [&, from = v, base = size](Index h) { reach(to(h), base + kGrading * (point(to(h)) - point(from)).norm()); });
        }
        // Two vertices at one place would otherwise want a size of nothing.
        for (double& size : size_) size = std::max(size, 1e-6 * uniform_);
        return true;
    }

    /// Where the vertex of a collapsed edge goes if it is free: least squares from all planes, near the middle along the surface.
    [[nodiscard]] Vec3 best(const Quadric& q, const Vec3& middle, const Vec3* volume, double missing) const {
        if (!(q.weight > 0.0)) return middle;
        Eigen::Matrix3d M = q.A;
        M.diagonal().array() += kMiddle * q.weight;
        const Eigen::LDLT<Eigen::Matrix3d> factor(M);
        Vec3 y = factor.solve(q.b - q.A * middle);
        if (volume) {  // volume . y = missing
            const Vec3 z = factor.solve(*volume);
            const double slope = volume->dot(z);
            if (slope > 0.0) y += z * ((missing - volume->dot(y)) / slope);
        }
        return middle + y;
    }

    void push(Index h) {
        const Index a = from(h), b = to(h);
        const Constraint low = std::min(constraintOf(a), constraintOf(b)), high = std::max(constraintOf(a), constraintOf(b));
        if (low == Constraint::Fixed || (low >= Constraint::OnRim && !rim(h))) return;
        const double squaredLength = (point(a) - point(b)).squaredNorm();
        Quadric q = quadric_[at(a)];
        q += quadric_[at(b)];
        double distance = 0.0;
        if (high == Constraint::Free) {
            const Vec3 middle = 0.5 * (point(a) + point(b)), x = best(q, middle, nullptr, 0.0);
            distance = q((x - middle).squaredNorm() <= squaredLength ? x : middle);
        } else if (low == high) {
            distance = std::min(q(point(a)), q(point(b)));
        } else {
            distance = q(point(constraintOf(a) == high ? a : b));
        }
        const double size = std::min(size_[at(a)], size_[at(b)]);
        const Index canonical = std::min(h, twin_[at(h)]);
        queue_.push({(squaredLength + kDistanceWeight * kDistanceWeight * distance) / (size * size), canonical, stamp_[at(canonical)]});
    }

    /// Collapses the edge if that keeps the topology and makes no bad triangle.
    void tryEdge(Index h) {
        Index gone = from(h), kept = to(h);
        if (constraintOf(gone) > constraintOf(kept) || (constraintOf(gone) == constraintOf(kept) && gone < kept)) std::swap(gone, kept), h = twin_[at(h)];
        if (!linked(h)) return;
        const Vec3 middle = 0.5 * (point(gone) + point(kept));
        const double length = (point(gone) - point(kept)).norm();
        struct Candidate {
            Vec3 point;
            Index place;
        };
        const Candidate ofKept{point(kept), s_.place[at(kept)]}, ofGone{point(gone), s_.place[at(gone)]};
        std::array<Candidate, 4> candidates{{ofKept}};
        std::size_t count = 1;
        if (constraintOf(kept) == Constraint::Free) {
            Quadric q = quadric_[at(gone)];
            q += quadric_[at(kept)];
            const auto [area, missing] = volumeAround(h, middle);
            Vec3 x = best(q, middle, &area, missing);
            if (!((x - middle).norm() <= length)) x = best(q, middle, nullptr, 0.0);
            candidates = {{{x, -1}, {middle, -1}, ofKept, ofGone}};
            count = length < kShort * size_[at(kept)] ? 4 : 2;
        } else if (constraintOf(gone) == constraintOf(kept)) {
            if (constraintOf(gone) == Constraint::OnRim && !slides(gone, kept)) {
                if (!slides(kept, gone)) return;
                candidates[0] = ofGone;
            } else if (constraintOf(gone) == Constraint::InFace) {
                candidates[1] = ofGone;
                count = 2;
            }
        } else if (constraintOf(gone) == Constraint::OnRim && !slides(gone, kept)) {
            return;
        }
        for (std::size_t i = 0; i < count; ++i)
            if (fits(h, candidates[i].point)) {
                perform(h, candidates[i].point, candidates[i].place);
                return;
            }
    }

    /// True where the rim stays the same line without v, whose neighbour along it is `into`.
    [[nodiscard]] bool slides(Index v, Index into) const {
        const auto ends = rimNeighbours(v);
        return ends && ((*ends)[0] == into || (*ends)[1] == into) && straight(v, *ends);
    }

    /// The link condition (Dey et al. 1999): the ends have no common neighbours but the apexes of their two triangles.
    bool linked(Index h) {
        const Index a = from(h), b = to(h), apexes[2] = {from(previous(h)), from(previous(twin_[at(h)]))};
        if (apexes[0] == apexes[1]) return false;
        eachLeaving(a, [&](Index g) { mark_[at(to(g))] = a; });
        int common = 0;
        eachLeaving(b, [&](Index g) { common += mark_[at(to(g))] == a ? 1 : 0; });
        eachLeaving(a, [&](Index g) { mark_[at(to(g))] = -1; });
        if (common != 2) return false;
        for (const Index apex : apexes) {
            int valence = 0;
            eachLeaving(apex, [&](Index) { ++valence; });
            if (valence <= 3) return false;
        }
        return true;
    }

    /// The volume, times 6, that the triangles around both ends enclose with `middle`, and its gradient by the place of the collapsed vertex.
    [[nodiscard]] std::pair<Vec3, double> volumeAround(Index h, const Vec3& middle) const {
        Vec3 area = Vec3::Zero();
        double volume = 0.0;
        const Index a = from(h), b = to(h);
        for (const Index v : {a, b})
            eachLeaving(v, [&](Index g) {
                const Index p = to(g), q = from(previous(g));
                const Vec3 cross = (point(p) - middle).cross(point(q) - middle);
                const bool both = p == a || p == b || q == a || q == b;  // vanishes, and is seen from both ends
                if (!both) area += cross;
                if (!both || v == a) volume += (point(v) - middle).dot(cross);
            });
        return {area, volume};
    }

    /// Whether the triangles around both ends stay good with x in the place of the ends.
    [[nodiscard]] bool fits(Index h, const Vec3& x) const {
        const Index a = from(h), b = to(h);
        const double limit = std::min(limit_[at(a)], limit_[at(b)]);
        double worstBefore = 1.0, worstAfter = 1.0;
        bool good = true;
        for (const Index v : {a, b})
            eachLeaving(v, [&](Index g) {
                if (!good) return;
                const Index p = to(g), q = from(previous(g));
                const Vec3 before = (point(p) - point(v)).cross(point(q) - point(v));
                const double areaBefore = before.norm();
                worstBefore = std::min(worstBefore, quality(point(v), point(p), point(q), areaBefore));
                if (p == a || p == b || q == a || q == b) return;
                // A free triangle between held vertices only would count as held, or leave no room between two faces.
                if (label(g) < 0 && constraintOf(v) == Constraint::Free && constraintOf(b) != Constraint::Free && constraintOf(p) != Constraint::Free && constraintOf(q) != Constraint::Free) {
                    good = false;
                    return;
                }
                const Vec3 after = (point(p) - x).cross(point(q) - x);
                const double areaAfter = after.norm();
                worstAfter = std::min(worstAfter, quality(x, point(p), point(q), areaAfter));
                good = areaAfter > 0.0 && after.dot(before) >= kTurn * areaAfter * areaBefore;
                const double allowed = std::min(limit, limit_[at(p)]);
                if (allowed < std::numeric_limits<double>::infinity()) {
                    const double length = (point(p) - x).norm();
                    good = good && (length <= allowed || length <= (point(p) - point(v)).norm());
                }
            });
        return good && worstAfter >= std::min(kPoor, worstBefore);
    }

    /// from(h) vanishes into to(h), which moves to x.
    void perform(Index h, const Vec3& x, Index place) {
        const Index gone = from(h), kept = to(h), other = twin_[at(h)];
        const Index n0 = twin_[at(next(h))], p0 = twin_[at(previous(h))], n1 = twin_[at(next(other))], p1 = twin_[at(previous(other))];
        std::vector<Index>& sides = scratch_;
        sides.clear();
        eachLeaving(gone, [&](Index g) { sides.push_back(g); });
        for (const Index g : sides) origin_[at(g)] = kept;
        for (const Index t : {h / 3, other / 3})
            for (Index c = 0; c < 3; ++c) origin_[at(3 * t + c)] = -1;
        twin_[at(n0)] = p0, twin_[at(p0)] = n0, twin_[at(n1)] = p1, twin_[at(p1)] = n1;
        for (const Index g : {n0, p0, n1, p1}) leaving_[at(from(g))] = g;
        s_.points[at(kept)] = x;
        s_.place[at(kept)] = place;
        quadric_[at(kept)] += quadric_[at(gone)];
        if (constraintOf(kept) == Constraint::Free) size_[at(kept)] = 0.5 * (size_[at(kept)] + size_[at(gone)]);
        limit_[at(kept)] = std::min(limit_[at(kept)], limit_[at(gone)]);
        became_[at(gone)] = kept;
        --left_;
        eachLeaving(kept, [&](Index g) {
            ++stamp_[at(g)], ++stamp_[at(twin_[at(g)])];
            push(g);
        });
    }

    LabelledSurface s_;
    std::vector<double> limit_;
    double uniform_;
    std::vector<double> tolerance_, wanted_;
    std::vector<Index> origin_, twin_;  ///< per half-edge; origin -1: gone
    std::vector<Index> leaving_;        ///< per vertex: a half-edge that starts there
    std::vector<Constraint> constraint_;
    std::vector<Quadric> quadric_;
    std::vector<double> size_;
    std::vector<Index> became_, mark_, scratch_;
    std::vector<std::uint32_t> stamp_;  ///< per half-edge: entries with an older one are out of date
    std::priority_queue<Entry> queue_;
    int left_ = 0;
};

EdgeCollapse::EdgeCollapse(const LabelledSurface& surface, std::vector<double> limit, double uniform, std::vector<double> tolerance, std::vector<double> size)
    : state_(std::make_unique<State>(surface, std::move(limit), uniform, std::move(tolerance), std::move(size))) {}
EdgeCollapse::~EdgeCollapse() = default;
bool EdgeCollapse::connect(const Progress& progress) { return state_->connect(progress); }
bool EdgeCollapse::run(int vertices, const Progress& progress) { return state_->run(vertices, progress); }
LabelledSurface EdgeCollapse::result(std::vector<std::int32_t>& number) const { return state_->result(number); }

}  // namespace imomushi
