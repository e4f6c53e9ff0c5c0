// SPDX-License-Identifier: GPL-3.0-or-later
// What holds for the answer of an element whatever mesh it is solved on: tested on the default one, and on decimated bodies.
#include <doctest/doctest.h>
#include <lapacke.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stop_token>
#include <string>
#include <vector>

#include "core/reduction/element_response.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

ResponseInput settingInput(const shapes::Body& body, const char* solverMesh, BasisKind basis = BasisKind::Affine) {
    auto mesh = std::make_shared<ElementMesh>();
    mesh->body = body.mesh;
    ResponseInput input;
    input.mesh = mesh;
    for (const auto& end : body.ends) input.faces.push_back(jointFaceByVertices(body.mesh, end.vertices).value());
    input.nu = 0.4;
    input.basis = basis;
    input.solverMesh = parseSolverMesh(solverMesh).value();
    return input;
}

/// Joint parameters of the motion x -> x + spin x + shift of the whole body.
Eigen::VectorXd rigidMotion(const ResponseInput& input, const ElementResponse& response, const Eigen::Matrix3d& spin, const Vec3& shift) {
    Eigen::VectorXd v(response.columns());
    for (std::size_t f = 0; f < input.faces.size(); ++f) {
        const FaceFrame& frame = input.faces[f].frame;
        JointMap map;
        map.linear += frame.axes.transpose() * spin * frame.axes;
        map.shift = frame.axes.transpose() * (spin * frame.origin + shift);
        double lost = 0.0;
        response.bases[f].coefficients(map, input.faces[f].size, v.data() + response.firstColumn[f], lost);
    }
    return v;
}

shapes::Body barrel() {
    shapes::Body body = shapes::cylinder(0.5, 1.5, 12, 6);
    for (Eigen::Index v = 0; v < body.mesh.vertices.rows(); ++v) {
        const double z = body.mesh.vertices(v, 2) / 1.5;
        body.mesh.vertices.row(v).head<2>() *= 1.0 + 4.0 * z * (1.0 - z);
    }
    return body;
}

shapes::Body threeFaces() {
    shapes::Body body = shapes::box(Vec3(0, 0, 0), Vec3(1, 1, 1), 4, 4, 4);
    body.ends.push_back(shapes::patchWhere(body.mesh, [](const Vec3& p) { return p.x() == 1.0 && std::abs(p.y() - 0.5) < 0.3 && std::abs(p.z() - 0.5) < 0.3; }));
    return body;
}

shapes::Body oneFace() {
    shapes::Body body = shapes::bar(3);
    body.ends.pop_back();
    return body;
}

}  // namespace

TEST_CASE("joint stiffness: symmetric, without negative energy, and zero for the six rigid motions alone, by default") {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    const std::pair<std::string, shapes::Body> bodies[] = {{"bar", shapes::bar(3)},
                                                           {"oblique cylinder", shapes::moved(shapes::cylinder(0.5, 2.0, 12, 8), turn, Vec3(3, -1, 2))},
                                                           {"barrel", barrel()},
                                                           {"cube with three faces", threeFaces()},
                                                           {"bar with one face", oneFace()}};
    for (const auto& [name, body] : bodies) {
        CAPTURE(name);
        const ResponseInput input = settingInput(body, "default");
        const auto response = buildResponse(input, {});
        REQUIRE(response);
        const Eigen::MatrixXd& K = response->stiffness;
        CHECK(K == K.transpose());

        // In parameters of unit stiffness, so that metres and radians weigh the same. A single face moves rigidly without any stiffness.
        const bool several = input.faces.size() > 1;
        const auto g = static_cast<int>(K.rows());
        const Eigen::VectorXd unit = several ? Eigen::VectorXd(K.diagonal().cwiseSqrt().cwiseInverse()) : Eigen::VectorXd(Eigen::VectorXd::Ones(g));
        Eigen::MatrixXd scaled = unit.asDiagonal() * K * unit.asDiagonal();
        for (int axis = 0; axis < 3; ++axis) {
            const Vec3 w = Vec3::Unit(axis);
            Eigen::Matrix3d spin;
            spin << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
            for (const Eigen::VectorXd& v : {rigidMotion(input, *response, Eigen::Matrix3d::Zero(), w), rigidMotion(input, *response, spin, Vec3::Zero())}) {
                const Eigen::VectorXd inUnits = v.cwiseQuotient(unit);
                CHECK((scaled * inUnits).norm() <= 1e-11 * inUnits.norm());
                CHECK((K * v).norm() <= 1e-11 * K.norm() * v.norm());
            }
        }
        if (!several) continue;
        Eigen::VectorXd values(g);
        REQUIRE(LAPACKE_dsyev(LAPACK_COL_MAJOR, 'N', 'U', g, scaled.data(), g, values.data()) == 0);
        MESSAGE(name << ": eigenvalues " << values[0] << " ... " << values[5] << " | " << values[6] << " ... " << values[g - 1] << ", raw asymmetry " << response->quality.asymmetry);
        CHECK(values[0] >= -1e-12 * values[g - 1]);
        CHECK(values[5] <= 1e-12 * values[g - 1]);
        CHECK(values[6] >= 1e-4 * values[g - 1]);
        CHECK(response->quality.asymmetry <= 0.01);
    }
}

TEST_CASE("element: its bytes are the same for 1, 2 and 5 threads, by default and on a decimated body") {
    const shapes::Body body = shapes::cylinder(0.5, 2.0, 16, 10);
    for (const std::string solverMesh : {"default", "decimated:120"}) {
        CAPTURE(solverMesh);
        ResponseInput input = settingInput(body, solverMesh.c_str(), BasisKind::Paper);
        const auto one = buildResponse(input, {});
        REQUIRE(one);
        for (const int threads : {2, 5}) {
            input.threads = threads;
            const auto more = buildResponse(input, {});
            REQUIRE(more);
            CHECK(more->response == one->response);
            CHECK(more->stiffness == one->stiffness);
            CHECK(more->quality.error == one->quality.error);
        }
    }
}

TEST_CASE("element: cancelling at any stage of the precompute gives no answer but that") {
    const shapes::Body body = shapes::cylinder(0.5, 2.0, 16, 10);
    for (const std::string solverMesh : {"default", "decimated:120"}) {
        const ResponseInput input = settingInput(body, solverMesh.c_str(), BasisKind::Paper);
        int reports = 0;
        std::vector<std::string> stages;
        std::vector<int> first;
        REQUIRE(buildResponse(input, Progress(
                                         [&](std::string_view stage, double) {
                                             if (stages.empty() || stages.back() != stage) {
                                                 stages.emplace_back(stage);
                                                 first.push_back(reports);
                                             }
                                             ++reports;
                                         },
                                         {})));
        CHECK(stages.size() >= 3);
        // At the first report of each stage, and in the middle of all.
        first.push_back(reports / 2);
        for (const int at : first) {
            CAPTURE(solverMesh);
            CAPTURE(at);
            std::stop_source stop;
            int seen = 0;
            const auto cancelled = buildResponse(input, Progress(
                                                            [&](std::string_view, double) {
                                                                if (seen++ == at) stop.request_stop();
                                                            },
                                                            stop.get_token()));
            REQUIRE(!cancelled);
            CHECK(cancelled.error().code == kCancelled);
        }
    }
}
