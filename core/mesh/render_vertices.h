// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// Chooses render vertices of a mesh, each once: those of the same body vertex whose attributes agree bit for bit are one.
class RenderVertices {
public:
    explicit RenderVertices(const RenderMesh& from) : from_(from) {}

    /// The number of render vertex `r` of the mesh on body vertex `body`, `flipped`: with its normal the other way. Numbers count up from 0.
    std::int32_t add(std::int32_t body, std::int32_t r, bool flipped = false);

    /// Sets bodyVertex, normals, texCoords and colors of `to`, which may be the mesh itself; it keeps all else.
    void write(RenderMesh& to) const;

private:
    struct Key {
        std::int32_t body;
        std::array<std::uint32_t, 9> bits;  // normal, texture coordinates, colour
        bool operator==(const Key&) const = default;
    };
    struct KeyHash {
        std::size_t operator()(const Key& key) const;
    };

    const RenderMesh& from_;
    std::unordered_map<Key, std::int32_t, KeyHash> known_;
    std::vector<Key> keys_;
};

}  // namespace imomushi
