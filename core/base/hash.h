// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace imomushi {

/// A 128-bit content key: equal bytes give equal keys on every machine and in every version (XXH3, a published stable hash).
struct ContentKey {
    std::uint64_t high = 0;
    std::uint64_t low = 0;
    auto operator<=>(const ContentKey&) const = default;
    /// 32 lower-case hexadecimal digits.
    [[nodiscard]] std::string hex() const;
};

/// Feeds values into a ContentKey. Everything is hashed with its length, so that neighbouring fields cannot be confused.
class ContentHasher {
public:
    ContentHasher();
    ~ContentHasher();
    ContentHasher(const ContentHasher&) = delete;
    ContentHasher& operator=(const ContentHasher&) = delete;

    void bytes(const void* data, std::size_t size);
    void text(std::string_view s) { bytes(s.data(), s.size()); }
    template <class T>
        requires std::is_arithmetic_v<T>
    void number(T value) {
        bytes(&value, sizeof value);
    }
    template <class T>
    void array(std::span<const T> values) {
        static_assert(std::is_arithmetic_v<T>);
        bytes(values.data(), values.size_bytes());
    }
    [[nodiscard]] ContentKey key() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace imomushi
