// SPDX-License-Identifier: GPL-3.0-or-later
// The manual and the pages beside it hold together: links, pictures, both languages. What they show as examples is run by examples_test.cpp.
#include <doctest/doctest.h>

#include <algorithm>
#include <cctype>
#include <regex>
#include <set>

#include "tests/run/program.h"

using namespace imomushi;
namespace fs = std::filesystem;

namespace {

const fs::path kRepository = IMOMUSHI_SOURCE_DIR;
const fs::path kManual = kRepository / "assets/manual";
constexpr std::uintmax_t kLargestPicture = 200'000;  // bytes: a page opens quickly on a forge

std::vector<fs::path> pagesOf(const char* language) {
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator(kManual / language)) found.push_back(entry.path());
    std::sort(found.begin(), found.end());
    return found;
}

/// Links and pictures of a page.
std::vector<std::string> linksIn(const std::string& text) {
    static const std::regex link("\\]\\(([^()\\s]+)\\)");
    std::vector<std::string> found;
    for (std::sregex_iterator m(text.begin(), text.end(), link), end; m != end; ++m) found.push_back((*m)[1]);
    return found;
}

/// How forges and the studio call a heading in links: lower case, without ASCII punctuation, hyphens for spaces.
std::string anchorOf(const std::string& heading) {
    std::string name;
    for (const char c : heading) {
        const auto u = static_cast<unsigned char>(c);
        if (c == ' ') name += '-';
        else if (u >= 0x80 || std::isalnum(u) || c == '-' || c == '_') name += static_cast<char>(std::tolower(u));
    }
    return name;
}

/// One character for each thing of a page that both languages have: headings with their depth, lists, rows of tables with their columns, pictures; and programs word for word.
std::string structureOf(const fs::path& page) {
    std::string shape;
    bool program = false;
    std::istringstream in(readFile(page));
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with("```")) {
            program = !program;
            shape += line + "\n";
        } else if (program) {
            shape += line + "\n";
        } else if (line.starts_with("#")) {
            shape += line.substr(0, line.find(' ')) + "\n";
        } else if (line.starts_with("|")) {
            std::string bare = std::regex_replace(line, std::regex("\\\\\\|"), "");
            shape += "|" + std::to_string(std::count(bare.begin(), bare.end(), '|')) + "\n";
        } else if (line.starts_with("![")) {
            shape += line.substr(line.find("](")) + "\n";
        } else if (line.starts_with("* ") || std::regex_search(line, std::regex("^[0-9]\\. "))) {
            shape += line.substr(0, 2) + "\n";
        }
    }
    return shape;
}

}  // namespace

TEST_CASE("manual: every page is there in both languages, with the same sections, tables, examples and pictures") {
    const auto english = pagesOf("en"), japanese = pagesOf("ja");
    REQUIRE(english.size() == japanese.size());
    CHECK(english.size() >= 12);
    for (std::size_t i = 0; i < english.size(); ++i) {
        CAPTURE(english[i].filename().string());
        REQUIRE(english[i].filename() == japanese[i].filename());
        CHECK(structureOf(english[i]) == structureOf(japanese[i]));
    }
}

TEST_CASE("manual: every link leads to a file that is there, and to a heading in it") {
    std::vector<fs::path> pages = {kRepository / "README.md", kRepository / "CONTRIBUTING.md", kRepository / "ARCHITECTURE.md"};
    for (const char* language : {"en", "ja"})
        for (const fs::path& page : pagesOf(language)) pages.push_back(page);
    std::set<std::string> reached;
    for (const fs::path& page : pages) {
        CAPTURE(page.string());
        const std::string text = readFile(page);
        CHECK(!text.empty());
        for (const std::string& link : linksIn(text)) {
            CAPTURE(link);
            if (link.starts_with("https://")) continue;  // not ours to keep alive
            const auto hash = link.find('#');
            const fs::path target = hash == 0 ? page : page.parent_path() / link.substr(0, hash);
            CHECK(fs::exists(target));
            reached.insert(fs::weakly_canonical(target).string());
            if (hash == std::string::npos) continue;
            bool found = false;
            std::istringstream in(readFile(target));
            for (std::string line; std::getline(in, line);)
                if (line.starts_with("#")) found = found || anchorOf(line.substr(line.find(' ') + 1)) == link.substr(hash + 1);
            CHECK(found);
        }
    }
    for (const fs::path& page : pages)
        if (page.filename() != "README.md") CHECK_MESSAGE(reached.contains(fs::weakly_canonical(page).string()), page.string());
    for (const auto& picture : fs::directory_iterator(kManual / "pictures")) {
        CAPTURE(picture.path().string());
        CHECK(reached.contains(fs::weakly_canonical(picture.path()).string()));
        CHECK(picture.file_size() < kLargestPicture);
    }
}

TEST_CASE("manual: its pages of all commands are what the program's help says, in Japanese, too") {
    const fs::path fresh = folder() / "manual";
    const auto shell = [&](const std::string& command) { return std::system((command + " 2>'" + (folder() / "stderr").string() + "'").c_str()); };
    const int status = shell("'" + (kRepository / "packaging/commands.sh").string() + "' '" IMOMUSHI_PROGRAM "' '" + fresh.string() + "'");
    // Where a text is new, it is in stderr: add a line to packaging/commands_ja.tsv, and run packaging/commands.sh.
    CHECK_MESSAGE(status == 0, readFile(folder() / "stderr"));
    for (const char* page : {"en/commands.md", "ja/commands.md"}) {
        CAPTURE(page);
        CHECK(readFile(fresh / page) == readFile(kManual / page));
    }
}

TEST_CASE("manual: README.md is read in five minutes") {
    std::istringstream words(readFile(kRepository / "README.md"));
    int count = 0;
    for (std::string word; words >> word;) ++count;
    CHECK(count <= 700);
}
