// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/io/raw_scene.h"

// What the readers of all formats share: checks, messages, numbers, polygons, textures.

namespace imomushi {

/// Vertices that a file may have, so that indices of corners stay within 32 bits.
inline constexpr std::size_t kMaxVertices = std::size_t{1} << 30;

/// "too-large": more than kMaxVertices.
tl::unexpected<Error> tooManyVertices(const SourceFile& file);

/// `x` as a coordinate of a texture or normal; 0, and one more in `bad`, where it is not finite or beyond the range of float sums.
inline float attributeOrZero(double x, std::size_t& bad) {
    if (std::isfinite(x) && std::abs(x) < 1e30) return static_cast<float>(x);
    ++bad;
    return 0.0f;
}

/// Tells how many colours, texture coordinates and normals were replaced; nothing where none was.
void tellReplacedAttributes(RawScene& scene, std::size_t count);

/// A "bad-file" error: "'horse.obj', line 12: <what>". line 0: no line.
tl::unexpected<Error> badFile(const SourceFile& file, std::size_t line, const std::string& what);

/// `name`, or with a number behind it that none of `taken` has, which it then is among.
std::string uniqueName(std::set<std::string>& taken, const std::string& name);

/// Adds an issue of the file.
void tell(RawScene& scene, Severity severity, const char* code, std::string text, std::size_t count, bool fixed = true);

/// A number in decimal, in any locale; "nan" and "inf" are numbers that are not finite; so is what double cannot hold. False: no number.
bool parseNumber(std::string_view token, double& value);

/// Splits the polygon `corners` (indices into `points`, which are finite or not) into #corners - 2 triangles, as positions in `corners`. Quads
/// are cut so that the two halves do not fold over, at the shorter diagonal where both do; larger polygons by ears in their plane.
void triangulatePolygon(const std::vector<double>& points, const std::vector<std::int32_t>& corners,
                        std::vector<std::array<std::int32_t, 3>>& triangles);

/// What the readers of scenes (glTF, FBX, COLLADA) collect of all meshes, one vertex after the other; one without an attribute has a filler.
class SceneVertices {
protected:
    /// Tells what was left out or replaced. `material_` is left to the reader.
    void putInto(RawScene& scene) const;

    std::vector<double> points_;
    std::vector<float> normals_, texCoords_, colors_;
    std::vector<std::int32_t> triangles_, material_;
    bool anyNormals_ = false, anyUv_ = false, anyColors_ = false;
    std::size_t linesAndPoints_ = 0, morphsLeftOut_ = 0, badAttributes_ = 0;
};

/// Pictures that a file names are read from beside it.
class TextureLoader {
public:
    TextureLoader(const SourceFile& file, RawScene& scene) : file_(file), scene_(scene) {}
    /// The texture's index in the scene's render mesh, -1 with an issue told where it cannot be had: absent, outside the file's
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
