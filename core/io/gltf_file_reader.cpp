// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/io/gltf_file_reader.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/base/base64.h"
#include "core/base/json_member.h"
#include "core/io/gltf_compression.h"
#include "core/io/reader_support.h"

namespace imomushi {

namespace {

using Json = GltfFileReader::Json;

constexpr std::size_t kLargestBuffer = std::size_t{1} << 30;
constexpr std::uint64_t kMaxItems = std::uint64_t{1} << 28;  // of an accessor


/// Bytes of one component, 0: no such type.
std::size_t componentSize(std::uint64_t type) { return type == 5120 || type == 5121 ? 1 : type == 5122 || type == 5123 ? 2 : type == 5125 || type == 5126 ? 4 : 0; }

double component(const char* at, std::uint64_t type, bool normalized) {
    const auto get = [&](auto v, double scale) {
        std::memcpy(&v, at, sizeof v);
        return normalized ? std::max(static_cast<double>(v) / scale, -1.0) : static_cast<double>(v);
    };
    switch (type) {
        case 5120: return get(std::int8_t{}, 127.0);
        case 5121: return get(std::uint8_t{}, 255.0);
        case 5122: return get(std::int16_t{}, 32767.0);
        case 5123: return get(std::uint16_t{}, 65535.0);
        case 5125: return get(std::uint32_t{}, 4294967295.0);
        default: {
            float f = 0.0f;
            std::memcpy(&f, at, sizeof f);
            return static_cast<double>(f);
        }
    }
}

}  // namespace

GltfFileReader::GltfFileReader(const SourceFile& file) : file_(file) {
    openContainer();
    if (!json_.is_object()) refuse("holds no glTF scene.");
    const std::string version = text(member(member(json_, "asset"), "version"));
    if (version.substr(0, 1) == "1" || (version.empty() && !member(json_, "techniques").is_null())) refuseAsOld("glTF version '" + cleanName(version, "1") + "'");
    if (version.substr(0, 2) != "2.") refuse("is glTF version '" + cleanName(version, "?") + "'; export it as version 2.");
    checkExtensions();
    buffers_.resize(list("buffers").size());
}

void GltfFileReader::refuse(const std::string& what) const { throw Refused{badFile(file_, 0, what).value()}; }

void GltfFileReader::refuseAsOld(const std::string& what) const {
    throw Refused{{"old-gltf", file_.quoted() + " is " + what + ", and 2 is read: export it again as glTF 2.0, or convert it with gltf-pipeline."}};
}

void GltfFileReader::refuseAsTooLarge() const { throw Refused{tooManyVertices(file_).value()}; }

const Json& GltfFileReader::member(const Json& object, const char* key) {
    return jsonMember(object, key);
}

const Json& GltfFileReader::array(const Json& value) const {
    static const Json kEmpty = Json::array();
    if (value.is_null()) return kEmpty;
    if (!value.is_array()) refuse("has something else where a list belongs.");
    return value;
}

const Json& GltfFileReader::list(const char* key) const { return array(member(json_, key)); }
std::string GltfFileReader::text(const Json& value) { return value.is_string() ? value.get<std::string>() : std::string(); }
std::uint64_t GltfFileReader::number(const Json& value, const char* what, std::optional<std::uint64_t> otherwise) const {
    if (value.is_null() && otherwise) return *otherwise;
    if (value.is_number_unsigned()) return value.get<std::uint64_t>();
    if (value.is_number_float() && value.get<double>() >= 0.0 && value.get<double>() < 9e15 && value.get<double>() == std::floor(value.get<double>()))
        return static_cast<std::uint64_t>(value.get<double>());
    refuse(std::string("has no valid ") + what + ".");
}

std::size_t GltfFileReader::index(const Json& value, std::size_t count, const char* what, std::optional<std::uint64_t> otherwise) const {
    const std::uint64_t i = number(value, what, otherwise);
    if (i >= count) refuse(std::string("refers to ") + what + " " + std::to_string(i) + ", and there are " + std::to_string(count) + " (counted from 0).");
    return static_cast<std::size_t>(i);
}

std::vector<double> GltfFileReader::numbers(const Json& value, std::size_t n, std::vector<double> otherwise, const char* what) const {
    if (value.is_null()) return otherwise;
    std::vector<double> result;
    if (value.is_array())
        for (const Json& x : value)
            if (x.is_number() && std::isfinite(x.get<double>())) result.push_back(x.get<double>());
    if (result.size() != n || value.size() != n) refuse(std::string("has no valid ") + what + ".");
    return result;
}

double GltfFileReader::number(const Json& value, double otherwise) const { return value.is_number() && std::isfinite(value.get<double>()) ? value.get<double>() : otherwise; }

void GltfFileReader::openContainer() {
    std::string_view text = file_.bytes;
    if (text.substr(0, 4) == "glTF") {
        binaryFile_ = true;
        const auto word = [&](std::size_t at) {
            std::uint32_t v = 0;
            std::memcpy(&v, file_.bytes.data() + at, 4);
            return v;
        };
        if (text.size() < 20) refuse("is cut off: export it again.");
        if (word(4) == 1) refuseAsOld("GLB version 1");
        if (word(4) != 2) refuse("is GLB version " + std::to_string(word(4)) + "; export it as version 2.");
        if (word(8) > text.size()) refuse("is cut off: it announces " + std::to_string(word(8)) + " bytes and has " + std::to_string(text.size()) + "; export it again.");
        text = {};
        bool first = true;
        for (std::size_t at = 12; at + 8 <= word(8);) {
            const std::size_t length = word(at);
            const std::uint32_t type = word(at + 4);
            at += 8;
            if (length > word(8) - at) refuse("is cut off within a chunk: export it again.");
            const std::string_view chunk = file_.bytes.substr(at, length);
            if (first && type != 0x4E4F534A) refuse("does not begin with its JSON chunk: export it again.");
            if (first) text = chunk;
            if (!first && type == 0x004E4942 && !binary_) binary_ = chunk;
            first = false;
            at += (length + 3) / 4 * 4;
        }
    }
    if (text.substr(0, 3) == "\xef\xbb\xbf") text.remove_prefix(3);
    try {
        json_ = Json::parse(text);
    } catch (const Json::parse_error& e) {
        const std::size_t lines = static_cast<std::size_t>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(std::min(e.byte, text.size())), '\n')) + 1;
        throw Refused{badFile(file_, binaryFile_ ? 0 : lines, "its JSON is damaged at byte " + std::to_string(e.byte) + ": export it again.").value()};
    }
}

