// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// How many points numerical quadrature spends on a pair of collocation point and triangle: Cowper's seven-point rule (degree 5; Int. J.
/// Numer. Meth. Eng. 7 (1973) 405) on the triangle cut into n x n equal parts, with n = `far`, or `near` where the point is nearer to the
/// centre of the triangle than `reach` times its longest edge. Triangles around the point itself: Gauss points squared in coordinates that
/// cancel 1/R. SurfaceOnlyDeformables (Sugimoto, Batty, Hachisuka 2022) cuts every triangle into 2 x 2 and has 5 x 5 points on each part
/// around the point.
struct Quadrature {
    int far = 2, near = 2;
    double reach = 0.0;
    int singularParts = 2;  ///< of five Gauss points each, in either direction
};

/// The rows of the boundary equations H u = G t (shear modulus 1) of the collocation points `rows` (vertices), by quadrature of Kelvin's
/// kernels as they stand: per row 9 * #V numbers of H (3 x 3 by rows; the block of the point itself makes a translation give no traction)
/// and 9 * #V of G, to which only the triangles `held` contribute.
struct AssembledRows {
    std::vector<double> h, g;
};
AssembledRows assembleByQuadrature(const TriangleMesh& mesh, const std::vector<std::int32_t>& held, const std::vector<std::int32_t>& rows,
                                   double nu, const Quadrature& quadrature, int threads);

/// The same rows by the closed forms of core (kernels.h).
AssembledRows assembleInClosedForm(const TriangleMesh& mesh, const std::vector<std::int32_t>& held, const std::vector<std::int32_t>& rows,
                                   double nu, int threads);

}  // namespace imomushi
