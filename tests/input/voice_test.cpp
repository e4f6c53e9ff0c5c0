// SPDX-License-Identifier: GPL-3.0-or-later
// A voice that is made by a pulse and resonances, as the source and the tube of a mouth make one.
#include <doctest/doctest.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "core/input/devices.h"
#include "core/input/voice_analyser.h"
#include "core/input/voice_packet.h"
#include "tests/support/allocations.h"

using namespace imomushi;

namespace {

constexpr double kRate = VoiceAnalyser::kRate;

/// Resonances in a row, fed by pulses; the lips take away the lowest frequencies.
std::vector<float> voice(double seconds, double pitch, const std::vector<double>& formants, double loud, double noise = 1e-4, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::normal_distribution<double> breath(0.0, noise);
    std::vector<double> sound(static_cast<std::size_t>(seconds * kRate));
    double last = 0.0;
    for (std::size_t i = 0; i < sound.size(); ++i) {
        const double now = std::fmod(static_cast<double>(i) * pitch / kRate, 1.0);
        const double pulse = now < 0.4 ? std::sin(std::numbers::pi * now / 0.4) : 0.0;  // the folds open and close
        sound[i] = pulse - last;
        last = pulse;
    }
    for (const double f : formants) {
        const double r = std::exp(-std::numbers::pi * (60.0 + 0.03 * f) / kRate), c = 2.0 * r * std::cos(2.0 * std::numbers::pi * f / kRate);
        double y1 = 0.0, y2 = 0.0;
        for (double& s : sound) {
            const double y = (1.0 - c + r * r) * s + c * y1 - r * r * y2;
            y2 = y1;
            y1 = y;
            s = y;
        }
    }
    double most = 1e-12;
    for (const double s : sound) most = std::max(most, std::abs(s));
    std::vector<float> made;
    for (const double s : sound) made.push_back(static_cast<float>(loud * s / most + breath(random)));
    return made;
}

/// The mean of what is heard after the first tenth of a second.
VoiceSound heard(VoiceAnalyser& analyser, const std::vector<float>& sound) {
    VoiceSound sum{};
    int count = 0;
    for (std::size_t i = 0; i + VoiceAnalyser::kHop <= sound.size(); i += VoiceAnalyser::kHop) {
        const VoiceSound now = analyser.hear(std::span(sound).subspan(i, VoiceAnalyser::kHop));
        for (const double part : now) REQUIRE((part >= 0.0 && part <= 1.0));
        if (i < 0.1 * kRate) continue;
        ++count;
        for (std::size_t v = 0; v < sum.size(); ++v) sum[v] += now[v];
    }
    for (double& part : sum) part /= count;
    return sum;
}

std::vector<float> silence(double seconds) { return voice(seconds, 100.0, {}, 0.0, 1e-3); }

}  // namespace

TEST_CASE("voice: vowels of men, women and children are told apart, at low and high pitch") {
    // Means of Peterson and Barney (1952), Hz.
    const std::map<std::string, std::vector<std::vector<double>>> spoken = {{"aa", {{730, 1090, 2440, 3400}, {850, 1220, 2810, 3800}, {1030, 1370, 3170}}},
                                                                           {"ih", {{270, 2290, 3010, 3600}, {310, 2790, 3310, 4000}, {370, 3200, 3730}}},
                                                                           {"ou", {{300, 870, 2240, 3400}, {370, 950, 2670, 3700}, {430, 1170, 3260}}},
                                                                           {"ee", {{530, 1840, 2480, 3500}, {610, 2330, 2990, 3900}, {690, 2610, 3570}}},
                                                                           {"oh", {{570, 840, 2410, 3400}, {590, 920, 2710, 3700}, {680, 1060, 3180}}}};
    int right = 0, all = 0;
    for (const auto& [vowel, voices] : spoken)
        for (std::size_t who = 0; who < voices.size(); ++who)
            for (const double pitch : {95.0 + 70.0 * static_cast<double>(who), 130.0 + 70.0 * static_cast<double>(who)}) {
                VoiceAnalyser analyser;
                (void)heard(analyser, silence(0.5));
                const VoiceSound sound = heard(analyser, voice(0.5, pitch, voices[who], 0.5));
                const auto best = static_cast<std::size_t>(std::max_element(sound.begin() + 1, sound.end()) - sound.begin());
                ++all;
                right += kVoiceChannels[best] == vowel;
                MESSAGE(vowel << ", voice " << who << " at " << pitch << " Hz: " << std::string(kVoiceChannels[best]) << " " << sound[best] << ", level " << sound[0]);
                CHECK(sound[0] > 0.5);
            }
    MESSAGE(right << " of " << all << " vowels");
    CHECK(right >= all - 2);
}

