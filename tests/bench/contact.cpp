// SPDX-License-Identifier: GPL-3.0-or-later
// What contact costs in a frame of a caterpillar: straight, bent without meeting itself, and rolled up once and a half, beside the frame without it; of the sample
// on the ground, at rest and pressed; and in a structural edit of a hundred elements.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <numbers>
#include <string>
#include <vector>

#include "core/commands/core_commands.h"
#include "core/effects/contact_job.h"
#include "core/session/session.h"
#include "tests/character/caterpillar.h"
#include "tests/support/plain_sample.h"

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

CharacterInput inputOf(int elements, int around, int along, int patches) {
    caterpillar::Shape shape;
    shape.elements = elements;
    shape.around = {around};
    shape.along = {along};
    shape.precomputed = false;
    CharacterInput input = caterpillar::make(shape);
    for (auto& element : input.elements) {
        ResponseInput in;
        in.mesh = element.mesh;
        in.faces = element.faces;
        in.basis = input.basis;
        in.touch = patches;
        in.solverMesh = {SolverMeshSetting::Kind::AsIs, 0};
        element.response = std::make_shared<const ElementResponse>(buildResponse(in, {}).value());
    }
    return input;
}

double processorMs() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// Processor time of all threads per frame of the sample caterpillar on the ground, ms: the middle of many frames.
struct OnGround {
    double resting = 0.0, pressed = 0.0, contact = 0.0;  // contact: ms by the statistics while it is pressed
};

OnGround onGround(const CommandRegistry& registry, const std::vector<std::string>& effects) {
    Session session(registry);
    const auto good = [&](const Json& command) {
        if (const auto done = session.execute(command); !done) std::fprintf(stderr, "%s\n", done.error().message.c_str());
    };
    good({{"do", "open"}, {"path", IMOMUSHI_SAMPLES "/caterpillar.imomushi"}});
    for (const auto& line : plainLines("caterpillar")) good(line);
    double low = 1e30, high = -1e30;
    for (const auto& [id, element] : session.document().elements) {
        low = std::min(low, element->mesh->body.vertices.col(1).minCoeff());
        high = std::max(high, element->mesh->body.vertices.col(1).maxCoeff());
    }
    good({{"do", "set"}, {"target", "ground"}, {"property", "height"}, {"value", low}});
    for (const auto& effect : effects) good({{"do", "enable"}, {"effect", effect}});
    good({{"do", "precompute"}});
    for (int i = 0; i < 1200; ++i) session.stepFrame(1.0 / 60.0);  // bones swing on for ten seconds
    const auto middle = [&](int frames, const auto& before) {
        std::vector<double> times;
        for (int i = 0; i < frames; ++i) {
            before(i);
            const double start = processorMs();
            session.stepFrame(1.0 / 60.0);
            times.push_back(processorMs() - start);
        }
        std::nth_element(times.begin(), times.begin() + frames / 2, times.end());
        return times[static_cast<std::size_t>(frames / 2)];
    };
    OnGround out;
    out.resting = middle(200, [](int) {});
    // The head is dragged down, up a little and down again.
    std::vector<double> contact;
    out.pressed = middle(300, [&](int i) {
        const double down = low + (0.35 + 0.15 * std::cos(0.1 * i)) * (high - low);
        good({{"do", "drag"}, {"endpoint", "head-bone/end"}, {"to", {2.0, down, 0.0}}});
        if (const auto ms = session.effectMilliseconds(EffectKind::Contact)) contact.push_back(*ms);
    });
    if (!contact.empty()) {
        std::nth_element(contact.begin(), contact.begin() + static_cast<std::ptrdiff_t>(contact.size() / 2), contact.end());
        out.contact = contact[contact.size() / 2];
    }
    return out;
}

void ground() {
    CommandRegistry registry;
    addCoreCommands(registry);
    std::printf("\nsample caterpillar on the ground: processor time of a frame, ms\n%-44s %10s %10s %22s\n", "effects", "at rest",
                "pressed", "contact while pressed");
    std::vector<std::string> effects = {"bone-dynamics", "gravity", "ground"};
    const auto print = [&](const std::vector<std::string>& with) {
        std::string names;
        for (const auto& effect : with) names += (names.empty() ? "" : ", ") + effect;
        const OnGround of = onGround(registry, with);
        std::printf("%-44s %10.4f %10.4f %22.4f\n", names.c_str(), of.resting, of.pressed, of.contact);
    };
    print(effects);
    effects.emplace_back("contact");
    print(effects);
    effects.back() = "bend-warp";
    print(effects);
    effects.emplace_back("contact");
    print(effects);
}

void structuralEdit() {
    CharacterInput input = inputOf(100, 16, 6, 48);
    const auto build = [&](const Character* known) {
        const double start = processorMs();
        auto made = Character::build(input, known).value();
        return std::pair(std::move(made), processorMs() - start);
    };
    const auto plain = build(nullptr).first;
    double without = 1e9;
    for (int i = 0; i < 10; ++i) without = std::min(without, build(&plain).second);
    input.effects.set(ContactEffect{});
    const auto first = build(nullptr).first;
    double with = 1e9;
    for (int i = 0; i < 10; ++i) with = std::min(with, build(&first).second);
    std::printf("\n100 elements, built again with the same elements: %.1f ms, with contact %.1f ms\n", without, with);
}

}  // namespace

int main() {
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    std::printf("%8s %8s %-10s %12s %12s %12s %8s\n", "patches", "vertices", "pose", "without, ms", "contact, ms", "all, ms", "ratio");
    for (const int patches : {24, 48, 96}) {
        CharacterInput input = inputOf(12, 24, 10, patches);
        Eigen::Index vertices = 0;
        for (const auto& element : input.elements) vertices += element.mesh->body.vertices.rows();
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
    ground();
    structuralEdit();
}
