// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/base/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

namespace imomushi {

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
    for (int attempt = 0; file_ < 0; ++attempt) {
        temporary_ = target_.string() + "." + std::to_string(::getpid()) + "-" + std::to_string(attempt) + ".part";
        file_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file_ < 0 && (errno != EEXIST || attempt == 100)) {
            error_ = errno;
            return;
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
    if (error_ != 0) return fail("not-writable", "Cannot write '" + path_.string() + "' (" + std::strerror(error_) + "): choose another place for it.");
    ::close(file_);
    file_ = -1;
    return {};
}

Result<void> writeFileAtomically(const std::filesystem::path& path, std::string_view bytes) {
    AtomicFile file(path);
    file.write(bytes);
    return file.finish();
}

}  // namespace imomushi
