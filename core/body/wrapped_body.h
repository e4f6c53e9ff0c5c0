// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/body/body.h"

// Of makeBody() alone.
namespace imomushi {

struct WrappedSurface {
    TriangleMesh mesh;  ///< closed, outward
    double detail = 0.0;
    ClosedGaps gaps;
};

/// A wrap of a prepared mesh, as fine as its gaps and limbs need (`detail` 0) or everywhere `detail`, coarsened where it is flat and taken back by its offset.
/// `volume`: that of the mesh, m^3, which the body gets then; 0: unknown. Errors: as wrapTriangles().
Result<WrappedSurface> wrappedBody(const TriangleMesh& mesh, double detail, double volume, const Progress& progress);

}  // namespace imomushi
