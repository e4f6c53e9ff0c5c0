// SPDX-License-Identifier: GPL-3.0-or-later
// Touch: what its columns add to the precompute, and what fingers cost in a frame. `bench_touch 2` precomputes on two threads, `bench_touch 0` only
// times frames.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "core/touch/touch_blocks.h"
#include "core/touch/touch_contact.h"
#include "tests/touch/bodies.h"

using namespace imomushi;
using namespace imomushi::touching;

namespace {

using Clock = std::chrono::steady_clock;
double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void precomputes(const char* name, const shapes::Body& body, const SolverMeshSetting& solver, int threads) {
    double plain = 0.0;
    std::size_t plainBytes = 0;
    for (const int touch : {0, 24, 48, 96}) {
        ResponseInput input = inputOf(body.mesh, body.ends, touch, 0.45, solver);
        input.threads = threads;
        const double estimated = estimateResponse(input).seconds;
        const auto start = Clock::now();
        const ElementResponse response = buildResponse(input, {}).value();
        const double seconds = secondsSince(start);
        if (touch == 0) {
            plain = seconds;
            plainBytes = response.bytes();
        }
        std::printf("%-26s %6td %6d %6d %8.2f %8.2f %7.2f %9.2f %8.1f %9.4f %9.4f\n", name, body.mesh.vertices.rows(),
                    response.quality.solverNodes, response.touch.patches.count(), seconds, estimated, seconds / plain,
                    static_cast<double>(response.bytes()) / 1e6, static_cast<double>(response.bytes()) / static_cast<double>(plainBytes),
                    response.touch.asymmetry, response.touch.negativeEnergy);
    }
}

void frames() {
    const auto shape = shapes::cylinder(0.5, 2.0, 48, 36);
    std::printf("\nframe of %td vertices, one thread, us: fingers that slide, hold, and their displacement added to all vertices\n",
                shape.mesh.vertices.rows());
    std::printf("%8s %8s %5s %10s %10s %10s %10s %10s %10s\n", "patches", "fingers", "tip", "columns", "placing", "contact", "adding",
                "in all", "ratio");
    for (const int touch : {24, 48, 96}) {
        const Touched body = precompute(inputOf(shape.mesh, shape.ends, touch));
        std::vector<std::int32_t> first;
        for (std::int32_t v = 0; v < body.mesh.vertices.rows(); v += TouchBlocks::kBlock) first.push_back(v);
        TouchBlocks blocks(*body.response, first);
        std::vector<float, Eigen::aligned_allocator<float>> local(first.size() * 3 * TouchBlocks::kBlock);
        const auto surface = TouchSurface::build({body.mesh, {}}, body.faces, body.response).value();
        const auto dents = std::make_shared<const DentSurface>(ElementMesh{body.mesh, {}}, body.faces, surface, 0.45, first);
        for (const int fingers : {1, 2, 4, 8, 16, 24}) {
            double without = 0.0;
            for (const double tip : {0.0, 0.05}) {
                TouchSettings settings;
                settings.tip = tip;
                TouchContact contact = TouchContact::build(surface, settings, tip > 0.0 ? dents : nullptr).value();
                double placing = 1e9, solving = 1e9, adding = 1e9;
                for (int frame = 0; frame < 400; ++frame) {
                    auto start = Clock::now();
                    for (int i = 0; i < fingers; ++i) {
                        const double turn = 2.4 * i + 0.001 * frame;
                        contact.place(i,
                                      contact.surface().nearest(
                                          Vec3(0.5 * std::cos(turn), 0.5 * std::sin(turn), 0.3 + 1.4 * i / TouchContact::kFingers)),
                                      0.0);
                    }
                    placing = std::min(placing, 1e6 * secondsSince(start));
                    start = Clock::now();
                    for (int i = 0; i < fingers; ++i) {
                        const auto corners = body.corners(contact.triangle(i));
                        const Vec3 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
                        contact.aim(i, corners, middle - Vec3(0.1 * middle.x(), 0.1 * middle.y(), 0.01));
                    }
                    contact.step(1.0 / 60.0);
                    solving = std::min(solving, 1e6 * secondsSince(start));
                    std::fill(local.begin(), local.end(), 0.0f);
                    start = Clock::now();
                    blocks.weigh(contact.patchForces());
                    blocks.add(0, blocks.count(), local.data());
                    if (tip > 0.0) dents->add(contact.dents(), 0, blocks.count(), local.data());
                    if (frame > 30) adding = std::min(adding, 1e6 * secondsSince(start));
                }
                const double all = placing + solving + adding;
                if (tip == 0.0) without = all;
                std::printf("%8d %8d %5.2f %10d %10.1f %10.1f %10.1f %10.1f %10.2f\n", body.response->touch.patches.count(), fingers, tip,
                            blocks.activeColumns(), placing, solving, adding, all, all / without);
            }
        }
        std::printf("%8s contact %.2f MB, blocks %.2f MB, dents %.2f MB\n", "", static_cast<double>(body.contact().bytes()) / 1e6,
                    static_cast<double>(blocks.bytes()) / 1e6, static_cast<double>(dents->bytes()) / 1e6);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const int threads = argc > 1 ? std::stoi(argv[1]) : 1;
    if (threads <= 0) return frames(), 0;
    std::printf("%-26s %6s %6s %6s %8s %8s %7s %9s %8s %9s %9s\n", "precompute", "verts", "nodes", "patch", "s", "estimate", "ratio", "MB",
                "ratio", "asymmetry", "negative");
    precomputes("cylinder, as it is", shapes::cylinder(0.5, 1.5, 32, 24), {SolverMeshSetting::Kind::AsIs, 0}, threads);
    precomputes("cylinder, default", shapes::cylinder(0.5, 1.5, 32, 24), {SolverMeshSetting::Kind::Default, 0}, threads);
    precomputes("cylinder, decimated", shapes::cylinder(0.5, 1.5, 96, 96), {SolverMeshSetting::Kind::Default, 0}, threads);
    frames();
    return 0;
}
