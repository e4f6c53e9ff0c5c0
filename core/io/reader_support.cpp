// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/io/reader_support.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>

#include "core/base/finite.h"
#include "core/base/utf8.h"
#include "core/mesh/cgal/fill_hole.h"

namespace imomushi {
namespace {

constexpr std::int32_t kLargestByEars = 256;
constexpr std::size_t kLongestStem = 180;  // bytes of a name that gets a number, so that it stays a name (cleanName())
constexpr std::size_t kLargestTexture = std::size_t{64} << 20;
constexpr std::size_t kLargestTextures = std::size_t{512} << 20;  // all of a file

std::string mimeOf(std::string_view bytes) {
    const auto begins = [&](std::string_view magic) { return bytes.substr(0, magic.size()) == magic; };
    if (begins("\x89PNG\r\n\x1a\n")) return "image/png";
    if (begins("\xff\xd8\xff")) return "image/jpeg";
    if (begins("BM")) return "image/bmp";
    if (begins("RIFF") && bytes.substr(8, 4) == "WEBP") return "image/webp";
    if (bytes.size() > 18 && bytes[1] <= 1 && (bytes[2] == 2 || bytes[2] == 10 || bytes[2] == 3 || bytes[2] == 1 || bytes[2] == 9))
        return "image/x-tga";
    return {};
}

}  // namespace

std::string quotedName(const std::filesystem::path& path) { return "'" + cleanName(path.filename().string(), "?") + "'"; }

std::string SourceFile::quoted() const { return quotedName(path); }

std::string formatOf(const std::filesystem::path& path) {
    std::string suffix = path.extension().string();
    std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const char* known : {"obj", "ply", "stl", "gltf", "glb", "fbx", "dae"})
        if (suffix == std::string(".") + known) return known;
    if (suffix == ".vrm") return "glb";
    return {};
}

tl::unexpected<Error> badFile(const SourceFile& file, std::size_t line, const std::string& what) {
    return fail("bad-file", file.quoted() + (line > 0 ? ", line " + std::to_string(line) : std::string()) + ": " + what);
}

tl::unexpected<Error> tooManyVertices(const SourceFile& file) { return fail("too-large", file.quoted() + " has more vertices than can be handled: reduce the mesh."); }

void tellReplacedAttributes(RawScene& scene, std::size_t count) {
    if (count > 0)
        tell(scene, Severity::Warning, "non-finite", std::to_string(count) + " numbers in colours, texture coordinates or normals not finite; they were replaced.", count);
}

void SceneVertices::putInto(RawScene& scene) const {
    if (linesAndPoints_ > 0) tell(scene, Severity::Info, "not-a-surface", std::to_string(linesAndPoints_) + " lines and points left out.", linesAndPoints_);
    if (morphsLeftOut_ > 0) tell(scene, Severity::Info, "morph-targets", std::to_string(morphsLeftOut_) + " morph targets left out.", morphsLeftOut_);
    tellReplacedAttributes(scene, badAttributes_);
    ElementMesh& mesh = scene.surface.mesh;
    const auto vertices = static_cast<Eigen::Index>(points_.size() / 3);
    mesh.body.vertices = Eigen::Map<const Points>(points_.data(), vertices, 3);
    mesh.body.triangles = Eigen::Map<const Triangles>(triangles_.data(), static_cast<Eigen::Index>(triangles_.size() / 3), 3);
    if (!anyNormals_ && !anyUv_ && !anyColors_) return;
    RenderMesh& render = mesh.renderMesh;
    render.triangles = mesh.body.triangles;
    for (Eigen::Index v = 0; v < vertices; ++v) render.bodyVertex.push_back(static_cast<std::int32_t>(v));
    if (anyNormals_) render.normals = Eigen::Map<const decltype(render.normals)>(normals_.data(), vertices, 3);
    if (anyUv_) render.texCoords = Eigen::Map<const decltype(render.texCoords)>(texCoords_.data(), vertices, 2);
    if (anyColors_) render.colors = Eigen::Map<const decltype(render.colors)>(colors_.data(), vertices, 4);
}

void tell(RawScene& scene, Severity severity, const char* code, std::string text, std::size_t count, bool fixed) {
    scene.issues.push_back({severity, code, std::move(text), static_cast<int>(std::min<std::size_t>(count, 1U << 30)), fixed, {}, {}});
}

bool parseNumber(std::string_view token, double& value) {
    if (token.size() > 1 && token[0] == '+' && token[1] != '-' && token[1] != '+') token.remove_prefix(1);
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (end != token.data() + token.size() || token.empty()) return false;
    if (error == std::errc::result_out_of_range) {
        // Too large or too small, which from_chars does not tell apart: the sign of the decimal exponent does.
        const std::size_t e = token.find_first_of("eE");
        const bool tiny = e != std::string_view::npos ? token.substr(e + 1, 1) == "-" : token.find_first_of("123456789") > token.find('.');
        value = tiny ? 0.0 : HUGE_VAL;
        return true;
    }
    return error == std::errc();
}

