// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "core/base/utf8.h"
#include "core/input/input_decoder.h"
#include "core/input/pad_packet.h"
#include "tests/support/osc_bytes.h"

using namespace imomushi;

namespace {

struct Heard {
    std::unique_ptr<InputDecoder> decoder;
    std::map<std::string, std::vector<double>> last;
    std::set<std::string> left;  // channels that were gone
    explicit Heard(InputProtocol protocol) : decoder(makeInputDecoder(protocol, "here")) {}
    /// How many values came of it.
    int hear(const std::string& packet) {
        int values = 0;
        decoder->decode(asBytes(packet), 7, [&](const InputValue& value) {
            CHECK(value.source.text() == "here");
            CHECK(value.nanoseconds == 7);
            last[std::string(value.channel.text())].assign(value.numbers.begin(), value.numbers.begin() + value.count);
            if (value.gone) left.emplace(value.channel.text());
            ++values;
        });
        return values;
    }
    std::uint64_t malformed() const { return decoder->counts().malformed; }
    double one(const std::string& channel) const {
        const auto found = last.find(channel);
        REQUIRE_MESSAGE(found != last.end(), channel);
        REQUIRE(found->second.size() == 1);
        return found->second[0];
    }
};

std::string midi(std::initializer_list<int> bytes) {
    std::string made;
    for (const int b : bytes) made += static_cast<char>(b);
    return made;
}

std::string bone(const std::string& name, float w = 0.5f) {
    const float s = std::sqrt((1.0f - w * w) / 3.0f);
    return oscBytes("/VMC/Ext/Bone/Pos", {name, 0.1f, 0.2f, 0.3f, s, s, s, w});
}

}  // namespace

TEST_CASE("osc: a channel per address, numbers as they were sent, bundles are taken apart") {
    Heard h(InputProtocol::Osc);
    CHECK(h.hear(oscBytes("/hand", {1.5f, std::int32_t{-3}, std::string("text"), 0.25f})) == 1);
    CHECK(h.last["/hand"] == std::vector<double>{1.5, -3.0, 0.25});
    CHECK(h.hear(oscBytes("/blink", {})) == 1);
    CHECK(h.one("/blink") == 1.0);
    CHECK(h.hear(oscBundle({oscBytes("/a", {1.0f}), oscBundle({oscBytes("/b", {2.0f})})})) == 2);
    CHECK(h.one("/b") == 2.0);
    CHECK(h.hear(oscBytes("/name", {std::string("only a text")})) == 0);
    CHECK(h.decoder->counts() == InputCounts{4, 4, 1, 0});
}

TEST_CASE("osc: a packet that is broken anywhere changes nothing and is counted") {
    Heard h(InputProtocol::Osc);
    const std::string good = oscBytes("/hand", {1.0f});
    std::vector<std::string> broken = {"", "/hand", good.substr(0, good.size() - 1), good.substr(0, good.size() - 4), "hand" + good.substr(4),
                                       oscBundle({good, good.substr(0, good.size() - 4)}), oscBundle({good}).substr(0, 18), oscBytes("/hand", {std::numeric_limits<float>::quiet_NaN()}),
                                       oscBytes("/hand", {std::numeric_limits<float>::infinity()}), oscBytes("/hand", {3e38f}), oscBytes("/" + std::string(200, 'x'), {1.0f}),
                                       oscBytes("/\xff\xfe", {1.0f}), oscBytes("/hand", std::vector<OscArgument>(17, 1.0f)), std::string(InputDecoder::kLongestPacket + 4, '\0')};
    std::string deep = good;
    for (int i = 0; i < 6; ++i) deep = oscBundle({deep});
    broken.push_back(deep);
    broken.push_back(oscBundle(std::vector<std::string>(500, oscBytes("/a", {1.0f, 1.0f}))));  // too long
    for (std::size_t i = 0; i < broken.size(); ++i) {
        CAPTURE(i);
        CHECK(h.hear(broken[i]) == 0);
        CHECK(h.malformed() == i + 1);
    }
    CHECK(h.last.empty());
    CHECK(h.hear(good) == 1);
}

