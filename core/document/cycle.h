// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/document/command.h"
#include "core/document/document.h"

namespace imomushi {

/// A movement that repeats: through kept poses, evenly in time, and from the last one to the first one again. Live input says how much of it there is and how fast it runs.
struct Cycle {
    static constexpr std::size_t kMost = 1000;        ///< cycles of a document
    static constexpr std::size_t kFewestPoses = 2, kMostPoses = 64;
    static constexpr double kShortest = 0.05, kLongest = 3600.0;  ///< s
    static constexpr double kFastest = 100.0;         ///< speed, both ways
    std::string name;
    std::vector<std::string> poses;  ///< kept poses by their names, one may come several times; of what is not there the cycle does not move
    double seconds = 2.0;            ///< one round at speed 1, > 0
    bool operator==(const Cycle&) const = default;
};

/// How much of pose `k` of so many there is at `phase`, in rounds: the trigonometric interpolation through values at k / count, periodic and smooth. The weights of all poses sum to 1; at its own
/// phase a pose has 1 and the others 0. A wave of first order is met exactly by three poses. Of an even count the highest order counts half. Between poses weights go below 0.
double cycleWeight(std::size_t k, std::size_t count, double phase);

/// Null: there is none of that name.
const Cycle* cycleNamed(const Document& document, std::string_view name);
const Cycles& cyclesOf(const Document& document);
void setCycles(Document& document, Cycles cycles);
/// Cycles follow a kept pose that gets another name.
void renamePoseInCycles(Document& document, std::string_view from, std::string_view to);
/// Names of the cycles that go through a kept pose.
std::vector<std::string> cyclesThrough(const Document& document, std::string_view pose);
/// All its poses are there.
bool isWhole(const Document& document, const Cycle& cycle);

/// As a project keeps them. Errors of cyclesFrom(): "bad-cycle".
Json cyclesJson(const Cycles& cycles);
Result<Cycles> cyclesFrom(const Json& list);

}  // namespace imomushi
