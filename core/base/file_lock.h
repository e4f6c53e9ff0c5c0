// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>

namespace imomushi {

/// A file that says that its owner lives. The system lets go of it when the process ends, however it ends, so what a killed one left is free at once; process
/// numbers, which are given again and differ between containers, do not matter (QLockFile goes by them, and one that was killed while it wrote its file is locked for ever).
class FileLock {
public:
    /// Null: somebody holds it, or there can be no such file.
    static std::unique_ptr<FileLock> take(const std::filesystem::path& path);
    ~FileLock();  ///< removes the file
    FileLock(const FileLock&) = delete;
    FileLock& operator=(const FileLock&) = delete;

private:
    FileLock(std::filesystem::path path, int file) : path_(std::move(path)), file_(file) {}
    std::filesystem::path path_;
    int file_;
};

}  // namespace imomushi
