// SPDX-License-Identifier: GPL-3.0-or-later
// `PROGRAM worker`: the worker of the tests. `PROGRAM`: one that has a worker, says its process and lets it work for ever, to be killed. `PROGRAM work`: one that asks for all kinds
// of operations, and lets its worker wait.
#include <unistd.h>

#include <cstdio>
#include <cstring>

#include "tests/worker/operations.h"

int main(int argc, char** argv) {
    if (argc > 1 && std::strcmp(argv[1], "worker") == 0) return imomushi::workerMain();
    imomushi::setWorkerProgram("/proc/self/exe");
    while (argc > 1) {
        if (!imomushi::repeated(std::string(std::size_t{1} << 20, 'x'), 2) || !imomushi::stepped(5, {2}, "crash")) return 1;
        ::usleep(1000);
    }
    const auto pid = imomushi::breaking("pid");
    std::puts(pid ? pid->c_str() : pid.error().message.c_str());
    std::fflush(stdout);
    return imomushi::breaking("burn").has_value();
}
