// SPDX-License-Identifier: GPL-3.0-or-later
// PLY, ascii and binary of both byte orders, with any properties. Source: Turk, "The PLY Polygon File Format", 1994. Own reader: single
// precision would be lost and Debian has none that checks counts against the file.
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

#include "core/base/colour.h"
#include "core/io/reader_support.h"
#include "core/io/text_scanner.h"

namespace imomushi {
namespace {

enum class Type { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float, Double };

struct Property {
    std::string name;
    Type type = Type::Float;
    bool list = false;
    Type countType = Type::Uint8;
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

std::size_t sizeOf(Type t) {
    switch (t) {
        case Type::Int8:
        case Type::Uint8: return 1;
        case Type::Int16:
        case Type::Uint16: return 2;
        case Type::Double: return 8;
        default: return 4;
    }
}

bool parseType(std::string_view word, Type& type) {
    static constexpr std::pair<std::string_view, Type> kTypes[] = {
        {"char", Type::Int8},    {"int8", Type::Int8},     {"uchar", Type::Uint8},  {"uint8", Type::Uint8}, {"short", Type::Int16},  {"int16", Type::Int16},
        {"ushort", Type::Uint16}, {"uint16", Type::Uint16}, {"int", Type::Int32},   {"int32", Type::Int32}, {"uint", Type::Uint32},  {"uint32", Type::Uint32},
        {"float", Type::Float},  {"float32", Type::Float}, {"double", Type::Double}, {"float64", Type::Double}};
    for (const auto& [name, value] : kTypes)
        if (name == word) {
            type = value;
            return true;
        }
    return false;
}

/// Colours of integer types run to their largest value.
double colorScale(Type t) {
    switch (t) {
        case Type::Float:
        case Type::Double: return 1.0;
        case Type::Uint16:
        case Type::Int16: return 1.0 / 65535.0;
        case Type::Uint32:
        case Type::Int32: return 1.0 / 4294967295.0;
        default: return 1.0 / 255.0;
    }
}

class PlyReader {
public:
    explicit PlyReader(const SourceFile& file) : file_(file), lines_(file.bytes), textures_(file, scene_) { scene_.format = "ply"; }

    Result<RawScene> read() {
        if (auto done = header(); !done) return tl::unexpected(done.error());
        if (splats()) return fail("splats", file_.quoted() + " holds gaussian splats, a cloud without a surface: make a mesh of it in the program that it came from, and import that.");
        for (const Element& element : elements_)
            if (auto done = body(element); !done) return tl::unexpected(done.error());
        return finish();
    }

private:
    Result<void> header() {
        std::string_view line;
        if (!lines_.next(line) || trimmed(line) != "ply") return badFile(file_, 1, "a PLY file begins with 'ply'.");
        bool format = false;
        std::string texture;
        while (lines_.next(line)) {
            const std::string_view key = takeWord(line);
            if (key == "comment") {
                if (takeWord(line) == "TextureFile") texture = trimmed(line);
            } else if (key == "format") {
                const std::string_view word = takeWord(line);
                ascii_ = word == "ascii";
                swap_ = (word == "binary_big_endian") == (std::endian::native == std::endian::little);
                format = ascii_ || word == "binary_little_endian" || word == "binary_big_endian";
                if (!format) return badFile(file_, lines_.number(), "'" + cleanName(word, "?") + "' is no format of a PLY file.");
            } else if (key == "element") {
                Element& element = elements_.emplace_back();
                element.name = takeWord(line);
                const std::string_view count = takeWord(line);
                const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
                if (error != std::errc() || end != count.data() + count.size()) return badFile(file_, lines_.number(), "'" + cleanName(count, "?") + "' is no number of elements.");
            } else if (key == "property") {
                if (elements_.empty()) return badFile(file_, lines_.number(), "a property stands before the first element.");
                Property property;
                std::string_view word = takeWord(line);
                bool known = true;
                if (word == "list") {
                    property.list = true;
                    known = parseType(takeWord(line), property.countType);
                    word = takeWord(line);
                }
                known = known && parseType(word, property.type);
                property.name = takeWord(line);
                if (!known || property.name.empty() || (property.list && (property.countType == Type::Float || property.countType == Type::Double)))
                    return badFile(file_, lines_.number(), "a property of a kind that PLY does not have.");
                elements_.back().properties.push_back(property);
            } else if (key == "end_header") {
                if (!format) return badFile(file_, lines_.number(), "the header says no format.");
                rest_ = lines_.rest();
                if (!texture.empty()) {
                    Material& material = scene_.surface.mesh.renderMesh.materials.emplace_back();
                    material.name = "material";
                    material.baseColorTexture = textures_.fromFile(texture);
                    if (material.baseColorTexture >= 0) material.baseColor.setOnes();
                }
                return checkCounts();
            } else if (key != "obj_info" && !key.empty()) {
                return badFile(file_, lines_.number(), "'" + cleanName(key, "?") + "' has no meaning in the header of a PLY file.");
            }
        }
        return badFile(file_, lines_.number(), "the header has no end: the file is cut off, export it again.");
    }

