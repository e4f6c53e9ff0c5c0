// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/render_model.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/finite.h"
#include "core/mesh/bounds.h"

namespace imomushi {

std::string checkMorphs(const std::vector<MorphTarget>& morphs, std::size_t vertices) {
    if (morphs.size() > kMostMorphs) return "there are too many morph targets";
    std::set<std::string_view> names;
    std::size_t deltas = 0;
    for (const MorphTarget& target : morphs) {
        if (target.name.empty() || !names.insert(target.name).second) return "two morph targets have one name";
        if (!isFinite(target.atRest) || std::abs(target.atRest) > kLargestMorphWeight) return "the weight of a morph target is out of range";
        if (static_cast<std::size_t>(target.deltas.rows()) != target.vertices.size()) return "a morph target has a wrong size";
        if (!target.vertices.empty() && (target.vertices.front() < 0 || static_cast<std::size_t>(target.vertices.back()) >= vertices)) return "a morph target moves a vertex that does not exist";
        if (std::adjacent_find(target.vertices.begin(), target.vertices.end(), std::greater_equal<>()) != target.vertices.end()) return "the vertices of a morph target are out of order";
        if (!allFinite(target.deltas) || (target.deltas.size() > 0 && static_cast<double>(target.deltas.cwiseAbs().maxCoeff()) > kMaxImportedCoordinate))
            return "a morph target has a number that is not finite or too large";
        deltas += target.vertices.size();
    }
    return deltas > kMostMorphDeltas ? "the morph targets move too many vertices" : "";
}

bool RenderModel::sameVertices(const RenderModel& other) const {
    const Points &own = mesh.body.vertices, &others = other.mesh.body.vertices;
    return own.rows() == others.rows() && own == others;
}

int RenderModel::morphIndex(std::string_view name) const {
    const auto found = std::find_if(morphs.begin(), morphs.end(), [&](const MorphTarget& target) { return target.name == name; });
    return found == morphs.end() ? -1 : static_cast<int>(found - morphs.begin());
}

}  // namespace imomushi
