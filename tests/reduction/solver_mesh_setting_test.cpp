// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>
#include <rapidcheck.h>

#include "core/meshing/solver_mesh_setting.h"

using namespace imomushi;
using Kind = SolverMeshSetting::Kind;

TEST_CASE("solver mesh setting: every name is read and written back") {
    CHECK(parseSolverMesh("as-is").value() == SolverMeshSetting{Kind::AsIs, 0});
    CHECK(parseSolverMesh("default").value() == SolverMeshSetting{Kind::Default, 0});
    CHECK(parseSolverMesh("best").value() == SolverMeshSetting{Kind::Best, 0});
    CHECK(parseSolverMesh("refined:2000").value() == SolverMeshSetting{Kind::Refined, 2000});
    CHECK(parseSolverMesh("decimated:4").value() == SolverMeshSetting{Kind::Decimated, 4});
    CHECK(parseSolverMesh("volume").value() == SolverMeshSetting{Kind::Volume, 0});
    CHECK(parseSolverMesh("volume:900").value() == SolverMeshSetting{Kind::Volume, 900});
    CHECK(SolverMeshSetting{} == SolverMeshSetting{Kind::Default, 0});
    CHECK(rc::check([](bool refined) {
        const int count = *rc::gen::inRange(SolverMeshSetting::kFewest, SolverMeshSetting::kMax + 1);
        const SolverMeshSetting setting{refined ? Kind::Refined : Kind::Decimated, count};
        RC_ASSERT(parseSolverMesh(solverMeshName(setting)).value() == setting);
    }));
    for (const Kind kind : {Kind::AsIs, Kind::Default, Kind::Best, Kind::Draft, Kind::Volume}) CHECK(parseSolverMesh(solverMeshName({kind, 0})).value().kind == kind);
}

TEST_CASE("solver mesh setting: what is no setting is refused with what to write instead") {
    for (const char* text : {"", "As-is", "fine", "refined", "refined:", "refined:many", "refined:-5", "refined:+5", "refined: 5", "refined:5 ", "refined:12.5",
                             "refined:1e4", "refinedx:5", "decimated:3", "decimated:0", "refined:10000001", "refined:99999999999999999999", "decimated:\xE8\x8A\x8B",
                             "best:2", "as-is:4", "best@0.001"}) {
        const auto read = parseSolverMesh(text);
        REQUIRE_MESSAGE(!read, text);
        CHECK(read.error().code == "bad-value");
        CHECK(read.error().message.find(';') != std::string::npos);  // what is wrong; what to do
    }
    CHECK(parseSolverMesh("refined").error().message.find("refined:2000") != std::string::npos);
    CHECK(parseSolverMesh("decimated:x").error().message.find("not a number") != std::string::npos);
    CHECK(parseSolverMesh("decimated:3").error().message.find("4 to 10000000") != std::string::npos);
    CHECK(parseSolverMesh("nothing").error().message.find("decimated:N") != std::string::npos);
    CHECK(parseSolverMesh("refined:x\ny").error().code == "bad-value");
}
