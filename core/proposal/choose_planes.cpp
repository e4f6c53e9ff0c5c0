// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/proposal/choose_planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <utility>

#include "core/proposal/mirror_plane.h"

namespace imomushi {
namespace {

/// The first plane is chosen unless another one misplaces this part of what it does, or less, and the difference is this part of the limb's flesh.
constexpr double kBetter = 0.85;
constexpr double kWorthIt = 0.05;
/// A plane counts if it misplaces less than no cut at all; or takes this part of what belongs beyond it, or more, and not more than so many times as much of what does not: a hat may belong to a root at the feet.
constexpr double kLeastOfIt = 0.5, kMostOther = 2.0;
/// Two sections cross an edge at least this part of its length apart.
constexpr double kApart = 0.01;
/// The search for places that go together: after so many steps without a better answer it ends; a cut that was just placed stays for some steps, and what was often moved is moved less readily. It starts anew so many times, in other orders.
constexpr int kPatience = 80, kStays = 6, kStarts = 32;
constexpr double kOften = 0.05;  // of a cut that is lost

/// Where a plane would cut the body, and what that would take.
struct Site {
    CutPlane plane;
    std::vector<std::pair<std::int32_t, double>> edges;  // that it crosses, ascending, and where
    std::vector<std::int32_t> vertices;                  // that it passes, ascending
    std::vector<std::int32_t> triangles;                 // that it crosses, ascending
    std::vector<std::pair<std::int32_t, std::array<Vec3, 2>>> segments;
    std::vector<std::uint64_t> taken;  // a bit for each vertex of the body in front of it
    double volume = 0.0;   // in front of the section, in parts of the whole
    double wrong = 0.0;    // flesh that is misplaced
    double without = 0.0;  // flesh that is misplaced by no cut at all
};

/// Planes for one cut, or for two that mirror each other: one site for each of its cuts.
struct Place {
    std::vector<Site> sites;
    double cost = 0.0;
    double gain = 0.0;                   // what it makes better against no cut
    std::size_t number = 0;              // among all places
    std::vector<std::int8_t> together;   // by the number of another place: 1 if both work beside each other, -1 if not, 0: nobody asked
};

struct Unit {
    std::vector<std::size_t> cuts;
    std::vector<Place> places;
    std::vector<std::size_t> order;  // of the places, ascending by what they misplace
    bool all = false;                // more planes are among them already
    int chosen = -1;
};

class Chooser {
public:
    Chooser(const CutSurface& surface, std::span<const double> volume, std::span<const PlaneWish> cuts, const std::optional<CutPlane>& mirror, double least, const Progress& progress)
        : surface_(surface), volume_(volume), cuts_(cuts), mirror_(mirror), least_(least), progress_(progress) {
        std::vector<char> used(cuts.size(), 0);
        for (std::size_t c = 0; c < cuts.size(); ++c) {
            if (used[c]) continue;
            Unit unit;
            unit.cuts.push_back(c);
            if (mirror && cuts[c].twin >= 0 && !used[static_cast<std::size_t>(cuts[c].twin)]) unit.cuts.push_back(static_cast<std::size_t>(cuts[c].twin));
            for (const std::size_t of : unit.cuts) used[of] = 1;
            units_.push_back(std::move(unit));
        }
    }

    std::vector<std::optional<CutPlane>> choose() {
        for (std::size_t u = 0; u < units_.size() && !progress_.cancelled(); ++u) {
            progress_.report("skeleton", static_cast<double>(u) / static_cast<double>(units_.size()));
            add(units_[u], false);
        }
        search();
        std::vector<std::optional<CutPlane>> planes(cuts_.size());
        for (const Unit& unit : units_)
            for (std::size_t i = 0; unit.chosen >= 0 && i < unit.cuts.size(); ++i) planes[unit.cuts[i]] = placeOf(unit).sites[i].plane;
        return planes;
    }

private:
    [[nodiscard]] static const Place& placeOf(const Unit& unit) { return unit.places[static_cast<std::size_t>(unit.chosen)]; }

