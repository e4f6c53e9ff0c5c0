// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/character/element_runtime.h"
#include "core/character/embedded_mesh.h"
#include "core/character/morph_shapes.h"

namespace imomushi {

/// What the frames of a render mesh read and never change. Characters share it where neither the mesh nor the points of its elements changed.
///
/// Normals are those of area-weighted triangles by stencils (normal_stencils.h), over all vertices of a smoothing group: those at one place at rest whose
/// normals in the file are less than kSameNormal apart or, without normals in the file, whose own triangles' normals are less than kCrease apart. So normals
/// are smooth where the file's are, over seams of texture coordinates and joints too, and hard edges stay hard in every pose.
struct RenderMeshTables {
    static constexpr double kSameNormal = 0.985;  ///< cosine of 10 degrees: below what a modelling program smooths or splits
    static constexpr double kCrease = 0.643;      ///< cosine of 50 degrees

    /// Vertices that follow each other here and in their element.
    struct Run {
        std::int32_t to = 0, element = 0, from = 0, count = 0;
    };
    /// Vertices of normals for one thread.
    struct NormalPiece {
        std::size_t begin = 0, end = 0;
        std::vector<std::int32_t> elements;  ///< that they follow from, ascending
    };

    /// runtimes: those of all elements. The mesh is valid for them (check_input.h).
    static std::shared_ptr<const RenderMeshTables> build(std::shared_ptr<const EmbeddedMesh> mesh,
                                                         std::span<const std::shared_ptr<const ElementRuntime>> runtimes);
    /// They are those of this mesh with these elements.
    [[nodiscard]] bool fits(const std::shared_ptr<const EmbeddedMesh>& mesh, std::span<const std::shared_ptr<const ElementRuntime>> runtimes) const;

    [[nodiscard]] std::size_t vertices() const { return mesh->vertices.size(); }
    [[nodiscard]] std::size_t bytes() const { return runs.size() * sizeof(Run) + stencils.size() * sizeof(NormalStencil); }

    std::shared_ptr<const EmbeddedMesh> mesh;
    Points rest;                           ///< #vertices x 3
    std::vector<std::int32_t> elements;    ///< that it has vertices of, ascending
    std::vector<Run> runs;
    std::vector<NormalStencil> stencils;   ///< padded
    std::vector<NormalPiece> normalPieces;
    double scale = 1.0;                    ///< see findNormals()
    std::shared_ptr<const MorphTables> morphs;  ///< null: it has no morph targets

private:
    struct Source {
        std::shared_ptr<const ElementMesh> mesh;
        std::shared_ptr<const EmbeddedPoints> points;
        bool operator==(const Source&) const = default;
    };
    std::vector<Source> sources_;          // of `elements`
};

/// The vertex of its element (EmbeddedTables) that a vertex of a render mesh is.
std::int32_t elementVertex(const EmbeddedMesh::Vertex& vertex, const ElementRuntime& runtime);

}  // namespace imomushi
