// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/input/voice_analyser.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace imomushi {

namespace {

constexpr double kLowest = 200.0, kHighest = 4200.0;  // Hz, of the bands
constexpr double kEmphasis = 0.97;                    // of high frequencies before the prediction
constexpr double kNoise = 1e-4;                       // part of the energy, so that the prediction is well posed
/// Loudness, dB: so much above what is always there a voice begins, and so much higher it is as loud as it gets.
constexpr double kBegins = 8.0, kSpan = 30.0;
constexpr double kQuietest = -70.0, kRises = 0.01;    // dB; what is always there is no quieter than this, and becomes louder by so many dB a hop at most
constexpr double kMuted = 1e-9;                       // energy of a sample, below what 16 bits say
/// Templates whose distance differs by this (RMS of log envelopes, dB) are told apart.
constexpr double kTold = 1.6;

/// First resonances of vowels, Hz: after Peterson and Barney (J. Acoust. Soc. Am. 24, 1952), means of men, and the unrounded u of Japanese.
struct Vowel {
    std::size_t channel;
    std::array<double, 4> formants;
};
constexpr Vowel kVowels[] = {{1, {730.0, 1150.0, 2440.0, 3500.0}}, {2, {280.0, 2250.0, 2950.0, 3600.0}}, {3, {310.0, 870.0, 2240.0, 3400.0}}, {3, {330.0, 1250.0, 2300.0, 3400.0}},
                             {4, {500.0, 1850.0, 2500.0, 3500.0}}, {5, {520.0, 850.0, 2450.0, 3400.0}}};
/// The lengths of tubes: of a deep man's voice to a child's.
constexpr double kTubes[] = {0.92, 1.0, 1.08, 1.16, 1.26};

/// Folds sound between these, Hz. A high voice has a short tube: at this pitch it has that of a man, and so much less at twice the pitch.
constexpr double kLowestPitch = 80.0, kHighestPitch = 400.0, kOfMan = 120.0, kShorter = 0.2;
constexpr double kVoiced = 0.4;      // of its energy repeats
constexpr double kUnlikely = 12.0;   // dB, that a tube costs which is e times as long as the pitch says

/// Bandwidth of a resonance at this frequency, Hz.
double bandwidth(double hertz) { return 50.0 + 0.04 * hertz; }

double mel(double hertz) { return 1127.0 * std::log1p(hertz / 700.0); }
double hertzOf(double mel) { return 700.0 * std::expm1(mel / 1127.0); }

/// Level and slope are of the microphone and the voice, not of the vowel.
template <std::size_t N>
void flatten(std::array<double, N>& envelope) {
    constexpr double middle = 0.5 * static_cast<double>(N - 1);
    double mean = 0.0, slope = 0.0, square = 0.0;
    for (std::size_t i = 0; i < N; ++i) {
        const double x = static_cast<double>(i) - middle;
        mean += envelope[i] / static_cast<double>(N);
        slope += envelope[i] * x;
        square += x * x;
    }
    for (std::size_t i = 0; i < N; ++i) envelope[i] -= mean + slope / square * (static_cast<double>(i) - middle);
}

}  // namespace

VoiceAnalyser::VoiceAnalyser() {
    std::array<double, kBands> hertz{};
    for (std::size_t b = 0; b < kBands; ++b) {
        hertz[b] = hertzOf(mel(kLowest) + (mel(kHighest) - mel(kLowest)) * static_cast<double>(b) / static_cast<double>(kBands - 1));
        const double angle = 2.0 * std::numbers::pi * hertz[b] / kRate;
        cosines_[b] = std::cos(angle);
        sines_[b] = std::sin(angle);
    }
    for (std::size_t i = 0; i < kWindow; ++i) shape_[i] = 0.54 - 0.46 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(kWindow - 1));
    for (const Vowel& vowel : kVowels)
        for (const double tube : kTubes) {
            Template made{vowel.channel, tube, {}};
            for (std::size_t b = 0; b < kBands; ++b) {
                const std::complex<double> s(0.0, hertz[b]);
                double gain = 1.0;
                for (const double f : vowel.formants) {
                    // A resonance and its mirror image, in hertz in the place of radians.
                    const std::complex<double> pole(-0.5 * bandwidth(tube * f), tube * f);
                    gain *= std::norm(pole) / (std::abs(s - pole) * std::abs(s - std::conj(pole)));
                }
                made.envelope[b] = 20.0 * std::log10(gain);
            }
            flatten(made.envelope);
            templates_.push_back(made);
        }
}

