// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace imomushi {

/// While this lives, the n-th request of this program's own code for memory by operator new fails, on this thread or on all others, and where asked for all requests after it
/// too. Libraries (Qt, OpenGL and its compiler) get what they ask for: most cannot survive anything else. One at a time. The test program links failing_new.cpp, which
/// replaces operator new.
class FailingNew {
public:
    enum class On { ThisThread, OtherThreads };
    enum class Fails { Once, FromThenOn };
    FailingNew(On threads, long n, Fails fails);
    ~FailingNew();
    FailingNew(const FailingNew&) = delete;
    FailingNew& operator=(const FailingNew&) = delete;

    /// There was an n-th.
    [[nodiscard]] static bool failed();
};

}  // namespace imomushi
