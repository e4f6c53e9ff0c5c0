// SPDX-License-Identifier: GPL-3.0-or-later
// Floating-point traps are on in every test: a division by zero, an invalid operation or an overflow is a bug, not a NaN to be found later.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>
#include <cfenv>
#include <cstdlib>
#include <cstring>

#include "core/worker/worker.h"
#include "tests/support/left_out.h"
#include "tests/support/own_home.h"

int main(int argc, char** argv) {
    // This very program is its worker.
    if (argc > 1 && std::strcmp(argv[1], "worker") == 0) return imomushi::workerMain();
    imomushi::setWorkerProgram("/proc/self/exe");
    feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW);
    imomushi::ownHome();
    // RapidCheck's chance is the same in each run, but for thorough ones: who changes something finds what that broke, and nothing else.
    if (!std::getenv("IMOMUSHI_THOROUGH")) setenv("RC_PARAMS", "seed=1", 0);
    return imomushi::statusOf(doctest::Context(argc, argv).run());
}
