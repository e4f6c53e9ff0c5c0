// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include "core/input/input_triggers.h"
#include "tests/support/allocations.h"
#include "tests/support/input_values.h"

using namespace imomushi;

namespace {

InputRow triggerRow(const std::string& channel, bool muted = false) {
    InputRow row;
    row.source = "pad";
    row.channel = channel;
    row.muted = muted;
    return row;
}

/// How many rows happen with each value of a control.
std::vector<std::size_t> happened(InputTriggers& triggers, const std::string& channel, std::initializer_list<double> values) {
    std::vector<std::size_t> counts;
    for (const double value : values) counts.push_back(triggers.take(valueOf("pad", channel, {value})).size());
    return counts;
}

}  // namespace

TEST_CASE("triggers: a button lets its row happen once each time it is pressed; what trembles about the middle happens once") {
    InputTriggers t({triggerRow("a"), triggerRow("b"), triggerRow("a")});
    CHECK(happened(t, "a", {1, 1, 0, 1}) == std::vector<std::size_t>{2, 0, 0, 2});
    CHECK(t.take(valueOf("pad", "a", {0.0})).empty());
    CHECK(t.take(valueOf("midi", "a", {1.0})).empty());
    CHECK(happened(t, "b", {0.2, 0.55, 0.48, 0.56, 0.45, 0.6, 0.3, 0.6}) == std::vector<std::size_t>{0, 1, 0, 0, 0, 0, 0, 1});
    CHECK(t.meter(1).drives);
    CHECK(t.meter(1).raw == 0.6);
    CHECK(t.meter(1).heard == 8);
}

TEST_CASE("triggers: one whose outcome is turned round happens when its control goes down; muted ones never, and what is plugged out can happen again") {
    InputRow down = triggerRow("a");
    std::swap(down.curve.outLow, down.curve.outHigh);
    InputTriggers t({down, triggerRow("a", true)});
    CHECK(happened(t, "a", {1, 0, 1, 0}) == std::vector<std::size_t>{0, 1, 0, 1});
    InputValue gone = valueOf("pad", "a", {0.0});
    gone.gone = true;
    CHECK(t.take(gone).empty());
    CHECK(t.meter(0).silent);
    CHECK(happened(t, "a", {0}) == std::vector<std::size_t>{1});
    const auto value = valueOf("pad", "a", {1.0});
    const auto before = allocations();
    for (int i = 0; i < 100; ++i) (void)t.take(value);
    CHECK(allocations() == before);
}
