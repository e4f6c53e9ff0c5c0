// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/take_deck.h"

#include <algorithm>
#include <cmath>

namespace imomushi {
namespace {

constexpr double kLiveFrame = 1.0 / 60.0;  // s

}  // namespace

TakeDeck::TakeDeck(StudioDocument& document, QObject* parent) : QObject(parent), document_(document) {
    connect(&document, &StudioDocument::structureChanged, this, &TakeDeck::follow);
    connect(&document, &StudioDocument::poseChanged, this, &TakeDeck::follow);
    connect(&document, &StudioDocument::responsesChanged, this, &TakeDeck::follow);
    connect(&document, &StudioDocument::frameStepped, this, [this] {
        const auto recording = document_.session().recording();
        if (!recording_ || !recording) return follow();
        // A recording whose character changed takes no more frames.
        if (recording->frames == recorded_) return stopRecording();
        recorded_ = recording->frames;
        Q_EMIT changed();
    });
}

const Take* TakeDeck::take() const {
    const auto found = document_.document().takes.find(take_);
    return found == document_.document().takes.end() ? nullptr : found->second.get();
}

int TakeDeck::frame() const {
    const Take* chosen = take();
    return chosen && !chosen->times.empty() ? int(momentAt(chosen->times, time_).frame) : 0;
}

/// After something happened elsewhere: a drag leaves the take, undo takes it away.
void TakeDeck::follow() {
    if (acting_) return;
    const auto recording = document_.session().recording();
    recording_ = recording.has_value();
    if (take_ && !take()) {
        take_ = 0;
        time_ = 0.0;
        if (shown_) return leave();
    }
    // There is always one to play.
    if (!take_ && !document_.document().takes.empty()) take_ = document_.document().takes.begin()->first;
    shown_ = shown_ && document_.session().showsTake();
    playing_ = playing_ && shown_;
    Q_EMIT changed();
}

void TakeDeck::choose(PartId id) {
    if (recording_ || (id == take_ && shown_)) return;
    take_ = id;
    time_ = 0.0;
    playing_ = false;
    if (take()) show(0.0);
    else leave();
}

bool TakeDeck::play(double time) {
    const Take* chosen = take();
    if (!chosen || recording_) return false;
    time_ = std::clamp(time, 0.0, chosen->duration());
    acting_ = true;
    const auto answer = document_.execute({{"do", "play"}, {"take", chosen->name}, {"time", time_}});
    acting_ = false;
    shown_ = document_.session().showsTake();
    if (answer) exact_ = answer->at("exact").get<bool>();
    return answer.has_value();
}

void TakeDeck::show(double time) {
    playing_ = false;
    play(time);
    Q_EMIT changed();
}

void TakeDeck::step(int frames) {
    const Take* chosen = take();
    if (!chosen || chosen->times.empty()) return;
    show(chosen->times[std::size_t(std::clamp(frame() + frames, 0, int(chosen->times.size()) - 1))]);
}

void TakeDeck::leave() {
    playing_ = false;
    if (document_.session().showsTake()) {
        acting_ = true;
        document_.stepFrame(kLiveFrame);
        acting_ = false;
    }
    shown_ = false;
    Q_EMIT changed();
}

void TakeDeck::setPlaying(bool playing) {
    const Take* chosen = take();
    if (recording_ || !chosen || playing == playing_) return;
    playing_ = playing && play(time_ < chosen->duration() ? time_ : 0.0);
    Q_EMIT changed();
}

void TakeDeck::setLooping(bool looping) {
    if (looping == looping_) return;
    looping_ = looping;
    Q_EMIT changed();
}

void TakeDeck::advance(double seconds) {
    const Take* chosen = take();
    if (!playing_ || !chosen) return;
    const double end = chosen->duration();
    double time = time_ + seconds;
    const bool over = time >= end;
    if (over) time = looping_ && end > 0.0 ? std::fmod(time, end) : end;
    playing_ = play(time) && (!over || looping_);
    Q_EMIT changed();
}

bool TakeDeck::canRecord() const { return !document_.document().elements.empty() || !document_.document().bones.empty(); }

void TakeDeck::startRecording() {
    if (recording_) return;
    playing_ = false;
    QString name;
    for (int n = int(document_.document().takes.size()) + 1; name.isEmpty() || document_.document().takeNamed(name.toStdString()); ++n) name = tr("Take %1").arg(n);
    acting_ = true;
    const auto started = document_.execute({{"do", "record"}, {"take", name.toStdString()}, {"action", "start"}});
    acting_ = false;
    shown_ = document_.session().showsTake();
    recording_ = started.has_value();
    recorded_ = recording_ ? 1 : 0;
    Q_EMIT changed();
}

void TakeDeck::stopRecording() {
    const auto recording = document_.session().recording();
    if (!recording) return;
    recording_ = false;
    acting_ = true;
    const auto answer = document_.execute({{"do", "record"}, {"take", recording->take}, {"action", "stop"}});
    acting_ = false;
    if (const Take* made = answer ? document_.document().takeNamed(recording->take) : nullptr) {
        take_ = made->id;
        time_ = made->duration();
        exact_ = true;
        if (!answer->at("whole").get<bool>()) Q_EMIT said(tr("The recording ended early: the character changed meanwhile, or the take was full."));
    }
    Q_EMIT changed();
}

}  // namespace imomushi
