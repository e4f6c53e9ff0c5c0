// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/worker/process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "core/base/clock.h"
#include "core/base/hash.h"

namespace imomushi::worker {
namespace {

constexpr int kPollMilliseconds = 20;                 // cancelling answers within this time
constexpr std::size_t kChunk = std::size_t{1} << 16;  // bytes received at once
/// Arguments from this size on are kept.
constexpr std::size_t kWorthKeeping = 16384;
/// A worker keeps this many at least, and more as long as they are small.
constexpr std::size_t kLeastKept = 4, kMostKept = 16, kMostKeptBytes = std::size_t{256} << 20;

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kAddressSanitizer = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
constexpr bool kAddressSanitizer = true;
#else
constexpr bool kAddressSanitizer = false;
#endif
#else
constexpr bool kAddressSanitizer = false;
#endif

void limit(pid_t pid, __rlimit_resource resource, rlim_t value, rlim_t more = 0) {
    rlimit old{};
    if (::prlimit(pid, resource, nullptr, &old) != 0) return;
    const rlimit wanted{std::min(value, old.rlim_max), resource == RLIMIT_CPU ? old.rlim_max : std::min(value + more, old.rlim_max)};
    ::prlimit(pid, resource, &wanted, nullptr);
}

Result<pid_t> spawn(const std::string& program, int socket, int board) {
    std::vector<std::string> environment;
    for (char** e = environ; *e; ++e) environment.emplace_back(*e);
    environment.emplace_back(kWorkerMark).append("=1");
    std::vector<char*> env;
    for (std::string& e : environment) env.push_back(e.data());
    env.push_back(nullptr);
    std::string name = program, argument = "worker";
    char* arguments[] = {name.data(), argument.data(), nullptr};

    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, socket, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&files, board, STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addclosefrom_np(&files, 3);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
    pid_t pid = -1;
    const int error = ::posix_spawn(&pid, program.c_str(), &files, &attributes, arguments, env.data());
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    if (error != 0)
        return fail("worker-failed", "The worker '" + program + "' cannot be started (" + std::strerror(error) + "): reinstall Imomushi.");
    return pid;
}

}  // namespace

Result<std::unique_ptr<WorkerProcess>> WorkerProcess::start(const std::string& program) {
    int pair[2] = {-1, -1};
    const int memory = ::memfd_create("worker", MFD_CLOEXEC);
    void* board = memory >= 0 && ::ftruncate(memory, kBoard) == 0 ? ::mmap(nullptr, kBoard, PROT_READ, MAP_SHARED, memory, 0) : MAP_FAILED;
    Result<pid_t> pid =
        fail("worker-failed", std::string("No connection to a worker (") + std::strerror(errno) + "): close other programs.");
    if (board != MAP_FAILED && ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) == 0) pid = spawn(program, pair[1], memory);
    for (const int mine : {memory, pair[1]})
        if (mine >= 0) ::close(mine);
    if (pid) return std::unique_ptr<WorkerProcess>(new WorkerProcess(program, *pid, pair[0], static_cast<const char*>(board)));
    if (pair[0] >= 0) ::close(pair[0]);
    if (board != MAP_FAILED) ::munmap(board, kBoard);
    return tl::unexpected(pid.error());
}

WorkerProcess::~WorkerProcess() {
    kill();
    ::close(socket_);
    ::munmap(const_cast<char*>(board_), kBoard);
}

void WorkerProcess::kill() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
}

int WorkerProcess::wait() {
    // One that closed its connection and goes on is killed.
    int status = 0;
    for (const auto began = Clock::now(); pid_ > 0;) {
        const pid_t ended = ::waitpid(pid_, &status, WNOHANG);
        if (ended == pid_ || (ended < 0 && errno != EINTR)) break;
        if (secondsSince(began) > 1.0) {
            kill();
            return 0;
        }
        ::usleep(1000);
    }
    pid_ = -1;
    return status;
}

bool WorkerProcess::alive() const {
    pollfd state{socket_, POLLIN, 0};  // anything to read is an end, or nonsense
    siginfo_t info{};
    return ::poll(&state, 1, 0) == 0 && ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           info.si_pid == 0;
}

void WorkerProcess::setLimits(const WorkLimits& limits) const {
    if (!kAddressSanitizer) limit(pid_, RLIMIT_AS, limits.memoryBytes);  // it reserves terabytes of addresses
    clockid_t clock{};
    timespec used{};
    if (::clock_getcpuclockid(pid_, &clock) == 0) ::clock_gettime(clock, &used);
    limit(pid_, RLIMIT_CPU, static_cast<rlim_t>(used.tv_sec + 1 + limits.cpuSeconds));
    limit(pid_, RLIMIT_FSIZE, 0);
    limit(pid_, RLIMIT_CORE, 0);
    limit(pid_, RLIMIT_NOFILE, 64);
}

