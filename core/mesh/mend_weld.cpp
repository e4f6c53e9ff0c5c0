// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cfloat>
#include <utility>

#include "core/mesh/mend_surface.h"
#include "core/mesh/weld.h"

namespace imomushi {
namespace {

/// Seams that writers rounded apart: a millionth of the size, or what single precision loses at these coordinates.
constexpr double kSeam = 1e-6;
constexpr double kSeamUlps = 4.0;
/// A seam tolerance above this part of the size would eat detail: such a file has lost its shape already.
constexpr double kWidestSeam = 1e-4;


struct Faults {
    std::size_t open = 0, nonManifold = 0;
};
Faults faults(const EdgeTable& edges) {
    Faults n;
    for (int e = 0; e < edges.size(); ++e) {
        n.open += edges.uses(e).size() == 1;
        n.nonManifold += edges.uses(e).size() > 2;
    }
    return n;
}

std::vector<char> openVertices(const MendSurface& s, const EdgeTable& edges) {
    std::vector<char> open(static_cast<std::size_t>(s.points.rows()), 0);
    for (int e = 0; e < edges.size(); ++e) {
        if (edges.uses(e).size() != 1) continue;
        open[at(edges.uses(e)[0].low)] = open[at(edges.uses(e)[0].high)] = 1;
    }
    return open;
}

/// Merges vertices if that closes open edges without new non-manifold ones (or `always`). Says how many went.
std::size_t merge(MendSurface& s, const std::vector<std::int32_t>& standsFor, const Faults& before, bool always) {
    std::size_t merged = 0;
    for (std::size_t v = 0; v < standsFor.size(); ++v) merged += standsFor[v] != static_cast<std::int32_t>(v);
    if (merged == 0) return 0;
    std::vector<MendFace> kept = s.faces;
    const std::size_t collapsedBefore = s.collapsed;
    for (MendFace& f : s.faces)
        for (std::int32_t& v : f.v) v = standsFor[at(v)];
    s.dropCollapsed();
    const Faults after = faults(EdgeTable(s.triangles()));
    if (always || (after.open < before.open && after.nonManifold <= before.nonManifold)) return merged;
    s.faces = std::move(kept);
    s.collapsed = collapsedBefore;
    return 0;
}

}  // namespace

void weldVertices(MendSurface& s) {
    std::size_t exact = 0;
    EdgeTable edges(s.triangles());
    Faults state = faults(edges);
    if (state.open == 0) return;
    std::vector<std::int32_t> group(static_cast<std::size_t>(s.points.rows()), -1);
    bool severalParts = false;
    for (const MendFace& f : s.faces) {
        severalParts = severalParts || f.part != s.faces.front().part;
        for (const std::int32_t v : f.v)
            if (group[at(v)] < 0) group[at(v)] = f.part;
    }
    // Parts first: neighbours that only touch (a character in pieces) stay apart where each piece closes by itself.
    exact += merge(s, weldExact(s.points, openVertices(s, edges), group), state, true);
    edges = EdgeTable(s.triangles());
    state = faults(edges);
    if (state.open > 0 && severalParts) {
        exact += merge(s, weldExact(s.points, openVertices(s, edges), {}), state, false);
        edges = EdgeTable(s.triangles());
        state = faults(edges);
    }
    if (exact > 0) s.say("unwelded", counted(exact, "vertex", "vertices") + " at the same place as others were merged with them.", exact);
    if (state.open == 0) return;
    const double size = (s.high - s.low).norm();
    const double farthest = std::max(s.low.cwiseAbs().maxCoeff(), s.high.cwiseAbs().maxCoeff());
    const double tolerance = std::min(std::max(kSeam * size, kSeamUlps * double{FLT_EPSILON} * farthest), kWidestSeam * size);
    const std::size_t near = merge(s, weldNear(s.points, openVertices(s, edges), tolerance), state, false);
    if (near > 0)
        s.say("unwelded", counted(near, "vertex", "vertices") + " within a millionth of the size of others were merged with them.", near);
}

}  // namespace imomushi
