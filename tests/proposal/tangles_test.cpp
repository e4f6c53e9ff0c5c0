// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces that cross, touch and lie on themselves: whatever comes of them, something does.
#include <doctest/doctest.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>
#include <set>
#include <string>

#include "core/body/body.h"
#include "core/body/cut.h"
#include "core/io/build_result.h"
#include "core/mesh/bounds.h"
#include "core/proposal/proposal_codec.h"
#include "core/proposal/rig_proposal.h"
#include "core/proposal/shape_proposal.h"
#include "core/worker/worker.h"
#include "tests/support/capsules.h"
#include "tests/support/shapes.h"
#include "tests/support/thorough.h"
#include "tests/support/without_steps.h"

using namespace imomushi;

namespace {

CharacterFile read(const std::string& name) {
    const std::string path = std::string(IMOMUSHI_TEST_DATA) + "/characters/" + name;
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    auto scene = readScene({path, bytes}, SceneUse::Character);
    REQUIRE(scene);
    ImportRequest request;
    request.path = path;
    auto character = buildCharacter(std::move(*scene), request, {});
    REQUIRE(character);
    return std::move(*character);
}

/// Uniform in [low, high), the same on every machine.
class Random {
public:
    explicit Random(std::uint32_t seed) : bits_(seed) {}
    double in(double low, double high) { return low + (high - low) * (static_cast<double>(bits_()) / 4294967296.0); }
    Vec3 vector() { return {in(-1, 1), in(-1, 1), in(-1, 1)}; }
    std::int32_t below(std::int32_t n) { return static_cast<std::int32_t>(bits_() % static_cast<std::uint32_t>(n)); }

private:
    std::mt19937 bits_;
};

void append(TriangleMesh& to, const TriangleMesh& more) {
    const Eigen::Index v = to.vertices.rows(), f = to.triangles.rows();
    to.vertices.conservativeResize(v + more.vertices.rows(), 3);
    to.vertices.bottomRows(more.vertices.rows()) = more.vertices;
    to.triangles.conservativeResize(f + more.triangles.rows(), 3);
    to.triangles.bottomRows(more.triangles.rows()) = (more.triangles.array() + static_cast<std::int32_t>(v)).matrix();
}

/// Mirrored by the plane x = 0, still facing outward.
TriangleMesh mirrored(TriangleMesh m) {
    m.vertices.col(0) *= -1.0;
    m.triangles.col(1).swap(m.triangles.col(2));
    return m;
}

TriangleMesh something(Random& random) {
    switch (random.below(4)) {
        case 0: return shapes::box({-1.0, -0.4, -0.3}, {1.0, 0.4, 0.3}, 2 + random.below(6), 1 + random.below(3), 1 + random.below(3)).mesh;
        case 1: return shapes::cylinder(random.in(0.2, 0.6), random.in(1.0, 3.0), 5 + random.below(10), 2 + random.below(8)).mesh;
        case 2: return shapes::sphere(random.in(0.4, 1.0), 1 + random.below(3)).mesh;
        default: return shapes::torus(1.0, random.in(0.15, 0.45), 8 + random.below(8), 5 + random.below(6)).mesh;
    }
}

/// Vertices go to the other side of the middle, or somewhat beyond.
TriangleMesh pushedThrough(Random& random) {
    TriangleMesh mesh = something(random);
    const Vec3 middle = boundsOf(mesh.vertices).low + 0.5 * boundsOf(mesh.vertices).size();
    for (std::int32_t n = 1 + random.below(5); n > 0; --n) {
        const std::int32_t v = random.below(static_cast<std::int32_t>(mesh.vertices.rows()));
        mesh.vertices.row(v) = (middle - random.in(0.01, 1.5) * (Vec3(mesh.vertices.row(v).transpose()) - middle)).transpose();
    }
    return mesh;
}

/// On some triangles of a shell lies another one, triangle on triangle or with other diagonals; a mesh laid on a copy of itself among them.
TriangleMesh laidOn(Random& random) {
    const TriangleMesh below = something(random);
    TriangleMesh mesh = below;
    for (std::int32_t n = 1 + random.below(3); n > 0; --n) {
        TriangleMesh above = below;
        const double how = random.in(0.0, 4.0);
        const Vec3 away = random.vector();
        const std::int32_t middle = random.below(static_cast<std::int32_t>(below.vertices.rows()));
        const double reach = random.in(0.2, 0.9) * diagonalOf(below.vertices);
        if (how < 1.0) {  // stays where it is: all of it on the other
        } else if (how < 3.0) {  // a part stays, the other is drawn away: into the flesh or out of it
            for (Eigen::Index v = 0; v < above.vertices.rows(); ++v)
                if ((below.vertices.row(v) - below.vertices.row(middle)).norm() > reach) above.vertices.row(v) += away.transpose();
        } else {  // shifted along itself
            above.vertices.col(random.below(3)).array() += std::round(random.in(-4.0, 4.0)) / 4.0;
        }
        if (random.below(2) == 0) above.triangles.col(1).swap(above.triangles.col(2));
        append(mesh, above);
    }
    return mesh;
}

/// A half and its mirror image, which overlap, touch, or cross each other vertex by vertex at the seam.
TriangleMesh halves(Random& random) {
    TriangleMesh half = something(random);
    half.vertices.col(0).array() += std::abs(half.vertices.col(0).minCoeff()) * random.in(0.2, 1.0);
    const double seam = random.in(0.0, 0.1);
    for (Eigen::Index v = 0; v < half.vertices.rows(); ++v)
        if (half.vertices(v, 0) < seam) half.vertices(v, 0) = random.below(3) == 0 ? 0.0 : random.in(-0.02, 0.02);
    TriangleMesh whole = half;
    append(whole, mirrored(half));
    return whole;
}

void tangle(std::uint32_t seed, std::set<std::string>& outcomes) {
    CAPTURE(seed);
    Random random(seed);
    const TriangleMesh mesh = seed % 3 == 0 ? pushedThrough(random) : seed % 3 == 1 ? laidOn(random) : halves(random);
    const auto body = makeBody(mesh, {}, {}, {});
    if (!body) {
        CHECK(body.error().message.size() > 20);
        outcomes.insert(body.error().code);
        return;
    }
    outcomes.insert(std::string(nameOf(body->report.how)));
    const MeshFacts facts = meshFacts(body->mesh);
    CHECK(facts.closed);
    CHECK(facts.outward);
    std::vector<CutPlane> cuts;
    for (int c = 0; c < 3; ++c) cuts.push_back({facts.low + (facts.high - facts.low).cwiseProduct(Vec3(random.in(0, 1), random.in(0, 1), random.in(0, 1))), random.vector()});
    if (const auto pieces = cutBody(body->mesh, cuts))
        for (const BodyPiece& piece : *pieces) CHECK(meshFacts(piece.body).closed);
    else
        CHECK(pieces.error().message.size() > 20);
    const auto proposal = proposeFromShape(body->mesh, kLeastShare, {});
    CHECK((proposal || proposal.error().message.size() > 20));
}

}  // namespace

