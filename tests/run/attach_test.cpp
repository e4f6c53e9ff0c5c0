// SPDX-License-Identifier: GPL-3.0-or-later
// The eyes of a character that others made: left out of its body, they keep their shape and look around.
#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tests/run/program.h"
#include "tests/support/left_out.h"
#include "tests/support/obj.h"

using namespace imomushi;

namespace {

double deformation(const Points& was, const Points& now) {
    double worst = 0.0;
    for (Eigen::Index a = 0; a < was.rows(); a += 7)
        for (Eigen::Index b = 0; b < a; ++b)
            if (const double before = (was.row(a) - was.row(b)).norm(); before > 0.0)
                worst = std::max(worst, std::abs((now.row(a) - now.row(b)).norm() - before) / before);
    return worst;
}

}  // namespace

TEST_CASE("attach: the frog's eyes follow its head rigidly, look around, and are in the take") {
    const std::filesystem::path frog = std::filesystem::path(IMOMUSHI_SHARED_MESHES) / "Easy_Animated_Enemy_Pack_-_Jan_2019__Frog.fbx";
    if (!std::filesystem::exists(frog)) return leaveOut("no " + frog.string());
    const std::string lines = R"({"do":"import-character","path":")" + frog.string() + R"(","name":"frog"}
{"do":"set","target":"frog body","property":"solver-mesh","value":"decimated:400"}
{"do":"handle","element":"frog body","name":"head","point":[0,1.3,1.2],"radius":0.25}
{"do":"handle","element":"frog body","name":"bottom","point":[0,0.3,-1.4],"radius":0.25}
{"do":"precompute"}
{"do":"pin","endpoint":"bottom"}
{"do":"drag","endpoint":"head","to":[0.5,1.7,1.5],"rotation":[0.2,0.3,0,1]}
{"do":"write-mesh","path":"auto.obj","character":"frog"}
{"do":"attach","character":"frog","part":"Frog#2","mode":"flesh"}
{"do":"attach","character":"frog","part":"Frog#3","mode":"flesh"}
{"do":"write-mesh","path":"flesh.obj","character":"frog"}
{"do":"attach","character":"frog","part":"Frog#2","mode":"rigid"}
{"do":"attach","character":"frog","part":"Frog#3","mode":"rigid"}
{"do":"write-mesh","path":"rigid.obj","character":"frog"}
{"do":"write-mesh","path":"rest.obj","character":"frog","state":"rest"}
{"do":"record","take":"look","action":"start"}
{"do":"turn-part","character":"frog","part":"Frog#2","rotation":[0,0.3,0,1],"seconds":0.2}
{"do":"turn-part","character":"frog","part":"Frog#3","rotation":[0,0.3,0,1],"seconds":0.2}
{"do":"step","frames":15}
{"do":"record","take":"look","action":"stop"}
{"do":"write-mesh","path":"look.obj","character":"frog"}
{"do":"save","path":"frog.imomushi"}
{"do":"open","path":"frog.imomushi"}
{"do":"play","take":"look"}
{"do":"write-mesh","path":"played.obj","character":"frog"}
{"do":"list"}
)";
    const Run run = script(lines, "--cache cache");
    for (const Json& answer : run.answers) CHECK_MESSAGE(codeOf(answer) == "ok", answer.dump());
    REQUIRE(run.status == 0);
    const Json shells = run.answers.back()["characters"][0]["parts"][0]["shells"];
    REQUIRE(shells.size() == 3);
    const auto read = [](const char* name) { return readObj((folder() / name).string()).vertices; };
    const Points rest = read("rest.obj"), flesh = read("flesh.obj"), rigid = read("rigid.obj"), look = read("look.obj");
    CHECK((read("played.obj") - look).cwiseAbs().maxCoeff() == 0.0);
    const auto head = shells[0]["vertices"].get<Eigen::Index>();  // the file has it first
    CHECK((look - rigid).topRows(head).cwiseAbs().maxCoeff() < 1e-9);
    CHECK((rigid - flesh).topRows(head).cwiseAbs().maxCoeff() == 0.0);
    for (const std::size_t eye : {1u, 2u}) {
        CAPTURE(eye);
        CHECK(shells[eye]["mode"] == "rigid");
        const double side = shells[eye]["pivot"][0].get<double>();
        std::vector<Eigen::Index> rows;
        for (Eigen::Index v = head; v < rest.rows(); ++v)
            if (rest(v, 0) * side > 0.0) rows.push_back(v);
        REQUIRE(rows.size() == shells[eye]["vertices"].get<std::size_t>());
        const auto of = [&rows](const Points& all) -> Points { return all(rows, Eigen::indexing::all); };
        CHECK(deformation(of(rest), of(read("auto.obj"))) < 1e-9);
        CHECK(deformation(of(rest), of(flesh)) > 1e-3);
        CHECK(deformation(of(rest), of(rigid)) < 1e-9);
        CHECK(deformation(of(rest), of(look)) < 1e-9);
        // It sits where the flesh would have it, which squeezes the eye by more than this.
        const double off = (of(rigid) - of(flesh)).rowwise().norm().mean() / (of(rest).rowwise() - of(rest).colwise().mean()).rowwise().norm().maxCoeff();
        MESSAGE("eye " << eye << ": flesh deforms by " << deformation(of(rest), of(flesh)) << ", rigid is off by " << off << " of its radius");
        CHECK(off < 0.25);
        // Turned by the angle that was asked for.
        const Points a = of(rigid).rowwise() - of(rigid).colwise().mean(), b = of(look).rowwise() - of(look).colwise().mean();
        const Eigen::Matrix3d turn = ((a.transpose() * a).inverse() * (a.transpose() * b)).transpose();
        CHECK(std::acos(std::min(1.0, 0.5 * (turn.trace() - 1.0))) == doctest::Approx(2.0 * std::atan(0.3)).epsilon(1e-6));
    }
}
