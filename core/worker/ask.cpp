// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/wait.h>

#include <csignal>
#include <cstdlib>
#include <memory>
#include <mutex>

#include "core/base/try.h"
#include "core/worker/process.h"

namespace imomushi {
using namespace worker;
namespace {

/// Workers that wait for the next operation; more than that end.
constexpr std::size_t kMostIdle = 2;
constexpr int kMostKills = 1;  // that are not taken for an answer

/// The workers of this program.
class Workers {
public:
    void use(std::string program) {
        std::vector<std::unique_ptr<WorkerProcess>> ending;
        const std::lock_guard lock(mutex_);
        program_ = std::move(program);
        ending.swap(idle_);
    }
    [[nodiscard]] bool inUse() {
        const std::lock_guard lock(mutex_);
        return !program_.empty();
    }
    Result<std::unique_ptr<WorkerProcess>> take() {
        std::string program;
        {
            const std::lock_guard lock(mutex_);
            while (!idle_.empty()) {
                std::unique_ptr<WorkerProcess> worker = std::move(idle_.back());
                idle_.pop_back();
                if (worker->alive()) return worker;
            }
            program = program_;
        }
        return WorkerProcess::start(program);
    }
    void giveBack(std::unique_ptr<WorkerProcess> worker) {
        const std::lock_guard lock(mutex_);
        if (idle_.size() < kMostIdle && worker->program() == program_) idle_.push_back(std::move(worker));
    }

private:
    std::mutex mutex_;
    std::string program_;
    std::vector<std::unique_ptr<WorkerProcess>> idle_;
};

Workers& workers() {
    static Workers all;
    return all;
}

tl::unexpected<Error> brokeDown(const std::vector<std::string>& leftOut) {
    if (leftOut.empty()) return fail("worker-failed", "The worker broke down on this surface: repair it, or export it again.");
    return fail("worker-failed",
                "The worker broke down on this surface, also without " + leftOut.back() + ": repair it, or export it again.");
}

}  // namespace

void setWorkerProgram(std::filesystem::path program) { workers().use(program.string()); }

bool workersInUse() { return !std::getenv(kWorkerMark) && workers().inUse(); }

Result<std::string> askWorker(std::string_view operation, const std::vector<std::string>& arguments, const WorkLimits& limits,
                              const Progress& progress) {
    std::vector<std::string> leftOut;
    for (int kills = 0;;) {
        IMOMUSHI_TRY(auto worker, workers().take());
        WorkerReply reply = worker->perform(operation, arguments, leftOut, limits, progress);
        if (reply.end == WorkerReply::End::Answered) {
            workers().giveBack(std::move(worker));
            return std::move(reply.answer);
        }
        worker.reset();
        const bool died = reply.end == WorkerReply::End::Died,
                   late =
                       reply.end == WorkerReply::End::TimedOut || (died && WIFSIGNALED(reply.status) && WTERMSIG(reply.status) == SIGXCPU);
        if (reply.end == WorkerReply::End::Cancelled) return fail(kCancelled, "It was cancelled.");
        if (reply.end == WorkerReply::End::Nonsense)
            return fail("worker-failed", "The worker answered with something that is no answer: reinstall Imomushi.");
        if (died && WIFSIGNALED(reply.status) && WTERMSIG(reply.status) == SIGKILL) {
            // Not its own doing: the same again gives what was asked for.
            if (kills++ < kMostKills) continue;
            return fail("worker-killed",
                        "The worker was ended from outside, probably for lack of memory: close other programs and try again.");
        }
        const bool limited = late || reply.end == WorkerReply::End::NoMemory;
        if (!reply.step.empty() && (limits.leaveOut || !limited) && leftOut.size() < static_cast<std::size_t>(kMostLeftOut)) {
            leftOut.push_back(std::move(reply.step));
            continue;
        }
        if (late) return fail("timeout", "This takes longer than an operation may: reduce the mesh, or repair it.");
        if (reply.end == WorkerReply::End::NoMemory)
            return fail("too-large", "This needs more memory than an operation may use: reduce the mesh.");
        return brokeDown(leftOut);
    }
}

}  // namespace imomushi
