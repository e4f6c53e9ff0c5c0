// SPDX-License-Identifier: GPL-3.0-or-later
// MIDI devices: they are pretended by a system of this test.
#include <doctest/doctest.h>

#include <array>
#include <deque>
#include <map>

#include "core/input/devices.h"
#include "core/input/midi_port.h"

using namespace imomushi;

namespace {

using Message = std::vector<std::uint8_t>;

struct PretendedMidi final : MidiSystem {
    std::vector<std::string> there;
    std::map<std::string, std::deque<Message>> said;
    int open_ = 0;
    struct Input final : MidiInput {
        PretendedMidi& of;
        std::string name;
        Input(PretendedMidi& system, std::string called) : of(system), name(std::move(called)) { ++of.open_; }
        ~Input() override { --of.open_; }
        bool take(std::vector<std::uint8_t>& message) override {
            auto& waiting = of.said[name];
            if (waiting.empty()) return false;
            message = waiting.front();
            waiting.pop_front();
            return true;
        }
    };
    std::vector<std::string> names() override { return there; }
    std::unique_ptr<MidiInput> open(std::size_t place) override { return std::make_unique<Input>(*this, there.at(place)); }
};

Message saidBy(InputPort& port, std::size_t size = InputDecoder::kLongestPacket) {
    std::vector<std::byte> room(size);
    const auto count = port.take(room);
    Message bytes;
    for (std::size_t i = 0; i < count.value_or(0); ++i) bytes.push_back(std::to_integer<std::uint8_t>(room[i]));
    return bytes;
}

constexpr const char* kKnobs = "nanoKONTROL2:nanoKONTROL2 MIDI 1 20:0";

}  // namespace

TEST_CASE("midi port: it waits for its device, hears it while it is there, says when it is gone, and opens it again under another number") {
    const auto midi = std::make_shared<PretendedMidi>();
    midi->there = {"Midi Through:Midi Through Port-0 14:0"};
    MidiPort port(midi, "", std::chrono::milliseconds(0));
    CHECK(saidBy(port).empty());
    CHECK(port.device().empty());
    CHECK(midi->open_ == 0);
    midi->there.push_back(kKnobs);
    midi->said[kKnobs] = {{0xB0, 7, 64}, {0x90, 60, 100}};
    CHECK(saidBy(port) == Message{0xB0, 7, 64, 0x90, 60, 100});
    CHECK(port.device() == "nanoKONTROL2 MIDI 1");
    CHECK(midi->open_ == 1);
    CHECK(saidBy(port).empty());
    midi->there.pop_back();
    CHECK(saidBy(port) == Message{0xFF});
    CHECK(port.device().empty());
    CHECK(midi->open_ == 0);
    const std::string again = "nanoKONTROL2:nanoKONTROL2 MIDI 1 28:0";
    midi->there.push_back(again);
    midi->said[again] = {{0xB0, 7, 1}};
    CHECK(saidBy(port) == Message{0xB0, 7, 1});
}

TEST_CASE("midi port: a certain device is known by its name without numbers; what finds no room waits, and a message that no packet could have is left out") {
    CHECK(plainMidiName(kKnobs) == "nanoKONTROL2 MIDI 1");
    CHECK(plainMidiName("Synth:out 129:3") == "Synth:out");
    CHECK(plainMidiName("system:midi_capture_1") == "system:midi_capture_1");
    CHECK(plainMidiName("") == "");
    const auto midi = std::make_shared<PretendedMidi>();
    midi->there = {"Other:Other MIDI 1 16:0", kKnobs};
    MidiPort port(midi, "nanoKONTROL2 MIDI 1", std::chrono::milliseconds(0));
    midi->said[kKnobs] = {{0xB0, 7, 1}, {0xB0, 7, 2}, Message(9, 0xF0), {0xB0, 7, 3}};
    CHECK(saidBy(port, 4) == Message{0xB0, 7, 1});
    CHECK(saidBy(port, 4) == Message{0xB0, 7, 2});
    CHECK(saidBy(port, 4) == Message{0xB0, 7, 3});
    CHECK(port.device() == "nanoKONTROL2 MIDI 1");
}

TEST_CASE("midi port: what a packet has fits a decoder, however much comes at once") {
    const auto midi = std::make_shared<PretendedMidi>();
    midi->there = {kKnobs};
    for (int i = 0; i < 3000; ++i) midi->said[kKnobs].push_back({0xB0, static_cast<std::uint8_t>(32 * (i % 2)), static_cast<std::uint8_t>(i % 128)});
    MidiPort port(midi, "", std::chrono::milliseconds(0));
    const auto decoder = makeInputDecoder(InputProtocol::Midi, "midi");
    for (Message bytes = saidBy(port); !bytes.empty(); bytes = saidBy(port)) decoder->decode(std::as_bytes(std::span(bytes)), 0, [](const InputValue&) {});
    CHECK(decoder->counts().malformed == 0);
    CHECK(decoder->counts().values > 3000);
}

TEST_CASE("midi port: without a system for it nothing is there, and a source is told so") {
    (void)pluggedDevices(InputProtocol::Midi);  // whatever this machine has
    const auto opened = openDevice(InputProtocol::Midi, "no such device");
    if (!opened) CHECK(opened.error().code == "no-devices");
    else CHECK((*opened)->device().empty());
}
