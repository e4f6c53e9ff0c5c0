// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <thread>
#include <vector>

#include "core/base/triple_buffer.h"

using namespace imomushi;

TEST_CASE("triple buffer: the reader sees the latest value, once, and keeps it while others are written") {
    TripleBuffer<int> buffer;
    CHECK(!buffer.take());
    for (const int value : {1, 2, 3}) {
        buffer.back() = value;
        buffer.publish();
    }
    REQUIRE(buffer.take());
    CHECK(buffer.front() == 3);
    CHECK(!buffer.take());
    for (const int value : {4, 5}) {
        buffer.back() = value;
        buffer.publish();
        CHECK(buffer.front() == 3);
    }
    REQUIRE(buffer.take());
    CHECK(buffer.front() == 5);
}

TEST_CASE("triple buffer: values that one thread writes arrive whole on another one, in order, the last one always") {
    constexpr int kValues = 200'000;
    TripleBuffer<std::vector<int>> buffer;
    for (auto& slot : buffer.allSlots()) slot.assign(64, 0);
    std::thread writer([&] {
        for (int value = 1; value <= kValues; ++value) {
            for (int& number : buffer.back()) number = value;
            buffer.publish();
        }
    });
    int last = 0;
    bool whole = true, ordered = true;
    while (last < kValues) {
        if (!buffer.take()) continue;
        const auto& now = buffer.front();
        for (const int number : now) whole = whole && number == now[0];
        ordered = ordered && now[0] > last;
        last = now[0];
    }
    writer.join();
    CHECK(whole);
    CHECK(ordered);
}
