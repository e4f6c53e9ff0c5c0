// SPDX-License-Identifier: GPL-3.0-or-later
// Game controllers by SDL: they are virtual ones of SDL's own.
#include <doctest/doctest.h>

#include <csignal>
#include <filesystem>
#include <functional>

#include "core/input/devices.h"
#include "core/input/input_listener.h"
#include "core/input/pad_packet.h"
#include "core/input/pad_port.h"
#include "tests/support/virtual_pad.h"

using namespace imomushi;

namespace {

using Records = std::vector<std::array<std::byte, PadPacket::kBytes>>;

/// What a port has to say now.
Records heardFrom(InputPort& port) {
    Records records;
    std::array<std::byte, InputDecoder::kLongestPacket> room{};
    while (const auto size = port.take(room)) {
        REQUIRE(*size % PadPacket::kBytes == 0);
        for (std::size_t i = 0; i < *size; i += PadPacket::kBytes) std::copy_n(room.begin() + static_cast<std::ptrdiff_t>(i), PadPacket::kBytes, records.emplace_back().begin());
    }
    return records;
}

std::unique_ptr<InputPort> opened(std::string_view wanted = {}) {
    auto port = openDevice(InputProtocol::Pad, wanted);
    REQUIRE(port);
    return std::move(*port);
}

std::size_t threads() {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator("/proc/self/task"), std::filesystem::directory_iterator()));
}

}  // namespace

TEST_CASE("pad: which one it is goes through a text; the same GUID is nearer than the same maker and name, others are others") {
    const PadId usb{"030000005e0400008e02000014010000", 0x045e, 0x028e, "Xbox 360 Controller"};
    PadId bluetooth = usb;
    bluetooth.guid = "050000005e0400008e02000030110000";
    CHECK(usb.text() == "030000005e0400008e02000014010000 045e:028e Xbox 360 Controller");
    CHECK(likeness(usb.text(), usb) > likeness(usb.text(), bluetooth));
    CHECK(likeness(usb.text(), bluetooth) > 0);
    CHECK(likeness("Xbox 360 Controller", usb) > 0);
    CHECK(likeness("", usb) > 0);
    PadId other = bluetooth;
    other.product = 1;
    CHECK(likeness(usb.text(), other) == 0);
    other = bluetooth;
    other.name = "Another";
    CHECK(likeness(usb.text(), other) == 0);
    CHECK(likeness("Xbox", usb) == 0);
}

TEST_CASE("pad: a port waits for its pad, hears it when it is plugged in, says when it is plugged out, and takes it back") {
    const auto port = opened();
    CHECK(heardFrom(*port).empty());
    CHECK(port->device().empty());
    CHECK(pluggedDevices(InputProtocol::Pad).empty());
    VirtualPad pad;
    CHECK(pluggedDevices(InputProtocol::Pad).size() == 1);
    CHECK(pluggedDevices(InputProtocol::Pad)[0].name == VirtualPad::kName);
    CHECK(heardFrom(*port).empty());  // that it is there moves nothing
    port->shake(0.5);
    CHECK(pad.rumble() == doctest::Approx(65535 / 2).epsilon(0.01));
    port->shake(7.0);
    CHECK(pad.rumble() == 65535);
    const auto shaken = std::chrono::steady_clock::now();
    while (pad.rumble() > 0 && std::chrono::steady_clock::now() - shaken < std::chrono::seconds(10)) (void)heardFrom(*port);
    CHECK(pad.rumble() == 0);  // a moment later
    CHECK(port->device() == VirtualPad::kName);
    pad.axis(SDL_CONTROLLER_AXIS_LEFTX, 20000);
    pad.axis(SDL_CONTROLLER_AXIS_TRIGGERRIGHT, 32767);
    pad.button(SDL_CONTROLLER_BUTTON_A, true);
    CHECK(heardFrom(*port) == Records{PadPacket::of(PadPacket::kAxis, 0, 20000), PadPacket::of(PadPacket::kAxis, 5, 32767), PadPacket::of(PadPacket::kButton, 0, 1)});
    // What was held when it left is not let go: it is gone.
    pad.unplug();
    CHECK(heardFrom(*port) == Records{PadPacket::of(PadPacket::kGone, 0, 0)});
    CHECK(port->device().empty());
    CHECK(pluggedDevices(InputProtocol::Pad).empty());
    pad.plug();
    CHECK(heardFrom(*port).empty());
    CHECK(port->device() == VirtualPad::kName);
    pad.axis(SDL_CONTROLLER_AXIS_LEFTY, -9000);
    CHECK(heardFrom(*port) == Records{PadPacket::of(PadPacket::kAxis, 1, -9000)});
}

TEST_CASE("pad: each of two ports has a pad of its own; one that wants a certain pad gets it, one that wants another waits") {
    VirtualPad first, second;
    const auto any = opened(), certain = opened(pluggedDevices(InputProtocol::Pad)[0].device), other = opened("Some other pad");
    for (const auto* port : {&any, &certain, &other}) CHECK(heardFrom(**port).empty());
    CHECK(any->device() == VirtualPad::kName);
    CHECK(certain->device() == VirtualPad::kName);
    CHECK(other->device().empty());
    first.axis(0, 12345);
    second.axis(0, 23456);
    const Records one = heardFrom(*certain), two = heardFrom(*any);
    REQUIRE(one.size() == 1);
    REQUIRE(two.size() == 1);
    CHECK(one != two);
    CHECK(heardFrom(*other).empty());
}

TEST_CASE("pad: asking for pads starts no thread, takes no signal, and leaves SDL when the last port is closed") {
    const std::size_t before = threads();
    struct sigaction kept {};
    ::sigaction(SIGINT, nullptr, &kept);
    {
        const auto port = opened();
        CHECK(heardFrom(*port).empty());
        CHECK((SDL_WasInit(0) & (SDL_INIT_VIDEO | SDL_INIT_AUDIO | SDL_INIT_HAPTIC | SDL_INIT_SENSOR)) == 0);
        CHECK(SDL_WasInit(SDL_INIT_GAMECONTROLLER) != 0);
        CHECK(threads() == before);
    }
    CHECK(SDL_WasInit(SDL_INIT_GAMECONTROLLER) == 0);
    struct sigaction now {};
    ::sigaction(SIGINT, nullptr, &now);
    CHECK((now.sa_handler == kept.sa_handler));
}

TEST_CASE("pad: a listener hears pads and ports side by side, with times") {
    VirtualPad pad;
    std::vector<std::unique_ptr<InputPort>> ports;
    ports.push_back(opened());
    CHECK(heardFrom(*ports[0]).empty());
    InputListener listener(std::move(ports));
    const auto start = InputListener::Clock::now();
    std::vector<std::int64_t> times;
    for (int i = 0; i < 3; ++i) {
        pad.axis(0, 5000 * (i + 1));
        listener.hear(start, InputListener::Clock::now() + std::chrono::milliseconds(30), [] { return false; }, [&](std::size_t, std::int64_t nanoseconds, std::span<const std::byte> bytes) {
            CHECK(bytes.size() == PadPacket::kBytes);
            times.push_back(nanoseconds);
        });
    }
    REQUIRE(times.size() == 3);
    CHECK(std::ranges::is_sorted(times));
}
