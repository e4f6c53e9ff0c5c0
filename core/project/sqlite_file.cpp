// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/project/sqlite_file.h"

#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <string>

#include "core/base/atomic_file.h"

namespace imomushi {

namespace {

constexpr const char kFileSystemName[] = "imomushi-file";

struct OpenFile : sqlite3_file {
    int file;
};

int descriptor(sqlite3_file* file) { return static_cast<OpenFile*>(file)->file; }

/// Calls `move`(bytes done) until `amount` bytes are moved. Where it answers 0 the file ends. What was moved, -1: errno says why not.
template <class Move>
int moveAll(int amount, const Move& move) {
    int done = 0;
    while (done < amount) {
        const ssize_t n = move(done);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return -1;
        if (n == 0) break;
        done += static_cast<int>(n);
    }
    return done;
}

int readBytes(sqlite3_file* file, void* to, int amount, sqlite3_int64 at) {
    const int done = moveAll(amount, [&](int n) { return ::pread(descriptor(file), static_cast<char*>(to) + n, static_cast<std::size_t>(amount - n), at + n); });
    if (done < 0) return SQLITE_IOERR_READ;
    std::memset(static_cast<char*>(to) + done, 0, static_cast<std::size_t>(amount - done));  // as SQLite asks for
    return done == amount ? SQLITE_OK : SQLITE_IOERR_SHORT_READ;
}

int writeBytes(sqlite3_file* file, const void* from, int amount, sqlite3_int64 at) {
    const int done = moveAll(amount, [&](int n) { return ::pwrite(descriptor(file), static_cast<const char*>(from) + n, static_cast<std::size_t>(amount - n), at + n); });
    if (done == amount) return SQLITE_OK;
    return done >= 0 || isDiskFull(errno) ? SQLITE_FULL : SQLITE_IOERR_WRITE;
}

int truncateFile(sqlite3_file* file, sqlite3_int64 size) { return ::ftruncate(descriptor(file), size) == 0 ? SQLITE_OK : SQLITE_IOERR_TRUNCATE; }

int fileSize(sqlite3_file* file, sqlite3_int64* size) {
    struct stat now {};
    if (::fstat(descriptor(file), &now) != 0) return SQLITE_IOERR_FSTAT;
    *size = now.st_size;
    return SQLITE_OK;
}

const sqlite3_io_methods kMethods = {
    .iVersion = 1,
    .xClose = [](sqlite3_file*) { return SQLITE_OK; },
    .xRead = readBytes,
    .xWrite = writeBytes,
    .xTruncate = truncateFile,
    .xSync = [](sqlite3_file*, int) { return SQLITE_OK; },
    .xFileSize = fileSize,
    .xLock = [](sqlite3_file*, int) { return SQLITE_OK; },
    .xUnlock = [](sqlite3_file*, int) { return SQLITE_OK; },
    .xCheckReservedLock = [](sqlite3_file*, int* locked) { return *locked = 0, SQLITE_OK; },
    .xFileControl = [](sqlite3_file*, int, void*) { return SQLITE_NOTFOUND; },
    .xSectorSize = [](sqlite3_file*) { return 4096; },
    .xDeviceCharacteristics = [](sqlite3_file*) { return 0; },
    .xShmMap = nullptr, .xShmLock = nullptr, .xShmBarrier = nullptr, .xShmUnmap = nullptr, .xFetch = nullptr, .xUnfetch = nullptr,
};

/// Only the file itself: what SQLite keeps besides is in memory or not at all.
int openFile(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* opened) {
    file->pMethods = nullptr;
    auto& made = *static_cast<OpenFile*>(file);
    if (!name || !(flags & SQLITE_OPEN_MAIN_DB)) return SQLITE_CANTOPEN;
    if (std::from_chars(name, name + std::strlen(name), made.file).ec != std::errc()) return SQLITE_CANTOPEN;
    file->pMethods = &kMethods;
    if (opened) *opened = flags;
    return SQLITE_OK;
}

/// SQLite's own, for time and chance, but for what concerns files.
bool registerFiles() {
    static sqlite3_vfs files = [] {
        sqlite3_vfs made = *sqlite3_vfs_find(nullptr);
        made.szOsFile = sizeof(OpenFile);
        made.pNext = nullptr;
        made.zName = kFileSystemName;
        made.xOpen = openFile;
        made.xDelete = [](sqlite3_vfs*, const char*, int) { return SQLITE_OK; };
        made.xAccess = [](sqlite3_vfs*, const char*, int, int* there) { return *there = 0, SQLITE_OK; };
        made.xFullPathname = [](sqlite3_vfs*, const char* name, int size, char* full) { return sqlite3_snprintf(size, full, "%s", name), SQLITE_OK; };
        return made;
    }();
    static const bool registered = sqlite3_vfs_register(&files, 0) == SQLITE_OK;
    return registered;
}

}  // namespace

int openDatabaseFile(int file, bool writable, sqlite3** handle) {
    *handle = nullptr;
    if (!registerFiles()) return SQLITE_CANTOPEN;
    const int flags = writable ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READONLY;
    return sqlite3_open_v2(std::to_string(file).c_str(), handle, flags | SQLITE_OPEN_NOMUTEX, kFileSystemName);
}

}  // namespace imomushi
