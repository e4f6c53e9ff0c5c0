// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <limits>
#include <set>

#include "core/mesh/bounds.h"
#include "core/project/packed_response.h"
#include "core/project/project_versions.h"
#include "tests/document/tamper.h"
#include "tests/document/workbench.h"
#include "tests/support/long_take.h"

// Saving where there is much to save, or little room for it.

using namespace imomushi;

namespace {

/// Of 18 columns, about `bytes` large. It belongs to no body.
std::shared_ptr<ElementResponse> responseOf(std::size_t bytes) {
    auto response = std::make_shared<ElementResponse>();
    response->firstColumn.push_back(0);
    for (int face = 0; face < 2; ++face) {
        response->bases.emplace_back();
        response->firstColumn.push_back(response->firstColumn.back() + response->bases.back().columns());
    }
    const auto vertices = static_cast<std::int32_t>(bytes / (3 * sizeof(double) * static_cast<std::size_t>(response->columns())));
    for (std::int32_t v = 0; v < vertices; ++v) response->freeVertices.push_back(v);
    response->response.setRandom(3 * vertices, response->columns());
    response->stiffness.setIdentity(response->columns(), response->columns());
    return response;
}

Project projectOf(std::size_t bytes, std::size_t each) {
    Workbench w;
    w.good({{"do", "import-element"}, {"path", "bar0"}, {"name", "A"}});
    Project project = w.session.project();
    const Element first = *project.document.elements.begin()->second;
    for (std::size_t n = 0; n * each < bytes; ++n) {
        auto element = std::make_shared<Element>(first);
        if (n > 0) element->id = project.document.nextId++;
        element->name = "e" + std::to_string(n);
        project.document.elements[element->id] = element;
        project.responses[element->id] = {{1, n}, {2, n}, responseOf(each)};
    }
    return project;
}

/// Of /proc/self/status, in bytes.
std::size_t memory(const std::string& field) {
    std::ifstream status("/proc/self/status");
    for (std::string name, line; status >> name && std::getline(status, line);)
        if (name == field + ":") return std::strtoull(line.c_str(), nullptr, 10) * 1024;
    return 0;
}

std::set<std::string> namesIn(const std::filesystem::path& folder) {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) names.insert(entry.path().filename().string());
    return names;
}

/// No file of this process may grow beyond `bytes`, as on a disk that is full.
class FullDisk {
public:
    explicit FullDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        REQUIRE(::getrlimit(RLIMIT_FSIZE, &before_) == 0);
        const rlimit now{bytes, before_.rlim_max};
        REQUIRE(::setrlimit(RLIMIT_FSIZE, &now) == 0);
    }
    ~FullDisk() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }

private:
    rlimit before_{};
    void (*handler_)(int);
};

}  // namespace

TEST_CASE("saving: an array that is divided comes back bit by bit, and its parts are checked like everything") {
    const Project project = projectOf(1, 3 * kPartBytes / 2);
    const PartId id = project.responses.begin()->first;
    const ElementResponse& response = *project.responses.at(id).response;
    const TestFolder folder;
    const auto path = folder / "divided.imomushi", bad = folder / "bad.imomushi";
    REQUIRE(saveProject(path, project));
    const auto opened = openProject(path);
    REQUIRE(opened);
    CHECK(opened->responses.at(id).response->response == response.response);
    CHECK(opened->responses.at(id).response->freeVertices == response.freeVertices);
    REQUIRE(saveProject(folder / "again.imomushi", *opened));
    CHECK(readFile(folder / "again.imomushi") == readFile(path));
    {
        const std::string bytes = readFile(path);
        Database db(std::as_bytes(std::span(bytes)));
        CHECK(db.number("SELECT count(*) FROM value_parts") == 2);
    }
    for (const char* statement : {"DELETE FROM value_parts", "DELETE FROM value_parts WHERE position=0", "UPDATE value_parts SET position=7 WHERE position=1", "UPDATE value_parts SET total=total-8", "UPDATE value_parts SET total=total+8", "UPDATE value_parts SET total=1<<40",
                                  "UPDATE value_parts SET total=8 WHERE position=1", "UPDATE value_parts SET bytes=zeroblob(7)",
                                  "UPDATE value_parts SET bytes='text'", "UPDATE value_parts SET bytes=1e30", "UPDATE value_parts SET bytes=NULL WHERE position=1", "UPDATE responses SET response=2",
                                  "UPDATE responses SET response=-1"}) {
        CAPTURE(statement);
        std::filesystem::copy_file(path, bad, std::filesystem::copy_options::overwrite_existing);
        sql(bad, statement);
        for (const bool whole : {false, true}) {
            if (whole) sign(bad);
            const auto read = openProject(bad);
            REQUIRE(!read);
            CHECK(read.error().code == "damaged");
        }
    }
    const auto packed = packResponse(response);
    REQUIRE(packed);
    TriangleMesh body;
    body.vertices.setZero(static_cast<Eigen::Index>(response.freeVertices.size()), 3);
    const std::vector<JointFace> faces(2);
    const auto back = unpackResponse(*packed, body, faces);
    REQUIRE(back);
    CHECK(back->response == response.response);
}

