// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <set>
#include <string>

#include "core/mesh/write_mesh.h"
#include "tests/run/program.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

/// Solves an egg that three handles hold, moves one of them, and writes what it became.
std::string eggScript(int threads) {
    return R"({"do":"new"}
{"do":"set","target":"character","property":"threads","value":)" + std::to_string(threads) + R"(}
{"do":"import-element","path":"egg.obj","name":"egg"}
{"do":"set","target":"egg","property":"solver-mesh","value":"draft"}
{"do":"handle","element":"egg","name":"top","point":[0,1.5,0],"radius":0.4}
{"do":"handle","element":"egg","name":"foot","point":[0,-1.5,0],"radius":0.5}
{"do":"handle","element":"egg","name":"left","point":[-1,0,0],"radius":0.4}
{"do":"precompute"}
{"do":"pin","endpoint":"foot"}
{"do":"drag","endpoint":"top","to":[0.3,2.0,0],"rotation":[0,0.3,0,1]}
{"do":"step","frames":3}
{"do":"write-mesh","path":"posed.obj"}
)";
}

}  // namespace

TEST_CASE("same answer: a precompute on one or two threads, on a busy machine and with little memory has the same bytes, or fails and says why") {
    const TriangleMesh mesh = [] {
        TriangleMesh egg = shapes::sphere(1.0, 4).mesh;
        egg.vertices.col(1) *= 1.5;
        return egg;
    }();
    REQUIRE(writeMesh(folder() / "egg.obj", mesh.vertices, mesh.triangles).has_value());
    // Nothing is taken over from an earlier run.
    int caches = 0;
    const auto run = [&](int threads, const std::string& before) { return script(eggScript(threads), "--cache 'cache " + std::to_string(++caches) + "'", before); };
    const Run whole = run(2, "true");
    REQUIRE_MESSAGE(whole.status == 0, whole.out);
    REQUIRE(whole.answers[7]["elements"][0]["tetrahedra"].get<int>() > 1000);
    const std::string bytes = readFile(folder() / "posed.obj");
    const auto checkSame = [&](const Run& other) {
        CHECK_MESSAGE(other.status == 0, other.out);
        CHECK(readFile(folder() / "posed.obj") == bytes);
    };
    checkSame(run(1, "true"));
    checkSame(run(2, "(for i in 1 2 3 4; do timeout 4 sh -c 'while :; do :; done' & done) 2>/dev/null"));
    // Address space, kB: from where the program hardly starts to where it is enough.
    int solved = 0, failed = 0;
    for (const int most : {400'000, 600'000, 900'000, 1'400'000, 20'000'000}) {
        CAPTURE(most);
        std::filesystem::remove(folder() / "posed.obj");
        const Run less = run(2, "ulimit -v " + std::to_string(most));
        if (less.status == 0) {
            ++solved;
            CHECK(readFile(folder() / "posed.obj") == bytes);
            continue;
        }
        ++failed;
        REQUIRE_MESSAGE(!less.answers.empty(), less.err);
        const std::string why = codeOf(less.answers.back());
        CHECK_MESSAGE((why == "no-memory" || why == "too-large" || why == "worker-failed"), less.out);
    }
    CHECK(solved > 0);
    MESSAGE(solved << " solved, " << failed << " failed for lack of memory");
}