TEST_CASE("voice: silence is 0, louder is more, what hums all the time becomes silence, and nothing is heard of what is not finite") {
    VoiceAnalyser analyser;
    CHECK(heard(analyser, silence(1.0))[0] < 0.01);
    double before = 0.0;
    for (const double loud : {0.01, 0.04, 0.15, 0.5}) {
        const double level = heard(analyser, voice(0.5, 120.0, {730, 1090, 2440}, loud, 1e-3))[0];
        CHECK(level > before);
        before = level;
        CHECK(heard(analyser, silence(0.5))[0] < 0.01);
    }
    CHECK(before > 0.7);
    const std::vector<float> broken(3200, std::numeric_limits<float>::quiet_NaN());
    for (const double part : heard(analyser, std::vector<float>(3200, std::numeric_limits<float>::infinity()))) CHECK(part == 0.0);
    CHECK(heard(analyser, broken)[0] == 0.0);
    // A microphone that was muted, then a quiet room.
    VoiceAnalyser muted;
    (void)heard(muted, std::vector<float>(48000, 0.0f));
    CHECK(heard(muted, silence(0.5))[0] < 0.1);
    CHECK(heard(muted, voice(0.5, 120.0, {730, 1090, 2440}, 0.5, 1e-3))[0] > 0.7);
    // A fan of half a minute.
    VoiceAnalyser beside;
    std::vector<float> fan = voice(40.0, 100.0, {}, 0.0, 0.02);
    (void)heard(beside, fan);
    CHECK(heard(beside, voice(1.0, 100.0, {}, 0.0, 0.02))[0] < 0.05);
}

TEST_CASE("voice: hearing takes no memory") {
    VoiceAnalyser analyser;
    const auto sound = voice(0.2, 120.0, {730, 1090, 2440}, 0.5);
    const std::size_t before = allocations();
    for (std::size_t i = 0; i + VoiceAnalyser::kHop <= sound.size(); i += VoiceAnalyser::kHop) (void)analyser.hear(std::span(sound).subspan(i, VoiceAnalyser::kHop));
    CHECK(allocations() == before);
}

// SDL's "disk" driver is a microphone that plays a file.
TEST_CASE("voice: a microphone is heard through its device, a hundred times a second, and what it says is decoded") {
    const auto path = std::filesystem::temp_directory_path() / ("imomushi-voice-" + std::to_string(::getpid()) + ".raw");
    {
        std::ofstream file(path, std::ios::binary);
        for (const auto& part : {silence(0.5), voice(3.0, 120.0, {270, 2290, 3010, 3600}, 0.5)}) file.write(reinterpret_cast<const char*>(part.data()), static_cast<std::streamsize>(part.size() * sizeof(float)));
    }
    ::setenv("SDL_AUDIODRIVER", "disk", 1);
    ::setenv("SDL_DISKAUDIOFILEIN", path.c_str(), 1);
    {
        auto port = openDevice(InputProtocol::Voice, {});
        REQUIRE(port);
        REQUIRE(!pluggedDevices(InputProtocol::Voice).empty());
        const auto decoder = makeInputDecoder(InputProtocol::Voice, "voice");
        std::array<std::byte, 64> room{};
        std::map<std::string, double> most;
        int packets = 0;
        for (const auto start = std::chrono::steady_clock::now(); packets < 150 && std::chrono::steady_clock::now() - start < std::chrono::seconds(30);) {
            const auto size = (*port)->take(room);
            if (!size) {
                std::this_thread::sleep_for(std::chrono::milliseconds(2));
                continue;
            }
            ++packets;
            CHECK(*size == VoicePacket::kBytes);
            decoder->decode(std::span(room).first(*size), 0, [&](const InputValue& value) { most[std::string(value.channel.text())] = std::max(most[std::string(value.channel.text())], value.numbers[0]); });
        }
        CHECK(packets == 150);
        CHECK(decoder->counts().malformed == 0);
        CHECK(!(*port)->device().empty());
        CHECK(most.size() == kVoiceChannels.size());
        CHECK(most["level"] > 0.7);
        CHECK(most["ih"] > 0.5);
        CHECK(most["ih"] > most["oh"]);
    }
    ::unsetenv("SDL_AUDIODRIVER");
    ::unsetenv("SDL_DISKAUDIOFILEIN");
    std::filesystem::remove(path);
}
