// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// The two compressions of meshes in glTF files, in the one .cpp file that knows Draco and meshoptimizer. Nothing of the bytes is believed.

namespace imomushi {

/// What KHR_draco_mesh_compression gives a primitive.
struct DracoMesh {
    struct Attribute {
        std::size_t width = 0;      ///< numbers of a vertex
        std::uint64_t type = 5126;  ///< component type as glTF counts them
        std::string bytes;          ///< #vertices x width components, packed
        double step = 0.0;          ///< of the grid to which positions were rounded, 0: they were not
    };
    std::size_t vertices = 0;
    std::map<std::uint64_t, Attribute> attributes;  ///< by the identifiers that the extension uses
    std::vector<std::uint32_t> corners;             ///< three per triangle, < vertices
};

/// Nothing where the bytes are no Draco mesh of version 2, or are damaged. Throws std::bad_alloc where they ask for more memory than there is.
std::optional<DracoMesh> decodeDraco(std::string_view bytes);

/// A buffer view compressed by meshoptimizer, as EXT_meshopt_compression and KHR_meshopt_compression describe it.
struct MeshoptView {
    std::string mode, filter;  ///< as the extension says; no filter: "NONE"
    std::uint64_t count = 0, stride = 0;
};

/// The bytes of the view, count x stride, in `to`. Returns why not, for a message "... that <why>"; empty: they are there.
/// Codec version 0 and its filters (EXT); version 1 and the filter COLOR came later, and are told by name.
std::string decodeMeshopt(const MeshoptView& view, std::string_view bytes, std::string& to);

/// The other way, without loss and without a filter, for version 0 of the codec. `view`: modes "ATTRIBUTES" (a stride of 4 to 256 that 4 divides) and "INDICES" (of 2 or 4 bytes);
/// `bytes`: count x stride.
std::string encodeMeshopt(const MeshoptView& view, std::string_view bytes);

}  // namespace imomushi
