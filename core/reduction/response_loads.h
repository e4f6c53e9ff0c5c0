// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/elasticity/boundary_problem.h"
#include "core/meshing/solved_body.h"
#include "core/reduction/element_response.h"
#include "core/reduction/held_modes.h"
#include "core/reduction/touch_patches.h"

namespace imomushi {

/// The loads that a response is asked for besides its joint modes, with all faces at rest: body loads, then touch patches.
struct WantedLoads {
    const ResponseInput* input = nullptr;  ///< the whole element
    bool body = false;                     ///< body loads
    TouchPatches patches;
    Eigen::MatrixXd tractions;             ///< of the patches on the solver mesh, see place()

    void place(const SolvedBody& solved);
    /// What is to be solved; refers to `tractions`.
    [[nodiscard]] BoundaryProblem::Loads columns() const;
    /// Resultants: force, and moment about modes.middle over modes.size, 6 x columns (m^3 and m^2).
    [[nodiscard]] Eigen::MatrixXd resultants(const SolverMesh& mesh, const HeldModes& modes) const;
};

/// The solution of WantedLoads.
struct SolvedLoads {
    Eigen::MatrixXd displacement;  ///< 3 #free x k
    Eigen::MatrixXd forces;        ///< g x k, on the joint parameters
    Eigen::MatrixXd compliance;    ///< see TouchResponse
    Eigen::MatrixXd resultants;    ///< 6 x k
};
/// Solves them on the whole body, where it has appendages, which bend under them. `modes`: those of the trimmed body. Errors: those of solveStatics().
Result<SolvedLoads> solveLoadsOnWhole(const ResponseInput& input, WantedLoads& wanted, const HeldModes& modes, const ElementResponse& response,
                                      const Progress& progress);

}  // namespace imomushi
