// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/project/response_store.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <thread>

#include "core/project/response_folder.h"
#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

ContentKey key(std::uint64_t n) { return {n, n}; }

/// A response of about `columns` times 24 kB.
std::shared_ptr<const ElementResponse> made(int columns) {
    auto response = std::make_shared<ElementResponse>();
    response->response = Eigen::MatrixXd::Constant(3000, columns, 1.0);
    return response;
}

/// The true response of a bar with two joint faces.
struct Solved {
    ResponseInput input;
    ContentKey key;
    std::shared_ptr<const ElementResponse> response;
    [[nodiscard]] std::shared_ptr<const ElementResponse> in(ResponseStore& store) const { return store.find(key, input.mesh->body, input.faces); }
};
Solved solved(Workbench& w, const char* basis = "affine") {
    w.buildChain();
    w.good({{"do", "set"}, {"target", "character"}, {"property", "basis"}, {"value", basis}});
    w.good({{"do", "set"}, {"target", "A"}, {"property", "solver-mesh"}, {"value", "as-is"}});
    w.good({{"do", "enable"}, {"effect", "touch"}});
    w.good({{"do", "precompute"}, {"elements", {"A"}}});
    const PartId a = w.session.document().elementNamed("A")->id;
    const ResponseInput input = w.session.responseInput(a);
    return {input, responseKey(input), w.session.response(a)};
}

std::vector<std::filesystem::path> filesIn(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(folder, none)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

constexpr ResponseStore::Limits kRoom{};

}  // namespace

TEST_CASE("response store: beyond its bound what was used longest ago goes first") {
    const std::size_t one = made(10)->bytes();
    ResponseStore store({3 * one, 0});
    for (std::uint64_t n = 1; n <= 3; ++n) store.insert(key(n), made(10));
    CHECK(store.bytes() == 3 * one);
    CHECK(store.find(key(1)));  // used now
    store.insert(key(4), made(10));
    CHECK(store.count() == 3);
    CHECK(store.find(key(1)));
    CHECK(!store.find(key(2)));
    CHECK(store.find(key(3)));
    CHECK(store.find(key(4)));
}

TEST_CASE("response store: what somebody holds stays, even beyond the bound") {
    const std::size_t one = made(10)->bytes();
    ResponseStore store({2 * one, 0});
    std::vector<std::shared_ptr<const ElementResponse>> held;
    for (std::uint64_t n = 1; n <= 4; ++n) store.insert(key(n), held.emplace_back(made(10)));
    CHECK(store.bytes() == 4 * one);
    held.erase(held.begin());
    store.insert(key(5), held.emplace_back(made(10)));
    CHECK(!store.find(key(1)));
    for (std::uint64_t n = 2; n <= 5; ++n) CHECK(store.find(key(n)));
}

TEST_CASE("response store: the same key again replaces, and each insert is told") {
    ResponseStore store;
    const auto first = made(1), second = made(2);
    store.insert(key(1), first);
    const auto told = store.revision();
    store.insert(key(1), second);
    CHECK(store.revision() > told);
    CHECK(store.find(key(1)) == second);
    CHECK(store.count() == 1);
    CHECK(store.bytes() == second->bytes());
}

TEST_CASE("response store: what the live character uses is not evicted, and sessions share") {
    auto store = std::make_shared<ResponseStore>(ResponseStore::Limits{1, 0});  // room for nothing that is not held
    Workbench w(store);
    w.buildChain();
    w.good({{"do", "precompute"}});
    CHECK(store->count() == 2);
    for (const auto& [id, element] : w.session.document().elements) CHECK(w.session.responseState(id) == ResponseState::Fresh);
    Workbench other(store);
    other.buildChain();
    CHECK(other.good({{"do", "precompute"}})["elements"][0]["cached"] == true);
    CHECK(other.session.character()->input().elements[0].response == w.session.character()->input().elements[0].response);
    w.good({{"do", "new"}});
    other.good({{"do", "new"}});
    w.session.character();
    other.session.character();
    store->insert(key(1), made(1));
    CHECK(store->count() == 0);
}

