// SPDX-License-Identifier: GPL-3.0-or-later
// Wavefront OBJ with vertex colours ("v x y z r g b") and MTL. Own reader: those in Debian read single precision or pass over what they do not
// understand. Source: "Object Files (.obj)", Alias|Wavefront Advanced Visualizer manual, appendix B1.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>

#include "core/base/colour.h"
#include "core/base/try.h"
#include "core/io/reader_support.h"
#include "core/io/text_scanner.h"

namespace imomushi {
namespace {

constexpr std::size_t kLargestMtl = std::size_t{16} << 20;

struct Corner {
    std::int32_t v = 0, vt = -1, vn = -1;
    bool operator==(const Corner&) const = default;
};
struct CornerHash {
    std::size_t operator()(const Corner& c) const {
        std::uint64_t h = static_cast<std::uint64_t>(c.v) * 0x9e3779b97f4a7c15ULL;
        h = (h ^ static_cast<std::uint32_t>(c.vt)) * 0xff51afd7ed558ccdULL;
        return (h ^ (h >> 31) ^ static_cast<std::uint32_t>(c.vn)) * 0xc4ceb9fe1a85ec53ULL;
    }
};

class ObjReader {
public:
    explicit ObjReader(const SourceFile& file) : file_(file), textures_(file, scene_) { scene_.format = "obj"; }

    Result<RawScene> read() {
        LineScanner lines(file_.bytes);
        std::string_view line;
        std::string joined;
        while (lines.next(line)) {
            number_ = lines.number();
            if (!line.empty() && line.back() == '\\') {  // goes on in the next line
                joined.assign(line.substr(0, line.size() - 1));
                while (lines.next(line)) {
                    const bool more = !line.empty() && line.back() == '\\';
                    joined += ' ';
                    joined += line.substr(0, line.size() - (more ? 1 : 0));
                    if (!more) break;
                }
                line = joined;
            }
            if (auto done = statement(line); !done) return tl::unexpected(done.error());
        }
        return finish();
    }

private:
    Result<void> statement(std::string_view line) {
        line = withoutComment(line);
        const std::string_view key = takeWord(line);
        if (key.empty()) return {};
        if (key == "v") return vertex(line);
        if (key == "vt") return texCoord(line);
        if (key == "vn") return normal(line);
        if (key == "f" || key == "fo") return face(line);
        if (key == "o") {
            objects_ = true;
            part_ = -1;
            partName_ = cleanName(line, "");
        } else if (key == "g") {
            if (!objects_) {
                part_ = -1;
                partName_ = cleanName(line, "");
            }
        } else if (key == "usemtl") {
            material_ = materialNamed(std::string(trimmed(line)));
        } else if (key == "mtllib") {
            library(trimmed(line));
        } else if (key == "l" || key == "p") {
            ++linesAndPoints_;
        } else if (key != "s" && key != "mg" && key != "lod" && key != "usemap" && key != "maplib" && key != "shadow_obj" &&
                   key != "trace_obj" && key != "bevel" && key != "c_interp" && key != "d_interp") {
            static const std::set<std::string_view> curved = {"vp",   "cstype", "deg",  "bmat", "step", "curv", "curv2", "surf", "parm",
                                                              "trim", "hole",   "scrv", "sp",   "end",  "con",  "ctech", "stech"};
            if (curved.contains(key))
                ++curves_;
            else if (unknown_++ == 0)
                firstUnknown_ = number_;
        }
        return {};
    }

    /// Names may contain '#': a comment begins a word.
    static std::string_view withoutComment(std::string_view line) {
        for (std::size_t at = line.find('#'); at != std::string_view::npos; at = line.find('#', at + 1))
            if (at == 0 || line[at - 1] == ' ' || line[at - 1] == '\t') return line.substr(0, at);
        return line;
    }

    tl::unexpected<Error> notANumber(std::string_view word) const {
        const bool comma = word.find(',') != std::string_view::npos;
        return badFile(file_, number_, "'" + cleanName(word, "?") + "' is not a number" + (comma ? " (decimals need a point, not a comma)." : "."));
    }

    /// Up to seven numbers of a line; more are counted but not kept.
    Result<int> numbers(std::string_view line, double* values) {
        int n = 0;
        for (std::string_view word = takeWord(line); !word.empty(); word = takeWord(line)) {
            double value = 0.0;
            if (!parseNumber(word, value)) return notANumber(word);
            if (n < 7) values[n] = value;
            ++n;
        }
        return n;
    }

