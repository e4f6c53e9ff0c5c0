// SPDX-License-Identifier: GPL-3.0-or-later
// What contact costs in a frame of a caterpillar: straight, bent without meeting itself, and rolled up once and a half, beside the frame without it.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/character/contact_job.h"
#include "tests/character/caterpillar.h"

using namespace imomushi;

namespace {

Pose rolled(const Skeleton& skeleton, double angle, double aside) {
    Pose pose = restPose(skeleton);
    Vec3 at = skeleton.points[0];
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
        const double turn = angle * static_cast<double>(b);
        pose.frames[b] = Eigen::Quaterniond(std::cos(0.5 * turn), std::sin(0.5 * turn), 0.0, 0.0);
        at += pose.frames[b] * Vec3(0, 0, skeleton.bones[b].length) + aside * Vec3::UnitX();
        pose.points[b + 1] = at;
    }
    return pose;
}

}  // namespace

int main() {
    std::printf("%8s %8s %-10s %12s %12s %12s %8s\n", "patches", "vertices", "pose", "without, ms", "contact, ms", "all, ms", "ratio");
    for (const int patches : {24, 48, 96}) {
        caterpillar::Shape shape;
        shape.elements = 12;
        shape.around = {24};
        shape.along = {10};
        shape.precomputed = false;
        CharacterInput input = caterpillar::make(shape);
        Eigen::Index vertices = 0;
        for (auto& element : input.elements) {
            ResponseInput in;
            in.mesh = element.mesh;
            in.faces = element.faces;
            in.basis = input.basis;
            in.touch = patches;
            in.solverMesh = {SolverMeshSetting::Kind::AsIs, 0};
            element.response = std::make_shared<const ElementResponse>(buildResponse(in, {}).value());
            vertices += element.mesh->body.vertices.rows();
        }
        auto plain = Character::build(input).value();
        input.effects.set(ContactEffect{});
        auto c = Character::build(input).value();
        struct Case {
            const char* name;
            double angle, aside;
        };
        for (const Case& of : {Case{"straight", 0.02, 0.0}, Case{"bent", 0.35, 0.0}, Case{"rolled up", 2.0 * std::numbers::pi / 8.0, 0.115}}) {
            double without = 1e9, contact = 1e9, all = 1e9;
            for (int i = 0; i < 200; ++i) {
                const double part = i < 100 ? 0.01 * i : 1.0 - 1e-4 * (i % 7);  // it comes to the pose, and moves a little
                const Pose pose = rolled(input.skeleton, part * of.angle, part * of.aside);
                plain.update(pose, 1.0 / 60.0);
                c.update(pose, 1.0 / 60.0);
                if (i < 110) continue;
                const auto sum = [](const Character::Stats& s) { return s.jointsMs + s.productMs + s.normalsMs; };
                without = std::min(without, sum(plain.stats()));
                all = std::min(all, sum(c.stats()));
                contact = std::min(contact, c.stats().effectMs(ContactEffect::kName));
            }
            std::printf("%8d %8td %-10s %12.4f %12.4f %12.4f %8.2f\n", patches, vertices, of.name, without, contact, all, all / without);
        }
    }
}
