// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "core/mesh/bounds.h"
#include "core/mesh/health.h"
#include "core/mesh/mesh.h"
#include "core/mesh/topology.h"
#include "core/mesh/triangle_clusters.h"
#include "core/mesh/vertex_corners.h"

namespace imomushi {

/// What follows from a body and is asked for again and again. Each part is made when it is first asked for and kept, by whichever thread asks first; the others
/// wait for it. Part of an ElementMesh, see ElementMesh::connectivity().
class MeshConnectivity {
public:
    explicit MeshConnectivity(const TriangleMesh& body);
    ~MeshConnectivity();

    [[nodiscard]] const EdgeTable& edges() const;
    [[nodiscard]] const VertexCorners& corners() const;
    [[nodiscard]] const Points& normals() const;   ///< vertexNormals()
    [[nodiscard]] const MeshFacts& facts() const;  ///< meshFacts()
    [[nodiscard]] const TriangleClusters& clusters() const;
    [[nodiscard]] const Bounds& box() const;
    [[nodiscard]] double diagonal() const;  ///< diagonalOf(), m

private:
    struct Parts;
    const TriangleMesh& body_;
    std::unique_ptr<Parts> parts_;
};

}  // namespace imomushi
