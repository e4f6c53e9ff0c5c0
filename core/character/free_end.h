// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/character/character.h"

namespace imomushi {

/// Where a bone ends in the flesh of an element, in no joint and no other bone, and the force that moves the flesh there.
struct FreeEnd {
    int end = 0, near = 0;  ///< points of the skeleton: the end, and the other end of its bone
    double length = 0.0;    ///< m, of the bone at rest
    /// Force per volume over the shear modulus, 1/m, per metre that flesh around the end moves: 1/m^2, both in the rest axes of the element.
    Eigen::Matrix3d perMetre = Eigen::Matrix3d::Zero();
};

/// The one free end of the bones of an element. Nullopt: it has none or several, nothing holds it but its bones, its response has no columns of loads, or a uniform force along the bone moves other
/// flesh more than that around the end.
std::optional<FreeEnd> freeEndOf(const CharacterInput& input, std::size_t element);

}  // namespace imomushi
