// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <cmath>

#include "core/mesh/write_mesh.h"
#include "tests/run/program.h"
#include "tests/support/obj.h"
#include "tests/support/shapes.h"

using namespace imomushi;

TEST_CASE("handles: a script makes four on one body, drags, turns and pins them, and gives the same bytes twice") {
    TriangleMesh mesh = shapes::sphere(1.0, 3).mesh;
    mesh.vertices.col(1) *= 1.5;
    REQUIRE(writeMesh(folder() / "egg.obj", mesh.vertices, mesh.triangles).has_value());
    const std::string lines = R"({"do":"new"}
{"do":"import-element","path":"egg.obj","name":"egg"}
{"do":"set","target":"egg","property":"solver-mesh","value":"as-is"}
{"do":"handle","element":"egg","name":"top","point":[0,1.5,0],"radius":0.4}
{"do":"handle","element":"egg","name":"foot","point":[0,-1.5,0],"radius":0.5}
{"do":"handle","element":"egg","name":"left","point":[-1,0,0]}
{"do":"handle","element":"egg","name":"right","point":[1,0,0]}
{"do":"precompute"}
{"do":"pin","endpoint":"foot"}
{"do":"drag","endpoint":"top","to":[0.3,2.0,0],"rotation":[0,0.3,0,1]}
{"do":"drag","endpoint":"left","to":[-1.5,0.2,0],"seconds":0.5}
{"do":"step","frames":40}
{"do":"measure","what":"position","endpoint":"left"}
{"do":"write-mesh","path":"posed.obj"}
{"do":"list"}
{"do":"release","endpoint":"top"}
{"do":"remove-handle","handle":"right"}
)";
    const Run run = script(lines);
    for (const Json& answer : run.answers) CHECK_MESSAGE(codeOf(answer) == "ok", answer.dump());
    REQUIRE(run.status == 0);
    REQUIRE(run.answers.size() == 17);
    CHECK(run.answers[11]["finite"] == true);
    const Json at = run.answers[12]["value"];
    CHECK(std::hypot(at[0].get<double>() + 1.5, at[1].get<double>() - 0.2, at[2].get<double>()) < 1e-9);
    CHECK(run.answers[14]["handles"].size() == 4);
    const TriangleMesh posed = readObj((folder() / "posed.obj").string());
    REQUIRE(posed.vertices.rows() == mesh.vertices.rows());
    const Eigen::VectorXd moved = (posed.vertices - mesh.vertices).rowwise().norm();
    // The foot is pinned, the left side went out by half a metre, nothing went farther than a little more than the handles did.
    Eigen::Index foot = 0, left = 0;
    mesh.vertices.col(1).minCoeff(&foot);
    mesh.vertices.col(0).minCoeff(&left);
    CHECK(moved[foot] < 1e-9);
    CHECK(moved[left] == doctest::Approx(std::hypot(0.5, 0.2)).epsilon(0.05));
    CHECK(moved.maxCoeff() < 1.0);
    const std::string bytes = readFile(folder() / "posed.obj");
    REQUIRE(script(lines).status == 0);
    CHECK(readFile(folder() / "posed.obj") == bytes);
}
