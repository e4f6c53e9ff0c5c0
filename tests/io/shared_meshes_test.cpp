// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <map>

#include "tests/io/files.h"
#include "tests/support/left_out.h"

using namespace imomushi;
namespace fs = std::filesystem;

TEST_CASE("third-party meshes: each is imported, or refused with the right reason") {
    if (!fs::exists(IMOMUSHI_SHARED_MESHES)) return leaveOut("no folder " IMOMUSHI_SHARED_MESHES);
    struct Expected {
        const char* code;  ///< of the refusal; "closed", or the issue that keeps a body from being an element
        Eigen::Index vertices = 0, triangles = 0;
    };
    // Counts and properties from the folder's index.md, which another program made.
    const std::map<std::string, Expected> expected = {
        {"spot_low_resolution.obj", {"closed", 829, 1654}}, {"spot.obj", {"closed", 11533, 23062}}, {"spot_control_mesh.obj", {"closed", 188, 372}},
        {"fish_low_resolution.obj", {"closed", 945, 1886}}, {"penguin.obj", {"closed", 3362, 6720}}, {"koala_low_resolution.obj", {"closed", 3560, 7116}},
        {"torus.obj", {"closed", 2304, 4608}}, {"sphere.obj", {"closed", 642, 1280}}, {"model-snake.glb", {"closed", 995 - 428, 1130}},
        {"model-horse.glb", {"closed", 2146 - 437, 3414}}, {"Fox.glb", {"closed", 1728 - 1438, 576}}, {"multibody.stl", {"closed", 96 - 76, 32}},
        {"nancolor.obj", {"closed", 8, 12}}, {"negative_indices.obj", {"closed", 8, 12}},
        {"cube_no_bottom.obj", {"closed", 25, 46}},  // 40 triangles and a cap
        {"model-spider.glb", {"non-manifold-edge"}}, {"model-dragon.glb", {"non-manifold-edge"}}, {"triple_vierbein.obj", {"non-manifold-edge"}},
        {"moebius.obj", {"non-orientable"}}, {"hourglass_ico.obj", {"non-manifold-vertex"}}, {"soup.stl", {"open"}}, {"character.glb", {"open"}},
        {"Easy_Animated_Enemy_Pack_-_Jan_2019__Frog.fbx", {"non-manifold-edge", 2442, 4920}},
        {"empty.obj", {"empty-mesh"}}, {"rig-snake.glb", {"empty-mesh"}}, {"rig-spider.glb", {"empty-mesh"}},
        {"malformed.obj", {"bad-file"}}, {"truncated_chunk_data.glb", {"bad-file"}}, {"OutOfMemory.off", {"unknown-format"}}};
    for (const auto& entry : expected) {
        const std::string& name = entry.first;
        const Expected& what = entry.second;
        CAPTURE(name);
        const fs::path path = fs::path(IMOMUSHI_SHARED_MESHES) / name;
        if (!fs::exists(path)) {
            leaveOut("no " + name);
            continue;
        }
        const auto answer = io_test::import(path);
        const std::string code = what.code;
        if (!answer) {
            CHECK(answer.error().code == code);
            continue;
        }
        REQUIRE(answer->bodies.size() == 1);
        const ImportedBody& body = answer->bodies[0];
        CHECK(body.closed == (code == "closed"));
        if (code != "closed") {
            REQUIRE(io_test::find(*answer, code));
            CHECK(io_test::find(*answer, code)->severity == Severity::Error);
        }
        if (what.vertices > 0) {
            CHECK(body.mesh.body.vertices.rows() == what.vertices);
            CHECK(body.mesh.body.triangles.rows() == what.triangles);
        }
    }
}
