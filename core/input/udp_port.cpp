// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/input/udp_port.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

namespace imomushi {

namespace {

/// Of the system for each port: a quarter of a second of two senders that put every value into a datagram of its own.
constexpr int kBufferBytes = 4 << 20;

}  // namespace

UdpPort::UdpPort(UdpPort&& other) noexcept : socket_(std::exchange(other.socket_, -1)), port_(other.port_), sender_(other.sender_), senderPort_(other.senderPort_) {}
UdpPort& UdpPort::operator=(UdpPort&& other) noexcept {
    std::swap(socket_, other.socket_);
    std::swap(port_, other.port_);
    std::swap(sender_, other.sender_);
    std::swap(senderPort_, other.senderPort_);
    return *this;
}
UdpPort::~UdpPort() {
    if (socket_ >= 0) ::close(socket_);
}

Result<UdpPort> UdpPort::listen(std::uint16_t port, From from) {
    const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (socket < 0) return fail("no-port", std::string("A port could not be made (") + std::strerror(errno) + "): close other programs that use the network.");
    UdpPort made(socket, port);
    (void)::setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &kBufferBytes, sizeof kBufferBytes);  // the system may give less
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(from == From::Loopback ? INADDR_LOOPBACK : INADDR_ANY);
    if (::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
        if (errno == EADDRINUSE) return fail("port-taken", "Port " + std::to_string(port) + " is used by another program: close that one, or choose another port here and in the sender.");
        return fail("no-port", "Port " + std::to_string(port) + " cannot be opened (" + std::strerror(errno) + "): choose one from 1024 on.");
    }
    socklen_t size = sizeof address;
    if (::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) == 0) made.port_ = ntohs(address.sin_port);
    return made;
}

std::optional<std::size_t> UdpPort::take(std::span<std::byte> room) {
    sockaddr_in from{};
    socklen_t length = sizeof from;
    const ssize_t size = ::recvfrom(socket_, room.data(), room.size(), MSG_TRUNC, reinterpret_cast<sockaddr*>(&from), &length);
    if (size < 0) return std::nullopt;
    sender_ = from.sin_addr.s_addr;
    senderPort_ = from.sin_port;
    return static_cast<std::size_t>(size);
}

bool UdpPort::answer(std::span<const std::byte> bytes) {
    if (senderPort_ == 0 || (ntohl(sender_) >> 24) != 127) return false;
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = senderPort_;
    to.sin_addr.s_addr = sender_;
    return ::sendto(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&to), sizeof to) == static_cast<ssize_t>(bytes.size());
}

}  // namespace imomushi
