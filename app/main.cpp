// SPDX-License-Identifier: GPL-3.0-or-later
// One program: sub-commands are headless, everything else opens the studio.
#include <iostream>
#include <string_view>
#include <vector>

#include "app/build_facts.h"
#include "app/headless/live_command.h"
#include "app/headless/runner.h"
#include "core/project/version.h"
#include "core/worker/worker.h"
#ifdef IMOMUSHI_STUDIO
#include "ui/studio.h"
#endif

namespace {

constexpr const char* kUsage =
    "imomushi [PROJECT.imomushi]      the studio\n"
    "imomushi run [--keep-going] SCRIPT\n"
    "                                 performs a script without a display (\"-\": standard input)\n"
    "imomushi run --help              all commands of a script, with their keys\n"
    "imomushi live --help             performs a project by OSC and VMC, without a display; replay does what was recorded again\n"
    "imomushi --version\n"
    "imomushi --help\n";

}  // namespace

int main(int argc, char** argv) {
    const std::string_view first = argc > 1 ? argv[1] : "";
    if (first == "worker") return imomushi::workerMain();
    imomushi::setWorkerProgram("/proc/self/exe");
    if (first == "run") return imomushi::runMain(std::vector<std::string>(argv + 2, argv + argc), std::cin, std::cout, std::cerr);
    if (first == "live" || first == "replay") return imomushi::liveMain(std::vector<std::string>(argv + 1, argv + argc), std::cout, std::cerr);
    if (first == "--version") {
        std::cout << "imomushi " << imomushi::kVersion << "\ncommit " << imomushi::kCommit << "\nbuilt with " << imomushi::kLibraries << "\n";
        return 0;
    }
    if (first == "--help" || first == "-h") {
        std::cout << kUsage;
        return 0;
    }
#ifdef IMOMUSHI_STUDIO
    return imomushi::runStudio(argc, argv);
#else
    std::cerr << "This program was built without the studio.\n" << kUsage;
    return 2;
#endif
}
