// SPDX-License-Identifier: GPL-3.0-or-later
// One frame of a caterpillar of 5 elements with 1978 vertices in all (the size in the paper), one thread: inverse kinematics to world positions and
// normals, beside the memory triad of the same run. Target: under 0.1 ms.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/character/character.h"
#include "tests/character/caterpillar.h"

using namespace imomushi;

namespace {

using Clock = std::chrono::steady_clock;

double milliseconds(Clock::time_point from) { return std::chrono::duration<double, std::milli>(Clock::now() - from).count(); }

// GB/s of a[i] = b[i] + s * c[i] over three arrays of 130 MB, best of several.
double triad() {
    const std::size_t n = 1 << 25;
    std::vector<float> a(n, 0.0f), b(n, 1.0f), c(n, 2.0f);
    double best = 0.0;
    for (int k = 0; k < 8; ++k) {
        const auto start = Clock::now();
        const float s = 0.5f + static_cast<float>(k);
        for (std::size_t i = 0; i < n; ++i) a[i] = b[i] + s * c[i];
        benchmark::DoNotOptimize(a.data());
        benchmark::ClobberMemory();
        best = std::max(best, 3.0 * sizeof(float) * n / milliseconds(start) * 1e-6);
    }
    return best;
}

struct Percentiles {
    double median, p99;
};

Percentiles of(std::vector<double>& samples) {
    std::sort(samples.begin(), samples.end());
    return {samples[samples.size() / 2], samples[samples.size() * 99 / 100]};
}

}  // namespace

int main() {
    caterpillar::Shape shape;
    shape.around = {24};
    shape.along = {9, 9, 11, 9, 9};
    shape.tips = true;
    CharacterInput input = caterpillar::make(shape);
    int vertices = 0, columns = 0;
    double triangles = 0.0;
    for (const auto& e : input.elements) {
        vertices += static_cast<int>(e.mesh->body.vertices.rows());
        triangles += static_cast<double>(e.mesh->body.triangles.rows());
        columns += e.response->columns();
    }
    auto character = Character::build(std::move(input)).value();
    double bytes = 0.0;
    for (int e = 0; e < 5; ++e) bytes += static_cast<double>(character.memory(e).response);
    Pose pose = restPose(character.input().skeleton);
    std::vector<IkGoal> goals = {{0, Vec3::Zero()}, {5, Vec3(0, 0, 5)}};

    constexpr int kFrames = 20000;
    std::vector<double> frame, solve, joints, product, normals;
    for (auto* s : {&frame, &solve, &joints, &product, &normals}) s->reserve(kFrames);
    double evaluated = 0.0;
    for (int i = 0; i < kFrames; ++i) {
        const double t = 0.013 * i;
        goals[1].target = Vec3(2.0 * std::sin(t), 1.5 * std::sin(0.7 * t), 4.5 + std::sin(0.31 * t));
        const auto start = Clock::now();
        character.solvePose(goals, pose);
        character.update(pose);
        frame.push_back(milliseconds(start));
        const auto& s = character.stats();
        solve.push_back(s.poseMs), joints.push_back(s.jointsMs), product.push_back(s.productMs), normals.push_back(s.normalsMs);
        evaluated += s.evaluatedElements;
    }
    const double rate = triad();
    std::printf("caterpillar: 5 elements, %d vertices, %.0f triangles, %d columns, %.3f MB of responses\n", vertices, triangles, columns, bytes * 1e-6);
    std::printf("%-34s %10s %10s\n", "ms per frame, one thread", "median", "p99");
    const auto row = [](const char* name, std::vector<double>& s) {
        const auto p = of(s);
        std::printf("%-34s %10.4f %10.4f\n", name, p.median, p.p99);
    };
    row("whole frame (target 0.1)", frame);
    row("  inverse kinematics", solve);
    row("  joints and parameters", joints);
    row("  product and placement", product);
    row("  normals", normals);
    std::printf("elements evaluated per frame: %.2f\n", evaluated / kFrames);
    // Every response is read once per frame; positions and normals are written once.
    const double least = (bytes + 24.0 * vertices) / rate * 1e-6;
    std::printf("memory triad: %.1f GB/s; reading the responses and writing the surface at that rate: %.4f ms\n", rate, least);
    return 0;
}
