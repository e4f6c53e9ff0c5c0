// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <chrono>

#include "core/comparison/timing.h"

using namespace imomushi;

namespace {

void spin(double ms) {
    const auto begin = std::chrono::steady_clock::now();
    while (std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count() < ms) {}
}

}  // namespace

TEST_CASE("What disturbs a machine most of the time is not in the quiet figures, but in those of all the time") {
    // Of 100 frames of each loop 70 are ten times slower.
    constexpr double kQuick = 0.05, kSlow = 0.5;
    int frames = 0;
    const auto ms = [&] { return frames / 2 % 100 < 30 ? kQuick : kSlow; };
    const auto reference = [&] { spin(ms()); };
    const auto loop = [&] {
        spin(2.0 * ms());
        ++frames;
    };
    const auto quiet = quietSpreads(0.6, {reference, loop});
    CHECK(quiet[0].median >= kQuick);
    CHECK(quiet[1].median >= 2.0 * kQuick);
    CHECK(quiet[1].median < 2.0 * kSlow);
    const auto all = spreadsInTurn(400, 0.6, {reference, loop});
    CHECK(all[1].median >= 2.0 * kSlow);
}

TEST_CASE("Nobody waits for figures that nobody wants") {
    std::stop_source stop;
    stop.request_stop();
    const auto none = quietSpreads(1e6, {[] {}, [] {}}, Progress({}, stop.get_token()));
    REQUIRE(none.size() == 2);
    CHECK(none[0].median == 0.0);
}
