// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/project/project_versions.h"

#include "tests/document/tamper.h"
#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

/// A chain with responses, saved in `path` each time its first element gets another name: v0, v1, ...
void saveOften(Workbench& w, const std::filesystem::path& path, int times) {
    w.buildChain();
    w.good({{"do", "precompute"}});
    std::string name = "A";
    for (int i = 0; i < times; ++i) {
        const std::string next = "v" + std::to_string(i);
        w.good({{"do", "rename"}, {"target", name}, {"name", next}});
        name = next;
        const Json answer = w.good({{"do", "save"}, {"path", path.string()}});
        CAPTURE(answer.dump());
        CHECK(!answer.contains("not-kept"));
        CHECK(answer.value("versions", 0) == (i == 0 ? 0 : std::min(i + 1, 10)));
    }
}

/// Parts of arrays: each version has one more, of what is not in parts.
std::int64_t partsIn(const std::filesystem::path& project) {
    const std::string bytes = readFile(versionsFile(project));
    return Database(std::as_bytes(std::span(bytes))).number("SELECT (SELECT count(*) FROM parts) - (SELECT count(*) FROM versions)");
}

}  // namespace

TEST_CASE("versions: the last ten saves open as they were, and share their responses") {
    const TestFolder folder;
    const auto path = folder / "虫.imomushi";
    Workbench w;
    saveOften(w, path, 13);
    const Json versions = w.good({{"do", "versions"}})["versions"];
    REQUIRE(versions.size() == 10);
    for (int i = 0; i < 10; ++i) {
        Workbench other;
        other.good({{"do", "open"}, {"path", path.string()}, {"version", versions[static_cast<std::size_t>(i)]["version"]}});
        CHECK(other.session.document().elementNamed("v" + std::to_string(12 - i)));
        CHECK(other.session.modified());
        CHECK(other.session.path().empty());
        for (const auto& [id, element] : other.session.document().elements) CHECK(other.session.response(id)->response == w.session.response(id)->response);
    }
    // Names alone changed: ten versions have the arrays that two have.
    Workbench few;
    saveOften(few, folder / "few.imomushi", 2);
    CHECK(partsIn(path) > 0);
    CHECK(partsIn(path) == partsIn(folder / "few.imomushi"));
    CHECK(Workbench().code({{"do", "open"}, {"path", path.string()}, {"version", 1}}) == "no-version");
    const Json again = w.good({{"do", "save"}});
    CHECK(w.good({{"do", "versions"}})["versions"] == versions);  // nothing was changed
    CHECK(Workbench().code({{"do", "versions"}}) == "missing-key");
}

TEST_CASE("versions: what another program wrote there is kept before it is replaced") {
    const TestFolder folder;
    const auto path = folder / "a.imomushi";
    Workbench one, two;
    saveOften(one, path, 1);
    two.good({{"do", "open"}, {"path", path.string()}});
    two.good({{"do", "rename"}, {"target", "v0"}, {"name", "theirs"}});
    two.session.setVersionLimits({10, 0});
    two.good({{"do", "save"}});
    CHECK(!std::filesystem::exists(versionsFile(path)));
    one.good({{"do", "rename"}, {"target", "v0"}, {"name", "mine"}});
    one.good({{"do", "save"}});
    const auto versions = projectVersions(path);
    REQUIRE(versions);
    REQUIRE(versions->size() == 2);
    CHECK(openVersion(path, versions->at(0).number).value().document.elementNamed("mine"));
    CHECK(openVersion(path, versions->at(1).number).value().document.elementNamed("theirs"));
}

TEST_CASE("versions: they stay within their space, and where they cannot be kept the project is saved all the same") {
    const TestFolder folder;
    const auto path = folder / "a.imomushi";
    Workbench w;
    saveOften(w, path, 4);
    const auto bytes = std::filesystem::file_size(versionsFile(path));
    w.session.setVersionLimits({2, bytes});
    w.good({{"do", "rename"}, {"target", "v3"}, {"name", "v4"}});
    CHECK(w.good({{"do", "save"}})["versions"] == 2);
    CHECK(std::filesystem::file_size(versionsFile(path)) <= bytes);
    const auto refuse = [&](const std::string& from, const std::string& to) {
        w.good({{"do", "rename"}, {"target", from}, {"name", to}});
        const Json answer = w.good({{"do", "save"}});
        CHECK(answer.contains("not-kept"));
        CHECK(openProject(path).value().document.elementNamed(to));
    };
    w.session.setVersionLimits({10, 20'000});
    refuse("v4", "v5");
    CHECK(projectVersions(path).value().size() == 2);  // those that were there
    w.session.setVersionLimits({});
    Workbench::writeFile(versionsFile(path), "notes of somebody else");
    refuse("v5", "v6");
    CHECK(readFile(versionsFile(path)) == "notes of somebody else");
}

TEST_CASE("versions: a damaged file of versions is told, part by part") {
    const TestFolder folder;
    const auto path = folder / "a.imomushi";
    Workbench w;
    saveOften(w, path, 3);
    const auto file = versionsFile(path);
    const std::string whole = readFile(file);
    for (const char* statement : {"DELETE FROM parts", "UPDATE parts SET bytes=zeroblob(length(bytes))", "UPDATE parts SET bytes='text'", "UPDATE versions SET rest=zeroblob(9)",
                                  "UPDATE versions SET rest=substr(rest,1,8)", "UPDATE versions SET rest=x''", "DROP TABLE parts; CREATE VIEW parts AS SELECT 1 AS id, zeroblob(16) AS key, zeroblob(9) AS bytes", "UPDATE versions SET rest=7", "PRAGMA user_version=9", "PRAGMA application_id=5"}) {
        CAPTURE(statement);
        Workbench::writeFile(file, whole);
        sql(file, statement);
        const auto opened = openVersion(path, 2);
        REQUIRE(!opened);
        CHECK(opened.error().code == "no-version");
    }
}
