// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/project/sqlite.h"

#include <sqlite3.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <map>
#include <memory>
#include <new>
#include <utility>

#include "core/base/atomic_file.h"
#include "core/base/hash.h"
#include "core/project/sqlite_file.h"
#include "core/project/version.h"

namespace imomushi {

namespace {

using Kind = DatabaseError::Kind;

/// What an error code of SQLite, without its extension, means. Those that are not here say that the content is damaged: it is no database, names what is not
/// there, breaks a rule of its schema.
struct Meaning {
    int code;
    Kind kind;
};
constexpr Meaning kMeanings[] = {
    {SQLITE_FULL, Kind::DiskFull},  {SQLITE_IOERR, Kind::Refused}, {SQLITE_CANTOPEN, Kind::Refused}, {SQLITE_PERM, Kind::Refused},     {SQLITE_READONLY, Kind::Refused},
    {SQLITE_AUTH, Kind::Refused},   {SQLITE_NOLFS, Kind::Refused}, {SQLITE_BUSY, Kind::Busy},        {SQLITE_LOCKED, Kind::Busy},      {SQLITE_PROTOCOL, Kind::Busy},
    {SQLITE_TOOBIG, Kind::TooLarge},
};

void check(sqlite3* handle, int code) {
    if (code == SQLITE_OK || code == SQLITE_DONE || code == SQLITE_ROW) return;
    const int primary = code & 0xff;
    if (primary == SQLITE_NOMEM || code == SQLITE_IOERR_NOMEM) throw std::bad_alloc();
    const auto* known = std::find_if(std::begin(kMeanings), std::end(kMeanings), [primary](const Meaning& m) { return m.code == primary; });
    Kind kind = known == std::end(kMeanings) ? Kind::Damaged : known->kind;
    const int system = primary == SQLITE_FULL ? ENOSPC : primary == SQLITE_IOERR && handle ? sqlite3_system_errno(handle) : 0;
    if (isDiskFull(system)) kind = Kind::DiskFull;
    throw DatabaseError(system ? std::strerror(system) : handle ? sqlite3_errmsg(handle) : sqlite3_errstr(code), kind);
}

/// The bytes of a value as SQLite has them: numbers as text. Null without an error is an empty value.
std::span<const std::byte> bytesAt(sqlite3* handle, sqlite3_stmt* statement, int column) {
    const auto* bytes = static_cast<const std::byte*>(sqlite3_column_blob(statement, column));
    if (!bytes && sqlite3_errcode(handle) == SQLITE_NOMEM) throw std::bad_alloc();
    return {bytes, bytes ? static_cast<std::size_t>(sqlite3_column_bytes(statement, column)) : 0};
}

/// Databases of SQLite's ":memory:" have no limit of their own: those over 1 GB are saved too.
sqlite3* openMemory() {
    sqlite3* handle = nullptr;
    const int code = sqlite3_open_v2(":memory:", &handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_MEMORY, nullptr);
    if (code != SQLITE_OK) {
        sqlite3_close(handle);
        check(nullptr, code);
    }
    sqlite3_extended_result_codes(handle, 1);
    return handle;
}

/// Bytes: a row has a few arrays that are not divided, at most.
constexpr int kMostInRow = 16 * static_cast<int>(kPartBytes);

void distrust(sqlite3* handle) {
    sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
    sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, kMostInRow);
    check(handle, sqlite3_exec(handle, "PRAGMA cell_size_check=ON", nullptr, nullptr, nullptr));
}

sqlite3_stmt* prepare(Database& database, const char* sql) {
    sqlite3_stmt* statement = nullptr;
    check(database.handle(), sqlite3_prepare_v2(database.handle(), sql, -1, &statement, nullptr));
    return statement;
}

using Statement = std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)>;
Statement statementOf(Database& database, const std::string& sql) { return {prepare(database, sql.c_str()), sqlite3_finalize}; }

std::string quoted(const std::string& name) {
    std::string out = "\"";
    for (const char c : name) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
}

constexpr const char* kInsertPart = "INSERT INTO value_parts VALUES (?,?,?,?)";

