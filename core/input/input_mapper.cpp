// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/input/input_mapper.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/input/input_triggers.h"
#include "core/input/name_hash.h"

namespace imomushi {

InputMapper::InputMapper(std::vector<InputRow> rows, std::span<const double> shown, std::span<const double> rest, std::vector<Correction> corrections)
    : rows_(std::move(rows)), corrections_(std::move(corrections)), heard_(rows_.size()), slots_(shown.size()), rowsOf_(shown.size()) {
    for (std::size_t i = 0; i < slots_.size(); ++i) slots_[i].shown = slots_[i].from = shown[i], slots_[i].rest = rest[i];
    for (std::size_t r = 0; r < rows_.size(); ++r) {
        const InputRow& row = rows_[r];
        sources_.emplace_back(row.source);
        channels_.emplace_back(row.channel);
        if (row.slot < 0 || row.slot >= static_cast<int>(slots_.size()) || !InputName::fits(row.source) || !InputName::fits(row.channel)) continue;
        listeners_.push_back({hashOfNames(row.source, row.channel), r});
        rowsOf_[static_cast<std::size_t>(row.slot)].push_back(r);
    }
    std::ranges::stable_sort(listeners_, {}, &Listener::name);
}

bool InputMapper::take(const InputValue& value) {
    const std::uint64_t name = hashOfNames(value.source.text(), value.channel.text());
    bool taken = false;
    for (auto at = std::ranges::lower_bound(listeners_, name, {}, &Listener::name); at != listeners_.end() && at->name == name; ++at) {
        const Listener& listener = *at;
        const int component = rows_[listener.row].component;
        if (value.gone && value.source == sources_[listener.row] && value.channel == channels_[listener.row]) {
            Heard& heard = heard_[listener.row];
            heard.gone = taken = touched_ = true;
            heard.fresh = false;
            continue;
        }
        if (!(value.source == sources_[listener.row]) || !(value.channel == channels_[listener.row]) || component < 0 || component >= value.count) continue;
        const double number = value.numbers[static_cast<std::size_t>(component)];
        if (!InputValue::isSound(number)) continue;
        Heard& heard = heard_[listener.row];
        heard.raw = heard.meant = number;
        const InputRow& row = rows_[listener.row];
        if (row.correction >= 0 && static_cast<std::size_t>(row.correction) < corrections_.size())
            heard.meant = corrections_[static_cast<std::size_t>(row.correction)].at(std::span(value.numbers).first(static_cast<std::size_t>(value.count)), component);
        if (row.toggles) {
            const double part = (number - row.curve.inLow) / (row.curve.inHigh - row.curve.inLow);
            if (part < 0.5 - InputTriggers::kBack) heard.pressed = false;
            else if (part > 0.5 && !std::exchange(heard.pressed, true)) heard.on = !heard.on;
            heard.meant = heard.on ? row.curve.inHigh : row.curve.inLow;
        }
        heard.fresh = taken = touched_ = true;
        ++heard.count;
    }
    return taken;
}

void InputMapper::step(double seconds) {
    touched_ = false;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
        const InputRow& row = rows_[r];
        Heard& heard = heard_[r];
        heard.returned = false;
        if (heard.fresh) {
            heard.returned = heard.silent || heard.gone;
            if (!heard.known || heard.returned) {  // what it knew is too old
                heard.filtered.restart(heard.meant);
                // A spring swings from where things are, also by the first press.
                const bool there = row.slot >= 0 && row.slot < static_cast<int>(slots_.size());
                heard.sprung.restart(there ? slots_[static_cast<std::size_t>(row.slot)].shown : row.curve.at(heard.meant));
            }
            heard.known = true;
            heard.silent = heard.fresh = heard.gone = false;
            heard.age = 0.0;
        } else if (heard.known) {
            heard.age += seconds;
            heard.silent = heard.gone || (row.after > 0.0 && heard.age > row.after);
        }
        if (heard.known) heard.value = heard.sprung.follow(row.curve.at(heard.filtered.follow(heard.meant, seconds, row.filter)), seconds, row.spring);
    }
    for (std::size_t s = 0; s < slots_.size(); ++s) {
        Slot& slot = slots_[s];
        slot.moved = false;
        if (slot.byHand) continue;
        int driver = slot.driver;  // where nobody drives it, it stays
        bool driven = false;
        for (const std::size_t r : rowsOf_[s]) {
            const Heard& heard = heard_[r];
            if (rows_[r].muted || !heard.known || (heard.silent && rows_[r].silence == InputRow::Silence::Next)) continue;
            driver = heard.silent && rows_[r].silence == InputRow::Silence::Rest ? kRests : static_cast<int>(r);
            driven = true;
            break;
        }
        if (!driven && driver >= 0) driver = -1;
        if (driver != slot.driver || (driver >= 0 && heard_[static_cast<std::size_t>(driver)].returned)) {
            slot.from = slot.shown;
            slot.passed = 0.0;
            slot.length = driver == kRests ? kGlideToRest : kHandover;
            slot.driven = driver == kRests && slot.driver >= 0;
            slot.driver = driver;
        }
        if (slot.driver == -1) continue;
        const double goal = slot.driver == kRests ? slot.rest : heard_[static_cast<std::size_t>(slot.driver)].value;
        slot.passed = std::min(slot.length, slot.passed + seconds);
        const double t = slot.passed / slot.length;
        const double next = t < 1.0 ? slot.from + eased(t) * (goal - slot.from) : goal;
        slot.moved = next != slot.shown;
        slot.shown = next;
    }
}

double InputMapper::rests() const {
    if (touched_) return 0.0;
    double most = std::numeric_limits<double>::infinity();
    for (std::size_t r = 0; r < rows_.size(); ++r) {
        const InputRow& row = rows_[r];
        const Heard& heard = heard_[r];
        if (!heard.known) continue;
        if (row.filter.hertz > 0.0 && std::abs(heard.filtered.value() - heard.meant) > kArrived * std::abs(row.curve.inHigh - row.curve.inLow)) return 0.0;
        if (!heard.sprung.rests()) return 0.0;
        if (row.after > 0.0 && !heard.silent) most = std::min(most, std::max(0.0, row.after - heard.age));
    }
    const bool glides = std::ranges::any_of(slots_, [](const Slot& slot) { return !slot.byHand && slot.driver != -1 && slot.passed < slot.length; });
    return glides ? 0.0 : most;
}

void InputMapper::pass(double seconds) {
    for (Heard& heard : heard_)
        if (heard.known) heard.age += seconds;
}

void InputMapper::letGo() {
    touched_ = true;
    for (Heard& heard : heard_) heard.known = heard.fresh = heard.gone = heard.silent = heard.returned = heard.pressed = heard.on = false;
    for (std::size_t s = 0; s < slots_.size(); ++s) letGo(static_cast<int>(s));
}

void InputMapper::letGo(int index) {
    touched_ = true;
    Slot& slot = slots_[static_cast<std::size_t>(index)];
    slot.from = slot.shown;
    slot.passed = 0.0;
    slot.length = kGlideToRest;
    slot.driven = slot.driver >= 0 || (slot.driver == kRests && slot.driven);
    slot.driver = kRests;
}

void InputMapper::setByHand(int index, bool byHand, double shown) {
    Slot& slot = slots_[static_cast<std::size_t>(index)];
    slot.byHand = byHand;
    slot.shown = slot.from = shown;
    touched_ = true;
    slot.driver = -1;  // who drives it next begins from there
}

}  // namespace imomushi
