// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "core/input/input_mapper.h"
#include "tests/support/allocations.h"
#include "tests/support/input_values.h"

using namespace imomushi;

namespace {

constexpr double kStep = 1.0 / 60.0;

InputRow rowOf(const std::string& source, const std::string& channel, int slot = 0) {
    InputRow row;
    row.source = source;
    row.channel = channel;
    row.slot = slot;
    return row;
}

InputMapper mapperOf(std::vector<InputRow> rows, double shown = 0.0, double rest = 0.0) { return InputMapper(std::move(rows), std::span(&shown, 1), std::span(&rest, 1)); }

/// The largest change of the first slot from one step to the next.
double stepFor(InputMapper& mapper, double seconds) {
    double largest = 0.0;
    for (int i = 0; i < static_cast<int>(std::lround(seconds / kStep)); ++i) {
        const double before = mapper.shown(0);
        mapper.step(kStep);
        largest = std::max(largest, std::abs(mapper.shown(0) - before));
    }
    return largest;
}

/// A glide of so many seconds over a way of 1 is nowhere faster than this in a step: the steepest of 3 t^2 - 2 t^3 is 1.5.
constexpr double fastest(double seconds) { return 1.5 * kStep / seconds + 1e-12; }

}  // namespace

TEST_CASE("mapper: a row drives its slot to what its curve says, without a jump at the beginning, and what is not mapped moves nothing") {
    InputMapper m = mapperOf({rowOf("face", "blend/Joy")}, 0.3);
    CHECK(!m.take(valueOf("face", "blend/Fun", {1.0})));
    CHECK(!m.take(valueOf("body", "blend/Joy", {1.0})));
    stepFor(m, 0.5);
    CHECK(m.shown(0) == 0.3);
    CHECK(m.winner(0) == -1);
    CHECK(m.take(valueOf("face", "blend/Joy", {0.8})));
    CHECK(stepFor(m, 0.5) <= fastest(InputMapper::kHandover));
    CHECK(m.shown(0) == 0.8);
    CHECK(m.winner(0) == 0);
    CHECK(!m.moved(0));
    // Afterwards it is followed at once.
    CHECK(m.take(valueOf("face", "blend/Joy", {0.1})));
    m.step(kStep);
    CHECK(m.shown(0) == 0.1);
    CHECK(m.moved(0));
}

TEST_CASE("mapper: a row that toggles is at the end of its range after a press, at the beginning after the next one; what trembles is pressed once") {
    InputRow row = rowOf("pad", "a");
    row.toggles = true;
    row.curve.outHigh = 2.0;
    InputMapper m = mapperOf({row});
    const auto says = [&](double number) { CHECK(m.take(valueOf("pad", "a", {number}))); };
    says(0.0);
    stepFor(m, 0.5);
    CHECK(m.shown(0) == 0.0);
    // Pressed and released between two steps.
    says(1.0), says(0.0);
    m.step(kStep);
    CHECK(m.shown(0) == 2.0);
    says(0.52), says(0.48), says(0.52);
    m.step(kStep);
    CHECK(m.shown(0) == 0.0);
    says(0.0), says(1.0);
    m.step(kStep);
    CHECK(m.shown(0) == 2.0);
    CHECK(m.meterOf(0).raw == 1.0);
    // After panic it is off again.
    m.letGo();
    stepFor(m, InputMapper::kGlideToRest);
    says(0.0);
    stepFor(m, 0.5);
    CHECK(m.shown(0) == 0.0);
}

TEST_CASE("mapper: a component that a value lacks, or a number that is not finite, is not heard") {
    InputRow second = rowOf("pad", "stick");
    second.component = 1;
    InputMapper m = mapperOf({second});
    CHECK(!m.take(valueOf("pad", "stick", {1.0})));
    CHECK(!m.take(valueOf("pad", "stick", {1.0, std::numeric_limits<double>::quiet_NaN()})));
    CHECK(m.take(valueOf("pad", "stick", {0.0, 0.5})));
    CHECK(m.heardBy(0) == 1);
    stepFor(m, 0.5);
    CHECK(m.shown(0) == 0.5);
}

