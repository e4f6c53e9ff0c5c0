// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/io/import.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <mutex>

#include "core/io/message.h"
#include "core/io/raw_scene.h"
#include "core/io/worker_process.h"

namespace imomushi {
namespace {

/// Set in a worker's environment: a worker never starts another one.
constexpr const char* kWorkerMark = "IMOMUSHI_IMPORT_WORKER";
constexpr int kPollMilliseconds = 20;  // cancelling answers within this time
constexpr std::size_t kChunk = std::size_t{1} << 20;
constexpr std::uint64_t kLargestAnswer = std::uint64_t{4} << 30;

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

std::mutex workerMutex;
std::filesystem::path workerProgram;  // empty: this executable

class Descriptor {
public:
    explicit Descriptor(int fd = -1) : fd_(fd) {}
    ~Descriptor() { close(); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    void close() {
        if (fd_ >= 0) ::close(fd_);
        fd_ = -1;
    }
    [[nodiscard]] int get() const { return fd_; }
    void set(int fd) {
        close();
        fd_ = fd;
    }

private:
    int fd_;
};

/// A started process, killed and waited for at the latest at the end of its scope.
class Child {
public:
    explicit Child(pid_t pid) : pid_(pid) {}
    ~Child() { kill(); }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;
    void kill() {
        if (pid_ <= 0) return;
        ::kill(pid_, SIGKILL);
        while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
        }
        pid_ = -1;
    }
    /// How it ended. One that closed its connection and goes on is killed after `seconds`.
    int wait(double seconds = 1.0) {
        int status = 0;
        for (const auto began = std::chrono::steady_clock::now(); pid_ > 0;) {
            const pid_t ended = ::waitpid(pid_, &status, WNOHANG);
            if (ended == pid_ || (ended < 0 && errno != EINTR)) break;
            if (std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count() > seconds) {
                ::kill(pid_, SIGKILL);
                while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
                }
                break;
            }
            ::usleep(1000);
        }
        pid_ = -1;
        return status;
    }

private:
    pid_t pid_;
};

void limit(pid_t pid, __rlimit_resource resource, rlim_t value) {
    rlimit old{};
    if (::prlimit(pid, resource, nullptr, &old) != 0) return;
    rlimit wanted{std::min(value, old.rlim_max), std::min(resource == RLIMIT_CPU ? value + 5 : value, old.rlim_max)};
    ::prlimit(pid, resource, &wanted, nullptr);
}

void setLimits(pid_t pid, const ImportLimits& limits) {
    if (!kAddressSanitizer) limit(pid, RLIMIT_AS, limits.memoryBytes);  // it reserves terabytes of addresses
    limit(pid, RLIMIT_CPU, static_cast<rlim_t>(limits.cpuSeconds));
    limit(pid, RLIMIT_FSIZE, 0);
    limit(pid, RLIMIT_CORE, 0);
    limit(pid, RLIMIT_NOFILE, 64);
}

Result<pid_t> start(const std::string& program, int socket) {
    std::vector<std::string> environment;
    for (char** e = environ; *e; ++e) environment.emplace_back(*e);
    environment.emplace_back(kWorkerMark).append("=1");
    std::vector<char*> env;
    for (std::string& e : environment) env.push_back(e.data());
    env.push_back(nullptr);
    std::string name = program, argument = "import-worker";
    char* arguments[] = {name.data(), argument.data(), nullptr};

    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, socket, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&files, socket, STDOUT_FILENO);
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
        return fail("worker-failed", "The import worker '" + program + "' cannot be started (" + std::strerror(error) + "): reinstall Imomushi.");
    return pid;
}

tl::unexpected<Error> died(int status, const std::string& quoted, const ImportLimits& limits) {
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
        return fail("timeout", quoted + " took more than " + std::to_string(limits.cpuSeconds) + " s to read: reduce the mesh, or split the file.");
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
        return fail("too-large", "Reading " + quoted + " was ended by the system, probably for lack of memory: reduce the mesh, or split the file.");
    if (WIFSIGNALED(status))
        return fail("worker-failed", "The reader crashed on " + quoted + ": the file is damaged; export it again, best as GLB or OBJ.");
    return fail("worker-failed", "The reader gave up on " + quoted + " without an answer: the file is probably damaged; export it again.");
}

/// What a caller asks the worker for, and how it reads the answer.
template <class Answer>
struct Question {
    FrameKind kind;
    Result<Answer> (*decode)(std::string_view);
};

