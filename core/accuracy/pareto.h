// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace imomushi {

/// What is given and what is got; less is better in both.
struct Trade {
    double cost = 0.0, error = 0.0;
    bool known = true;  ///< false: one of them is not; it takes no part
};

/// Of each: some other is at least as good in both and better in one. What is not known is not dominated.
std::vector<char> dominated(std::span<const Trade> trades);

/// The known ones that are not dominated, cheapest first; of equal ones the first.
std::vector<std::size_t> paretoFront(std::span<const Trade> trades);

}  // namespace imomushi
