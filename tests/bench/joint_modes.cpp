// SPDX-License-Identifier: GPL-3.0-or-later
// Smooth joints against the full model (all degrees of freedom of all joint faces in equilibrium, the same rigid parts): the sample "caterpillar" in
// standard poses, visible vertices. Errors by pose are relative to displacements in the moving frames of elements, and so is "frames"; "whole" is
// relative to the displacement from rest, "largest" is in diagonals of an element. Beside them: microseconds of the equilibrium in a frame.
// Then a bend of 90 degrees at one joint: volume and crease with a = b = 1 + c s and with smooth joints. Then microseconds of the sample "octopus".
// Arguments: more basis names to try.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "core/commands/core_commands.h"
#include "core/document/command_support.h"
#include "core/effects/smooth_joints_job.h"
#include "core/joints/seam.h"
#include "core/mesh/topology.h"
#include "core/session/session.h"
#include "tests/character/full_joints.h"
#include "tests/support/plain_sample.h"

using namespace imomushi;

namespace {

CharacterInput sample(const std::string& path) {
    CommandRegistry registry;
    addCoreCommands(registry);
    Session session(registry);
    const auto opened = session.execute({{"do", "open"}, {"path", path}});
    if (!opened) {
        std::fprintf(stderr, "%s\n", opened.error().message.c_str());
        std::exit(1);
    }
    for (const auto& line : plainLines(std::filesystem::path(path).stem().string())) (void)session.execute(line);
    return session.character()->input();
}

double volume(const Character& c) {
    double sum = 0.0;
    for (std::size_t e = 0; e < c.input().elements.size(); ++e) {
        const Points p = c.positions(static_cast<int>(e));
        sum += enclosedVolume(p, c.input().elements[e].mesh->body.triangles);
    }
    return sum;
}

// Radians.
double crease(const Character& c, const CharacterInput::Joint& joint) {
    const auto& a = joint.faces[0];
    const auto& b = joint.faces[1];
    const auto on = [&](const CharacterInput::Joint::Face& f) {
        return FaceOnBody{&c.input().elements[f.element].mesh->body, &c.input().elements[f.element].faces[f.face]};
    };
    return seamCrease(on(a), c.positions(a.element), on(b), c.positions(b.element));
}

// Median of the equilibrium in frames, microseconds.
double microseconds(Character& c, const std::vector<Pose>& poses) {
    std::vector<double> times;
    for (int k = 0; k < 400; ++k) {
        c.update(poses[static_cast<std::size_t>(k) % poses.size()]);
        times.push_back(1e3 * c.stats().effectMs(SmoothJointsEffect::kName));
    }
    std::nth_element(times.begin(), times.begin() + 200, times.end());
    return times[200];
}

}  // namespace

int main(int count, char** arguments) {
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    const CharacterInput base = sample(IMOMUSHI_SAMPLES "/caterpillar.imomushi");
    const SolverMeshSetting mesh = parseSolverMesh("as-is").value();
    const auto poses = full_joints::standardPoses(static_cast<int>(base.skeleton.bones.size()), Vec3::UnitX());
    const auto start = std::chrono::steady_clock::now();
    const full_joints::FullModel model(full_joints::smooth(base, BasisKind::Full, mesh));
    auto affine = Character::build(full_joints::smooth(base, BasisKind::Affine, mesh)).value();
    std::vector<std::vector<Points>> full;
    for (const auto& pose : poses) {
        affine.update(full_joints::poseOf(base.skeleton, pose));
        full.push_back(model.solve(affine));
    }
    std::printf("full model: %.1f s\n\n%-24s", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), "error, %");
    std::vector<std::string> names;
    for (const auto& pose : poses) names.push_back(pose.name.substr(0, 12));
    for (const auto& n : names) std::printf(" %12s", n.c_str());
    std::printf(" %9s %9s %9s %9s\n", "frames", "whole", "largest", "us");

    std::vector<std::string> bases = {"straight", "paper", "affine", "modes:3", "modes:6", "modes:9", "modes:12", "modes:15", "modes:18", "modes:21", "modes:24", "modes:30", "modes:36"};
    for (int i = 1; i < count; ++i) bases.emplace_back(arguments[i]);
    for (const auto& name : bases) {
        CharacterInput input = full_joints::smooth(base, name == "straight" ? BasisChoice() : parseBasis(name).value(), mesh);
        if (name != "straight") input.effects.set(SmoothJointsEffect{});
        auto c = Character::build(std::move(input)).value();
        std::printf("%-24s", name == "straight" ? "affine, a = b = 1 + c s" : name.c_str());
        full_joints::Difference all;
        for (std::size_t k = 0; k < poses.size(); ++k) {
            c.update(full_joints::poseOf(base.skeleton, poses[k]));
            const auto one = full_joints::difference(c, full[k]);
            all.add(one);
            std::printf(" %12.3f", 100.0 * one.strict());
        }
        std::vector<Pose> shown;
        for (const auto& pose : poses) shown.push_back(full_joints::poseOf(base.skeleton, pose));
        std::printf(" %9.3f %9.3f %9.3f %9.1f\n", 100.0 * all.strict(), 100.0 * all.relative(), 100.0 * all.largest, microseconds(c, shown));
    }

    std::printf("\nbend of 90 degrees in the middle       volume, %%   crease at the seam, degrees\n");
    full_joints::ChainPose bent = poses[2];
    for (std::size_t b = 0; b < bent.bend.size(); ++b) bent.bend[b] = (b == 2 ? 0.5 * std::numbers::pi : 0.0) * Vec3::UnitZ();
    for (const char* name : {"straight", "affine", "modes:6", "modes:12", "modes:24", "modes:36"}) {
        CharacterInput input = full_joints::smooth(base, std::string(name) == "straight" ? BasisChoice() : parseBasis(name).value(), mesh);
        if (std::string(name) != "straight") input.effects.set(SmoothJointsEffect{});
        auto c = Character::build(std::move(input)).value();
        const double rest = volume(c);
        const double restCrease = crease(c, c.input().joints[1]);
        c.update(full_joints::poseOf(base.skeleton, bent));
        constexpr double kDegrees = 180.0 / std::numbers::pi;
        const double bentCrease = crease(c, c.input().joints[1]);
        std::printf("%-38s %9.3f %21.2f (rest %.2f)\n", name, 100.0 * (volume(c) / rest - 1.0), kDegrees * bentCrease, kDegrees * restCrease);
    }

    CharacterInput octopus = sample(IMOMUSHI_SAMPLES "/octopus.imomushi");
    std::printf("\noctopus, %zu elements, %zu joints, microseconds of the equilibrium:", octopus.elements.size(), octopus.joints.size());
    std::vector<Pose> waves;
    for (int k = 0; k < 10; ++k) {
        Pose pose = restPose(octopus.skeleton);
        for (std::size_t i = 0; i < pose.points.size(); ++i) pose.points[i] *= 1.0 + 0.02 * std::sin(static_cast<double>(i) + k);
        waves.push_back(pose);
    }
    for (const char* name : {"affine", "modes:5", "modes:12"}) {
        auto c = Character::build(full_joints::smooth(octopus, parseBasis(name).value(), mesh)).value();
        std::printf(" %s %.0f", name, microseconds(c, waves));
    }
    std::printf("\n");
    return 0;
}
