// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/cut_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>

#include "core/base/union_find.h"
#include "core/body/convex_polygon.h"
#include "core/mesh/edge_key.h"
#include "core/mesh/health.h"
#include "core/mesh/winding_number.h"

namespace imomushi {
namespace {

/// Two cuts cross an edge at least this part of its length apart: the strip between them must not be a sliver.
constexpr double kGap = 1e-3;
/// A piece has at least this part of the body's volume, or it is rounding.
constexpr double kLeastVolume = 1e-9;

using Refused = tl::unexpected<CutRefusal>;

Refused refuse(int cut, int other, const char* code, std::string message) {
    CutRefusal refusal;
    refusal.code = code;
    refusal.message = std::move(message);
    refusal.cut = cut;
    refusal.other = other;
    return Refused(std::move(refusal));
}

Refused touching(int a, int b) {
    return refuse(std::max(a, b), std::min(a, b), "cuts-touch", "The cut touches another cut or comes too near to it; move one of them away.");
}

/// A point on an edge of the body.
struct EdgePoint {
    double along = 0.0;  // from the low vertex
    std::int32_t id = 0;
    int cut = 0;
};

/// A cut's way through a triangle.
struct Chord {
    int cut = 0;
    std::vector<std::int32_t> ids;  // from one side of the triangle to another, its front part on the left
};

/// A triangle of the body, or a part of it. Without ids: the triangle itself.
struct Polygon {
    std::int32_t triangle = 0;
    std::vector<std::int32_t> ids;
};

/// Points have ids: the vertices of the body, then what each cut adds. The order of ids of two points does not depend on other cuts than their own.
class Assembly {
public:
    Assembly(const CutSurface& surface, std::span<const PreparedCut> cuts, int only) : surface_(surface), mesh_(surface.mesh), cuts_(cuts), only_(only) {}

    tl::expected<std::vector<BodyPiece>, CutRefusal> run() {
        if (auto refusal = divide()) return Refused(std::move(*refusal));
        if (auto refusal = connect()) return Refused(std::move(*refusal));
        return pieces();
    }

    using Refusal = std::optional<CutRefusal>;

    /// What is refused here is that cuts touch.
    Refusal divide() {
        for (const auto step : {&Assembly::number, &Assembly::checkApart, &Assembly::split})
            if (auto refusal = (this->*step)()) return refusal;
        return {};
    }

private:

    [[nodiscard]] std::int32_t bodyVertices() const { return static_cast<std::int32_t>(mesh_.vertices.rows()); }
    [[nodiscard]] Vec3 placeOf(std::int32_t id) const {
        if (id >= bodyVertices()) return added_[static_cast<std::size_t>(id - bodyVertices())];
        const auto it = moved_.find(id);
        return it == moved_.end() ? Vec3(mesh_.vertices.row(id).transpose()) : it->second;
    }

    /// Gives ids to the points of all caps, and hands the sides of their loops to edges and triangles.
    Refusal number() {
        std::unordered_map<std::int32_t, int> owner;  // of vertices of the body on a cut
        for (int c = 0; c < static_cast<int>(cuts_.size()); ++c) {
            const auto& [section, region] = cuts_[static_cast<std::size_t>(c)];
            for (const auto& [v, place] : section.moved) moved_[v] = place;
            std::vector<std::int32_t>& ids = capIds_.emplace_back();
            const auto add = [&](const Vec3& place) {
                ids.push_back(bodyVertices() + static_cast<std::int32_t>(added_.size()));
                added_.push_back(place);
            };
            for (const auto& loop : section.loops)
                for (const SectionPoint& point : loop) {
                    if (point.vertex >= 0) {
                        const auto [it, fresh] = owner.try_emplace(point.vertex, c);
                        if (!fresh && it->second != c) return touching(c, it->second).value();
                        ids.push_back(point.vertex);
                    } else {
                        add(point.place);
                        onEdge_[point.edge].push_back({point.along, ids.back(), c});
                    }
                }
            for (const Eigen::Vector2d& p : region.added) add(section.lifted(p));
            addSides(c);
        }
        return {};
    }

