// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/base/atomic_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>

#include "core/base/abandoned_files.h"

namespace imomushi {
namespace {

constexpr std::string_view kSuffix = ".part";
constexpr int kMostAttempts = 100;  // at a name that no other writer has

/// "PROCESS-ATTEMPT", as the constructor writes it.
bool isWriter(std::string_view text) {
    const auto digits = [](std::string_view part) { return !part.empty() && std::all_of(part.begin(), part.end(), [](char c) { return c >= '0' && c <= '9'; }); };
    const auto dash = text.find('-');
    return dash != text.npos && digits(text.substr(0, dash)) && digits(text.substr(dash + 1));
}

/// Removes the file if nobody writes it: a writer holds a lock, which the system lets go when the process ends, however it ends.
void removeIfAbandoned(const std::filesystem::path& path) {
    const int file = ::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (file < 0) return;
    struct stat opened {}, named {};
    if (::flock(file, LOCK_EX | LOCK_NB) == 0 && ::fstat(file, &opened) == 0 && S_ISREG(opened.st_mode) && ::lstat(path.c_str(), &named) == 0 &&
        named.st_dev == opened.st_dev && named.st_ino == opened.st_ino)
        ::unlink(path.c_str());
    ::close(file);
}

/// The file that "FILE.PROCESS-ATTEMPT.part" is written for; empty: the name is another.
std::string_view writtenFor(std::string_view name) {
    if (!name.ends_with(kSuffix)) return {};
    name.remove_suffix(kSuffix.size());
    const auto dot = name.rfind('.');
    return dot != name.npos && isWriter(name.substr(dot + 1)) ? name.substr(0, dot) : std::string_view();
}

/// Removes what killed writers left in a folder, all or those of one file. What cannot be removed stays: it is no reason not to write.
void removeAbandoned(const std::filesystem::path& folder, const std::string& only) {
    std::error_code error;
    for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        const std::string name = it->path().filename().string();
        const std::string_view target = writtenFor(name);
        if (!target.empty() && (only.empty() || target == only)) removeIfAbandoned(it->path());
    }
}

}  // namespace

AtomicFile::AtomicFile(const std::filesystem::path& path) : path_(path), target_(path) {
    std::error_code error;
    if (path.filename().empty() || std::filesystem::is_directory(path, error)) {
        error_ = EISDIR;
        return;
    }
    // A link is followed, so that the file it points to is replaced and the link stays.
    if (std::filesystem::is_symlink(path, error))
        if (auto real = std::filesystem::weakly_canonical(path, error); !error) target_ = std::move(real);
    struct stat old {};
    replaces_ = ::stat(target_.c_str(), &old) == 0;
    mode_ = old.st_mode;
    if (replaces_ && ::access(target_.c_str(), W_OK) != 0) {
        error_ = errno;  // a rename alone would replace a protected file
        return;
    }
    removeAbandonedPartsOf(target_);
    for (int attempt = 0; file_ < 0; ++attempt) {
        temporary_ = (target_.string() + "." + std::to_string(::getpid()) + "-" + std::to_string(attempt)).append(kSuffix);
        file_ = ::open(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file_ < 0 && (errno != EEXIST || attempt >= kMostAttempts)) {
            error_ = errno;
            return;
        }
        // Another writer may have taken the file for an abandoned one before it was locked: then it has no name any more. Where there are no locks, nothing is removed.
        struct stat made {};
        if (file_ >= 0 && ::flock(file_, LOCK_EX) == 0 && ::fstat(file_, &made) == 0 && made.st_nlink == 0) {
            ::close(file_);
            file_ = -1;
        }
    }
}

AtomicFile::~AtomicFile() {
    if (file_ < 0) return;
    ::close(file_);
    ::unlink(temporary_.c_str());
}

void AtomicFile::write(std::string_view bytes) {
    while (error_ == 0 && !bytes.empty()) {
        const ssize_t n = ::write(file_, bytes.data(), bytes.size());
        if (n >= 0)
            bytes.remove_prefix(static_cast<std::size_t>(n));
        else if (errno != EINTR)
            error_ = errno;
    }
}

Result<void> AtomicFile::finish() {
    if (error_ == 0 && ((replaces_ && ::fchmod(file_, mode_ & 07777) != 0) || ::fsync(file_) != 0 || ::rename(temporary_.c_str(), target_.c_str()) != 0))
        error_ = errno;
    if (isDiskFull(error_)) return failDiskFull(path_);
    if (error_ != 0) return fail("not-writable", "Cannot write '" + path_.string() + "' (" + std::strerror(error_) + "): choose another place for it.");
    ::close(file_);
    file_ = -1;
    return {};
}

void removeAbandonedFiles(const std::filesystem::path& folder) { removeAbandoned(folder, {}); }

void removeAbandonedPartsOf(const std::filesystem::path& file) { removeAbandoned(file.has_parent_path() ? file.parent_path() : std::filesystem::path("."), file.filename().string()); }

bool isDiskFull(int error) { return error == ENOSPC || error == EDQUOT || error == EFBIG; }

tl::unexpected<Error> failDiskFull(const std::filesystem::path& path) {
    return fail("disk-full", "There is no room for '" + path.string() + "': make room on its disk or choose another one. Nothing was replaced.");
}

Result<void> writeFileAtomically(const std::filesystem::path& path, std::string_view bytes) {
    AtomicFile file(path);
    file.write(bytes);
    return file.finish();
}

}  // namespace imomushi
