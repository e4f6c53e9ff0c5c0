// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/result.h"
#include "core/input/input_port.h"

namespace imomushi {

/// A UDP port that is listened to. Datagrams wait in a buffer of the system, of some megabytes, until they are taken.
class UdpPort final : public InputPort {
public:
    /// Who may send: programs of this machine, or everybody who reaches it.
    enum class From { Loopback, Anywhere };
    /// `port` 0: any that is free. Errors: "port-taken", "no-port".
    static Result<UdpPort> listen(std::uint16_t port, From from = From::Loopback);
    UdpPort(UdpPort&& other) noexcept;
    UdpPort& operator=(UdpPort&& other) noexcept;
    ~UdpPort() override;

    [[nodiscard]] std::uint16_t port() const { return port_; }
    std::optional<std::size_t> take(std::span<std::byte> room) override;
    bool answer(std::span<const std::byte> bytes) override;
    /// Told apart by address and port.
    [[nodiscard]] std::uint64_t sender() const override { return std::uint64_t{sender_} << 16 | senderPort_; }
    [[nodiscard]] int descriptor() const override { return socket_; }

private:
    UdpPort(int socket, std::uint16_t port) : socket_(socket), port_(port) {}
    int socket_ = -1;
    std::uint16_t port_ = 0;
    std::uint32_t sender_ = 0;  // of what was taken last, as the network writes it
    std::uint16_t senderPort_ = 0;
};

}  // namespace imomushi