TEST_CASE("a character whose halves cross each other at the muzzle gets a body that does not, and is cut at muzzle and head, too") {
    const CharacterFile file = read("crossing_halves.glb");
    const auto body = makeBody(file.renderModel.mesh.body, file.renderModel.part, {}, {});
    REQUIRE(body);
    CHECK(body->report.how == BodyKind::Mended);
    for (const MeshIssue& issue : checkMesh(body->mesh)) CHECK_MESSAGE(issue.severity == Severity::Info, issue.text);
    CHECK(body->report.distanceLargest < 0.01);
    const auto proposal = proposeFromRig(*file.rig, file.renderModel.mesh.body, body->mesh, std::nullopt, {});
    REQUIRE(proposal);
    CHECK(proposal->cuts.size() == 19);
    for (const char* name : {"head cut", "muzzle cut", "ear.L cut", "ear.R cut"}) CHECK_MESSAGE(std::any_of(proposal->cuts.begin(), proposal->cuts.end(), [&](const ProposedCut& cut) { return cut.name == name; }), name);
}

TEST_CASE("a character whose legs lie on its chest triangle on triangle becomes one closed body by mending") {
    const CharacterFile file = read("legs_on_patches.glb");
    const auto body = makeBody(file.renderModel.mesh.body, file.renderModel.part, {}, {});
    REQUIRE(body);
    CHECK(body->report.how == BodyKind::Mended);
    const MeshFacts facts = meshFacts(body->mesh);
    CHECK(facts.outward);
    CHECK(facts.components == 1);
    for (const MeshIssue& issue : checkMesh(body->mesh)) CHECK_MESSAGE(issue.severity == Severity::Info, issue.text);
}

TEST_CASE("boxes that lie on each other triangle on triangle are one: their volumes add up, or the larger one has both") {
    const TriangleMesh below = shapes::box({0, 0, 0}, {2, 1, 2}, 2, 1, 2).mesh;
    const auto united = [&](const TriangleMesh& other) {
        TriangleMesh mesh = below;
        append(mesh, other);
        const auto body = makeBody(mesh, {}, {}, {});
        REQUIRE(body);
        CHECK(body->report.how == BodyKind::Mended);
        return meshFacts(body->mesh);
    };
    // Against each other on one square of four; the same square again, seen from inside.
    CHECK(united(shapes::box({0, 1, 0}, {1, 2, 1}, 1, 1, 1).mesh).volume == doctest::Approx(5.0).epsilon(1e-12));
    CHECK(united(shapes::box({0, 0.5, 0}, {1, 1, 1}, 1, 1, 1).mesh).volume == doctest::Approx(4.0).epsilon(1e-12));
}

