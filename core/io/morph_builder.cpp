// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/io/morph_builder.h"

#include <cmath>

#include "core/base/finite.h"
#include "core/io/reader_support.h"
#include "core/mesh/bounds.h"

namespace imomushi {

int MorphBuilder::target(const std::string& name, bool named, double atRest) {
    if (!isFinite(atRest) || std::abs(atRest) > kLargestMorphWeight) atRest = 0.0;
    const auto add = [&] {
        targets_.push_back({cleanName(name, "morph target"), atRest, {}, {}});
        return static_cast<int>(targets_.size()) - 1;
    };
    if (!named) return add();
    const auto [known, isNew] = named_.try_emplace({name, atRest}, -1);
    if (isNew) known->second = add();
    return known->second;
}

void MorphBuilder::move(int target, std::int32_t vertex, const Vec3& delta) {
    if (delta.isZero(0.0)) return;
    const auto [known, isNew] = targets_[static_cast<std::size_t>(target)].moved.try_emplace(vertex, delta);
    if (!isNew) known->second += delta;
}

void MorphBuilder::finish(RawScene& scene) {
    std::set<std::string> names;
    std::size_t deltas = 0, tooMany = 0, broken = 0;
    for (Target& target : targets_) {
        if (target.moved.empty()) continue;
        if (scene.morphs.size() == kMostMorphs || deltas + target.moved.size() > kMostMorphDeltas) {
            ++tooMany;
            continue;
        }
        MorphTarget made;
        made.atRest = target.atRest;
        made.deltas.resize(static_cast<Eigen::Index>(target.moved.size()), 3);
        bool good = true;
        for (const auto& [vertex, delta] : target.moved) {
            good = good && allFinite(delta) && delta.cwiseAbs().maxCoeff() <= kMaxImportedCoordinate;
            if (good) made.deltas.row(static_cast<Eigen::Index>(made.vertices.size())) = delta.cast<float>().transpose();
            made.vertices.push_back(vertex);
        }
        if (!good) {
            ++broken;
            continue;
        }
        made.name = uniqueName(names, target.name);
        deltas += made.vertices.size();
        target.given = made.name;
        scene.morphs.push_back(std::move(made));
    }
    if (tooMany > 0) tell(scene, Severity::Warning, "morph-targets", "Morph targets left out: the file has too many.", tooMany);
    if (broken > 0) tell(scene, Severity::Warning, "morph-targets", "Morph targets with numbers that are not finite or too large were left out.", broken);
}

}  // namespace imomushi
