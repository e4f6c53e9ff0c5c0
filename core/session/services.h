// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

#include "core/body/body.h"
#include "core/io/character_file.h"
#include "core/proposal/proposal.h"

namespace imomushi {

struct CharacterSource;
struct Project;
struct ProposalRequest;
struct SavedProject;
struct VersionLimits;

/// Slow work that commands ask for. Who has done it beforehand (the studio, in the background) puts a function in place that hands over the result. None is empty; errors are those
/// of the functions that coreServices() names.
struct Services {
    std::function<Result<ImportResult>(const ImportRequest&, const Progress&)> import;
    std::function<Result<CharacterFile>(const ImportRequest&, const Progress&)> importCharacter;
    BodyMaker makeBody;
    std::function<Result<Proposal>(const CharacterSource&, const ProposalRequest&, const Progress&)> propose;
    std::function<Result<Project>(const std::filesystem::path&, std::optional<std::int64_t> version)> read;  ///< a project file, for "open"
    std::function<Result<SavedProject>(const std::filesystem::path&, const Project&, const VersionLimits&)> write;  ///< for "save"
};

/// The functions of core: importFile(), importCharacter(), makeBody(), proposeFor(), loadProject(), storeProject().
Services coreServices();

}  // namespace imomushi
