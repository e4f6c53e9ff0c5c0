// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstddef>
#include <optional>
#include <cstdint>
#include <string>

namespace imomushi {

/// Sends datagrams to a port of this machine, as another program does, and hears what is answered.
class UdpSender {
public:
    explicit UdpSender(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
        to_.sin_family = AF_INET;
        to_.sin_port = htons(port);
        to_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    }
    ~UdpSender() { ::close(socket_); }
    UdpSender(const UdpSender&) = delete;
    UdpSender& operator=(const UdpSender&) = delete;
    void send(const std::string& bytes) const { (void)::sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to_), sizeof to_); }
    [[nodiscard]] std::optional<std::string> answer() const {
        std::string room(65536, '\0');
        const ssize_t size = ::recv(socket_, room.data(), room.size(), MSG_DONTWAIT);
        if (size < 0) return std::nullopt;
        room.resize(static_cast<std::size_t>(size));
        return room;
    }

private:
    int socket_;
    sockaddr_in to_{};
};

}  // namespace imomushi
