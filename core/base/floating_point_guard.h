// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cfenv>

namespace imomushi {

/// CGAL's interval filters overflow and divide by zero on purpose before they fall back to exact numbers, and switch rounding; LAPACK's newer eigenvalue
/// routines divide by zero to see whether infinity works. Inside this guard that traps nothing, after it the caller's floating-point environment is as it was.
class FloatingPointGuard {
public:
    FloatingPointGuard() { std::feholdexcept(&saved_); }
    ~FloatingPointGuard() { std::fesetenv(&saved_); }
    FloatingPointGuard(const FloatingPointGuard&) = delete;
    FloatingPointGuard& operator=(const FloatingPointGuard&) = delete;

private:
    std::fenv_t saved_{};
};

}  // namespace imomushi