bool VoiceAnalyser::envelopeOf(Envelope& envelope) {
    for (std::size_t i = 0; i < kWindow; ++i) shaped_[i] = shape_[i] * (window_[i] - (i > 0 ? kEmphasis * window_[i - 1] : 0.0));
    std::array<double, kOrder + 1> correlation{}, a{}, next{};
    for (std::size_t lag = 0; lag <= kOrder; ++lag)
        for (std::size_t i = lag; i < kWindow; ++i) correlation[lag] += shaped_[i] * shaped_[i - lag];
    if (!(correlation[0] > 1e-12)) return false;
    correlation[0] *= 1.0 + kNoise;
    // Levinson and Durbin.
    double error = correlation[0];
    a[0] = 1.0;
    for (std::size_t k = 1; k <= kOrder; ++k) {
        double sum = correlation[k];
        for (std::size_t j = 1; j < k; ++j) sum += a[j] * correlation[k - j];
        const double reflection = -sum / error;
        next = a;
        for (std::size_t j = 1; j < k; ++j) next[j] = a[j] + reflection * a[k - j];
        next[k] = reflection;
        a = next;
        error *= 1.0 - reflection * reflection;
        if (!(error > 0.0)) return false;
    }
    for (std::size_t b = 0; b < kBands; ++b) {
        const std::complex<double> z(cosines_[b], -sines_[b]);
        std::complex<double> sum = 0.0;
        for (std::size_t k = kOrder + 1; k-- > 0;) sum = sum * z + a[k];
        envelope[b] = -20.0 * std::log10(std::max(std::abs(sum), 1e-9));
    }
    flatten(envelope);
    return true;
}

double VoiceAnalyser::pitch() const {
    constexpr auto kFirst = static_cast<std::size_t>(kRate / kHighestPitch), kLast = static_cast<std::size_t>(kRate / kLowestPitch);
    std::array<double, kLast + 1> repeats{};
    double best = 0.0;
    for (std::size_t lag = kFirst; lag <= kLast; ++lag) {
        double both = 0.0, first = 0.0, second = 0.0;
        for (std::size_t i = lag; i < kWindow; ++i) {
            both += window_[i] * window_[i - lag];
            first += window_[i] * window_[i];
            second += window_[i - lag] * window_[i - lag];
        }
        repeats[lag] = both / std::sqrt(first * second + 1e-12);
        best = std::max(best, repeats[lag]);
    }
    // Twice the time repeats as well: the first one that is nearly as good.
    for (std::size_t lag = kFirst; best > kVoiced && lag <= kLast; ++lag)
        if (repeats[lag] > 0.9 * best && (lag == kLast || repeats[lag] >= repeats[lag + 1])) return kRate / static_cast<double>(lag);
    return 0.0;
}

VoiceSound VoiceAnalyser::hear(std::span<const float> samples) {
    std::shift_left(window_.begin(), window_.end(), static_cast<std::ptrdiff_t>(kHop));
    double energy = 0.0;
    for (std::size_t i = 0; i < kHop; ++i) {
        const double sample = i < samples.size() && std::isfinite(samples[i]) ? std::clamp(static_cast<double>(samples[i]), -1.0, 1.0) : 0.0;
        window_[kWindow - kHop + i] = sample;
        energy += sample * sample;
    }
    const double loudness = std::max(-120.0, 10.0 * std::log10(energy / static_cast<double>(kHop) + 1e-12));
    // No sound at all is a microphone that is muted, not a quiet room.
    if (energy > kMuted * static_cast<double>(kHop)) floor_ = std::clamp(loudness, kQuietest, floor_ + kRises);
    VoiceSound sound{};
    sound[0] = std::clamp((loudness - floor_ - kBegins) / kSpan, 0.0, 1.0);
    Envelope envelope;
    if (sound[0] == 0.0 || !envelopeOf(envelope)) return sound;
    VoiceSound distance;
    distance.fill(std::numeric_limits<double>::infinity());
    const double hertz = pitch(), tube = hertz > 0.0 ? 1.0 + kShorter * std::log2(hertz / kOfMan) : 0.0;
    for (const Template& known : templates_) {
        double square = 0.0;
        for (std::size_t b = 0; b < kBands; ++b) square += (envelope[b] - known.envelope[b]) * (envelope[b] - known.envelope[b]) / static_cast<double>(kBands);
        distance[known.vowel] = std::min(distance[known.vowel], std::sqrt(square) + (hertz > 0.0 ? kUnlikely * std::abs(std::log(known.tube / tube)) : 0.0));
    }
    const double nearest = *std::min_element(distance.begin() + 1, distance.end());
    double sum = 0.0;
    for (std::size_t v = 1; v < sound.size(); ++v) sum += std::exp((nearest - distance[v]) / kTold);
    for (std::size_t v = 1; v < sound.size(); ++v) sound[v] = sound[0] * std::exp((nearest - distance[v]) / kTold) / sum;
    return sound;
}

}  // namespace imomushi
