// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace imomushi {

/// Which share of `threads` undisturbed processors so many threads of this process get now, 0.1...1: estimates of seconds are those of a machine that has nothing else to do.
/// Takes half a second.
double machineShare(int threads);

}  // namespace imomushi
