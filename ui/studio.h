// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace imomushi {

/// Runs the studio until its window is closed; answers the exit status. `imomushi [PROJECT.imomushi | MESH ...]`
int runStudio(int argc, char** argv);

/// What every program that shows parts of the studio does once, after making its GuardedApplication: icons, translations, look.
void prepareStudio();

}  // namespace imomushi
