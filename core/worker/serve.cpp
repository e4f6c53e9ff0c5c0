// SPDX-License-Identifier: GPL-3.0-or-later
// The worker's side: requests come over standard input, one after the other, and each gets progress, steps and one answer. The program sets the limits from outside.
#include <fcntl.h>
#include <malloc.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <exception>
#include <map>
#include <new>
#include <system_error>
#include <thread>
#include <utility>

#include "core/base/clock.h"
#include "core/worker/frame.h"
#include "core/worker/worker.h"

namespace imomushi {
using namespace worker;
namespace {

struct Known {
    OperationHandler handler;
    const void* operation;
};

/// Filled before main().
std::map<std::string, Known, std::less<>>& operations() {
    static std::map<std::string, Known, std::less<>> known;
    return known;
}

bool readAll(int file, char* to, std::size_t size) {
    while (size > 0) {
        const ssize_t n = ::read(file, to, size);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        to += n;
        size -= static_cast<std::size_t>(n);
    }
    return true;
}

bool writeAll(int file, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t n = ::send(file, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(n));
    }
    return true;
}

constexpr std::size_t kSmall = 4096;      // bytes that go along with the header
constexpr double kBetweenReports = 0.02;  // s, of one stage
constexpr int kIdleMilliseconds = 1000;   // after which what is free is given back to the system

bool say(int file, FrameKind kind, std::string_view content) {
    const std::string header = frameHeader(kind, content.size());
    return content.size() < kSmall ? writeAll(file, header + std::string(content)) : writeAll(file, header) && writeAll(file, content);
}

/// The operation that is done.
struct Current {
    char* board;
    const std::vector<std::string>& toLeaveOut;
    std::map<std::string, int, std::less<>> count;
    std::vector<std::string> leftOut;
    std::vector<std::string> steps;  ///< that are tried, one within the other

    void show() const {
        const std::string_view step = steps.empty() ? std::string_view() : std::string_view(steps.back()).substr(0, kBoard - 1);
        board[step.copy(board, kBoard - 1)] = '\0';
    }
};
thread_local Current* current = nullptr;

struct Serving {
    int socket;
    char* board;
    std::map<std::pair<std::uint64_t, std::uint64_t>, std::string> kept;

    bool answer(std::string_view content) {
        Request request;
        MessageIn in(content);
        in(request);
        const auto known = operations().find(request.operation);
        if (!in.finished() || known == operations().end()) return false;
        std::vector<std::string_view> arguments;
        for (const RequestArgument& argument : request.arguments) {
            if (argument.high == 0 && argument.low == 0) {
                arguments.emplace_back(argument.bytes.data(), argument.bytes.size());
                continue;
            }
            const auto at = kept.find({argument.high, argument.low});
            if (at == kept.end()) return false;
            arguments.emplace_back(at->second);
        }
        std::string told;
        auto last = Clock::now();
        const Progress progress(
            [&](std::string_view stage, double fraction) {
                // Nobody sees more, and each wakes the program.
                if (stage == told && fraction < 1.0 && secondsSince(last) < kBetweenReports) return;
                told = stage;
                last = Clock::now();
                MessageOut out;
                out(told, fraction);
                say(socket, FrameKind::Progress, out.take());
            },
            {});
        Current now{board, request.leftOut, {}, {}, {}};
        now.show();
        current = &now;
        bool sent = false;
        try {
            const std::string bytes = known->second.handler(known->second.operation, arguments, progress);
            sent = say(socket, FrameKind::Answer, bytes);
        } catch (const std::bad_alloc&) {
            sent = say(socket, FrameKind::NoMemory, {});
        }
        current = nullptr;
        return sent;
    }
};

}  // namespace

void registerOperation(const char* name, OperationHandler handler, const void* operation) { operations()[name] = {handler, operation}; }

Attempt::Attempt(std::string_view step) : unwinding_(std::uncaught_exceptions()) {
    if (!current) return;
    int& count = current->count.try_emplace(std::string(step), 0).first->second;
    const std::string name = std::string(step) + " (" + std::to_string(++count) + ")";
    allowed_ = std::find(current->toLeaveOut.begin(), current->toLeaveOut.end(), name) == current->toLeaveOut.end();
    (allowed_ ? current->steps : current->leftOut).push_back(name);
    current->show();
}

Attempt::~Attempt() {
    // What ran out of memory is still what was tried.
    if (!current || !allowed_ || std::uncaught_exceptions() != unwinding_) return;
    current->steps.pop_back();
    current->show();
}

std::vector<std::string> leftOutSteps() { return current ? current->leftOut : std::vector<std::string>(); }

int workerMain() {
    ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    // Where memory runs out for all, the system ends this process and not the studio.
    if (const int file = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC); file >= 0) {
        [[maybe_unused]] const ssize_t n = ::write(file, "500", 3);
        ::close(file);
    }
    // What libraries print must not get between the frames.
    const int socket = ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3);
    const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
    void* board = ::mmap(nullptr, kBoard, PROT_READ | PROT_WRITE, MAP_SHARED, STDOUT_FILENO, 0);
    if (board == MAP_FAILED || socket < 0 || nowhere < 0 || ::dup2(nowhere, STDIN_FILENO) < 0 || ::dup2(nowhere, STDOUT_FILENO) < 0)
        return 1;
    // It ends with its program, however busy it is. The signal of PR_SET_PDEATHSIG comes when the thread ends that started it, and that is not the program.
    try {
        std::thread([socket] {
            pollfd gone{socket, POLLRDHUP, 0};
            while (::poll(&gone, 1, -1) < 0 && errno == EINTR) {
            }
            ::_exit(0);
        }).detach();
    } catch (const std::system_error&) {
        return 1;
    }
    Serving serving{socket, static_cast<char*>(board), {}};
    for (;;) {
        if (pollfd more{socket, POLLIN, 0}; ::poll(&more, 1, kIdleMilliseconds) == 0) ::malloc_trim(0);  // nobody waits now
        char header[kFrameHeader];
        FrameKind kind{};
        std::uint64_t length = 0;
        if (!readAll(socket, header, sizeof header)) ::_exit(0);
        if (!parseFrameHeader({header, sizeof header}, kind, length)) ::_exit(2);
        try {
            std::string content(length, '\0');
            if (!readAll(socket, content.data(), content.size())) ::_exit(0);
            if (kind == FrameKind::Request) {
                if (!serving.answer(content)) ::_exit(2);
                continue;
            }
            std::uint64_t high = 0, low = 0;
            ByteReader r(content);
            high = r.value<std::uint64_t>();
            low = r.value<std::uint64_t>();
            if (!r.good()) ::_exit(2);
            if (kind == FrameKind::Keep)
                serving.kept[{high, low}] = content.substr(2 * sizeof high);
            else if (kind == FrameKind::Forget)
                serving.kept.erase({high, low});
            else
                ::_exit(2);
        } catch (const std::bad_alloc&) {
            say(socket, FrameKind::NoMemory, {});
            ::_exit(3);
        }
    }
}

}  // namespace imomushi
