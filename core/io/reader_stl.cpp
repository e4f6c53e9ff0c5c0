// SPDX-License-Identifier: GPL-3.0-or-later
// STL, ascii and binary. Source: "StereoLithography Interface Specification", 3D Systems 1989. Facet normals say nothing that the corners do not.
#include <bit>
#include <cmath>
#include <cstring>

#include "core/io/reader_support.h"
#include "core/io/text_scanner.h"

namespace imomushi {
namespace {

constexpr std::size_t kHeader = 84, kFacet = 50;
constexpr std::size_t kMaxFacets = std::size_t{1} << 28;

static_assert(std::endian::native == std::endian::little, "binary STL is little-endian");

void finish(RawScene& scene, const std::vector<double>& points) {
    ElementMesh& mesh = scene.surface.mesh;
    mesh.body.vertices = Eigen::Map<const Points>(points.data(), static_cast<Eigen::Index>(points.size() / 3), 3);
    mesh.body.triangles.resize(static_cast<Eigen::Index>(points.size() / 9), 3);
    for (Eigen::Index i = 0; i < mesh.body.triangles.size(); ++i) mesh.body.triangles.data()[i] = static_cast<std::int32_t>(i);
}

void checkPoint(RawScene& scene, const std::vector<double>& points, const std::string& where) {
    const double* p = points.data() + points.size() - 3;
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
        scene.nonFinite.emplace_back(static_cast<std::int32_t>(points.size() / 3) - 1, where);
}

Result<RawScene> readBinary(const SourceFile& file) {
    RawScene scene;
    scene.format = "stl";
    if (file.bytes.size() < kHeader) return badFile(file, 0, "is too short for an STL file: export it again.");
    std::uint32_t count = 0;
    std::memcpy(&count, file.bytes.data() + 80, 4);
    const std::size_t holds = (file.bytes.size() - kHeader) / kFacet;
    if (count > holds)
        return badFile(file, 0, "announces " + std::to_string(count) + " triangles and holds " + std::to_string(holds) + ": it is cut off or damaged, export it again.");
    if (count == 0) return fail("empty-mesh", file.quoted() + " has no triangles: choose a file with a mesh.");
    if (const std::size_t extra = file.bytes.size() - kHeader - count * kFacet; extra > 0)
        tell(scene, Severity::Info, "not-understood", std::to_string(extra) + " bytes after the last triangle left out.", extra);
    std::vector<double> points;
    points.reserve(std::size_t{count} * 9);
    for (std::uint32_t f = 0; f < count; ++f) {
        float x[12];
        std::memcpy(x, file.bytes.data() + kHeader + f * kFacet, sizeof x);
        for (int k = 3; k < 12; k += 3) {
            points.insert(points.end(), x + k, x + k + 3);
            checkPoint(scene, points, "triangle " + std::to_string(f + 1));
        }
    }
    scene.partNames.push_back(cleanName(file.path.stem().string(), "mesh"));
    scene.surface.part.assign(count, 0);
    finish(scene, points);
    return scene;
}

Result<RawScene> readAscii(const SourceFile& file) {
    RawScene scene;
    scene.format = "stl";
    std::vector<double> points;
    LineScanner lines(file.bytes);
    std::string_view line;
    int corners = -1;  // of the open facet, -1: none is open
    bool solid = false;
    while (lines.next(line)) {
        const std::string_view key = takeWord(line);
        if (key.empty() || key == "outer" || key == "endloop") continue;
        if (key == "solid") {
            solid = true;
            scene.partNames.push_back(cleanName(line, cleanName(file.path.stem().string(), "mesh")));
        } else if (key == "facet") {
            if (!solid || corners >= 0) return badFile(file, lines.number(), "a facet begins where none can begin.");
            corners = 0;
        } else if (key == "vertex") {
            if (corners < 0) return badFile(file, lines.number(), "a vertex stands outside of a facet.");
            if (++corners > 3) return badFile(file, lines.number(), "a facet has more than three vertices.");
            for (int k = 0; k < 3; ++k) {
                const std::string_view word = takeWord(line);
                double value = 0.0;
                if (!parseNumber(word, value)) return badFile(file, lines.number(), "'" + cleanName(word, "(nothing)") + "' is not a coordinate.");
                points.push_back(value);
            }
            checkPoint(scene, points, "line " + std::to_string(lines.number()));
        } else if (key == "endfacet") {
            if (corners != 3) return badFile(file, lines.number(), "a facet ends without three vertices.");
            corners = -1;
            scene.surface.part.push_back(static_cast<std::int32_t>(scene.partNames.size()) - 1);
            if (scene.surface.part.size() > kMaxFacets) return fail("too-large", file.quoted() + " has too many triangles: reduce the mesh.");
        } else if (key == "endsolid") {
            if (corners >= 0) return badFile(file, lines.number(), "a solid ends within a facet.");
            solid = false;
        } else {
            return badFile(file, lines.number(), "'" + cleanName(key, "?") + "' has no meaning in an STL file.");
        }
    }
    if (corners >= 0 || solid) return badFile(file, lines.number(), "the file ends within a solid: it is cut off, export it again.");
    if (points.empty()) return fail("empty-mesh", file.quoted() + " has no triangles: choose a file with a mesh.");
    finish(scene, points);
    return scene;
}

}  // namespace

Result<RawScene> readStl(const SourceFile& file) {
    // Binary files may begin with "solid" too: the size decides, then whether the beginning is text.
    if (file.bytes.size() >= kHeader) {
        std::uint32_t count = 0;
        std::memcpy(&count, file.bytes.data() + 80, 4);
        if (file.bytes.size() == kHeader + std::size_t{count} * kFacet) return readBinary(file);
    }
    LineScanner lines(file.bytes.substr(0, 4096));
    std::string_view line;
    while (lines.next(line) && trimmed(line).empty()) {
    }
    const bool text = file.bytes.substr(0, 1024).find('\0') == std::string_view::npos;
    return takeWord(line) == "solid" && text ? readAscii(file) : readBinary(file);
}

}  // namespace imomushi
