// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reduction/response_loads.h"

#include <Eigen/Geometry>
#include <utility>

#include "core/elasticity/boundary_equation.h"
#include "core/mesh/topology.h"
#include "core/reduction/element_statics.h"
#include "core/reduction/touch_response.h"

namespace imomushi {

namespace {

/// Resultants of the body loads along the rigid motions of HeldModes: 6 x kLoads, m^3 and m^2.
Eigen::Matrix<double, 6, BoundaryEquation::kLoads> bodyLoadResultants(const ResponseInput& input, const HeldModes& modes) {
    const TriangleMesh& body = input.mesh->body;
    std::vector<char> covered(static_cast<std::size_t>(body.triangles.rows()));
    for (const JointFace& face : input.faces)
        for (const std::int32_t f : face.triangles) covered[static_cast<std::size_t>(f)] = 1;
    double volume = 0.0;
    Vec3 firstMoment = Vec3::Zero(), pressure = Vec3::Zero(), pressureMoment = Vec3::Zero();
    for (std::int32_t f = 0; f < body.triangles.rows(); ++f) {
        Vec3 corners = Vec3::Zero();
        for (int c = 0; c < 3; ++c) corners += body.vertices.row(body.triangles(f, c)).transpose() - modes.middle;
        const Vec3 area = 0.5 * areaVector(body, f);
        const double cone = area.dot(Vec3(body.vertices.row(body.triangles(f, 0)).transpose()) - modes.middle) / 3.0;  // volume of the tetrahedron from the middle to the triangle
        volume += cone;
        firstMoment += cone * corners / 4.0;
        if (covered[static_cast<std::size_t>(f)]) continue;
        pressure += area;
        pressureMoment += (corners / 3.0).cross(area);
    }
    Eigen::Matrix<double, 6, BoundaryEquation::kLoads> out;
    for (int axis = 0; axis < 3; ++axis) {
        out.col(axis).head<3>() = volume * Vec3::Unit(axis);
        out.col(axis).tail<3>() = firstMoment.cross(Vec3::Unit(axis)) / modes.size;
    }
    out.col(3) << pressure, pressureMoment / modes.size;
    return out;
}

}  // namespace

void WantedLoads::place(const SolvedBody& solved) {
    if (patches.count() > 0) tractions = patchTractions(patches, input->mesh->body, input->faces, solved);
}

BoundaryProblem::Loads WantedLoads::columns() const { return {body, patches.count() > 0 ? &tractions : nullptr}; }

Eigen::MatrixXd WantedLoads::resultants(const SolverMesh& mesh, const HeldModes& modes) const {
    const Eigen::Index ofBody = body ? BoundaryEquation::kLoads : 0;
    Eigen::MatrixXd out(6, ofBody + 3 * patches.count());
    if (body) out.leftCols(ofBody) = bodyLoadResultants(*input, modes);
    if (patches.count() > 0) out.rightCols(3 * patches.count()) = patchResultants(mesh, tractions, modes.middle, modes.size);
    return out;
}

Result<SolvedLoads> solveLoadsOnWhole(const ResponseInput& input, WantedLoads& wanted, const HeldModes& modes, const ElementResponse& response,
                                      const Progress& progress) {
    const TrimmedElement whole{&input, input, {}, response.freeVertices, response.freeVertices};
    const auto solved = solvedBody(input.mesh->body, input.faces, input.solverMesh, progress.part(0.0, 0.1), filled(input));
    if (!solved) return tl::make_unexpected(solved.error());
    wanted.place(*solved);
    const HeldModes solvedModes = heldModes(input.mesh->body, input.faces, *solved, response.bases, response.firstColumn);
    const Eigen::MatrixXd& C = solvedModes.C;
    auto solution = solveStatics(whole, *solved, C, solvedModes.inside, wanted.columns(), progress.part(0.1, 1.0));
    if (!solution) return tl::make_unexpected(solution.error());
    const Eigen::Index count = wanted.columns().columns();
    return SolvedLoads{solution->response.rightCols(count), C.transpose() * solution->forces.rightCols(count), std::move(solution->compliance),
                 wanted.resultants(solved->mesh, modes)};
}

}  // namespace imomushi
