// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/character/embedded_mesh.h"
#include "core/character/vertex_kernels.h"

namespace imomushi {

/// What the frames of the morph targets of a render mesh read and never change. A morph target moves vertices at rest; the body carries what it adds by the gradient of its
/// deformation there, F delta, since a place beside the body moves by F times its distance. F is that of the surface itself: it takes the two tangents of a vertex's stencil
/// (NormalStencil) from rest to where they are shown, and the unit normal to the unit normal. So it is the same on both sides of a joint, under every effect and on attached
/// parts, and costs nothing of vertices that no weight moves. Exact where the shape is rigid; thickness across the surface stays what it was.
struct MorphTables {
    /// stencils: of the vertices of the mesh, at `rest`.
    static std::shared_ptr<const MorphTables> build(const EmbeddedMesh& mesh, const Points& rest, const std::vector<NormalStencil>& stencils);

    /// A vertex that some target moves.
    struct Vertex {
        std::int32_t vertex = 0;
        Eigen::Matrix3f fromRest = Eigen::Matrix3f::Identity();  ///< inverse of its tangents and normal at rest; 0: its stencil has no area, what is added is not turned
    };
    struct Target {
        float atRest = 0.0f;
        std::vector<std::int32_t> moved;  ///< into `vertices`, as MorphTarget::vertices
        const float* deltas = nullptr;    ///< of the model, 3 per vertex
    };
    std::vector<Vertex> vertices;         ///< ascending
    std::vector<Target> targets;
    std::shared_ptr<const RenderModel> model;
    [[nodiscard]] std::size_t bytes() const { return vertices.size() * sizeof(Vertex); }
};

/// The work of one mesh in frames.
class MorphShapes {
public:
    explicit MorphShapes(std::shared_ptr<const MorphTables> tables);

    /// Per target.
    [[nodiscard]] std::vector<double> restWeights() const;
    /// Some weight is not that at rest.
    [[nodiscard]] bool active(const std::vector<double>& weights) const;
    /// Adds them to positions (x 3) without morph targets. Does not allocate.
    template <class Number>
    void add(const std::vector<double>& weights, const NormalStencil* stencils, Number* positions);

private:
    std::shared_ptr<const MorphTables> tables_;
    std::vector<Eigen::Vector3f> sums_;  // per vertex of the tables: deltas times weights, then what they move it by
};

}  // namespace imomushi
