// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/input/input_port.h"
#include "core/input/pad_id.h"

namespace imomushi {

/// A game controller that is waited for, and heard while it is plugged in: its packets are records of PadPacket. SDL reads it. SDL's game controllers are initialised while there is a port, and
/// polled by take(); nothing else of SDL is used.
class PadPort final : public InputPort {
public:
    /// See openDevice(). Errors: "no-devices".
    static Result<std::unique_ptr<PadPort>> open(std::string_view wanted);
    ~PadPort() override;
    PadPort(const PadPort&) = delete;
    PadPort& operator=(const PadPort&) = delete;

    /// All that the pad has said since, as one packet, so that both axes of a stick come together.
    std::optional<std::size_t> take(std::span<std::byte> room) override;
    [[nodiscard]] std::string device() const override;
    void shake(double strength) override;

private:
    class Hub;
    struct Pad;
    PadPort(std::shared_ptr<Hub> hub, std::string_view wanted);
    std::shared_ptr<Hub> hub_;
    std::unique_ptr<Pad> pad_;  // of the hub and its lock
    friend std::vector<PadId> pluggedPads();
};

/// Those that are plugged in, in the order of SDL. Empty where SDL has no game controllers at all.
std::vector<PadId> pluggedPads();

}  // namespace imomushi
