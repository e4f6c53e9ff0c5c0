// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace imomushi {

/// The commit that the program was built from; "unknown" outside of a git checkout.
extern const char* const kCommit;
/// Versions of the libraries it was built with, and of the compiler.
extern const char* const kLibraries;

}  // namespace imomushi
