// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/base/base64.h"

#include <doctest/doctest.h>

using namespace imomushi;

TEST_CASE("base64: the examples of RFC 4648, and bytes of all values come back") {
    for (const auto& [plain, text] : {std::pair{"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}, {"fooba", "Zm9vYmE="}, {"foobar", "Zm9vYmFy"}}) {
        CHECK(toBase64(plain) == text);
        CHECK(fromBase64(text) == plain);
    }
    std::string all;
    for (int i = 0; i < 256; ++i) all += static_cast<char>(i);
    CHECK(fromBase64(toBase64(all)) == all);
    CHECK(!fromBase64("Zm9?"));
}
