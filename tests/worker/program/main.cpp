// SPDX-License-Identifier: GPL-3.0-or-later
// `PROGRAM worker`: the worker of the tests. `PROGRAM`: one that has a worker, says its process and lets it work for ever, to be killed.
#include <cstdio>
#include <cstring>

#include "tests/worker/operations.h"

int main(int argc, char** argv) {
    if (argc > 1 && std::strcmp(argv[1], "worker") == 0) return imomushi::workerMain();
    imomushi::setWorkerProgram("/proc/self/exe");
    const auto pid = imomushi::breaking("pid");
    std::puts(pid ? pid->c_str() : pid.error().message.c_str());
    std::fflush(stdout);
    return imomushi::breaking("burn").has_value();
}
