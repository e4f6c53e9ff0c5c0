// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace imomushi {

/// "AMD EPYC ..., 2 threads".
std::string machineName();

/// The part of `threads` idle processors that as many threads of this process get now, 0.1...1. Estimates of seconds are those of an idle machine and are divided by it.
/// Takes half a second.
double machineShare(int threads);

}  // namespace imomushi
