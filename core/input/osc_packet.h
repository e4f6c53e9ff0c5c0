// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace imomushi {

/// A message of Open Sound Control, as far as live input needs it. Its texts are in the packet.
struct OscMessage {
    static constexpr std::size_t kMost = 16;
    std::string_view address;
    /// Arguments that are no numbers and no texts (blobs, nothing, colours, times) are left out; what is in arrays counts like the rest.
    struct Argument {
        bool isText = false;
        double number = 0.0;  ///< true and false are 1 and 0
        std::string_view text;
    };
    std::array<Argument, kMost> arguments;
    std::size_t count = 0;
    bool more = false;  ///< it had more arguments than there is room for
};

/// Reads a packet of OSC 1.0, a message or a bundle of them. By hand: oscpack 1.1.0 reads beyond a message whose blob is longer than it. `take` says whether a message is sound. False: the packet or one of its messages is malformed, or bundles are nested deeper
/// than four times. Messages before the broken one were handed to `take` by then.
bool readOscPacket(std::span<const std::byte> packet, const std::function<bool(const OscMessage&)>& take);

/// Messages of OSC 1.0 in bundles that are to be taken at once. A buffer is kept, so that the next bundles take no memory.
class OscBundle {
public:
    static constexpr std::size_t kMostBytes = 1400;  ///< of a bundle of several messages: what one datagram carries in a usual network
    using Send = std::function<void(std::span<const std::byte>)>;

    /// `send` is called with each bundle until end().
    void begin(const Send& send);
    void message(std::string_view address) { put(address, {}, {}, {}); }
    void message(std::string_view address, std::int32_t number) { put(address, {}, number, {}); }
    void message(std::string_view address, std::initializer_list<float> numbers) { put(address, {}, {}, numbers); }
    void message(std::string_view address, std::string_view text, std::initializer_list<float> numbers) { put(address, text, {}, numbers); }
    void end();

private:
    void put(std::string_view address, std::optional<std::string_view> text, std::optional<std::int32_t> number, std::initializer_list<float> numbers);
    const Send* send_ = nullptr;
    std::string bytes_, message_;
};

/// A message of a text and a whole number.
std::string oscMessage(std::string_view address, std::string_view text, std::int32_t number);

}  // namespace imomushi
