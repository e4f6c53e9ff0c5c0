// SPDX-License-Identifier: GPL-3.0-or-later
// Which keys an InputDeck wants, and learning which control moves.
#include <algorithm>
#include <tuple>

#include "core/input/key_names.h"
#include "ui/models/commands.h"
#include "ui/models/input_deck.h"
#include "ui/models/mapping_texts.h"
#include "ui/models/texts.h"

namespace imomushi {
namespace {

bool isTrigger(const InputMapping& m) { return m.target.starts_with("take/") || m.target.starts_with("trigger/"); }

}  // namespace

bool InputDeck::hasKey(std::string_view key, const std::function<bool(const InputMapping&)>& acts) const {
    const KeyStick* stick = keyStick(key);
    const auto& rows = document_.document().mappings;
    return rows && std::any_of(sources_.begin(), sources_.end(), [&](const Source& s) {
               return s.protocol == InputProtocol::Keys && s.open && std::any_of(rows->begin(), rows->end(), [&](const InputMapping& m) {
                          return m.row.source == s.name && (m.row.channel == key || (stick && m.row.channel == stick->name)) && acts(m);
                      });
           });
}

bool InputDeck::wantsKey(std::string_view key) const {
    if (!isKeyName(key)) return false;
    if (learning()) return std::any_of(sources_.begin(), sources_.end(), [](const Source& s) { return s.protocol == InputProtocol::Keys && s.open; });
    const bool performs = waits() == Waits::No || waits() == Waits::LetGo, solo = anySolo(document_.document());
    // Triggers act while inputs wait, too.
    return hasKey(key, [&](const InputMapping& m) { return !heardRow(m, solo).muted && (performs || isTrigger(m)); });
}

bool InputDeck::drivesByKey(std::string_view key) const {
    const bool solo = anySolo(document_.document());
    return isKeyName(key) && hasKey(key, [&](const InputMapping& m) { return !heardRow(m, solo).muted && !isTrigger(m); });
}

void InputDeck::learn(const std::string& target) {
    target_ = target;
    candidate_.reset();
    thread_.learn(learning());
    const bool heard = hears();
    followDevices();
    if (hears() != heard) follow();
    Q_EMIT changed();
}

void InputDeck::stopLearning() {
    if (learning()) learn({});
}

void InputDeck::takeCandidate() {
    const auto found = candidate_;
    const std::string target = target_;
    // Where it stops without a row, the device may be closed.
    if (!found) return stopLearning();
    const auto there = mappedTarget(document_.document(), target);
    if (!there) {
        stopLearning();
        return Q_EMIT document_.failed(errorText(there.error()));
    }
    InputMapping made;
    made.target = target;
    made.row.source = found->source;
    made.row.channel = found->channel;
    made.row.component = found->component;
    ResponseCurve& curve = made.row.curve;
    curve.inLow = found->low;
    curve.inHigh = found->high;
    std::tie(curve.outLow, curve.outHigh) = usualReach(document_.document(), *there, found->low < 0.0 && found->high > 0.0);
    const auto answer = document_.execute(commands::mapInput(made));
    stopLearning();
    if (!answer) return;
    if (waits_ != Waits::No) goOn();
    holdsAnyway_ = true;
    Q_EMIT learned(answer->at("position").get<int>());
}

}  // namespace imomushi
