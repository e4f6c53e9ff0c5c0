// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "core/body/body.h"
#include "core/io/build_result.h"
#include "core/mesh/bounds.h"
#include "tests/body/messes.h"
#include "tests/support/left_out.h"

using namespace imomushi;
using namespace imomushi::messes;
namespace fs = std::filesystem;

namespace {

Result<RawScene> read(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    return readScene({path, bytes});
}

bool meshesExist() {
    if (fs::exists(IMOMUSHI_SHARED_MESHES)) return true;
    leaveOut("no folder " IMOMUSHI_SHARED_MESHES);
    return false;
}

/// Makes it, prints it and checks what every body promises.
Body made(const std::string& name, const TriangleMesh& render, std::span<const std::int32_t> part, const BodySetting& setting) {
    auto body = makeBody(render, part, setting, {});
    REQUIRE_MESSAGE(body.has_value(), name << ": " << body.error().message);
    const BodyReport& r = body->report;
    std::printf("%-32.32s %6d -> %-7s %5d vertices  distance %.5f, largest %.4f  volume error %.5f  detail %.4f  closed gaps %.4f  %.2f s\n", name.c_str(),
                static_cast<int>(render.vertices.rows()), std::string(nameOf(r.how)).c_str(), static_cast<int>(body->mesh.vertices.rows()), r.distanceRms,
                r.distanceLargest, r.volumeError, r.detail, r.gaps.area, r.seconds);
    const MeshFacts facts = meshFacts(body->mesh);
    CHECK(facts.closed);
    CHECK(facts.outward);
    for (const MeshIssue& issue : checkMesh(body->mesh)) CHECK(issue.severity != Severity::Error);
    return std::move(*body);
}

TriangleMesh penguin() {
    const auto scene = read(fs::path(IMOMUSHI_SHARED_MESHES) / "penguin.obj");
    REQUIRE(scene.has_value());
    return scene->surface.mesh.body;
}

}  // namespace

TEST_CASE("shared meshes: every one that can be read gets a body") {
    if (!meshesExist()) return;
    // Not characters: a strip with one side, loose triangles, crossing sheets. They are wrapped; the others need no wrap.
    const std::set<std::string> wrapped{"moebius.obj", "soup.stl", "triple_vierbein.obj"};
    std::set<fs::path> paths;
    for (const auto& entry : fs::directory_iterator(IMOMUSHI_SHARED_MESHES))
        if (!formatOf(entry.path()).empty()) paths.insert(entry.path());
    for (const fs::path& path : paths) {
        const std::string name = path.filename();
        CAPTURE(name);
        const auto scene = read(path);
        if (!scene || scene->surface.mesh.body.triangles.rows() == 0) continue;  // malformed, or a skeleton alone
        BodySetting setting;
        if (wrapped.contains(name)) setting.detail = 0.03;
        const Body body = made(name, scene->surface.mesh.body, scene->surface.part, setting);
        CHECK((body.report.how == BodyKind::Wrapped) == wrapped.contains(name));
    }
}

TEST_CASE("shared meshes: dirty variants of a character get its body") {
    if (!meshesExist()) return;
    const TriangleMesh clean = penguin();
    const double volume = meshFacts(clean).volume;
    const Vec3 size = boundsOf(clean.vertices).size();
    TriangleMesh fin = clean;
    fin.vertices.conservativeResize(clean.vertices.rows() + 1, 3);
    fin.vertices.bottomRows(1) = clean.vertices.row(clean.triangles(0, 0)) + Eigen::RowVector3d::Constant(0.3);
    fin = withTriangle(fin, clean.triangles(0, 0), clean.triangles(0, 1), static_cast<int>(clean.vertices.rows()));
    TriangleMesh middle = clean;  // a vertex in the middle of an edge, which a triangle without area fills
    middle.vertices.conservativeResize(clean.vertices.rows() + 1, 3);
    middle.vertices.bottomRows(1) = (clean.vertices.row(clean.triangles(0, 0)) + clean.vertices.row(clean.triangles(0, 1))) / 2;
    middle = withTriangle(middle, clean.triangles(0, 0), clean.triangles(0, 1), static_cast<int>(clean.vertices.rows()));
    TriangleMesh jittered = exploded(clean, 1.0);
    jittered = broken(jittered, 7, 0.0, 0.0, 0.0, 1e-7);
    const std::vector<std::pair<std::string, TriangleMesh>> variants{
        {"inverted", inverted(clean)}, {"mixed winding", broken(clean, 7, 0.0, 0.1, 0.0, 0.0)}, {"split vertices", exploded(clean, 1.0)}, {"jittered", jittered},
        {"one hole", without(clean, {0})}, {"duplicates", broken(clean, 7, 0.0, 0.0, 0.01, 0.0)}, {"zero area", middle}, {"fin", fin},
        {"collapsed", withTriangle(withTriangle(clean, 0, 0, 1), 2, 2, 2)}};
    for (const auto& [name, mesh] : variants) {
        CAPTURE(name);
        const Body body = made("penguin, " + name, mesh, {}, {});
        CHECK(body.report.how != BodyKind::Wrapped);
        CHECK(meshFacts(body.mesh).volume == doctest::Approx(volume).epsilon(1e-4));
    }
    const Body cavity = made("penguin, nested cavity", both(clean, inverted(moved(clean, 0.5, clean.vertices.colwise().mean().transpose() * 0.5))), {}, {});
    CHECK(meshFacts(cavity.mesh).volume == doctest::Approx(volume * 7 / 8));
    CHECK(made("penguin, two disjoint", both(clean, moved(clean, 1.0, 1.5 * size)), {}, {}).report.components == 2);
    const Body two = made("penguin, two overlapping", both(clean, moved(clean, 1.0, 0.2 * size)), {}, {});
    CHECK(two.report.components == 1);
    CHECK(meshFacts(two.mesh).volume < 2.0 * volume);
    CHECK(meshFacts(two.mesh).volume > volume);
}

TEST_CASE("shared meshes: a clean character wrapped on purpose keeps its volume and its limbs apart") {
    if (!meshesExist()) return;
    const TriangleMesh mesh = penguin();
    const Body body = made("penguin, wrapped", mesh, {}, {BodyKind::Wrapped, 0.0});
    CHECK(body.report.volumeError < 1e-3);
    CHECK(body.report.distanceRms < 1e-3);
    CHECK(body.report.components == 1);
    CHECK(body.report.gaps.area < 0.005);  // the innermost of its armpits; a coarse wrap closes all of the gaps below the flippers, some .05
}
