// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/sqlite.h"

#include <sqlite3.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <new>
#include <utility>

#include "core/base/atomic_file.h"
#include "core/base/hash.h"
#include "core/document/sqlite_file.h"

namespace imomushi {

namespace {

void check(sqlite3* handle, int code) {
    if (code == SQLITE_OK || code == SQLITE_DONE || code == SQLITE_ROW) return;
    const int kind = code & 0xff, system = kind == SQLITE_FULL ? ENOSPC : kind == SQLITE_IOERR && handle ? sqlite3_system_errno(handle) : 0;
    DatabaseError error(system ? std::strerror(system) : handle ? sqlite3_errmsg(handle) : sqlite3_errstr(code));
    error.diskFull = isDiskFull(system);
    throw error;
}

/// Databases of SQLite's ":memory:" have no limit of their own: those over 1 GB are saved too.
sqlite3* openMemory() {
    sqlite3* handle = nullptr;
    const int code = sqlite3_open_v2(":memory:", &handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_MEMORY, nullptr);
    if (code != SQLITE_OK) {
        sqlite3_close(handle);
        throw DatabaseError(sqlite3_errstr(code));
    }
    sqlite3_extended_result_codes(handle, 1);
    return handle;
}

void distrust(sqlite3* handle) {
    sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    check(handle, sqlite3_exec(handle, "PRAGMA cell_size_check=ON", nullptr, nullptr, nullptr));
}

sqlite3_stmt* prepare(Database& database, const char* sql) {
    sqlite3_stmt* statement = nullptr;
    check(database.handle(), sqlite3_prepare_v2(database.handle(), sql, -1, &statement, nullptr));
    return statement;
}

constexpr const char* kInsertPart = "INSERT INTO value_parts VALUES (?,?,?)";

std::string partsOf(std::int64_t parted) { return "SELECT position, bytes FROM value_parts WHERE value=" + std::to_string(parted) + " ORDER BY position"; }

/// What stands for a part that is in a store: its key and size.
std::pair<ContentKey, std::size_t> sharedPart(RowReader& parts) {
    const auto numbers = parts.array<std::uint64_t>(3);
    if (numbers.size() != 3 || numbers[2] > kPartBytes) throw DatabaseError("a part is broken");
    return {{numbers[0], numbers[1]}, numbers[2]};
}

}  // namespace

Database::Database() : handle_(openMemory()) {}

Database::Database(std::span<const std::byte> file) : handle_(openMemory()) {
    try {
        auto* copy = static_cast<unsigned char*>(sqlite3_malloc64(file.size() + 1));
        if (!copy) throw std::bad_alloc();
        std::copy_n(reinterpret_cast<const unsigned char*>(file.data()), file.size(), copy);
        const auto size = static_cast<sqlite3_int64>(file.size());
        check(handle_, sqlite3_deserialize(handle_, "main", copy, size, size, SQLITE_DESERIALIZE_FREEONCLOSE | SQLITE_DESERIALIZE_READONLY));
        distrust(handle_);
    } catch (...) {
        sqlite3_close(handle_);
        throw;
    }
}

Database::Database(int file, Access access) {
    try {
        check(handle_, openDatabaseFile(file, access == Access::Write, &handle_));
        sqlite3_extended_result_codes(handle_, 1);
        run("PRAGMA temp_store=MEMORY");
        if (access == Access::Write) {
            run("PRAGMA page_size=4096");
            run("PRAGMA journal_mode=OFF");
            run("PRAGMA synchronous=OFF");
        } else {
            distrust(handle_);
        }
    } catch (...) {
        sqlite3_close(handle_);
        throw;
    }
}

Database::Database(const std::filesystem::path& file, bool make) {
    try {
        check(handle_, sqlite3_open_v2(file.c_str(), &handle_, SQLITE_OPEN_READWRITE | (make ? SQLITE_OPEN_CREATE : 0) | SQLITE_OPEN_NOMUTEX, nullptr));
        sqlite3_extended_result_codes(handle_, 1);
        sqlite3_busy_timeout(handle_, 3000);
        sqlite3_db_config(handle_, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
        distrust(handle_);
    } catch (...) {
        sqlite3_close(handle_);
        throw;
    }
}

Database::~Database() { sqlite3_close(handle_); }

void Database::run(const char* sql) { check(handle_, sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr)); }

std::int64_t Database::number(const char* sql) {
    sqlite3_stmt* statement = prepare(*this, sql);
    const int code = sqlite3_step(statement);
    const std::int64_t value = code == SQLITE_ROW ? sqlite3_column_int64(statement, 0) : 0;
    sqlite3_finalize(statement);
    check(handle_, code);
    return value;
}

std::vector<std::byte> Database::file() {
    sqlite3_int64 size = 0;
    const std::unique_ptr<unsigned char, decltype(&sqlite3_free)> bytes(sqlite3_serialize(handle_, "main", &size, 0), sqlite3_free);
    if (!bytes) throw std::bad_alloc();
    const auto* first = reinterpret_cast<const std::byte*>(bytes.get());
    return {first, first + size};
}

std::string Database::digest(std::span<const char* const> tables) {
    ContentHasher hasher;
    for (const char* table : tables) {
        sqlite3_stmt* statement = prepare(*this, ("SELECT * FROM " + std::string(table) + " ORDER BY rowid").c_str());
        int code = SQLITE_ROW;
        while ((code = sqlite3_step(statement)) == SQLITE_ROW)
            for (int column = 0; column < sqlite3_column_count(statement); ++column) {
                const int type = sqlite3_column_type(statement, column);
                hasher.number(type);
                if (type == SQLITE_FLOAT) {
                    hasher.number(sqlite3_column_double(statement, column));
                } else {
                    const void* bytes = sqlite3_column_blob(statement, column);  // whole numbers as their text
                    hasher.bytes(bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement, column)));
                }
            }
        sqlite3_finalize(statement);
        check(handle_, code);
    }
    return hasher.key().hex();
}

