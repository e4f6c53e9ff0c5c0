// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/mend.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/mesh/mend_surface.h"

namespace imomushi {
void dropUnused(MendSurface& s) {
    std::vector<char> used(static_cast<std::size_t>(s.points.rows()), 0);
    for (const MendFace& f : s.faces)
        for (const std::int32_t v : f.v) used[at(v)] = 1;
    const auto unused = static_cast<std::size_t>(std::count(used.begin(), used.end(), 0));
    if (unused > 0)
        s.say("unused-vertex", counted(unused, "vertex belongs to no triangle and was", "vertices belong to no triangle and were") + " dropped.",
            unused);
    // Left where they are: they only must not spoil the box, which welding tolerances follow.
    s.low = Vec3::Constant(std::numeric_limits<double>::max());
    s.high = -s.low;
    for (std::size_t v = 0; v < used.size(); ++v) {
        if (!used[v]) continue;
        s.low = s.low.cwiseMin(s.points.row(static_cast<Eigen::Index>(v)).transpose());
        s.high = s.high.cwiseMax(s.points.row(static_cast<Eigen::Index>(v)).transpose());
    }
}

void dropDuplicates(MendSurface& s) {
    const std::vector<std::int32_t> copies = duplicateTriangles(s.triangles());
    std::int32_t f = 0;
    const std::size_t dropped = std::erase_if(s.faces, [&](const MendFace&) { return std::binary_search(copies.begin(), copies.end(), f++); });
    if (dropped > 0)
        s.say("duplicate-triangle", counted(dropped, "triangle that lay on another was", "triangles that lay on others were") + " removed.",
            dropped);
}

void dropUseless(MendSurface& s) {
    dropDuplicates(s);
    mendDegenerate(s);
    if (s.collapsed > 0) s.say("degenerate", counted(s.collapsed, "triangle without area was", "triangles without area were") + " removed.", s.collapsed);
}

void windConsistently(MendSurface& s) {
    const EdgeTable edges(s.triangles());
    std::vector<std::int8_t> side(s.faces.size(), -1);  // 0: as in the file, 1: turned
    std::size_t turned = 0, oneSided = 0;
    std::vector<std::int32_t> piece;
    for (std::size_t seed = 0; seed < s.faces.size(); ++seed) {
        if (side[seed] >= 0) continue;
        piece.assign(1, static_cast<std::int32_t>(seed));
        side[seed] = 0;
        bool orientable = true;
        std::size_t ones = 0;
        for (std::size_t next = 0; next < piece.size(); ++next) {
            const std::int32_t f = piece[next];
            ones += side[at(f)] == 1;
            for (int k = 0; k < 3; ++k) {
                const auto uses = edges.uses(edges.edgeOf(f, k));
                if (uses.size() != 2) continue;
                const std::int32_t g = uses[0].triangle == f ? uses[1].triangle : uses[0].triangle;
                const auto wanted = static_cast<std::int8_t>(uses[0].forward == uses[1].forward ? 1 - side[at(f)] : side[at(f)]);
                if (side[at(g)] < 0) {
                    side[at(g)] = wanted;
                    piece.push_back(g);
                } else {
                    orientable = orientable && side[at(g)] == wanted;
                }
            }
        }
        if (!orientable) {
            ++oneSided;
            continue;
        }
        const std::int8_t minority = 2 * ones > piece.size() ? 0 : 1;
        for (const std::int32_t f : piece)
            if (side[at(f)] == minority) {
                s.faces[at(f)].turn();
                ++turned;
            }
    }
    if (turned > 0)
        s.say("mixed-winding", counted(turned, "triangle faced", "triangles faced") + " against its neighbours and was turned.", turned);
    if (turned > 1) s.issues.back().text = std::to_string(turned) + " triangles faced against their neighbours and were turned.";
    if (oneSided > 0) {
        s.say("non-orientable", "The surface has only one side, like a Moebius strip: rebuild it in a modelling program.", oneSided);
        s.issues.back().severity = Severity::Error;
        s.issues.back().fixed = false;
    }
}

MendResult mend(RawSurface surface, bool split) {
    MendSurface s(std::move(surface));
    dropUnused(s);
    s.dropCollapsed();
    weldVertices(s);
    dropUseless(s);
    windConsistently(s);
    capHoles(s);
    return makeBodies(s, split);
}

}  // namespace imomushi
