// SPDX-License-Identifier: GPL-3.0-or-later
#define SDL_MAIN_HANDLED  // this program has a main() of its own
#include "core/input/voice_port.h"

#include <SDL.h>

#include <algorithm>
#include <mutex>
#include <utility>

#include "core/input/sdl_parts.h"
#include "core/input/voice_packet.h"

namespace imomushi {

namespace {

/// After each time that it could not be opened, twice as long: opening may hold up whoever hears.
constexpr auto kBetweenLooks = std::chrono::seconds(1), kLongestWait = std::chrono::seconds(32);
constexpr std::uint16_t kBuffer = 256;  // samples that SDL brings at once
/// What waits because nobody took it is old: a voice is heard now or not at all.
constexpr std::uint32_t kMostWaiting = sizeof(float) * VoiceAnalyser::kRate / 4;

}  // namespace

/// SDL's sound, which this program has once, and which any of its threads may ask.
class VoicePort::Sound {
public:
    static Result<std::shared_ptr<Sound>> get() {
        static std::weak_ptr<Sound> known;
        const std::lock_guard lock(sdlMutex());
        if (auto sound = known.lock()) return sound;
        if (auto ok = beginSdlPart(SDL_INIT_AUDIO, "Microphones"); !ok) return tl::unexpected(ok.error());
        auto sound = std::shared_ptr<Sound>(new Sound);
        known = sound;
        return sound;
    }
    ~Sound() {
        const std::lock_guard lock(sdlMutex());
        endSdlPart(SDL_INIT_AUDIO);
    }
    Sound(const Sound&) = delete;
    Sound& operator=(const Sound&) = delete;

    [[nodiscard]] std::vector<std::string> names() const {
        const std::lock_guard lock(sdlMutex());  // asking for their number makes the list anew
        std::vector<std::string> names;
        for (int i = 0; i < SDL_GetNumAudioDevices(1); ++i)
            if (const char* name = SDL_GetAudioDeviceName(i, 1)) names.emplace_back(name);
        return names;
    }

    /// What the artist made the usual microphone; empty: the system does not say.
    [[nodiscard]] static std::string usual() {
        std::string name;
        char* said = nullptr;
        SDL_AudioSpec spec{};
        if (SDL_GetDefaultAudioInfo(&said, &spec, 1) == 0 && said) name = said;
        SDL_free(said);
        return name;
    }

private:
    Sound() = default;
};

Result<std::unique_ptr<VoicePort>> VoicePort::open(std::string_view wanted) {
    auto sound = Sound::get();
    if (!sound) return tl::unexpected(sound.error());
    return std::unique_ptr<VoicePort>(new VoicePort(std::move(*sound), wanted));
}

VoicePort::VoicePort(std::shared_ptr<Sound> sound, std::string_view wanted) : sound_(std::move(sound)), wanted_(wanted) {}

VoicePort::~VoicePort() {
    if (device_ != 0) SDL_CloseAudioDevice(device_);
}

void VoicePort::look() {
    const Clock::time_point now = Clock::now();
    if (looked_ != Clock::time_point{} && now - looked_ < waits_) return;
    looked_ = now;
    waits_ = kBetweenLooks;
    const std::vector<std::string> names = sound_->names();
    if (wanted_.empty() ? names.empty() : std::ranges::find(names, wanted_) == names.end()) return;
    SDL_AudioSpec asked{};
    asked.freq = VoiceAnalyser::kRate;
    asked.format = AUDIO_F32SYS;
    asked.channels = 1;
    asked.samples = kBuffer;
    SDL_AudioSpec got{};
    device_ = SDL_OpenAudioDevice(wanted_.empty() ? nullptr : wanted_.c_str(), 1, &asked, &got, 0);
    if (device_ == 0) {
        failed_ = std::min<Clock::duration>(2 * failed_, kLongestWait);
        waits_ = failed_;
        return;
    }
    failed_ = kBetweenLooks;
    name_ = wanted_.empty() ? Sound::usual() : wanted_;
    if (name_.empty()) name_ = names.front();
    analyser_ = VoiceAnalyser();
    SDL_PauseAudioDevice(device_, 0);
}

std::optional<std::size_t> VoicePort::take(std::span<std::byte> room) {
    if (room.size() < VoicePacket::kBytes) return std::nullopt;
    const auto packet = [&](unsigned kind, const VoiceSound& heard) {
        std::ranges::copy(VoicePacket::of(kind, heard), room.begin());
        return VoicePacket::kBytes;
    };
    if (device_ == 0) look();
    if (device_ == 0) return std::nullopt;
    if (SDL_GetAudioDeviceStatus(device_) == SDL_AUDIO_STOPPED) {
        SDL_CloseAudioDevice(std::exchange(device_, 0));
        name_.clear();
        return packet(VoicePacket::kGone, {});
    }
    const std::uint32_t waiting = SDL_GetQueuedAudioSize(device_);
    if (waiting > kMostWaiting) SDL_ClearQueuedAudio(device_);
    if (waiting > kMostWaiting || waiting < sizeof samples_) return std::nullopt;
    if (SDL_DequeueAudio(device_, samples_.data(), sizeof samples_) < sizeof samples_) return std::nullopt;
    return packet(VoicePacket::kHeard, analyser_.hear(samples_));
}

std::vector<std::string> pluggedMicrophones() {
    const auto sound = VoicePort::Sound::get();
    return sound ? (*sound)->names() : std::vector<std::string>();
}

}  // namespace imomushi
