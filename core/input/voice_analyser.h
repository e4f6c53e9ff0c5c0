// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace imomushi {

/// What a microphone says: how loud it is, and how much the mouth has the shape of each of five vowels, all 0 ... 1. Shapes are named as the expressions of VRM 1.0.
inline constexpr std::array<std::string_view, 6> kVoiceChannels = {"level", "aa", "ih", "ou", "ee", "oh"};
using VoiceSound = std::array<double, kVoiceChannels.size()>;

/// Hears a voice: loudness above what is always there, and vowels by the resonances of the mouth. The spectrum's envelope (linear prediction; Makhoul, Proc. IEEE 63, 1975) is compared
/// with those of vowels by tubes of several lengths, so that it counts for deep and for high voices. Simple: it knows no consonants, and no language.
class VoiceAnalyser {
public:
    static constexpr int kRate = 16000;                ///< samples per second
    static constexpr std::size_t kHop = kRate / 100;   ///< samples from one answer to the next one

    VoiceAnalyser();
    /// Of the next kHop samples, -1 ... 1. What is not finite counts as silence. Takes no memory.
    VoiceSound hear(std::span<const float> samples);

private:
    static constexpr std::size_t kWindow = 400, kOrder = 16, kBands = 32;
    using Envelope = std::array<double, kBands>;
    struct Template {
        std::size_t vowel = 0;
        double tube = 1.0;
        Envelope envelope{};
    };
    /// Log of the envelope of a window; false: it is silent.
    bool envelopeOf(Envelope& envelope);
    /// Of the folds, Hz; 0: they do not sound.
    [[nodiscard]] double pitch() const;
    std::array<double, kBands> cosines_{}, sines_{};   // of the first power at each band
    std::array<double, kWindow> shape_{}, window_{}, shaped_{};
    std::vector<Template> templates_;
    double floor_ = -55.0;                             // dB, of what is always there
};

}  // namespace imomushi
