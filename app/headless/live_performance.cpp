// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/headless/live_performance.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/base/try.h"
#include "core/commands/meetings.h"
#include "core/input/input_listener.h"
#include "core/session/hold_inputs.h"

namespace imomushi {

LivePerformance::LivePerformance(SessionAccess& access, std::vector<RawSource> sources, double seconds, InputDriver driver)
    : access_(&access), sources_(std::move(sources)), driver_(std::move(driver)), seconds_(seconds), known_(access.document().effects[EffectKind::Contact].elements) {
    std::vector<std::size_t> places;
    std::vector<InputRow> rows;
    for (auto& [row, target] : triggerRows(access.document(), places)) {
        rows.push_back(std::move(row));
        happens_.push_back(target);
    }
    triggers_ = InputTriggers(std::move(rows));
    for (const RawSource& source : sources_) decoders_.push_back(makeInputDecoder(source.protocol, source.name));
}

Result<LivePerformance> LivePerformance::begin(SessionAccess& access, std::vector<RawSource> sources, double seconds) {
    IMOMUSHI_TRY(const auto alive, access.live.built());
    if (!alive) return fail("no-element", "There is no character to perform: open a project, or import one.");
    std::vector<std::string> osc;
    for (const RawSource& source : sources)
        if (source.protocol == InputProtocol::Osc) osc.push_back(source.name);
    InputDriver driver(access.document(), access.live.plan(), osc);
    access.live.hidePositions();
    return LivePerformance(access, std::move(sources), seconds, std::move(driver));
}

void LivePerformance::take(std::size_t source, std::int64_t nanoseconds, std::span<const std::byte> bytes, const std::function<void()>& asked) {
    decoders_[source]->decode(bytes, nanoseconds, [&](const InputValue& value) {
        // Takes are played where somebody sees them.
        for (const std::size_t row : triggers_.take(value))
            if (happens_[row].kind == MappedTarget::Kind::LetGo) driver_.letGo();
        if (!driver_.take(value) && asked && value.channel.text() == InputListener::kListAddress) asked();
    });
}

Result<void> LivePerformance::step(const Progress& progress) {
    LiveCharacter& live = access_->live;
    for (const LiveInput& input : driver_.step(seconds_)) {
        const auto known = std::find_if(driven_.begin(), driven_.end(), [&](const LiveInput& d) { return d.sameTarget(input); });
        // Undo leads back to what a number was before.
        if (input.isNumber() && known == driven_.end() && !std::exchange(changed_, true)) access_->beginStep();
        if (!live.apply(input)) {
            if (auto held = hold(input, progress); !held) return held;
        } else if (known == driven_.end()) {
            driven_.push_back(input);
        } else {
            *known = input;
        }
    }
    live.stepFrame(seconds_);
    ++steps_;
    return pressWhatMet(*access_, known_, met_, progress);
}

std::size_t LivePerformance::restingSteps() const {
    if (access_->live.inMotion()) return 0;
    return static_cast<std::size_t>(std::min(driver_.rests() / seconds_, static_cast<double>(std::numeric_limits<std::uint32_t>::max())));
}

void LivePerformance::rest(std::size_t steps) {
    driver_.pass(static_cast<double>(steps) * seconds_);
    steps_ += steps;
    rested_ += steps;
}

Result<Json> LivePerformance::execute(const Json& command, const Progress& progress) {
    if (!std::exchange(changed_, true)) access_->beginStep();
    return access_->execute(command, progress);
}

Result<void> LivePerformance::hold(const LiveInput& input, const Progress& progress) {
    IMOMUSHI_TRY(const auto hold, takingHoldOf(access_->session, input));
    if (!hold) return {};
    if (auto ok = execute(hold->command, progress); !ok) return tl::unexpected(ok.error());
    driver_.hold(hold->held);
    return {};
}

void LivePerformance::cancel() noexcept {
    if (std::exchange(changed_, false)) access_->cancelStep();
}

Result<Json> LivePerformance::end(const Progress& progress) {
    for (const LiveInput& input : driven_)
        if (auto ok = execute(leavingOf(access_->session, input), progress); !ok) return tl::unexpected(ok.error());
    if (changed_) access_->endStep({"live", {}});
    access_->changedPose();
    Json answer{{"frames", steps_}, {"rested", rested_}, {"seconds", static_cast<double>(steps_) * seconds_}, {"sources", Json::array()}};
    for (std::size_t i = 0; i < sources_.size(); ++i) {
        const InputCounts& counts = decoders_[i]->counts();
        answer["sources"].push_back({{"name", sources_[i].name}, {"protocol", protocolName(sources_[i].protocol)}, {"packets", counts.packets}, {"values", counts.values}, {"ignored", counts.ignored}, {"malformed", counts.malformed}});
    }
    if (!met_.empty()) answer["met"] = met_;
    return answer;
}

}  // namespace imomushi
