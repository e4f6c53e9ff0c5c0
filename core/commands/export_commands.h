// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "core/document/command.h"
#include "core/document/effects.h"
#include "core/export/export.h"

namespace imomushi {

class Session;

/// What suits a program that reads glTF; keys of the command go before it.
struct ExportPreset {
    const char* name;
    const char* help;  ///< English, one clause
    ExportOptions options;
};
std::span<const ExportPreset> exportPresets();

/// Everything that an export needs, taken from a session, which may change afterwards.
struct ExportPlan {
    ExportScene scene;
    ExportOptions options;
    std::filesystem::path path;
    std::vector<EffectKind> effects;    ///< that the scene has
    bool performed = false;             ///< takes are among the clips; else there is the pose of now alone
    std::vector<ExportWarning> warnings;
};

/// `arguments`: those of the command "export", checked. Errors: those of the command that can be told before the work.
Result<ExportPlan> planExport(const Session& session, const Json& arguments);
/// The work, on any thread; what the command answers. Errors: those of exportScene().
Result<Json> runExport(const ExportPlan& plan, const Progress& progress);

}  // namespace imomushi