std::string partsOf(std::int64_t parted) { return "SELECT position, total, bytes FROM value_parts WHERE value=" + std::to_string(parted) + " ORDER BY position"; }

/// Of an array in parts, bytes.
constexpr std::int64_t kMostDivided = std::int64_t{1} << 46;

constexpr const char* kInfo = "info";

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
        distrust(handle_);
    } catch (...) {
        sqlite3_close(handle_);
        throw;
    }
}

Database::~Database() { sqlite3_close(handle_); }

void Database::run(const char* sql) { check(handle_, sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr)); }

std::int64_t Database::number(const char* sql) {
    const Statement statement = statementOf(*this, sql);
    const int code = sqlite3_step(statement.get());
    check(handle_, code);
    return code == SQLITE_ROW ? sqlite3_column_int64(statement.get(), 0) : 0;
}

std::vector<std::byte> Database::file() {
    sqlite3_int64 size = 0;
    const std::unique_ptr<unsigned char, decltype(&sqlite3_free)> bytes(sqlite3_serialize(handle_, "main", &size, 0), sqlite3_free);
    if (!bytes) throw std::bad_alloc();
    const auto* first = reinterpret_cast<const std::byte*>(bytes.get());
    return {first, first + size};
}

std::vector<std::string> Database::tables() {
    std::vector<std::string> names;
    RowReader rows(*this, "SELECT name FROM sqlite_schema WHERE type='table' AND rootpage>0 AND name NOT LIKE 'sqlite\\_%' ESCAPE '\\' ORDER BY name");
    while (rows.next()) names.push_back(rows.text());
    return names;
}

std::string Database::digest() {
    ContentHasher hasher;
    for (const std::string& table : tables()) {
        hasher.text(table);
        const Statement rows = statementOf(*this, "SELECT * FROM " + quoted(table) + (table == kInfo ? " WHERE name<>'digest'" : "") + " ORDER BY rowid");
        int code = SQLITE_ROW;
        while ((code = sqlite3_step(rows.get())) == SQLITE_ROW)
            for (int column = 0; column < sqlite3_column_count(rows.get()); ++column) {
                const int type = sqlite3_column_type(rows.get(), column);
                hasher.number(type);
                if (type == SQLITE_FLOAT) {
                    hasher.number(sqlite3_column_double(rows.get(), column));
                } else {
                    const auto bytes = bytesAt(handle_, rows.get(), column);
                    hasher.bytes(bytes.data(), bytes.size());
                }
            }
        check(handle_, code);
    }
    return hasher.key().hex();
}

void Database::seal() {
    run("CREATE TABLE info (name TEXT PRIMARY KEY, value TEXT NOT NULL)");
    RowWriter info(*this, "INSERT INTO info VALUES (?,?)");
    info.row("program", std::string("imomushi ") + kVersion);
    info.row("digest", digest());
}

void Database::checkSeal() {
    RowReader info(*this, "SELECT value FROM info WHERE name='digest'");
    if (!info.next() || info.text() != digest()) throw DatabaseError("its content does not match its digest");
}

std::vector<std::string> Database::compareSchema(Database& model) {
    using Schema = std::map<std::string, std::string>;  // by name: kind and text
    const auto schemaOf = [](Database& db) {
        Schema schema;
        RowReader rows(db, "SELECT name, type || ' ' || sql FROM sqlite_schema WHERE sql IS NOT NULL ORDER BY name");
        while (rows.next()) {
            std::string name = rows.text();
            schema.emplace(std::move(name), rows.text());
        }
        return schema;
    };
    const Schema here = schemaOf(*this), wanted = schemaOf(model);
    for (const auto& [name, text] : wanted)
        if (const auto found = here.find(name); found == here.end() || found->second != text) throw DatabaseError("the table \"" + name + "\" is not as it should be");
    std::vector<std::string> others;
    for (const auto& [name, text] : here)
        if (!wanted.contains(name)) others.push_back(name);
    return others;
}