    void addSides(int c) {
        const auto& [section, region] = cuts_[static_cast<std::size_t>(c)];
        const std::vector<std::int32_t>& ids = capIds_.back();
        std::size_t begin = 0, s = 0;
        for (const auto& sides : section.sides) {
            for (std::size_t i = 0; i < sides.size(); ++i, ++s) {
                Chord chord{c, {ids[s]}};
                if (!region.onSide.empty())
                    for (const std::int32_t p : region.onSide[s]) chord.ids.push_back(ids[static_cast<std::size_t>(p)]);
                chord.ids.push_back(ids[i + 1 < sides.size() ? s + 1 : begin]);
                for (std::size_t k = 0; k + 1 < chord.ids.size(); ++k) cutSides_.push_back({chord.ids[k], chord.ids[k + 1], c});
                if (sides[i].triangle >= 0) {
                    chords_[sides[i].triangle].push_back(std::move(chord));
                    continue;
                }
                const EdgeUse& use = surface_.edges.uses(sides[i].edge)[0];
                if (use.low != chord.ids.front()) std::reverse(chord.ids.begin(), chord.ids.end());
                std::vector<EdgePoint>& points = onEdge_[sides[i].edge];
                for (std::size_t k = 1; k + 1 < chord.ids.size(); ++k)
                    points.push_back({static_cast<double>(k) / static_cast<double>(chord.ids.size() - 1), chord.ids[k], c});
                runs_[sides[i].edge] = c;
            }
            begin += sides.size();
        }
    }

    /// Cuts must not meet, and where one moved a vertex, no other may rest on the triangles around it: what it makes would change with the first.
    Refusal checkApart() {
        for (auto& [edge, points] : onEdge_) {
            std::sort(points.begin(), points.end(), [](const EdgePoint& a, const EdgePoint& b) { return std::pair(a.along, a.id) < std::pair(b.along, b.id); });
            for (std::size_t i = 0; i + 1 < points.size(); ++i)
                if (points[i].cut != points[i + 1].cut && points[i + 1].along - points[i].along < kGap)
                    return touching(points[i].cut, points[i + 1].cut).value();
            const auto run = runs_.find(edge);
            if (run == runs_.end()) continue;
            for (const EdgePoint& p : points)
                if (p.cut != run->second) return touching(p.cut, run->second).value();
        }
        std::unordered_map<std::int32_t, int> movedAt;
        for (int c = 0; c < static_cast<int>(cuts_.size()); ++c)
            for (const auto& [v, place] : cuts_[static_cast<std::size_t>(c)].section.moved)
                for (const std::int32_t corner : surface_.corners.at(v)) {
                    const auto [it, fresh] = movedAt.try_emplace(corner / 3, c);
                    if (!fresh && it->second != c) return touching(c, it->second).value();
                }
        for (const auto& [edge, points] : onEdge_)
            for (const EdgePoint& p : points)
                for (const EdgeUse& use : surface_.edges.uses(edge)) {
                    const auto it = movedAt.find(use.triangle);
                    if (it != movedAt.end() && it->second != p.cut) return touching(p.cut, it->second).value();
                }
        return {};
    }

