// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <type_traits>
#include <vector>

#include "core/base/result.h"
#include "core/base/utf8.h"
#include "core/worker/bytes.h"

// Values in messages. A struct of ours becomes one by a function that lists its members, found where the struct is:
//     void members(auto& archive, BodySetting& s) { archive(s.how, s.detail); }
// and where there is a function sound() of it, too, what is read must pass it. Of an enumeration lastOf(value) says which values there are. Texts are UTF-8.
namespace imomushi {

template <class M>
concept DenseMatrix = std::is_base_of_v<Eigen::PlainObjectBase<M>, M>;

template <class T>
inline constexpr bool kIsVector = false;
template <class T>
inline constexpr bool kIsVector<std::vector<T>> = true;
template <class T>
inline constexpr bool kIsOptional = false;
template <class T>
inline constexpr bool kIsOptional<std::optional<T>> = true;
template <class T>
inline constexpr bool kIsExpected = false;
template <class T, class E>
inline constexpr bool kIsExpected<tl::expected<T, E>> = true;

void members(auto& archive, Error& e) { archive(e.code, e.message); }

/// Writes values one after the other.
class MessageOut {
public:
    template <class... T>
    void operator()(const T&... values) {
        (write(values), ...);
    }
    std::string take() { return writer_.take(); }

private:
    template <class T>
    void write(const T& v) {
        if constexpr (std::is_arithmetic_v<T>) {
            writer_.value(v);
        } else if constexpr (std::is_enum_v<T>) {
            writer_.value(static_cast<std::int32_t>(v));
        } else if constexpr (std::is_same_v<T, std::string>) {
            writer_.text(v);
        } else if constexpr (std::is_same_v<T, std::filesystem::path>) {
            writer_.text(v.native());
        } else if constexpr (DenseMatrix<T>) {
            writer_.value(static_cast<std::int64_t>(v.rows()));
            writer_.value(static_cast<std::int64_t>(v.cols()));
            writer_.raw(v.data(), static_cast<std::size_t>(v.size()) * sizeof(typename T::Scalar));
        } else if constexpr (std::is_same_v<T, Eigen::Quaterniond>) {
            write(Eigen::Vector4d(v.coeffs()));
        } else if constexpr (kIsVector<T>) {
            if constexpr (std::is_arithmetic_v<typename T::value_type>) {
                writer_.items(v.data(), v.size());
            } else {
                writer_.value(static_cast<std::uint64_t>(v.size()));
                for (const auto& item : v) write(item);
            }
        } else if constexpr (kIsOptional<T> || kIsExpected<T>) {
            writer_.value(static_cast<std::uint8_t>(v.has_value()));
            if (v) write(*v);
            if constexpr (kIsExpected<T>)
                if (!v) write(v.error());
        } else {
            members(*this, const_cast<T&>(v));  // lists them for both directions
        }
    }

    ByteWriter writer_;
};

/// Reads what MessageOut wrote. After the first thing that does not fit, good() is false and what follows stays as it is.
class MessageIn {
public:
    explicit MessageIn(std::string_view bytes) : reader_(bytes) {}
    [[nodiscard]] bool finished() const { return reader_.finished(); }
    template <class... T>
    void operator()(T&... values) {
        (read(values), ...);
    }

private:
    template <class T>
    void read(T& v) {
        if (!reader_.good()) return;
        if constexpr (std::is_same_v<T, bool>) {
            const auto n = reader_.value<std::uint8_t>();
            if (n > 1) reader_.refuse();
            v = n == 1;
        } else if constexpr (std::is_arithmetic_v<T>) {
            v = reader_.value<T>();
        } else if constexpr (std::is_enum_v<T>) {
            const auto n = reader_.value<std::int32_t>();
            if (n < 0 || n > static_cast<std::int32_t>(lastOf(T{}))) return reader_.refuse();
            v = static_cast<T>(n);
        } else if constexpr (std::is_same_v<T, std::string>) {
            v = reader_.text();
            if (!isUtf8(v)) reader_.refuse();
        } else if constexpr (std::is_same_v<T, std::filesystem::path>) {
            v = reader_.text();
        } else if constexpr (DenseMatrix<T>) {
            const auto rows = reader_.value<std::int64_t>(), cols = reader_.value<std::int64_t>();
            const auto left = static_cast<std::int64_t>(reader_.left() / sizeof(typename T::Scalar));
            const auto fits = [](std::int64_t n, int fixed) { return fixed == Eigen::Dynamic ? n >= 0 : n == fixed; };
            if (!fits(rows, T::RowsAtCompileTime) || !fits(cols, T::ColsAtCompileTime) || (cols > 0 && rows > left / cols))
                return reader_.refuse();
            v.resize(rows, cols);
            reader_.copy(v.data(), static_cast<std::size_t>(v.size()) * sizeof(typename T::Scalar));
        } else if constexpr (std::is_same_v<T, Eigen::Quaterniond>) {
            Eigen::Vector4d coefficients = v.coeffs();
            read(coefficients);
            v.coeffs() = coefficients;
        } else if constexpr (kIsVector<T>) {
            if constexpr (std::is_arithmetic_v<typename T::value_type>) {
                v = reader_.items<typename T::value_type>();
            } else {
                const std::size_t n = reader_.count(1);
                v.clear();
                for (std::size_t i = 0; i < n && reader_.good(); ++i) read(v.emplace_back());
            }
        } else if constexpr (kIsOptional<T>) {
            v.reset();
            if (reader_.value<std::uint8_t>() != 0) read(v.emplace());
        } else if constexpr (kIsExpected<T>) {
            if (reader_.value<std::uint8_t>() != 0) {
                typename T::value_type value{};
                read(value);
                v = std::move(value);
            } else {
                typename T::error_type error{};
                read(error);
                v = tl::unexpected(std::move(error));
            }
        } else {
            members(*this, v);
            if constexpr (requires { sound(v); })
                if (reader_.good() && !sound(v)) reader_.refuse();
        }
    }

    ByteReader reader_;
};

}  // namespace imomushi
