// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/elasticity/kernels.h"
#include "core/mesh/mesh.h"
#include "core/mesh/topology.h"

namespace imomushi {

/// A patch of the surface whose displacement is prescribed. Patches must not share vertices.
struct HeldPatch {
    std::vector<std::int32_t> vertices;   ///< ascending, the rim included
    std::vector<std::int32_t> triangles;  ///< all triangles whose corners lie in `vertices`
};

/// The equations A X = -H_J u_J of one closed body with unit shear modulus, entry by entry: direct collocation of H u = G t (see kernels.h).
/// The displacement is continuous, linear on every triangle, and quadratic along the edges that have a bubble; tractions are linear on each
/// held patch (one-sided at its rim) and zero elsewhere. Collocation points are the vertices and the middles of the edges with bubbles.
/// Nodes, three unknowns each: the displacement of every free vertex; how far the middle of an edge leaves the straight line between
/// its ends, for every bubble; the scaled traction of every held vertex.
/// Lengths are in units of the body's size, so that entries are of order one whatever the body's unit and place.
class BoundaryEquation {
public:
    /// `mesh`: closed, outward, without degenerate triangles, with these edges. `bubbles`: vertices of edges, each edge once, of which no triangle is held.
    BoundaryEquation(const TriangleMesh& mesh, const EdgeTable& edges, std::span<const HeldPatch> held, std::span<const std::array<std::int32_t, 2>> bubbles, double nu);

    [[nodiscard]] std::int32_t nodes() const { return static_cast<std::int32_t>(points_.rows()); }
    [[nodiscard]] std::int32_t freeCount() const { return freeCount_; }      ///< nodes 0...
    [[nodiscard]] std::int32_t bubbleCount() const { return bubbleCount_; }  ///< nodes freeCount()...
    [[nodiscard]] std::int32_t heldCount() const { return heldCount_; }      ///< the last nodes, patch by patch
    [[nodiscard]] const std::vector<std::int32_t>& freeVertices() const { return freeVertices_; }  ///< ascending
    /// The vertex nearest to a node, to name it to a user.
    [[nodiscard]] std::int32_t vertexOf(std::int32_t node) const;
    /// Solid angle of the body at a node over 4 pi, the free term of the equation, from the triangles around the node alone. row() returns the same from all
    /// triangles unless the surface overlaps or touches itself there.
    [[nodiscard]] double localSolidAngle(std::int32_t node) const { return freeTerm_[static_cast<std::size_t>(node)]; }
    /// Traction, for the body in its own unit of length, per unknown of the j-th held vertex.
    [[nodiscard]] double tractionScale(std::int32_t j) const { return columnScale_[static_cast<std::size_t>(j)] / size_; }

    /// The row of a node in whole: h (9 (nodes() + 1)) gets the blocks of H, 3 x 3 by rows, with the free term, in the order of the nodes, those of
    /// held vertices for their displacement, and one more without meaning; g (9 heldCount()) those of A for the tractions. Returns the free term.
    double row(std::int32_t node, double* h, double* g) const;

    [[nodiscard]] std::int32_t vertices() const { return static_cast<std::int32_t>(mesh_.vertices.rows()); }
    [[nodiscard]] std::int32_t triangles() const { return static_cast<std::int32_t>(mesh_.triangles.rows()); }

    /// What loads add to the right side with the held vertices at rest: 3 nodes() x kLoads. Columns 0 1 2: a uniform force per volume along x, y, z
    /// over the shear modulus (1/m); 3: a pressure over the shear modulus that pushes all triangles outwards but those held (for a body inflated from
    /// inside). The displacement is in the body's unit of length. The same bytes for any number of threads. Unfinished when cancelled.
    static constexpr int kLoads = 4;
    [[nodiscard]] Eigen::MatrixXd loads(int threads, const Progress& progress) const;

    /// What tractions on the free surface add to the right side with the held vertices at rest: 3 nodes() x 3 k for `sizes`, #V x k. Column 3 i + axis: a
    /// traction along that axis over the shear modulus, sizes(v, i) at vertex v of the mesh and linear on each triangle that is not held. Time grows with the
    /// vertices that carry any. The same bytes for any number of threads. Unfinished when cancelled.
    [[nodiscard]] Eigen::MatrixXd tractionLoads(const Eigen::MatrixXd& sizes, int threads, const Progress& progress) const;

    [[nodiscard]] Vec3 position(std::int32_t node) const { return points_.row(node).transpose(); }

private:
    [[nodiscard]] bool bubble(std::int32_t node) const { return node >= freeCount_ && node < freeCount_ + bubbleCount_; }
    void addFreeTerm(std::int32_t node, double freeTerm, double* h) const;

    TriangleMesh mesh_;
    double nu_ = 0.0, size_ = 1.0;
    std::int32_t freeCount_ = 0, bubbleCount_ = 0, heldCount_ = 0;
    std::vector<std::int32_t> freeVertices_, heldVertices_;
    std::vector<std::array<std::int32_t, 2>> ends_;  ///< nodes at the ends of each bubble's edge
    Points points_;                                  ///< nodes() x 3
    std::vector<double> freeTerm_;                   ///< per node, from the triangles around it
    std::vector<double> columnScale_;                ///< per held vertex: times this is of order one
    std::vector<char> inPatch_;                      ///< per triangle
    TriangleBatch plain_, curved_, held_;            ///< triangles without and with bubbles, and those of held patches
};

}  // namespace imomushi
