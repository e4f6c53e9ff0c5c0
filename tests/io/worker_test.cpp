// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>
#include <sys/wait.h>

#include <filesystem>
#include <thread>

#include "core/io/limited_import.h"
#include "tests/io/raw_scene.h"
#include "tests/support/shapes.h"
#include "tests/support/without_steps.h"

using namespace imomushi;

namespace {

/// The answer of a worker that misbehaves as `how` says.
Result<ImportResult> badWorker(const TestFolder& folder, const std::string& how, const Progress& progress = {}, const WorkLimits& limits = {}) {
    const io_test::WithWorker bad(IMOMUSHI_TEST_BAD_IMPORT_WORKER);
    ImportRequest request;
    request.path = folder.write(how + ".obj", "v 0 0 0\n");
    return importFile(request, progress, limits);
}

std::string badCode(const TestFolder& folder, const std::string& how, const WorkLimits& limits = {}) {
    const auto answer = badWorker(folder, how, {}, limits);
    if (answer) return "";
    CHECK_MESSAGE(answer.error().message.find("'" + how + ".obj'") != std::string::npos, answer.error().message);
    return answer.error().code;
}

int openDescriptors() {
    int n = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) n += !entry.path().empty();
    return n;
}

}  // namespace

TEST_CASE("import survives a reader that crashes, quits or lies, and says so of which file") {
    const TestFolder folder;
    CHECK(badCode(folder, "good") == "");
    const int before = openDescriptors();
    for (const char* how : {"crash", "abort", "quit", "lie", "latin", "closed"}) CHECK_MESSAGE(badCode(folder, how) == "worker-failed", how);
    CHECK(openDescriptors() == before);
}

TEST_CASE("import ends a reader that takes too long, by the clock and by its own work, or too much memory") {
    const TestFolder folder;
    WorkLimits limits;
    limits.wallSeconds = 0.3;
    CHECK(badCode(folder, "hang", limits) == "timeout");
    limits.wallSeconds = 60.0;
    limits.cpuSeconds = 1;
    CHECK(badCode(folder, "burn", limits) == "timeout");
#if !defined(__SANITIZE_ADDRESS__) && !defined(__clang__)  // sanitizers reserve terabytes of addresses
    limits = {};
    limits.memoryBytes = std::size_t{160} << 20;
    CHECK(badCode(folder, "memory", limits) == "too-large");
    // The reader itself, of 100 MB of vertices.
    std::string large;
    for (int i = 0; i < 4000000; ++i) large += "v 0 0 0\n";
    ImportRequest request;
    request.path = folder.write("large.obj", large);
    const auto answer = importFile(request, {}, limits);
    REQUIRE(!answer);
    CHECK(answer.error().code == "too-large");
#endif
}

TEST_CASE("import: cancelling answers at once, and the next import is made by another worker") {
    const TestFolder folder;
    std::stop_source stop;
    // Once the worker is there.
    const auto started = [] {
        siginfo_t child{};
        return ::waitid(P_ALL, 0, &child, WEXITED | WNOHANG | WNOWAIT) == 0;
    };
    setWorkerProgram({});
    REQUIRE_FALSE(started());
    std::jthread later([&] {
        while (!started()) std::this_thread::yield();
        stop.request_stop();
    });
    // Without cancelling this would take 1000 s.
    const auto answer = badWorker(folder, "hang", Progress({}, stop.get_token()));
    REQUIRE(!answer);
    CHECK(answer.error().code == kCancelled);
    CHECK_FALSE(started());
    CHECK(io_test::import(folder.write("ball.obj", io_test::objOf(shapes::sphere(1.0, 1).mesh))));
}

TEST_CASE("import: what is no readable mesh file is refused before any worker is asked") {
    const TestFolder folder;
    const io_test::WithWorker none("/nonexistent/worker");
    const auto code = [](const std::filesystem::path& path) {
        ImportRequest request;
        request.path = path;
        const auto answer = importFile(request, {});
        return answer ? std::string() : answer.error().code;
    };
    CHECK(code(folder.path() / "none.obj") == "file-not-found");
    CHECK(code(folder.path()) == "not-readable");
    CHECK(code(folder.write("a.xyz", "1 2 3")) == "unknown-format");
    CHECK(code(folder.write("noending", "1 2 3")) == "unknown-format");
    const auto large = folder.write("a.obj", "v 0 0 0\nv 1 0 0\n");
    std::filesystem::resize_file(large, (std::uintmax_t{1} << 30) + 1);  // a hole: it takes no room
    CHECK(code(large) == "too-large");
    CHECK(code(folder.write("b.obj", "v 0 0 0\n")) == "worker-failed");  // the program does not exist
}

TEST_CASE("import: a file whose name is no UTF-8 is read like others") {
    const TestFolder folder;
    const auto answer = io_test::import(folder.write("caf\xe9.obj", io_test::objOf(shapes::sphere(1.0, 1).mesh)));
    REQUIRE(answer);
    CHECK(answer->bodies[0].name == "café");
}

TEST_CASE("import without a step that broke down: the file comes in, and the issue says what was left out") {
    const TestFolder folder;
    TriangleMesh box = shapes::box({0, 0, 0}, {1, 1, 1}, 2, 2, 2).mesh;
    box.triangles.conservativeResize(box.triangles.rows() - 1, 3);
    const auto without = [&](const std::vector<std::string>& steps) {
        return withoutSteps<ImportResult>(steps, "import-file", ImportRequest{folder.write("open.obj", io_test::objOf(box))});
    };
    const auto whole = without({});
    REQUIRE(whole);
    CHECK(whole->bodies[0].closed);
    CHECK_FALSE(io_test::find(*whole, "left-out"));
    const auto open = without({"caps over holes (1)", "looking for triangles that cross each other (1)"});
    REQUIRE(open);
    CHECK_FALSE(open->bodies[0].closed);
    REQUIRE(io_test::find(*open, "left-out"));
    CHECK(io_test::find(*open, "left-out")->count == 2);
}

TEST_CASE("import tells its progress, from 0 to 1 and never backwards") {
    const TestFolder folder;
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