void Database::createPartTable() { run("CREATE TABLE value_parts (value INTEGER, position INTEGER, total INTEGER, bytes BLOB, PRIMARY KEY (value, position))"); }

void Database::addPart(RowWriter& rows, std::int64_t position, std::int64_t total, std::span<const std::byte> part) {
    if (!store_) return rows.row(parted_, position, total, part);
    const ContentKey key = store_->keep(part);
    rows.row(parted_, position, total, std::vector<std::uint64_t>{key.high, key.low, part.size()});
}

std::int64_t Database::divide(const void* data, std::size_t size) {
    ++parted_;
    const std::span<const std::byte> bytes(static_cast<const std::byte*>(data), size);
    RowWriter rows(*this, kInsertPart);
    for (std::size_t at = 0; at < size; at += kPartBytes)
        addPart(rows, static_cast<std::int64_t>(at / kPartBytes), static_cast<std::int64_t>(size), bytes.subspan(at, std::min(kPartBytes, size - at)));
    return parted_;
}

std::int64_t Database::divideLike(Database& from, std::int64_t parted) {
    ++parted_;
    RowWriter rows(*this, kInsertPart);
    RowReader parts(from, partsOf(parted).c_str());
    while (parts.next()) {
        const std::int64_t position = parts.integer(), total = parts.integer();
        addPart(rows, position, total, parts.bytes());
    }
    return parted_;
}

void Database::addRows(Database& from, const std::string& table) {
    const Statement rows = statementOf(from, "SELECT * FROM " + quoted(table) + " ORDER BY rowid");
    const int columns = sqlite3_column_count(rows.get());
    std::string sql = "INSERT INTO " + quoted(table) + " VALUES (?";
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
                    const auto text = bytesAt(from.handle(), rows.get(), c);
                    writer.bind(std::string(reinterpret_cast<const char*>(text.data()), text.size()));
                    break;
                }
                default: writer.bind(bytesAt(from.handle(), rows.get(), c));
            }
        }
        writer.finish();
    }
    check(from.handle(), code);
}

void Database::copyParts(std::int64_t parted, const std::function<void*(std::size_t)>& room) {
    const Row row = row_;
    std::byte* next = nullptr;
    std::size_t left = 0;
    RowReader parts(*this, partsOf(parted).c_str());
    std::int64_t position = 0, total = 0;
    for (; parts.next(); ++position) {
        parts.integer(position, position);
        const std::int64_t told = parts.integer(1, kMostDivided);
        if (position == 0) {
            // What a file of this size cannot hold is not asked for. Parts in a store may be shared.
            if (!store_ && told > number("PRAGMA page_count") * number("PRAGMA page_size")) throw DatabaseError("an array is larger than its file");
            total = told;
            left = static_cast<std::size_t>(total);
            next = static_cast<std::byte*>(room(left));
        }
        if (told != total) throw DatabaseError("an array has a broken size");
        const auto take = [&](std::span<const std::byte> part) {
            if (part.size() > left) throw DatabaseError("an array has a broken size");
            next = std::copy(part.begin(), part.end(), next);
            left -= part.size();
        };
        if (store_) {
            const auto [key, size] = sharedPart(parts);
            const auto part = store_->find(key);
            if (part.size() != size) throw DatabaseError("a part has a broken size");
            take(part);
        } else {
            take(parts.bytes());
        }
    }
    if (position == 0 || left > 0) throw DatabaseError("a part of an array is missing");
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
    const auto text = bytesAt(database_.handle(), statement_, column_++);
    return {reinterpret_cast<const char*>(text.data()), text.size()};
}

std::span<const std::byte> RowReader::bytes() {
    expect(SQLITE_BLOB);
    return bytesAt(database_.handle(), statement_, column_++);
}

void RowReader::takeArray(const std::function<void*(std::size_t)>& room) {
    if (sqlite3_column_type(statement_, column_) == SQLITE_INTEGER) return database_.copyParts(sqlite3_column_int64(statement_, column_++), room);
    const auto array = bytes();
    void* to = room(array.size());
    if (!array.empty()) std::memcpy(to, array.data(), array.size());
}

}  // namespace imomushi
