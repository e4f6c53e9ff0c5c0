// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "core/base/progress.h"
#include "core/character/character.h"

namespace imomushi {

/// The paper's previous model, live, as the proposed one is measured against (model.md section 2): per frame one product with the n x m matrix of every
/// element, X = (displacement of free vertices, tractions of joint-face vertices); bones carry each joint face as a whole, and within it every vertex
/// has an equation of motion driven by those tractions, integrated explicitly with one step per frame. In float, as the paper's memory figures are.
class PreviousModel {
public:
    /// input: as for Character, each element with joint faces with a response of basis "full". The masses of joint-face vertices are as small as a
    /// step of a 60th of a second allows. Errors: "bad-value", those of Character::build, "cancelled".
    static Result<PreviousModel> build(CharacterInput input, const Progress& progress);
    PreviousModel(PreviousModel&&) noexcept;
    PreviousModel& operator=(PreviousModel&&) noexcept;
    ~PreviousModel();

    /// The product of all elements alone, on whatever the joint faces last did. Does not allocate, like frame().
    void product();
    /// One frame of a 60th of a second: inverse kinematics, joints, product, positions, normals, dynamics of the joint faces. False: diverged, and survived.
    bool frame(const std::vector<IkGoal>& goals, Pose& pose);
    /// Milliseconds of the last frame() that a joint-face model without A' spends twice here (a rigid body is placed first): not part of its cost.
    [[nodiscard]] double overheadMs() const;
    /// #body vertices x 3, world, as frame() left them.
    [[nodiscard]] const float* positions(int element) const;
    [[nodiscard]] const float* normals(int element) const;

    /// Where the dynamics come to rest: joint-face vertices at least elastic energy, while bones hold each joint face as a whole. Per element
    /// #body vertices x 3, world. Allocates. Errors: "cancelled", "not-solved".
    Result<std::vector<Points>> statics(const Pose& pose, const Progress& progress);

    [[nodiscard]] std::size_t matrixBytes() const;  ///< of all n x m matrices, as floats
    [[nodiscard]] int columns() const;              ///< m of all elements

private:
    struct State;
    explicit PreviousModel(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace imomushi
