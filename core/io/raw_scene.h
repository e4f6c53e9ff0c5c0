// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "core/mesh/mend.h"

namespace imomushi {

/// A file to be read, in memory.
struct SourceFile {
    std::filesystem::path path;
    std::string_view bytes;
    /// For messages: "'horse.obj'".
    [[nodiscard]] std::string quoted() const;
};

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
};

/// Readers of one format each. Strict: what is not understood is refused with its place or told as an issue.
/// Errors: "bad-file", "too-large", "empty-mesh".
Result<RawScene> readObj(const SourceFile& file);
Result<RawScene> readPly(const SourceFile& file);
Result<RawScene> readStl(const SourceFile& file);
Result<RawScene> readGltf(const SourceFile& file);
Result<RawScene> readByAssimp(const SourceFile& file, std::string_view format);  ///< "fbx", "dae"

/// The formats that can be read, by suffix: "obj", "ply", ... Empty: none.
std::string formatOf(const std::filesystem::path& path);

// Helpers of the readers ----------------------------------------------------------------------------------------------------------------

/// A "bad-file" error: "'horse.obj', line 12: <what>". line 0: no line.
tl::unexpected<Error> badFile(const SourceFile& file, std::size_t line, const std::string& what);

/// Adds an issue of the file.
void tell(RawScene& scene, Severity severity, const char* code, std::string text, std::size_t count, bool fixed = true);

/// A number in decimal, in any locale; "nan" and "inf" are numbers that are not finite; so is what double cannot hold. False: no number.
bool parseNumber(std::string_view token, double& value);

/// UTF-8 without control characters: bytes that are no UTF-8 are read as Latin-1. Never empty: `otherwise` stands in.
std::string cleanName(std::string_view name, std::string_view otherwise);


/// Splits the polygon `corners` (indices into `points`, which are finite or not) into #corners - 2 triangles, as positions in `corners`. Quads
/// are cut so that the two halves do not fold over, at the shorter diagonal where both do; larger polygons by ears in their plane.
void triangulatePolygon(const std::vector<double>& points, const std::vector<std::int32_t>& corners,
                        std::vector<std::array<std::int32_t, 3>>& triangles);

/// Pictures that a file names are read from beside it.
class TextureLoader {
public:
    TextureLoader(const SourceFile& file, RawScene& scene) : file_(file), scene_(scene) {}
    /// The texture's index in the scene's look, -1 with an issue told where it cannot be had: absent, outside the file's
    /// folder, too large or no picture. The same name gives the same index.
    int fromFile(std::string_view name);
    int fromBytes(std::string_view name, std::string_view bytes);

private:
    const SourceFile& file_;
    RawScene& scene_;
    std::vector<std::pair<std::string, int>> known_;
    std::size_t total_ = 0;
};

/// A file that `file` refers to: within the folder of `file`, a plain file, not above `limit` bytes.
/// Errors: "missing", "outside", "too-large".
Result<std::string> readBeside(const SourceFile& file, std::string_view name, std::size_t limit);

}  // namespace imomushi
