// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/input/input_port.h"
#include "core/input/voice_analyser.h"

namespace imomushi {

/// A microphone that is waited for, and heard while it is plugged in: its packets are VoicePacket, a hundred a second. SDL records it; sound itself is kept nowhere.
class VoicePort final : public InputPort {
public:
    /// See openDevice(). Errors: "no-devices".
    static Result<std::unique_ptr<VoicePort>> open(std::string_view wanted);
    ~VoicePort() override;
    VoicePort(const VoicePort&) = delete;
    VoicePort& operator=(const VoicePort&) = delete;

    std::optional<std::size_t> take(std::span<std::byte> room) override;
    [[nodiscard]] std::string device() const override { return name_; }

private:
    using Clock = std::chrono::steady_clock;
    class Sound;
    VoicePort(std::shared_ptr<Sound> sound, std::string_view wanted);
    /// Opens the device where it is not, now and then.
    void look();

    std::shared_ptr<Sound> sound_;
    std::string wanted_, name_;       // name_: of what is heard; empty: nothing is
    unsigned device_ = 0;             // of SDL, 0: none
    Clock::time_point looked_{};
    Clock::duration waits_ = std::chrono::seconds(1), failed_ = std::chrono::seconds(1);  // until it looks again; after it could not open
    VoiceAnalyser analyser_;
    std::array<float, VoiceAnalyser::kHop> samples_{};
    friend std::vector<std::string> pluggedMicrophones();
};

/// Names of those that are plugged in, in the order of SDL. Empty where there is no sound at all.
std::vector<std::string> pluggedMicrophones();

}  // namespace imomushi