    /// Makes the polygons, in the order of triangles.
    Refusal split() {
        std::vector<char> touched(static_cast<std::size_t>(mesh_.triangles.rows()), 0);
        for (const auto& [f, chords] : chords_) touched[static_cast<std::size_t>(f)] = 1;
        for (const auto& [edge, points] : onEdge_)
            for (const EdgeUse& use : surface_.edges.uses(edge)) touched[static_cast<std::size_t>(use.triangle)] = 1;
        whole_.assign(touched.size(), -1);
        for (std::int32_t f = 0; f < mesh_.triangles.rows(); ++f) {
            if (touched[static_cast<std::size_t>(f)] == 0) {
                whole_[static_cast<std::size_t>(f)] = static_cast<std::int32_t>(polygons_.size());
                polygons_.push_back({f, {}});
                continue;
            }
            std::vector<std::vector<std::int32_t>> parts{rimOf(f)};
            const auto chords = chords_.find(f);
            if (chords != chords_.end())
                for (const Chord& chord : chords->second)
                    if (!splitBy(chord, parts)) {
                        const int other = chord.cut == chords->second[0].cut ? chords->second.back().cut : chords->second[0].cut;
                        return touching(chord.cut, other).value();
                    }
            for (auto& part : parts)
                if (part.size() > 3 || std::any_of(part.begin(), part.end(), [&](std::int32_t id) { return id >= bodyVertices(); }))
                    std::rotate(part.begin(), std::min_element(part.begin(), part.end()), part.end());
            std::sort(parts.begin(), parts.end());
            for (auto& part : parts) polygons_.push_back({f, std::move(part)});
        }
        return {};
    }

    /// The corners of a triangle with all points on its sides.
    [[nodiscard]] std::vector<std::int32_t> rimOf(std::int32_t f) const {
        std::vector<std::int32_t> rim;
        for (int k = 0; k < 3; ++k) {
            rim.push_back(mesh_.triangles(f, k));
            const auto at = onEdge_.find(surface_.edges.edgeOf(f, k));
            if (at == onEdge_.end()) continue;
            const std::size_t before = rim.size();
            for (const EdgePoint& p : at->second) rim.push_back(p.id);
            if (mesh_.triangles(f, k) > mesh_.triangles(f, (k + 1) % 3)) std::reverse(rim.begin() + static_cast<std::ptrdiff_t>(before), rim.end());
        }
        return rim;
    }

    /// Splits the part in which both ends of the chord are; false: there is none.
    static bool splitBy(const Chord& chord, std::vector<std::vector<std::int32_t>>& parts) {
        for (auto& part : parts) {
            const auto from = std::find(part.begin(), part.end(), chord.ids.front());
            if (from == part.end() || std::find(part.begin(), part.end(), chord.ids.back()) == part.end()) continue;
            std::rotate(part.begin(), from, part.end());
            const auto to = std::find(part.begin(), part.end(), chord.ids.back());
            std::vector<std::int32_t> front(to, part.end());  // ... back to the first point, and along the chord
            front.insert(front.end(), chord.ids.begin(), chord.ids.end() - 1);
            part.erase(to + 1, part.end());
            part.insert(part.end(), chord.ids.rbegin() + 1, chord.ids.rend() - 1);
            parts.push_back(std::move(front));
            return true;
        }
        return false;
    }

    template <class Visit>
    void forSides(const Polygon& polygon, Visit visit) const {
        if (polygon.ids.empty())
            for (int k = 0; k < 3; ++k) visit(mesh_.triangles(polygon.triangle, k), mesh_.triangles(polygon.triangle, (k + 1) % 3));
        else
            for (std::size_t k = 0; k < polygon.ids.size(); ++k) visit(polygon.ids[k], polygon.ids[(k + 1) % polygon.ids.size()]);
    }

