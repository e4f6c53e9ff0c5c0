// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <iterator>
#include <numeric>
#include <set>
#include <unordered_map>

#include "core/mesh/mend_surface.h"

namespace imomushi {
namespace {

constexpr int kDegeneratePasses = 20;
/// A triangle whose shortest side is below this many times the flatness of its longest is a needle and is collapsed; others are flipped away.
constexpr double kNeedle = 10.0;

double length(const MendSurface& s, std::int32_t a, std::int32_t b) { return (s.points.row(a) - s.points.row(b)).norm(); }

bool flat(const MendSurface& s, std::int32_t a, std::int32_t b, std::int32_t c, double flatness) {
    const double longest = std::max({length(s, a, b), length(s, b, c), length(s, c, a)});
    if (!(longest > 0.0)) return true;
    const Vec3 p = (s.points.row(b) - s.points.row(a)).transpose() / longest, q = (s.points.row(c) - s.points.row(a)).transpose() / longest;
    return p.cross(q).norm() < flatness;
}

}  // namespace

// Each pass changes places that do not touch.
void mendDegenerate(MendSurface& s, double flatness) {
    for (int pass = 0; pass < kDegeneratePasses; ++pass) {
        std::vector<std::int32_t> bad;
        for (std::size_t f = 0; f < s.faces.size(); ++f)
            if (flat(s, s.faces[f].v[0], s.faces[f].v[1], s.faces[f].v[2], flatness)) bad.push_back(static_cast<std::int32_t>(f));
        if (bad.empty()) return;
        const EdgeTable edges(s.triangles());
        std::unordered_map<std::int32_t, std::vector<std::int32_t>> around;  // faces at the vertices of the bad ones
        for (const std::int32_t f : bad)
            for (const std::int32_t v : s.faces[at(f)].v) around[v];
        for (std::size_t f = 0; f < s.faces.size(); ++f)
            for (const std::int32_t v : s.faces[f].v)
                if (const auto it = around.find(v); it != around.end()) it->second.push_back(static_cast<std::int32_t>(f));
        std::set<std::int32_t> touched;
        std::vector<std::int32_t> standsFor(static_cast<std::size_t>(s.points.rows()));
        std::iota(standsFor.begin(), standsFor.end(), 0);
        std::vector<char> remove(s.faces.size(), 0);
        bool changed = false;
        const auto neighbours = [&](std::int32_t v) {
            std::set<std::int32_t> ring;
            for (const std::int32_t f : around[v])
                for (const std::int32_t w : s.faces[at(f)].v)
                    if (w != v) ring.insert(w);
            return ring;
        };
        for (const std::int32_t f : bad) {
            MendFace& face = s.faces[at(f)];
            if (std::any_of(face.v.begin(), face.v.end(), [&](std::int32_t v) { return touched.contains(v); })) continue;
            bool manifold = true;
            for (int k = 0; k < 3; ++k) manifold = manifold && edges.uses(edges.edgeOf(f, k)).size() == 2;
            int longest = 0, shortest = 0;  // the side from this corner to the next
            for (int k = 1; k < 3; ++k) {
                const auto side = [&](int i) { return length(s, face.v[static_cast<std::size_t>(i)], face.v[static_cast<std::size_t>((i + 1) % 3)]); };
                if (side(k) > side(longest)) longest = k;
                if (side(k) < side(shortest)) shortest = k;
            }
            const auto corner = [](int k) { return static_cast<std::size_t>(k % 3); };
            const std::int32_t a = face.v[corner(longest)], b = face.v[corner(longest + 1)], m = face.v[corner(longest + 2)];
            const std::int32_t p = face.v[corner(shortest)], q = face.v[corner(shortest + 1)];
            if (!manifold) {
                remove[at(f)] = 1;
                for (const std::int32_t v : face.v) touched.insert(v);
            } else if (length(s, p, q) <= kNeedle * flatness * length(s, a, b)) {
                // The link condition: the two ends share just the tips of the two triangles at the side, or the surface would pinch.
                const std::set<std::int32_t> ringP = neighbours(p), ringQ = neighbours(q);
                std::vector<std::int32_t> common;
                std::set_intersection(ringP.begin(), ringP.end(), ringQ.begin(), ringQ.end(), std::back_inserter(common));
                if (common.size() != 2) continue;
                if (std::any_of(ringP.begin(), ringP.end(), [&](std::int32_t v) { return touched.contains(v); })) continue;
                if (std::any_of(ringQ.begin(), ringQ.end(), [&](std::int32_t v) { return touched.contains(v); })) continue;
                standsFor[at(std::max(p, q))] = std::min(p, q);
                touched.insert(ringP.begin(), ringP.end());
                touched.insert(ringQ.begin(), ringQ.end());
            } else {
                const auto uses = edges.uses(edges.edgeOf(f, longest));
                const EdgeUse& other = uses[0].triangle == f ? uses[1] : uses[0];
                MendFace& next = s.faces[at(other.triangle)];
                const std::int32_t d = next.v[corner(other.corner + 2)];
                if (other.forward == (a < b)) continue;  // wound against each other: a flip would tear
                if (touched.contains(d) || neighbours(m).contains(d)) continue;
                if (flat(s, m, a, d, flatness) && flat(s, m, b, d, flatness)) continue;
                const MendFace mine = face, theirs = next;
                const std::int32_t rm = mine.r[corner(longest + 2)], rd = theirs.r[corner(other.corner + 2)];
                const std::int32_t rb = theirs.r[corner(other.corner)], ra = theirs.r[corner(other.corner + 1)];
                face.v = {a, d, m}, face.r = {ra, rd, rm};
                next.v = {d, b, m}, next.r = {rd, rb, rm};
                face.material = next.material, face.part = next.part;
                touched.insert({a, b, m, d});
                ++s.collapsed;
            }
            changed = true;
        }
        if (!changed) return;
        for (MendFace& f : s.faces)
            for (std::int32_t& v : f.v) v = standsFor[at(v)];
        std::size_t i = 0;
        s.collapsed += std::erase_if(s.faces, [&](const MendFace&) { return remove[i++] != 0; });
        s.dropCollapsed();
    }
}

}  // namespace imomushi
