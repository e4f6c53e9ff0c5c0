// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

// How the content of a message to or from a worker is written and read, in the machine's own byte order: both are the same program.

namespace imomushi {

class ByteWriter {
public:
    template <class T>
    requires std::is_arithmetic_v<T>
    void value(T v) { bytes_.append(reinterpret_cast<const char*>(&v), sizeof v); }
    template <class T>
    void items(const T* data, std::size_t count) {
        value(static_cast<std::uint64_t>(count));
        if (count > 0) bytes_.append(reinterpret_cast<const char*>(data), count * sizeof(T));
    }
    /// As they are, without a count.
    void raw(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }
    void text(std::string_view s) { items(s.data(), s.size()); }
    template <class M>
    void matrix(const M& m) {
        items(m.data(), static_cast<std::size_t>(m.size()));
    }
    std::string take() { return std::move(bytes_); }

private:
    std::string bytes_;
};

/// Reads what ByteWriter wrote. After the first thing that does not fit everything reads as empty and good() is false.
class ByteReader {
public:
    explicit ByteReader(std::string_view bytes) : rest_(bytes) {}
    [[nodiscard]] bool good() const { return good_; }
    [[nodiscard]] bool finished() const { return good_ && rest_.empty(); }
    void refuse() { good_ = false; }
    [[nodiscard]] std::size_t left() const { return rest_.size(); }

    template <class T>
    requires std::is_arithmetic_v<T> T value() {
        T v{};
        if (!good_ || rest_.size() < sizeof v) {
            good_ = false;
            return T{};
        }
        std::memcpy(&v, rest_.data(), sizeof v);
        rest_.remove_prefix(sizeof v);
        return v;
    }
    /// How many items of `size` bytes follow.
    std::size_t count(std::size_t size) {
        const auto n = value<std::uint64_t>();
        if (!good_ || n > rest_.size() / size) {
            good_ = false;
            return 0;
        }
        return static_cast<std::size_t>(n);
    }
    template <class T>
    std::vector<T> items() {
        std::vector<T> v(count(sizeof(T)));
        copy(v.data(), v.size() * sizeof(T));
        return v;
    }
    std::string text() {
        std::string s(count(1), '\0');
        copy(s.data(), s.size());
        return s;
    }
    template <class M>
    void matrix(M& m) {
        const std::size_t n = count(sizeof(typename M::Scalar));
        if (n % static_cast<std::size_t>(M::ColsAtCompileTime) != 0) {
            good_ = false;
            return;
        }
        m.resize(static_cast<Eigen::Index>(n) / M::ColsAtCompileTime, M::ColsAtCompileTime);
        copy(m.data(), n * sizeof(typename M::Scalar));
    }

    /// As many bytes as raw() wrote.
    void copy(void* to, std::size_t n) {
        if (rest_.size() < n) good_ = false;
        if (!good_ || n == 0) return;
        std::memcpy(to, rest_.data(), n);
        rest_.remove_prefix(n);
    }

private:
    std::string_view rest_;
    bool good_ = true;
};

}  // namespace imomushi