TEST_CASE("bodies, cuts and proposals are the same, byte for byte, made here and by a worker") {
    struct Made {
        Body body;
        Proposal fromRig, fromShape;
        std::vector<BodyPiece> pieces;
        CutRefusal refusal;
    };
    const CharacterFile file = read("legs_on_patches.glb");
    const auto make = [&] {
        Made made;
        auto body = makeBody(file.renderModel.mesh.body, file.renderModel.part, {}, {});
        REQUIRE(body);
        made.body = std::move(*body);
        auto rig = proposeFromRig(*file.rig, file.renderModel.mesh.body, made.body.mesh, std::nullopt, {});
        auto shape = proposeFromShape(made.body.mesh, kLeastShare, {});
        REQUIRE(rig);
        REQUIRE(shape);
        made.fromRig = std::move(*rig);
        made.fromShape = std::move(*shape);
        std::vector<CutPlane> planes;
        for (const ProposedCut& cut : made.fromRig.cuts) planes.push_back(cut.plane);
        auto pieces = cutBody(made.body.mesh, planes);
        REQUIRE(pieces);
        made.pieces = std::move(*pieces);
        planes.push_back(planes[0]);
        auto refused = cutBody(made.body.mesh, planes);
        REQUIRE(!refused);
        made.refusal = std::move(refused.error());
        made.body.report.seconds = 0.0;
        return made;
    };
    const auto bytes = [](const auto& value) { return messageOf(value); };  // what a message carries is all there is
    setWorkerProgram({});
    const Made here = make();
    setWorkerProgram("/proc/self/exe");
    const Made there = make();
    CHECK(bytes(there.body) == bytes(here.body));
    CHECK(bytes(there.fromRig) == bytes(here.fromRig));
    CHECK(bytes(there.fromShape) == bytes(here.fromShape));
    CHECK(bytes(there.pieces) == bytes(here.pieces));
    CHECK(bytes(there.refusal) == bytes(here.refusal));
    CHECK(there.refusal.code == "cuts-touch");
}

TEST_CASE("bodies, cuts and proposals are the same, byte for byte, wherever in memory they are made") {
    setWorkerProgram({});
    const auto bytes = [](std::uint32_t seed) {
        Random random(seed);
        const TriangleMesh mesh = seed % 3 == 0 ? pushedThrough(random) : seed % 3 == 1 ? laidOn(random) : halves(random);
        MessageOut out;
        auto body = makeBody(mesh, {}, {}, {});
        if (body) {
            body->report.seconds = 0.0;
            const MeshFacts facts = meshFacts(body->mesh);
            out(cutBody(body->mesh, std::vector<CutPlane>{{0.5 * (facts.low + facts.high) + 0.01 * random.vector(), random.vector()}}));
            out(proposeFromShape(body->mesh, kLeastShare, {}));
        }
        out(body);
        return out.take();
    };
    const int count = repeats(3, 60);
    // Blocks from some size on get addresses that descend, and never those of others; then all come from one heap.
    std::vector<std::string> one;
    ::mallopt(M_MMAP_THRESHOLD, 256);
    for (int seed = 0; seed < count; ++seed) one.push_back(bytes(static_cast<std::uint32_t>(seed)));
    ::mallopt(M_MMAP_THRESHOLD, 32 << 20);
    for (int seed = 0; seed < count; ++seed) CHECK_MESSAGE(bytes(static_cast<std::uint32_t>(seed)) == one[static_cast<std::size_t>(seed)], seed);
    setWorkerProgram("/proc/self/exe");
}

TEST_CASE("proposals without lines that shapes shrink to: where that breaks down the finer ones are left out, or the shape gets handles, and a note says so") {
    const TriangleMesh body = capsules::animal();
    const auto without = [&](const std::vector<std::string>& steps) {
        return withoutSteps<Proposal>(steps, "propose-from-shape", body, kLeastShare);
    };
    const auto notes = [](const Proposal& proposal, const char* code) {
        return std::count_if(proposal.notes.begin(), proposal.notes.end(), [&](const auto& note) { return note.code == code; });
    };
    const auto whole = without({}), none = without({"shrinking the shape to lines (1)"});
    REQUIRE(whole);
    REQUIRE(none);
    CHECK(whole->cuts.size() > 0);
    CHECK(none->cuts.empty());
    CHECK(none->handles.size() > 0);
    CHECK(notes(*none, "no-skeleton") == 1);
    CHECK(notes(*none, "left-out") == 1);
}

TEST_CASE("tangles of all kinds become a body that can be cut, or a reason") {
    std::set<std::string> outcomes;
    tangle(310, outcomes);  // parts of its surface meet in a vertex alone: untangling it had no end
    tangle(463, outcomes);  // its cuts leave polygons of hundreds of points, whose triangulation took minutes
    const int count = repeats(6, 500);
    for (int seed = 0; seed < count; ++seed) tangle(static_cast<std::uint32_t>(seed), outcomes);
    // Not all of them are refused, and not all are simple.
    CHECK(outcomes.size() >= 2);
}
