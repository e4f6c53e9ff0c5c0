// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "core/worker/codec.h"

namespace imomushi {

/// What a worker sends of it.
template <class T>
std::string messageOf(const T& value) {
    MessageOut out;
    out(value);
    return out.take();
}

/// What comes over of a message. "refused": it is none, or contradicts itself.
template <class T>
Result<T> inMessage(std::string_view message) {
    Result<T> answer;
    MessageIn in(message);
    in(answer);
    if (!in.finished()) return fail("refused", "");
    return answer;
}

}  // namespace imomushi