#ifndef __SANITIZE_ADDRESS__  // keeps what was freed
TEST_CASE("saving: needs memory for its largest response, not for the project") {
    constexpr std::size_t kBytes = std::size_t{256} << 20;
    const TestFolder folder;
    const Project project = projectOf(kBytes, kBytes / 4);
    std::ofstream("/proc/self/clear_refs") << "5";  // the highest so far begins anew
    const std::size_t before = memory("VmRSS");
    REQUIRE(saveProject(folder / "large.imomushi", project));
    CHECK(std::filesystem::file_size(folder / "large.imomushi") > kBytes);
    // A few parts, and one response twice while it is checked.
    CHECK(memory("VmHWM") - before < 2 * (kBytes / 4) + 4 * kPartBytes);
}

TEST_CASE("saving: needs memory for a few blocks of a take, not for all of it, and so does keeping a version") {
    const TestFolder folder;
    const auto path = folder / "take.imomushi";
    Project project = projectOf(1, 1000);
    const auto take = longTake(5, 100'000);
    take->id = project.document.nextId++;
    project.document.takes[take->id] = take;
    const std::size_t bytes = take->bytes();
    REQUIRE(bytes > 8 * kPartBytes);
    for (const char* way : {"new", "over another"}) {
        CAPTURE(way);
        std::ofstream("/proc/self/clear_refs") << "5";
        const std::size_t before = memory("VmRSS");
        REQUIRE(storeProject(path, project, {}));
        CHECK(memory("VmHWM") - before < 3 * kPartBytes);
    }
    std::ofstream("/proc/self/clear_refs") << "5";
    const std::size_t before = memory("VmRSS");
    const auto opened = openProject(path);
    REQUIRE(opened);
    CHECK(memory("VmHWM") - before < bytes + 3 * kPartBytes);
    const Take& read = *opened->document.takes.begin()->second;
    CHECK(read.times == take->times);
    CHECK(read.shapes == take->shapes);
    REQUIRE(saveProject(folder / "again.imomushi", *opened));
    CHECK(readFile(folder / "again.imomushi") == readFile(path));
}
#endif

TEST_CASE("saving: where the disk is full it says so, the old file stays whole and nothing is left beside it") {
    Workbench w;
    w.buildChain();
    const TestFolder folder;
    const auto path = folder / "虫.imomushi";
    w.good({{"do", "save"}, {"path", path.string()}});
    const std::string old = readFile(path);
    w.good({{"do", "rename"}, {"target", "A"}, {"name", "changed"}});
    for (const rlim_t room : {rlim_t{0}, rlim_t{4096}, rlim_t{old.size() / 2}}) {
        const FullDisk disk(room);
        CHECK(w.code({{"do", "save"}}) == "disk-full");
        CHECK(w.session.modified());
    }
    CHECK(readFile(path) == old);
    auto left = namesIn(folder.path());
    left.erase("虫.imomushi-versions");  // begun, with no version in it
    CHECK(left == std::set<std::string>{"虫.imomushi"});
    w.good({{"do", "save"}});
    CHECK(!w.session.modified());
}

TEST_CASE("saving: what would not open again is refused by the name of its part, and the old file stays") {
    const TestFolder folder;
    const auto path = folder / "a.imomushi";
    Project project = projectOf(1, 1000);
    REQUIRE(saveProject(path, project));
    const std::string old = readFile(path);
    const auto refused = [&](const Project& broken, const std::string& part, const std::string& why) {
        const auto saved = saveProject(path, broken);
        REQUIRE(!saved);
        CHECK(saved.error().code == "not-sound");
        CAPTURE(saved.error().message);
        CHECK(saved.error().message.find(part + ": " + why) != std::string::npos);
        CHECK(readFile(path) == old);
        CHECK(namesIn(folder.path()) == std::set<std::string>{"a.imomushi"});
    };
    auto& element = project.document.elements.begin()->second;
    {
        Project far = project;
        auto changed = std::make_shared<Element>(*element);
        auto mesh = std::make_shared<ElementMesh>(*element->mesh);
        mesh->body.vertices(3, 1) = 2.0 * kMaxCoordinate;
        changed->mesh = mesh;
        far.document.elements.begin()->second = changed;
        refused(far, "element \"e0\"", "a vertex is out of range");
    }
    {
        Project thin = project;
        auto changed = std::make_shared<Element>(*element);
        changed->nu = 0.7;
        thin.document.elements.begin()->second = changed;
        refused(thin, "element \"e0\"", "a number is out of range");
    }
    {
        Project infinite = project;
        auto response = std::make_shared<ElementResponse>(*project.responses.begin()->second.response);
        response->response(2, 2) = std::numeric_limits<double>::infinity();
        infinite.responses.begin()->second.response = response;
        refused(infinite, "the response of element \"e0\"", "a response is not finite");
    }
}

TEST_CASE("saving: a skeleton that cannot be built is refused, and the file with its responses stays") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    Project project = w.session.project();
    const TestFolder folder;
    const auto path = folder / "a.imomushi";
    REQUIRE(saveProject(path, project));
    auto& bone = project.document.bones.begin()->second;
    auto changed = std::make_shared<Bone>(*bone);
    // Both ends are at the one point of a joint: it has no length.
    changed->start = FaceRef{project.document.elements.begin()->first, "out"};
    changed->end = FaceRef{std::next(project.document.elements.begin())->first, "in"};
    bone = changed;
    const auto saved = saveProject(path, project);
    REQUIRE(!saved);
    CHECK(saved.error().code == "not-sound");
    CHECK(openProject(path).value().responses.size() == project.responses.size());
}

