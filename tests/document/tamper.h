// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <doctest/doctest.h>
#include <sqlite3.h>

#include <filesystem>
#include <string>

#include "core/project/project_file.h"
#include "core/project/sqlite.h"
#include "tests/support/folder.h"

// What a hostile writer does to a project file.

namespace imomushi {

inline void sql(const std::filesystem::path& path, const std::string& statement) {
    sqlite3* handle = nullptr;
    REQUIRE(sqlite3_open(path.c_str(), &handle) == SQLITE_OK);
    char* message = nullptr;
    const int code = sqlite3_exec(handle, statement.c_str(), nullptr, nullptr, &message);
    INFO(statement << ": " << (message ? message : ""));
    CHECK(code == SQLITE_OK);
    sqlite3_free(message);
    sqlite3_close(handle);
}

/// Makes a tampered file look whole.
inline void sign(const std::filesystem::path& path) {
    const std::string bytes = readFile(path);
    Database db(std::as_bytes(std::span(bytes)));
    sql(path, "UPDATE info SET value='" + db.digest() + "' WHERE name='digest'");
}

}  // namespace imomushi
