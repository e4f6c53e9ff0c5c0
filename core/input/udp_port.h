// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/result.h"

namespace imomushi {

/// A UDP port that is listened to. Datagrams wait in a buffer of the system, of some megabytes, until they are taken.
class UdpPort {
public:
    /// Who may send: programs of this machine, or everybody who reaches it.
    enum class From { Loopback, Anywhere };
    /// `port` 0: any that is free. Errors: "port-taken", "no-port".
    static Result<UdpPort> listen(std::uint16_t port, From from = From::Loopback);
    UdpPort(UdpPort&& other) noexcept;
    UdpPort& operator=(UdpPort&& other) noexcept;
    ~UdpPort();

    [[nodiscard]] std::uint16_t port() const { return port_; }
    /// The next datagram, in `room`, and how long it is: longer than `room`, then it was cut. None waits: none.
    std::optional<std::size_t> take(std::span<std::byte> room);
    /// To whoever sent what was taken last, where that is a program of this machine. False: it is not, or it was not sent.
    bool answer(std::span<const std::byte> bytes);
    /// Whoever sent what was taken last, told apart from others by address and port.
    [[nodiscard]] std::uint64_t sender() const { return std::uint64_t{sender_} << 16 | senderPort_; }
    /// Returns when one of the ports has a datagram, or at that time. At most 64 ports.
    static void wait(std::span<const UdpPort> ports, std::chrono::steady_clock::time_point until);

private:
    UdpPort(int socket, std::uint16_t port) : socket_(socket), port_(port) {}
    int socket_ = -1;
    std::uint16_t port_ = 0;
    std::uint32_t sender_ = 0;  // of what was taken last, as the network writes it
    std::uint16_t senderPort_ = 0;
};

}  // namespace imomushi
