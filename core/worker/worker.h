// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/worker/codec.h"

// What libraries do with foreign surfaces may crash, or never end. Operations on such surfaces are done by a worker: a process of the same program, which is kept, and keeps
// large arguments by their content, so that another operation on the same body begins at once. A room declares an operation, whose function stays in its .cpp file:
//
//     const Operation<Result<Body>(TriangleMesh, BodySetting)> kMakeBody("make-body", makeBodyHere);
//     Result<Body> makeBody(const TriangleMesh& mesh, const BodySetting& setting, const Progress& progress) { return kMakeBody(mesh, setting, progress); }
//
// A worker knows an operation wherever the function that asks for it is linked. The answer has the same bytes with and without workers.
namespace imomushi {

/// What one operation may use of the machine.
struct WorkLimits {
    std::size_t memoryBytes = std::size_t{8} << 30;  ///< address space of the worker
    int cpuSeconds = 600;
    double wallSeconds = 3600.0;
    /// A step that reaches one of them is left out, as one that crashes is, and the answer says so. False: the operation fails, as where what is left would be stored for what was
    /// asked, and a faster machine would give another answer.
    bool leaveOut = true;
};

/// The program whose workers do operations from now on, called as `PROGRAM worker`; "/proc/self/exe" is this one, if its main() calls workerMain(). Empty, as it is unless
/// somebody sets it: operations are done in this process. Workers of another program end.
void setWorkerProgram(std::filesystem::path program);

/// main() of a worker.
int workerMain();

/// Whether operations are done by workers. Not within a worker.
bool workersInUse();

/// Says, within an operation, what is tried while this lives: what may crash, or never end. False: it did before, and is left out; then the operation goes on without it, or
/// fails with the reason. In a process that is no worker always true. Of the thread that does the operation alone. `step`: a few words, such as "a union of two parts".
class Attempt {
public:
    explicit Attempt(std::string_view step);
    ~Attempt();
    Attempt(const Attempt&) = delete;
    Attempt& operator=(const Attempt&) = delete;
    explicit operator bool() const { return allowed_; }

private:
    int unwinding_;  // exceptions, when it began
    bool allowed_ = true;
};
/// The steps that were left out of the operation so far.
std::vector<std::string> leftOutSteps();

/// How often an operation is begun again, each time without one step more.
inline constexpr int kMostLeftOut = 8;

/// Asks a worker for an operation. Errors: "cancelled"; "timeout", "too-large": a limit was reached outside of any step, or no step may be left out for it; "worker-failed": it crashed outside of any step, or in more
/// than kMostLeftOut of them; "worker-killed": somebody else ended it, twice. None of them is an answer: what was asked for is still unknown, and may be asked again.
Result<std::string> askWorker(std::string_view operation, const std::vector<std::string>& arguments, const WorkLimits& limits,
                              const Progress& progress);

using OperationHandler = std::string (*)(const void* operation, const std::vector<std::string_view>& arguments, const Progress& progress);
void registerOperation(const char* name, OperationHandler handler, const void* operation);

template <class Signature>
class Operation;

/// A static constant.
template <class Answer, class... Asked>
class Operation<Answer(Asked...)> {
public:
    using Function = Answer (*)(const Asked&..., const Progress&);

    Operation(const char* name, Function here) : name_(name), here_(here) { registerOperation(name, &Operation::handle, this); }
    Operation(const Operation&) = delete;
    Operation& operator=(const Operation&) = delete;

    Answer operator()(const Asked&... asked, const Progress& progress, const WorkLimits& limits = {}) const {
        if (!workersInUse()) return here_(asked..., progress);
        std::vector<std::string> arguments;
        (arguments.push_back(bytesOf(asked)), ...);
        const auto bytes = askWorker(name_, arguments, limits, progress);
        if (!bytes) return failed(bytes.error());
        const Answer contradiction =
            failed({"worker-failed", "The worker answered with something that contradicts itself: repair what it was given, or try again."});
        Answer answer = contradiction;
        MessageIn in(*bytes);
        in(answer);
        if (!in.finished()) answer = contradiction;
        return answer;
    }

private:
    template <class T>
    static std::string bytesOf(const T& value) {
        MessageOut out;
        out(value);
        return out.take();
    }
    static Answer failed(const Error& error) {
        typename Answer::error_type e;
        static_cast<Error&>(e) = error;
        return tl::unexpected(std::move(e));
    }
    static std::string handle(const void* operation, const std::vector<std::string_view>& arguments, const Progress& progress) {
        return static_cast<const Operation*>(operation)->handle(arguments, progress, std::index_sequence_for<Asked...>());
    }
    template <std::size_t... I>
    std::string handle(const std::vector<std::string_view>& arguments, const Progress& progress, std::index_sequence<I...>) const {
        std::tuple<Asked...> asked;
        bool good = arguments.size() == sizeof...(Asked);
        const auto read = [&](std::string_view bytes, auto& value) {
            MessageIn in(bytes);
            in(value);
            good = good && in.finished();
        };
        if (good) (read(arguments[I], std::get<I>(asked)), ...);
        return bytesOf(good ? here_(std::get<I>(asked)..., progress)
                            : failed({"worker-failed", "The worker was asked something that it does not understand: reinstall Imomushi."}));
    }

    const char* name_;
    Function here_;
};

}  // namespace imomushi