    /// What a plane would do; nothing where it does not cut off a part of the body that belongs beyond it.
    [[nodiscard]] std::optional<Site> siteOf(const CutPlane& plane, const std::vector<double>& own) {
        const auto section = findSection(surface_, plane);
        if (!section) return std::nullopt;
        const TriangleMesh& mesh = surface_.mesh;
        Site site;
        site.plane = plane;
        std::vector<std::int32_t> open;
        const auto inFront = [&](std::int32_t v) { return plane.normal.dot(Vec3(mesh.vertices.row(v).transpose()) - plane.origin) > 0.0; };
        for (std::size_t l = 0; l < section->loops.size(); ++l) {
            const auto& loop = section->loops[l];
            for (std::size_t i = 0; i < loop.size(); ++i) {
                if (loop[i].edge >= 0) site.edges.emplace_back(loop[i].edge, loop[i].along);
                if (loop[i].vertex >= 0) site.vertices.push_back(loop[i].vertex);
                const std::int32_t f = section->sides[l][i].triangle;
                if (f < 0) continue;
                site.triangles.push_back(f);
                site.segments.push_back({f, {loop[i].place, loop[(i + 1) % loop.size()].place}});
            }
        }
        std::sort(site.edges.begin(), site.edges.end());
        std::sort(site.vertices.begin(), site.vertices.end());
        std::sort(site.triangles.begin(), site.triangles.end());
        std::sort(site.segments.begin(), site.segments.end(), [](const auto& a, const auto& b) { return a.first < b.first; });

        // Everything in front of the loops that hangs together there, and nothing behind them.
        const auto vertices = static_cast<std::size_t>(mesh.vertices.rows());
        site.taken.assign((vertices + 63) / 64, 0);
        const auto bit = [](std::int32_t v) { return std::uint64_t{1} << (static_cast<std::size_t>(v) % 64); };
        const auto taken = [&](std::int32_t v) { return (site.taken[static_cast<std::size_t>(v) / 64] & bit(v)) != 0; };
        crossed_.assign(static_cast<std::size_t>(surface_.edges.size()), 0);
        passed_.assign(vertices, 0);
        for (const auto& [e, along] : site.edges) crossed_[static_cast<std::size_t>(e)] = 1;
        for (const std::int32_t v : site.vertices) passed_[static_cast<std::size_t>(v)] = 1;
        const auto take = [&](std::int32_t v) {
            if (taken(v) || passed_[static_cast<std::size_t>(v)] != 0) return;
            site.taken[static_cast<std::size_t>(v) / 64] |= bit(v);
            open.push_back(v);
        };
        for (const auto& [e, along] : site.edges) {
            const EdgeUse& use = surface_.edges.uses(e)[0];
            take(inFront(use.low) ? use.low : use.high);
        }
        for (const std::int32_t v : site.vertices)
            for (const std::int32_t corner : surface_.corners.at(v))
                for (int k = 1; k < 3; ++k) {
                    const std::int32_t w = mesh.triangles(corner / 3, (corner + k) % 3);
                    if (inFront(w)) take(w);
                }
        while (!open.empty()) {
            const std::int32_t v = open.back();
            open.pop_back();
            for (const std::int32_t corner : surface_.corners.at(v)) {
                const std::int32_t f = corner / 3;
                const int k = corner % 3;
                if (crossed_[static_cast<std::size_t>(surface_.edges.edgeOf(f, k))] == 0) take(mesh.triangles(f, (k + 1) % 3));
            }
        }
        for (const auto& [e, along] : site.edges) {
            const EdgeUse& use = surface_.edges.uses(e)[0];
            if (taken(use.low) && taken(use.high)) return std::nullopt;  // all hangs together around the section
        }
        double flesh = 0.0, right = 0.0;  // taken
        for (std::size_t v = 0; v < vertices; ++v) {
            site.without += volume_[v] * own[v];
            if (!taken(static_cast<std::int32_t>(v))) continue;
            flesh += volume_[v];
            right += volume_[v] * own[v];
        }
        site.volume = volumeInFront(site, taken);
        // The flesh of a vertex lies beneath it, of a shallow slice mostly behind the plane.
        const double part = flesh > 0.0 ? std::clamp(site.volume / flesh, 0.0, 1.0) : 0.0;
        right *= part;
        flesh *= part;
        site.wrong = site.without - right + (flesh - right);
        if (site.volume < least_ || right <= 0.0) return std::nullopt;
        if (site.wrong >= site.without && (right < kLeastOfIt * site.without || flesh - right > kMostOther * site.without)) return std::nullopt;
        return site;
    }

