// SPDX-License-Identifier: GPL-3.0-or-later
#include <chrono>
#include <thread>

#include "core/input/devices.h"
#include "core/live/direct_names.h"
#include "core/live/hearing_thread.h"
#include "core/live/input_feed.h"
#include "tests/document/workbench.h"
#include "tests/support/input_values.h"
#include "tests/support/osc_bytes.h"
#include "tests/support/udp_sender.h"
#include "tests/support/virtual_pad.h"

using namespace imomushi;
using namespace std::chrono_literals;

namespace {

/// Two bars; the end of the second one is driven by a control, and the bone is turned by another one.
struct HeardPuppet : Workbench {
    HeardPuppet() {
        buildChain();
        good({{"do", "pin"}, {"endpoint", "a/start"}});
        good({{"do", "precompute"}});
        good({{"do", "map-input"}, {"source", "osc"}, {"channel", "/gone"}, {"target", "bone/b/end/x"}});
        good({{"do", "map-input"}, {"source", "osc"}, {"channel", "/fader"}, {"target", "bone/b/end/y"}});
        REQUIRE(session.builtCharacter());
    }
    InputDriver driver() { return InputDriver(session.document(), session.plan(), {}); }
};

template <class Until>
bool waited(Until until) {
    const auto start = std::chrono::steady_clock::now();
    while (!until()) {
        if (std::chrono::steady_clock::now() - start > 60s) return false;
        std::this_thread::sleep_for(2ms);
    }
    return true;
}

}  // namespace

TEST_CASE("hearing: a source is measured while its values are held back; what it said before counts where it says nothing else") {
    HearingThread thread;
    const auto port = thread.open({"osc", InputProtocol::Osc}, 0, UdpPort::From::Loopback);
    REQUIRE(port);
    CHECK(!thread.measured());
    thread.hold(true);
    const UdpSender sender(*port);
    sender.send(oscBytes("/still", {0.5F}));
    sender.send(oscBytes("/moves", {9.0F}));
    REQUIRE(waited([&] { return thread.heard("osc")->counts.values == 2; }));
    thread.measure("osc");
    CHECK(thread.measured()->heard() == 0);
    sender.send(oscBytes("/moves", {1.0F}));
    sender.send(oscBytes("/moves", {2.0F}));
    REQUIRE(waited([&] { return thread.measured()->heard() == 2; }));
    const auto means = thread.measured()->means();
    CHECK(means.size() == 2);
    CHECK(means.at("/still") == std::vector{0.5});
    CHECK(means.at("/moves") == std::vector{1.5});
    thread.measure({});
    CHECK(!thread.measured());
}

TEST_CASE("hearing: ports are open for as long as somebody listens; a taken one is refused, packets are counted, broken ones too, and senders") {
    HearingThread thread;
    CHECK(!thread.hears());
    const auto port = thread.open({"osc", InputProtocol::Osc}, 0, UdpPort::From::Loopback);
    REQUIRE(port);
    const auto taken = thread.open({"other", InputProtocol::Osc}, *port, UdpPort::From::Loopback);
    REQUIRE(!taken);
    CHECK(taken.error().code == "port-taken");
    CHECK(!thread.heard("other"));
    UdpSender one(*port), two(*port);
    one.send(oscBytes("/fader", {0.5F}));
    two.send(oscBytes("/fader", {0.25F}));
    two.send("no packet of OSC");
    two.send(std::string(10000, 'x'));
    CHECK(waited([&] { return thread.heard("osc")->counts.packets == 4; }));
    const auto heard = *thread.heard("osc");
    CHECK(heard.counts.values == 2);
    CHECK(heard.counts.malformed == 2);
    CHECK(heard.senders == 2);
    CHECK(heard.lost == 0);
    // Another source joins; the first one is heard on.
    const auto second = thread.open({"vmc", InputProtocol::Vmc}, 0, UdpPort::From::Loopback);
    REQUIRE(second);
    one.send(oscBytes("/fader", {0.75F}));
    UdpSender(*second).send(oscBytes("/VMC/Ext/OK", {1}));
    CHECK(waited([&] { return thread.heard("osc")->counts.packets == 5 && thread.heard("vmc")->counts.packets == 1; }));
    CHECK(thread.heard("vmc")->counts.ignored == 1);
    thread.close("osc");
    CHECK(!thread.heard("osc"));
    CHECK(UdpPort::listen(*port).has_value());
    thread.close("vmc");
    CHECK(!thread.hears());
}

