// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "core/worker/process.h"
#include "tests/support/messages.h"

namespace imomushi {

/// What a worker of this program answers if these steps, "a step (1)", broke down before.
template <class Answer, class... Asked>
Result<Answer> withoutSteps(const std::vector<std::string>& steps, std::string_view operation, const Asked&... asked) {
    auto process = worker::WorkerProcess::start("/proc/self/exe");
    REQUIRE(process);
    const auto reply = (*process)->perform(operation, {messageOf(asked)...}, steps, {}, {});
    REQUIRE(reply.end == worker::WorkerReply::End::Answered);
    return inMessage<Answer>(reply.answer);
}

}  // namespace imomushi
