// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace imomushi {

/// Where the packets of a source come from: a port of the network, or a device that may be plugged in and out meanwhile.
class InputPort {
public:
    virtual ~InputPort() = default;
    /// Copies the next packet to `room`. Returns its whole length; if that is more than room.size(), the packet was cut. Nullopt: no packet waits.
    virtual std::optional<std::size_t> take(std::span<std::byte> room) = 0;
    /// Whoever sent what was taken last, told apart from others. A device is one alone.
    [[nodiscard]] virtual std::uint64_t sender() const { return 0; }
    /// To whoever sent what was taken last, where that is a program of this machine. False: it is not, or it was not sent.
    virtual bool answer(std::span<const std::byte>) { return false; }
    /// Name of the device that is heard now; empty: none is plugged in, or this is none.
    [[nodiscard]] virtual std::string device() const { return {}; }
    /// Lets whoever holds the device feel something for a moment: 1 is as strong as it can, 0 nothing. Those that cannot do not.
    virtual void shake(double) {}
    /// A file descriptor that is readable while a packet waits; -1: there is none, take() must be polled.
    [[nodiscard]] virtual int descriptor() const { return -1; }

    /// Ports without a descriptor are asked so often.
    static constexpr std::chrono::milliseconds kBetweenAsks{4};
    /// Returns when one of the ports has a packet or must be asked, or at that time. At most 64 ports.
    static void wait(std::span<const std::unique_ptr<InputPort>> ports, std::chrono::steady_clock::time_point until);
};

}  // namespace imomushi
