// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/io/raw_scene.h"

// How the content of a message (message.h) is written and read. Both follow from fields(value): the members of a struct in their order, as listed() gives them.
// Of an enumeration lastOf(value) says which values there are.

namespace imomushi {

inline constexpr std::uint64_t kMaxMessageItems = std::uint64_t{1} << 30;

template <class... Field>
std::tuple<Field...> listed(Field&&... fields) {
    return {std::forward<Field>(fields)...};
}

/// A field that is a name: what is read is clean, see cleanName().
template <class Text>
struct NameField {
    Text& text;
    const char* otherwise;
};
template <class Text>
NameField<Text> named(Text& text, const char* otherwise = "") {
    return {text, otherwise};
}

/// What a fields() takes: `Of`, constant where it is written.
template <class T, class Of>
concept Some = std::is_same_v<std::remove_const_t<T>, Of>;

class MessageWriter {
public:
    template <class... Field>
    void operator()(const Field&... values) {
        (write(values), ...);
    }
    std::string take() { return std::move(bytes_); }

private:
    template <class T>
    void write(const T& v) {
        if constexpr (std::is_enum_v<T> || std::is_same_v<T, bool>)
            write(static_cast<std::uint8_t>(v));
        else if constexpr (std::is_arithmetic_v<T>)
            bytes_.append(reinterpret_cast<const char*>(&v), sizeof v);
        else if constexpr (requires { v.coeffs(); })
            write(v.coeffs());
        else if constexpr (requires { v.derived(); })
            items(v.derived().data(), static_cast<std::size_t>(v.size()));
        else if constexpr (requires { v.size(); })
            items(v.data(), v.size());
        else
            std::apply([this](const auto&... values) { (write(values), ...); }, fields(v));
    }
    template <class Text>
    void write(const NameField<Text>& name) {
        write(name.text);
    }
    template <class T>
    void write(const std::optional<T>& v) {
        write(v.has_value());
        if (v) write(*v);
    }
    template <class T>
    void items(const T* data, std::size_t count) {
        write(static_cast<std::uint64_t>(count));
        if constexpr (std::is_arithmetic_v<T>) {
            if (count > 0) bytes_.append(reinterpret_cast<const char*>(data), count * sizeof(T));
        } else {
            for (std::size_t i = 0; i < count; ++i) write(data[i]);
        }
    }

    std::string bytes_;
};

/// Reads what MessageWriter wrote. After the first thing that does not fit everything reads as empty and good() is false.
class MessageReader {
public:
    explicit MessageReader(std::string_view bytes) : rest_(bytes) {}
    [[nodiscard]] bool good() const { return good_; }
    [[nodiscard]] bool finished() const { return good_ && rest_.empty(); }
    template <class... Field>
    void operator()(Field&&... values) {
        (read(values), ...);
    }

private:
    template <class T>
    void read(T& v) {
        if constexpr (std::is_enum_v<T> || std::is_same_v<T, bool>) {
            std::uint8_t n = 0;
            read(n);
            if constexpr (std::is_enum_v<T>)
                good_ = good_ && n <= static_cast<std::uint8_t>(lastOf(T{}));
            else
                good_ = good_ && n <= 1;
            v = good_ ? static_cast<T>(n) : T{};
        } else if constexpr (std::is_arithmetic_v<T>) {
            good_ = good_ && rest_.size() >= sizeof v;
            v = T{};
            copy(&v, sizeof v);
        } else if constexpr (requires { v.coeffs(); }) {
            read(v.coeffs());
        } else if constexpr (requires { v.derived(); }) {
            const std::size_t n = count(sizeof(typename T::Scalar));
            if constexpr (T::RowsAtCompileTime == Eigen::Dynamic) {
                good_ = good_ && n % static_cast<std::size_t>(T::ColsAtCompileTime) == 0;
                if (good_) v.resize(static_cast<Eigen::Index>(n) / T::ColsAtCompileTime, T::ColsAtCompileTime);
            } else {
                good_ = good_ && n == static_cast<std::size_t>(T::SizeAtCompileTime);
            }
            copy(v.data(), n * sizeof(typename T::Scalar));
        } else if constexpr (requires { v.size(); }) {
            using Item = typename T::value_type;
            if constexpr (std::is_arithmetic_v<Item>) {
                v.resize(count(sizeof(Item)));
                copy(v.data(), v.size() * sizeof(Item));
            } else {
                const std::size_t n = count(1);
                for (std::size_t i = 0; i < n && good_; ++i) read(v.emplace_back());
            }
        } else {
            std::apply([this](auto&&... values) { (read(values), ...); }, fields(v));
        }
    }
    template <class Text>
    void read(NameField<Text>& name) {
        read(name.text);
        name.text = cleanName(name.text, name.otherwise);
    }
    template <class T>
    void read(std::optional<T>& v) {
        bool has = false;
        read(has);
        if (has) read(v.emplace());
    }
    /// How many items of `size` bytes follow.
    std::size_t count(std::size_t size) {
        std::uint64_t n = 0;
        read(n);
        good_ = good_ && n <= kMaxMessageItems && n <= rest_.size() / size;
        return good_ ? static_cast<std::size_t>(n) : 0;
    }
    void copy(void* to, std::size_t n) {
        if (!good_ || n == 0) return;
        std::memcpy(to, rest_.data(), n);
        rest_.remove_prefix(n);
    }

    std::string_view rest_;
    bool good_ = true;
};

}  // namespace imomushi
