// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/input/udp_target.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace imomushi {

UdpTarget::UdpTarget(UdpTarget&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}
UdpTarget& UdpTarget::operator=(UdpTarget&& other) noexcept {
    std::swap(socket_, other.socket_);
    return *this;
}
UdpTarget::~UdpTarget() {
    if (socket_ >= 0) ::close(socket_);
}

Result<UdpTarget> UdpTarget::open(const std::string& host, std::uint16_t port) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    if (port == 0) return fail("bad-value", "Port 0 cannot be sent to: give the port on which the other program listens, such as 39539.");
    if (::inet_pton(AF_INET, host == "localhost" ? "127.0.0.1" : host.c_str(), &to.sin_addr) != 1) return fail("no-address", "\"" + host + "\" is no address: give one such as 192.168.1.20, or localhost.");
    UdpTarget made(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    if (made.socket_ < 0 || ::connect(made.socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
        return fail("cannot-send", "Nothing can be sent to " + host + " (" + std::strerror(errno) + "): choose another address, or look at the network.");
    return made;
}

bool UdpTarget::send(std::span<const std::byte> bytes) const { return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size()); }

}  // namespace imomushi
