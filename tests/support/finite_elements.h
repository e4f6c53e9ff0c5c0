// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/joints/joint_face.h"
#include "core/mesh/mesh.h"

/// Linear elastostatics of one body by second-order tetrahedra: an answer that shares nothing with the boundary elements of core but the
/// definition of the problem (faces held, the rest of the surface free of traction, no body force, shear modulus 1).
namespace imomushi::finite_elements {

/// Sizes of tetrahedra, metres. At the distance d (metres) from the nearest rim of a joint face: min(bulk, rim + growth * d); near
/// re-entrant edges of the free surface likewise, starting from `crease`.
struct Grading {
    double rim = 0.0;
    double crease = 0.0;
    double bulk = 0.0;
    double growth = 0.5;
};

/// Tetrahedra with straight edges and a node in the middle of each.
struct QuadraticTets {
    Points nodes;
    /// #T x 10: corners 0 1 2 3 (positive volume), then the middles of the edges 01 12 02 03 13 23.
    Eigen::Matrix<std::int32_t, Eigen::Dynamic, 10, Eigen::RowMajor> tets;
    std::vector<std::int32_t> nodeOfVertex;              ///< per vertex of the body
    std::vector<std::vector<std::int32_t>> nodesOfFace;  ///< per joint face, ascending

    /// The rows of `values` (#nodes x 3) that belong to the vertices of the body.
    [[nodiscard]] Points atVertices(const Points& values) const;
};

/// Puts a node in the middle of each edge. `faceTriangles`: per joint face the corner nodes of the triangles that lie on it.
QuadraticTets quadraticTets(const Points& corners, const Eigen::Matrix<std::int32_t, Eigen::Dynamic, 4, Eigen::RowMajor>& tets,
                            std::span<const Triangles> faceTriangles);

/// Fills exactly the polyhedron `body` (closed, outward) with tetrahedra; every triangle and every vertex of it is kept.
/// Errors: "mesher" with gmsh's reason.
Result<QuadraticTets> meshBody(const TriangleMesh& body, std::span<const JointFace> faces, const Grading& grading);

/// The stiffness matrix of the nodes that no face holds, factorised (CHOLMOD, supernodal, ordered by METIS).
class Elastostatics {
public:
    /// `mesh` is kept by reference. Errors: "no-memory", "not-definite" (nothing holds the body, or a tetrahedron is inverted).
    static Result<Elastostatics> build(const QuadraticTets& mesh, double nu);
    Elastostatics(Elastostatics&&) noexcept;
    Elastostatics& operator=(Elastostatics&&) noexcept;
    ~Elastostatics();

    /// Displacement of every node (#nodes x 3); of each entry of `held` only the rows of held nodes are read.
    struct Solution {
        std::vector<Points> displacement;
        double residual = 0.0;  ///< largest |f - K u| / |f|
    };
    Result<Solution> solve(std::span<const Points> held);

    [[nodiscard]] std::int64_t unknowns() const;
    [[nodiscard]] double factorBytes() const;

private:
    struct State;
    explicit Elastostatics(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace imomushi::finite_elements