void Database::beginParts() {
    if (parted_++ == 0) run("CREATE TABLE value_parts (value INTEGER, position INTEGER, bytes BLOB, PRIMARY KEY (value, position))");
}

void Database::addPart(RowWriter& rows, std::int64_t position, std::span<const std::byte> part) {
    if (!store_) return rows.row(parted_, position, part);
    const ContentKey key = store_->keep(part);
    rows.row(parted_, position, std::vector<std::uint64_t>{key.high, key.low, part.size()});
}

std::int64_t Database::divide(const void* data, std::size_t size) {
    beginParts();
    const std::span<const std::byte> bytes(static_cast<const std::byte*>(data), size);
    RowWriter rows(*this, kInsertPart);
    for (std::size_t at = 0; at < size; at += kPartBytes) addPart(rows, static_cast<std::int64_t>(at / kPartBytes), bytes.subspan(at, std::min(kPartBytes, size - at)));
    return parted_;
}

std::int64_t Database::divideLike(Database& from, std::int64_t parted) {
    beginParts();
    RowWriter rows(*this, kInsertPart);
    RowReader parts(from, partsOf(parted).c_str());
    while (parts.next()) {
        const std::int64_t position = parts.integer();
        const auto part = parts.array<std::byte>();
        addPart(rows, position, part);
    }
    return parted_;
}

void Database::addRows(Database& from, const char* table) {
    const std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)> rows(prepare(from, ("SELECT * FROM " + std::string(table) + " ORDER BY rowid").c_str()), sqlite3_finalize);
    const int columns = sqlite3_column_count(rows.get());
    std::string sql = "INSERT INTO " + std::string(table) + " VALUES (?";
    for (int c = 1; c < columns; ++c) sql += ",?";
    RowWriter writer(*this, (sql + ")").c_str());
    int code = SQLITE_ROW;
    while ((code = sqlite3_step(rows.get())) == SQLITE_ROW) {
        writer.column_ = 0;
        for (int c = 0; c < columns; ++c) {
            const char* declared = sqlite3_column_decltype(rows.get(), c);
            switch (sqlite3_column_type(rows.get(), c)) {
                case SQLITE_INTEGER: {
                    const std::int64_t value = sqlite3_column_int64(rows.get(), c);
                    writer.bind(declared && std::strcmp(declared, "BLOB") == 0 ? divideLike(from, value) : value);
                    break;
                }
                case SQLITE_FLOAT: writer.bind(sqlite3_column_double(rows.get(), c)); break;
                case SQLITE_NULL: writer.bind(std::optional<double>()); break;
                case SQLITE_TEXT: {
                    const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(rows.get(), c));
                    writer.bind(std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(rows.get(), c))));
                    break;
                }
                default: {
                    const void* bytes = sqlite3_column_blob(rows.get(), c);
                    writer.blob(bytes, static_cast<std::size_t>(sqlite3_column_bytes(rows.get(), c)));
                }
            }
        }
        writer.finish();
    }
    check(from.handle(), code);
}

std::size_t Database::sizeOf(std::int64_t parted) {
    const Row row = row_;
    std::size_t size = 0;
    {
        RowReader parts(*this, (store_ ? partsOf(parted) : "SELECT 0, sum(length(bytes)) FROM value_parts WHERE value=" + std::to_string(parted)).c_str());
        while (parts.next()) {
            parts.integer();
            size += store_ ? sharedPart(parts).second : static_cast<std::size_t>(parts.integer());  // NULL where there are none
        }
    }
    row_ = row;
    return size;
}

