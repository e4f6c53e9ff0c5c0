// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/worker/frame.h"
#include "core/worker/worker.h"

// Of this room alone.
namespace imomushi::worker {

/// How asking a worker ended.
struct WorkerReply {
    enum class End { Answered, Cancelled, TimedOut, NoMemory, Died, Nonsense } end = End::Died;
    std::string answer;
    std::string step;  ///< what it tried when it ended
    int status = 0;    ///< of a dead one, as waitpid() gives it
};

/// A worker process, killed and waited for at the latest at the end of this.
class WorkerProcess {
public:
    /// Errors: "worker-failed".
    static Result<std::unique_ptr<WorkerProcess>> start(const std::string& program);
    ~WorkerProcess();
    WorkerProcess(const WorkerProcess&) = delete;
    WorkerProcess& operator=(const WorkerProcess&) = delete;

    [[nodiscard]] const std::string& program() const { return program_; }
    /// Whether it still waits for requests, as far as can be told.
    [[nodiscard]] bool alive() const;
    /// Does one operation. After anything but an answer it is of no use any more.
    WorkerReply perform(std::string_view operation, const std::vector<std::string>& arguments, const std::vector<std::string>& leftOut,
                        const WorkLimits& limits, const Progress& progress);

private:
    struct Kept {
        std::uint64_t high, low;
        std::size_t bytes;
    };
    WorkerProcess(std::string program, pid_t pid, int socket, const char* board)
        : program_(std::move(program)), pid_(pid), socket_(socket), board_(board) {}
    void setLimits(const WorkLimits& limits) const;
    std::vector<std::string> messagesFor(std::string_view operation, const std::vector<std::string>& arguments,
                                         const std::vector<std::string>& leftOut);
    int wait();
    void kill();

    std::string program_;
    pid_t pid_;
    int socket_;
    const char* board_;
    std::list<Kept> kept_;  // what it keeps, the one used last first
};

}  // namespace imomushi::worker