TEST_CASE("mapper: in silence a row holds, glides to rest or leaves its slot to the next one, and comes back without a jump") {
    for (const auto silence : {InputRow::Silence::Hold, InputRow::Silence::Rest, InputRow::Silence::Next}) {
        CAPTURE(static_cast<int>(silence));
        InputRow first = rowOf("body", "a");
        first.after = 0.5;
        first.silence = silence;
        InputMapper m = mapperOf({first, rowOf("spare", "b")});
        m.take(valueOf("spare", "b", {0.25}));
        m.take(valueOf("body", "a", {1.0}));
        stepFor(m, 0.45);
        CHECK(m.shown(0) == 1.0);  // the first one wins while it speaks
        CHECK(stepFor(m, 2.0) <= fastest(InputMapper::kHandover));
        const double expected = silence == InputRow::Silence::Hold ? 1.0 : silence == InputRow::Silence::Rest ? 0.0 : 0.25;
        CHECK(m.shown(0) == expected);
        CHECK(m.winner(0) == (silence == InputRow::Silence::Hold ? 0 : silence == InputRow::Silence::Rest ? -1 : 1));
        m.take(valueOf("body", "a", {0.5}));
        CHECK(stepFor(m, 0.4) <= fastest(InputMapper::kHandover));
        CHECK(m.shown(0) == 0.5);
    }
}

TEST_CASE("mapper: after silence a filter starts anew, with what came") {
    InputRow smooth = rowOf("body", "a");
    smooth.filter.hertz = 0.5;
    smooth.after = 0.5;
    InputMapper m = mapperOf({smooth});
    m.take(valueOf("body", "a", {0.0}));
    stepFor(m, 1.0);
    m.take(valueOf("body", "a", {1.0}));
    m.step(kStep);
    CHECK(m.valueOf(0) == 1.0);
    // While it speaks, it is followed slowly.
    m.take(valueOf("body", "a", {0.0}));
    m.step(kStep);
    CHECK(m.valueOf(0) > 0.9);
}

TEST_CASE("mapper: muted rows leave their slot to others; a hand wins until it lets go; panic brings everything to rest") {
    InputRow muted = rowOf("pad", "a");
    muted.muted = true;
    InputMapper m = mapperOf({muted, rowOf("pad", "a")}, 0.0, -1.0);
    m.take(valueOf("pad", "a", {1.0}));
    stepFor(m, 0.5);
    CHECK(m.winner(0) == 1);
    m.setByHand(0, true, 0.4);
    m.take(valueOf("pad", "a", {0.9}));
    CHECK(stepFor(m, 0.5) == 0.0);
    m.setByHand(0, false, 0.4);
    CHECK(stepFor(m, 0.5) <= fastest(InputMapper::kHandover));
    CHECK(m.shown(0) == 0.9);
    m.letGo();
    CHECK(stepFor(m, 1.5) <= 1.9 * fastest(InputMapper::kGlideToRest));
    CHECK(m.shown(0) == -1.0);
    m.take(valueOf("pad", "a", {0.5}));
    stepFor(m, 0.5);
    CHECK(m.shown(0) == 0.5);
}

TEST_CASE("mapper: a step of 100 rows with 300 values neither allocates nor takes long, and says the same each time") {
    std::vector<InputRow> rows;
    std::vector<InputValue> values;
    for (int i = 0; i < 100; ++i) {
        rows.push_back(rowOf("body", "bone/" + std::to_string(i), i / 2));
        rows.back().filter = {1.0, 0.1};
        rows.back().curve.exponent = 1.5;
        rows.back().component = i % 3;
    }
    for (int i = 0; i < 300; ++i) values.push_back(valueOf("body", "bone/" + std::to_string(i), {0.1, 0.2, 0.3}));
    const std::vector<double> zero(50, 0.0);
    InputMapper one(rows, zero, zero), two(rows, zero, zero);
    const auto perform = [&](InputMapper& mapper) {
        for (int s = 0; s < 600; ++s) {
            for (InputValue& value : values) {
                value.numbers[0] = 0.5 + 0.4 * ((s * 7) % 11) / 11.0;
                mapper.take(value);
            }
            mapper.step(kStep);
        }
    };
    const std::size_t before = allocations();
    const auto start = std::chrono::steady_clock::now();
    perform(one);
    const double milliseconds = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count() / 600;
    CHECK(allocations() == before);
    perform(two);
    for (int s = 0; s < 50; ++s) CHECK(one.shown(s) == two.shown(s));
    MESSAGE(milliseconds << " ms a step");
    CHECK(milliseconds < 4.0);  // what the whole step may take
}

