// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace imomushi {

/// While this lives, the n-th request for memory of this program fails, whoever asks for it on whichever thread (operator new, Eigen, SQLite, C libraries), and all
/// others succeed; or all from the n-th on fail. Where a library cannot survive it, the next one after that fails.
class FailingMalloc {
public:
    enum class Fails { Once, FromThenOn };
    explicit FailingMalloc(long n, Fails fails = Fails::Once);
    ~FailingMalloc();
    FailingMalloc(const FailingMalloc&) = delete;
    FailingMalloc& operator=(const FailingMalloc&) = delete;

    /// There was an n-th.
    [[nodiscard]] static bool failed();
    /// False: the program runs under a sanitizer, which has a malloc of its own.
    [[nodiscard]] static bool works();
};

}  // namespace imomushi
