// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// The triangle corners at each vertex. Corner c of triangle f has the number 3 f + c.
class VertexCorners {
public:
    VertexCorners() = default;  ///< no vertices
    /// `corners`: the vertex of each corner, 3 for each triangle, in [0, vertices). `which`: per triangle, 0: its corners are left out; empty: none are.
    VertexCorners(std::span<const std::int32_t> corners, std::size_t vertices, std::span<const char> which = {});
    /// Of all triangles of a mesh.
    explicit VertexCorners(const TriangleMesh& mesh)
        : VertexCorners({mesh.triangles.data(), static_cast<std::size_t>(mesh.triangles.size())}, static_cast<std::size_t>(mesh.vertices.rows())) {}

    /// Ascending.
    [[nodiscard]] std::span<const std::int32_t> at(std::int32_t vertex) const {
        const std::uint32_t begin = first_[static_cast<std::size_t>(vertex)];
        return {corners_.data() + begin, first_[static_cast<std::size_t>(vertex) + 1] - begin};
    }
    [[nodiscard]] std::size_t vertices() const { return first_.empty() ? 0 : first_.size() - 1; }
    [[nodiscard]] std::size_t bytes() const { return sizeof(std::int32_t) * (first_.size() + corners_.size()); }

private:
    std::vector<std::uint32_t> first_;  ///< per vertex into corners_, one more
    std::vector<std::int32_t> corners_;
};

}  // namespace imomushi
