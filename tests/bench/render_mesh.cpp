// SPDX-License-Identifier: GPL-3.0-or-later
// One frame of a body of 2,000 vertices under a render mesh of 20,000, beside one of a plain body of 20,000: update() on one thread, the two in turn. Then the same
// body with the bend warp, where the render mesh follows deformed triangles. Then bodies of 34,000 and 250,000 vertices without and with the bend warp, on two threads.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "core/character/character.h"
#include "core/effects/bend_warp_job.h"
#include "core/reduction/embedded_mapping.h"
#include "tests/character/embedded.h"

using namespace imomushi;

namespace {

using Clock = std::chrono::steady_clock;

CharacterInput cylinder(int around, int along, bool solved) {
    caterpillar::Shape shape;
    shape.elements = 1;
    shape.length = 3.0;
    shape.around = {around};
    shape.along = {along};
    shape.tips = true;
    shape.precomputed = solved;
    return caterpillar::make(shape);
}

/// The response of a coarse body on the vertices of a dense one: how well it is solved is no matter here.
void takeResponse(CharacterInput& dense, const CharacterInput& coarse) {
    const auto& mesh = dense.elements[0].mesh->body;
    ElementResponse made = *coarse.elements[0].response;
    made.freeVertices.clear();
    std::vector<char> held(static_cast<std::size_t>(mesh.vertices.rows()), 0);
    for (std::size_t f = 0; f < made.bases.size(); ++f) {
        made.bases[f] = FaceBasis::on(mesh, dense.elements[0].faces[f], dense.basis);
        for (const auto v : dense.elements[0].faces[f].vertices) held[static_cast<std::size_t>(v)] = 1;
    }
    for (std::int32_t v = 0; v < mesh.vertices.rows(); ++v)
        if (!held[static_cast<std::size_t>(v)]) made.freeVertices.push_back(v);
    Points points(static_cast<Eigen::Index>(made.freeVertices.size()), 3);
    for (std::size_t i = 0; i < made.freeVertices.size(); ++i) points.row(static_cast<Eigen::Index>(i)) = mesh.vertices.row(made.freeVertices[i]);
    const auto& from = coarse.elements[0];
    EmbeddedMapping::Input in;
    const std::vector<char> covered(from.faces.size(), 0);
    in.body = &from.mesh->body, in.faces = from.faces, in.covered = covered, in.points = &points;
    Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(3 * from.mesh->body.vertices.rows(), made.response.cols());
    for (std::size_t i = 0; i < from.response->freeVertices.size(); ++i)
        whole.middleRows<3>(3 * from.response->freeVertices[i]) = from.response->response.middleRows<3>(3 * static_cast<Eigen::Index>(i));
    made.response = EmbeddedMapping::build(in).value().apply(whole, 1);
    made.loads.resize(0, 0);
    made.loadForces.resize(0, 0);
    dense.elements[0].response = std::make_shared<const ElementResponse>(std::move(made));
}

struct Times {
    std::vector<double> frame, product, normals;
    double megabytes = 0.0;  // of the response
    void row(const char* name, int vertices) {
        const auto median = [](std::vector<double>& s) {
            std::nth_element(s.begin(), s.begin() + static_cast<std::ptrdiff_t>(s.size() / 2), s.end());
            return s[s.size() / 2];
        };
        std::printf("%-45s %9d %9.4f %9.4f %9.4f %9.3f\n", name, vertices, median(frame), median(product), median(normals), megabytes);
    }
};

/// Frames of a body of 250,000 vertices without and with the bend warp: two threads. Ratios to the product of the same run.
int largeBody(const CharacterInput& solved) {
    std::printf("\n%10s %-12s %10s %10s %10s %12s %12s\n", "vertices", "", "frame ms", "warp ms", "normals ms", "to product", "frames / s");
    for (const auto& [around, along] : {std::pair{100, 340}, std::pair{300, 830}}) {
        CharacterInput plain = cylinder(around, along, false);
        takeResponse(plain, solved);
        plain.threads = 2;
        CharacterInput warped = plain;
        warped.effects.set(BendWarpEffect{});
        double product = 0.0;
        for (const auto* input : {&plain, &warped}) {
            auto character = Character::build(*input).value();
            std::vector<double> frame, warp, normals, products;
            for (int i = 0; i < 120; ++i) {
                const Pose pose = embedded::chainPose(plain.skeleton, 0.0, 0.3 * std::sin(0.1 * i), 1.0 + 0.1 * std::sin(0.07 * i));
                const auto start = Clock::now();
                character.update(pose, 0.0);
                frame.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
                products.push_back(character.stats().productMs);
                normals.push_back(character.stats().normalsMs);
                warp.push_back(character.stats().effectMs(BendWarpEffect::kName));
            }
            const auto median = [](std::vector<double>& s) { return std::nth_element(s.begin(), s.begin() + static_cast<std::ptrdiff_t>(s.size() / 2), s.end()), s[s.size() / 2]; };
            if (input == &plain) product = median(products);
            const double ms = median(frame);
            std::printf("%10d %-12s %10.3f %10.3f %10.3f %12.1f %12.1f\n", character.surface(0).vertices, input == &plain ? "product" : "bend warp", ms, median(warp), median(normals),
                        ms / product, 1000.0 / ms);
        }
    }
    return 0;
}

}  // namespace

