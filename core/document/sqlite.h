// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/finite.h"

struct sqlite3;
struct sqlite3_stmt;

namespace imomushi {

/// Why a database could not be written or read. Callers of saveProject(), openProject(), packResponse() and unpackResponse() get an Error instead.
struct DatabaseError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A database in memory: built row by row and turned into the bytes of a file, or the other way round. One value has 10^9 bytes at most (SQLite's default).
class Database {
public:
    Database();                                          ///< empty
    explicit Database(std::span<const std::byte> file);  ///< a copy of the bytes of a file, read only
    ~Database();
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;

    void run(const char* sql);
    [[nodiscard]] std::int64_t number(const char* sql);
    [[nodiscard]] std::vector<std::byte> file();  ///< its bytes
    [[nodiscard]] sqlite3* handle() { return handle_; }
    /// Of the types and bytes of all values in `tables`, row by row: 32 hexadecimal digits.
    [[nodiscard]] std::string digest(std::span<const char* const> tables);

private:
    sqlite3* handle_ = nullptr;
};

/// Writes rows of one table: row(1, "name", blob, ...).
class RowWriter {
public:
    RowWriter(Database& database, const char* sql);
    ~RowWriter();
    RowWriter(const RowWriter&) = delete;
    RowWriter& operator=(const RowWriter&) = delete;

    template <class... Values>
    void row(const Values&... values) {
        column_ = 0;
        (bind(values), ...);
        finish();
    }

private:
    void bind(bool value) { bind(std::int64_t{value}); }
    void bind(int value) { bind(static_cast<std::int64_t>(value)); }
    void bind(std::uint64_t value) { bind(static_cast<std::int64_t>(value)); }
    void bind(std::int64_t value);
    void bind(double value);
    void bind(float value) { bind(static_cast<double>(value)); }
    void bind(const std::string& value);
    void bind(const char* value) { bind(std::string(value)); }
    void bind(const std::optional<double>& value);
    template <class T>
    void bind(const std::vector<T>& values) {
        blob(values.data(), values.size() * sizeof(T));
    }
    template <class Derived>
    void bind(const Eigen::PlainObjectBase<Derived>& values) {
        blob(values.data(), static_cast<std::size_t>(values.size()) * sizeof(typename Derived::Scalar));
    }
    void blob(const void* data, std::size_t size);
    void finish();

    Database& database_;
    sqlite3_stmt* statement_ = nullptr;
    int column_ = 0;
};

/// Reads rows, column by column; each value must have the type that is asked for.
class RowReader {
public:
    RowReader(Database& database, const char* sql);
    ~RowReader();
    RowReader(const RowReader&) = delete;
    RowReader& operator=(const RowReader&) = delete;

    bool next();
    std::int64_t integer();
    /// Within [low, high].
    std::int64_t integer(std::int64_t low, std::int64_t high);
    bool boolean() { return integer(0, 1) == 1; }
    double real();
    double real(double low, double high);
    std::optional<double> optionalReal();
    std::string text();
    /// An array whose size must be a multiple of `width` items.
    template <class T>
    std::vector<T> array(std::size_t width = 1) {
        const std::string_view bytes = blob();
        if (bytes.size() % (sizeof(T) * width) != 0) throw DatabaseError("an array has a broken size");
        std::vector<T> values(bytes.size() / sizeof(T));
        if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
        return values;
    }
    /// A matrix of as many columns as its type has, any number of rows.
    template <class Matrix>
    Matrix matrix() {
        constexpr int kColumns = Matrix::ColsAtCompileTime;
        const auto values = array<typename Matrix::Scalar>(static_cast<std::size_t>(kColumns));
        if (values.size() / kColumns > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) throw DatabaseError("an array is too long");
        Matrix m(static_cast<Eigen::Index>(values.size()) / kColumns, kColumns);
        if (!values.empty()) std::memcpy(m.data(), values.data(), values.size() * sizeof values[0]);
        return m;
    }

private:
    std::string_view blob();
    void expect(int type);

    Database& database_;
    sqlite3_stmt* statement_ = nullptr;
    int column_ = 0;
};

}  // namespace imomushi