    /// Finds what hangs together.
    Refusal connect() {
        std::unordered_map<std::uint64_t, std::int32_t> at;  // sides of polygons, without those between two whole triangles
        sets_ = UnionFind(polygons_.size());
        for (std::size_t p = 0; p < polygons_.size(); ++p) {
            const Polygon& polygon = polygons_[p];
            const auto self = static_cast<std::int32_t>(p);
            int k = 0;
            forSides(polygon, [&](std::int32_t a, std::int32_t b) {
                if (polygon.ids.empty()) {
                    const auto uses = surface_.edges.uses(surface_.edges.edgeOf(polygon.triangle, k++));
                    const std::int32_t beside = whole_[static_cast<std::size_t>(uses[0].triangle == polygon.triangle ? uses[1].triangle : uses[0].triangle)];
                    if (beside >= 0) {
                        sets_.unite(self, beside);
                        return;
                    }
                }
                at[sideKey(a, b)] = self;
            });
        }
        std::unordered_map<std::uint64_t, int> onCut;
        front_.assign(cuts_.size(), -1);
        back_.assign(cuts_.size(), -1);
        for (const CutSide& side : cutSides_) {
            const auto inFront = at.find(sideKey(side.from, side.to)), behind = at.find(sideKey(side.to, side.from));
            if (inFront == at.end() || behind == at.end())
                return refuse(side.cut, -1, "section-touches-itself",
                              "The section touches itself, so that the pieces would hang together there; move or turn the plane a little.")
                    .value();
            onCut[edgeKey(side.from, side.to)] = side.cut;
            for (auto [first, polygon] : {std::pair(&front_, inFront->second), std::pair(&back_, behind->second)}) {
                std::int32_t& one = (*first)[static_cast<std::size_t>(side.cut)];
                if (one < 0) one = polygon;
                sets_.unite(one, polygon);
            }
        }
        for (const auto& [key, polygon] : at) {
            const auto from = static_cast<std::int32_t>(key >> 32), to = static_cast<std::int32_t>(key & 0xffffffffu);
            if (from > to || onCut.contains(key)) continue;
            const auto beside = at.find(sideKey(to, from));
            if (beside != at.end()) sets_.unite(polygon, beside->second);
        }
        for (std::size_t c = 0; c < cuts_.size(); ++c)
            if (sets_.find(front_[c]) == sets_.find(back_[c]))
                return refuse(static_cast<int>(c), -1, "does-not-separate",
                              "The body still hangs together around this cut; cut the ring in a second place too, or move the plane to where it cuts something "
                              "off.")
                    .value();
        return {};
    }

    [[nodiscard]] std::map<std::int32_t, std::vector<std::int32_t>> groups() {
        std::map<std::int32_t, std::vector<std::int32_t>> result;
        for (std::int32_t p = 0; p < static_cast<std::int32_t>(polygons_.size()); ++p) result[sets_.find(p)].push_back(p);
        return result;
    }

    /// Joins closed surfaces that no cut meets to the piece that they lie in, or to the nearest one.
    void placeShells() {
        auto all = groups();
        if (cuts_.empty()) {
            for (const auto& [root, members] : all) sets_.unite(all.begin()->first, root);
            return;
        }
        std::map<std::int32_t, std::vector<std::int32_t>> shells = all;
        for (const auto& side : {front_, back_})
            for (const std::int32_t p : side) shells.erase(sets_.find(p));
        if (shells.empty()) return;
        std::vector<std::pair<std::int32_t, TriangleMesh>> cut;
        std::vector<std::int32_t> pieceOf(static_cast<std::size_t>(bodyVertices()), -1);
        for (const auto& [root, members] : all) {
            if (shells.contains(root)) continue;
            for (const std::int32_t p : members)
                forSides(polygons_[static_cast<std::size_t>(p)], [&, piece = root](std::int32_t id, std::int32_t) {
                    if (id < bodyVertices()) pieceOf[static_cast<std::size_t>(id)] = piece;
                });
            cut.emplace_back(root, build(root, members).body);
        }
        for (const auto& [root, members] : shells) {
            const Vec3 place = mesh_.vertices.row(mesh_.triangles(polygons_[static_cast<std::size_t>(members[0])].triangle, 0)).transpose();
            std::int32_t home = -1;
            for (const auto& [piece, body] : cut)
                if (home < 0 && windingNumber(body, place) > 0.5) home = piece;
            double nearest = HUGE_VAL;
            for (std::int32_t v = 0; v < bodyVertices() && (home < 0 || nearest < HUGE_VAL); ++v) {
                const double squared = (mesh_.vertices.row(v).transpose() - place).squaredNorm();
                if (pieceOf[static_cast<std::size_t>(v)] >= 0 && squared < nearest) nearest = squared, home = pieceOf[static_cast<std::size_t>(v)];
            }
            sets_.unite(home < 0 ? cut[0].first : home, root);
        }
    }