template <class Answer>
Result<Answer> converse(const std::string& program, const Question<Answer>& asked, const ImportRequest& request, const Progress& progress, const ImportLimits& limits) {
    const std::string quoted = quotedName(request.path);
    int pair[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
        return fail("worker-failed", std::string("No connection to an import worker (") + std::strerror(errno) + "): close other programs.");
    Descriptor mine(pair[0]), theirs(pair[1]);
    const auto began = std::chrono::steady_clock::now();
    const auto pid = start(program, theirs.get());
    if (!pid) return tl::unexpected(pid.error());
    Child child(*pid);
    theirs.close();
    setLimits(*pid, limits);

    const std::string question = frame(asked.kind, encodeRequest(request));
    if (::send(mine.get(), question.data(), question.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(question.size()))
        return died(child.wait(), quoted, limits);

    const auto garbage = [&] {
        return fail("worker-failed", "The import worker answered " + quoted + " with something that is no answer: reinstall Imomushi.");
    };
    std::string received;  // not yet understood
    bool open = true;
    for (;;) {
        while (received.size() >= kFrameHeader) {
            FrameKind kind{};
            std::uint64_t length = 0;
            if (!parseFrameHeader(received, kind, length) || (kind != FrameKind::Answer && kind != FrameKind::Progress) || length > kLargestAnswer) return garbage();
            if (received.size() - kFrameHeader < length) break;
            const std::string_view content = std::string_view(received).substr(kFrameHeader, length);
            if (kind == FrameKind::Answer) {
                child.kill();
                return asked.decode(content);
            }
            std::string stage;
            double fraction = 0.0;
            if (!decodeProgress(content, stage, fraction)) return garbage();
            progress.report(stage, fraction);
            received.erase(0, kFrameHeader + length);
        }
        if (!open) {
            const int status = child.wait();
            return received.empty() || WIFSIGNALED(status) ? died(status, quoted, limits) : garbage();
        }
        if (progress.cancelled()) return fail(kCancelled, "The import of " + quoted + " was cancelled.");
        if (std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count() > limits.wallSeconds)
            return fail("timeout", quoted + " took too long to read: reduce the mesh, or split the file.");
        pollfd wait{mine.get(), POLLIN, 0};
        const int ready = ::poll(&wait, 1, kPollMilliseconds);
        if (ready < 0 && errno != EINTR) return garbage();
        if (ready <= 0) continue;
        const std::size_t before = received.size();
        received.resize(before + kChunk);  // grows with what came, whatever length was announced
        const ssize_t n = ::recv(mine.get(), received.data() + before, kChunk, MSG_DONTWAIT);
        received.resize(before + static_cast<std::size_t>(std::max<ssize_t>(n, 0)));
        if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) open = false;
    }
}

template <class Answer>
Result<Answer> ask(const Question<Answer>& asked, const ImportRequest& request, const Progress& progress, const ImportLimits& limits) {
    namespace fs = std::filesystem;
    const std::string quoted = quotedName(request.path);
    std::error_code error;
    const fs::file_status status = fs::status(request.path, error);
    if (!fs::exists(status)) return fail("file-not-found", "There is no file '" + cleanName(request.path.string(), "?") + "': check the path.");
    if (!fs::is_regular_file(status)) return fail("not-readable", quoted + " is not a file: choose a mesh file.");
    if (formatOf(request.path).empty())
        return fail("unknown-format", quoted + " is of no kind that can be read: OBJ, PLY, STL, glTF, GLB, FBX and DAE can.");
    if (::access(request.path.c_str(), R_OK) != 0) return fail("not-readable", quoted + " cannot be read: check its permissions.");
    const std::uintmax_t size = fs::file_size(request.path, error);
    if (error) return fail("not-readable", quoted + " cannot be read: check its permissions.");
    if (size > limits.fileBytes)
        return fail("too-large", quoted + " is larger than " + std::to_string(limits.fileBytes >> 20) + " MB: reduce the mesh, or split the file.");
    if (progress.cancelled()) return fail(kCancelled, "The import of " + quoted + " was cancelled.");
    if (std::getenv(kWorkerMark)) return fail("worker-failed", "An import worker was asked to start another one.");

    std::string program;
    {
        const std::lock_guard lock(workerMutex);
        program = workerProgram.empty() ? "/proc/self/exe" : workerProgram.string();
    }
    ImportRequest absolute = request;
    absolute.path = fs::absolute(request.path, error);
    if (error) return fail("not-readable", quoted + " cannot be read: check its path.");
    try {
        return converse(program, asked, absolute, progress, limits);
    } catch (const std::bad_alloc&) {
        return fail("too-large", quoted + " needs more memory than there is: reduce the mesh, or split the file.");
    }
}

}  // namespace

void setImportWorker(std::filesystem::path program) {
    const std::lock_guard lock(workerMutex);
    workerProgram = std::move(program);
}

Result<ImportResult> importFile(const ImportRequest& request, const Progress& progress, const ImportLimits& limits) {
    return ask(Question<ImportResult>{FrameKind::Request, decodeAnswer}, request, progress, limits);
}

Result<ImportResult> importFile(const ImportRequest& request, const Progress& progress) { return importFile(request, progress, ImportLimits{}); }

Result<CharacterFile> importCharacter(const ImportRequest& request, const Progress& progress, const ImportLimits& limits) {
    return ask(Question<CharacterFile>{FrameKind::CharacterRequest, decodeCharacter}, request, progress, limits);
}

Result<CharacterFile> importCharacter(const ImportRequest& request, const Progress& progress) { return importCharacter(request, progress, ImportLimits{}); }

}  // namespace imomushi
