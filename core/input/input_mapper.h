// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/input/correction.h"
#include "core/input/input_value.h"
#include "core/input/one_euro_filter.h"
#include "core/input/response_curve.h"
#include "core/input/spring_filter.h"

namespace imomushi {

/// Which number of which channel drives what: a row of the table of mappings.
struct InputRow {
    std::string source, channel;
    int component = 0;          ///< which number of the channel, from 0
    int slot = 0;               ///< what it drives: 0 ... slots - 1, see InputMapper
    int correction = -1;        ///< of those of its mapper, -1: none
    ResponseCurve curve;
    OneEuro filter;             ///< of the control, before the curve
    Spring spring;              ///< of what the curve makes of it
    /// What happens where its source has been silent for `after` seconds.
    enum class Silence { Hold, Rest, Next } silence = Silence::Hold;  ///< stays; glides to rest; the next row of the slot drives it
    double after = 0.0;         ///< s; 0: it is silent only where its device is plugged out (a stick that is not moved says nothing)
    bool muted = false;
    /// A button that switches: each time the control rises through the middle of its range, its value goes to the other end of the range.
    bool toggles = false;
    bool operator==(const InputRow&) const = default;
};

/// What a row shows while it is used.
struct InputMeter {
    double raw = 0.0;        ///< what its control said last, before any correction
    double value = 0.0;      ///< what it makes of that, in the unit of its slot
    std::uint64_t heard = 0; ///< how many values
    bool known = false;      ///< something was heard since the beginning, or since everything let go
    bool silent = false;     ///< for longer than its row allows
    bool drives = false;     ///< of the rows of its slot it is the one that wins
    bool operator==(const InputMeter&) const = default;
};

/// Maps values of controls to values of slots, once per step of a performance. A slot is one number that is driven, such as the height of a handle (m, from rest) or the weight of
/// a morph target. Of several rows of one slot the first one wins that has heard something and is neither muted nor silent. Where another row wins, or one comes back from silence, the slot
/// glides there from what it shows, so that nothing jumps. take(), step() and what is asked neither allocate, lock nor fail; an answer depends on values and steps alone.
class InputMapper {
public:
    static constexpr double kHandover = 0.25;    ///< s, from one row to another one
    static constexpr double kGlideToRest = 1.0;  ///< s
    /// A filter that is nearer to what it follows than this part of its control's range has arrived, for rests().
    static constexpr double kArrived = 1e-7;

    /// `shown`, `rest`: of each slot, what it is now and where it rests. Rows of slots that do not exist, or with a component that no value has, are never heard.
    /// `corrections`: of what rows hear, before anything else is made of it.
    InputMapper(std::vector<InputRow> rows, std::span<const double> shown, std::span<const double> rest, std::vector<Correction> corrections = {});

    /// False: no row listens to it.
    bool take(const InputValue& value);
    /// A step of so many seconds, > 0. Between two steps the last value of a channel counts.
    void step(double seconds);
    /// For how many seconds from the last step on no step would change anything that is seen, if nothing is heard: until a source has been silent for too long. 0: steps must go on.
    [[nodiscard]] double rests() const;
    /// So many seconds have passed without steps, at most rests(): sources were silent for longer.
    void pass(double seconds);
    /// Everything lets go: rows are as if nothing had been heard, and slots glide to rest. For panic.
    void letGo();
    /// A slot that a hand has (a mouse) is not driven; `shown`: where the hand left it.
    void setByHand(int slot, bool byHand, double shown);

    [[nodiscard]] double shown(int slot) const { return slots_[static_cast<std::size_t>(slot)].shown; }
    /// Whether the last step changed what it shows.
    [[nodiscard]] bool moved(int slot) const { return slots_[static_cast<std::size_t>(slot)].moved; }
    /// It glides to rest, or is there because everything let go.
    [[nodiscard]] bool letsGo(int slot) const { return slots_[static_cast<std::size_t>(slot)].driver == kRests; }
    /// How much is left of the way to rest, 1 ... 0, of what a row drove until it was let go.
    [[nodiscard]] double left(int slot) const {
        const Slot& of = slots_[static_cast<std::size_t>(slot)];
        return of.driver == kRests && of.driven ? 1.0 - eased(of.passed / of.length) : 0.0;
    }
    /// Everything lets go of this slot alone.
    void letGo(int slot);
    /// The row that drives a slot; -1: none has, or it rests.
    [[nodiscard]] int winner(int slot) const { return std::max(-1, slots_[static_cast<std::size_t>(slot)].driver); }
    /// For meters: what a row makes of its control now, in the unit of its slot, and how many values it heard.
    [[nodiscard]] double valueOf(std::size_t row) const { return heard_[row].value; }
    [[nodiscard]] std::uint64_t heardBy(std::size_t row) const { return heard_[row].count; }
    [[nodiscard]] InputMeter meterOf(std::size_t row) const {
        const Heard& heard = heard_[row];
        const int slot = rows_[row].slot;
        return {heard.raw, heard.value, heard.count, heard.known, heard.silent, slot >= 0 && slot < static_cast<int>(slots_.size()) && winner(slot) == static_cast<int>(row)};
    }
    [[nodiscard]] const std::vector<InputRow>& rows() const { return rows_; }

private:
    struct Heard {
        double raw = 0.0, value = 0.0;
        double meant = 0.0;    // raw and corrected, or the end of the range where the last press has put it
        bool pressed = false, on = false;
        FilteredNumber filtered;
        SprungNumber sprung;
        std::uint64_t count = 0;
        double age = 0.0;      // s, since the last value
        bool known = false;    // something was heard since letGo()
        bool fresh = false;    // since the last step
        bool gone = false;     // its device was plugged out, and has not said it again before the last step
        bool silent = false, returned = false;  // as of the last step
    };
    struct Slot {
        double shown = 0.0, rest = 0.0, from = 0.0;
        double passed = 0.0, length = 0.0;  // s, of the glide
        int driver = -1;                    // a row, -1: nothing, kRests
        bool driven = false;                // a row drove it before it rests
        bool moved = false, byHand = false;
    };
    static constexpr int kRests = -2;
    static double eased(double t) { return t < 1.0 ? t * t * (3.0 - 2.0 * t) : 1.0; }
    struct Listener {
        std::uint64_t name = 0;  // hash of source and channel
        std::size_t row = 0;
    };
    std::vector<InputRow> rows_;
    std::vector<Correction> corrections_;
    std::vector<Heard> heard_;
    std::vector<InputName> sources_, channels_;
    std::vector<Slot> slots_;
    std::vector<Listener> listeners_;              // by name
    std::vector<std::vector<std::size_t>> rowsOf_; // of each slot, in order
    bool touched_ = true;                          // since the last step something was said that it has not shown yet
};

}  // namespace imomushi