    tl::expected<std::vector<BodyPiece>, CutRefusal> pieces() {
        placeShells();
        std::vector<BodyPiece> result;
        for (const auto& [root, members] : groups()) {
            if (only_ >= 0 && root != sets_.find(front_[static_cast<std::size_t>(only_)]) && root != sets_.find(back_[static_cast<std::size_t>(only_)])) continue;
            BodyPiece piece = build(root, members);
            const MeshFacts facts = meshFacts(piece.body);
            if (!piece.caps.empty()) {
                const BodyPiece::Cap& cap = piece.caps[0];
                if (!facts.closed)
                    return refuse(cap.cut, -1, "section-touches-itself",
                                  "The section touches the surface elsewhere, so that a piece would not be closed; move or turn the plane a little.");
                if (!(facts.volume > kLeastVolume * std::abs(surface_.volume)))
                    return refuse(cap.cut, -1, "empty-piece",
                                  std::string("The piece ") + (cap.front ? "in front of" : "behind") +
                                      " the cut would have no volume; move the plane deeper into the body.");
            }
            result.push_back(std::move(piece));
        }
        const auto lowest = [](const BodyPiece& p) { return p.source[0] < 0 ? std::numeric_limits<std::int32_t>::max() : p.source[0]; };
        std::stable_sort(result.begin(), result.end(), [&](const BodyPiece& a, const BodyPiece& b) { return lowest(a) < lowest(b); });
        return result;
    }

    /// Whether all points of a piece lie on cuts, as on a strip between two cuts through the same long triangles: its joint faces would hold it whole.
    [[nodiscard]] bool heldWhole(std::int32_t root, const std::vector<std::int32_t>& members) {
        std::vector<std::int32_t> held;
        for (std::size_t c = 0; c < cuts_.size(); ++c)
            if (sets_.find(front_[c]) == root || sets_.find(back_[c]) == root) held.insert(held.end(), capIds_[c].begin(), capIds_[c].end());
        if (held.empty()) return false;
        std::sort(held.begin(), held.end());
        bool whole = true;
        for (const std::int32_t p : members)
            forSides(polygons_[static_cast<std::size_t>(p)], [&](std::int32_t id, std::int32_t) { whole = whole && std::binary_search(held.begin(), held.end(), id); });
        return whole;
    }

