// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/count_allocations.inc"