TEST_CASE("osc: a blob that is longer than its message is malformed, and one that is whole is left out") {
    Heard h(InputProtocol::Osc);
    std::string blobs, whole;
    addOscText(blobs, "/hand");
    addOscText(blobs, ",bb");
    CHECK(h.hear(blobs) == 0);
    for (const std::uint32_t size : {5u, 0x7fffffffu, 0xfffffffcu, 0xffffffffu}) {
        std::string longer = blobs;
        addOscNumber(longer, size);
        CHECK(h.hear(longer) == 0);
        CHECK(h.hear(longer + std::string(4, '\0')) == 0);
    }
    CHECK(h.malformed() == 9);
    addOscText(whole, "/hand");
    addOscText(whole, ",bf");
    addOscNumber(whole, 5);
    whole += std::string(8, 'x');
    addOscNumber(whole, std::bit_cast<std::uint32_t>(0.5f));
    CHECK(h.hear(whole) == 1);
    CHECK(h.one("/hand") == 0.5);
}

TEST_CASE("vmc: poses come in our axes, x mirrored, and blend values count from their Apply on") {
    Heard h(InputProtocol::Vmc);
    CHECK(h.hear(bone("Hips")) == 1);
    const auto& n = h.last["bone/Hips"];
    REQUIRE(n.size() == 10);
    // (0.5, -0.5, -0.5, 0.5) turns by 120 degrees about (1, -1, -1).
    CHECK(n[7] == doctest::Approx(2.0 * std::numbers::pi / 3.0 / std::sqrt(3.0)));
    CHECK(n[8] == doctest::Approx(-n[7]));
    CHECK(n[9] == doctest::Approx(-n[7]));
    CHECK(n[0] == doctest::Approx(-0.1));
    CHECK(n[2] == doctest::Approx(0.3));
    CHECK(n[3] == doctest::Approx(0.5));
    CHECK(n[4] == doctest::Approx(-0.5));
    CHECK(n[5] == doctest::Approx(-0.5));
    CHECK(n[6] == doctest::Approx(0.5));
    CHECK(h.hear(oscBytes("/VMC/Ext/Tra/Pos", {std::string("LHR-1"), 1.0f, 2.0f, 3.0f, 0.0f, 0.0f, 0.0f, 1.0f})) == 1);
    CHECK(h.last["tracker/LHR-1"][0] == -1.0);
    CHECK(h.hear(oscBytes("/VMC/Ext/Root/Pos", {std::string("root"), 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 1.0f, 1.0f, 1.0f, 1.0f, 0.0f, 0.0f, 0.0f})) == 1);  // version 2.1
    CHECK(h.hear(oscBytes("/VMC/Ext/Blend/Val", {std::string("Joy"), 1.75f})) == 0);
    CHECK(h.hear(oscBytes("/VMC/Ext/Blend/Val", {std::string("A"), 0.25f})) == 0);
    CHECK(h.hear(oscBytes("/VMC/Ext/Blend/Apply", {})) == 2);
    CHECK(h.one("blend/Joy") == 1.75);
    CHECK(h.hear(oscBytes("/VMC/Ext/Blend/Apply", {})) == 0);
    for (const auto& [address, arguments] : std::vector<std::pair<std::string, std::vector<OscArgument>>>{
             {"/VMC/Ext/OK", {1}}, {"/VMC/Ext/OK", {1, 3, 0, 1}}, {"/VMC/Ext/T", {1.0f}}, {"/VMC/Ext/Midi/Note", {1, 2, 3}}, {"/VMC/Ext/Set/Eye", {1, 0.0f, 0.0f, 0.0f}}})
        CHECK(h.hear(oscBytes(address, arguments)) == 0);
    CHECK(h.hear(bone("LastBone")) == 0);
    CHECK(h.decoder->counts().ignored == 6);
    CHECK(h.malformed() == 0);
}

