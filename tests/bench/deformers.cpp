// SPDX-License-Identifier: GPL-3.0-or-later
// Deformers beside each other on the cases of tests/support/deformer_cases.h: what bends, twists and stretches do to volume, triangles and seams, and
// what a frame costs. Skins are those of other programs, with weights by hand ("ramp") and by bone heat ("auto"); the character's own deformers
// follow. Arguments choose cases by name.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "core/base/parallel.h"
#include "core/comparison/skin.h"
#include "core/comparison/timing.h"
#include "core/effects/bend_warp_job.h"
#include "core/effects/smooth_joints_job.h"
#include "tests/support/deformer_cases.h"

using namespace imomushi;

namespace {

constexpr double kNu = 0.49;

struct Deformed {
    Points positions;   // of all vertices of the surface
    double seconds = 0.0, ms = 0.0;
    std::size_t bytes = 0;
};

Points read(const float* positions, Eigen::Index count) {
    return Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(positions, count, 3).cast<double>();
}

Deformed bySkin(const DeformerCase& c, SkinKind kind, bool automatic) {
    const auto weights = automatic ? automaticWeights(c.surface, c.input.skeleton, {}) : rampWeights(c.surface, c.input.skeleton, 0.0);
    if (!weights) {
        std::printf("%s: %s\n", c.name.c_str(), weights.error().message.c_str());
        return {};
    }
    auto skin = Skin::build(c.surface, c.input.skeleton, *weights, kind).value();
    const double ms = mediansInTurn(50, 1.0, {[&] { skin.update(c.pose); }})[0];
    return {read(skin.positions(), skin.vertices()), weights->seconds, ms, skin.bytes()};
}

/// Responses by mesh: cases share them.
std::map<const ElementMesh*, std::shared_ptr<const ElementResponse>>& responses() {
    static std::map<const ElementMesh*, std::shared_ptr<const ElementResponse>> known;
    return known;
}

/// The character, with what `change` asks for beyond the plain linear solution.
Deformed byCharacter(const DeformerCase& c, const std::function<void(CharacterInput&)>& change) {
    CharacterInput input = c.input;
    input.basis = BasisKind::Affine;
    Deformed out;
    for (auto& e : input.elements) {
        auto& known = responses()[e.mesh.get()];
        if (!known) {
            ResponseInput in;
            in.mesh = e.mesh;
            in.faces = e.faces;
            in.nu = kNu;
            in.threads = hardwareThreads();
            known = std::make_shared<const ElementResponse>(buildResponse(in, {}).value());
        }
        e.response = known;
        out.seconds += known->quality.seconds;
    }
    change(input);
    auto character = Character::build(std::move(input)).value();
    Pose other = c.pose;
    for (auto& p : other.points) p *= 1.001;
    // In turn with another pose: what did not change is not evaluated.
    out.ms = 0.5 * mediansInTurn(50, 1.0, {[&] {
                                     character.update(other);
                                     character.update(c.pose);
                                 }})[0];
    out.positions.resize(c.surface.vertices.rows(), 3);
    for (std::size_t e = 0; e < c.input.elements.size(); ++e) {
        const int element = static_cast<int>(e);
        out.positions.middleRows(c.surface.first[e], c.surface.first[e + 1] - c.surface.first[e]) = character.positions(element);
        out.bytes += character.memory(element).response + character.memory(element).surface;
    }
    return out;
}

struct Deformer {
    std::string name;
    std::function<Deformed(const DeformerCase&)> run;
};

std::vector<Deformer> deformers() {
    std::vector<Deformer> out;
    const std::pair<const char*, SkinKind> kinds[] = {
        {"linear blend", SkinKind::LinearBlend}, {"dual quaternion", SkinKind::DualQuaternion}, {"spline", SkinKind::Spline}};
    for (const auto& [name, kind] : kinds)
        for (const bool automatic : {false, true})
            out.push_back({std::string(name) + (automatic ? ", auto" : ", ramp"), [kind = kind, automatic](const DeformerCase& c) { return bySkin(c, kind, automatic); }});
    const auto warped = [](CharacterInput& input) {
        for (auto& element : input.elements) element.nu = kNu;
        input.effects.set(BendWarpEffect{});
    };
    out.push_back({"character, plain linear", [](const DeformerCase& c) { return byCharacter(c, [](CharacterInput&) {}); }});
    out.push_back({"character, smooth joints", [](const DeformerCase& c) { return byCharacter(c, [](CharacterInput& input) { input.effects.set(SmoothJointsEffect{}); }); }});
    out.push_back({"character, bend warp", [warped](const DeformerCase& c) { return byCharacter(c, warped); }});
    out.push_back({"character, warp + smooth", [warped](const DeformerCase& c) {
                       return byCharacter(c, [warped](CharacterInput& input) {
                           warped(input);
                           input.effects.set(SmoothJointsEffect{});
                       });
                   }});
    return out;
}

}  // namespace

int main(int argc, char** argv) {
    std::printf("volume: change in %%; quality: worst triangle relative to rest; crease: degrees at the seam / in the rows beside it; ms: one thread, skins: "
                "positions, character: positions and normals\n");
    for (const auto& c : deformerCases(IMOMUSHI_TEST_DATA "/reference")) {
        if (argc > 1 && std::find(argv + 1, argv + argc, c.name) == argv + argc) continue;
        std::printf("\n%s: %lld vertices, %zu bones\n", c.name.c_str(), static_cast<long long>(c.surface.vertices.rows()), c.input.skeleton.bones.size());
        std::printf("%-26s %8s %8s %6s %8s %16s %9s %9s %8s\n", "", "volume", "quality", "folds", "crossing", "crease", "ms", "build s", "MB");
        for (const auto& d : deformers()) {
            const auto done = d.run(c);
            if (done.positions.rows() == 0) continue;
            const auto m = measureDeformation(c, done.positions);
            const double degrees = 180.0 / std::numbers::pi;
            std::printf("%-26s %8.2f %8.3f %6d %8d %7.1f /%7.1f %9.4f %9.3f %8.3f\n", d.name.c_str(), 100.0 * m.volumeChange, m.worstQuality, m.folds,
                        m.intersections, degrees * m.crease, degrees * m.creaseBeside, done.ms, done.seconds, 1e-6 * static_cast<double>(done.bytes));
            std::fflush(stdout);
        }
    }
    return 0;
}
