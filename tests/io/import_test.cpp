// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <bit>
#include <filesystem>

#include "core/io/import.h"
#include "core/mesh/write_mesh.h"
#include "tests/io/files.h"

using namespace imomushi;
namespace fs = std::filesystem;

TEST_CASE("import, write, import: every reference mesh keeps its vertices, their order and their axes, bit for bit") {
    const TestFolder folder;
    int meshes = 0;
    for (const auto& entry : fs::directory_iterator(IMOMUSHI_TEST_DATA "/reference")) {
        if (entry.path().extension() != ".obj") continue;
        CAPTURE(entry.path().string());
        ++meshes;
        const TriangleMesh plain = io_test::plainObj(entry.path());
        const auto first = io_test::import(entry.path());
        REQUIRE(first);
        REQUIRE(first->bodies.size() == 1);
        CHECK(first->bodies[0].closed);
        CHECK(first->metresPerUnit == 1.0);
        CHECK(!first->zUpConverted);
        CHECK(io_test::sameBits(plain.vertices, first->bodies[0].mesh.body.vertices));
        CHECK(plain.triangles == first->bodies[0].mesh.body.triangles);
        for (const char* suffix : {".obj", ".ply"}) {
            const fs::path copy = folder.path() / ("copy" + std::string(suffix));
            REQUIRE(writeMesh(copy, first->bodies[0].mesh.body.vertices, first->bodies[0].mesh.body.triangles));
            const auto second = io_test::import(copy);
            REQUIRE(second);
            CHECK(io_test::sameBits(plain.vertices, second->bodies[0].mesh.body.vertices));
            CHECK(plain.triangles == second->bodies[0].mesh.body.triangles);
        }
    }
    CHECK(meshes >= 7);
}
