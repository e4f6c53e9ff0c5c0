// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "tests/support/hard_cases.h"

/// What must hold of a solved element, with a bound and the reason for it.
namespace imomushi::hard {

/// Rigid motions of all faces give rigid motions. condition: of the solved equations.
HardCheck rigid(double condition);
/// Of a prism along z whose two ends are its faces.
HardCheck stretch(double condition);
/// Four relative motions of the last face (stretch, shear, bend, twist), at the vertices that both bodies have: relative L2 difference, the largest of
/// them. A point x of `other` is scale x + shift here.
HardCheck sameAs(std::string what, HardElement other, double bound, std::string why, double scale = 1.0, const Vec3& shift = Vec3::Zero());
/// With another bound for the default solver mesh.
HardCheck byDefault(HardCheck check, double bound, std::string why);

}  // namespace imomushi::hard
