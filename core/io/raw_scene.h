// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "core/mesh/mend.h"
#include "core/mesh/render_model.h"
#include "core/mesh/rig.h"

namespace imomushi {

/// A file to be read, in memory.
struct SourceFile {
    std::filesystem::path path;
    std::string_view bytes;
    /// For messages: "'horse.obj'".
    [[nodiscard]] std::string quoted() const;
};

/// UTF-8 without control characters: bytes that are no UTF-8 are read as Latin-1. Never empty: `otherwise` replaces an empty name.
std::string cleanName(std::string_view name, std::string_view otherwise);

/// "'horse.obj'": the last part of a path for a message, in valid UTF-8.
std::string quotedName(const std::filesystem::path& path);

/// What a reader makes of a file, before units, axes and mending. Indices are in range, whatever the file says.
struct RawScene {
    std::string format;
    double metresPerUnit = 1.0;  ///< as the file itself says, 1 where it says nothing
    bool zUp = false;            ///< as the file itself says
    RawSurface surface;
    std::vector<std::string> partNames;  ///< by RawSurface::part
    /// Vertices with a coordinate that is not finite, and where the file has them ("line 12"). Only those in use matter.
    std::vector<std::pair<std::int32_t, std::string>> nonFinite;
    std::vector<MeshIssue> issues;       ///< of the file: what was dropped or not understood
    std::vector<MorphTarget> morphs;     ///< of characters alone; deltas in the coordinates of the vertices
    std::optional<Rig> rig;              ///< of characters alone, whose surface may be empty then. `toScene` takes it to the coordinates of the vertices
};

/// What a file is read for. Character: glTF nodes come depth first, and a skinned vertex that its joints move by rounding alone keeps its place. Elements: as elements have
/// always come, since documents refer to their vertices by number: nodes by their index, skins as the joints say; without bones.
enum class SceneUse { Elements, Character };

/// Readers of one format each. Strict: what is not understood is refused with its place or told as an issue.
/// Errors: "bad-file", "too-large", "empty-mesh".
Result<RawScene> readObj(const SourceFile& file);
Result<RawScene> readPly(const SourceFile& file);
Result<RawScene> readStl(const SourceFile& file);
Result<RawScene> readGltf(const SourceFile& file, SceneUse use);
Result<RawScene> readByAssimp(const SourceFile& file, std::string_view format, SceneUse use);  ///< "fbx", "dae"

/// The formats that can be read, by suffix: "obj", "ply", ... Empty: none.
std::string formatOf(const std::filesystem::path& path);

}  // namespace imomushi
