// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/mesh/render_model.h"

namespace imomushi {

/// Vertices of render meshes that the body of one element moves, at rest. Does not change once a character has it.
struct EmbeddedPoints {
    Points rest;     ///< #E x 3, m
    /// #E x 3 or 0 x 3: out of the surface that is seen, any length, zero: not known. They say which side of a thin wall a point is on (EmbeddedMapping).
    Points normals;
    /// #E or none: the body vertex at the same place, which the point is in every pose, bit for bit; -1: none.
    std::vector<std::int32_t> bodyVertex;
    /// Points that are not flesh (an eye, a hat, a row of teeth): they keep their shape, and move as the body does at the pivot, by the rotation in its gradient.
    struct Attached {
        Vec3 pivot = Vec3::Zero();          ///< m, rest
        std::vector<std::int32_t> points;   ///< of at most one part each
    };
    std::vector<Attached> attached;
};

/// A render mesh over the elements of a character: triangles of any kind in the order of the file, each vertex moved by one element. Does not change once a
/// character has it.
struct EmbeddedMesh {
    struct Vertex {
        std::int32_t element = 0;
        std::int32_t index = 0;  ///< of an embedded point of that element, or of a body vertex
        bool onBody = false;     ///< of a body vertex
    };
    std::vector<Vertex> vertices;
    Triangles triangles;  ///< #F x 3 of `vertices`
    /// #vertices x 3 or 0 x 3, those of the file: where they jump at one place, edges are hard.
    Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> normals;
    std::shared_ptr<const RenderModel> model;  ///< whose morph targets move these vertices; null: none do
    [[nodiscard]] std::size_t morphs() const { return model ? model->morphs.size() : 0; }
};

}  // namespace imomushi
