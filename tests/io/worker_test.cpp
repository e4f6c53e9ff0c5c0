// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>
#include <sys/wait.h>

#include <fstream>
#include <thread>

#include "core/io/worker_process.h"
#include "tests/io/files.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

/// The answer of a worker that misbehaves as `how` says.
Result<ImportResult> badWorker(const TestFolder& folder, const std::string& how, ImportLimits limits = {}) {
    setImportWorker(IMOMUSHI_TEST_BAD_IMPORT_WORKER);
    ImportRequest request;
    request.path = folder.write(how + ".obj", "v 0 0 0\n");
    return importFile(request, {}, limits);
}

int openDescriptors() {
    int n = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) n += !entry.path().empty();
    return n;
}

}  // namespace

TEST_CASE("import survives a worker that crashes, quits, lies or talks nonsense, and says so") {
    const TestFolder folder;
    const int before = openDescriptors();
    for (const char* how : {"crash", "abort", "quit", "garbage", "long", "huge", "lie", "mute"}) {
        CAPTURE(how);
        const auto answer = badWorker(folder, how);
        REQUIRE(!answer);
        CHECK(answer.error().code == "worker-failed");
        CHECK(answer.error().message.size() > 20);
    }
    CHECK(openDescriptors() == before);
}

TEST_CASE("import ends a worker that takes too long, by the clock and by its own work") {
    const TestFolder folder;
    ImportLimits limits;
    limits.wallSeconds = 0.3;
    auto answer = badWorker(folder, "hang", limits);
    REQUIRE(!answer);
    CHECK(answer.error().code == "timeout");
    limits.wallSeconds = 60.0;
    limits.cpuSeconds = 1;
    answer = badWorker(folder, "burn", limits);
    REQUIRE(!answer);
    CHECK(answer.error().code == "timeout");
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__clang__)  // sanitizers reserve terabytes of addresses
TEST_CASE("import ends a worker that takes too much memory") {
    const TestFolder folder;
    ImportLimits limits;
    limits.memoryBytes = std::size_t{160} << 20;
    CHECK(!badWorker(folder, "memory", limits));
    // The real worker says it in words.
    setImportWorker(IMOMUSHI_TEST_IMPORT_WORKER);
    ImportRequest request;
    // 100 MB of vertices.
    std::string large;
    for (int i = 0; i < 4000000; ++i) large += "v 0 0 0\n";
    request.path = folder.write("large.obj", large);
    const auto answer = importFile(request, {}, limits);
    REQUIRE(!answer);
    CHECK(answer.error().code == "too-large");
}
#endif

TEST_CASE("import: a worker inherits no open files") {
    const TestFolder folder;
    std::ofstream open(folder.path() / "open");
    const auto answer = badWorker(folder, "descriptors");
    REQUIRE(!answer);
    CHECK(answer.error().message == "all closed");
}

TEST_CASE("import: cancelling answers at once") {
    const TestFolder folder;
    setImportWorker(IMOMUSHI_TEST_BAD_IMPORT_WORKER);
    ImportRequest request;
    request.path = folder.write("hang.obj", "v 0 0 0\n");
    std::stop_source stop;
    // Once the worker is there.
    const auto started = [] {
        siginfo_t child{};
        return ::waitid(P_ALL, 0, &child, WEXITED | WNOHANG | WNOWAIT) == 0;
    };
    REQUIRE_FALSE(started());
    std::jthread later([&] {
        while (!started()) std::this_thread::yield();
        stop.request_stop();
    });
    // Without cancelling this would take 1000 s.
    const auto answer = importFile(request, Progress({}, stop.get_token()));
    REQUIRE(!answer);
    CHECK(answer.error().code == kCancelled);
}

TEST_CASE("import: what is no readable mesh file is refused before any worker starts") {
    setImportWorker("/nonexistent/worker");
    const TestFolder folder;
    const auto code = [](const std::filesystem::path& path, ImportLimits limits = {}) {
        ImportRequest request;
        request.path = path;
        const auto answer = importFile(request, {}, limits);
        return answer ? std::string() : answer.error().code;
    };
    CHECK(code(folder.path() / "none.obj") == "file-not-found");
    CHECK(code(folder.path()) == "not-readable");
    CHECK(code(folder.write("a.xyz", "1 2 3")) == "unknown-format");
    CHECK(code(folder.write("noending", "1 2 3")) == "unknown-format");
    ImportLimits limits;
    limits.fileBytes = 10;
    CHECK(code(folder.write("a.obj", "v 0 0 0\nv 1 0 0\n"), limits) == "too-large");
    CHECK(code(folder.write("b.obj", "v 0 0 0\n")) == "worker-failed");  // the program does not exist
}

TEST_CASE("import tells its progress, from 0 to 1 and never backwards") {
    const TestFolder folder;
    setImportWorker(IMOMUSHI_TEST_IMPORT_WORKER);
    ImportRequest request;
    request.path = folder.write("球.obj", io_test::objOf(shapes::sphere(1.0, 2).mesh));
    double last = -1.0;
    int reports = 0;
    const auto answer = importFile(request, Progress(
                                                [&](std::string_view, double f) {
                                                    CHECK(f >= last);
                                                    last = f;
                                                    ++reports;
                                                },
                                                {}));
    REQUIRE(answer);
    CHECK(answer->bodies[0].name == "球");
    CHECK(reports >= 2);
}
