// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace imomushi {

/// A file that is written piece by piece beside its place, flushed to the disk and renamed by finish(): it appears whole or not at all.
/// What a writer of the same file that was killed left beside it is removed.
class AtomicFile {
public:
    explicit AtomicFile(const std::filesystem::path& path);
    ~AtomicFile();  ///< unfinished: leaves nothing
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    void write(std::string_view bytes);
    /// What is written, for those who read and write it themselves; -1: it could not be made, as finish() will tell.
    [[nodiscard]] int descriptor() const { return file_; }
    /// Errors: "not-writable" and "disk-full", for whatever went wrong since the beginning.
    Result<void> finish();

private:
    std::filesystem::path path_, target_;
    std::string temporary_;
    int file_ = -1, error_ = 0;
    unsigned mode_ = 0;
    bool replaces_ = false;
};

/// Whether an operation of the system failed with `error` because there is no room for a file.
[[nodiscard]] bool isDiskFull(int error);
/// Errors: "disk-full".
tl::unexpected<Error> failDiskFull(const std::filesystem::path& path);

/// Replaces the file at `path` by `bytes`, or leaves it as it was: writes a file beside it, flushes it to the disk and renames it.
/// Errors: "not-writable", "disk-full".
Result<void> writeFileAtomically(const std::filesystem::path& path, std::string_view bytes);

}  // namespace imomushi
