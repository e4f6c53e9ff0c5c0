// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/worker/operations.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace imomushi {

void members(auto& archive, Stepped& s) { archive(s.sum, s.leftOut); }

namespace {

void breakDown(const std::string& how) {
    if (how == "crash") ::raise(SIGSEGV);
    if (how == "abort") std::abort();
    if (how == "exit") ::_exit(7);
    if (how == "kill") ::kill(::getpid(), SIGKILL);
    if (how == "sleep") ::sleep(1000);
    if (how == "burn")
        for (;;) ::getppid();
    if (how == "memory") {
        std::vector<std::string> all;
        for (;;) all.emplace_back(std::size_t{1} << 24, 'x');
    }
    if (how == "garbage")
        for (int file = 3; file < 16; ++file)
            [[maybe_unused]] const ssize_t n = ::write(file, "this is not what a worker should ever say to anybody", 52);
}

Result<std::string> repeatedHere(const std::string& text, const int& times, const Progress& progress) {
    std::string all;
    for (int i = 0; i < times; ++i) {
        all += text;
        progress.report("repeat", static_cast<double>(i + 1) / times);
    }
    return all;
}

Result<Stepped> steppedHere(const int& steps, const std::vector<int>& breaking, const std::string& how, const Progress&) {
    Stepped out;
    for (int i = 1; i <= steps; ++i) {
        const Attempt step("a step");
        if (!step) continue;
        if (std::find(breaking.begin(), breaking.end(), i) != breaking.end()) breakDown(how);
        out.sum += i;
    }
    out.leftOut = leftOutSteps();
    return out;
}

Result<std::string> breakingHere(const std::string& how, const Progress&) {
    if (how == "descriptors") {
        std::string open;
        for (int file = 3; file < 64; ++file)
            if (::fcntl(file, F_GETFD) != -1) open += std::to_string(file) + " ";
        return open;
    }
    if (how == "pid") return std::to_string(::getpid());
    breakDown(how);
    return std::string("nothing broke");
}

const Operation<Result<std::string>(std::string, int)> kRepeated("repeated", repeatedHere);
const Operation<Result<Stepped>(int, std::vector<int>, std::string)> kStepped("stepped", steppedHere);
const Operation<Result<std::string>(std::string)> kBreaking("breaking", breakingHere);

}  // namespace

Result<std::string> repeated(const std::string& text, int times, const Progress& progress, const WorkLimits& limits) {
    return kRepeated(text, times, progress, limits);
}
Result<Stepped> stepped(int steps, const std::vector<int>& breaking, const std::string& how, const Progress& progress,
                        const WorkLimits& limits) {
    return kStepped(steps, breaking, how, progress, limits);
}
Result<std::string> breaking(const std::string& how, const Progress& progress, const WorkLimits& limits) {
    return kBreaking(how, progress, limits);
}

}  // namespace imomushi
