// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/meshing/appendages.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "core/reduction/element_response.h"
#include "tests/support/finite_elements.h"
#include "tests/support/voxels.h"

using namespace imomushi;
using shapes::block;
using shapes::operator+;
namespace fe = imomushi::finite_elements;

TEST_CASE("element with horns: the default moves them as second-order finite elements say, about as well as the body they stand on") {
    // A bent bar with a forked horn and a plain one. The finite elements fill the whole body.
    constexpr double kSide = 0.25;
    auto mesh = std::make_shared<ElementMesh>();
    mesh->body = shapes::surfaceOf(block({0, 0, 0}, {4, 4, 12}) + block({1, 4, 3}, {2, 9, 4}) + block({2, 4, 8}, {3, 8, 9}) + block({1, 8, 8}, {4, 9, 9}) +
                                       block({1, 9, 8}, {2, 12, 9}) + block({3, 9, 8}, {4, 12, 9}),
                                   kSide);
    Points& points = mesh->body.vertices;
    const auto bent = [](double z) { return 0.15 * z * (3.0 - z); };
    for (Eigen::Index v = 0; v < points.rows(); ++v) points(v, 1) += bent(points(v, 2));
    ResponseInput input;
    input.mesh = mesh;
    for (const double end : {0.0, 3.0})
        input.faces.push_back(jointFaceByVertices(mesh->body, shapes::patchWhere(mesh->body, [&](const Vec3& x) { return std::abs(x.z() - end) < 1e-9; }).vertices).value());
    REQUIRE(withoutAppendages(*mesh, input.faces, {})->appendages.size() == 2);
    const auto response = buildResponse(input, {});
    REQUIRE(response);

    const auto tets = fe::meshBody(mesh->body, input.faces, {0.05, 0.1, 0.2, 0.5});
    REQUIRE(tets);
    auto system = fe::Elastostatics::build(*tets, input.nu);
    REQUIRE(system);
    std::vector<Points> held;
    for (std::size_t f = 0; f < input.faces.size(); ++f)
        for (int c = 0; c < response->bases[f].columns(); ++c) {
            const FaceFrame& frame = input.faces[f].frame;
            held.emplace_back(Points::Zero(tets->nodes.rows(), 3));
            for (const std::int32_t n : tets->nodesOfFace[f])
                held.back().row(n) = (frame.axes * response->bases[f].at(frame.toLocal(tets->nodes.row(n).transpose()))).col(c).transpose();
        }
    const auto solution = system->solve(held);
    REQUIRE(solution);
    double onBody = 0.0, onHorns = 0.0;
    for (int c = 0; c < response->columns(); ++c) {
        const Points reference = tets->atVertices(solution->displacement[static_cast<std::size_t>(c)]);
        const double largest = reference.rowwise().norm().maxCoeff();
        for (std::size_t i = 0; i < response->freeVertices.size(); ++i) {
            const std::int32_t v = response->freeVertices[i];
            const double error = (response->response.col(c).segment<3>(3 * static_cast<Eigen::Index>(i)).transpose() - reference.row(v)).norm() / largest;
            double& worst = points(v, 1) > 1.0 + bent(points(v, 2)) + 1e-9 ? onHorns : onBody;
            worst = std::max(worst, error);
        }
    }
    MESSAGE("largest error of a vertex over the largest motion: ", 100.0 * onHorns, " % on horns, ", 100.0 * onBody, " % on the body; estimated error ", 100.0 * response->quality.error, " %");
    // A vertex beside a rim is wrong by 2 to 3 % on any such body. A horn multiplies what its foot's turn is wrong by, but not as solid angles do: solved
    // as a part of the body, the fork is wrong by 76 %.
    CHECK(onBody <= 0.03);
    CHECK(onHorns <= 2.0 * onBody);
}
