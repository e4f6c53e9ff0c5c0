// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>

#include "core/base/finite.h"

namespace imomushi {

/// A name of a source or channel. It is stored in place: values go from one thread to another without memory of their own.
class InputName {
public:
    static constexpr std::size_t kLongest = 111;  ///< bytes
    InputName() = default;
    /// A longer text is cut; see fits().
    explicit InputName(std::string_view text) : size_(static_cast<std::uint8_t>(std::min(text.size(), kLongest))) { std::copy_n(text.begin(), size_, bytes_.begin()); }
    static bool fits(std::string_view text) { return text.size() <= kLongest; }
    [[nodiscard]] std::string_view text() const { return {bytes_.data(), size_}; }
    bool operator==(const InputName& o) const { return text() == o.text(); }

private:
    std::array<char, kLongest> bytes_{};
    std::uint8_t size_ = 0;
};

/// What one control of one source said, whatever kind of device or sender it is.
struct InputValue {
    static constexpr std::size_t kMost = 16;
    /// Larger numbers are refused: nothing that is mapped means them.
    static constexpr double kLargest = 1e9;
    /// Finite and within kLargest, asked without arithmetic: what comes from outside may be any bits.
    static bool isSound(double number) { return isFinite(number) && std::abs(number) <= kLargest; }
    InputName source, channel;
    std::array<double, kMost> numbers{};  ///< finite, within kLargest; what they mean says the decoder of the source
    int count = 0;                        ///< how many of them there are, from 1
    std::int64_t nanoseconds = 0;         ///< when it came, since listening began
    bool gone = false;                    ///< it says nothing from now on: its device was plugged out
};

using InputSink = std::function<void(const InputValue&)>;

/// What came from a source so far.
struct InputCounts {
    std::uint64_t packets = 0;
    std::uint64_t values = 0;     ///< that were handed on
    std::uint64_t ignored = 0;    ///< messages that say nothing that could be mapped
    std::uint64_t malformed = 0;  ///< packets that were dropped whole: broken, too long, not finite
    bool operator==(const InputCounts&) const = default;
};

}  // namespace imomushi
