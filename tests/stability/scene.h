// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/session/session.h"
#include "tests/support/hard_cases.h"

namespace imomushi {

/// A hard case as the commands that make it; its files lie in the current folder.
struct HardScene {
    std::vector<Json> make;     ///< from an empty document to the precomputed elements
    std::vector<Json> perform;  ///< then: drag and step
};
/// `solverMesh`: the value of the elements' property "solver-mesh", empty: not set.
HardScene hardScene(const HardCase& hard, const std::string& solverMesh = {});

/// Writes NAME.obj (NAME ELEMENT.obj where there are several) and NAME.jsonl, a script that runs in that folder. Errors: those of writing.
Result<void> writeHardCase(const HardCase& hard, const HardScene& scene, const std::filesystem::path& folder);

}  // namespace imomushi
