// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/io/gltf_compression.h"

#include <draco/attributes/attribute_quantization_transform.h>
#include <draco/compression/decode.h>
#include <meshoptimizer.h>

#include <cstring>
#include <memory>

namespace imomushi {

namespace {

/// The component type of glTF, 0: none.
std::uint64_t typeOf(draco::DataType type) {
    switch (type) {
        case draco::DT_INT8: return 5120;
        case draco::DT_UINT8: return 5121;
        case draco::DT_INT16: return 5122;
        case draco::DT_UINT16: return 5123;
        case draco::DT_UINT32: return 5125;
        case draco::DT_FLOAT32: return 5126;
        default: return 0;
    }
}

}  // namespace

std::optional<DracoMesh> decodeDraco(std::string_view bytes) {
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    const auto kind = draco::Decoder::GetEncodedGeometryType(&buffer);
    if (!kind.ok() || kind.value() != draco::TRIANGULAR_MESH) return std::nullopt;
    draco::Decoder decoder;
    decoder.SetSkipAttributeTransform(draco::GeometryAttribute::POSITION);  // undone here, where the grid is known
    const auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) return std::nullopt;
    const draco::Mesh& mesh = *decoded.value();
    DracoMesh result;
    result.vertices = mesh.num_points();
    for (int a = 0; a < mesh.num_attributes(); ++a) {
        const draco::PointAttribute& stored = *mesh.attribute(a);
        DracoMesh::Attribute to;
        draco::AttributeQuantizationTransform grid;
        draco::PointAttribute plain;
        const bool rounded = grid.InitFromAttribute(stored);
        if (rounded) {
            if (grid.quantization_bits() < 1 || grid.quantization_bits() > 30) return std::nullopt;
            plain.Init(stored.attribute_type(), static_cast<std::int8_t>(stored.num_components()), draco::DT_FLOAT32, false, stored.size());
            if (!grid.InverseTransformAttribute(stored, &plain)) return std::nullopt;
            to.step = static_cast<double>(grid.range()) / static_cast<double>((std::uint64_t{1} << static_cast<unsigned>(grid.quantization_bits())) - 1);
        }
        const draco::PointAttribute& from = rounded ? plain : stored;
        to.type = typeOf(from.data_type());
        to.width = from.num_components();
        const auto size = static_cast<std::size_t>(draco::DataTypeLength(from.data_type())) * to.width;
        if (to.type == 0 || from.byte_stride() < static_cast<std::int64_t>(size)) continue;
        to.bytes.resize(size * result.vertices);
        for (std::size_t v = 0; v < result.vertices; ++v) {
            const draco::AttributeValueIndex at = stored.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(v)));
            if (at.value() >= from.size()) return std::nullopt;
            from.buffer()->Read(from.GetBytePos(at), to.bytes.data() + v * size, size);
        }
        result.attributes.emplace(stored.unique_id(), std::move(to));
    }
    result.corners.reserve(3 * static_cast<std::size_t>(mesh.num_faces()));
    for (std::uint32_t f = 0; f < mesh.num_faces(); ++f)
        for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(f))) {
            if (corner.value() >= result.vertices) return std::nullopt;
            result.corners.push_back(corner.value());
        }
    return result;
}

std::string decodeMeshopt(const MeshoptView& view, std::string_view bytes, std::string& to) {
    // The library asserts what is checked here.
    const bool attributes = view.mode == "ATTRIBUTES";
    const auto *from = reinterpret_cast<const unsigned char*>(bytes.data());
    if (!attributes && view.mode != "TRIANGLES" && view.mode != "INDICES") return "are of the unknown mode '" + view.mode + "'";
    if (attributes ? view.stride % 4 != 0 || view.stride == 0 || view.stride > 256 : view.stride != 2 && view.stride != 4) return "have an impossible stride";
    if (view.mode == "TRIANGLES" && view.count % 3 != 0) return "make no whole triangles";
    // The first byte: which stream, and in its last four bits the version of the codec. Later libraries may read version 1 of attributes, this one cannot.
    const unsigned kind = bytes.empty() ? 0 : from[0] & 0xF0U, version = bytes.empty() ? 0 : from[0] & 0x0FU;
    if (kind != (attributes ? 0xA0U : view.mode == "TRIANGLES" ? 0xE0U : 0xD0U)) return "are damaged";
    if (version > (attributes ? 0U : 1U)) return "are of version " + std::to_string(version) + " of the codec, which is not known here";
    const bool octahedral = view.filter == "OCTAHEDRAL", quaternion = view.filter == "QUATERNION", exponential = view.filter == "EXPONENTIAL";
    if (!octahedral && !quaternion && !exponential && view.filter != "NONE") return "need the filter '" + view.filter + "', which is not known here";
    if ((octahedral && view.stride != 4 && view.stride != 8) || (quaternion && view.stride != 8) || (view.filter != "NONE" && !attributes)) return "have a filter that does not fit them";
    // Rows of four take a quarter of a byte at least: what announces much more than it holds is damaged, and no memory is asked for it.
    if (attributes && view.count / 16384 > bytes.size()) return "are damaged";
    if (!attributes && view.count / 4096 > bytes.size()) return "are damaged";
    to.resize(static_cast<std::size_t>(view.count * view.stride));
    const auto count = static_cast<std::size_t>(view.count), stride = static_cast<std::size_t>(view.stride);
    const int failed = attributes                  ? meshopt_decodeVertexBuffer(to.data(), count, stride, from, bytes.size())
                       : view.mode == "TRIANGLES" ? meshopt_decodeIndexBuffer(to.data(), count, stride, from, bytes.size())
                                                   : meshopt_decodeIndexSequence(to.data(), count, stride, from, bytes.size());
    if (failed != 0) return "are damaged";
    if (octahedral) meshopt_decodeFilterOct(to.data(), count, stride);
    if (quaternion) meshopt_decodeFilterQuat(to.data(), count, stride);
    if (exponential) meshopt_decodeFilterExp(to.data(), count, stride);
    return "";
}

std::string encodeMeshopt(const MeshoptView& view, std::string_view bytes) {
    // What the extension knows, whatever a later library would choose.
    [[maybe_unused]] static const bool set = (meshopt_encodeVertexVersion(0), meshopt_encodeIndexVersion(1), true);
    const auto count = static_cast<std::size_t>(view.count), stride = static_cast<std::size_t>(view.stride);
    std::string to;
    const auto room = [&](std::size_t bound) {
        to.resize(bound);
        return reinterpret_cast<unsigned char*>(to.data());
    };
    if (view.mode == "ATTRIBUTES") {
        const std::size_t bound = meshopt_encodeVertexBufferBound(count, stride);
        to.resize(meshopt_encodeVertexBuffer(room(bound), bound, bytes.data(), count, stride));
        return to;
    }
    std::vector<unsigned int> indices(count, 0);
    for (std::size_t i = 0; i < count; ++i) std::memcpy(&indices[i], bytes.data() + i * stride, stride);  // little-endian, as the file is
    const std::size_t bound = meshopt_encodeIndexSequenceBound(count, std::size_t{1} << 32);
    to.resize(meshopt_encodeIndexSequence(room(bound), bound, indices.data(), count));
    return to;
}

}  // namespace imomushi
