// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/take_deck.h"

#include <algorithm>
#include <cmath>

#include "ui/models/commands.h"

namespace imomushi {
namespace {

constexpr int kCount = 3;                  // s before a recording

}  // namespace

TakeDeck::TakeDeck(StudioDocument& document, QObject* parent) : QObject(parent), document_(document) {
    connect(&document, &StudioDocument::structureChanged, this, &TakeDeck::follow);
    connect(&document, &StudioDocument::poseChanged, this, &TakeDeck::follow);
    connect(&document, &StudioDocument::responsesChanged, this, &TakeDeck::follow);
    connect(&document, &StudioDocument::frameStepped, this, [this] {
        const auto recording = document_.session().recording();
        if (!recording_ || !recording) return follow();
        if (recording->ended) return stopRecording();
        Q_EMIT changed();
    });
    count_.setInterval(1000);
    connect(&count_, &QTimer::timeout, this, [this] {
        if (--counting_ > 0) return void(Q_EMIT changed());
        count_.stop();
        beginRecording();
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
    if (counting_ && !canRecord()) stopRecording();
    if (take_ && !take()) {
        take_ = 0;
        time_ = 0.0;
        if (shown_) return leave();
    }
    // There is always one to play.
    if (!take_ && !document_.document().takes.empty()) take_ = document_.document().takes.begin()->first;
    shown_ = shown_ && document_.session().showsTake();
    playing_ = playing_ && shown_;
    if (const Take* chosen = take(); chosen && chosen->duration() != length_) {
        // It was trimmed, or that was undone.
        forgetSpan();
        if (shown_) play(time_);
        time_ = std::min(time_, length_);
    }
    Q_EMIT changed();
}

void TakeDeck::forgetSpan() {
    const Take* chosen = take();
    length_ = chosen ? chosen->duration() : 0.0;
    from_ = 0.0;
    to_ = length_;
}

void TakeDeck::choose(PartId id) {
    if (recording_ || (id == take_ && shown_)) return;
    if (id != take_) {
        take_ = id;
        forgetSpan();
    }
    playing_ = false;
    if (take()) show(from_);
    else leave();
}

bool TakeDeck::play(double time) {
    const Take* chosen = take();
    if (!chosen || recording_) return false;
    time_ = std::clamp(time, 0.0, chosen->duration());
    acting_ = true;
    const auto answer = document_.execute(commands::play(chosen->name, time_));
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

void TakeDeck::setSpan(double from, double to) {
    const Take* chosen = take();
    if (!chosen || chosen->times.size() < 2) return;
    const auto& times = chosen->times;
    const auto nearest = [&](double time) {
        const TakeMoment moment = momentAt(times, time);
        return moment.frame + (moment.part > 0.5 ? 1 : 0);
    };
    // The mark that moves stops at the other one.
    std::size_t first = nearest(from), last = nearest(to);
    if (to == to_) first = std::min(first, last - 1);
    else last = std::max(last, first + 1);
    if (times[first] == from_ && times[last] == to_) return;
    from_ = times[first];
    to_ = times[last];
    Q_EMIT changed();
}

void TakeDeck::trim() {
    const Take* chosen = take();
    if (!chosen || !marked() || recording_) return;
    const double time = std::clamp(time_, from_, to_) - from_;
    acting_ = true;
    const bool trimmed = document_.execute(commands::trimTake(chosen->name, from_, to_)).has_value();
    acting_ = false;
    if (!trimmed) return;
    forgetSpan();
    time_ = time;
    if (shown_) play(time);
    Q_EMIT changed();
}

void TakeDeck::duplicate() {
    const Take* chosen = take();
    if (!chosen || recording_) return;
    const QString name = QString::fromStdString(chosen->name);
    QString copy = tr("%1 copy", "name of a take").arg(name);
    for (int n = 2; document_.document().takeNamed(copy.toStdString()); ++n) copy = tr("%1 copy %2", "name of a take").arg(name, QString::number(n));
    const double time = time_;
    if (!document_.execute(commands::duplicateTake(chosen->name, copy.toStdString()))) return;
    take_ = document_.document().takeNamed(copy.toStdString())->id;
    time_ = time;
    Q_EMIT changed();
}

void TakeDeck::remove() {
    const Take* chosen = take();
    if (chosen && !recording_) document_.execute(commands::removeTake(chosen->name));
}

void TakeDeck::leave() {
    playing_ = false;
    if (document_.session().showsTake()) {
        acting_ = true;
        document_.stepFrame(1.0 / document_.document().settings.rate);
        acting_ = false;
    }
    shown_ = false;
    Q_EMIT changed();
}

void TakeDeck::setPlaying(bool playing) {
    const Take* chosen = take();
    if (recording_ || !chosen || playing == playing_) return;
    playing_ = playing && play(time_ >= from_ && time_ < to_ ? time_ : from_);
    const Document& d = document_.document();
    const auto drafts = std::count_if(d.elements.begin(), d.elements.end(), [this](const auto& e) { return document_.session().responses().isDraft(e.first); });
    if (playing_ && drafts > 0) Q_EMIT said(tr("%n element(s) play as drafts: precompute them (P) for what their settings ask for.", nullptr, int(drafts)));
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
    double time = time_ + seconds;
    const bool over = time >= to_;
    if (over) time = looping_ && to_ > from_ ? from_ + std::fmod(time - from_, to_ - from_) : to_;
    playing_ = play(time) && (!over || looping_);
    Q_EMIT changed();
}

bool TakeDeck::canRecord() const { return !document_.document().elements.empty() || !document_.document().bones.empty(); }

void TakeDeck::setCountsIn(bool counts) {
    if (counts == countsIn_) return;
    countsIn_ = counts;
    Q_EMIT changed();
}

void TakeDeck::startRecording() {
    if (recording_ || counting_) return;
    if (!countsIn_) return beginRecording();
    counting_ = kCount;
    count_.start();
    Q_EMIT changed();
}

void TakeDeck::beginRecording() {
    playing_ = false;
    QString name;
    for (int n = int(document_.document().takes.size()) + 1; name.isEmpty() || document_.document().takeNamed(name.toStdString()); ++n) name = tr("Take %1").arg(n);
    acting_ = true;
    const auto started = document_.execute(commands::startRecording(name.toStdString()));
    acting_ = false;
    shown_ = document_.session().showsTake();
    recording_ = started.has_value();
    Q_EMIT changed();
}

void TakeDeck::stopRecording() {
    count_.stop();
    const bool counted = counting_ > 0;
    counting_ = 0;
    const auto recording = document_.session().recording();
    if (!recording) {
        if (counted) Q_EMIT changed();
        return;
    }
    recording_ = false;
    acting_ = true;
    const auto answer = document_.execute(commands::stopRecording(recording->take));
    acting_ = false;
    if (const Take* made = answer ? document_.document().takeNamed(recording->take) : nullptr) {
        take_ = made->id;
        forgetSpan();
        time_ = made->duration();
        exact_ = true;
        if (answer->at("whole").get<bool>()) Q_EMIT recorded(QString::fromStdString(made->name), made->duration());
        else Q_EMIT said(tr("The recording ended early: the character changed meanwhile, or the take was full."));
    }
    Q_EMIT changed();
}

}  // namespace imomushi