    /// No memory is asked for that the file could not fill.
    Result<void> checkCounts() {
        double least = 0.0;
        for (const Element& element : elements_) {
            double size = 0.0;
            for (const Property& p : element.properties) size += ascii_ ? 2.0 : static_cast<double>(sizeOf(p.list ? p.countType : p.type));
            least += size * static_cast<double>(element.count);
            if (element.name == "vertex" && element.count > std::uint64_t{1} << 30) least = HUGE_VAL;
            if (element.properties.empty() && element.count > 0)
                return badFile(file_, 0, "element '" + cleanName(element.name, "?") + "' has no properties.");
        }
        if (least > static_cast<double>(rest_.size()) + 1.0)
            return badFile(file_, 0, "announces more vertices and faces than it holds: it is cut off or damaged, export it again.");
        return {};
    }

    /// Vertices with the scale, rotation and colour of a splat each, and no face.
    [[nodiscard]] bool splats() const {
        std::size_t known = 0;
        for (const Element& element : elements_) {
            if (element.name == "face" && element.count > 0) return false;
            for (const Property& p : element.properties) known += p.name == "f_dc_0" || p.name == "scale_0" || p.name == "rot_0";
        }
        return known == 3;
    }

    tl::unexpected<Error> cutOff(const Element& element, std::uint64_t i) {
        return badFile(file_, 0, "ends within '" + cleanName(element.name, "?") + "' number " + std::to_string(i + 1) + " of " + std::to_string(element.count) +
                                     ": it is cut off, export it again.");
    }

    bool next(Type type, double& value) {
        if (ascii_) {
            while (words_.empty() || (word_ = takeWord(words_)).empty())
                if (!bodyLines_.next(words_)) return word_ = {}, false;
            return parseNumber(word_, value);
        }
        const std::size_t size = sizeOf(type);
        if (rest_.size() < size) return word_ = {}, false;
        char bytes[8] = {};
        std::memcpy(bytes, rest_.data(), size);
        rest_.remove_prefix(size);
        if (swap_) std::reverse(bytes, bytes + size);
        switch (type) {
            case Type::Int8: value = convert<std::int8_t>(bytes); break;
            case Type::Uint8: value = convert<std::uint8_t>(bytes); break;
            case Type::Int16: value = convert<std::int16_t>(bytes); break;
            case Type::Uint16: value = convert<std::uint16_t>(bytes); break;
            case Type::Int32: value = convert<std::int32_t>(bytes); break;
            case Type::Uint32: value = convert<std::uint32_t>(bytes); break;
            case Type::Float: value = convert<float>(bytes); break;
            case Type::Double: value = convert<double>(bytes); break;
        }
        return true;
    }

    template <class T>
    static double convert(const char* bytes) {
        T v;
        std::memcpy(&v, bytes, sizeof v);
        return static_cast<double>(v);
    }

