// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/input/input_port.h"

namespace imomushi {

/// A MIDI device that is open. It may be gone any time.
class MidiInput {
public:
    virtual ~MidiInput() = default;
    /// The next message, whole. False: there is none.
    virtual bool take(std::vector<std::uint8_t>& message) = 0;
};

/// What MIDI devices there are.
class MidiSystem {
public:
    virtual ~MidiSystem() = default;
    /// Names of all that can be heard, in the order of the system.
    virtual std::vector<std::string> names() = 0;
    /// The device of a place in names(). Null: it cannot be opened.
    virtual std::unique_ptr<MidiInput> open(std::size_t place) = 0;
    /// By RtMidi: ALSA's sequencer, where that is missing a JACK server that runs. Errors: "no-devices".
    static Result<std::shared_ptr<MidiSystem>> ofThisMachine();
};

/// A name without the numbers that the system gave it this time: "nanoKONTROL2:nanoKONTROL2 MIDI 1 20:0" is "nanoKONTROL2 MIDI 1".
std::string plainMidiName(std::string_view name);

/// A MIDI device that is waited for, and heard while it is plugged in. Its packets are messages, one after the other; 0xFF says that it was plugged out.
class MidiPort final : public InputPort {
public:
    /// Whether a device was plugged in or out is asked so often.
    static constexpr std::chrono::milliseconds kBetweenLooks{1000};
    /// `wanted`: a plain name; empty: the first one that is a device and no connection between programs.
    MidiPort(std::shared_ptr<MidiSystem> system, std::string_view wanted, std::chrono::milliseconds betweenLooks = kBetweenLooks)
        : system_(std::move(system)), wanted_(wanted), betweenLooks_(betweenLooks) {}
    std::optional<std::size_t> take(std::span<std::byte> room) override;
    [[nodiscard]] std::string device() const override { return name_; }

private:
    using Clock = std::chrono::steady_clock;
    /// Whether the device is there, or is there now.
    void look(bool& gone);
    std::shared_ptr<MidiSystem> system_;
    std::string wanted_, name_;   // name_: of the device that is open, empty: none is
    std::string place_;           // its name as the system gave it
    std::unique_ptr<MidiInput> input_;
    std::chrono::milliseconds betweenLooks_;
    Clock::time_point looked_{};
    std::vector<std::uint8_t> message_;
    bool waits_ = false;          // message_ found no room
};

}  // namespace imomushi
