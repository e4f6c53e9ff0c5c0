// SPDX-License-Identifier: GPL-3.0-or-later
// All inputs at once, by the threads of the studio: OSC faster than anybody sends it and a tenth of it broken, a MIDI clock with notes and a knob, a pad that is plugged in and out, a hand, and a take that is recorded.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <random>
#include <thread>

#include "core/input/devices.h"
#include "core/input/midi_port.h"
#include "core/live/direct_names.h"
#include "core/live/hearing_thread.h"
#include "core/live/input_feed.h"
#include "tests/document/workbench.h"
#include "tests/support/osc_bytes.h"
#include "tests/support/udp_sender.h"
#include "tests/support/virtual_pad.h"

using namespace imomushi;
using namespace std::chrono_literals;

namespace {

using FloodClock = std::chrono::steady_clock;

constexpr int kPerSecond = 15'000, kPerBurst = kPerSecond / 500;

/// Of each sample; packaging/thorough.sh asks for an hour.
int floodSeconds() {
    const char* wanted = std::getenv("IMOMUSHI_FLOOD_SECONDS");
    return wanted ? std::max(4, std::atoi(wanted)) : 4;
}

/// A keyboard that sends its clock, 24 times a beat, notes and a knob, and whose cable is pulled now and then.
class Keyboard final : public MidiSystem {
public:
    std::vector<std::string> names() override {
        if (!plugged()) return {};
        return {"Keys:Keys MIDI 1 20:0"};
    }
    std::unique_ptr<MidiInput> open(std::size_t) override { return std::make_unique<Cable>(); }

private:
    static bool plugged() { return FloodClock::now().time_since_epoch() % 3s < 2500ms; }
    struct Cable final : MidiInput {
        FloodClock::time_point said = FloodClock::now();
        unsigned count = 0;
        bool take(std::vector<std::uint8_t>& message) override {
            if (FloodClock::now() < said || !plugged()) return false;
            said += 3ms;
            switch (++count % 7) {
                case 0: message = {0x90, static_cast<std::uint8_t>(60 + count % 12), 100}; break;
                case 3: message = {0x80, static_cast<std::uint8_t>(60 + count % 12), 0}; break;
                case 5: message = {0xB0, 7, static_cast<std::uint8_t>(count % 128)}; break;
                default: message = {0xF8}; break;
            }
            return true;
        }
    };
};

/// Something whole for any of these addresses, or one time in ten something broken.
std::string datagram(std::mt19937& random, const std::vector<DirectName>& names, double time) {
    const DirectName& name = names[random() % names.size()];
    std::vector<OscArgument> numbers;
    for (int i = 0; i < name.count; ++i) numbers.push_back(static_cast<float>(std::sin(2.0 * time + 7.0 * i + static_cast<double>(&name - names.data()))));
    std::string bytes = oscBytes(name.address, numbers);
    if (random() % 10 == 0) bytes.resize(random() % bytes.size() | 1U);
    return bytes;
}

void checkFlooded(const std::string& sample) {
    CAPTURE(sample);
    Workbench w;
    w.good({{"do", "open"}, {"path", IMOMUSHI_SAMPLES "/" + sample + ".imomushi"}});
    const std::vector<DirectName> names = directNames(w.session.document());
    REQUIRE(w.session.builtCharacter());
    const auto bone = std::ranges::find_if(names, [](const DirectName& name) { return name.address.ends_with("/end/position"); });
    REQUIRE(bone != names.end());
    std::string end = bone->address.substr(std::string_view("/imomushi/bone/").size());
    end.resize(end.size() - std::string_view("/position").size());
    w.good({{"do", "map-input"}, {"source", "midi"}, {"channel", "cc/1/7"}, {"target", "bone/" + end + "/x"}});
    w.good({{"do", "map-input"}, {"source", "pad"}, {"channel", "left-y"}, {"target", "bone/" + end + "/y"}, {"in", {-1, 1}}});
    const std::vector<std::string> direct{"osc"};
    const auto feed = std::make_shared<InputFeed>(InputDriver(w.session.document(), w.session.plan(), direct));
    w.session.perform([] {});
    REQUIRE(w.session.performInputs(feed));
    HearingThread thread;
    thread.feed(feed, nameMessages(w.session.document()));
    const auto port = thread.open({"osc", InputProtocol::Osc}, 0, UdpPort::From::Loopback);
    REQUIRE(port);
    auto pads = openDevice(InputProtocol::Pad, {});
    REQUIRE(pads);
    thread.open({"pad", InputProtocol::Pad}, std::move(*pads));
    thread.open({"midi", InputProtocol::Midi}, std::make_unique<MidiPort>(std::make_shared<Keyboard>(), "", 200ms));

    const FloodClock::time_point start = FloodClock::now(), over = start + std::chrono::seconds(floodSeconds());
    const auto since = [&] { return std::chrono::duration<double>(FloodClock::now() - start).count(); };
    std::atomic<std::uint64_t> sent = 0;
    std::thread flood([&] {
        std::mt19937 random(1);
        const UdpSender sender(*port);
        for (auto next = start; next < over; next += 2ms) {
            std::this_thread::sleep_until(next);
            for (int i = 0; i < kPerBurst; ++i, ++sent) sender.send(datagram(random, names, since()));
        }
    });
    std::thread player([&] {
        VirtualPad pad;
        for (int i = 0; FloodClock::now() < over; ++i) {
            std::this_thread::sleep_for(10ms);
            pad.axis(SDL_CONTROLLER_AXIS_LEFTY, 32767 - 1600 * (i % 40));
            if (i % 50 == 30) pad.unplug(), pad.plug();
        }
    });
    // The window: it takes frames, holds what inputs move, and a hand drags an end a third of the time.
    w.good({{"do", "record"}, {"take", "show"}, {"action", "start"}});
    std::uint64_t frames = 0, first = 0;
    LiveInput hand;
    hand.end = *w.session.document().endpoint(end);
    bool dragging = false, finite = true;
    while (FloodClock::now() < over) {
        std::this_thread::sleep_for(8ms);
        if (!w.session.holdInputs()) continue;
        if (const bool drags = std::fmod(since(), 1.5) > 1.0; drags != dragging) {
            dragging = drags;
            if (drags)
                w.session.beginGesture();
            else
                w.session.endGesture();
        }
        hand.target = Vec3(0.3 * std::sin(since()), 1.0, 0.3);
        if (dragging) (void)w.session.give(hand);
        if (!w.session.takeFrame()) continue;
        const std::uint64_t step = w.session.performed()->step;
        if (first == 0) first = step;
        frames = step - first;
        for (std::size_t e = 0; e < w.session.document().elements.size(); ++e) {
            const auto surface = w.session.character()->surface(static_cast<int>(e));
            finite = finite && std::all_of(surface.positions, surface.positions + 3 * surface.vertices, [](float x) { return std::isfinite(x); });
        }
    }
    if (dragging) w.session.endGesture();
    flood.join();
    player.join();
    const auto osc = *thread.heard("osc"), pad = *thread.heard("pad"), midi = *thread.heard("midi");
    for (const char* source : {"osc", "pad", "midi"}) thread.close(source);
    w.session.performInputs(nullptr);
    w.good({{"do", "record"}, {"take", "show"}, {"action", "stop"}});
    MESSAGE(sample << ": " << sent.load() << " datagrams, taken " << osc.counts.packets << ", malformed " << osc.counts.malformed << ", lost " << osc.lost << "; pad " << pad.counts.values << ", midi " << midi.counts.values << "; " << frames << " steps in " << floodSeconds() << " s");
    CHECK(finite);
    CHECK(frames > static_cast<std::uint64_t>(10 * floodSeconds()));
    CHECK(osc.counts.packets > sent / 2);
    CHECK(static_cast<double>(osc.counts.malformed) == doctest::Approx(0.1 * static_cast<double>(osc.counts.packets)).epsilon(0.3));
    CHECK(pad.counts.values > static_cast<std::uint64_t>(20 * floodSeconds()));
    CHECK(midi.counts.values > static_cast<std::uint64_t>(20 * floodSeconds()));
    CHECK(w.session.document().takes.size() >= 1);
    CHECK(w.good({{"do", "measure"}, {"what", "gap"}})["value"].get<double>() < 1e-6);
    // What was on its way is one history: back to the beginning, and again to here.
    const Json here = w.good({{"do", "list"}});
    const int steps = w.session.position();
    w.good({{"do", "undo"}, {"count", steps}});
    w.good({{"do", "redo"}, {"count", steps}});
    CHECK(w.good({{"do", "list"}})["held"].size() == here["held"].size());
}

}  // namespace

TEST_CASE("everything at once: the octopus stays finite and whole under OSC, MIDI, a pad that comes and goes, a hand and a take") { checkFlooded("octopus"); }
TEST_CASE("everything at once: the figure stays finite and whole under OSC, MIDI, a pad that comes and goes, a hand and a take") { checkFlooded("figure"); }
