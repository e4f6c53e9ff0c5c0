// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/base/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace imomushi {

std::unique_ptr<FileLock> FileLock::take(const std::filesystem::path& path) {
    for (;;) {
        const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
        if (file < 0) return nullptr;
        if (::flock(file, LOCK_EX | LOCK_NB) != 0) {
            ::close(file);
            return nullptr;
        }
        // The last owner may have removed it after it was opened here: then another one may be there by now.
        struct stat locked {}, named {};
        if (::fstat(file, &locked) == 0 && ::lstat(path.c_str(), &named) == 0 && locked.st_dev == named.st_dev && locked.st_ino == named.st_ino)
            return std::unique_ptr<FileLock>(new FileLock(path, file));
        ::close(file);
    }
}

FileLock::~FileLock() {
    ::unlink(path_.c_str());
    ::close(file_);
}

}  // namespace imomushi
