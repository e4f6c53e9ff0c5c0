// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/gltf_compressor.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <set>

#include "core/export/gltf_file.h"
#include "core/io/gltf_compression.h"

namespace imomushi {

namespace {

using Json = GltfFile::Json;

constexpr const char* kMeshopt = "EXT_meshopt_compression";

std::uint64_t widthOf(const Json& accessor) {
    const std::string type = accessor.at("type");
    return type == "SCALAR" ? 1 : type == "MAT4" ? 16 : static_cast<std::uint64_t>(type.back() - '0');
}

std::uint64_t sizeOf(int componentType) {
    switch (componentType) {
        case GltfFile::kByte:
        case GltfFile::kUnsignedByte: return 1;
        case GltfFile::kShort:
        case GltfFile::kUnsignedShort: return 2;
        default: return 4;
    }
}

/// How views can be compressed, by their index: those of accessors, each of which has views of its own.
std::map<std::size_t, MeshoptView> compressible(const Json& root) {
    std::set<std::size_t> corners;  // accessors of triangles
    for (const Json& mesh : root.value("meshes", Json::array()))
        for (const Json& primitive : mesh.at("primitives"))
            if (primitive.contains("indices")) corners.insert(primitive.at("indices").get<std::size_t>());
    std::map<std::size_t, MeshoptView> views;
    const auto add = [&](const Json& view, const char* mode, std::uint64_t count, std::uint64_t packed) {
        const auto at = view.get<std::size_t>();
        const std::uint64_t stride = root.at("bufferViews").at(at).value("byteStride", packed);
        if (count > 0 && (*mode == 'I' || (stride % 4 == 0 && stride <= 256))) views[at] = {mode, "NONE", count, stride};
    };
    const Json accessors = root.value("accessors", Json::array());
    for (std::size_t a = 0; a < accessors.size(); ++a) {
        const Json& accessor = accessors[a];
        const std::uint64_t count = accessor.at("count"), packed = widthOf(accessor) * sizeOf(accessor.at("componentType"));
        if (accessor.contains("bufferView")) add(accessor.at("bufferView"), corners.contains(a) ? "INDICES" : "ATTRIBUTES", count, packed);
        if (!accessor.contains("sparse")) continue;
        const Json& sparse = accessor.at("sparse");
        add(sparse.at("indices").at("bufferView"), "INDICES", sparse.at("count"), sizeOf(sparse.at("indices").at("componentType")));
        add(sparse.at("values").at("bufferView"), "ATTRIBUTES", sparse.at("count"), packed);
    }
    return views;
}

void align(std::string& bytes) { bytes.resize((bytes.size() + 3) / 4 * 4, '\0'); }

}  // namespace

Result<std::string> compressGlb(const std::string& glb) {
    std::uint32_t text = 0;
    std::memcpy(&text, glb.data() + 12, 4);
    GltfFile file;
    file.root = Json::parse(glb.begin() + 20, glb.begin() + 20 + text);
    const std::string_view plain = std::string_view(glb).substr(28 + std::size_t{text});
    std::string packed;
    std::size_t unpacked = 0;  // bytes of the buffer that only readers of the extension fill
    const auto views = compressible(file.root);
    for (std::size_t i = 0; file.root.contains("bufferViews") && i < file.root["bufferViews"].size(); ++i) {
        Json& view = file.root["bufferViews"][i];
        const std::string_view bytes = plain.substr(view.value("byteOffset", std::size_t{0}), view.at("byteLength").get<std::size_t>());
        align(packed);
        std::string shorter;
        const auto how = views.find(i);
        if (how != views.end() && how->second.count * how->second.stride == bytes.size()) {
            shorter = encodeMeshopt(how->second, bytes);
            std::string again;
            if (!decodeMeshopt(how->second, shorter, again).empty() || again != bytes)
                return fail("not-readable", "What was compressed does not come back as it was: please report that, and export without compression.");
        }
        if (shorter.empty() || shorter.size() >= bytes.size()) {
            view["byteOffset"] = packed.size();
            packed += bytes;
            continue;
        }
        view["buffer"] = 1;
        view["byteOffset"] = unpacked;
        view["extensions"][kMeshopt] = {{"buffer", 0}, {"byteOffset", packed.size()}, {"byteLength", shorter.size()}, {"byteStride", how->second.stride}, {"count", how->second.count}, {"mode", how->second.mode}};
        unpacked += (bytes.size() + 3) / 4 * 4;
        packed += shorter;
    }
    if (unpacked == 0) return glb;
    for (const char* list : {"extensionsUsed", "extensionsRequired"}) file.root[list].push_back(kMeshopt);
    return file.glb(std::move(packed), unpacked);
}

}  // namespace imomushi
