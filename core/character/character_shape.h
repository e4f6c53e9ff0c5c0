// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace imomushi {

/// How the numbers of a character's shape are ordered (Character::shape()):
///   per element  rotation x y z w and shift (m) of its frame, rest to world; weights: v, then body loads (ElementResponse); the forces of
///                touch patches (over the shear modulus, m^2); where its fingers have tips, TouchContact::kDents dents (Dent::put()); where the bend warp is automatic, how much of it is shown
///   per joint    rotation x y z w; the linear part of its map, rest to world, column by column, and the shift (m); the part of its shape that is shown;
///                its warping, world, 3 per shape (JointEquilibrium)
///   per node     the offset (m) of a face vertex of the previous model, in the rest axes of its joint
///   per attached part  its turn about its pivot, a rotation vector in the axes of the rest pose (radians); by elements
///   per morph target    its weight; by render meshes
struct ShapeLayout {
    static constexpr int kFrame = 7, kJoint = 17;
    struct Element {
        int weights = 0;
        int forces = 0;  ///< with the numbers of dents
        int fades = 0;  ///< 0 or 1
        [[nodiscard]] int size() const { return kFrame + weights + forces + fades; }
        bool operator==(const Element&) const = default;
    };
    std::vector<Element> elements;
    int joints = 0;
    int warping = 0;  ///< shapes per joint
    int nodes = 0;
    int turns = 0;
    int morphs = 0;
    bool operator==(const ShapeLayout&) const = default;

    [[nodiscard]] int element(std::size_t e) const {  ///< where its numbers begin
        int at = 0;
        for (std::size_t i = 0; i < e; ++i) at += elements[i].size();
        return at;
    }
    [[nodiscard]] int jointSize() const { return kJoint + 3 * warping; }
    [[nodiscard]] int joint(int j) const { return element(elements.size()) + j * jointSize(); }
    [[nodiscard]] int size() const { return joint(joints) + 3 * (nodes + turns) + morphs; }
    [[nodiscard]] int morph(int i) const { return size() - morphs + i; }
};

}  // namespace imomushi