TEST_CASE("response folder: what one process computed the next one finds, in every basis, fingers included") {
    for (const char* basis : {"affine", "modes:3", "full"}) {
        const TestFolder folder;
        Workbench w;
        const Solved s = solved(w, basis);
        REQUIRE(s.response);
        ResponseStore(kRoom, folder.path()).insertComputed(s.key, s.response);  // ends when it is written
        REQUIRE(filesIn(folder.path()).size() == 1);
        CHECK(filesIn(folder.path())[0].filename() == s.key.hex() + ".response");
        ResponseStore store(kRoom, folder.path());
        CHECK(store.count() == 0);
        const auto read = s.in(store);
        REQUIRE(read);
        CHECK(store.find(s.key) == read);  // in memory now
        CHECK(read->bases == s.response->bases);
        CHECK(read->freeVertices == s.response->freeVertices);
        CHECK(read->response == s.response->response);
        CHECK(read->stiffness == s.response->stiffness);
        CHECK(read->tractions == s.response->tractions);
        CHECK(read->touch.displacement == s.response->touch.displacement);
        CHECK(read->touch.columns() > 0);
    }
}

TEST_CASE("response folder: projects share it, and a session that finds its response there computes nothing and owes no saving") {
    const TestFolder folder;
    {
        Workbench w(std::make_shared<ResponseStore>(kRoom, folder.path()));
        w.buildChain();
        w.good({{"do", "precompute"}});
    }
    CHECK(filesIn(folder.path()).size() == 1);  // B has the shape of A: its response is carried over, which is quicker than to read it
    Workbench w(std::make_shared<ResponseStore>(kRoom, folder.path()));
    w.buildChain();
    const PartId a = w.session.document().elementNamed("A")->id;
    CHECK(w.session.responseState(a) == ResponseState::Fresh);
    CHECK(w.session.character()->input().elements[0].response);
    CHECK(w.good({{"do", "precompute"}})["elements"][0]["cached"] == true);
    w.good({{"do", "save"}, {"path", folder.file("p.imomushi")}});
    CHECK(!w.session.modified());
}

TEST_CASE("response folder: a damaged file and one of another key are absent and removed; other files are left alone") {
    const TestFolder folder;
    Workbench w;
    const Solved s = solved(w);
    ResponseStore(kRoom, folder.path()).insertComputed(s.key, s.response);
    const auto file = filesIn(folder.path()).at(0);
    const std::string good = readFile(file);
    const auto name = [&](const ContentKey& k) { return k.hex() + ".response"; };
    folder.write(name(key(7)), good);          // says another key
    folder.write(name(key(8)), "nonsense");
    folder.write("notes.txt", "mine");
    std::string damaged = good;
    damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 1);
    folder.write(name(s.key), damaged);
    {
        ResponseStore store(kRoom, folder.path());
        CHECK(!s.in(store));
        CHECK(!store.find(key(7), s.input.mesh->body, s.input.faces));
        CHECK(!store.find(key(8), s.input.mesh->body, s.input.faces));
        CHECK(filesIn(folder.path()) == std::vector{folder / "notes.txt"});
        store.insertComputed(s.key, s.response);  // takes its place again
    }
    CHECK(readFile(file) == good);
}

TEST_CASE("response folder: what cannot be read now is absent and stays") {
    const TestFolder folder;
    Workbench w;
    const Solved s = solved(w);
    ResponseStore(kRoom, folder.path()).insertComputed(s.key, s.response);
    const auto file = filesIn(folder.path()).at(0);
    ResponseStore store(kRoom, folder.path());
    const std::string good = readFile(file);
    std::filesystem::remove(file);
    std::filesystem::create_directory(file);  // it opens, and reading it fails
    CHECK(!s.in(store));
    CHECK(std::filesystem::is_directory(file));
    std::filesystem::remove(file);
    folder.write(file.filename().string(), good);
    CHECK(s.in(store));
}

