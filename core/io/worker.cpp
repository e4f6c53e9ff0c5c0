// SPDX-License-Identifier: GPL-3.0-or-later
// The worker's side of importFile() and importCharacter(): one request on standard input, progress and one answer on standard output (message.h). The parent sets
// the limits of memory and time from outside, before it sends the request.
#include <fcntl.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <new>

#include "core/io/build_result.h"
#include "core/io/message.h"

namespace imomushi {
namespace {

constexpr std::uint64_t kLargestRequest = 1 << 20;

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
        const ssize_t n = ::write(file, bytes.data(), bytes.size());
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(n));
    }
    return true;
}

Result<RawScene> read(const ImportRequest& request, SceneUse use, const Progress& progress) {
    SourceFile file{request.path, {}};
    std::string bytes;
    {
        std::ifstream in(request.path, std::ios::binary | std::ios::ate);
        const auto size = in ? static_cast<std::streamoff>(in.tellg()) : std::streamoff{-1};
        if (size < 0) return fail("not-readable", file.quoted() + " cannot be read: check its permissions.");
        bytes.resize(static_cast<std::size_t>(size));
        in.seekg(0);
        if (size > 0 && !in.read(bytes.data(), size)) return fail("not-readable", file.quoted() + " cannot be read to its end: copy it again.");
    }
    file.bytes = bytes;
    progress.report("read", 0.05);
    return readScene(file, use);
}

/// Reads the scene and builds the answer of it: buildResult() or buildCharacter().
template <class Answer>
Result<Answer> answerFor(const ImportRequest& request, SceneUse use, Result<Answer> (*build)(RawScene, const ImportRequest&, const Progress&), const Progress& progress) {
    const std::string quoted = quotedName(request.path);
    try {
        auto scene = read(request, use, progress);
        if (!scene) return tl::unexpected(scene.error());
        return build(std::move(*scene), request, progress);
    } catch (const std::bad_alloc&) {
        return fail("too-large", quoted + " needs more memory than an import may use: reduce the mesh, or split the file.");
    } catch (const std::exception& e) {
        return fail("bad-file", quoted + " cannot be read (" + cleanName(e.what(), "damaged") + "): export it again.");
    }
}

}  // namespace

int importWorkerMain() {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    // What libraries print must not get between the frames.
    const int answerTo = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (answerTo < 0 || nowhere < 0 || ::dup2(nowhere, STDOUT_FILENO) < 0) return 1;

    char header[kFrameHeader];
    FrameKind kind{};
    std::uint64_t length = 0;
    if (!readAll(STDIN_FILENO, header, sizeof header) || !parseFrameHeader({header, sizeof header}, kind, length) ||
        (kind != FrameKind::Request && kind != FrameKind::CharacterRequest) || length > kLargestRequest)
        return 2;
    std::string content(length, '\0');
    if (!readAll(STDIN_FILENO, content.data(), content.size())) return 2;
    const auto request = decodeRequest(content);
    const Progress progress(
        [&](std::string_view stage, double fraction) { writeAll(answerTo, frame(FrameKind::Progress, encodeProgress(stage, fraction))); }, {});
    std::string answer;
    if (!request)
        answer = encodeAnswer(tl::unexpected(request.error()));
    else if (kind == FrameKind::Request)
        answer = encodeAnswer(answerFor(*request, SceneUse::Elements, buildResult, progress));
    else
        answer = encodeCharacter(answerFor(*request, SceneUse::Character, buildCharacter, progress));
    return writeAll(answerTo, frame(FrameKind::Answer, answer)) ? 0 : 1;
}

}  // namespace imomushi
