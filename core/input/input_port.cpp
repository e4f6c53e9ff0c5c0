// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/input/input_port.h"

#include <poll.h>

#include <algorithm>
#include <array>

namespace imomushi {

namespace {

constexpr std::size_t kMostPorts = 64;

}  // namespace

void InputPort::wait(std::span<const std::unique_ptr<InputPort>> ports, std::chrono::steady_clock::time_point until) {
    std::array<pollfd, kMostPorts> all{};
    std::size_t count = 0;
    bool asks = false;
    for (const auto& port : ports) {
        if (const int file = port->descriptor(); file < 0) asks = true;
        else if (count < kMostPorts) all[count++] = {file, POLLIN, 0};
    }
    auto left = std::chrono::ceil<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
    if (asks) left = std::min(left, kBetweenAsks);
    if (left.count() > 0) (void)::poll(all.data(), count, static_cast<int>(left.count()));
}

}  // namespace imomushi
