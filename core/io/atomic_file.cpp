// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/io/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

namespace imomushi {

Result<void> writeFileAtomically(const std::filesystem::path& path, std::string_view bytes) {
    const auto failed = [&](int reason) {
        return fail("not-writable", "Cannot write '" + path.string() + "' (" + std::strerror(reason) + "): choose another place for it.");
    };
    std::error_code error;
    if (path.filename().empty() || std::filesystem::is_directory(path, error)) return failed(EISDIR);
    // A link is followed, so that the file it points to is replaced and the link stays.
    std::filesystem::path target = path;
    if (std::filesystem::is_symlink(path, error))
        if (auto real = std::filesystem::weakly_canonical(path, error); !error) target = std::move(real);
    struct stat old {};
    const bool replaces = ::stat(target.c_str(), &old) == 0;
    if (replaces && ::access(target.c_str(), W_OK) != 0) return failed(errno);  // a rename alone would replace a protected file
    std::string temporary;
    int file = -1;
    for (int attempt = 0; file < 0; ++attempt) {
        temporary = target.string() + "." + std::to_string(::getpid()) + "-" + std::to_string(attempt) + ".part";
        file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file < 0 && (errno != EEXIST || attempt == 100)) return failed(errno);
    }
    const auto undo = [&](int reason) {
        ::close(file);
        ::unlink(temporary.c_str());
        return failed(reason);
    };
    while (!bytes.empty()) {
        const ssize_t n = ::write(file, bytes.data(), bytes.size());
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return undo(errno);
        bytes.remove_prefix(static_cast<std::size_t>(n));
    }
    if (replaces && ::fchmod(file, old.st_mode & 07777) != 0) return undo(errno);
    if (::fsync(file) != 0) return undo(errno);
    if (::rename(temporary.c_str(), target.c_str()) != 0) return undo(errno);
    ::close(file);
    return {};
}

}  // namespace imomushi
