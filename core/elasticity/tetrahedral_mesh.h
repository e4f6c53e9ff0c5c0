// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// Tetrahedra that fill a closed surface exactly: its triangles are sides of theirs.
struct TetrahedralMesh {
    Points vertices;  ///< those of the surface first, in their order
    Eigen::Matrix<std::int32_t, Eigen::Dynamic, 4, Eigen::RowMajor> tetrahedra;  ///< of positive volume
};

/// Whether the volume of a tetrahedron is less than 1e-7 of the product of three of its edges, or negative: equations with it mean nothing.
bool anyFlat(const TetrahedralMesh& mesh);

/// Lengths of edges, m: the least of `most` and, at the distance d from each point, its size + growth * d.
struct TetrahedronSizes {
    struct Point {
        Vec3 place;
        double size;
    };
    std::vector<Point> points;
    double growth = 0.5, most = 0.0;
    [[nodiscard]] double at(const Vec3& p) const;
};

/// Fills what lies inside `surface` (closed, outward; cavities stay empty) with tetrahedra of about the size `size` where the surface's own triangles are no
/// larger. No vertex is put on the surface and none of its edges is moved. Deterministic.
/// TetGen does it (Si 2015, ACM TOMS 41:11), in a worker (core/worker/worker.h) where there are any: it cannot be cancelled, and ends its process on some input.
/// Errors: "no-filling" with the reason: the surface meets itself, or TetGen gave up or broke down. All others say nothing about the surface, so that no other way may be taken
/// because of them: "cancelled", "too-large", and those of askWorker().
Result<TetrahedralMesh> fillWithTetrahedra(const TriangleMesh& surface, const TetrahedronSizes& size, const Progress& progress);

}  // namespace imomushi
