// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/io/raw_scene.h"

namespace imomushi {

/// Makes morph targets of what a reader finds in a scene. Targets of one name and one weight at rest are one, as lashes, teeth and eyes of a face have those of the face. Nothing of the file has
/// to be finite.
class MorphBuilder {
public:
    /// The number of a target. `named`: the file itself calls it so; else it is one of its own.
    int target(const std::string& name, bool named, double atRest);
    /// Per unit of weight, in the file's coordinates. Later ones of a vertex add up.
    void move(int target, std::int32_t vertex, const Vec3& delta);
    /// Gives the targets that move something to the scene, in their order. What exceeds the limits or is broken is left out and told.
    void finish(RawScene& scene);
    /// What the scene calls a target after that; empty: it was left out.
    [[nodiscard]] const std::string& nameOf(int target) const { return targets_[static_cast<std::size_t>(target)].given; }

private:
    struct Target {
        std::string name;
        double atRest = 0.0;
        std::map<std::int32_t, Vec3> moved;
        std::string given = {};
    };
    std::vector<Target> targets_;
    std::map<std::pair<std::string, double>, int> named_;
};

}  // namespace imomushi
