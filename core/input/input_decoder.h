// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/input/input_value.h"

namespace imomushi {

/// What the bytes of a source are.
enum class InputProtocol : std::uint8_t { Osc, Vmc, Midi, Pad, Keys, Voice };
inline constexpr std::size_t kInputProtocols = 6;
/// It is spoken by devices, not by programs that send to a port.
inline bool isOfDevices(InputProtocol protocol) { return protocol != InputProtocol::Osc && protocol != InputProtocol::Vmc; }
std::string_view protocolName(InputProtocol protocol);                      ///< "osc", "vmc", "midi", "pad", "keys", "voice"
std::optional<InputProtocol> protocolNamed(std::string_view name);

/// Turns the packets of one source into values. It trusts nothing: a packet that is broken anywhere changes nothing and is counted.
class InputDecoder {
public:
    static constexpr std::size_t kLongestPacket = 8192;  ///< bytes
    static constexpr std::size_t kMostValues = 1024;     ///< of one packet; one with more is dropped

    explicit InputDecoder(std::string_view source) : source_(source) {}
    virtual ~InputDecoder() = default;
    /// `nanoseconds`: when the packet came. `sink` is called for each value, in their order.
    void decode(std::span<const std::byte> packet, std::int64_t nanoseconds, const InputSink& sink);
    [[nodiscard]] const InputCounts& counts() const { return counts_; }
    /// A packet that was not read, as it is too long or there are too many.
    void drop() { ++counts_.packets, ++counts_.malformed; }

protected:
    /// Fills `values_` by add(), and ignored_. False: the packet is malformed.
    virtual bool read(std::span<const std::byte> packet) = 0;
    /// Keeps the state that read() has prepared: the packet was valid.
    virtual void accept() {}
    /// False: it is too long, has numbers that are not finite or too large, or the packet has too many.
    bool add(std::string_view channel, std::span<const double> numbers);
    /// The channel says nothing from now on. False: as add().
    bool addGone(std::string_view channel);
    void ignore() { ++ignored_; }

private:
    InputName source_;
    InputCounts counts_;
    std::vector<InputValue> values_;  // of the packet that is read
    std::uint64_t ignored_ = 0;
};

/// * "osc": a channel per address, its numbers are the numeric arguments; without arguments it is a trigger, 1. Bundles are taken apart, their time tags are not waited for.
/// * "vmc": the VMC protocol, see vmc_decoder.cpp.
/// * "midi": whole or divided messages with running status, see midi_decoder.cpp.
/// * "pad": what this program notes of game controllers, see pad_decoder.cpp.
/// * "keys": the keyboard, see key_decoder.cpp.
/// * "voice": a microphone, see voice_decoder.cpp.
std::unique_ptr<InputDecoder> makeInputDecoder(InputProtocol protocol, std::string_view source);

}  // namespace imomushi