std::string cleanName(std::string_view name, std::string_view otherwise) {
    std::string clean;
    for (std::size_t i = 0; i < name.size();) {
        const std::size_t n = utf8Length(name, i);
        const auto byte = static_cast<unsigned char>(name[i]);
        if (n == 0) {
            if (byte >= 0xA0U) {
                clean += static_cast<char>(0xC0U | byte >> 6);
                clean += static_cast<char>(0x80U | (byte & 0x3FU));
            }
            ++i;
        } else {
            if (n > 1 || (byte >= 0x20U && byte != 0x7FU)) clean += name.substr(i, n);
            i += n;
        }
        if (clean.size() > 200) break;  // a name, not a text
    }
    while (!clean.empty() && clean.front() == ' ') clean.erase(0, 1);
    while (!clean.empty() && clean.back() == ' ') clean.pop_back();
    return clean.empty() ? std::string(otherwise) : clean;
}

std::string uniqueName(std::set<std::string>& taken, const std::string& name) {
    if (taken.insert(name).second) return name;
    std::size_t length = std::min(name.size(), kLongestStem);
    while (length < name.size() && (static_cast<unsigned char>(name[length]) & 0xC0U) == 0x80U) --length;  // whole characters
    const std::string stem = name.substr(0, length);
    for (int i = 2;; ++i)
        if (std::string other = stem + " (" + std::to_string(i) + ")"; taken.insert(other).second) return other;
}

void triangulatePolygon(const std::vector<double>& points, const std::vector<std::int32_t>& corners,
                        std::vector<std::array<std::int32_t, 3>>& triangles) {
    triangles.clear();
    const auto n = static_cast<std::int32_t>(corners.size());
    if (n < 3) return;
    const auto position = [&](std::int32_t k) -> Vec3 {
        const double* p = points.data() + 3 * static_cast<std::size_t>(corners[static_cast<std::size_t>(k)]);
        return {p[0], p[1], p[2]};
    };
    if (n == 3) {
        triangles.push_back({0, 1, 2});
        return;
    }
    double largest = 0.0;
    for (std::int32_t k = 0; k < n; ++k) {
        if (!allFinite(position(k))) {  // refused later, where the vertex is told
            for (std::int32_t i = 1; i + 1 < n; ++i) triangles.push_back({0, i, i + 1});
            return;
        }
        largest = std::max(largest, (position(k) - position(0)).cwiseAbs().maxCoeff());
    }
    // Relative to the first corner and to the size: far or tiny polygons neither cancel nor underflow.
    const double scale = largest > 0.0 ? 1.0 / largest : 0.0;
    std::vector<Vec3> p(static_cast<std::size_t>(n));
    for (std::int32_t k = 0; k < n; ++k) p[static_cast<std::size_t>(k)] = (position(k) - position(0)) * (std::isfinite(scale) ? scale : 0.0);
    if (n == 4) {
        const Vec3 ac = p[2] - p[0], bd = p[3] - p[1];
        const double foldAc = (p[1] - p[0]).cross(ac).dot(ac.cross(p[3] - p[0]));  // cosine of the fold along each diagonal, unscaled
        const double foldBd = (p[2] - p[1]).cross(bd).dot(bd.cross(p[0] - p[1]));
        const bool alongAc = (foldAc > 0.0) != (foldBd > 0.0) ? foldAc > 0.0 : ac.squaredNorm() <= bd.squaredNorm();
        if (alongAc)
            triangles.insert(triangles.end(), {{0, 1, 2}, {0, 2, 3}});
        else
            triangles.insert(triangles.end(), {{0, 1, 3}, {1, 2, 3}});
        return;
    }
    if (n > kLargestByEars) {  // ears cost n^3
        Points polygon(n, 3);
        for (std::int32_t k = 0; k < n; ++k) polygon.row(k) = p[static_cast<std::size_t>(k)].transpose();
        triangles = triangulateHole(polygon);
        if (triangles.size() == corners.size() - 2) return;
        triangles.clear();
        for (std::int32_t i = 1; i + 1 < n; ++i) triangles.push_back({0, i, i + 1});
        return;
    }
    // Ear clipping in the plane of the area vector; of all ears the one with the roundest triangle.
    Vec3 normal = Vec3::Zero();
    for (std::int32_t k = 0; k < n; ++k) normal += p[static_cast<std::size_t>(k)].cross(p[static_cast<std::size_t>((k + 1) % n)]);
    const double length = normal.norm();
    normal = length > 0.0 ? Vec3(normal / length) : Vec3::UnitZ();
    const auto turn = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
        const auto &pa = p[static_cast<std::size_t>(a)], &pb = p[static_cast<std::size_t>(b)], &pc = p[static_cast<std::size_t>(c)];
        return (pb - pa).cross(pc - pa).dot(normal);
    };
    std::vector<std::int32_t> ring(static_cast<std::size_t>(n));
    for (std::int32_t k = 0; k < n; ++k) ring[static_cast<std::size_t>(k)] = k;
    while (ring.size() > 3) {
        const std::size_t m = ring.size();
        std::size_t best = 0;
        double bestQuality = -HUGE_VAL;
        for (std::size_t i = 0; i < m; ++i) {
            const std::int32_t a = ring[(i + m - 1) % m], b = ring[i], c = ring[(i + 1) % m];
            const double area = turn(a, b, c);
            bool ear = area > 0.0;
            for (std::size_t j = 0; ear && j < m; ++j) {
                const std::int32_t q = ring[j];
                if (q == a || q == b || q == c) continue;
                ear = !(turn(a, b, q) >= 0.0 && turn(b, c, q) >= 0.0 && turn(c, a, q) >= 0.0);
            }
            const auto &pa = p[static_cast<std::size_t>(a)], &pb = p[static_cast<std::size_t>(b)], &pc = p[static_cast<std::size_t>(c)];
            const double sides = (pb - pa).squaredNorm() + (pc - pb).squaredNorm() + (pa - pc).squaredNorm();
            const double roundness = sides > 0.0 ? area / sides : 0.0;
            const double quality = ear ? roundness : roundness - 10.0;  // a polygon that crosses itself has no ear: still cut it
            if (quality > bestQuality) bestQuality = quality, best = i;
        }
        triangles.push_back({ring[(best + m - 1) % m], ring[best], ring[(best + 1) % m]});
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(best));
    }
    triangles.push_back({ring[0], ring[1], ring[2]});
}

