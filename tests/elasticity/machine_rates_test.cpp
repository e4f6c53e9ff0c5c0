// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/machine_rates.h"

#include <doctest/doctest.h>

using namespace imomushi;

TEST_CASE("machine rates: known at once, and they only become better") {
    MachineRates before = machineRates();
    CHECK(before.secondsPerPair > 0.0);
    CHECK(before.flops > 0.0);
    CHECK(before.bytesPerSecond > 0.0);
    for (int i = 0; i < 3; ++i) {
        const MachineRates now = machineRates();
        CHECK(now.secondsPerPair <= before.secondsPerPair);
        CHECK(now.flops >= before.flops);
        CHECK(now.bytesPerSecond >= before.bytesPerSecond);
        before = now;
    }
}
