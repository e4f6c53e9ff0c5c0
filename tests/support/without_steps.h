// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "core/worker/process.h"

namespace imomushi {

template <class T>
std::string messageOf(const T& value) {
    MessageOut out;
    out(value);
    return out.take();
}

/// What a worker of this program answers if these steps, "a step (1)", broke down before.
template <class Answer, class... Asked>
Answer withoutSteps(const std::vector<std::string>& steps, std::string_view operation, const Asked&... asked) {
    auto process = worker::WorkerProcess::start("/proc/self/exe");
    REQUIRE(process);
    const auto reply = (*process)->perform(operation, {messageOf(asked)...}, steps, {}, {});
    REQUIRE(reply.end == worker::WorkerReply::End::Answered);
    Answer answer;
    MessageIn in(reply.answer);
    in(answer);
    REQUIRE(in.finished());
    return answer;
}

}  // namespace imomushi
