// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tl/expected.hpp>
#include <utility>

#define IMOMUSHI_JOINED_(a, b) a##b
#define IMOMUSHI_JOINED(a, b) IMOMUSHI_JOINED_(a, b)
#define IMOMUSHI_TRY_(result, to, ...)                                     \
    auto result = __VA_ARGS__;                                             \
    if (!result) return tl::unexpected(std::move(result.error()));         \
    to = std::move(*result)

/// Gives `to` the value of a Result, or returns its error from the function:
///     IMOMUSHI_TRY(const Plane plane, planeFrom(json));
#define IMOMUSHI_TRY(to, ...) IMOMUSHI_TRY_(IMOMUSHI_JOINED(result_of_line_, __LINE__), to, __VA_ARGS__)
