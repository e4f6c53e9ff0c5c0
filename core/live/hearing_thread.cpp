// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/hearing_thread.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/base/try.h"
#include "core/input/name_hash.h"
#include "core/live/input_feed.h"

namespace imomushi {

namespace {

/// Whether it is over is asked so often: the window waits for the answer where a port is opened or closed.
constexpr std::chrono::milliseconds kSlice(10);
/// A sender that was silent for so long, ns, is not there any more.
constexpr std::int64_t kGone = 10'000'000'000;
/// Channels whose last value is remembered; whoever has more sends them all the time.
constexpr std::size_t kMostRemembered = 4096;

}  // namespace

Result<std::uint16_t> HearingThread::open(const RawSource& source, std::uint16_t port, UdpPort::From from) {
    IMOMUSHI_TRY(auto opened, UdpPort::listen(port, from));
    const std::uint16_t number = opened.port();
    open(source, std::make_unique<UdpPort>(std::move(opened)));
    return number;
}

void HearingThread::open(const RawSource& source, std::unique_ptr<InputPort> port) {
    stop();
    Source made;
    made.source = source;
    made.decoder = makeInputDecoder(source.protocol, source.name);
    sources_.push_back(std::move(made));
    listener_.add(std::move(port));
    run();
}

void HearingThread::close(const std::string& source) {
    const auto found = std::ranges::find_if(sources_, [&](const Source& s) { return s.source.name == source; });
    if (found == sources_.end()) return;
    stop();
    listener_.close(static_cast<std::size_t>(found - sources_.begin()));
    sources_.erase(found);
    forget(source);
    run();
}

std::optional<HearingThread::Heard> HearingThread::heard(const std::string& source) const {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find_if(sources_, [&](const Source& s) { return s.source.name == source; });
    if (found == sources_.end()) return std::nullopt;
    Heard told{found->decoder->counts(), found->lost, found->refused, 0, found->device};
    told.counts.packets += found->tooLong;
    told.counts.malformed += found->tooLong;
    const std::int64_t at = now();
    told.senders = static_cast<int>(std::count_if(found->senders.begin(), found->senders.begin() + static_cast<std::ptrdiff_t>(found->known), [&](const Sender& s) { return at - s.last < kGone; }));
    return told;
}

void HearingThread::feed(std::shared_ptr<InputFeed> feed, std::vector<std::string> names) {
    const std::lock_guard lock(mutex_);
    feed_ = std::move(feed);
    names_ = std::move(names);
    if (!feed_ || held_) return;
    for (const auto& [name, value] : last_) (void)feed_->give(std::span(&value, 1));
}

void HearingThread::say(const InputValue& value) {
    const std::lock_guard lock(mutex_);
    remember(value);
    if (feed_ && !held_) (void)feed_->give(std::span(&value, 1));
}

void HearingThread::forget(const std::string& source) {
    const std::lock_guard lock(mutex_);
    std::erase_if(last_, [&](const auto& known) { return known.second.source.text() == source; });
}

void HearingThread::hold(bool held) {
    const std::lock_guard lock(mutex_);
    held_ = held;
}

void HearingThread::learn(bool on) {
    const std::lock_guard lock(mutex_);
    learner_ = on ? std::make_unique<ControlLearner>() : nullptr;
}

void HearingThread::measure(const std::string& source) {
    const std::lock_guard lock(mutex_);
    measure_.reset();
    if (source.empty()) return;
    measure_.emplace(source);
    for (const auto& [name, value] : last_) measure_->knew(value);
}

std::optional<SourceMeasure> HearingThread::measured() const {
    const std::lock_guard lock(mutex_);
    return measure_;
}

void HearingThread::triggers(std::vector<InputRow> rows, std::function<void(std::size_t)> happened) {
    const std::lock_guard lock(mutex_);
    // A button that is pressed has happened.
    if (rows != triggers_.rows()) triggers_ = InputTriggers(std::move(rows));
    happened_ = std::move(happened);
}

std::vector<InputMeter> HearingThread::triggerMeters() const {
    const std::lock_guard lock(mutex_);
    std::vector<InputMeter> meters;
    for (std::size_t i = 0; i < triggers_.rows().size(); ++i) meters.push_back(triggers_.meter(i));
    return meters;
}

std::optional<ControlLearner::Found> HearingThread::learned() const {
    const std::lock_guard lock(mutex_);
    return learner_ ? learner_->found(now()) : std::nullopt;
}

std::int64_t HearingThread::now() const { return std::chrono::duration_cast<std::chrono::nanoseconds>(InputListener::Clock::now() - start_).count(); }

void HearingThread::run() {
    if (sources_.empty()) return;
    over_ = false;
    thread_ = std::thread([this] { serve(); });
}

void HearingThread::stop() {
    if (!thread_.joinable()) return;
    over_ = true;
    thread_.join();
}

void HearingThread::serve() {
    while (!over_) {
        listener_.hear(start_, InputListener::Clock::now() + kSlice, [this] { return over_.load(); },
                       [this](std::size_t source, std::int64_t nanoseconds, std::span<const std::byte> bytes) { take(source, nanoseconds, bytes); });
        double felt = 0.0;
        {
            const std::lock_guard lock(mutex_);
            if (feed_) felt = feed_->takeFelt();
            for (std::size_t i = 0; i < sources_.size(); ++i) {
                sources_[i].tooLong = listener_.tooLong(i);
                sources_[i].device = listener_.ports()[i]->device();
            }
        }
        if (felt > 0.0)
            for (const auto& port : listener_.ports()) port->shake(felt);
    }
}

void HearingThread::remember(const InputValue& value) {
    const std::uint64_t name = hashOfNames(value.source.text(), value.channel.text());
    if (value.gone) last_.erase(name);
    else if (last_.size() < kMostRemembered || last_.contains(name)) last_.insert_or_assign(name, value);
}

bool HearingThread::admits(Source& source, std::uint64_t sender, std::int64_t nanoseconds) {
    const auto end = source.senders.begin() + static_cast<std::ptrdiff_t>(source.known);
    auto place = std::find_if(source.senders.begin(), end, [&](const Sender& s) { return s.id == sender; });
    if (place == end) place = std::find_if(source.senders.begin(), end, [&](const Sender& s) { return nanoseconds - s.last >= kGone; });
    if (place == end) {
        if (source.known == kMostSenders) return false;
        ++source.known;
    }
    *place = {sender, nanoseconds};
    return true;
}

void HearingThread::take(std::size_t index, std::int64_t nanoseconds, std::span<const std::byte> bytes) {
    const std::lock_guard lock(mutex_);
    Source& source = sources_[index];
    if (!admits(source, listener_.ports()[index]->sender(), nanoseconds)) {
        ++source.refused;
        return;
    }
    bool asked = false;
    values_.clear();
    source.decoder->decode(bytes, nanoseconds, [&](const InputValue& value) {
        asked = asked || value.channel.text() == InputListener::kListAddress;
        values_.push_back(value);
    });
    if (asked) listener_.answerList(index, [this] { return names_; });
    for (const InputValue& value : values_) remember(value);
    for (const InputValue& value : values_)
        for (const std::size_t row : triggers_.take(value)) happened_(row);
    if (learner_)
        for (const InputValue& value : values_) learner_->hear(value);
    if (measure_)
        for (const InputValue& value : values_) measure_->hear(value);
    if (feed_ && !held_ && !values_.empty() && !feed_->give(values_)) ++source.lost;
}

}  // namespace imomushi
