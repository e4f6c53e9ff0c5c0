// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "core/base/result.h"

namespace imomushi {

/// Somebody who is sent datagrams of UDP. Sending waits for nobody: what finds no room in the system is lost.
class UdpTarget {
public:
    /// `host`: an address such as 192.168.1.20, or "localhost"; names are not looked up. Errors: "no-address", "bad-value" (port 0), "cannot-send".
    static Result<UdpTarget> open(const std::string& host, std::uint16_t port);
    UdpTarget(UdpTarget&& other) noexcept;
    UdpTarget& operator=(UdpTarget&& other) noexcept;
    ~UdpTarget();

    /// False: it was not sent. On this machine that also tells that nobody listened to what was sent before.
    bool send(std::span<const std::byte> bytes) const;

private:
    explicit UdpTarget(int socket) : socket_(socket) {}
    int socket_ = -1;
};

}  // namespace imomushi
