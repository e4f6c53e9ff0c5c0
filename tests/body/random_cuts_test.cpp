// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <random>
#include <string>

#include "core/body/cut.h"
#include "core/mesh/cgal/intersections.h"
#include "tests/body/cut_checks.h"
#include "tests/support/left_out.h"
#include "tests/support/obj.h"
#include "tests/support/shapes.h"
#include "tests/support/voxels.h"

using namespace imomushi;
using shapes::operator+;

namespace {

struct Named {
    std::string name;
    TriangleMesh body;
};

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

/// A star of lobes, like a body with limbs.
TriangleMesh lobes(int levels) {
    TriangleMesh mesh = shapes::sphere(1.0, levels).mesh;
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
        const Vec3 p = mesh.vertices.row(v).transpose();
        mesh.vertices.row(v) *= 0.4 + std::pow(std::abs(p.x() * p.x() * p.x()) + std::abs(p.y() * p.y() * p.y()) + std::abs(p.z() * p.z() * p.z()), 2.0);
    }
    return mesh;
}

TriangleMesh jittered(TriangleMesh mesh, double by) {
    Random random(5);
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) mesh.vertices.row(v) += by * random.vector().transpose();
    return mesh;
}

TriangleMesh hollow() {
    const TriangleMesh a = shapes::sphere(1.0, 3).mesh, b = shapes::inverted(shapes::sphere(0.6, 2)).mesh;
    TriangleMesh both = a;
    both.vertices.conservativeResize(a.vertices.rows() + b.vertices.rows(), 3);
    both.vertices.bottomRows(b.vertices.rows()) = b.vertices;
    both.triangles.conservativeResize(a.triangles.rows() + b.triangles.rows(), 3);
    both.triangles.bottomRows(b.triangles.rows()) = b.triangles.array() + static_cast<std::int32_t>(a.vertices.rows());
    return both;
}

std::vector<Named> ownBodies() {
    return {{"limb", shapes::cylinder(0.5, 3.0, 24, 18).mesh},
            {"torus", shapes::torus(1.0, 0.3, 40, 16).mesh},
            {"sphere", shapes::sphere(1.0, 3).mesh},
            {"icosahedron", shapes::sphere(1.0, 0).mesh},
            {"coarse box", shapes::box(Vec3::Zero(), Vec3(1, 1, 4), 1, 1, 1).mesh},
            {"bar", shapes::bar(4).mesh},
            {"plate", shapes::box(Vec3::Zero(), Vec3(1, 1, 0.02), 20, 20, 1).mesh},
            {"table", shapes::surfaceOf(shapes::block({0, 0, 3}, {6, 6, 4}) + shapes::block({0, 0, 0}, {1, 1, 3}) + shapes::block({5, 0, 0}, {6, 1, 3}) +
                                            shapes::block({2, 4, 0}, {4, 6, 3}),
                                        0.25)},
            {"lobes", lobes(4)},
            {"jittered", jittered(shapes::sphere(1.0, 3).mesh, 0.03)},
            {"hollow", hollow()}};
}

/// Anywhere, in any direction; of four planes one goes through three vertices of the body, one along an axis through one of them.
CutPlane randomPlane(const TriangleMesh& body, Random& random) {
    const Vec3 low = body.vertices.colwise().minCoeff(), high = body.vertices.colwise().maxCoeff();
    const auto vertex = [&] { return Vec3(body.vertices.row(random.below(static_cast<std::int32_t>(body.vertices.rows()))).transpose()); };
    switch (random.below(4)) {
        case 0: {
            const Vec3 a = vertex(), b = vertex(), c = vertex();
            return {a, (b - a).cross(c - a)};
        }
        case 1:
            return {vertex(), Vec3::Unit(random.below(3))};
        default:
            return {low + (0.5 * (Vec3::Ones() + random.vector())).cwiseProduct(high - low), random.vector()};
    }
}

struct Tally {
    int cuts = 0, accepted = 0, below5 = 0, caps = 0;
    double smallest = 180.0, milliseconds = 0.0;
    std::map<std::string, int> refused;
};

/// Taking one cut out changes no byte of the pieces that it does not touch.
void checkIndependent(const TriangleMesh& body, const std::vector<CutPlane>& cuts, const std::vector<BodyPiece>& pieces) {
    for (int out = 0; out < static_cast<int>(cuts.size()); ++out) {
        std::vector<CutPlane> fewer = cuts;
        fewer.erase(fewer.begin() + out);
        const auto rest = cutBody(body, fewer);
        if (!rest) continue;  // a ring that needs both
        for (const BodyPiece& piece : pieces) {
            std::vector<std::pair<int, bool>> caps;
            for (const auto& cap : piece.caps) caps.emplace_back(cap.cut, cap.front);
            if (std::any_of(caps.begin(), caps.end(), [&](const auto& cap) { return cap.first == out; })) continue;
            const auto same = std::find_if(rest->begin(), rest->end(), [&](const BodyPiece& other) {
                return other.caps.size() == caps.size() &&
                       std::equal(caps.begin(), caps.end(), other.caps.begin(),
                                  [&](const auto& a, const BodyPiece::Cap& b) { return a.first - (a.first > out) == b.cut && a.second == b.front; });
            });
            REQUIRE(same != rest->end());
            CHECK(sameBytes(piece, *same));
        }
    }
}