TEST_CASE("mapper: a device that is plugged out is silent at once, whatever its row waits for; when it is back, nothing jumps") {
    const auto gone = [](const char* channel) {
        InputValue value = valueOf("pad", channel, {0.0});
        value.gone = true;
        return value;
    };
    InputRow rests = rowOf("pad", "x");
    rests.silence = InputRow::Silence::Rest;
    for (const bool hold : {true, false}) {
        InputMapper m = mapperOf({hold ? rowOf("pad", "x") : rests});
        CHECK(m.take(valueOf("pad", "x", {0.8})));
        stepFor(m, 1.0);
        CHECK(m.shown(0) == 0.8);
        CHECK(m.take(gone("x")));
        CHECK(!m.take(gone("y")));
        CHECK(stepFor(m, 2.0) <= 0.8 * fastest(InputMapper::kGlideToRest));
        CHECK(m.shown(0) == (hold ? 0.8 : 0.0));
        CHECK(m.meterOf(0).silent);
        CHECK(m.take(valueOf("pad", "x", {-0.2})));
        CHECK(stepFor(m, 1.0) <= fastest(InputMapper::kHandover));
        CHECK(m.shown(0) == 0.0);  // the range of the row
        CHECK(!m.meterOf(0).silent);
    }
    // The same within one step: what comes last counts.
    InputMapper m = mapperOf({rowOf("pad", "x")});
    m.take(valueOf("pad", "x", {0.8}));
    stepFor(m, 1.0);
    m.take(gone("x"));
    m.take(valueOf("pad", "x", {0.1}));
    CHECK(stepFor(m, 1.0) <= fastest(InputMapper::kHandover));
    CHECK(m.shown(0) == 0.1);
}

TEST_CASE("mapper: what hangs on a spring swings beyond by the first press already, and comes to rest where its control is") {
    InputRow row = rowOf("keys", "space");
    row.spring = {3.0, 0.3};
    InputMapper m = mapperOf({row}, 0.0);
    m.take(valueOf("keys", "space", {1.0}));
    double highest = 0.0;
    for (int i = 0; i < 240; ++i) {
        m.step(kStep);
        highest = std::max(highest, m.shown(0));
    }
    CHECK(highest > 1.1);
    CHECK(m.shown(0) == 1.0);
    CHECK(!m.moved(0));
}

TEST_CASE("mapper: it says for how long steps would change nothing; without these steps it goes on as with them") {
    InputRow filtered = rowOf("face", "a", 0), sprung = rowOf("face", "b", 1), held = rowOf("face", "c", 2), next = rowOf("pad", "c", 2);
    filtered.filter.hertz = 3.0;
    sprung.spring.hertz = 2.0;
    sprung.after = 4.0;
    sprung.silence = InputRow::Silence::Rest;
    held.after = 6.0;
    held.silence = InputRow::Silence::Next;
    const std::vector<double> shown(3, 0.0);
    const std::vector<InputRow> rows{filtered, sprung, held, next};
    InputMapper all(rows, shown, shown), some(rows, shown, shown);
    CHECK(all.rests() == 0.0);  // it has made no step yet
    all.step(kStep), some.step(kStep);
    CHECK(all.rests() == std::numeric_limits<double>::infinity());
    const std::vector<std::vector<InputValue>> heard = {{valueOf("face", "a", {0.7}), valueOf("face", "b", {0.4}), valueOf("face", "c", {0.9})}, {valueOf("pad", "c", {0.2})}, {}, {}, {valueOf("face", "b", {0.1})}, {}};
    int left = 0, made = 0, events = 0;
    for (const auto& values : heard) {
        for (const InputValue& value : values) CHECK(all.take(value) == some.take(value));
        if (!values.empty()) CHECK(some.rests() == 0.0);
        for (double passed = 0.0; passed < 2.5;) {
            const int steps = static_cast<int>(std::min(some.rests(), 2.5) / kStep);
            for (int i = 0; i < steps; ++i) {
                all.step(kStep);
                for (int s = 0; s < 3; ++s) CHECK(std::abs(all.shown(s) - some.shown(s)) < 1e-6);
            }
            some.pass(steps * kStep);
            left += steps;
            all.step(kStep), some.step(kStep);
            ++made;
            for (int s = 0; s < 3; ++s) {
                CHECK(all.winner(s) == some.winner(s));
                CHECK(std::abs(all.shown(s) - some.shown(s)) < 1e-6);
            }
            for (std::size_t r = 0; r < rows.size(); ++r) CHECK(all.meterOf(r).silent == some.meterOf(r).silent);
            passed += (steps + 1) * kStep;
        }
        events += some.meterOf(1).silent + some.meterOf(2).silent;
    }
    CHECK(events >= 3);
    MESSAGE(made << " steps, " << left << " left out");
    CHECK(left > made);
    // What is told counts at once.
    REQUIRE(some.rests() > 0.0);
    some.setByHand(0, false, 0.5);
    CHECK(some.rests() == 0.0);
    for (int i = 0; i < 200; ++i) some.step(kStep);
    REQUIRE(some.rests() > 0.0);
    some.letGo();
    CHECK(some.rests() == 0.0);
    const InputValue gone = [] {
        InputValue value = valueOf("pad", "c", {0.0});
        value.gone = true;
        return value;
    }();
    for (int i = 0; i < 200; ++i) some.step(kStep);
    REQUIRE(some.rests() > 0.0);
    CHECK(some.take(gone));
    CHECK(some.rests() == 0.0);
}
