// SPDX-License-Identifier: GPL-3.0-or-later
// MIDI by RtMidi.
#include <RtMidi.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <system_error>

#include "core/input/midi_port.h"

namespace imomushi {

namespace {

constexpr const char* kClient = "Imomushi";
constexpr unsigned kMostHeld = 4096;  // messages

/// Which system answers: whoever asks one that is not there is told so on standard error, again and again.
std::optional<RtMidi::Api> systemHere() {
    if (::access("/dev/snd/seq", R_OK | W_OK) == 0) return RtMidi::LINUX_ALSA;
    std::error_code error;
    for (const auto& file : std::filesystem::directory_iterator("/dev/shm", error))  // sockets of JACK servers: "jack_default_0_0"
        if (const std::string name = file.path().filename().string(); name.starts_with("jack_") && file.is_socket(error)) return RtMidi::UNIX_JACK;
    return std::nullopt;
}

/// What goes wrong is seen by what is missing.
std::unique_ptr<RtMidiIn> made(RtMidi::Api api) {
    try {
        auto in = std::make_unique<RtMidiIn>(api, kClient, kMostHeld);
        in->setErrorCallback([](RtMidiError::Type, const std::string&, void*) {});
        return in;
    } catch (const RtMidiError&) {
        return nullptr;
    }
}

class RtInput final : public MidiInput {
public:
    explicit RtInput(std::unique_ptr<RtMidiIn> in) : in_(std::move(in)) {}
    bool take(std::vector<std::uint8_t>& message) override {
        (void)in_->getMessage(&message);
        return !message.empty();
    }

private:
    std::unique_ptr<RtMidiIn> in_;
};

class RtSystem final : public MidiSystem {
public:
    RtSystem(RtMidi::Api api, std::unique_ptr<RtMidiIn> asked) : api_(api), asked_(std::move(asked)) {}
    std::vector<std::string> names() override {
        std::vector<std::string> names;
        for (unsigned i = 0; i < asked_->getPortCount(); ++i) names.push_back(asked_->getPortName(i));
        return names;
    }
    std::unique_ptr<MidiInput> open(std::size_t place) override {
        auto in = made(api_);
        if (!in) return nullptr;
        in->openPort(static_cast<unsigned>(place), "in");
        if (!in->isPortOpen()) return nullptr;
        return std::make_unique<RtInput>(std::move(in));
    }

private:
    RtMidi::Api api_;
    std::unique_ptr<RtMidiIn> asked_;
};

}  // namespace

Result<std::shared_ptr<MidiSystem>> MidiSystem::ofThisMachine() {
    const auto api = systemHere();
    auto asked = api ? made(*api) : nullptr;
    if (!asked) return fail("no-devices", "MIDI devices cannot be had on this machine: neither ALSA's sequencer nor a JACK server answers.");
    return std::shared_ptr<MidiSystem>(std::make_shared<RtSystem>(*api, std::move(asked)));
}

}  // namespace imomushi