/// Three slices across a random direction, a little tilted.
std::vector<CutPlane> randomSlices(const TriangleMesh& body, Random& random) {
    const Vec3 n = random.vector().normalized(), low = body.vertices.colwise().minCoeff(), high = body.vertices.colwise().maxCoeff();
    std::vector<CutPlane> cuts;
    for (const double part : {-0.3, 0.0, 0.3})
        cuts.push_back({0.5 * (low + high) + (part + random.in(-0.1, 0.1)) * std::abs(n.dot(high - low)) * n, n + 0.05 * random.vector()});
    return cuts;
}

void tryCuts(const Named& named, const std::vector<CutPlane>& cuts, Tally& tally) {
    const auto begin = std::chrono::steady_clock::now();
    const auto pieces = cutBody(named.body, cuts);
    tally.milliseconds += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    ++tally.cuts;
    if (!pieces) {
        ++tally.refused[pieces.error().code];
        CHECK(pieces.error().code != "not-closed");
        CHECK(pieces.error().message.size() > 20);
        return;
    }
    ++tally.accepted;
    tally.smallest = std::min(tally.smallest, checkPieces(named.body, cuts, *pieces));
    for (const BodyPiece& piece : *pieces)
        for (const auto& cap : piece.caps)
            if (cap.front) ++tally.caps, tally.below5 += degrees(cap.smallestAngle) < 5.0;
    if (cuts.size() > 1) checkIndependent(named.body, cuts, *pieces);
}

void print(const std::string& name, const Tally& tally) {
    std::string text = name + ": " + std::to_string(tally.accepted) + " of " + std::to_string(tally.cuts) + " cut";
    for (const auto& [code, count] : tally.refused) text += ", " + std::to_string(count) + " " + code;
    MESSAGE(text << "; smallest angle " << tally.smallest << " degrees, below 5 degrees in " << tally.below5 << " of " << tally.caps << " caps; "
                 << tally.milliseconds / tally.cuts << " ms each");
}

}  // namespace

TEST_CASE("random cuts: each plane cuts or is refused with a reason, all is closed, volumes add up") {
    Random random(20061);
    for (const Named& named : ownBodies()) {
        INFO(named.name);
        Tally one, three;
        for (int i = 0; i < 20; ++i) tryCuts(named, {randomPlane(named.body, random)}, one);
        for (int i = 0; i < 5; ++i) {
            tryCuts(named, {randomPlane(named.body, random), randomPlane(named.body, random), randomPlane(named.body, random)}, three);
            tryCuts(named, randomSlices(named.body, random), three);
        }
        CHECK(one.accepted > 0);
        print(named.name, one);
        print(named.name + ", three planes", three);
    }
}

TEST_CASE("random cuts: characters of others") {
    const std::filesystem::path folder = IMOMUSHI_SHARED_MESHES;
    if (!std::filesystem::exists(folder)) return leaveOut("no folder " IMOMUSHI_SHARED_MESHES);
    Random random(72);
    for (const char* name :
         {"penguin", "cat-low-resolution", "fish_low_resolution", "koala_low_resolution", "scorpion_low_resolution", "spot_low_resolution", "torus"}) {
        INFO(name);
        const Named named{name, readObj((folder / (std::string(name) + ".obj")).string())};
        if (!meshFacts(named.body).outward) {
            MESSAGE(name << " is not closed");
            continue;
        }
        Tally one, three;
        for (int i = 0; i < 20; ++i) tryCuts(named, {randomPlane(named.body, random)}, one);
        for (int i = 0; i < 4; ++i) tryCuts(named, randomSlices(named.body, random), three);
        CHECK(one.accepted > 0);
        print(name, one);
        print(std::string(name) + ", three planes", three);
    }
}

TEST_CASE("cuts of a character: the penguin falls into wings, head and trunk") {
    const std::filesystem::path path = std::filesystem::path(IMOMUSHI_SHARED_MESHES) / "penguin.obj";
    if (!std::filesystem::exists(path)) return leaveOut("no " + path.string());
    const TriangleMesh body = readObj(path.string());
    const std::vector<CutPlane> cuts{
        {Vec3(-0.6, 0.2, -0.05), Vec3(-1, -0.6, 0)}, {Vec3(0.62, 0.2, -0.05), Vec3(1, -0.6, 0)}, {Vec3(0, 0.68, 0), Vec3(0, 1, 0)}};
    auto pieces = cutBody(body, cuts);
    REQUIRE_MESSAGE(pieces.has_value(), pieces.error().code << ": " << pieces.error().message);
    checkPieces(body, cuts, *pieces);
    CHECK(pieces->size() == 4);
    const double whole = enclosedVolume(body.vertices, body.triangles);
    for (const BodyPiece& piece : *pieces) {
        CHECK(selfIntersections(piece.body, 1).empty() == selfIntersections(body, 1).empty());
        for (const auto& cap : piece.caps)
            MESSAGE("cut " << cap.cut << std::string(cap.front ? " front" : " back") << ": " << piece.body.vertices.rows() << " vertices, "
                           << 100 * enclosedVolume(piece.body.vertices, piece.body.triangles) / whole << " % of the volume, cap of " << cap.vertices.size()
                           << " vertices, smallest angle " << degrees(cap.smallestAngle));
    }
    const auto begin = std::chrono::steady_clock::now();
    constexpr int kRuns = 5;
    for (int i = 0; i < kRuns; ++i) CHECK(cutBody(body, cuts).has_value());
    MESSAGE("the penguin cut by three planes in " << std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count() / kRuns
                                                  << " ms");
}