int main() {
    const CharacterInput solved = cylinder(24, 12, true);
    CharacterInput coarse = cylinder(48, 27, false), plain = cylinder(60, 314, false);
    takeResponse(coarse, solved);
    takeResponse(plain, solved);
    CharacterInput under = coarse;
    embedded::addRenderMesh(under, embedded::tube(0.52, 0.05, 2.95, 200, 99), 3.0);
    CharacterInput warped = under;
    warped.effects.set(BendWarpEffect{});
    CharacterInput warpedBody = coarse;
    warpedBody.effects.set(BendWarpEffect{});

    const auto built = Clock::now();
    auto first = Character::build(under).value();
    const double buildMs = std::chrono::duration<double, std::milli>(Clock::now() - built).count();
    struct Case {
        const char* name;
        Character character;
        int vertices;
        Times times;
    };
    std::vector<Case> cases;
    const auto add = [&](const char* name, Character character) {
        const int seen = character.input().renderMeshes.empty() ? character.surface(0).vertices : character.renderSurface(0).vertices;
        cases.push_back({name, std::move(character), seen, {}});
    };
    add("plain body", Character::build(plain).value());
    add("render mesh on a body of 2,000", std::move(first));
    add("plain body of 2,000", Character::build(coarse).value());
    add("bend warp: render mesh on a body of 2,000", Character::build(warped).value());
    add("bend warp: plain body of 2,000", Character::build(warpedBody).value());
    std::printf("body: %d vertices, %d columns; character with the render mesh built in %.1f ms\n", static_cast<int>(coarse.elements[0].mesh->body.vertices.rows()),
                coarse.elements[0].response->columns(), buildMs);

    constexpr int kFrames = 1500;
    for (int i = 0; i < kFrames; ++i)
        for (auto& c : cases) {
            Pose pose = embedded::chainPose(coarse.skeleton, 0.0, 0.3 * std::sin(0.1 * i), 1.0 + 0.1 * std::sin(0.07 * i));
            const auto start = Clock::now();
            c.character.update(pose, 0.0);
            c.times.frame.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
            c.times.product.push_back(c.character.stats().productMs);
            c.times.normals.push_back(c.character.stats().normalsMs);
        }
    std::printf("%-45s %9s %9s %9s %9s %9s\n", "ms per frame, one thread, median", "seen", "frame", "product", "normals", "MB of A'");
    for (auto& c : cases) c.times.megabytes = 1e-6 * static_cast<double>(c.character.memory(0).response), c.times.row(c.name, c.vertices);
    return largeBody(solved);
}
