// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

struct sqlite3;

namespace imomushi {

/// (SQLite's own "unix-none" takes paths of 512 bytes at most, which are 170 letters of Japanese, and opens a file a second time.)
/// A database in the file that is open as `file`, which must stay open and belong to this database alone: SQLite knows neither its name nor locks nor journals.
/// Nothing is flushed to the disk. The answer is one of SQLite's codes; *handle must be closed in any case.
int openDatabaseFile(int file, bool writable, sqlite3** handle);

}  // namespace imomushi