TEST_CASE("saving: what the system refuses is no damage") {
    Workbench w;
    w.buildChain();
    const TestFolder folder;
    const auto path = folder / "a.imomushi";
    w.good({{"do", "save"}, {"path", path.string()}});
    const int file = ::open(path.c_str(), O_WRONLY);  // reading it fails
    REQUIRE(file >= 0);
    try {
        Database db(file, Database::Access::Read);
        (void)db.number("PRAGMA user_version");
        CHECK(false);
    } catch (const DatabaseError& error) {
        CHECK(error.kind == DatabaseError::Kind::Refused);
        CHECK(!error.damaged());
    }
    ::close(file);
    sqlite3* other = nullptr;  // somebody writes
    REQUIRE(sqlite3_open(path.c_str(), &other) == SQLITE_OK);
    REQUIRE(sqlite3_exec(other, "BEGIN EXCLUSIVE", nullptr, nullptr, nullptr) == SQLITE_OK);
    try {
        (void)Database(path, false).number("SELECT count(*) FROM elements");
        CHECK(false);
    } catch (const DatabaseError& error) {
        CHECK(error.kind == DatabaseError::Kind::Busy);
    }
    sqlite3_close(other);
}

TEST_CASE("saving: a folder whose path is long is no obstacle") {
    Workbench w;
    w.buildChain();
    const TestFolder folder;
    std::filesystem::path deep = folder.path();
    for (int i = 0; i < 10; ++i) deep /= std::string(100, 'd');
    std::filesystem::create_directories(deep);
    const std::string path = (deep / "a#b?c%20.imomushi").string();
    w.good({{"do", "save"}, {"path", path}});
    Workbench().good({{"do", "open"}, {"path", path}});
}
