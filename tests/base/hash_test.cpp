// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include "core/base/hash.h"
#include "core/base/parallel.h"

#include <numeric>
#include <vector>

using namespace imomushi;

TEST_CASE("content key: equal content gives equal keys, the border between fields counts") {
    ContentHasher a, b, c;
    a.text("ab"), a.text("c");
    b.text("ab"), b.text("c");
    c.text("a"), c.text("bc");
    CHECK(a.key() == b.key());
    CHECK(a.key() != c.key());
}

TEST_CASE("content key: stays the same over versions (it is stored in project files)") {
    ContentHasher h;
    h.text("imomushi");
    h.number(0.45);
    CHECK(h.key().hex() == "2350a806f1135b680f8e4b7f61af6d6e");
}

TEST_CASE("parallel for: every item is done once, by the same chunks for any number of threads") {
    for (int threads : {1, 2, 7}) {
        std::vector<int> done(1001, 0);
        parallelFor(threads, done.size(), 64, [&](std::size_t begin, std::size_t end) {
            CHECK(begin % 64 == 0);
            for (std::size_t i = begin; i < end; ++i) ++done[i];
        });
        CHECK(std::accumulate(done.begin(), done.end(), 0) == 1001);
        CHECK(*std::max_element(done.begin(), done.end()) == 1);
    }
}
