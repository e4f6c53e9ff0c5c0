// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace imomushi {

/// Why an operation failed. `code` is stable and lower-case-with-dashes (scripts test it); `message` is one sentence in
/// English that names what is wrong and what to do about it.
struct Error {
    std::string code;
    std::string message;
};

/// The value of an operation, or the reason why there is none. Failures are returned, not thrown; only std::bad_alloc may leave a room.
template <class T>
using Result = tl::expected<T, Error>;

inline tl::unexpected<Error> fail(std::string code, std::string message) {
    return tl::unexpected<Error>(Error{std::move(code), std::move(message)});
}

/// The code of every operation that ended because its Progress was cancelled.
inline constexpr const char* kCancelled = "cancelled";

}  // namespace imomushi