TEST_CASE("hearing: senders beyond sixteen are left out and counted") {
    HearingThread thread;
    const auto port = thread.open({"osc", InputProtocol::Osc}, 0, UdpPort::From::Loopback);
    REQUIRE(port);
    std::vector<std::unique_ptr<UdpSender>> senders;
    for (std::size_t i = 0; i < HearingThread::kMostSenders + 3; ++i) senders.push_back(std::make_unique<UdpSender>(*port));
    for (const auto& sender : senders) sender->send(oscBytes("/fader", {0.5F}));
    CHECK(waited([&] { return thread.heard("osc")->counts.packets + thread.heard("osc")->refused == senders.size(); }));
    CHECK(thread.heard("osc")->refused == 3);
    CHECK(thread.heard("osc")->senders == 16);
    senders[0]->send(oscBytes("/fader", {0.6F}));  // who was first is heard on
    CHECK(waited([&] { return thread.heard("osc")->counts.packets == 17; }));
}

TEST_CASE("hearing: what is heard moves the meters of its row and the character; held inputs move neither; the list of names is answered") {
    HeardPuppet f;
    HearingThread thread;
    const auto port = thread.open({"osc", InputProtocol::Osc}, 0, UdpPort::From::Loopback);
    REQUIRE(port);
    const auto feed = std::make_shared<InputFeed>(f.driver());
    thread.feed(feed, nameMessages(f.session.document()));
    f.session.perform([] {});
    REQUIRE(f.session.performInputs(feed));
    UdpSender sender(*port);
    sender.send(oscBytes("/fader", {0.5F}));
    CHECK(waited([&] { return feed->takeMeters() && feed->meters()[1].heard == 1 && feed->meters()[1].drives; }));
    REQUIRE(feed->meters().size() == 2);
    CHECK(feed->meters()[1].raw == 0.5);
    CHECK(feed->meters()[1].value == 0.5);
    CHECK(feed->meters()[0] == InputMeter());
    CHECK(f.session.inputsWait());
    CHECK(waited([&] { return f.session.holdInputs().value(); }));
    thread.hold(true);
    sender.send(oscBytes("/fader", {0.9F}));
    CHECK(waited([&] { return thread.heard("osc")->counts.packets == 2; }));
    CHECK(waited([&] { return feed->takeMeters(); }));
    CHECK(feed->meters()[1].heard == 1);
    // Another feed knows what controls said last, though they say nothing more.
    thread.hold(false);
    const auto again = std::make_shared<InputFeed>(f.driver());
    REQUIRE(f.session.performInputs(again));
    thread.feed(again, {});
    CHECK(waited([&] { return again->takeMeters() && again->meters()[1].raw == static_cast<double>(0.9F); }));
    REQUIRE(f.session.performInputs(feed));
    thread.feed(feed, nameMessages(f.session.document()));
    // Panic: nothing drives any more.
    feed->letGo();
    CHECK(waited([&] { return feed->takeMeters() && !feed->meters()[1].drives && !feed->meters()[1].known; }));
    sender.send(oscBytes(InputListener::kListAddress, {}));
    std::vector<std::string> answers;
    CHECK(waited([&] {
        while (const auto answer = sender.answer()) answers.push_back(*answer);
        return !answers.empty() && answers.back().starts_with("/imomushi/names");
    }));
    CHECK(answers.size() == directNames(f.session.document()).size() + 1);
    f.session.performInputs(nullptr);
}