    tl::unexpected<Error> unreadable(const Element& element, std::uint64_t i) {
        if (word_.empty()) return cutOff(element, i);
        return badFile(file_, headerLines_ + bodyLines_.number(), "'" + cleanName(word_, "?") + "' is not a number.");
    }

    Result<void> body(const Element& element) {
        if (ascii_ && !bodyBegun_) {
            bodyBegun_ = true;
            headerLines_ = lines_.number();
            bodyLines_ = LineScanner(rest_);
        }
        const bool vertex = element.name == "vertex", face = element.name == "face";
        if (!vertex && !face && element.count > 0)
            tell(scene_, Severity::Info, "not-understood", "'" + cleanName(element.name, "?") + "' (" + std::to_string(element.count) + ") left out.", element.count);
        // What each property means: an index into `values`.
        enum : std::size_t { X, Y, Z, Nx, Ny, Nz, R, G, B, A, U, V, kMeanings };
        std::vector<int> meaning(element.properties.size(), -1);
        int indices = -1, wedges = -1;
        double scale[kMeanings];
        bool has[kMeanings] = {};
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
            const Property& property = element.properties[p];
            static constexpr std::pair<std::string_view, std::size_t> kNames[] = {
                {"x", X}, {"y", Y}, {"z", Z}, {"nx", Nx}, {"ny", Ny}, {"nz", Nz}, {"red", R}, {"green", G}, {"blue", B}, {"alpha", A},
                {"r", R}, {"g", G}, {"b", B}, {"a", A}, {"diffuse_red", R}, {"diffuse_green", G}, {"diffuse_blue", B}, {"diffuse_alpha", A},
                {"u", U}, {"v", V}, {"s", U}, {"t", V}, {"texture_u", U}, {"texture_v", V}};
            if (vertex && !property.list)
                for (const auto& [name, what] : kNames)
                    if (name == property.name && !has[what]) {
                        meaning[p] = static_cast<int>(what);
                        has[what] = true;
                        scale[what] = what >= R && what <= A ? colorScale(property.type) : 1.0;
                    }
            if (face && property.list && (property.name == "vertex_indices" || property.name == "vertex_index")) indices = static_cast<int>(p);
            if (face && property.list && property.name == "texcoord") wedges = static_cast<int>(p);
        }
        if (vertex && !(has[X] && has[Y] && has[Z])) return badFile(file_, 0, "its vertices have no x, y and z.");
        if (vertex && !points_.empty()) return badFile(file_, 0, "has two lists of vertices.");
        if (face && indices < 0) return badFile(file_, 0, "its faces have no vertex_indices.");
        const bool normals = has[Nx] && has[Ny] && has[Nz], colors = has[R] && has[G] && has[B], uv = has[U] && has[V];
        if (vertex) {
            const auto n = static_cast<Eigen::Index>(element.count);
            points_.resize(static_cast<std::size_t>(n) * 3);
            if (normals) normals_.setZero(n, 3);
            if (colors) colors_.setOnes(n, 4);
            if (uv) texCoords_.setZero(n, 2);
        }
        std::vector<std::int32_t> corners;
        std::vector<double> wedge;
        for (std::uint64_t i = 0; i < element.count; ++i) {
            double values[kMeanings] = {};
            corners.clear();
            wedge.clear();
            for (std::size_t p = 0; p < element.properties.size(); ++p) {
                const Property& property = element.properties[p];
                double value = 0.0;
                if (!next(property.list ? property.countType : property.type, value)) return unreadable(element, i);
                if (!property.list) {
                    if (meaning[p] >= 0) values[meaning[p]] = value;
                    continue;
                }
                if (!(value >= 0.0) || value > 1e9 || value != std::floor(value)) return badFile(file_, ascii_ ? headerLines_ + bodyLines_.number() : 0, "a list of '" + cleanName(element.name, "?") + "' number " + std::to_string(i + 1) + " has an impossible length.");
                for (auto left = static_cast<std::uint64_t>(value); left > 0; --left) {
                    if (!next(property.type, value)) return unreadable(element, i);
                    if (static_cast<int>(p) == indices) {
                        if (!(value >= 0.0) || value > 2e9 || value != std::floor(value))
                            return badFile(file_, ascii_ ? headerLines_ + bodyLines_.number() : 0, "face " + std::to_string(i + 1) + " has an impossible vertex index.");
                        corners.push_back(static_cast<std::int32_t>(value));
                    } else if (static_cast<int>(p) == wedges) {
                        wedge.push_back(value);
                    }
                }
            }
            const auto row = static_cast<Eigen::Index>(i);
            if (vertex) {
                std::copy(values + X, values + Z + 1, points_.begin() + 3 * row);
                if (!std::isfinite(values[X]) || !std::isfinite(values[Y]) || !std::isfinite(values[Z]))
                    scene_.nonFinite.emplace_back(static_cast<std::int32_t>(i), "vertex " + std::to_string(i + 1));
                if (normals) {
                    const double length = std::sqrt(values[Nx] * values[Nx] + values[Ny] * values[Ny] + values[Nz] * values[Nz]);
                    if (std::isfinite(length) && length > 0.0)
                        for (int k = 0; k < 3; ++k) normals_(row, k) = static_cast<float>(values[Nx + static_cast<std::size_t>(k)] / length);
                    else
                        badAttributes_ += !std::isfinite(length);
                }
                if (colors) {
                    for (int k = 0; k < 3; ++k) {
                        const auto c = R + static_cast<std::size_t>(k);
                        badAttributes_ += !std::isfinite(values[c]);
                        colors_(row, k) = linearFromSrgb(values[c] * scale[c]);
                    }
                    if (has[A] && std::isfinite(values[A])) colors_(row, 3) = static_cast<float>(std::clamp(values[A] * scale[A], 0.0, 1.0));
                }
                if (uv)
                    for (int k = 0; k < 2; ++k) texCoords_(row, k) = texCoord(values[U + static_cast<std::size_t>(k)], k == 1);
            } else if (face) {
                if (corners.size() < 3) {
                    ++fewCorners_;
                    continue;
                }
                faceLines_.push_back(i);
                faceBegin_.push_back(corners_.size());
                corners_.insert(corners_.end(), corners.begin(), corners.end());
                const bool has6 = wedge.size() == corners.size() * 2;
                anyWedge_ = anyWedge_ || has6;
                for (std::size_t k = 0; k < corners.size() * 2; ++k) wedges_.push_back(has6 ? texCoord(wedge[k], k % 2 == 1) : 0.0f);
            }
        }
        return {};
    }

