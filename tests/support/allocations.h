// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

/// How often this program asked operator new for memory so far. The test program includes count_allocations.inc in one .cpp.
std::size_t allocations();