TEST_CASE("feed: what a hand has is not driven until the gesture ends; then the control drives it again, from where the hand left it") {
    HeardPuppet f;
    f.session.perform([] {});
    f.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0, 0, 6}}});
    const auto feed = std::make_shared<InputFeed>(f.driver());
    REQUIRE(f.session.performInputs(feed));
    const EndpointRef end = *f.session.document().endpoint("b/end");
    const auto says = [&](double number) {
        const InputValue value = valueOf("osc", "/fader", {number});
        REQUIRE(feed->give(std::span(&value, 1)));
    };
    const auto target = [&] {
        f.session.takeFrame();
        f.good({{"do", "list"}});  // the document becomes what is performed
        return f.session.document().goals.at(end).target;
    };
    says(0.4);
    CHECK(waited([&] { return std::abs(target().y() - 0.4) < 1e-9; }));
    f.session.beginGesture();
    LiveInput hand;
    hand.end = end;
    hand.target = Vec3(1.0, 0.0, 6.0);
    REQUIRE(f.session.give(hand));
    CHECK(waited([&] { return (target() - hand.target).norm() < 1e-9; }));
    for (int i = 0; i < 20; ++i) {
        const auto before = f.session.performed()->step;
        says(0.8);  // a step is made for each
        CHECK(waited([&] { return f.session.takeFrame() && f.session.performed()->step > before; }));
        CHECK((target() - hand.target).norm() < 1e-9);
    }
    f.session.endGesture();
    says(0.7);
    // Only what is mapped goes on: the end stays where the hand left it in x.
    CHECK(waited([&] { return std::abs(target().y() - 0.7) < 1e-9; }));
    CHECK(target().x() == doctest::Approx(1.0));
    f.session.performInputs(nullptr);
}

TEST_CASE("hearing: a pad is heard while it is plugged in, moves what is mapped, and is learned; what it said last is forgotten when it leaves") {
    HeardPuppet f;
    f.good({{"do", "map-input"}, {"source", "pad"}, {"channel", "left-y"}, {"target", "bone/b/end/y"}, {"in", {-1, 1}}, {"out", {-0.5, 0.5}}});
    f.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0, 0, 6}}});
    f.session.perform([] {});
    const auto feed = std::make_shared<InputFeed>(f.driver());
    REQUIRE(f.session.performInputs(feed));
    HearingThread thread;
    thread.feed(feed, {});
    auto port = openDevice(InputProtocol::Pad, {});
    REQUIRE(port);
    thread.open({"pad", InputProtocol::Pad}, std::move(*port));
    CHECK(waited([&] { return thread.heard("pad").has_value(); }));
    CHECK(thread.heard("pad")->device.empty());
    thread.learn(true);
    VirtualPad pad;
    CHECK(waited([&] { return thread.heard("pad")->device == VirtualPad::kName; }));
    CHECK(thread.heard("pad")->counts.packets == 0);
    for (int i = 0; i <= 10; ++i) {
        pad.axis(SDL_CONTROLLER_AXIS_LEFTY, -3276 * i);
        std::this_thread::sleep_for(10ms);
    }
    CHECK(waited([&] { return feed->takeMeters() && feed->meters()[2].drives && feed->meters()[2].raw > 0.9; }));
    CHECK(thread.heard("pad")->senders == 1);
    // What a step lets be felt is felt.
    CHECK(pad.shaken() == 0);
    feed->feel(0.25);
    feed->feel(0.5);
    CHECK(waited([&] { return pad.shaken() > 0; }));
    CHECK(feed->takeFelt() == 0.0);
    CHECK(waited([&] { return thread.learned() && thread.learned()->settled; }));
    CHECK(thread.learned()->channel == "left-y");
    CHECK(thread.learned()->source == "pad");
    pad.unplug();
    CHECK(waited([&] { return feed->takeMeters() && feed->meters()[2].silent; }));
    CHECK(waited([&] { return thread.heard("pad")->device.empty(); }));  // which another thread says a moment later
    // Another feed knows nothing of it: nobody says it any more.
    const auto next = std::make_shared<InputFeed>(f.driver());
    REQUIRE(f.session.performInputs(next));
    thread.feed(next, {});
    CHECK(waited([&] { return next->takeMeters() && !next->meters()[2].known; }));
    thread.close("pad");
    CHECK(!thread.hears());
    f.session.performInputs(nullptr);
}
