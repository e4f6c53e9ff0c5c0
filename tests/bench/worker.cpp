// SPDX-License-Identifier: GPL-3.0-or-later
// What it costs that workers do what may break: reading, bodies, proposals and cuts of characters, in this process and by a worker. bench_worker FILE...
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "core/base/clock.h"
#include "core/body/body.h"
#include "core/body/cut.h"
#include "core/io/character_file.h"
#include "core/proposal/shape_proposal.h"
#include "core/worker/worker.h"

using namespace imomushi;

namespace {

constexpr int kRuns = 7;

double milliseconds(const std::function<void()>& work) {
    const auto began = Clock::now();
    work();
    return 1e3 * secondsSince(began);
}

/// The fastest of several runs of each, taken in turn, so that both see the same machine.
void compare(const std::string& what, const std::function<void()>& work) {
    double here = 1e30, there = 1e30;
    for (int run = 0; run < kRuns; ++run) {
        setWorkerProgram({});
        here = std::min(here, milliseconds(work));
        setWorkerProgram("/proc/self/exe");
        work();  // the worker is there, and keeps the body
        there = std::min(there, milliseconds(work));
    }
    std::printf("  %-9s %9.2f %9.2f  %+6.2f ms  %+5.1f %%\n", what.c_str(), here, there, there - here, 100.0 * (there / here - 1.0));
}

}  // namespace

int main(int argc, char** argv) {
    if (argc > 1 && std::strcmp(argv[1], "worker") == 0) return workerMain();
    for (int i = 1; i < argc; ++i) {
        ImportRequest request;
        request.path = argv[i];
        setWorkerProgram({});
        const auto file = importCharacter(request, {});
        if (!file) {
            std::printf("%s: %s\n", argv[i], file.error().message.c_str());
            continue;
        }
        const RenderModel& model = file->renderModel;
        const auto body = makeBody(model.mesh.body, model.part, {}, {});
        if (!body) {
            std::printf("%s: %s\n", argv[i], body.error().message.c_str());
            continue;
        }
        std::printf("%s, %ld vertices: ms here, by a worker\n", request.path.filename().c_str(),
                    static_cast<long>(body->mesh.vertices.rows()));
        setWorkerProgram("/proc/self/exe");
        std::printf("  the first %9.2f\n", milliseconds([&] { (void)cutBody(body->mesh, {}, {}); }));
        compare("reading", [&] { (void)importCharacter(request, {}); });
        compare("body", [&] { (void)makeBody(model.mesh.body, model.part, {}, {}); });
        const auto proposal = proposeFromShape(body->mesh, 0.0, {});
        if (!proposal) continue;
        compare("proposal", [&] { (void)proposeFromShape(body->mesh, 0.0, {}); });
        std::vector<CutPlane> cuts;
        for (const ProposedCut& cut : proposal->cuts) cuts.push_back(cut.plane);
        if (!cuts.empty()) compare("cuts", [&] { (void)cutBody(body->mesh, cuts, {}); });
    }
    return 0;
}
