// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "remesh.h"

namespace imomushi::samples {

/// The surface of a shape inside a box, by marching tetrahedra on a grid of `step` metres: closed, wound outwards, a start for remesh.
Mesh surfaceOf(const Shape& shape, const Vec3& low, const Vec3& high, double step);

}  // namespace imomushi::samples
