// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/base/kept_with.h"

#include <doctest/doctest.h>

#include <atomic>
#include <thread>
#include <vector>

using namespace imomushi;

TEST_CASE("what is kept with an object is made once, whoever asks, and again for another object, also where that lies at the same place") {
    KeptWith<int, std::vector<int>> all;
    std::atomic<int> made = 0;
    const auto of = [&](const std::shared_ptr<const int>& object) {
        return all.of(object, [&] {
            ++made;
            return std::vector<int>{*object};
        });
    };
    const auto object = std::make_shared<const int>(7);
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i) threads.emplace_back([&] { CHECK(of(object)->front() == 7); });
    for (std::thread& thread : threads) thread.join();
    CHECK(made == 1);
    CHECK(of(object) == of(object));
    for (int i = 0; i < 50; ++i) {
        const auto other = std::make_shared<const int>(i);
        const auto kept = of(other);
        CHECK(kept->front() == i);
    }
    CHECK(made == 51);
    // It outlives the object for whoever has it.
    auto gone = std::make_shared<const int>(3);
    const auto kept = of(gone);
    gone.reset();
    CHECK(of(object)->front() == 7);
    CHECK(kept->front() == 3);
}
