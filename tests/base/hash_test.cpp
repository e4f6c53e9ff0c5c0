// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include "core/base/hash.h"

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