    /// In parts of the whole. The section itself adds nothing, seen from a point of its plane.
    template <typename Taken>
    [[nodiscard]] double volumeInFront(const Site& site, const Taken& taken) const {
        const TriangleMesh& mesh = surface_.mesh;
        double sum = 0.0;
        const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) { sum += a.dot(b.cross(c)); };
        for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
            std::array<Vec3, 3> at;
            int in = 0;
            for (int k = 0; k < 3; ++k) {
                at[static_cast<std::size_t>(k)] = mesh.vertices.row(mesh.triangles(f, k)).transpose() - site.plane.origin;
                in += taken(mesh.triangles(f, k)) || passed_[static_cast<std::size_t>(mesh.triangles(f, k))] != 0;
            }
            if (in == 0) continue;
            if (!std::binary_search(site.triangles.begin(), site.triangles.end(), static_cast<std::int32_t>(f))) {
                if (in == 3 && (taken(mesh.triangles(f, 0)) || taken(mesh.triangles(f, 1)) || taken(mesh.triangles(f, 2)))) add(at[0], at[1], at[2]);
                continue;
            }
            // The part of a triangle in front of the plane: a fan of up to four corners.
            std::array<Vec3, 4> part;
            std::size_t count = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const double here = site.plane.normal.dot(at[k]), next = site.plane.normal.dot(at[(k + 1) % 3]);
                if (here > 0.0) part[count++] = at[k];
                if (here * next < 0.0) part[count++] = at[k] + here / (here - next) * (at[(k + 1) % 3] - at[k]);
            }
            for (std::size_t i = 2; i < count; ++i) add(part[0], part[i - 1], part[i]);
        }
        return sum / (6.0 * surface_.volume);
    }

    void add(Unit& unit, bool more) {
        const PlaneWish& first = cuts_[unit.cuts[0]];
        const std::vector<CutPlane>& planes = more ? first.more : first.planes;
        for (std::size_t p = 0; p < planes.size(); ++p) {
            const CutPlane& plane = planes[p];
            if (progress_.cancelled()) return;
            Place place;
            for (std::size_t i = 0; i < unit.cuts.size(); ++i) {
                auto site = siteOf(i == 0 ? plane : CutPlane{mirroredPoint(*mirror_, plane.origin), mirroredDirection(*mirror_, plane.normal)}, cuts_[unit.cuts[i]].own);
                if (!site) break;
                place.cost += more || p > 0 ? site->wrong : std::min(kBetter * site->wrong, site->wrong - kWorthIt * site->without);
                place.sites.push_back(std::move(*site));
            }
            if (place.sites.size() < unit.cuts.size()) continue;
            if (unit.cuts.size() == 2 && !together(unit.cuts[0], place.sites[0], unit.cuts[1], place.sites[1])) continue;
            for (const Site& site : place.sites) place.gain += 1.0 + site.without;
            place.gain -= place.cost;
            place.number = numbers_++;
            unit.places.push_back(std::move(place));
        }
        while (unit.order.size() < unit.places.size()) unit.order.push_back(unit.order.size());
        std::stable_sort(unit.order.begin(), unit.order.end(), [&](std::size_t a, std::size_t b) { return unit.places[a].cost < unit.places[b].cost; });
        unit.all = unit.all || more;
    }

    [[nodiscard]] bool isBeyond(std::size_t inner, std::size_t outer) const {
        for (int c = cuts_[outer].parent; c >= 0; c = cuts_[static_cast<std::size_t>(c)].parent)
            if (c == static_cast<int>(inner)) return true;
        return false;
    }

    /// Whether two cuts work beside each other.
    [[nodiscard]] bool together(std::size_t a, const Site& atA, std::size_t b, const Site& atB) const {
        if (isBeyond(b, a)) return together(b, atB, a, atA);
        bool apart = true, bInA = true, aInB = true;
        for (std::size_t i = 0; i < atA.taken.size(); ++i) {
            const std::uint64_t inA = atA.taken[i], inB = atB.taken[i];
            apart = apart && (inA & inB) == 0;
            bInA = bInA && (inB & ~inA) == 0;
            aInB = aInB && (inA & ~inB) == 0;
        }
        // A hand may hang on the root, beyond the arm all the same.
        if (isBeyond(a, b) ? !bInA : !apart && !bInA && !aInB) return false;
        if (!apart && std::abs(atA.volume - atB.volume) < least_) return false;
        return !meet(atA, atB);
    }

    [[nodiscard]] bool meet(const Site& a, const Site& b) const {
        for (auto i = a.edges.begin(), j = b.edges.begin(); i != a.edges.end() && j != b.edges.end();) {
            if (i->first == j->first && std::abs(i->second - j->second) < kApart) return true;
            i->first < j->first ? ++i : ++j;
        }
        const auto passes = [&](const Site& one, const Site& other) {
            for (const std::int32_t v : one.vertices) {
                if (std::binary_search(other.vertices.begin(), other.vertices.end(), v)) return true;
                for (const std::int32_t corner : surface_.corners.at(v))
                    if (std::binary_search(other.triangles.begin(), other.triangles.end(), corner / 3)) return true;
            }
            return false;
        };
        if (passes(a, b) || passes(b, a)) return true;
        // In a triangle that both cross, the one's ends lie on one side of the other.
        for (auto i = a.segments.begin(), j = b.segments.begin(); i != a.segments.end() && j != b.segments.end();) {
            if (i->first != j->first) {
                i->first < j->first ? ++i : ++j;
                continue;
            }
            for (auto other = j; other != b.segments.end() && other->first == i->first; ++other) {
                const double first = a.plane.normal.dot(other->second[0] - a.plane.origin), second = a.plane.normal.dot(other->second[1] - a.plane.origin);
                if (!(first * second > 0.0)) return true;
            }
            ++i;
        }
        return false;
    }

    /// Whether a place of a unit works beside what another one has chosen.
    [[nodiscard]] bool together(const Unit& unit, Place& place, const Unit& other) const {
        if (other.chosen < 0 || &other == &unit) return true;
        const Place& there = placeOf(other);
        if (place.together.size() <= there.number) place.together.resize(numbers_, 0);
        std::int8_t& known = place.together[there.number];
        if (known == 0) {
            known = 1;
            for (std::size_t i = 0; i < unit.cuts.size(); ++i)
                for (std::size_t j = 0; j < other.cuts.size(); ++j)
                    if (known > 0 && !together(unit.cuts[i], place.sites[i], other.cuts[j], there.sites[j])) known = -1;
        }
        return known > 0;
    }

    /// Chooses the best place beside those of the other units, if there is one.
    void placeFreely(Unit& unit) {
        for (const std::size_t p : unit.order)
            if (std::all_of(units_.begin(), units_.end(), [&](const Unit& other) { return together(unit, unit.places[p], other); })) {
                unit.chosen = static_cast<int>(p);
                return;
            }
    }

    [[nodiscard]] double gained() const {
        double sum = 0.0;
        for (const Unit& unit : units_)
            if (unit.chosen >= 0) sum += placeOf(unit).gain;
        return sum;
    }

    /// The best of several searches: the first one places the cuts as they come, the others in orders of their own.
    void search() {
        std::vector<std::size_t> order(units_.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::minstd_rand random(1);
        std::vector<int> best;
        double most = -1.0;
        const auto keep = [&] {
            const double now = gained();
            if (now <= most + 1e-9) return false;
            most = now;
            best.clear();
            for (const Unit& unit : units_) best.push_back(unit.chosen);
            return true;
        };
        for (int start = 0; start < kStarts && !progress_.cancelled(); ++start) {
            for (Unit& unit : units_) unit.chosen = -1;
            for (const std::size_t u : order) placeFreely(units_[u]);
            improve(keep);
            if (std::all_of(units_.begin(), units_.end(), [](const Unit& unit) { return unit.chosen >= 0; })) break;
            for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
        }
        for (std::size_t u = 0; u < best.size(); ++u) units_[u].chosen = best[u];
        for (bool better = true; better && !progress_.cancelled();) {
            better = false;
            for (Unit& unit : units_) {
                if (unit.chosen < 0) continue;
                const int before = unit.chosen;
                placeFreely(unit);
                better = better || unit.chosen != before;
            }
        }
    }

    /// Places what has no place, though others lose theirs and look for another one: by what is gained most, in a tabu search. `keep` is asked whether what is chosen now is the best.
    template <typename Keep>
    void improve(const Keep& keep) {
        std::vector<int> stays(units_.size(), 0), moved(units_.size(), 0);
        keep();
        for (int step = 0, since = 0; since < kPatience && !progress_.cancelled(); ++step, ++since) {
            std::size_t unit = units_.size();
            int to = -1;
            double gain = -1e8;
            for (std::size_t u = 0; u < units_.size(); ++u) {
                if (units_[u].chosen >= 0) continue;
                if (!units_[u].all) add(units_[u], true);
                for (const std::size_t p : units_[u].order) {
                    double sum = units_[u].places[p].gain;
                    for (std::size_t o = 0; o < units_.size() && sum > gain; ++o) {
                        if (together(units_[u], units_[u].places[p], units_[o])) continue;
                        sum -= stays[o] > step ? 1e9 : placeOf(units_[o]).gain + kOften * moved[o];
                    }
                    if (sum <= gain) continue;
                    gain = sum;
                    unit = u;
                    to = static_cast<int>(p);
                }
            }
            if (to < 0) break;
            for (std::size_t o = 0; o < units_.size(); ++o)
                if (!together(units_[unit], units_[unit].places[static_cast<std::size_t>(to)], units_[o])) {
                    units_[o].chosen = -1;
                    ++moved[o];
                }
            units_[unit].chosen = to;
            stays[unit] = step + kStays;
            if (keep()) since = 0;
        }
    }

    const CutSurface& surface_;
    std::span<const double> volume_;
    std::span<const PlaneWish> cuts_;
    const std::optional<CutPlane>& mirror_;
    double least_;
    const Progress& progress_;
    std::vector<Unit> units_;
    std::size_t numbers_ = 0;  // of places
    std::vector<char> crossed_, passed_;  // edges and vertices of the body, by the section that is looked at
};

}  // namespace

std::vector<std::optional<CutPlane>> choosePlanes(const CutSurface& surface, std::span<const double> volume, std::span<const PlaneWish> cuts, const std::optional<CutPlane>& mirror,
                                                  double least, const Progress& progress) {
    return Chooser(surface, volume, cuts, mirror, least, progress).choose();
}

}  // namespace imomushi