    Result<void> vertex(std::string_view line) {
        double x[7];
        IMOMUSHI_TRY(const auto n, numbers(line, x));
        if (n < 3 || n > 8 || n == 5)
            return badFile(file_, number_, "a vertex needs three coordinates and has " + std::to_string(n) + " numbers.");
        const auto index = static_cast<std::int32_t>(points_.size() / 3);
        if (points_.size() / 3 >= kMaxVertices) return tooManyVertices(file_);
        points_.insert(points_.end(), x, x + 3);
        if (!std::isfinite(x[0]) || !std::isfinite(x[1]) || !std::isfinite(x[2]))
            scene_.nonFinite.emplace_back(index, "line " + std::to_string(number_));
        if (n >= 6) {
            const double* c = n == 6 ? x + 3 : x + 4;
            colors_.resize(points_.size(), 1.0f);
            for (int k = 0; k < 3; ++k) {
                badAttributes_ += !std::isfinite(c[k]);
                colors_[static_cast<std::size_t>(index) * 3 + static_cast<std::size_t>(k)] = linearFromSrgb(c[k]);
            }
        }
        return {};
    }

    Result<void> texCoord(std::string_view line) {
        double x[7] = {};
        IMOMUSHI_TRY(const auto n, numbers(line, x));
        if (n < 1) return badFile(file_, number_, "a texture coordinate has no numbers.");
        texCoords_.push_back(attributeOrZero(x[0], badAttributes_));
        texCoords_.push_back(1.0f - attributeOrZero(x[1], badAttributes_));
        return {};
    }

    Result<void> normal(std::string_view line) {
        double x[7] = {};
        IMOMUSHI_TRY(const auto n, numbers(line, x));
        if (n < 3) return badFile(file_, number_, "a normal needs three numbers and has " + std::to_string(n) + ".");
        const double length = std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        for (int k = 0; k < 3; ++k) normals_.push_back(std::isfinite(length) && length > 0.0 ? static_cast<float>(x[k] / length) : 0.0f);
        badAttributes_ += !std::isfinite(length);
        return {};
    }

    /// "5", "-1": from 1, or backwards from the last one. -1: there is none.
    static bool parseIndex(std::string_view word, std::size_t count, std::int32_t& index, bool& inRange) {
        std::int64_t i = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), i);
        if (end != word.data() + word.size() || word.empty() || (error != std::errc() && error != std::errc::result_out_of_range)) return false;
        if (error != std::errc()) i = 0;
        const std::int64_t zeroBased = i > 0 ? i - 1 : i < 0 ? static_cast<std::int64_t>(count) + i : -1;
        inRange = zeroBased >= 0 && zeroBased < static_cast<std::int64_t>(count);
        index = inRange ? static_cast<std::int32_t>(zeroBased) : -1;
        return true;
    }

    Result<void> face(std::string_view line) {
        corners_.clear();
        for (std::string_view word = takeWord(line); !word.empty(); word = takeWord(line)) {
            const std::size_t slash = word.find('/');
            const std::string_view v = word.substr(0, slash);
            std::string_view vt, vn;
            if (slash != std::string_view::npos) {
                const std::string_view more = word.substr(slash + 1);
                const std::size_t second = more.find('/');
                vt = more.substr(0, second);
                if (second != std::string_view::npos) vn = more.substr(second + 1);
            }
            Corner c;
            bool inRange = false;
            if (!parseIndex(v, points_.size() / 3, c.v, inRange))
                return badFile(file_, number_, "'" + cleanName(word, "?") + "' is not a corner of a face.");
            if (!inRange)
                return badFile(file_, number_,
                               "a face refers to vertex " + std::string(v) + ", and there are " + std::to_string(points_.size() / 3) +
                                   " vertices so far (counted from 1).");
            if (!vt.empty()) {
                if (!parseIndex(vt, texCoords_.size() / 2, c.vt, inRange)) return badFile(file_, number_, "'" + cleanName(word, "?") + "' is not a corner of a face.");
                missingAttributes_ += !inRange;
            }
            if (!vn.empty()) {
                if (!parseIndex(vn, normals_.size() / 3, c.vn, inRange)) return badFile(file_, number_, "'" + cleanName(word, "?") + "' is not a corner of a face.");
                missingAttributes_ += !inRange;
            }
            corners_.push_back(c);
        }
        if (corners_.size() < 3) {
            ++fewCorners_;
            return {};
        }
        polygons_ += corners_.size() > 3;
        positions_.clear();
        for (const Corner& c : corners_) positions_.push_back(c.v);
        triangulatePolygon(points_, positions_, cut_);
        if (part_ < 0) {
            const std::string name = partName_.empty() ? cleanName(file_.path.stem().string(), "mesh") : partName_;
            const auto [it, added] = partNumber_.emplace(name, static_cast<std::int32_t>(scene_.partNames.size()));
            if (added) scene_.partNames.push_back(name);
            part_ = it->second;
        }
        for (const auto& t : cut_) {
            for (const std::int32_t k : t) faces_.push_back(corners_[static_cast<std::size_t>(k)]);
            scene_.surface.part.push_back(part_);
            faceMaterial_.push_back(material_);
        }
        return {};
    }

