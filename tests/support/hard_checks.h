// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "tests/support/hard_cases.h"

/// What must hold of a solved element, with a bound and the reason for it.
namespace imomushi::hard {

/// Rounding of the assembled equations, relative: sums of some hundred terms in double precision.
inline constexpr double kAssemblyRounding = 1e-14;

/// Diagonal of the box about a mesh, m.
double sizeOf(const TriangleMesh& mesh);
/// At rest, #free vertices x 3, m.
Points freePoints(const SolvedElement& solved);
/// Of joint parameters v: #free vertices x 3, m.
Points freeDisplacement(const SolvedElement& solved, const Eigen::VectorXd& v);

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