void GltfFileReader::checkExtensions() const {
    static const char* const kKnown[] = {"KHR_mesh_quantization", "KHR_texture_transform", "KHR_lights_punctual", "EXT_texture_webp", "KHR_texture_basisu",
                                         "KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression",
                                         "KHR_animation_pointer", "KHR_gaussian_splatting", "VRMC_vrm", "VRMC_springBone", "VRMC_materials_mtoon"};
    for (const Json& name : list("extensionsRequired")) {
        const std::string extension = text(name);
        const bool known = extension.rfind("KHR_materials_", 0) == 0 || std::find(std::begin(kKnown), std::end(kKnown), extension) != std::end(kKnown);
        if (!known) refuse("needs the extension '" + cleanName(extension, "?") + "', which is not known here: export it without.");
    }
}

std::string_view GltfFileReader::buffer(std::size_t i) {
    auto& known = buffers_[i];
    if (known) return *known;
    const Json& from = list("buffers")[i];
    const std::uint64_t length = number(member(from, "byteLength"), "length of a buffer");
    const std::string uri = text(member(from, "uri"));
    if (uri.empty()) {
        if (i != 0 || !binary_) refuse("has a buffer without content: export it again.");
        known = *binary_;
    } else if (uri.rfind("data:", 0) == 0) {
        owned_.push_back(std::make_unique<std::string>(decodeData(uri)));
        known = *owned_.back();
    } else {
        auto bytes = readBeside(file_, decodePercent(uri), kLargestBuffer);
        if (!bytes) refuse("needs the file '" + cleanName(uri, "?") + "', which " + bytes.error().message + ".");
        owned_.push_back(std::make_unique<std::string>(std::move(*bytes)));
        known = *owned_.back();
    }
    if (known->size() < length)
        refuse("has a buffer of " + std::to_string(known->size()) + " bytes that should have " + std::to_string(length) + ": it is cut off, export it again.");
    known = known->substr(0, length);
    return *known;
}

