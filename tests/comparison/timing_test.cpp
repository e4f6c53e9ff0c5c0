// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/comparison/timing.h"

#include <doctest/doctest.h>

#include <stop_token>

using namespace imomushi;

TEST_CASE("What disturbs a machine most of the time is not in the quiet figures, a slow frame of a quiet stretch is") {
    // Of 60 frames of each loop the last 45 are ten times slower.
    std::vector<std::vector<double>> times(2);
    for (int frame = 0; frame < 3000; ++frame) {
        const double ms = frame % 60 < 15 ? 0.05 : 0.5;
        times[0].push_back(ms);
        times[1].push_back(frame % 1500 == 3 ? 7.0 : 2.0 * ms);
    }
    const auto quiet = quietOf(times);
    REQUIRE(quiet.size() == 2);
    CHECK(quiet[0].median == 0.05);
    CHECK(quiet[0].p99 == 0.05);
    CHECK(quiet[1].median == 0.1);
    CHECK(quiet[1].p99 < 7.0);
    // One frame in a hundred and more counts.
    for (std::size_t frame = 3; frame < times[1].size(); frame += 60) times[1][frame] = 7.0;
    CHECK(quietOf(times)[1].median == 0.1);
    CHECK(quietOf(times)[1].p99 == 7.0);
}

TEST_CASE("Nobody waits for figures that nobody wants") {
    std::stop_source stop;
    stop.request_stop();
    const auto none = quietSpreads(1e6, {[] {}, [] {}}, Progress({}, stop.get_token()));
    REQUIRE(none.size() == 2);
    CHECK(none[0].median == 0.0);
}
