// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/io/build_result.h"
#include "tests/document/workbench.h"

namespace imomushi {

/// Reads a character file in this process, without a worker: for Session::services().importCharacter = .
inline Result<CharacterFile> readCharacter(const ImportRequest& request, const Progress& progress) {
    const std::string bytes = readFile(request.path);
    auto scene = readScene({request.path, bytes}, SceneUse::Character);
    if (!scene) return tl::unexpected(scene.error());
    return buildCharacter(std::move(*scene), request, progress);
}

}  // namespace imomushi
