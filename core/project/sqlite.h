// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/base/finite.h"
#include "core/base/hash.h"

struct sqlite3;
struct sqlite3_stmt;

namespace imomushi {

class RowWriter;

/// Why a database could not be written or read. Callers of saveProject(), openProject(), packResponse() and unpackResponse() get an Error instead. Memory that
/// runs out is no DatabaseError but std::bad_alloc: it says nothing of the file.
struct DatabaseError : std::runtime_error {
    enum class Kind {
        Damaged,   ///< the content is not what it should be
        DiskFull,
        Refused,   ///< the system does not read or write the file: permissions, a broken disk
        Busy,      ///< another process has it
        TooLarge,  ///< a value or row is larger than a database takes
    };
    explicit DatabaseError(const std::string& what, Kind why = Kind::Damaged) : std::runtime_error(what), kind(why) {}
    Kind kind;
    /// Whether what was read is to blame: a value that no database of ours has is too large, too.
    [[nodiscard]] bool damaged() const { return kind == Kind::Damaged || kind == Kind::TooLarge; }
};

/// Arrays larger than this, bytes, are divided into parts of this size, so that neither writing nor reading one needs more memory than a few parts beside the array.
/// SQLite takes no row over 10^9 bytes.
inline constexpr std::size_t kPartBytes = std::size_t{16} << 20;

/// Arrays over this size, bytes, are divided where there is a PartStore.
inline constexpr std::size_t kSharedBytes = 4096;

/// Keeps parts of arrays outside of a database, each once however many databases have it.
class PartStore {
public:
    virtual ~PartStore() = default;
    virtual ContentKey keep(std::span<const std::byte> part) = 0;
    /// Throws DatabaseError where the part is not there or damaged.
    virtual std::vector<std::byte> find(const ContentKey& key) = 0;
};

/// A database in memory, built row by row and turned into the bytes of a file, or the other way round; or in a file of its own. What is read is not trusted:
/// views, triggers and functions that a schema names have no effect.
/// A divided array has rows in the table of createPartTable(), and their number where the array would be.
class Database {
public:
    enum class Access { Write, Read };
    Database();                                          ///< empty
    explicit Database(std::span<const std::byte> file);  ///< a copy of the bytes of a file, read only
    /// In the file that is open as `file`: a new one, which is to be empty and needs to be flushed when this is gone, or one that is only read.
    Database(int file, Access access);
    /// A file that other processes may have open too, made where there is none and `make` is set. Changes are transactions.
    Database(const std::filesystem::path& file, bool make);
    ~Database();
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;

    void run(const char* sql);
    [[nodiscard]] std::int64_t number(const char* sql);
    [[nodiscard]] std::vector<std::byte> file();  ///< its bytes
    [[nodiscard]] sqlite3* handle() { return handle_; }

    /// The tables that hold rows, by name: no views, no virtual tables.
    [[nodiscard]] std::vector<std::string> tables();
    /// Hash of the names of all tables() and of the types and bytes of their values, row by row, without the row of the digest itself. Returns 32 hexadecimal digits.
    [[nodiscard]] std::string digest();
    /// The last thing that is written: a table "info" with the name of the program and the digest.
    void seal();
    /// Throws DatabaseError where the content is not what was sealed.
    void checkSeal();
    /// Throws DatabaseError unless each table, index, view and trigger of `model` is here with the same SQL text. Returns the names of those that only this database has.
    [[nodiscard]] std::vector<std::string> compareSchema(Database& model);

    static constexpr const char* kPartTable = "value_parts";
    void createPartTable();
    /// The parts of arrays are or go there. `store` must outlive this.
    void setStore(PartStore& store) { store_ = &store; }
    [[nodiscard]] std::size_t wholeBytes() const { return store_ ? kSharedBytes : kPartBytes; }
    /// Keeps an array in parts. Its number.
    std::int64_t divide(const void* data, std::size_t size);
    /// Adds the rows of a table of another database to the same table of this one, large arrays part by part.
    void addRows(Database& from, const std::string& table);
    /// Puts the parts of an array together, where `room`(bytes) says.
    void copyParts(std::int64_t parted, const std::function<void*(std::size_t)>& room);

    /// The row that is being read, of the reader that moved last.
    struct Row {
        std::string table;  ///< empty: none, all that was asked for is read
        std::int64_t id = 0;  ///< its first column, as a whole number
    };
    [[nodiscard]] const Row& row() const { return row_; }

private:
    friend class RowReader;
    std::int64_t divideLike(Database& from, std::int64_t parted);
    void addPart(RowWriter& rows, std::int64_t position, std::int64_t total, std::span<const std::byte> part);

    Row row_;
    PartStore* store_ = nullptr;
    sqlite3* handle_ = nullptr;
    std::int64_t parted_ = 0;  // arrays that were divided
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
    friend class Database;
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
    void bind(std::span<const std::byte> bytes) { blob(bytes.data(), bytes.size()); }
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
        std::vector<T> values;
        takeArray([&](std::size_t bytes) {
            if (bytes % (sizeof(T) * width) != 0) throw DatabaseError("an array has a broken size");
            values.resize(bytes / sizeof(T));
            return static_cast<void*>(values.data());
        });
        return values;
    }
    /// A matrix of as many columns as its type has, any number of rows.
    template <class Matrix>
    Matrix matrix() {
        constexpr int kColumns = Matrix::ColsAtCompileTime;
        constexpr std::size_t kRow = kColumns * sizeof(typename Matrix::Scalar);
        Matrix m;
        takeArray([&](std::size_t bytes) {
            if (bytes % kRow != 0) throw DatabaseError("an array has a broken size");
            if (bytes / kRow > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) throw DatabaseError("an array is too long");
            m.resize(static_cast<Eigen::Index>(bytes / kRow), kColumns);
            return static_cast<void*>(m.data());
        });
        return m;
    }

private:
    friend class Database;
    void takeArray(const std::function<void*(std::size_t)>& room);  // which may be divided; into `room`(bytes)
    std::span<const std::byte> bytes();                             // an array of this row, until the next one
    void expect(int type);

    Database& database_;
    sqlite3_stmt* statement_ = nullptr;
    int column_ = 0;
    std::string table_;  // after FROM
};

}  // namespace imomushi