TEST_CASE("vmc: nameless, short and twisted arguments are malformed, and do not touch the values that wait") {
    Heard h(InputProtocol::Vmc);
    const std::string joy = oscBytes("/VMC/Ext/Blend/Val", {std::string("Joy"), 1.0f});
    CHECK(h.hear(joy) == 0);
    const std::vector<std::string> broken = {oscBytes("/VMC/Ext/Bone/Pos", {0.1f, 0.2f, 0.3f, 0.0f, 0.0f, 0.0f, 1.0f, 1.0f}), oscBytes("/VMC/Ext/Bone/Pos", {std::string("Hips"), 0.1f}),
                                             oscBytes("/VMC/Ext/Bone/Pos", {std::string(), 0.1f, 0.2f, 0.3f, 0.0f, 0.0f, 0.0f, 1.0f}),
                                             oscBytes("/VMC/Ext/Bone/Pos", {std::string("Hips"), 0.1f, 0.2f, 0.3f, 0.0f, 0.0f, 0.0f, 0.0f}),
                                             oscBytes("/VMC/Ext/Blend/Val", {0.5f}), oscBytes("/VMC/Ext/Blend/Val", {std::string("Joy"), std::numeric_limits<float>::quiet_NaN()}),
                                             oscBundle({oscBytes("/VMC/Ext/Blend/Val", {std::string("Joy"), 9.0f}), oscBytes("/VMC/Ext/Blend/Val", {std::string("Fun")})})};
    for (std::size_t i = 0; i < broken.size(); ++i) {
        CAPTURE(i);
        CHECK(h.hear(broken[i]) == 0);
        CHECK(h.malformed() == i + 1);
    }
    CHECK(h.hear(oscBytes("/VMC/Ext/Blend/Apply", {})) == 1);
    CHECK(h.one("blend/Joy") == 1.0);
}

TEST_CASE("midi: running status, divided messages, pairs of 14 bit and pitch bend") {
    Heard h(InputProtocol::Midi);
    CHECK(h.hear(midi({0x90, 60, 127, 64, 0, 0x80, 60, 64})) == 3);
    CHECK(h.one("note/1/60") == 0.0);
    CHECK(h.hear(midi({0xB2, 7})) == 0);
    CHECK(h.hear(midi({0xF8})) == 0);  // a clock between the bytes of a message
    CHECK(h.hear(midi({127})) == 1);
    CHECK(h.one("cc/3/7") == 1.0);
    CHECK(h.hear(midi({39, 127})) == 2);
    CHECK(h.one("cc14/3/7") == 1.0);
    CHECK(h.hear(midi({0xE0, 0, 64, 127, 127, 0, 0})) == 3);
    CHECK(h.one("bend/1") == -1.0);
    CHECK(h.hear(midi({0xE0, 0, 64})) == 1);
    CHECK(h.one("bend/1") == 0.0);
    CHECK(h.hear(midi({0xF0, 1, 2, 3})) == 0);
    CHECK(h.hear(midi({4, 5, 0xF7})) == 0);
    CHECK(h.malformed() == 0);
    CHECK(h.hear(midi({1})) == 0);  // exclusive messages end the running status
    CHECK(h.malformed() == 1);
    CHECK(h.hear(midi({0xD4, 127, 0xC4, 5, 0xA4, 1, 127})) == 3);
    CHECK(h.one("pressure/5") == 1.0);
    CHECK(h.one("program/5") == 5.0);
    CHECK(h.one("key-pressure/5/1") == 1.0);
}

namespace {

std::string pad(unsigned kind, unsigned control, int value) {
    const auto p = PadPacket::of(kind, control, static_cast<std::int16_t>(value));
    return {reinterpret_cast<const char*>(p.data()), p.size()};
}

}  // namespace