std::vector<std::string> WorkerProcess::messagesFor(std::string_view operation, const std::vector<std::string>& arguments,
                                                    const std::vector<std::string>& leftOut) {
    std::vector<std::string> messages;
    const auto add = [&](FrameKind kind, std::string_view content) {
        messages.push_back(frameHeader(kind, content.size()).append(content));
    };
    Request request{std::string(operation), leftOut, {}};
    std::size_t used = 0;
    for (const std::string& argument : arguments) {
        if (argument.size() < kWorthKeeping) {
            request.arguments.push_back({0, 0, {argument.begin(), argument.end()}});
            continue;
        }
        ContentHasher hasher;
        hasher.text(argument);
        const ContentKey key = hasher.key();
        auto at = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.high == key.high && k.low == key.low; });
        if (at == kept_.end()) {
            ByteWriter w;
            w.value(key.high);
            w.value(key.low);
            w.raw(argument.data(), argument.size());
            add(FrameKind::Keep, w.take());
            at = kept_.insert(kept_.begin(), {key.high, key.low, argument.size()});
        }
        kept_.splice(kept_.begin(), kept_, at);
        request.arguments.push_back({key.high, key.low, {}});
        ++used;
    }
    std::size_t bytes = 0;
    for (const Kept& k : kept_) bytes += k.bytes;
    while (kept_.size() > std::max(used, kLeastKept) && (kept_.size() > kMostKept || bytes > kMostKeptBytes)) {
        ByteWriter w;
        w.value(kept_.back().high);
        w.value(kept_.back().low);
        add(FrameKind::Forget, w.take());
        bytes -= kept_.back().bytes;
        kept_.pop_back();
    }
    MessageOut out;
    out(request);
    add(FrameKind::Request, out.take());
    return messages;
}

WorkerReply WorkerProcess::perform(std::string_view operation, const std::vector<std::string>& arguments,
                                   const std::vector<std::string>& leftOut, const WorkLimits& limits, const Progress& progress) {
    const auto began = Clock::now();
    WorkerReply reply;
    const auto ended = [&](WorkerReply::End end) {
        reply.end = end;
        reply.step.assign(board_, ::strnlen(board_, kBoard));
        return std::move(reply);
    };
    const auto died = [&] {
        reply.status = wait();
        return ended(WorkerReply::End::Died);
    };
    /// Waits until the socket is ready for `what`. False: it is to be given up, as `end` says.
    auto end = WorkerReply::End::Died;
    const auto ready = [&](short what) {
        for (;;) {
            if (progress.cancelled()) return end = WorkerReply::End::Cancelled, false;
            if (secondsSince(began) > limits.wallSeconds) return end = WorkerReply::End::TimedOut, false;
            pollfd state{socket_, what, 0};
            if (::poll(&state, 1, kPollMilliseconds) > 0) return true;
        }
    };
    setLimits(limits);
    for (const std::string& message : messagesFor(operation, arguments, leftOut))
        for (std::size_t sent = 0; sent < message.size();) {
            if (!ready(POLLOUT)) return ended(end);
            const ssize_t n = ::send(socket_, message.data() + sent, message.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
            if (n < 0 && errno != EAGAIN && errno != EINTR) return died();
            sent += static_cast<std::size_t>(std::max<ssize_t>(n, 0));
        }

    std::string received;  // not yet understood
    std::string chunk(kChunk, '\0');
    std::size_t understood = 0;
    for (;;) {
        while (received.size() - understood >= kFrameHeader) {
            FrameKind kind{};
            std::uint64_t length = 0;
            const std::string_view rest = std::string_view(received).substr(understood);
            if (!parseFrameHeader(rest, kind, length) || kind < FrameKind::Progress) return ended(WorkerReply::End::Nonsense);
            if (rest.size() - kFrameHeader < length) break;
            const std::string_view content = rest.substr(kFrameHeader, length);
            understood += kFrameHeader + length;
            switch (kind) {
                case FrameKind::Answer:
                    if (understood != received.size()) return ended(WorkerReply::End::Nonsense);
                    received.erase(0, understood - length);
                    reply.answer = std::move(received);
                    return ended(WorkerReply::End::Answered);
                case FrameKind::NoMemory:
                    return ended(WorkerReply::End::NoMemory);
                default: {
                    std::string stage;
                    double fraction = 0.0;
                    MessageIn in(content);
                    in(stage, fraction);
                    if (!in.finished() || !(fraction >= 0.0 && fraction <= 1.0)) return ended(WorkerReply::End::Nonsense);
                    progress.report(stage, fraction);
                }
            }
        }
        received.erase(0, std::exchange(understood, 0));
        if (!ready(POLLIN)) return ended(end);
        const ssize_t n = ::recv(socket_, chunk.data(), kChunk, MSG_DONTWAIT);
        if (n > 0) received.append(chunk, 0, static_cast<std::size_t>(n));
        if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) return died();
    }
}

}  // namespace imomushi::worker
