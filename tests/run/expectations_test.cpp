// SPDX-License-Identifier: GPL-3.0-or-later
// tests/expectations.md says which test holds what artists expect: those tests exist, and no row is without one.
#include <doctest/doctest.h>

#include <regex>
#include <set>
#include <string_view>

#include "tests/run/program.h"

using namespace imomushi;
namespace fs = std::filesystem;

TEST_CASE("expectations: each of the 25 rows names tests that exist") {
    const fs::path tests = fs::path(IMOMUSHI_SOURCE_DIR) / "tests";
    std::set<std::string> names;
    const std::string_view begins = "TEST_CASE(\"", ends = "\") {";  // what is skipped unless asked for has more before the brace
    const std::regex quoted("`([^`]+)`"), row(R"re(^\| (\d+) \|[^|]*\|([^|]*)\|[^|]*\|$)re");
    for (const auto& file : fs::recursive_directory_iterator(tests)) {
        if (file.path().extension() != ".cpp") continue;
        const std::string text = readFile(file.path());
        for (std::size_t at = text.find(begins); at != std::string::npos; at = text.find(begins, at)) {
            at += begins.size();
            const std::size_t quote = text.find('"', at);
            if (quote != std::string::npos && text.compare(quote, ends.size(), ends) == 0) names.insert(text.substr(at, quote - at));
        }
    }
    REQUIRE(names.size() > 500);
    int rows = 0;
    std::istringstream page(readFile(tests / "expectations.md"));
    for (std::string line; std::getline(page, line);) {
        std::smatch found;
        if (!std::regex_match(line, found, row)) continue;
        CHECK(std::stoi(found[1]) == ++rows);
        const std::string held = found[2];
        int named = 0;
        for (std::sregex_iterator at(held.begin(), held.end(), quoted), end; at != end; ++at, ++named) CHECK_MESSAGE(names.contains((*at)[1]), (*at)[1].str());
        CHECK_MESSAGE(named > 0, line);
    }
    CHECK(rows == 25);
}