TEST_CASE("response folder: beyond its bound the files that were used longest ago go") {
    const TestFolder folder;
    Workbench w;
    const Solved s = solved(w);
    ResponseStore(kRoom, folder.path()).insertComputed(s.key, s.response);
    const auto file = filesIn(folder.path()).at(0);
    const std::uintmax_t size = std::filesystem::file_size(file);
    const auto now = std::filesystem::file_time_type::clock::now();
    const auto copy = [&](std::uint64_t n, int hoursAgo) {
        const auto to = folder / (key(n).hex() + ".response");
        std::filesystem::copy_file(file, to);
        std::filesystem::last_write_time(to, now - std::chrono::hours(hoursAgo));
        return to;
    };
    const auto old = copy(1, 3), older = copy(2, 4);
    std::filesystem::last_write_time(file, now - std::chrono::hours(5));
    {
        ResponseStore store({kRoom.memory, 3 * size}, folder.path());
        CHECK(s.in(store));  // used now
    }
    CHECK(std::filesystem::file_size(file) == size);
    ResponseStore({kRoom.memory, 2 * size}, folder.path());
    CHECK(std::filesystem::exists(file));
    CHECK(std::filesystem::exists(old));
    CHECK(!std::filesystem::exists(older));
    ResponseStore({kRoom.memory, size - 1}, folder.path());
    CHECK(filesIn(folder.path()).empty());
}

TEST_CASE("response store: while a file is read other keys are answered, and who asks for the same key gets what is read once") {
    const TestFolder folder;
    Workbench w, v;
    const Solved slow = solved(w), other = solved(v, "modes:3");
    {
        ResponseStore written(kRoom, folder.path());
        written.insertComputed(slow.key, slow.response);
        written.insertComputed(other.key, other.response);
    }
    ResponseStore store(kRoom, folder.path());
    // A pipe in place of the file: reading it begins when this end is opened, and ends when it is closed.
    const std::string file = folder.file(slow.key.hex() + ".response"), content = readFile(file);
    std::filesystem::remove(file);
    REQUIRE(::mkfifo(file.c_str(), 0600) == 0);
    std::shared_ptr<const ElementResponse> first, second;
    std::thread reader([&] { first = slow.in(store); });
    const int pipe = ::open(file.c_str(), O_WRONLY);
    REQUIRE(pipe >= 0);
    // It is being read now.
    CHECK(store.has(slow.key));
    CHECK(store.has(other.key));
    CHECK(!store.find(slow.key));
    CHECK(other.in(store));
    store.insert(key(1), made(1));
    CHECK(store.find(key(1)));
    CHECK(store.count() == 2);
    std::thread waiting([&] { second = slow.in(store); });  // would find a part of what is written here, or nothing
    for (std::size_t at = 0; at < content.size();) {
        const ssize_t n = ::write(pipe, content.data() + at, content.size() - at);
        REQUIRE(n > 0);
        at += static_cast<std::size_t>(n);
    }
    ::close(pipe);
    reader.join();
    waiting.join();
    REQUIRE(first);
    CHECK(first->response == slow.response->response);
    CHECK(first == second);
    CHECK(store.count() == 3);
}

TEST_CASE("response folder: one that cannot be written is none") {
    const TestFolder folder;
    folder.write("file", "");
    Workbench w(std::make_shared<ResponseStore>(kRoom, folder / "file"));
    w.buildChain();
    w.good({{"do", "precompute"}});
    CHECK(w.session.responseState(w.session.document().elementNamed("A")->id) == ResponseState::Fresh);
}

TEST_CASE("unsaved: responses that were computed and are in no project file count until they are") {
    Workbench w;
    const std::string path = (Workbench::folder() / "computed.imomushi").string();
    w.buildChain();
    w.good({{"do", "save"}, {"path", path}});
    CHECK(!w.session.modified());
    w.good({{"do", "precompute"}});
    CHECK(w.session.modified());
    w.good({{"do", "save"}, {"path", (Workbench::folder() / "copy.imomushi").string()}, {"copy", true}});
    CHECK(w.session.modified());
    w.good({{"do", "save"}});
    CHECK(!w.session.modified());
    w.good({{"do", "precompute"}});  // known
    CHECK(!w.session.modified());
    w.good({{"do", "open"}, {"path", path}});
    CHECK(!w.session.modified());
    w.good({{"do", "precompute"}});
    CHECK(!w.session.modified());
}
