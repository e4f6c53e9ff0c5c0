// SPDX-License-Identifier: GPL-3.0-or-later
// Smooth joints against the full model (all degrees of freedom of all joint faces in equilibrium, the same rigid parts): the sample "caterpillar" in
// standard poses, visible vertices, displacements in the moving frames of elements. Beside the error: microseconds of the equilibrium in a frame.
// Then a bend of 90 degrees at one joint: crease and volume with a = b = 1 + c s and with smooth joints.
// Arguments: the solver mesh ("default"), more basis names to try.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "core/document/command_support.h"
#include "core/document/session.h"
#include "tests/character/full_joints.h"

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
    return session.character()->input();
}

double volume(const Character& c) {
    double sum = 0.0;
    for (std::size_t e = 0; e < c.input().elements.size(); ++e) {
        const Points p = c.positions(static_cast<int>(e));
        const auto& t = c.input().elements[e].mesh->body.triangles;
        for (Eigen::Index f = 0; f < t.rows(); ++f)
            sum += Vec3(p.row(t(f, 0)).transpose()).dot(Vec3(p.row(t(f, 1)).transpose()).cross(Vec3(p.row(t(f, 2)).transpose()))) / 6.0;
    }
    return sum;
}

// Largest angle between the visible triangles on both sides of an edge of the seam of joint 1 (degrees), and at any other edge of its elements.
struct Crease {
    double seam = 0.0, beside = 0.0;
};
Crease crease(const Character& c, std::size_t j) {
    const auto& joint = c.input().joints[j];
    // Triangles of both elements by the edges between the vertices of the first one.
    std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::pair<Vec3, int>>> edges;
    for (int side = 0; side < 2; ++side) {
        const auto& f = joint.faces[static_cast<std::size_t>(side)];
        const auto& element = c.input().elements[f.element];
        const Points p = c.positions(f.element);
        std::vector<char> hidden(static_cast<std::size_t>(element.mesh->body.triangles.rows()), 0);
        for (const auto& face : element.faces)
            for (const auto t : face.triangles) hidden[static_cast<std::size_t>(t)] = 1;
        const auto name = [&](std::int32_t v) -> std::int64_t {
            if (side == 0) return v;
            for (const auto& [a, b] : joint.welded)
                if (b == v) return a;
            return 1000000 + v;
        };
        const auto& t = element.mesh->body.triangles;
        for (Eigen::Index k = 0; k < t.rows(); ++k) {
            if (hidden[static_cast<std::size_t>(k)]) continue;
            const Vec3 a = p.row(t(k, 0)).transpose(), b = p.row(t(k, 1)).transpose(), d = p.row(t(k, 2)).transpose();
            const Vec3 normal = (b - a).cross(d - a).normalized();
            for (int i = 0; i < 3; ++i) {
                auto from = name(t(k, i)), to = name(t(k, (i + 1) % 3));
                if (from > to) std::swap(from, to);
                edges[{from, to}].emplace_back(normal, side);
            }
        }
    }
    Crease out;
    for (const auto& [edge, sides] : edges) {
        if (sides.size() != 2) continue;
        const double angle = std::acos(std::clamp(sides[0].first.dot(sides[1].first), -1.0, 1.0)) * 180.0 / std::numbers::pi;
        double& to = sides[0].second != sides[1].second ? out.seam : out.beside;
        to = std::max(to, angle);
    }
    return out;
}

}  // namespace

int main(int count, char** arguments) {
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    const CharacterInput base = sample(IMOMUSHI_SAMPLES "/caterpillar.imomushi");
    const SolverMeshSetting mesh = parseSolverMesh(count > 1 ? arguments[1] : "default").value();
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
    std::printf(" %9s %9s %9s\n", "all, L2", "largest", "us");

    std::vector<std::string> bases = {"straight", "paper", "affine", "modes:3", "modes:6", "modes:9", "modes:12", "modes:15", "modes:18", "modes:21", "modes:24", "modes:30", "modes:36"};
    for (int i = 2; i < count; ++i) bases.emplace_back(arguments[i]);
    for (const auto& name : bases) {
        CharacterInput input = full_joints::smooth(base, name == "straight" ? BasisChoice() : parseBasis(name).value(), mesh);
        input.smoothJoints = name != "straight";
        auto c = Character::build(std::move(input)).value();
        std::printf("%-24s", name == "straight" ? "affine, a = b = 1 + c s" : name.c_str());
        full_joints::Difference all;
        for (std::size_t k = 0; k < poses.size(); ++k) {
            c.update(full_joints::poseOf(base.skeleton, poses[k]));
            const auto one = full_joints::difference(c, full[k]);
            all.add(one);
            std::printf(" %12.3f", 100.0 * one.relative());
        }
        std::vector<double> times;
        for (int k = 0; k < 400; ++k) {
            c.update(full_joints::poseOf(base.skeleton, poses[static_cast<std::size_t>(k) % poses.size()]));
            times.push_back(1e3 * c.stats().equilibriumMs);
        }
        std::nth_element(times.begin(), times.begin() + 200, times.end());
        std::printf(" %9.3f %9.3f %9.1f\n", 100.0 * all.relative(), 100.0 * all.largest, times[200]);
    }

    std::printf("\nbend of 90 degrees in the middle       volume, %%   crease at the seam, degrees   largest other\n");
    full_joints::ChainPose bent = poses[2];
    for (std::size_t b = 0; b < bent.bend.size(); ++b) bent.bend[b] = (b == 2 ? 0.5 * std::numbers::pi : 0.0) * Vec3::UnitZ();
    for (const char* name : {"straight", "affine", "modes:6", "modes:12", "modes:24", "modes:36"}) {
        CharacterInput input = full_joints::smooth(base, std::string(name) == "straight" ? BasisChoice() : parseBasis(name).value(), mesh);
        input.smoothJoints = std::string(name) != "straight";
        auto c = Character::build(std::move(input)).value();
        const double rest = volume(c);
        const auto restCrease = crease(c, 1);
        c.update(full_joints::poseOf(base.skeleton, bent));
        const auto k = crease(c, 1);
        std::printf("%-38s %9.3f %21.2f (rest %.2f) %12.2f (rest %.2f)\n", name, 100.0 * (volume(c) / rest - 1.0), k.seam, restCrease.seam, k.beside, restCrease.beside);
    }
    return 0;
}