void Database::copy(std::int64_t parted, void* to) {
    const Row row = row_;
    auto* next = static_cast<std::byte*>(to);
    RowReader parts(*this, partsOf(parted).c_str());
    for (std::int64_t position = 0; parts.next(); ++position) {
        parts.integer(position, position);
        if (store_) {
            const auto [key, size] = sharedPart(parts);
            const auto part = store_->find(key);
            if (part.size() != size) throw DatabaseError("a part has a broken size");
            next = std::copy(part.begin(), part.end(), next);
        } else {
            next += parts.part(next);
        }
    }
    row_ = row;
}

RowWriter::RowWriter(Database& database, const char* sql) : database_(database), statement_(prepare(database, sql)) {}
RowWriter::~RowWriter() { sqlite3_finalize(statement_); }

void RowWriter::bind(std::int64_t value) {
    check(database_.handle(), sqlite3_bind_int64(statement_, ++column_, value));
}

void RowWriter::bind(double value) {
    if (!isFinite(value)) throw DatabaseError("a number is not finite");  // SQLite would store NaN as NULL
    check(database_.handle(), sqlite3_bind_double(statement_, ++column_, value));
}

void RowWriter::bind(const std::optional<double>& value) {
    if (value) return bind(*value);
    check(database_.handle(), sqlite3_bind_null(statement_, ++column_));
}

void RowWriter::bind(const std::string& value) {
    check(database_.handle(), sqlite3_bind_text64(statement_, ++column_, value.data(), value.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
}

void RowWriter::blob(const void* data, std::size_t size) {
    if (size > database_.wholeBytes()) return bind(database_.divide(data, size));
    static const char kEmpty = 0;  // a null pointer would become NULL
    check(database_.handle(), sqlite3_bind_blob64(statement_, ++column_, size ? data : &kEmpty, size, SQLITE_STATIC));
}

void RowWriter::finish() {
    check(database_.handle(), sqlite3_step(statement_));
    check(database_.handle(), sqlite3_reset(statement_));
}

RowReader::RowReader(Database& database, const char* sql) : database_(database), statement_(prepare(database, sql)) {
    constexpr std::string_view kFrom = " FROM ";
    const std::string_view text(sql);
    const std::size_t begin = std::min(text.find(kFrom), text.size() - kFrom.size()) + kFrom.size();
    table_ = text.substr(begin, text.find(' ', begin) - begin);
}
RowReader::~RowReader() { sqlite3_finalize(statement_); }

bool RowReader::next() {
    column_ = 0;
    const int code = sqlite3_step(statement_);
    check(database_.handle(), code);
    if (code == SQLITE_ROW)
        database_.row_ = {table_, sqlite3_column_int64(statement_, 0)};
    else
        database_.row_ = {};
    return code == SQLITE_ROW;
}

void RowReader::expect(int type) {
    if (sqlite3_column_type(statement_, column_) != type) throw DatabaseError("a value has the wrong type");
}

std::int64_t RowReader::integer() {
    expect(SQLITE_INTEGER);
    return sqlite3_column_int64(statement_, column_++);
}

std::int64_t RowReader::integer(std::int64_t low, std::int64_t high) {
    const std::int64_t value = integer();
    if (value < low || value > high) throw DatabaseError("a whole number is out of range");
    return value;
}

double RowReader::real() {
    expect(SQLITE_FLOAT);
    const double value = sqlite3_column_double(statement_, column_++);
    if (!isFinite(value)) throw DatabaseError("a number is not finite");
    return value;
}

double RowReader::real(double low, double high) {
    const double value = real();
    if (value < low || value > high) throw DatabaseError("a number is out of range");
    return value;
}

std::optional<double> RowReader::optionalReal() {
    if (sqlite3_column_type(statement_, column_) != SQLITE_NULL) return real();
    ++column_;
    return std::nullopt;
}

std::string RowReader::text() {
    expect(SQLITE_TEXT);
    const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column_));
    std::string value(bytes ? bytes : "", static_cast<std::size_t>(sqlite3_column_bytes(statement_, column_)));
    ++column_;
    return value;
}

std::size_t RowReader::size() {
    if (sqlite3_column_type(statement_, column_) == SQLITE_INTEGER) return database_.sizeOf(sqlite3_column_int64(statement_, column_));
    expect(SQLITE_BLOB);
    return static_cast<std::size_t>(sqlite3_column_bytes(statement_, column_));
}

void RowReader::copy(void* to) {
    if (sqlite3_column_type(statement_, column_) == SQLITE_INTEGER)
        database_.copy(sqlite3_column_int64(statement_, column_++), to);
    else
        part(to);
}

std::size_t RowReader::part(void* to) {
    expect(SQLITE_BLOB);
    const void* bytes = sqlite3_column_blob(statement_, column_);
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column_));
    if (size > 0) std::memcpy(to, bytes, size);
    ++column_;
    return size;
}

}  // namespace imomushi
