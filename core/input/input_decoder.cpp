// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/input/input_decoder.h"

#include "core/base/utf8.h"
#include "core/input/decoders.h"

namespace imomushi {

namespace {

constexpr std::array<std::string_view, kInputProtocols> kProtocols = {"osc", "vmc", "midi", "pad", "keys", "voice"};

}  // namespace

std::string_view protocolName(InputProtocol protocol) { return kProtocols[static_cast<std::size_t>(protocol)]; }

std::optional<InputProtocol> protocolNamed(std::string_view name) {
    const auto found = std::find(kProtocols.begin(), kProtocols.end(), name);
    if (found == kProtocols.end()) return std::nullopt;
    return static_cast<InputProtocol>(found - kProtocols.begin());
}

void InputDecoder::decode(std::span<const std::byte> packet, std::int64_t nanoseconds, const InputSink& sink) {
    ++counts_.packets;
    values_.clear();
    ignored_ = 0;
    if (packet.empty() || packet.size() > kLongestPacket || !read(packet)) {
        ++counts_.malformed;
        return;
    }
    accept();
    counts_.ignored += ignored_;
    counts_.values += values_.size();
    for (InputValue& value : values_) {
        value.nanoseconds = nanoseconds;
        sink(value);
    }
}

bool InputDecoder::add(std::string_view channel, std::span<const double> numbers) {
    if (channel.empty() || !InputName::fits(channel) || !isUtf8(channel) || numbers.empty() || numbers.size() > InputValue::kMost || values_.size() == kMostValues) return false;
    for (const double number : numbers)
        if (!InputValue::isSound(number)) return false;
    InputValue& value = values_.emplace_back();
    value.source = source_;
    value.channel = InputName(channel);
    std::copy(numbers.begin(), numbers.end(), value.numbers.begin());
    value.count = static_cast<int>(numbers.size());
    return true;
}

bool InputDecoder::addGone(std::string_view channel) {
    const double nothing = 0.0;
    if (!add(channel, std::span(&nothing, 1))) return false;
    values_.back().gone = true;
    return true;
}

std::unique_ptr<InputDecoder> makeInputDecoder(InputProtocol protocol, std::string_view source) {
    switch (protocol) {
        case InputProtocol::Osc: return makeOscDecoder(source);
        case InputProtocol::Vmc: return makeVmcDecoder(source);
        case InputProtocol::Midi: return makeMidiDecoder(source);
        case InputProtocol::Pad: return makePadDecoder(source);
        case InputProtocol::Keys: return makeKeyDecoder(source);
        case InputProtocol::Voice: return makeVoiceDecoder(source);
    }
    return nullptr;
}

}  // namespace imomushi
