// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/input/devices.h"

#include "core/base/try.h"
#include "core/input/key_port.h"
#include "core/input/midi_port.h"
#include "core/input/pad_port.h"
#include "core/input/voice_port.h"

namespace imomushi {

std::vector<PluggedDevice> pluggedDevices(InputProtocol protocol) {
    std::vector<PluggedDevice> devices;
    if (protocol == InputProtocol::Pad)
        for (const PadId& pad : pluggedPads()) devices.push_back({pad.text(), pad.name});
    if (protocol == InputProtocol::Midi)
        if (const auto midi = MidiSystem::ofThisMachine())
            for (const std::string& name : (*midi)->names()) devices.push_back({plainMidiName(name), plainMidiName(name)});
    if (protocol == InputProtocol::Voice)
        for (const std::string& name : pluggedMicrophones()) devices.push_back({name, name});
    return devices;
}

std::string deviceName(InputProtocol protocol, std::string_view wanted) { return std::string(protocol == InputProtocol::Pad ? PadId::nameIn(wanted) : wanted); }

Result<std::unique_ptr<InputPort>> openDevice(InputProtocol protocol, std::string_view wanted) {
    if (protocol == InputProtocol::Midi) {
        IMOMUSHI_TRY(auto midi, MidiSystem::ofThisMachine());
        return std::unique_ptr<InputPort>(std::make_unique<MidiPort>(std::move(midi), wanted));
    }
    if (protocol == InputProtocol::Keys) {
        IMOMUSHI_TRY(auto keys, KeyPort::open());
        return std::unique_ptr<InputPort>(std::move(keys));
    }
    if (protocol == InputProtocol::Voice) {
        IMOMUSHI_TRY(auto voice, VoicePort::open(wanted));
        return std::unique_ptr<InputPort>(std::move(voice));
    }
    IMOMUSHI_TRY(auto pad, PadPort::open(wanted));
    return std::unique_ptr<InputPort>(std::move(pad));
}

}  // namespace imomushi
