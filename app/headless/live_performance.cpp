// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/headless/live_performance.h"

#include <algorithm>
#include <utility>

#include "core/commands/meetings.h"
#include "core/document/command_support.h"
#include "core/document/names.h"

namespace imomushi {

namespace {

Json quaternion(const Eigen::Quaterniond& q) { return Json::array({q.x(), q.y(), q.z(), q.w()}); }

}  // namespace

LivePerformance::LivePerformance(SessionAccess& access, std::vector<RawSource> sources, double seconds, InputDriver driver)
    : access_(&access), sources_(std::move(sources)), driver_(std::move(driver)), seconds_(seconds), known_(access.document().effects[EffectKind::Contact].elements) {
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
        if (!driver_.take(value) && asked && value.channel.text() == kListAddress) asked();
    });
}

Result<void> LivePerformance::step(const Progress& progress) {
    LiveCharacter& live = access_->live;
    for (const LiveInput& input : driver_.step(seconds_)) {
        const auto known = std::find_if(driven_.begin(), driven_.end(), [&](const LiveInput& d) { return d.sameTarget(input); });
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

Result<Json> LivePerformance::execute(const Json& command, const Progress& progress) {
    if (!std::exchange(changed_, true)) access_->beginStep();
    return access_->execute(command, progress);
}

Result<void> LivePerformance::hold(const LiveInput& input, const Progress& progress) {
    LiveCharacter& live = access_->live;
    Json command{{"do", "drag"}};
    HandlePose shown;
    if (input.kind == LiveInput::Kind::Handle) {
        const FaceRef& handle = live.plan().handles[static_cast<std::size_t>(input.handle)];
        IMOMUSHI_TRY(shown, live.poseOf(handle));
        command["endpoint"] = handle.face;
        command["rotation"] = quaternion(shown.rotation);
    } else if (input.kind == LiveInput::Kind::End) {
        IMOMUSHI_TRY(shown.at, live.positionOf(input.end));
        command["endpoint"] = endpointText(access_->document(), input.end);
    } else {
        return {};  // needs no hold
    }
    command["to"] = json(shown.at);
    if (auto ok = execute(command, progress); !ok) return tl::unexpected(ok.error());
    driver_.hold(input, shown.at, shown.rotation, 0.0);
    return {};
}

void LivePerformance::cancel() noexcept {
    if (std::exchange(changed_, false)) access_->cancelStep();
}

Result<Json> LivePerformance::end(const Progress& progress) {
    const Document& document = access_->document();
    for (const LiveInput& input : driven_) {
        Json command;
        if (input.kind == LiveInput::Kind::Morph) {
            const CharacterSource& character = *document.characters.at(input.morph.character);
            command = {{"do", "morph"}, {"character", character.name}, {"target", character.model->morphs[static_cast<std::size_t>(input.morph.target)].name}, {"weight", input.weight}};
        } else if (input.kind == LiveInput::Kind::Handle) {
            command = {{"do", "drag"}, {"endpoint", access_->live.plan().handles[static_cast<std::size_t>(input.handle)].face}, {"to", json(input.target)}, {"rotation", quaternion(input.rotation)}};
        } else {
            command = {{"do", "drag"}, {"endpoint", endpointText(document, input.end)}, {"to", json(input.target)}};
            if (input.hasRoll) command["roll"] = input.roll;
        }
        if (auto ok = execute(command, progress); !ok) return tl::unexpected(ok.error());
    }
    if (changed_) access_->endStep({"live", {}});
    access_->changedPose();
    Json answer{{"frames", steps_}, {"seconds", static_cast<double>(steps_) * seconds_}, {"sources", Json::array()}};
    for (std::size_t i = 0; i < sources_.size(); ++i) {
        const InputCounts& counts = decoders_[i]->counts();
        answer["sources"].push_back({{"name", sources_[i].name}, {"protocol", protocolName(sources_[i].protocol)}, {"packets", counts.packets}, {"values", counts.values}, {"ignored", counts.ignored}, {"malformed", counts.malformed}});
    }
    if (!met_.empty()) answer["met"] = met_;
    return answer;
}

}  // namespace imomushi
