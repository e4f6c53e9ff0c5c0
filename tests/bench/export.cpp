// SPDX-License-Identifier: GPL-3.0-or-later
// Ten seconds of a character of 250,000 vertices as files: seconds per layout and stage (at all, and of all processors together), and how long a cancelled export goes on.
//   bench_export [FOLDER for files] [layouts, all unless given]
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "core/commands/core_commands.h"
#include "core/io/import.h"
#include "core/session/session.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

constexpr int kCancels = 8;

using Clock = std::chrono::steady_clock;
double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

double processSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// A cylinder of 6 m along z, from z = 6 place.
ImportedBody body(const std::string& name, int place, double vertices) {
    ImportedBody out;
    out.name = name;
    out.closed = true;
    const int around = static_cast<int>(std::lround(std::sqrt(0.75 * vertices)));
    out.mesh.body = shapes::cylinder(1.0, 6.0, around, around).mesh;
    const double low = out.mesh.body.vertices.col(2).minCoeff();
    out.mesh.body.vertices.col(2).array() += 6.0 * place - low;
    for (std::int32_t v = 0; v < out.mesh.body.vertices.rows(); ++v) out.mesh.renderMesh.bodyVertex.push_back(v);
    out.mesh.renderMesh.triangles = out.mesh.body.triangles;
    return out;
}

Json run(Session& session, const Json& command, const Progress& progress = {}) {
    auto answer = session.execute(command, progress);
    if (!answer) std::printf("%s\n%s\n", command.dump().c_str(), answer.error().message.c_str()), std::exit(1);
    return *answer;
}

}  // namespace

int main(int argc, char** argv) {
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    const std::filesystem::path folder = argc > 1 ? argv[1] : std::filesystem::temp_directory_path().string();
    CommandRegistry registry;
    addCoreCommands(registry);
    Session session(registry);
    session.services().import = [](const ImportRequest& request, const Progress&) -> Result<ImportResult> {
        ImportResult result;
        result.format = "shape";
        result.bodies.push_back(body(request.path.string(), request.path.string() == "A" ? 0 : 1, 125'000.0));
        return result;
    };
    for (const char* name : {"A", "B"}) {
        const double z = name[0] == 'A' ? 0.0 : 6.0;
        run(session, {{"do", "import-element"}, {"path", name}, {"name", name}});
        run(session, {{"do", "set"}, {"target", name}, {"property", "solver-mesh"}, {"value", "decimated:400"}});
        for (const int end : {0, 1})
            run(session, {{"do", "add-joint-face"}, {"element", name}, {"name", end ? "out" : "in"}, {"plane", {{"origin", {0, 0, z + 6.0 * end}}, {"normal", {0, 0, end ? 1 : -1}}}}});
    }
    run(session, {{"do", "join"}, {"a", "A/out"}, {"b", "B/in"}});
    run(session, {{"do", "add-bone"}, {"name", "a"}, {"from", "A/in"}, {"to", "A/out"}});
    run(session, {{"do", "add-bone"}, {"name", "b"}, {"from", "a/end"}, {"to", "B/out"}});
    auto start = Clock::now();
    run(session, {{"do", "precompute"}});
    std::printf("precompute %.1f s\n", since(start));
    run(session, {{"do", "record"}, {"take", "t"}, {"action", "start"}});
    run(session, {{"do", "drag"}, {"endpoint", "b/end"}, {"to", {3, 1, 11}}, {"roll", 0.5}, {"seconds", 5}});
    run(session, {{"do", "step"}, {"frames", 600}});
    run(session, {{"do", "record"}, {"take", "t"}, {"action", "stop"}});

    for (const char* layout : {"baked", "rigged", "skinned"}) {
        if (argc > 2 && std::string(argv[2]).find(layout) == std::string::npos) continue;
        const Json command{{"do", "export"}, {"layout", layout}, {"path", (folder / "bench.glb").string()}};
        std::vector<std::pair<std::string, double>> stages;
        double longest = 0.0;
        const double spent = processSeconds();
        auto last = Clock::now();
        start = last;
        const Json answer = run(session, command, Progress([&](std::string_view stage, double) {
                                    const double passed = since(last);
                                    last = Clock::now();
                                    if (!stages.empty()) stages.back().second += passed, longest = std::max(longest, passed);
                                    if (stages.empty() || stages.back().first != stage) stages.emplace_back(stage, 0.0);
                                }, {}));
        const double all = since(start), processed = processSeconds() - spent;
        if (!stages.empty()) stages.back().second += since(last);
        std::printf("%-8s %d vertices, %d targets, %.1f MB, check %.1e %%: %.2f s (%.2f s of processors)", layout, answer["vertices"].get<int>(), answer["targets"].get<int>(),
                    answer["bytes"].get<double>() / 1e6, answer["check"]["max_percent"].get<double>(), all, processed);
        for (const auto& [stage, seconds] : stages) std::printf(", %s %.2f", stage.c_str(), seconds);
        // Cancelled at some moments of the whole.
        double slowest = 0.0, worst = 0.0;
        for (int i = 0; i < kCancels; ++i) {
            std::stop_source stop;
            Clock::time_point asked;
            std::jthread hand([&] {
                std::this_thread::sleep_for(std::chrono::duration<double>(all * (i + 0.5) / kCancels));
                asked = Clock::now();
                stop.request_stop();
            });
            const auto cancelled = session.execute(command, Progress({}, stop.get_token()));
            const auto ended = Clock::now();
            hand.join();
            if (!cancelled)
                if (const double late = std::chrono::duration<double>(ended - asked).count(); late > slowest) slowest = late, worst = (i + 0.5) / kCancels;
        }
        std::printf(", longest silence %.2f s, cancelled within %.2f s (at %.0f %%)\n", longest, slowest, 100.0 * worst);
    }
    return 0;
}
