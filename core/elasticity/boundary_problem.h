// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/elasticity/boundary_equation.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// Accuracy and cost of a boundary problem.
struct SolveQuality {
    double residual = 0.0;  ///< largest |A x - b| / |b| over the solved columns (2-norm), after refinement; of finite elements: of one combination of them
    double rcond = 0.0;     ///< estimate of the reciprocal condition number of the scaled matrix in the maximum norm (Higham 1988, LAPACK slacn2)
    double assembleSeconds = 0.0, factoriseSeconds = 0.0, solveSeconds = 0.0;
    std::size_t peakBytes = 0;
};

/// Linear elastostatics of one closed body with unit shear modulus, see BoundaryEquation, with a dense matrix.
/// Built once (assembly and factorisation), then solve() answers any number of right-hand sides.
/// The same input gives the same bytes for any number of threads.
class BoundaryProblem {
public:
    struct Input {
        const TriangleMesh* mesh = nullptr;  ///< closed, outward; read during build() only
        std::vector<HeldPatch> held;         ///< at least one
        std::vector<std::array<std::int32_t, 2>> bubbles;  ///< edges along which the displacement is quadratic; see BoundaryEquation
        double nu = 0.45;                    ///< Poisson ratio, 0...0.5
        int threads = 1;
    };
    /// With more nodes finite elements take less processor time for a smaller error, see README.md.
    static constexpr int kUsualNodes = 5000;
    /// Errors: "cancelled", "bad-value", "no-memory", "no-face", "shared-rim" (two patches share a vertex), "no-free-vertex",
    /// "singular", "not-closed" (the solid-angle sums say that the surface is open, inverted or self-overlapping).
    static Result<BoundaryProblem> build(const Input& input, const Progress& progress);
    /// Those checks of build() that need no integrals: mesh, patches and numbers.
    static Result<void> check(const Input& input);

    /// Bytes and seconds that build() will need, before it runs.
    struct Estimate {
        double seconds = 0.0;
        std::size_t bytes = 0;
    };
    /// `nodes`: vertices and bubbles together. `tractions`: columns of tractionLoads(), besides `columns`.
    static Estimate estimate(int nodes, int triangles, int columns, int threads, int tractions = 0);

    BoundaryProblem(BoundaryProblem&&) noexcept;
    BoundaryProblem& operator=(BoundaryProblem&&) noexcept;
    ~BoundaryProblem();

    /// Solves for the prescribed displacements `held` (3 * #heldVertices x k; patches in order, vertices in their order, xyz).
    /// displacement: 3 * #freeVertices x k, xyz of freeVertices(); traction: like held, for shear modulus 1 (Pa per Pa).
    /// Errors: "cancelled", "bad-value", "inaccurate" (the residual stayed above 1e-6).
    struct Solution {
        Eigen::MatrixXd displacement;
        Eigen::MatrixXd bubbles;  ///< 3 * #bubbles x k: how far the middle of each edge leaves the straight line between its ends
        Eigen::MatrixXd traction;
    };
    Result<Solution> solve(const Eigen::MatrixXd& held, const Progress& progress);
    /// Loads with the held vertices at rest, each as more columns after those of `held`.
    struct Loads {
        bool body = false;                           ///< BoundaryEquation::loads()
        const Eigen::MatrixXd* tractions = nullptr;  ///< #V x p, then BoundaryEquation::tractionLoads(), 3 p columns; null: none
        [[nodiscard]] Eigen::Index columns() const { return (body ? BoundaryEquation::kLoads : 0) + (tractions ? 3 * tractions->cols() : 0); }
    };
    /// The same with the columns of loads after the k of `held`.
    Result<Solution> solve(const Eigen::MatrixXd& held, const Loads& loads, const Progress& progress);

    [[nodiscard]] const std::vector<std::int32_t>& freeVertices() const;  ///< ascending
    [[nodiscard]] const SolveQuality& quality() const;

private:
    struct State;
    explicit BoundaryProblem(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace imomushi