Result<std::string> readBeside(const SourceFile& file, std::string_view name, std::size_t limit) {
    namespace fs = std::filesystem;
    std::string plain(name);
    std::replace(plain.begin(), plain.end(), '\\', '/');
    if (plain.find('\0') != std::string::npos) return fail("outside", "has no valid name");
    fs::path relative(plain);
    // Absolute paths are those of another computer: the file may lie beside all the same.
    if (relative.is_absolute() || (plain.size() > 1 && plain[1] == ':')) relative = relative.filename();
    std::error_code error;
    const fs::path folder = fs::weakly_canonical(fs::absolute(file.path, error).parent_path(), error);
    const fs::path whole = fs::weakly_canonical(folder / relative, error);
    if (error) return fail("missing", "was not found");
    const fs::path inside = whole.lexically_relative(folder);
    if (inside.empty() || *inside.begin() == "..") return fail("outside", "lies outside the folder of the file");
    if (!fs::is_regular_file(whole, error)) return fail("missing", "was not found");
    const std::uintmax_t size = fs::file_size(whole, error);
    if (error) return fail("missing", "was not found");
    if (size > limit) return fail("too-large", "is larger than " + std::to_string(limit >> 20) + " MB");
    std::string bytes(size, '\0');
    std::ifstream in(whole, std::ios::binary);
    if (!in.read(bytes.data(), static_cast<std::streamsize>(size))) return fail("missing", "could not be read");
    return bytes;
}

int TextureLoader::fromFile(std::string_view name) {
    for (const auto& [known, index] : known_)
        if (known == name) return index;
    int index = -1;
    if (auto bytes = readBeside(file_, name, kLargestTexture)) {
        index = fromBytes(name, *bytes);
    } else {
        tell(scene_, Severity::Warning, "texture", "The texture '" + cleanName(name, "?") + "' " + bytes.error().message + " and was left out.", 1);
    }
    known_.emplace_back(name, index);
    return index;
}

int TextureLoader::fromBytes(std::string_view name, std::string_view bytes) {
    const std::string mime = mimeOf(bytes);
    total_ += bytes.size();
    if (mime.empty() || bytes.size() > kLargestTexture || total_ > kLargestTextures) {
        tell(scene_, Severity::Warning, "texture",
             "The texture '" + cleanName(name, "?") + "' is " + (mime.empty() ? "no PNG, JPEG, TGA, BMP or WebP picture" : "too large") +
                 " and was left out.",
             1);
        return -1;
    }
    Texture texture;
    texture.name = cleanName(std::filesystem::path(std::string(name)).filename().string(), "texture");
    texture.mimeType = mime;
    texture.bytes.assign(bytes.begin(), bytes.end());
    scene_.surface.mesh.renderMesh.textures.push_back(std::move(texture));
    return static_cast<int>(scene_.surface.mesh.renderMesh.textures.size()) - 1;
}

}  // namespace imomushi
