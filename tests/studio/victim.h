// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace imomushi {

/// A studio that works until it is killed, as a process of its own (main() runs it for "victim PROJECT"): takes up what the last one left, says on its standard
/// output what it found, then changes, keeps and saves PROJECT, and says what is done. The element of the project is named "work N" after step N.
///   found FILE RECOVERED    the step of the project's file, and of the copy that was recovered (-1: there was none)
///   done N                  step N is kept or saved
/// `last`: ends after that instead, as a person quits who saved.
int studioVictim(int argc, char** argv, const std::string& project, bool last);

}  // namespace imomushi