TEST_CASE("pad: sticks point up and say both their numbers, triggers go from 0 to 1, and what no pad has is malformed") {
    Heard h(InputProtocol::Pad);
    CHECK(h.hear(pad(PadPacket::kAxis, 0, 32767)) == 2);
    CHECK(h.one("left-x") == 1.0);
    CHECK(h.one("left-y") == 0.0);
    CHECK(h.hear(pad(PadPacket::kAxis, 0, 0) + pad(PadPacket::kAxis, 1, -32768)) == 4);
    CHECK(h.one("left-x") == 0.0);
    CHECK(h.one("left-y") == 1.0);
    CHECK(h.hear(pad(PadPacket::kAxis, 4, 32767) + pad(PadPacket::kAxis, 5, -300)) == 2);
    CHECK(h.one("left-trigger") == 1.0);
    CHECK(h.one("right-trigger") == 0.0);
    CHECK(h.hear(pad(PadPacket::kButton, 0, 1)) == 1);
    CHECK(h.one("a") == 1.0);
    for (const std::string& broken : {pad(PadPacket::kAxis, 6, 0), pad(PadPacket::kButton, 0, 2), pad(PadPacket::kGone, 1, 0), pad(3, 0, 0), std::string("abc")}) CHECK(h.hear(broken) == 0);
    CHECK(h.malformed() == 5);
}

TEST_CASE("pad: the dead zone of a stick is round, so that a circle of the stick is a circle, and the way begins at 0") {
    Heard h(InputProtocol::Pad);
    const auto lean = [&](double x, double y) {
        h.hear(pad(PadPacket::kAxis, 2, static_cast<int>(32767 * x)) + pad(PadPacket::kAxis, 3, static_cast<int>(-32767 * y)));
        return std::pair(h.one("right-x"), h.one("right-y"));
    };
    CHECK(lean(0.08, 0.08) == std::pair(0.0, 0.0));
    // Nearly upright: what is sideways is told, though it is less than the dead zone.
    CHECK(lean(0.1, 0.9).first > 0.09);
    for (int i = 0; i < 32; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / 32.0;
        const auto [x, y] = lean(0.6 * std::cos(angle), 0.6 * std::sin(angle));
        CHECK(std::hypot(x, y) == doctest::Approx((0.6 - 0.12) / 0.88).epsilon(1e-3));
        CHECK(x * std::sin(angle) - y * std::cos(angle) == doctest::Approx(0.0).epsilon(1e-3));
    }
    const double little = lean(0.125, 0.0).first;
    CHECK(little > 0.0);
    CHECK(little < 0.01);
}

TEST_CASE("pad: one that is plugged out leaves every channel that it said, and none that it did not") {
    Heard h(InputProtocol::Pad);
    h.hear(pad(PadPacket::kAxis, 0, 20000) + pad(PadPacket::kButton, 1, 1));
    h.last.clear();
    CHECK(h.hear(pad(PadPacket::kGone, 0, 0)) == 3);
    CHECK(h.left == std::set<std::string>{"b", "left-x", "left-y"});
    CHECK(h.hear(pad(PadPacket::kGone, 0, 0)) == 0);
    // It comes back with its sticks in the middle.
    h.hear(pad(PadPacket::kAxis, 1, -32768));
    CHECK(h.one("left-x") == 0.0);
}

TEST_CASE("keys: each has a channel, four of them are a stick, too, and what no keyboard has is malformed") {
    Heard h(InputProtocol::Keys);
    const auto key = [&](bool down, const std::string& name) { return h.hear(std::string(1, down ? '\1' : '\0') + name); };
    CHECK(key(true, "space") == 1);
    CHECK(h.one("space") == 1.0);
    CHECK(key(false, "space") == 1);
    CHECK(h.one("space") == 0.0);
    CHECK(key(true, "w") == 2);
    CHECK(key(true, "d") == 2);
    CHECK(h.last.at("wasd") == std::vector<double>{1.0, 1.0});
    key(true, "a");  // both sides at once
    CHECK(h.last.at("wasd") == std::vector<double>{0.0, 1.0});
    key(false, "d");
    key(false, "w");
    CHECK(h.last.at("wasd") == std::vector<double>{-1.0, 0.0});
    for (const std::string& broken : {std::string("\1"), std::string("\1") + "escape", std::string("\2") + "w", std::string("\1") + "W", std::string("\1") + "wasd"}) CHECK(h.hear(broken) == 0);
    CHECK(h.malformed() == 5);
    // What was broken has changed nothing.
    key(true, "w");
    CHECK(h.last.at("wasd") == std::vector<double>{-1.0, 1.0});
}