    int materialNamed(const std::string& name) {
        const auto [it, added] = materialNumber_.emplace(name, static_cast<int>(scene_.surface.mesh.renderMesh.materials.size()));
        if (added) scene_.surface.mesh.renderMesh.materials.emplace_back().name = cleanName(name, "material");
        return it->second;
    }

    void library(std::string_view name) {
        const auto text = readBeside(file_, name, kLargestMtl);
        if (!text) {
            tell(scene_, Severity::Warning, "material", "The material file '" + cleanName(name, "?") + "' " + text.error().message + "; the mesh comes without it.", 1);
            return;
        }
        LineScanner lines(*text);
        std::string_view line;
        Material* material = nullptr;
        while (lines.next(line)) {
            line = withoutComment(line);
            const std::string_view key = takeWord(line);
            double x[7] = {};
            if (key == "newmtl") {
                material = &scene_.surface.mesh.renderMesh.materials[static_cast<std::size_t>(materialNamed(std::string(trimmed(line))))];
            } else if (!material || key.empty()) {
                continue;
            } else if (key == "Kd") {
                const auto n = numbers(line, x);
                if (!n || *n < 1 || !std::isfinite(x[0] + x[1] + x[2])) continue;
                if (*n < 3) x[1] = x[2] = x[0];
                for (int k = 0; k < 3; ++k) material->baseColor[k] = static_cast<float>(std::clamp(x[k], 0.0, 1.0));
            } else if (key == "d" || key == "Tr" || key == "Pm" || key == "Pr") {
                if (const auto n = numbers(line, x); !n || *n < 1 || !std::isfinite(x[0])) continue;
                const auto value = static_cast<float>(std::clamp(x[0], 0.0, 1.0));
                if (key == "d") material->baseColor[3] = value;
                if (key == "Tr") material->baseColor[3] = 1.0f - value;
                if (key == "Pm") material->metallic = value;
                if (key == "Pr") material->roughness = value;
            } else if (key == "map_Kd") {
                const std::size_t i = static_cast<std::size_t>(material - scene_.surface.mesh.renderMesh.materials.data());
                const int texture = textures_.fromFile(mapName(line));
                scene_.surface.mesh.renderMesh.materials[i].baseColorTexture = texture;
                if (texture >= 0) scene_.surface.mesh.renderMesh.materials[i].baseColor.head<3>().setOnes();
            }
        }
    }

    /// The file name after the options of a map statement.
    static std::string_view mapName(std::string_view line) {
        for (;;) {
            std::string_view after = line;
            const std::string_view option = takeWord(after);
            if (option.size() < 2 || option[0] != '-') return trimmed(line);
            const int most = option == "-mm" ? 2 : option == "-s" || option == "-o" || option == "-t" ? 3 : 1;
            for (int k = 0; k < most; ++k) {
                std::string_view rest = after;
                const std::string_view word = takeWord(rest);
                double value = 0.0;
                if (most == 3 && !parseNumber(word, value)) break;  // these have one to three numbers
                after = rest;
            }
            line = after;
        }
    }