    [[nodiscard]] BodyPiece build(std::int32_t root, const std::vector<std::int32_t>& members) {
        BodyPiece piece;
        std::vector<std::array<std::int32_t, 3>> corners;
        std::vector<Vec3> places;
        const bool held = heldWhole(root, members);
        for (const std::int32_t p : members) {
            const auto& [f, ids] = polygons_[static_cast<std::size_t>(p)];
            if (ids.empty()) {
                corners.push_back({mesh_.triangles(f, 0), mesh_.triangles(f, 1), mesh_.triangles(f, 2)});
            } else if (held && ids.size() > 3) {  // a free point in the middle, which leaves the surface what it is
                Vec3 middle = Vec3::Zero();
                for (const std::int32_t id : ids) middle += placeOf(id) / static_cast<double>(ids.size());
                const std::int32_t own = bodyVertices() + static_cast<std::int32_t>(added_.size());
                added_.push_back(middle);
                for (std::size_t k = 0; k < ids.size(); ++k) corners.push_back({ids[k], ids[(k + 1) % ids.size()], own});
            } else {
                places.clear();
                for (const std::int32_t id : ids) places.push_back(placeOf(id));
                for (const auto& t : triangulateConvex(places))
                    corners.push_back({ids[static_cast<std::size_t>(t[0])], ids[static_cast<std::size_t>(t[1])], ids[static_cast<std::size_t>(t[2])]});
            }
            piece.sourceTriangle.resize(corners.size(), f);
        }
        for (std::size_t c = 0; c < cuts_.size(); ++c)
            for (const bool front : {false, true}) {
                if (sets_.find(front ? front_[c] : back_[c]) != root) continue;
                const PlaneRegion& region = cuts_[c].region;
                BodyPiece::Cap cap;
                cap.cut = static_cast<int>(c);
                cap.front = front;
                cap.vertices = capIds_[c];
                cap.smallestAngle = region.smallestAngle;
                for (Eigen::Index f = 0; f < region.triangles.rows(); ++f) {
                    const auto id = [&](int k) { return capIds_[c][static_cast<std::size_t>(region.triangles(f, k))]; };
                    cap.triangles.push_back(static_cast<std::int32_t>(corners.size()));
                    corners.push_back({id(0), id(front ? 2 : 1), id(front ? 1 : 2)});
                }
                piece.caps.push_back(std::move(cap));
            }
        piece.sourceTriangle.resize(corners.size(), -1);

        std::vector<std::int32_t> local(static_cast<std::size_t>(bodyVertices()) + added_.size(), -1);  // per id
        for (const auto& t : corners)
            for (const std::int32_t id : t) local[static_cast<std::size_t>(id)] = 0;
        for (std::size_t id = 0; id < local.size(); ++id) {
            if (local[id] < 0) continue;
            local[id] = static_cast<std::int32_t>(piece.source.size());
            piece.source.push_back(static_cast<std::int32_t>(id) < bodyVertices() ? static_cast<std::int32_t>(id) : -1);
        }
        piece.body.vertices.resize(static_cast<Eigen::Index>(piece.source.size()), 3);
        for (std::size_t id = 0; id < local.size(); ++id)
            if (local[id] >= 0) piece.body.vertices.row(local[id]) = placeOf(static_cast<std::int32_t>(id)).transpose();
        piece.body.triangles.resize(static_cast<Eigen::Index>(corners.size()), 3);
        for (std::size_t f = 0; f < corners.size(); ++f)
            for (int k = 0; k < 3; ++k)
                piece.body.triangles(static_cast<Eigen::Index>(f), k) = local[static_cast<std::size_t>(corners[f][static_cast<std::size_t>(k)])];
        for (BodyPiece::Cap& cap : piece.caps)
            for (std::int32_t& v : cap.vertices) v = local[static_cast<std::size_t>(v)];
        return piece;
    }

    struct CutSide {
        std::int32_t from = 0, to = 0;
        int cut = 0;
    };

    const CutSurface& surface_;
    const TriangleMesh& mesh_;
    std::span<const PreparedCut> cuts_;
    int only_;
    std::vector<Vec3> added_;                                // places of the points that cuts add
    std::unordered_map<std::int32_t, Vec3> moved_;           // places of moved vertices of the body
    std::vector<std::vector<std::int32_t>> capIds_;          // per cut: ids of the points of its region
    std::map<std::int32_t, std::vector<EdgePoint>> onEdge_;  // per edge
    std::unordered_map<std::int32_t, int> runs_;             // edges that a loop runs along, and its cut
    std::map<std::int32_t, std::vector<Chord>> chords_;      // per triangle, ascending by cut
    std::vector<CutSide> cutSides_;                          // their front parts on the left
    std::vector<std::int32_t> whole_;                        // per triangle its polygon, -1: touched by a cut
    std::vector<Polygon> polygons_;
    UnionFind sets_{0};                       // of polygons
    std::vector<std::int32_t> front_, back_;  // per cut, a polygon on each side
};

}  // namespace

tl::expected<std::vector<BodyPiece>, CutRefusal> assemblePieces(const CutSurface& surface, std::span<const PreparedCut> cuts, int only) {
    return Assembly(surface, cuts, only).run();
}

std::optional<CutRefusal> findTouching(const CutSurface& surface, std::span<const PreparedCut> cuts) { return Assembly(surface, cuts, -1).divide(); }

}  // namespace imomushi