TEST_CASE("midi: a device that is plugged out leaves every channel that it said, also what it said in the same packet") {
    Heard h(InputProtocol::Midi);
    h.hear(midi({0xB0, 7, 64, 0x90, 60, 100}));
    CHECK(h.left.empty());
    CHECK(h.hear(midi({0xB0, 8, 1, 0xFF})) == 4);
    CHECK(h.left == std::set<std::string>{"cc/1/7", "cc/1/8", "note/1/60"});
    h.left.clear();
    CHECK(h.hear(midi({0xFF})) == 0);
    CHECK(h.hear(midi({7, 1})) == 0);  // and its running status
    CHECK(h.malformed() == 1);
    CHECK(h.hear(midi({0xB0, 7, 1, 0xFF, 0xB0, 9, 1})) == 3);
    CHECK(h.left == std::set<std::string>{"cc/1/7"});
    CHECK(h.hear(midi({0xFF})) == 1);
    CHECK(h.left == std::set<std::string>{"cc/1/7", "cc/1/9"});
}

TEST_CASE("decoders: of a million packets that are random, or valid ones with a few bytes changed, only sound values come through") {
    std::mt19937 random(49);
    const std::vector<std::string> osc = {oscBytes("/hand", {1.0f, 2, std::string("abc")}), oscBundle({oscBytes("/a", {1.0f}), bone("Hips")}), bone("Spine"),
                                          oscBytes("/VMC/Ext/Blend/Val", {std::string("Joy"), 1.0f}), oscBytes("/VMC/Ext/Blend/Apply", {})};
    const std::vector<std::string> other = {midi({0x90, 60, 127, 64, 0}), midi({0xF0, 1, 2, 0xF7}), midi({0xE0, 0, 64}), std::string("\0\1\2\3", 4), std::string("\1w"), std::string("\1left"), std::string("\1space"), std::string(13, '\0'), "\1" + std::string(12, '\0')};
    for (const InputProtocol protocol : {InputProtocol::Osc, InputProtocol::Vmc, InputProtocol::Midi, InputProtocol::Pad, InputProtocol::Keys, InputProtocol::Voice}) {
        const auto decoder = makeInputDecoder(protocol, "fuzz");
        const auto& seeds = protocol == InputProtocol::Osc || protocol == InputProtocol::Vmc ? osc : other;
        std::uint64_t values = 0;
        bool sound = true;
        constexpr int kPackets = 175'000;
        for (int i = 0; i < kPackets; ++i) {
            std::string packet;
            if (i % 4 == 0) {
                packet.resize(random() % 64);
                for (char& c : packet) c = static_cast<char>(random());
            } else {
                packet = seeds[random() % seeds.size()];
                for (unsigned change = random() % 4; change > 0; --change) packet[random() % packet.size()] = static_cast<char>(random());
                if (random() % 8 == 0) packet.resize(random() % (packet.size() + 1));
            }
            decoder->decode(asBytes(packet), i, [&](const InputValue& value) {
                ++values;
                sound = sound && value.count > 0 && value.count <= static_cast<int>(InputValue::kMost) && isUtf8(value.channel.text()) && !value.channel.text().empty();
                for (int k = 0; k < value.count; ++k) sound = sound && std::abs(value.numbers[static_cast<std::size_t>(k)]) <= InputValue::kLargest;
            });
        }
        CHECK(sound);
        const InputCounts& counts = decoder->counts();
        CHECK(counts.packets == kPackets);
        CHECK(counts.values == values);
        CHECK(values > 1000);
        CHECK(counts.malformed > 1000);
        MESSAGE(std::string(protocolName(protocol)) << ": " << values << " values, " << counts.malformed << " packets malformed");
    }
}