    Result<RawScene> finish() {
        if (faces_.empty()) {
            return fail("empty-mesh", file_.quoted() + " has no faces" +
                                          (curves_ > 0 ? ": it holds curved surfaces, which must be exported as polygons." : ": choose a file with a mesh."));
        }
        if (polygons_ > 0) tell(scene_, Severity::Info, "not-triangles", counted(polygons_, "polygon was", "polygons were") + " cut into triangles.", polygons_);
        if (fewCorners_ > 0) tell(scene_, Severity::Info, "degenerate", counted(fewCorners_, "face", "faces") + " with fewer than three corners left out.", fewCorners_);
        if (linesAndPoints_ > 0) tell(scene_, Severity::Info, "not-a-surface", counted(linesAndPoints_, "line or point", "lines and points") + " left out.", linesAndPoints_);
        if (curves_ > 0) tell(scene_, Severity::Warning, "not-a-surface", "Curved surfaces were left out: export them as polygons.", curves_);
        if (unknown_ > 0)
            tell(scene_, Severity::Warning, "not-understood", counted(unknown_, "line", "lines") + " not understood, the first is line " + std::to_string(firstUnknown_) + ".", unknown_);
        if (missingAttributes_ > 0)
            tell(scene_, Severity::Warning, "bad-index", counted(missingAttributes_, "corner refers", "corners refer") + " to texture coordinates or normals that do not exist; they were left out.", missingAttributes_);
        tellReplacedAttributes(scene_, badAttributes_);

        ElementMesh& mesh = scene_.surface.mesh;
        const auto vertices = static_cast<Eigen::Index>(points_.size() / 3);
        const auto triangles = static_cast<Eigen::Index>(faces_.size() / 3);
        mesh.body.vertices = Eigen::Map<const Points>(points_.data(), vertices, 3);
        mesh.body.triangles.resize(triangles, 3);
        for (Eigen::Index i = 0; i < 3 * triangles; ++i) mesh.body.triangles(i / 3, i % 3) = faces_[static_cast<std::size_t>(i)].v;
        if (std::any_of(faceMaterial_.begin(), faceMaterial_.end(), [](int m) { return m >= 0; })) {
            if (std::find(faceMaterial_.begin(), faceMaterial_.end(), -1) != faceMaterial_.end()) {
                const int plain = materialNamed("");
                std::replace(faceMaterial_.begin(), faceMaterial_.end(), -1, plain);
            }
            mesh.renderMesh.material.assign(faceMaterial_.begin(), faceMaterial_.end());
        } else {
            mesh.renderMesh.materials.clear();
            mesh.renderMesh.textures.clear();
        }
        makeRenderMesh(mesh.renderMesh, triangles);
        return std::move(scene_);
    }

    void makeRenderMesh(RenderMesh& render, Eigen::Index triangles) {
        const auto has = [&](auto member) { return std::any_of(faces_.begin(), faces_.end(), [&](const Corner& c) { return c.*member >= 0; }); };
        const bool uv = has(&Corner::vt), normals = has(&Corner::vn), colors = !colors_.empty();
        if (!uv && !normals && !colors) return;
        // Normals are kept only where every corner has one: half of them would shade with zeros.
        const bool allNormals = normals && std::all_of(faces_.begin(), faces_.end(), [](const Corner& c) { return c.vn >= 0; });
        std::unordered_map<Corner, std::int32_t, CornerHash> known;
        std::vector<Corner> corners;
        render.triangles.resize(triangles, 3);
        for (Eigen::Index i = 0; i < 3 * triangles; ++i) {
            Corner c = faces_[static_cast<std::size_t>(i)];
            if (!allNormals) c.vn = -1;
            const auto [it, added] = known.emplace(c, static_cast<std::int32_t>(corners.size()));
            if (added) corners.push_back(c);
            render.triangles(i / 3, i % 3) = it->second;
        }
        const auto n = static_cast<Eigen::Index>(corners.size());
        if (uv) render.texCoords.setZero(n, 2);
        if (allNormals) render.normals.setZero(n, 3);
        if (colors) {
            render.colors.setOnes(n, 4);
            colors_.resize(points_.size(), 1.0f);
        }
        for (Eigen::Index r = 0; r < n; ++r) {
            const Corner& c = corners[static_cast<std::size_t>(r)];
            render.bodyVertex.push_back(c.v);
            if (c.vt >= 0)
                for (int k = 0; k < 2; ++k) render.texCoords(r, k) = texCoords_[static_cast<std::size_t>(c.vt) * 2 + static_cast<std::size_t>(k)];
            if (c.vn >= 0)
                for (int k = 0; k < 3; ++k) render.normals(r, k) = normals_[static_cast<std::size_t>(c.vn) * 3 + static_cast<std::size_t>(k)];
            if (colors)
                for (int k = 0; k < 3; ++k) render.colors(r, k) = colors_[static_cast<std::size_t>(c.v) * 3 + static_cast<std::size_t>(k)];
        }
    }

    const SourceFile& file_;
    RawScene scene_;
    TextureLoader textures_;
    std::size_t number_ = 0;  // line
    std::vector<double> points_;
    std::vector<float> colors_, texCoords_, normals_;
    std::vector<Corner> faces_;  // three per triangle
    std::vector<int> faceMaterial_;
    std::map<std::string, std::int32_t> partNumber_;
    std::map<std::string, int> materialNumber_;
    std::string partName_;
    bool objects_ = false;
    std::int32_t part_ = -1;
    int material_ = -1;
    std::vector<Corner> corners_;
    std::vector<std::int32_t> positions_;
    std::vector<std::array<std::int32_t, 3>> cut_;
    std::size_t polygons_ = 0, fewCorners_ = 0, linesAndPoints_ = 0, curves_ = 0, unknown_ = 0, firstUnknown_ = 0;
    std::size_t missingAttributes_ = 0, badAttributes_ = 0;
};

}  // namespace

Result<RawScene> readObj(const SourceFile& file) { return ObjReader(file).read(); }

}  // namespace imomushi
