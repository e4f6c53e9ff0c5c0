// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace imomushi {

/// Two quantities to minimise at once.
struct Trade {
    double cost = 0.0, error = 0.0;
    bool known = true;  ///< false: one of them is not; it takes no part
};

/// The known ones that are worth their cost, cheapest first: each has at least 1 % less error than all that cost no more.
std::vector<std::size_t> paretoFront(std::span<const Trade> trades);

/// Of each: it is known, and one of the front costs no more and is as good, to 1 %.
std::vector<char> dominated(std::span<const Trade> trades);

}  // namespace imomushi
