// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/elasticity/inner_angle.h"
#include "core/elasticity/kernels.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// Finds the triangles around some vertices of a mesh and lays them out for vector instructions, so that a few columns of a boundary matrix can be
/// evaluated as fast as all.
class ColumnGather {
public:
    /// `mesh` is kept by reference.
    explicit ColumnGather(const TriangleMesh& mesh);

    /// The triangles of the mesh that touch one of `vertices`, each once; triangles where `leaveOut` (per triangle, or empty) is nonzero are
    /// left out. Corner vertices[i] adds to column i, all other corners to column vertices.size(), which is to be ignored.
    /// May be called from several threads at once.
    [[nodiscard]] TriangleBatch around(std::span<const std::int32_t> vertices, std::span<const char> leaveOut = {}) const;
    /// The same for both matrices (see TriangleBatch): their columns are equal.
    [[nodiscard]] TriangleBatch aroundForBoth(std::span<const std::int32_t> vertices, std::span<const char> leaveOut = {}) const;

    /// Triangles that touch a vertex, ascending.
    [[nodiscard]] std::span<const std::int32_t> trianglesOf(std::int32_t vertex) const {
        const auto v = static_cast<std::size_t>(vertex);
        return std::span(triangles_).subspan(begin_[v], begin_[v + 1] - begin_[v]);
    }

private:
    [[nodiscard]] TriangleBatch gather(std::span<const std::int32_t> vertices, std::span<const char> leaveOut, bool both) const;

    const TriangleMesh* mesh_;
    std::vector<std::size_t> begin_;
    std::vector<std::int32_t> triangles_;
};

}  // namespace imomushi
