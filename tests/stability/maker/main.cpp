// SPDX-License-Identifier: GPL-3.0-or-later
// Writes every hard case into a folder ("hard cases" unless given): meshes, a script for `imomushi run`, and the project that the script
// makes, for the studio. A case whose refusal is expected is saved as far as it came. `PROGRAM worker` is its own worker.
#include <cstdio>
#include <cstring>

#include "core/commands/core_commands.h"
#include "core/worker/worker.h"
#include "tests/stability/scene.h"

using namespace imomushi;

int main(int argc, char** argv) {
    if (argc > 1 && std::strcmp(argv[1], "worker") == 0) return workerMain();
    setWorkerProgram("/proc/self/exe");
    const std::filesystem::path folder = argc > 1 ? argv[1] : "hard cases";
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    std::filesystem::current_path(folder, error);
    if (error) {
        std::fprintf(stderr, "%s: %s\n", folder.c_str(), error.message().c_str());
        return 1;
    }
    CommandRegistry registry;
    addCoreCommands(registry);
    int unexpected = 0;
    for (const HardCase& hard : hardCases()) {
        const HardScene scene = hardScene(hard);
        if (const auto written = writeHardCase(hard, scene, "."); !written) {
            std::fprintf(stderr, "%s: %s\n", hard.name.c_str(), written.error().message.c_str());
            return 1;
        }
        Session session(registry);
        std::string outcome = "solved";
        bool refused = false;
        for (const Json& line : scene.make) {
            const auto answer = session.execute(line);
            if (answer) continue;
            outcome = line["do"].get<std::string>() + " refused: " + answer.error().code;
            refused = true;
            unexpected += line["do"] != hard.refusal.command || answer.error().code != hard.refusal.code;
            break;
        }
        unexpected += !refused && !hard.refusal.command.empty() && !hard.orSolved;
        if (!session.document().elements.empty())
            if (const auto saved = session.execute({{"do", "save"}, {"path", hard.name + ".imomushi"}}); !saved) outcome += ", not saved: " + saved.error().message;
        std::printf("%-24s %s\n", hard.name.c_str(), outcome.c_str());
    }
    return unexpected > 0;
}