std::string GltfFileReader::decodeData(const std::string& uri) const {
    const std::size_t comma = uri.find(',');
    if (comma == std::string::npos || uri.substr(0, comma).find(";base64") == std::string::npos) refuse("has data that is not in base64: export it again.");
    auto bytes = fromBase64(std::string_view(uri).substr(comma + 1));
    if (!bytes) refuse("has damaged base64 data: export it again.");
    return std::move(*bytes);
}

std::string GltfFileReader::decodePercent(const std::string& uri) {
    std::string plain;
    const auto hex = [](char c) { return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1; };
    for (std::size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] == '%' && i + 2 < uri.size() && hex(uri[i + 1]) >= 0 && hex(uri[i + 2]) >= 0) {
            plain += static_cast<char>(hex(uri[i + 1]) * 16 + hex(uri[i + 2]));
            i += 2;
        } else {
            plain += uri[i];
        }
    }
    return plain;
}

std::string_view GltfFileReader::bufferView(std::size_t i, std::size_t* stride) {
    if (const auto plain = decompressed(i, stride)) return *plain;
    const Json& view = list("bufferViews")[i];
    const std::string_view whole = buffer(index(member(view, "buffer"), buffers_.size(), "buffer"));
    const std::uint64_t offset = number(member(view, "byteOffset"), "offset of a buffer view", 0), length = number(member(view, "byteLength"), "length of a buffer view");
    if (offset > whole.size() || length > whole.size() - offset) refuse("has a buffer view that reaches beyond its buffer: export it again.");
    if (stride) *stride = static_cast<std::size_t>(number(member(view, "byteStride"), "stride of a buffer view", 0));
    return whole.substr(offset, length);
}

