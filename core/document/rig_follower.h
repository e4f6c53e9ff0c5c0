// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/document/character_input.h"
#include "core/mesh/rig.h"
#include "core/skeleton/bone_tree.h"

namespace imomushi {

/// Moves the bones of a document as a clip moves the skeleton of a file. A document bone follows the first of: the file bone of its name; the one that its parent follows, if both start at
/// one point; a file bone whose head is at its start; the one that its parent follows; the nearest file bone. A joint point at the head of a bone of the file goes where that goes;
/// any other is carried rigidly.
class RigFollower {
public:
    /// Bones of `character` are those that hang together with a bone through one of its elements. All must outlive this.
    RigFollower(const Document& document, const CharacterPlan& plan, const CharacterSource& character);

    /// Poses everything else at rest. Frames hold the whole turn of a bone, its twist too; roll is 0.
    [[nodiscard]] Pose pose(const RigClip& clip, double time) const;

    /// Per bone of the plan the bone of the file that it follows, -1: none.
    [[nodiscard]] const std::vector<int>& follows() const { return follows_; }
    /// Joint points that are joints of the file, and others that follow it.
    [[nodiscard]] int exactPoints() const { return exact_; }
    [[nodiscard]] int carriedPoints() const { return carried_; }

private:
    void chooseBones(const Document& document, PartId character);
    void choosePoints();

    const CharacterPlan& plan_;
    const Rig& rig_;
    BoneTree tree_;
    double same_ = 0.0;              // m: places nearer than this are one
    std::vector<int> follows_;       // per bone
    std::vector<int> pointFollows_;  // per joint point
    int exact_ = 0, carried_ = 0;
};

}  // namespace imomushi