    float texCoord(double x, bool vertical) {
        if (!std::isfinite(x) || std::abs(x) > 1e30) {
            ++badAttributes_;
            return 0.0f;
        }
        return vertical ? 1.0f - static_cast<float>(x) : static_cast<float>(x);
    }

    Result<RawScene> finish() {
        if (faceBegin_.empty())
            return fail("empty-mesh", file_.quoted() + " has no faces" + (points_.empty() ? "" : ", only points") + ": choose a file with a mesh.");
        faceBegin_.push_back(corners_.size());
        const auto vertices = static_cast<std::int32_t>(points_.size() / 3);
        std::vector<std::int32_t> polygon;
        std::vector<std::array<std::int32_t, 3>> cut;
        std::vector<std::int32_t> triangles;   // body vertices
        std::vector<std::size_t> wedgeOf;      // corner of the file
        std::size_t polygons = 0;
        for (std::size_t f = 0; f + 1 < faceBegin_.size(); ++f) {
            polygon.assign(corners_.begin() + static_cast<std::ptrdiff_t>(faceBegin_[f]), corners_.begin() + static_cast<std::ptrdiff_t>(faceBegin_[f + 1]));
            for (const std::int32_t v : polygon)
                if (v >= vertices)
                    return badFile(file_, 0, "face " + std::to_string(faceLines_[f] + 1) + " refers to vertex " + std::to_string(v) + ", and there are " +
                                                 std::to_string(vertices) + " (counted from 0).");
            polygons += polygon.size() > 3;
            triangulatePolygon(points_, polygon, cut);
            for (const auto& t : cut)
                for (const std::int32_t k : t) {
                    triangles.push_back(polygon[static_cast<std::size_t>(k)]);
                    wedgeOf.push_back(faceBegin_[f] + static_cast<std::size_t>(k));
                }
        }
        if (polygons > 0) tell(scene_, Severity::Info, "not-triangles", std::to_string(polygons) + (polygons == 1 ? " polygon was" : " polygons were") + " cut into triangles.", polygons);
        if (fewCorners_ > 0) tell(scene_, Severity::Info, "degenerate", std::to_string(fewCorners_) + " faces with fewer than three corners left out.", fewCorners_);
        tellReplacedAttributes(scene_, badAttributes_);

        ElementMesh& mesh = scene_.surface.mesh;
        const auto n = static_cast<Eigen::Index>(triangles.size() / 3);
        mesh.body.vertices = Eigen::Map<const Points>(points_.data(), vertices, 3);
        mesh.body.triangles = Eigen::Map<const Triangles>(triangles.data(), n, 3);
        scene_.partNames.push_back(cleanName(file_.path.stem().string(), "mesh"));
        scene_.surface.part.assign(static_cast<std::size_t>(n), 0);
        RenderMesh& render = mesh.renderMesh;
        if (render.materials.empty() || render.materials[0].baseColorTexture < 0)
            render.materials.clear();
        else
            render.material.assign(static_cast<std::size_t>(n), 0);
        if (anyWedge_) {  // texture coordinates per corner: a render vertex each, mend() merges equal ones
            const auto corners = static_cast<Eigen::Index>(triangles.size());
            render.bodyVertex = triangles;
            render.triangles.resize(n, 3);
            for (Eigen::Index i = 0; i < corners; ++i) render.triangles.data()[i] = static_cast<std::int32_t>(i);
            render.texCoords.resize(corners, 2);
            if (normals_.rows() > 0) render.normals.resize(corners, 3);
            if (colors_.rows() > 0) render.colors.resize(corners, 4);
            for (Eigen::Index i = 0; i < corners; ++i) {
                const auto w = 2 * wedgeOf[static_cast<std::size_t>(i)];
                render.texCoords(i, 0) = wedges_[w], render.texCoords(i, 1) = wedges_[w + 1];
                const std::int32_t v = triangles[static_cast<std::size_t>(i)];
                if (normals_.rows() > 0) render.normals.row(i) = normals_.row(v);
                if (colors_.rows() > 0) render.colors.row(i) = colors_.row(v);
            }
        } else if (normals_.rows() + colors_.rows() + texCoords_.rows() > 0) {
            render.triangles = mesh.body.triangles;
            render.bodyVertex.resize(static_cast<std::size_t>(vertices));
            for (std::int32_t v = 0; v < vertices; ++v) render.bodyVertex[static_cast<std::size_t>(v)] = v;
            render.normals = normals_;
            render.colors = colors_;
            render.texCoords = texCoords_;
        }
        return std::move(scene_);
    }

    const SourceFile& file_;
    RawScene scene_;
    LineScanner lines_;
    TextureLoader textures_;
    std::vector<Element> elements_;
    bool ascii_ = false, swap_ = false, bodyBegun_ = false, anyWedge_ = false;
    std::string_view rest_;        // binary: what is not read yet
    LineScanner bodyLines_{{}};    // ascii
    std::string_view words_, word_;
    std::size_t headerLines_ = 0, fewCorners_ = 0, badAttributes_ = 0;
    std::vector<double> points_;
    decltype(RenderMesh::normals) normals_;
    decltype(RenderMesh::colors) colors_;
    decltype(RenderMesh::texCoords) texCoords_;
    std::vector<std::int32_t> corners_;
    std::vector<std::size_t> faceBegin_;
    std::vector<std::uint64_t> faceLines_;
    std::vector<float> wedges_;
};

}  // namespace

Result<RawScene> readPly(const SourceFile& file) { return PlyReader(file).read(); }

}  // namespace imomushi
