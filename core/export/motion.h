// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/export/export.h"

namespace imomushi {

/// The clips of a scene sampled at their keys: one shape (ShapeLayout) per key, of a character that this owns.
class Motion {
public:
    struct Clip {
        std::vector<double> times;
        std::vector<std::vector<double>> shapes;
    };
    /// fps: see ExportOptions. Errors: those of Character::build, "bad-value" (a clip without frames, or of another character), "cancelled".
    static Result<Motion> build(const ExportScene& scene, double fps, const Progress& progress);

    Character character;  ///< surfaces are not made unless somebody asks for them
    std::vector<Clip> clips;
    ShapeLayout layout;
    double diagonal = 1.0;  ///< m, of the bounding box at rest; never 0
    std::vector<double> restShape;

    /// Frames that can be measured in about a second, with so many products each; 48 at least.
    static std::size_t affordable(Eigen::Index products);
    /// Some keys of all clips, evenly spread, `most` at most: clip and frame.
    [[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> sample(std::size_t most) const;

private:
    explicit Motion(Character made) : character(std::move(made)) {}
};

/// Of the first clip that has more than one frame; 60 where none has.
double framesPerSecond(const Motion& motion);

}  // namespace imomushi