std::optional<std::string_view> GltfFileReader::decompressed(std::size_t i, std::size_t* stride) {
    const Json& view = list("bufferViews")[i];
    const char* extension = nullptr;
    for (const char* known : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
        if (!member(member(view, "extensions"), known).is_null()) extension = known;
    if (!extension) return std::nullopt;
    const Json& from = member(member(view, "extensions"), extension);
    const std::size_t at = index(member(from, "buffer"), buffers_.size(), "buffer");
    const std::uint64_t offset = number(member(from, "byteOffset"), "offset of a buffer view", 0), length = number(member(from, "byteLength"), "length of a buffer view");
    MeshoptView how;
    how.mode = cleanName(text(member(from, "mode")), "?");
    how.filter = cleanName(text(member(from, "filter")), "NONE");
    how.count = number(member(from, "count"), "count");
    how.stride = number(member(from, "byteStride"), "stride of a buffer view");
    // As of an accessor: the stride of the view, which is that of what was compressed.
    if (stride) *stride = static_cast<std::size_t>(number(member(view, "byteStride"), "stride of a buffer view", 0));
    if (const auto known = decompressed_.find(i); known != decompressed_.end()) return known->second;
    const std::string_view whole = buffer(at);
    if (offset > whole.size() || length > whole.size() - offset) refuse("has a buffer view that reaches beyond its buffer: export it again.");
    if (how.stride > 256 || how.count > kMaxItems || how.count * how.stride > kLargestBuffer - std::min(kLargestBuffer, decompressedBytes_)) refuseAsTooLarge();
    auto plain = std::make_unique<std::string>();
    if (const std::string why = decodeMeshopt(how, whole.substr(offset, length), *plain); !why.empty()) {
        const Json& fallback = list("buffers")[index(member(view, "buffer"), buffers_.size(), "buffer")];
        if (!text(member(fallback, "uri")).empty()) return std::nullopt;  // plain bytes are there
        refuse(std::string("has data compressed by ") + extension + " that " + why + ": export it without compression.");
    }
    decompressedBytes_ += plain->size();
    owned_.push_back(std::move(plain));
    return decompressed_[i] = *owned_.back();
}

bool GltfFileReader::hasNumbers(const Json& reference) const {
    const Json& accessors = list("accessors");
    const Json& from = accessors[index(reference, accessors.size(), "accessor")];
    return !member(from, "bufferView").is_null() || !member(from, "sparse").is_null();
}

GltfFileReader::Values GltfFileReader::accessor(const Json& reference, std::string_view packed, std::size_t width, std::uint64_t componentType, const char* what) {
    const Json& accessors = list("accessors");
    const Json& from = accessors[index(reference, accessors.size(), "accessor")];
    const std::size_t size = componentSize(componentType);
    if (width == 0 || size == 0) refuse(std::string("has ") + what + " of an unknown type: export it again.");
    const Json& normalizedFlag = member(from, "normalized");
    const bool normalized = normalizedFlag.is_boolean() && normalizedFlag.get<bool>() && componentType != 5126;
    Values values{packed.size() / (width * size), width, {}};
    values.at.resize(values.count * width);
    for (std::size_t i = 0; i < values.at.size(); ++i) values.at[i] = component(packed.data() + i * size, componentType, normalized);
    return values;
}

GltfFileReader::Values GltfFileReader::accessor(const Json& reference, const char* what) {
    const Json& accessors = list("accessors");
    const Json& from = accessors[index(reference, accessors.size(), "accessor")];
    const std::string type = text(member(from, "type"));
    const std::size_t width = type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : type == "MAT4" ? 16 : 0;
    const std::uint64_t componentType = number(member(from, "componentType"), "component type");
    const std::size_t size = componentSize(componentType);
    const std::uint64_t count = number(member(from, "count"), "count");
    if (width == 0 || size == 0) refuse(std::string("has ") + what + " of an unknown type: export it again.");
    if (count > kMaxItems) refuseAsTooLarge();
    const Json& normalizedFlag = member(from, "normalized");
    const bool normalized = normalizedFlag.is_boolean() && normalizedFlag.get<bool>() && componentType != 5126;
    Values values{static_cast<std::size_t>(count), width, {}};
    if (const Json& view = member(from, "bufferView"); !view.is_null()) {
        std::size_t stride = 0;
        const std::string_view bytes = slice(view, number(member(from, "byteOffset"), "offset of an accessor", 0), count, width * size, stride, what);
        values.at.resize(values.count * width);
        for (std::size_t i = 0; i < values.count; ++i)
            for (std::size_t k = 0; k < width; ++k) values.at[i * width + k] = component(bytes.data() + i * stride + k * size, componentType, normalized);
    } else {
        values.at.assign(values.count * width, 0.0);
    }
    if (const Json& sparse = member(from, "sparse"); !sparse.is_null()) {
        const std::uint64_t few = number(member(sparse, "count"), "count");
        const Json &where = member(sparse, "indices"), &with = member(sparse, "values");
        const std::uint64_t indexType = number(member(where, "componentType"), "component type");
        const std::size_t indexSize = componentSize(indexType);
        if (indexSize == 0 || few > count) refuse(std::string("has ") + what + " with impossible sparse values: export it again.");
        std::size_t indexStride = 0, stride = 0;
        const std::string_view places = slice(member(where, "bufferView"), number(member(where, "byteOffset"), "offset", 0), few, indexSize, indexStride, what);
        const std::string_view bytes = slice(member(with, "bufferView"), number(member(with, "byteOffset"), "offset", 0), few, width * size, stride, what);
        for (std::size_t i = 0; i < few; ++i) {
            const double place = component(places.data() + i * indexStride, indexType, false);
            if (!(place >= 0.0 && place < static_cast<double>(count))) refuse(std::string("has ") + what + " with impossible sparse values: export it again.");
            for (std::size_t k = 0; k < width; ++k)
                values.at[static_cast<std::size_t>(place) * width + k] = component(bytes.data() + i * stride + k * size, componentType, normalized);
        }
    }
    return values;
}

std::string_view GltfFileReader::slice(const Json& view, std::uint64_t offset, std::uint64_t count, std::size_t size, std::size_t& stride, const char* what) {
    const std::string_view bytes = bufferView(index(view, list("bufferViews").size(), "buffer view"), &stride);
    if (stride == 0) stride = size;
    if (stride < size || stride > 4096 || count > kMaxItems) refuse(std::string("has ") + what + " with an impossible stride: export it again.");
    const std::uint64_t needed = count == 0 ? 0 : stride * (count - 1) + size;
    if (offset > bytes.size() || needed > bytes.size() - offset) refuse(std::string("has ") + what + " that reach beyond their buffer view: export it again.");
    return bytes.substr(offset);
}

}  // namespace imomushi
