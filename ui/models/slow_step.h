// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/session/session.h"

namespace imomushi {

/// What may take its time, and what follows it. Where it is given up, nothing follows, and what the functions hold is freed.
struct SlowStep {
    Json command;  ///< or an array of them, which become one step and succeed or fail together
    QString title = {};                                      ///< what goes on: "Making “penguin” soft"; empty: as the step is called
    std::function<void(const Json& answer)> done = {};       ///< it is part of the document; `answer`: of the last command
    std::function<void(Session&)> arrange = {};              ///< see prepareStep()
    std::int64_t brings = 0;                                 ///< vertices that are not in the document yet
    /// It was refused: looks in the document for what else could be done, on any thread. What it finds belongs to it and `refused`.
    std::function<void(const Document&)> lookFurther = {};
    std::function<void(const Error&)> refused = {};          ///< empty: the studio says why

    [[nodiscard]] std::vector<Json> commands() const { return command.is_array() ? command.get<std::vector<Json>>() : std::vector<Json>{command}; }
};

}  // namespace imomushi
