// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "core/base/union_find.h"
#include "core/body/prepared_surface.h"

namespace imomushi {
namespace {

/// Of the whole area: hanging triangles beyond it are a part of the shape.
constexpr double kHanging = 0.05;
/// Of the whole area: walls beyond it are a part of the shape.
constexpr double kWalls = 0.2;
/// Volume over area^1.5 up to which a closed piece is two sides of a sheet.
constexpr double kSheet = 1e-6;

double faceArea(const MendSurface& s, const MendFace& f) {
    const Vec3 a = s.points.row(f.v[0]), b = s.points.row(f.v[1]), c = s.points.row(f.v[2]);
    return 0.5 * (b - a).cross(c - a).norm();
}

/// Fins: dropped one after the other from their free side.
std::size_t dropHanging(MendSurface& s) {
    double whole = 0.0, dropped = 0.0;
    for (const MendFace& f : s.faces) whole += faceArea(s, f);
    const std::vector<MendFace> before = s.faces;
    for (;;) {
        const EdgeTable edges(s.triangles());
        std::vector<char> hanging(s.faces.size(), 0);
        std::size_t found = 0;
        for (std::size_t f = 0; f < s.faces.size(); ++f) {
            bool free = false, crowded = false;
            for (int k = 0; k < 3; ++k) {
                const std::size_t uses = edges.uses(edges.edgeOf(static_cast<std::int32_t>(f), k)).size();
                free = free || uses == 1;
                crowded = crowded || uses > 2;
            }
            if (!free || !crowded) continue;
            hanging[f] = 1;
            dropped += faceArea(s, s.faces[f]);
            ++found;
        }
        if (found == 0) return before.size() - s.faces.size();
        if (dropped > kHanging * whole) {
            s.faces = before;
            return 0;
        }
        std::size_t i = 0;
        std::erase_if(s.faces, [&](const MendFace&) { return hanging[i++] != 0; });
    }
}

/// A closed piece that touches others along edges and encloses flesh, as a wing on its hinge does. `rim`: of its triangles, ascending, its edges with more than two: each is there twice.
bool isFlesh(const MendSurface& s, const std::vector<std::int32_t>& faces, const std::vector<int>& rim, double area) {
    for (std::size_t i = 0; i < rim.size(); i += 2)
        if (i + 1 == rim.size() || rim[i] != rim[i + 1]) return false;
    const Vec3 from = s.points.row(s.faces[at(faces.front())].v[0]);
    const auto corner = [&](std::int32_t f, std::size_t k) { return Vec3(s.points.row(s.faces[at(f)].v[k]).transpose() - from); };
    double volume = 0.0;
    for (const std::int32_t f : faces) volume += corner(f, 0).dot(corner(f, 1).cross(corner(f, 2))) / 6.0;
    return std::abs(volume) > kSheet * area * std::sqrt(area);
}

/// Walls inside of flesh: pieces of surface whose rim lies on edges that are sound without them, or two such pieces with the same rim. Smallest first:
/// a wall is smaller than what it divides.
std::size_t dropWalls(MendSurface& s) {
    const EdgeTable edges(s.triangles());
    UnionFind pieces(s.faces.size());
    for (int e = 0; e < edges.size(); ++e)
        if (const auto uses = edges.uses(e); uses.size() == 2) pieces.unite(uses[0].triangle, uses[1].triangle);
    struct Piece {
        std::vector<int> rim;
        std::vector<std::int32_t> faces;
        double area = 0.0;
        bool free = false;  // ends somewhere in the open
    };
    std::map<std::int32_t, Piece> byFirst;
    double whole = 0.0;
    for (std::int32_t f = 0; f < static_cast<std::int32_t>(s.faces.size()); ++f) {
        Piece& piece = byFirst[pieces.find(f)];
        piece.faces.push_back(f);
        const double area = faceArea(s, s.faces[at(f)]);
        piece.area += area;
        whole += area;
        for (int k = 0; k < 3; ++k) {
            const int e = edges.edgeOf(f, k);
            const std::size_t uses = edges.uses(e).size();
            piece.free = piece.free || uses == 1;
            if (uses > 2) piece.rim.push_back(e);
        }
    }
    std::map<std::vector<int>, std::vector<Piece>> byRim;
    for (auto& [first, piece] : byFirst) {
        if (piece.free || piece.rim.empty()) continue;
        std::sort(piece.rim.begin(), piece.rim.end());
        if (isFlesh(s, piece.faces, piece.rim, piece.area)) continue;
        byRim[piece.rim].push_back(std::move(piece));
    }
    struct Wall {
        double area;
        std::vector<int> rim;
        std::vector<std::int32_t> faces;
    };
    std::vector<Wall> walls;
    for (auto& [rim, same] : byRim) {
        std::stable_sort(same.begin(), same.end(), [](const Piece& a, const Piece& b) { return a.area < b.area; });
        walls.push_back({same[0].area, rim, same[0].faces});
        if (same.size() < 2) continue;
        Wall both{same[0].area + same[1].area, rim, same[0].faces};
        both.faces.insert(both.faces.end(), same[1].faces.begin(), same[1].faces.end());
        walls.push_back(std::move(both));
    }
    std::stable_sort(walls.begin(), walls.end(), [](const Wall& a, const Wall& b) { return a.area < b.area; });
    std::vector<char> gone(s.faces.size(), 0);
    std::size_t dropped = 0;
    double area = 0.0;
    for (const Wall& wall : walls) {
        if (area + wall.area > kWalls * whole) break;
        const std::set<std::int32_t> own(wall.faces.begin(), wall.faces.end());
        std::size_t sound = 0, torn = 0;  // of the rim without the wall
        for (const int e : wall.rim) {
            int forward = 0, backward = 0;
            for (const EdgeUse& use : edges.uses(e)) {
                if (gone[at(use.triangle)] || own.contains(use.triangle)) continue;
                ++(use.forward ? forward : backward);
            }
            sound += forward == 1 && backward == 1;
            torn += forward + backward < 2;
        }
        // Where two walls meet, more than two triangles are left until both are gone.
        if (gone[at(wall.faces.front())] || torn > 0 || 2 * sound <= wall.rim.size()) continue;
        for (const std::int32_t f : wall.faces) gone[at(f)] = 1;
        area += wall.area;
        ++dropped;
    }
    std::size_t i = 0;
    std::erase_if(s.faces, [&](const MendFace&) { return gone[i++] != 0; });
    return dropped;
}

std::int32_t cornerAt(const MendSurface& s, std::int32_t f, std::int32_t v) {
    for (int k = 0; k < 3; ++k)
        if (s.faces[at(f)].v[static_cast<std::size_t>(k)] == v) return f * 3 + k;
    return f * 3;
}

/// Pairs of triangles at one edge between which flesh lies. Counter-clockwise around the edge from its lower vertex to its higher one, flesh begins behind a
/// triangle that runs backward along it and ends at one that runs forward; pairs nest like brackets, the closest first.
std::vector<std::pair<std::int32_t, std::int32_t>> pairsAt(const MendSurface& s, std::span<const EdgeUse> uses) {
    if (uses.size() == 2) return {{uses[0].triangle, uses[1].triangle}};
    struct EdgeSide {
        double angle;
        bool forward;
        std::int32_t triangle;
    };
    const Vec3 from = s.points.row(uses[0].low);
    const Vec3 axis = (s.points.row(uses[0].high).transpose() - from).normalized();
    const Vec3 x = axis.unitOrthogonal(), y = axis.cross(x);
    std::vector<EdgeSide> sides;
    for (const EdgeUse& use : uses) {
        const Vec3 tip = s.points.row(s.faces[at(use.triangle)].v[static_cast<std::size_t>((use.corner + 2) % 3)]).transpose() - from;
        sides.push_back({std::atan2(tip.dot(y), tip.dot(x)), use.forward, use.triangle});
    }
    std::sort(sides.begin(), sides.end(), [](const EdgeSide& a, const EdgeSide& b) { return std::tie(a.angle, a.forward, a.triangle) < std::tie(b.angle, b.forward, b.triangle); });
    std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
    for (bool found = true; found && sides.size() > 1;) {
        found = false;
        for (std::size_t i = 0; i < sides.size(); ++i) {
            const std::size_t next = (i + 1) % sides.size();
            if (sides[i].forward || !sides[next].forward) continue;
            pairs.emplace_back(sides[i].triangle, sides[next].triangle);
            sides.erase(sides.begin() + static_cast<std::ptrdiff_t>(std::max(i, next)));
            sides.erase(sides.begin() + static_cast<std::ptrdiff_t>(std::min(i, next)));
            found = true;
            break;
        }
    }
    return pairs;
}

}  // namespace

bool separateNonManifold(MendSurface& s) {
    const auto crowdedEdges = [](const EdgeTable& edges) {
        std::size_t n = 0;
        for (int e = 0; e < edges.size(); ++e) n += edges.uses(e).size() > 2;
        return n;
    };
    EdgeTable edges(s.triangles());
    const std::size_t crowded = crowdedEdges(edges);
    const std::size_t pinched = nonManifoldVertices(s.triangles(), edges).size();
    if (crowded == 0 && pinched == 0) return false;
    const std::size_t hanging = crowded > 0 ? dropHanging(s) : 0;
    const std::size_t walls = crowded > 0 ? dropWalls(s) : 0;
    if (hanging + walls > 0) edges = EdgeTable(s.triangles());

    UnionFind fans(s.faces.size() * 3);
    for (int e = 0; e < edges.size(); ++e) {
        const auto uses = edges.uses(e);
        if (uses.size() < 2) continue;
        for (const auto& [f, g] : pairsAt(s, uses))
            for (const std::int32_t v : {uses[0].low, uses[0].high}) fans.unite(cornerAt(s, f, v), cornerAt(s, g, v));
    }
    // The first fan keeps the vertex, others get copies behind the last one.
    std::vector<std::int32_t> owner(static_cast<std::size_t>(s.points.rows()), -1), vertexOf(s.faces.size() * 3, -1), copied;
    for (std::int32_t c = 0; c < static_cast<std::int32_t>(vertexOf.size()); ++c) {
        const std::int32_t fan = fans.find(c);
        if (fan == c) {
            const std::int32_t v = s.faces[at(c / 3)].v[at(c % 3)];
            if (owner[at(v)] < 0) {
                owner[at(v)] = fan;
                vertexOf[at(c)] = v;
            } else {
                vertexOf[at(c)] = static_cast<std::int32_t>(s.points.rows()) + static_cast<std::int32_t>(copied.size());
                copied.push_back(v);
            }
        } else {
            vertexOf[at(c)] = vertexOf[at(fan)];
        }
    }
    const Eigen::Index first = s.points.rows();
    s.points.conservativeResize(first + static_cast<Eigen::Index>(copied.size()), 3);
    for (std::size_t i = 0; i < copied.size(); ++i) s.points.row(first + static_cast<Eigen::Index>(i)) = s.points.row(copied[i]).eval();
    for (std::size_t c = 0; c < vertexOf.size(); ++c) s.faces[c / 3].v[c % 3] = vertexOf[c];
    if (crowded > 0)
        s.say("non-manifold-edge", counted(crowded, "edge with more than two triangles was", "edges with more than two triangles were") + " separated" +
                                       (hanging > 0 ? ", and " + counted(hanging, "triangle that hung on them was", "triangles that hung on them were") + " left out." : "."),
              crowded);
    if (walls > 0) s.say("inner-wall", counted(walls, "wall inside of the flesh was", "walls inside of the flesh were") + " left out.", walls);
    if (pinched > 0) s.say("non-manifold-vertex", counted(pinched, "vertex", "vertices") + " in which the surface touched itself became one for each side.", pinched);
    return true;
}

}  // namespace imomushi
