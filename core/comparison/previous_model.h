// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/character/character.h"

namespace imomushi {

/// The paper's previous model, as the proposed one is measured against (the manual's model, "The previous model"): a Character of basis "full" with the PreviousModelEffect alone,
/// and the statics that its dynamics come to rest at. In float, as the paper's memory figures are.
class PreviousModel {
public:
    /// input: as for Character, each element with joint faces with a response of basis "full"; its effects are left out. It runs on one thread with one step
    /// per frame of a 60th of a second, its joint faces so soft that this is stable: a frame takes as long whatever the stiffness.
    /// Errors: "bad-value", those of Character::build, "cancelled".
    static Result<PreviousModel> build(CharacterInput input, const Progress& progress);

    /// What is performed: update() with kFrame is one step of its dynamics.
    [[nodiscard]] Character& character() { return character_; }
    static constexpr double kFrame = 1.0 / 60.0;  // s

    /// Where the dynamics come to rest: joint-face vertices at least elastic energy, while bones hold each joint face as a whole. Per element
    /// #body vertices x 3, world. Welded vertices move as one, others each by itself. Stops what moves. Allocates. Errors: "cancelled", "not-solved".
    Result<std::vector<Points>> statics(const Pose& pose, const Progress& progress);

    /// Of all n x m matrices, X = (displacement of free vertices, tractions of joint-face vertices), as floats; and m of all elements.
    [[nodiscard]] std::size_t matrixBytes() const;
    [[nodiscard]] int columns() const;

private:
    struct FaceVertex {
        std::int32_t vertex = 0;
        Eigen::Index node = 0;  // welded vertices share one
        Eigen::Matrix3d axes;   // of its face: those of the columns of the response
    };
    explicit PreviousModel(Character character);

    Character character_;
    std::vector<std::vector<FaceVertex>> held_;  // per element, in the order of columns
    std::vector<double> area_;                   // of nodes, m^2
    std::vector<Eigen::Index> first_;            // node of each joint; one more entry: their number
};

}  // namespace imomushi
