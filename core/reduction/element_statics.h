// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/elasticity/boundary_problem.h"
#include "core/meshing/appendages.h"
#include "core/meshing/solved_body.h"
#include "core/reduction/element_response.h"

namespace imomushi {

/// An element and the one solved in its place: the same without its appendages, which follow (see TrimmedBody).
struct TrimmedElement {
    const ResponseInput* whole = nullptr;
    ResponseInput input;                                ///< of the trimmed body
    TrimmedBody body;
    std::vector<std::int32_t> freeVertices, wholeFree;  ///< ascending: of the trimmed body and of the whole one
};
/// Errors: those of withoutAppendages().
Result<TrimmedElement> trimmedElement(const ResponseInput& whole, const Progress& progress);

/// Statics of one element on one solver mesh.
struct StaticSolution {
    Eigen::MatrixXd response;    ///< 3 * #free x k: displacement of the free vertices of the whole body; the columns of loads come last
    Eigen::MatrixXd forces;      ///< 3 * #held x k: what holds the vertices of the faces, linear on their triangles, for shear modulus 1
    Eigen::MatrixXd compliance;  ///< of touch patches, see patchCompliance()
    SolveQuality quality;
    std::int64_t nodes = 0;      ///< three unknowns each
    double mappingError = 0.0, shapeError = 0.0;  ///< see ResponseQuality
};
/// `held`: displacements of the held vertices of the solver mesh, 3 * #held x k; `inside`: those of SolvedBody::inside, 3 * # x k. Errors: those of
/// BoundaryProblem::build() and solve(), or of VolumeProblem.
Result<StaticSolution> solveStatics(const TrimmedElement& element, const SolvedBody& solved, const Eigen::MatrixXd& held, const Eigen::MatrixXd& inside,
                                    const BoundaryProblem::Loads& loads, const Progress& progress);

/// Ascending body vertices that no joint face holds.
std::vector<std::int32_t> freeVerticesOf(const ResponseInput& input);

/// Whether finite elements may solve it, if its body can be filled: not beyond VolumeProblem::kLargestNu.
bool filled(const ResponseInput& input);

/// buildResponse(), and what the input was solved as: default climbs to best where it says that it is not within 1 %.
Result<ElementResponse> buildResponse(const ResponseInput& input, SolverMeshSetting& solvedAs, const Progress& progress);

/// What buildResponse() refuses before it computes anything.
Result<void> checkInput(const ResponseInput& input);

}  // namespace imomushi
