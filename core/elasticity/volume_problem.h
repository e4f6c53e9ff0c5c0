// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/elasticity/boundary_equation.h"
#include "core/elasticity/boundary_problem.h"
#include "core/elasticity/tetrahedral_mesh.h"

namespace imomushi {

/// Linear elastostatics of one body with unit shear modulus by finite elements: tetrahedra with straight edges and displacement quadratic on each, nodes at
/// corners and in the middles of edges. The energy of the answer is never below the exact one's; for a smooth answer its error falls as the square of
/// the size of the tetrahedra, relative displacement as its cube. The same input gives the same bytes for any number of threads.
/// Nearly incompressible bodies: exact for constant strain at any ratio; quadratic displacement does not lock, but loses part of its order beyond kLargestNu.
class VolumeProblem {
public:
    struct Input {
        const TriangleMesh* surface = nullptr;      ///< what `tetrahedra` fill; read during build() only
        const TetrahedralMesh* tetrahedra = nullptr;  ///< kept by reference
        std::vector<HeldPatch> held;                ///< of the surface, at least one
        std::vector<std::array<std::int32_t, 2>> bubbles;  ///< edges of the surface whose middles are asked for
        double nu = 0.45;                           ///< Poisson ratio, 0...kLargestNu
        int threads = 1;
    };
    static constexpr double kLargestNu = 0.49;
    /// Cancelling waits for the ordering and for the factorisation: about a second at 25,000 nodes.
    /// Errors: "cancelled", "bad-value", "no-memory", "no-face", "no-free-vertex", "singular" (nothing holds the body).
    static Result<VolumeProblem> build(const Input& input, const Progress& progress);

    /// Bytes and seconds that build() will need for so many nodes, corners and middles together.
    static BoundaryProblem::Estimate estimate(int nodes, int columns, int threads);

    VolumeProblem(VolumeProblem&&) noexcept;
    VolumeProblem& operator=(VolumeProblem&&) noexcept;
    ~VolumeProblem();

    /// The same rows and columns as BoundaryProblem::Solution; the displacement is linear along held edges.
    struct Solution {
        Eigen::MatrixXd displacement;  ///< 3 * #free surface vertices x k
        Eigen::MatrixXd bubbles;       ///< 3 * #bubbles x k: how far the middle of each edge leaves the straight line between its ends
        Eigen::MatrixXd forces;        ///< 3 * #held x k: what holds the vertices of the patches, linear on their triangles, for shear modulus 1 (m^2 per m)
        Eigen::MatrixXd compliance;    ///< work of each of the 3 p columns of tractions on the answer to each: symmetric
    };
    /// Errors: "cancelled", "bad-value".
    Result<Solution> solve(const Eigen::MatrixXd& held, const BoundaryProblem::Loads& loads, const Progress& progress);

    [[nodiscard]] const std::vector<std::int32_t>& freeVertices() const;  ///< of the surface, ascending
    [[nodiscard]] std::int64_t nodes() const;                             ///< corners and middles
    [[nodiscard]] const SolveQuality& quality() const;

private:
    struct State;
    explicit VolumeProblem(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace imomushi
