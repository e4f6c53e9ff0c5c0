// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "core/worker/worker.h"

// What the worker of these tests can do.
namespace imomushi {

/// The text, as often as asked for.
Result<std::string> repeated(const std::string& text, int times, const Progress& progress = {}, const WorkLimits& limits = {});

/// A sum over steps 1 to `steps`; those in `breaking` break down as `how` says: "crash", "abort", "exit", "burn" (never ends), "memory". What was left out stands in the answer.
struct Stepped {
    int sum = 0;
    std::vector<std::string> leftOut;
};
Result<Stepped> stepped(int steps, const std::vector<int>& breaking, const std::string& how, const Progress& progress = {},
                        const WorkLimits& limits = {});

/// Breaks down outside of any step: as above, "kill" (by itself, as from outside), "sleep", "garbage", "descriptors" (answers which are open).
Result<std::string> breaking(const std::string& how, const Progress& progress = {}, const WorkLimits& limits = {});

}  // namespace imomushi
